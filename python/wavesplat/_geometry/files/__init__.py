"""Surfaces, lines and points in files, a module for each kind of format."""
