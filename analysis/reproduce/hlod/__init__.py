"""The thesis on hierarchical levels of detail with hysteresis."""
