"""Simulated replays compared with recorded ones."""
