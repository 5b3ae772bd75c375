"""Simulated replays held against recorded ones."""
