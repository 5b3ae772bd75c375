"""Simulated runs for the viewers that users already have."""
