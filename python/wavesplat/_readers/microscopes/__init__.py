"""Formats of microscopes: BigDataViewer, Imaris, and formats of vendors by bioio."""
