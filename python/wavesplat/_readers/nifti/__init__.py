"""NIfTI and other formats of neuroimaging, by nibabel."""
