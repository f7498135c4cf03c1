"""OME-Zarr, plain Zarr arrays, and maps that xarray wrote."""
