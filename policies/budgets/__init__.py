"""Policies that choose the best picture within a predicted cost."""
