"""Colour points of the maps that ParaView starts with, which its Python states name and do not write out.

Source: ParaView's Remoting/Views/ColorMaps.json, version 6.
"""

from __future__ import annotations

#: Place, 0..1, red, green and blue of the maps that ParaView starts with: up to version 5, and from 6 on.
OWN = {
    "Cool to Warm": [
        (0.0, 0.231373, 0.298039, 0.752941),
        (0.5, 0.865003, 0.865003, 0.865003),
        (1.0, 0.705882, 0.0156863, 0.14902),
    ],
    "Fast": [
        (0.0, 0.0564, 0.0564, 0.47),
        (0.171592, 0.243, 0.46035, 0.81),
        (0.298491, 0.356814, 0.745025, 0.954368),
        (0.432129, 0.6882, 0.93, 0.91791),
        (0.5, 0.899496, 0.944646, 0.768657),
        (0.588226, 0.957108, 0.833819, 0.508916),
        (0.706141, 0.927521, 0.621439, 0.315357),
        (0.847640, 0.8, 0.352, 0.16),
        (1.0, 0.59, 0.0767, 0.119475),
    ],
}
