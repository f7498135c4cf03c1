"""Slices of the viewer: their first settings, their panes, and the values sent to the page."""
