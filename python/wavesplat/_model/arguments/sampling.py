"""Kernels, operators, qualities and planes by name, and sampling rates: sheets per slice, and texels per pixel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from wavesplat._public import public
from wavesplat._system.values import described, number
from wavesplat.errors import ArgumentError

# Names of the kernels, operators, qualities and planes, and the largest side of a picture.

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


def composite_name(given: object) -> Composite:
    """The name of an operator, of which synonyms are known; an `ArgumentError` for anything else."""
    names: tuple[Composite, ...] = get_args(Composite)
    name = COMPOSITE_SYNONYMS.get(given, given) if isinstance(given, str) else given
    for known in names:
        if name == known:
            return known
    raise ArgumentError(f"unknown composite operator {described(given)}; use one of: {', '.join(names)}")


Quality: TypeAlias = Literal["draft", "normal", "fine", "high"]
Plane: TypeAlias = Literal["axial", "coronal", "sagittal", "xy", "xz", "yz"]
Slab: TypeAlias = Literal["maximum", "minimum", "mean"]

#: Operators whose grey scale, where none is given, is chosen by the values that the view shows.
BY_VIEW = ("minimum", "mean", "sum", "x-ray")


# Sampling rates of a picture: sheets per slice, and texels per pixel.


@public
@dataclass(frozen=True)
class Sampling:
    """The sampling rates of a picture, instead of a quality by name.

    Parameters
    ----------
    sheets_per_slice : float, optional
        Sheets per slice distance.
    oversampling : float, optional
        Texels per pixel, along each side; a pixel is the mean of this number of reads along each, rounded up. In
        perspective it is an average: where rays lie closest together, pixels get 0.7 of it at least.
    quality : str, default "normal"
        The quality that gives the values that are None.

    Raises
    ------
    ArgumentError
        If a value is no number, or there is no quality of that name.

    Examples
    --------
    >>> import wavesplat as ws
    >>> picture = ws.render(ws.examples.ripples(8), size=(8, 8), quality=ws.Sampling(4, 2))
    >>> picture.report["sheets_per_slice"], picture.report["oversampling"]
    (4.0, 2.0)
    """

    sheets_per_slice: float | None = None
    oversampling: float | None = None
    quality: Quality = "normal"

    def __post_init__(self) -> None:
        """Check types and names; ranges are checked by the compiled module."""
        for name in ("sheets_per_slice", "oversampling"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, number(value, name, "a number", finite=False))
        _check_name(self.quality)


def checked_quality(given: object) -> Sampling:
    """The `Sampling` of a quality by name, or of a `Sampling` itself."""
    if isinstance(given, Sampling):
        return given
    if not isinstance(given, str):
        raise ArgumentError(
            f"quality is {described(given)}; give {', '.join(get_args(Quality))}, "
            "or wavesplat.Sampling(sheets_per_slice, oversampling)"
        )
    return Sampling(quality=_check_name(given))


def _check_name(name: object) -> Quality:
    if not isinstance(name, str) or name not in get_args(Quality):
        raise ArgumentError(f"unknown quality {described(name)}; use one of: {', '.join(get_args(Quality))}")
    return name  # type: ignore[return-value]
