"""Captures of frame times: what they hold, by the metrics of replays, and how two differ."""
