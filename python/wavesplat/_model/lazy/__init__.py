"""Volumes whose samples stay where they are and are read as they are drawn."""
