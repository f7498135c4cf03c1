"""The result, and what is written on it."""
