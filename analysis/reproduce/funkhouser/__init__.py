"""Funkhouser and Sequin: the order of algorithms on the Soda Hall model."""
