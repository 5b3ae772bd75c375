"""Gumbau, Chover and others: a manager of levels that objects share."""
