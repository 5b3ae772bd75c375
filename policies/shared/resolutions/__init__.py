"""Resolutions of objects: what they cost, and how a budget is divided among them."""
