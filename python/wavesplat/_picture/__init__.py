"""Pictures, the figures that are made of them, and their files."""
