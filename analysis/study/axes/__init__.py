"""What varies in a study: axes, the grid of their combinations, and what they name."""
