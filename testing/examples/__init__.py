"""Small worlds in which promises are tried: fixed ones, and strategies that draw others."""
