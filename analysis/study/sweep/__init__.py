"""Studies as files: read from TOML, estimated, carried out, and shown."""
