"""Names of the kernels, operators, qualities and views."""

from __future__ import annotations

from typing import Literal, TypeAlias

__all__ = ["VIEWS", "Composite", "Kernel", "Quality"]

Kernel: TypeAlias = Literal["linear", "catmull-rom", "bspline2", "bspline3", "gaussian"]
Composite: TypeAlias = Literal["over", "maximum", "minimum", "mean", "sum", "first-hit"]
Quality: TypeAlias = Literal["draft", "normal", "high"]

#: Azimuth and elevation, degrees, of the six anatomical views.
#: Superior and inferior have the patient's front at the top; inferior is how radiologists look at an axial slice.
VIEWS = {
    "anterior": (0.0, 0.0),
    "posterior": (180.0, 0.0),
    "left": (90.0, 0.0),
    "right": (-90.0, 0.0),
    "superior": (180.0, 90.0),
    "inferior": (0.0, -90.0),
}
