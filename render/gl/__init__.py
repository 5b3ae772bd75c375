"""Frames drawn with OpenGL, and how long they took."""
