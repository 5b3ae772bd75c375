"""Paths of engines, tools and vehicles."""
