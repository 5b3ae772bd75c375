"""Reported times, and loops that steer by them."""
