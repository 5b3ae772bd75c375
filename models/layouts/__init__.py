"""Where objects stand: one layout a file."""
