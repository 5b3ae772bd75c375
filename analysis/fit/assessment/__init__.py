"""What a fit is worth: held-out error, dependence, collinearity, the choice of terms."""
