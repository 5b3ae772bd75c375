"""What is measured of a frame: timers, counts of the pipeline, fences, and a reference."""
