"""The posterior of a fit, and how it is sampled."""
