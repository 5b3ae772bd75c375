"""The sections of a report, one a file, by the name of the file."""
