"""Where objects stand: one layout a file, a function of radii, side and random numbers."""
