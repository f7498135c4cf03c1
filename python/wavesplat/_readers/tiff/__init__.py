"""TIFF stacks and folders, by tifffile."""
