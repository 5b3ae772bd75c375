"""Ends of the scale: full detail, and the best selection there is."""
