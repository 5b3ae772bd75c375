"""The machine that frames run on, its noise, and what it reports."""
