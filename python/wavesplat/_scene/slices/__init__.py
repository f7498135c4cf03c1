"""Slices of scenes: layers on them, lines, sheets of several, and slices that stand in space."""
