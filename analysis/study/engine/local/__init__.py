"""Worker processes of this machine, each of which runs one policy only."""
