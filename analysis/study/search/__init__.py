"""Search for better parameters of a policy."""
