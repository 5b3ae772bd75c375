"""Hierarchies, and the order in which they are refined."""
