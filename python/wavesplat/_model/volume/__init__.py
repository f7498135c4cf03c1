"""Volumes, their places, facts, units, names and series."""
