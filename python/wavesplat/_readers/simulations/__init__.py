"""Grids of simulations and surveys: bricks of values, molecules, crystals, seismic cubes."""
