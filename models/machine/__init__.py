"""Machines: what a frame costs, the noise of its times, and hardware profiles."""
