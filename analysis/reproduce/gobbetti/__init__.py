"""Gobbetti and Bouvier: time-critical multiresolution scene rendering."""
