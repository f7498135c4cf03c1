"""Samples without much of a header: NumPy's files and raw bytes."""
