"""Level-of-detail policies: one a file."""
