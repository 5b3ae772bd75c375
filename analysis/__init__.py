"""Metrics, fits, comparisons and reports."""
