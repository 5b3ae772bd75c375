"""Policies that choose a front in a hierarchy."""
