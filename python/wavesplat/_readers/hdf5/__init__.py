"""HDF5, by h5py, with openPMD; and netCDF, by xarray."""
