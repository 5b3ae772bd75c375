"""Hierarchical levels of detail of one mesh, by recursive cuts."""
