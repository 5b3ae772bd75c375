"""A comparison for papers and pull requests: figures, tables and a summary, as files."""
