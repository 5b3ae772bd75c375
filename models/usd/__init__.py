"""USD files as scenes."""
