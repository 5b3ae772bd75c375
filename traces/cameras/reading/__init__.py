"""From the poses of a file, in its own axes and units, to a camera trace."""
