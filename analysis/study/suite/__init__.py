"""A fixed, versioned study, and its leaderboard."""
