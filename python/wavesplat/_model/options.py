"""Names of the kernels, operators, qualities, views and planes, and the largest side of a picture."""

from __future__ import annotations

from typing import Literal, TypeAlias

__all__ = [
    "BY_VIEW",
    "COMPOSITE_SYNONYMS",
    "MAX_SIDE_PX",
    "PLANES",
    "VIEWS",
    "Buffer",
    "Composite",
    "Kernel",
    "Plane",
    "Quality",
    "Slab",
]

#: Pixels along a side of a picture, at most: `MAX_SIDE_PX` of the compiled module.
MAX_SIDE_PX = 16384

Buffer: TypeAlias = Literal["axis", "view"]
Kernel: TypeAlias = Literal["linear", "catmull-rom", "bspline2", "bspline3", "gaussian"]
Composite: TypeAlias = Literal[
    "over", "maximum", "depth-shaded-maximum", "local-maximum", "minimum", "mean", "sum", "x-ray", "first-hit"
]
#: Other names of operators.
COMPOSITE_SYNONYMS = {"mip": "maximum", "minip": "minimum", "average": "mean", "isosurface": "first-hit"}
Quality: TypeAlias = Literal["draft", "normal", "fine", "high"]
Plane: TypeAlias = Literal["axial", "coronal", "sagittal"]
Slab: TypeAlias = Literal["maximum", "minimum", "mean"]

#: Operators whose grey scale, where none is given, is chosen by the values that the view shows.
BY_VIEW = ("minimum", "mean", "sum", "x-ray")

#: Azimuth and elevation, degrees, of the named views.
#: Superior and inferior have the patient's front at the top; inferior is how radiologists look at an axial slice.
#: The views of a plane have its first axis to the right and its second one up.
VIEWS = {
    "anterior": (0.0, 0.0),
    "posterior": (180.0, 0.0),
    "left": (90.0, 0.0),
    "right": (-90.0, 0.0),
    "superior": (180.0, 90.0),
    "inferior": (0.0, -90.0),
    "front": (0.0, 0.0),
    "back": (180.0, 0.0),
    "top": (180.0, 90.0),
    "bottom": (0.0, -90.0),
    "xy": (180.0, 90.0),
    "xz": (180.0, 0.0),
    "yz": (-90.0, 0.0),
    "isometric": (150.0, 30.0),
}

#: Anatomical plane -> the axis across it, the axis that is up in its picture, and the side on which the eye is.
#: Axial is seen from the feet, coronal from the front, sagittal from the patient's left.
PLANES = {"axial": ("z", "y", -1), "coronal": ("y", "z", 1), "sagittal": ("x", "z", -1)}
