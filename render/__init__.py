"""Frames drawn: by OpenGL, which measures them, and by numpy, as pictures."""
