"""Cost models fitted to measured render logs: posterior, diagnostics, held-out error, profile."""
