"""Engines: what carries out the tasks of a study, each away from the tasks of other policies."""
