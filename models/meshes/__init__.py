"""Meshes of levels of detail: reading, simplifying, measuring."""
