"""What policies promise: each promise with its judge, and how examples are tried."""
