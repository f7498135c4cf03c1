"""Labels: segmentations, their files, names and colours, and regions of closed lines."""
