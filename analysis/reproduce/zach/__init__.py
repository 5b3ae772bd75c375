"""Zach, Mantler and Karner: time-critical rendering of discrete and continuous levels."""
