"""Scenes: objects, trees, cells, cameras, culling, and the scene file."""
