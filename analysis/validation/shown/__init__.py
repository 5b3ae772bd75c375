"""A validation as it is shown: tables for a terminal, and a page."""
