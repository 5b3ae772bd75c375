"""Traps of real logs that take more than a line to find."""
