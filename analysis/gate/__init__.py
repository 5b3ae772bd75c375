"""The frame-budget gate for continuous integration: limits, measurements, verdicts and reports."""
