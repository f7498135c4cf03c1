"""Scenes: what is shown, of how many volumes, and how it becomes a picture, a document, a picture again."""
