"""Each paper's experiments: what it printed beside what the simulator gives."""
