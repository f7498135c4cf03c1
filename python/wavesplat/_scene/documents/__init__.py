"""Scenes as documents: JSON, the volumes and files that it names, and the files it stands in."""
