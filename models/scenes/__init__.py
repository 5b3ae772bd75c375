"""The scenes of the papers at full size, generated."""
