"""What the columns of a log mean: words of their names, roles, units."""
