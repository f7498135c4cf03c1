"""Curves and colours: transfer functions, colour maps, materials, and the scales of their values."""
