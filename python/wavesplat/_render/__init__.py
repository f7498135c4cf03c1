"""The renderer's front ends: they check what a user gives, and call the compiled module."""
