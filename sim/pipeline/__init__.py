"""The frame pipeline: events, pacing and screens on one clock."""
