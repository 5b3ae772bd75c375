"""Metrics of a frame log: stability, lag, flicker, quality and work."""
