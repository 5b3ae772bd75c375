"""Camera traces: reading, placing, generating, writing."""
