"""Objects that users make: volumes, cameras, clips; checked when they are made, so that drawing them cannot fail."""
