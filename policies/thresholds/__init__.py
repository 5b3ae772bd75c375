"""Policies that compare a distance, a size or an error with a threshold."""
