"""What a GPU's cost model counts beside the levels' own counts: one term a file."""
