"""Statistics behind a verdict: operating points, intervals, chances, ranks, the gate."""
