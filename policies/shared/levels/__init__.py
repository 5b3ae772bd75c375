"""Levels of objects and what choosing among them needs."""
