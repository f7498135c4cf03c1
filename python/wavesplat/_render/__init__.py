"""The renderer's front doors: they take what a user has, and call the compiled module."""
