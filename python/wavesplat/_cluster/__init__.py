"""Pictures from many machines, by Dask: which there are, and blocks and segments of a picture over them."""
