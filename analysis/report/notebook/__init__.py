"""A comparison in a notebook: its ranking, and figures that can be worked on."""
