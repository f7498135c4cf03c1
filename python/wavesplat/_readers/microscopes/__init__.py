"""Formats of microscopes: BigDataViewer, Imaris, and those of vendors by bioio."""
