"""A policy's thresholds as settings of engines."""
