"""Camera traces that are made up."""
