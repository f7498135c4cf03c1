"""Scenes of volumes: how they are shown, drawn as pictures, and written and read as documents."""
