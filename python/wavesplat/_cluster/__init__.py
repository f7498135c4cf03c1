"""Pictures drawn by many machines, with Dask: the workers, and the blocks and segments that are their tasks."""
