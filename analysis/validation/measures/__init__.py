"""What a validation measures: errors, metrics inside intervals, decisions, order."""
