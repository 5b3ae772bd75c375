"""Optimisers that policies share a budget with."""
