"""What every room stands on: errors, arrays, files written whole, strict readers, predictors."""
