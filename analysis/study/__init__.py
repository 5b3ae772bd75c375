"""Runs of policies: what is replayed, where, and the record of its results."""
