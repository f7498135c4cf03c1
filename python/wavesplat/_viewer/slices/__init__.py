"""Slices of the viewer: what they begin with, their panes, and the values sent to the page."""
