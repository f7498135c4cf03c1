"""Names of the kernels, operators, qualities and planes, and the largest side of a picture."""

from __future__ import annotations

from typing import Literal, TypeAlias

#: Pixels along a side of a picture, at most: `MAX_SIDE_PX` of the compiled module.
MAX_SIDE_PX = 16384

Buffer: TypeAlias = Literal["axis", "view"]
Kernel: TypeAlias = Literal["linear", "catmull-rom", "bspline2", "bspline3", "gaussian"]
Composite: TypeAlias = Literal[
    "over",
    "maximum",
    "depth-shaded-maximum",
    "depth-colored-maximum",
    "attenuated-maximum",
    "local-maximum",
    "minimum",
    "mean",
    "sum",
    "x-ray",
    "first-hit",
]
#: Other names of operators.
COMPOSITE_SYNONYMS = {"mip": "maximum", "minip": "minimum", "average": "mean", "isosurface": "first-hit"}
Quality: TypeAlias = Literal["draft", "normal", "fine", "high"]
Plane: TypeAlias = Literal["axial", "coronal", "sagittal", "xy", "xz", "yz"]
Slab: TypeAlias = Literal["maximum", "minimum", "mean"]

#: Operators whose grey scale, where none is given, is chosen by the values that the view shows.
BY_VIEW = ("minimum", "mean", "sum", "x-ray")
