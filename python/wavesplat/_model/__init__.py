"""What users make and others draw: volumes, cameras, boxes; checked at once, so that the inside cannot fail."""
