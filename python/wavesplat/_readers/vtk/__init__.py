"""Files of VTK: images, grids, adaptive meshes and series."""
