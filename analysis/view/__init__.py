"""The replay viewer: a page of what two policies draw, side by side, along the first path."""
