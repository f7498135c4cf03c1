"""NRRD and MetaImage, by SimpleITK."""
