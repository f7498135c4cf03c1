"""Stores of Zarr arrays: where their keys lie, and how their chunks are read, checked and decoded."""
