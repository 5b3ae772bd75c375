"""Render logs and frame timings: reading, checking, writing."""
