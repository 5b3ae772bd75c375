"""Results that outlive the process: what was run, and what became of it."""
