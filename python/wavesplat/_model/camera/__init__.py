"""Cameras: views, paths between them, fits to volumes, eyes, and their files."""
