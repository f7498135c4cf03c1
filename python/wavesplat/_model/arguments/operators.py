"""Operators along a ray: names for the plain ones, objects for those that have numbers.

| operator | the picture shows |
| --- | --- |
| "over" | emission and absorption, front to back |
| "maximum", "minimum", "mean", "sum" | one number of the values along the ray, then coloured |
| `FirstHit` | the isosurface |
| `LocalMaximum` | the first maximum that reaches a threshold |
| `DepthShadedMaximum` | the maximum, dimmed by depth |
| `DepthColoredMaximum` | the maximum, in the colour of its depth |
| `AttenuatedMaximum` | the maximum, dimmed by what is in front of it |
| `XRay` | the fraction of light that is transmitted |
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal, TypeAlias

from wavesplat._model.arguments.sampling import Composite, composite_name
from wavesplat._public import public
from wavesplat._system.values import described, number
from wavesplat.errors import ArgumentError

#: World axes along which a place can be measured.
AXES = ("x", "y", "z")


@public
@dataclass(frozen=True)
class FirstHit:
    """The first surface along a ray where the values cross one value: an isosurface.

    Parameters
    ----------
    iso_value : float
        The surface's value, in sample units.

    Raises
    ------
    ArgumentError
        If it is no finite number.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.render(ws.examples.ripples(8), composite=ws.FirstHit(127.5), size=(8, 8)).size
    (8, 8)
    """

    iso_value: float

    name: ClassVar[Composite] = "first-hit"

    def __post_init__(self) -> None:
        object.__setattr__(self, "iso_value", number(self.iso_value, "iso_value of FirstHit"))


@public
@dataclass(frozen=True)
class LocalMaximum:
    """The first maximum along a ray that reaches a threshold; the largest value where none does.

    Parameters
    ----------
    threshold : float, optional
        Sample value that a maximum must reach. None is a quarter of the way from the first to the last colour of the
        transfer function.

    Raises
    ------
    ArgumentError
        If it is no finite number.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.render(ws.examples.ripples(8), composite=ws.LocalMaximum(100), size=(8, 8)).size
    (8, 8)
    """

    threshold: float | None = None

    name: ClassVar[Composite] = "local-maximum"

    def __post_init__(self) -> None:
        if self.threshold is not None:
            object.__setattr__(self, "threshold", number(self.threshold, "threshold of LocalMaximum"))


@public
@dataclass(frozen=True)
class DepthShadedMaximum:
    """The largest value along a ray, dimmed by how far away it is, so that the picture has depth.

    Parameters
    ----------
    strength : float, default 0.6
        How much the farthest point of what is drawn is dimmed, 0..1, towards the value of the first colour; the
        nearest is not dimmed.

    Raises
    ------
    ArgumentError
        If it is not between 0 and 1.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.render(ws.examples.ripples(8), composite=ws.DepthShadedMaximum(0.8), size=(8, 8)).size
    (8, 8)
    """

    strength: float = 0.6

    name: ClassVar[Composite] = "depth-shaded-maximum"

    def __post_init__(self) -> None:
        strength = number(self.strength, "strength of DepthShadedMaximum")
        if not 0 <= strength <= 1:
            raise ArgumentError(
                f"strength of DepthShadedMaximum is {strength:g}; give a number between 0 and 1: 0 to dim nothing, "
                "1 to dim the farthest point to black"
            )
        object.__setattr__(self, "strength", strength)


@public
@dataclass(frozen=True)
class DepthColoredMaximum:
    """The largest value along a ray, in a colour by its depth: Fiji's temporal-color code, of depth.

    The hue shows the place of the maximum, the brightness its value, as a share of the brightest. Where
    nothing is bright, the picture is clear. `Picture.annotated(colorbar=True)` draws the scale of places.

    Parameters
    ----------
    cmap : str, default "turbo"
        A colour map, by its name. Its first colour is the nearest, or the lowest along `axis`.
    axis : "x", "y" or "z", optional
        World axis along which the place is measured, so that a colour means the same place from everywhere. None is
        the depth along the view, from the nearest to the farthest point of what is drawn.

    Raises
    ------
    ArgumentError
        If the axis is another one, or, when it is drawn, if no colour map has that name.

    Examples
    --------
    >>> import wavesplat as ws
    >>> picture = ws.render(ws.examples.ripples(8), composite=ws.DepthColoredMaximum("viridis", "z"), size=(8, 8))
    >>> picture.report["depth_colors"]["axis"]
    'z'
    """

    cmap: str = "turbo"
    axis: Literal["x", "y", "z"] | None = None

    name: ClassVar[Composite] = "depth-colored-maximum"

    def __post_init__(self) -> None:
        cmap: object = self.cmap
        if not isinstance(cmap, str):
            raise ArgumentError(f"cmap of DepthColoredMaximum is {described(cmap)}; give the name of a colour map")
        axis: object = self.axis
        if axis is not None and (not isinstance(axis, str) or axis not in AXES):
            raise ArgumentError(
                f'axis of DepthColoredMaximum is {described(axis)}; give "x", "y" or "z", or None for the view'
            )


@public
@dataclass(frozen=True)
class AttenuatedMaximum:
    """The largest value along a ray, dimmed by the bright matter in front of it, so that near things hide far ones.

    A value `v` above black counts `black + (v - black) * exp(-attenuation * n)`, where n is the number of voxels of
    the brightest matter that lie in front; darker ones count by their share of the way from black to white. Black and
    white are the values of the first and of the last colour. napari's "attenuated_mip" sums samples where this
    integrates.

    Parameters
    ----------
    attenuation : float, default 0.05
        Optical depth of one voxel of the brightest matter; a voxel is as long as the geometric mean of its sides.
        0 dims nothing.

    Raises
    ------
    ArgumentError
        If it is negative or no finite number.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.render(ws.examples.ripples(8), composite=ws.AttenuatedMaximum(0.1), size=(8, 8)).size
    (8, 8)
    """

    attenuation: float = 0.05

    name: ClassVar[Composite] = "attenuated-maximum"

    def __post_init__(self) -> None:
        attenuation = number(self.attenuation, "attenuation of AttenuatedMaximum")
        if attenuation < 0:
            raise ArgumentError(
                f"attenuation of AttenuatedMaximum is {attenuation:g}; give a number of at least 0: how much one voxel "
                "of the brightest matter dims what is behind it"
            )
        object.__setattr__(self, "attenuation", attenuation)


@public
@dataclass(frozen=True)
class XRay:
    """The fraction of light that is transmitted, 0..1, as in a radiograph.

    Parameters
    ----------
    clear : float, optional
        The largest sample value that absorbs nothing.
    attenuation : float, optional
        Absorption per world unit and sample unit above `clear`. Defaults: -1000 and 2.059e-5 for values that look like
        Hounsfield units, which is water at 60 keV in millimetres; else they follow the range of values.

    Raises
    ------
    ArgumentError
        If a number is not finite, or the attenuation not positive.

    Examples
    --------
    >>> import wavesplat as ws
    >>> pelvis = ws.examples.ct_pelvis()
    >>> ws.render(pelvis, composite=ws.XRay(clear=-1000, attenuation=3e-5), size=(8, 8)).size
    (8, 8)
    """

    clear: float | None = None
    attenuation: float | None = None

    name: ClassVar[Composite] = "x-ray"

    def __post_init__(self) -> None:
        if self.clear is not None:
            object.__setattr__(self, "clear", number(self.clear, "clear of XRay"))
        if self.attenuation is not None:
            attenuation = number(self.attenuation, "attenuation of XRay")
            if not attenuation > 0:
                raise ArgumentError(
                    f"attenuation of XRay is {attenuation:g}; give a positive number: absorption per world unit and "
                    "sample unit above `clear`, 2e-5 for Hounsfield units and millimetres"
                )
            object.__setattr__(self, "attenuation", attenuation)


#: Types of the argument `composite`, checked.
Operator: TypeAlias = (
    Composite | FirstHit | LocalMaximum | DepthShadedMaximum | DepthColoredMaximum | AttenuatedMaximum | XRay
)

#: Plain names of operators with numbers -> their class, called without arguments; "first-hit" needs its number.
WITH_DEFAULTS: dict[str, Any] = {
    kind.name: kind for kind in (LocalMaximum, DepthShadedMaximum, DepthColoredMaximum, AttenuatedMaximum, XRay)
}


def checked_operator(given: object) -> Operator | None:
    """The operator of a plain name, a synonym or an object; an `ArgumentError` for anything else."""
    if given is None or isinstance(
        given, FirstHit | LocalMaximum | DepthShadedMaximum | DepthColoredMaximum | AttenuatedMaximum | XRay
    ):
        return given
    if isinstance(given, type) and getattr(given, "__module__", "") == "wavesplat" and hasattr(given, "name"):
        raise ArgumentError(f"composite is the class {given.__name__}; give an object, as {given.__name__}(...)")
    if not isinstance(given, str):
        raise ArgumentError(
            f"composite is {described(given)}; give a name or an object of wavesplat: FirstHit, LocalMaximum, "
            "DepthShadedMaximum, DepthColoredMaximum, AttenuatedMaximum or XRay"
        )
    name = composite_name(given)
    if name == FirstHit.name:
        raise ArgumentError(
            'composite="first-hit" needs the value of the surface; give composite=wavesplat.FirstHit(iso_value)'
        )
    operator: Operator = WITH_DEFAULTS[name]() if name in WITH_DEFAULTS else name
    return operator


def name_of(operator: Operator) -> Composite:
    """The plain name of an operator."""
    return operator if isinstance(operator, str) else operator.name
