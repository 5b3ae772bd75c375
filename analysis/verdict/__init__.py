"""Statistics behind a verdict: resamples, intervals, fronts."""
