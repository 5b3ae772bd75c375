"""Camera-trace formats, one a file."""
