"""Workers of a Dask cluster, each of which has worker processes of its own."""
