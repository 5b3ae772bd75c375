"""Pieces that bundled scenes are made of."""
