"""What several policies use, and the parts of the larger ones."""
