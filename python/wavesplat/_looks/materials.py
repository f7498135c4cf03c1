"""Materials: what a sample value may be made of, and the mixture as a transfer function.

Each material claims sample values by a piecewise-linear curve of probabilities; curves may overlap.
Claims that sum to more than 1 are scaled to 1, and give the material percentages p_i of a value; what no material
claims is clear.
The mixture's associated colour is sum p_i alpha_i rgb_i, its opacity sum p_i alpha_i.
Source: Drebin, Carpenter and Hanrahan, Volume Rendering, SIGGRAPH 1988.
There the percentages are a volume of their own; here they are a function of the reconstructed value, as all colour is.
`materials_mixture` makes curves of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat._files.values import number, numbers, share
from wavesplat._looks import colors, materials_mixture
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._model.argument_types import check_text, described, takes_its_types
from wavesplat._model.volume_like import VolumeLike, as_volume
from wavesplat._public import public
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.transfer_function_2d import TransferFunction2D

__all__ = ["Material", "Materials"]


@public
@dataclass(frozen=True, init=False)
class Material:
    """A material: which sample values are it, and how it looks.

    Parameters
    ----------
    name : str
        Such as "bone".
    probability : sequence of (value, p)
        Nodes in order of value; `p`, 0..1, is the share of such samples that are this material.
        Linear between nodes, constant beyond the first and the last; two nodes at the same value make a step.
    color : colour
        (r, g, b), "#rrggbb" or a name.
    opacity : float
        0..1, of the pure material, `Materials.opacity_unit` thick.
    density : float, optional
        The number whose gradient is the strength of a surface between materials (Drebin's rho); of two materials with
        the same density the boundary is no surface. None takes the place in the list of materials: 0, 1, 2, ...
        `Materials.surfaces` uses it.

    Raises
    ------
    ArgumentError
        If one of them cannot be; the message says which.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Material("bone", [(150, 0), (300, 1)], "#fff2d9", 0.4).color
    (1.0, 0.9490196078431372, 0.8509803921568627)
    """

    name: str
    probability: tuple[tuple[float, float], ...]
    color: tuple[float, float, float]
    opacity: float
    density: float | None

    def __init__(
        self,
        name: str,
        probability: Iterable[Iterable[float]],
        color: str | Iterable[float],
        opacity: float,
        *,
        density: float | None = None,
    ) -> None:
        object.__setattr__(self, "name", _name(name))
        object.__setattr__(self, "probability", _curve(name, probability))
        object.__setattr__(self, "color", _color(name, color))
        object.__setattr__(self, "opacity", share(opacity, f"material {name!r}: opacity", "a number between 0 and 1"))
        object.__setattr__(self, "density", None if density is None else number(density, f"material {name!r}: density"))


@public
@dataclass(frozen=True, init=False)
class Materials:
    """Materials that may share a place; a transfer function made of their mixture.

    Parameters
    ----------
    materials : sequence of Material
        At least one, with names of their own; mostly in order of density.
    opacity_unit : float, optional
        Thickness that the opacities belong to, world units.
        None takes the geometric mean of the volume's spacings.

    Raises
    ------
    ArgumentError
        If there is no material, or two have the same name.

    Examples
    --------
    >>> import wavesplat as ws
    >>> flesh = ws.Material("flesh", [(-200, 0), (0, 1), (150, 1), (300, 0)], (0.9, 0.4, 0.3), 0.02)
    >>> bone = ws.Material("bone", [(150, 0), (300, 1)], (1, 0.95, 0.85), 0.4)
    >>> materials = ws.Materials([flesh, bone])
    >>> materials.percentages([-100, 225]).tolist()
    [[0.5, 0.0], [0.5, 0.5]]
    >>> picture = ws.render(ws.examples.ct_pelvis(), materials, size=(32, 32))
    """

    materials: tuple[Material, ...]
    opacity_unit: float | None

    def __init__(self, materials: Iterable[Material], opacity_unit: float | None = None) -> None:
        listed = _listed(materials)
        names = [material.name for material in listed]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ArgumentError(f"materials: two are named {twice!r}; give each a name of its own")
        placed = (
            replace(material, density=number) if material.density is None else material
            for number, material in enumerate(listed)
        )
        object.__setattr__(self, "materials", tuple(placed))
        if opacity_unit is not None:
            opacity_unit = number(opacity_unit, "materials: opacity_unit", "a number or None", finite=False)
        object.__setattr__(self, "opacity_unit", opacity_unit)
        self.transfer_function()  # so that a wrong unit of the opacities is refused here

    @property
    def names(self) -> tuple[str, ...]:
        """The materials' names, in order."""
        return tuple(material.name for material in self.materials)

    def percentages(self, values: ArrayLike) -> NDArray[np.float64]:
        """Shares of the materials in samples of some values, 0..1, shape (n, number of materials).

        Rows sum to 1, or to less where the curves claim less; of NaN, to 0.
        """
        flat = np.atleast_1d(np.asarray(values, dtype=np.float64)).ravel()
        claims = self._claims(flat, "right")
        claims[np.isnan(flat)] = 0.0
        claims /= np.maximum(claims.sum(axis=1, keepdims=True), 1.0)
        return claims

    def __repr__(self) -> str:
        return f"<Materials: {', '.join(self.names)}>"

    def transfer_function(self, opacity_unit: float | None = None) -> TransferFunction:
        """The mixture as a transfer function.

        Parameters
        ----------
        opacity_unit : float, optional
            Instead of the materials' own; the opacities are kept.

        Returns
        -------
        TransferFunction
            Opacity and associated colour are the mixture's to 1e-3, at every value.
        """
        values = np.unique([value for material in self.materials for value, _ in material.probability])
        below, above = (self._claims(values, side) for side in ("left", "right"))
        claims = np.stack([below, above], axis=1).reshape(-1, len(self.materials))
        looks = np.array([(*material.color, 1.0) for material in self.materials])
        looks *= [[material.opacity] for material in self.materials]
        opacity, color = materials_mixture.curves(np.repeat(values, 2), claims.sum(axis=1), claims @ looks)
        return TransferFunction(opacity, color, self.opacity_unit if opacity_unit is None else opacity_unit)

    def surfaces(self, share: float = 1.0, *, thickness: float = 4.0) -> TransferFunction2D:
        """The mixture with the surfaces between materials strengthened by the gradient, and their insides fainter.

        Parameters
        ----------
        share : float, 0..1
            How much of the opacity only boundaries have; 1 clears what is homogeneous, 0 changes nothing.
        thickness : float, default 4
            World units. A boundary has its whole opacity where `Material.density`, as a mixture, changes by 1 or more
            over this length: a few samples.

        Returns
        -------
        TransferFunction2D
            A function of value and gradient magnitude, for `render`.

        Raises
        ------
        ArgumentError
            If a number is out of its range, or there is no boundary.

        Examples
        --------
        >>> import wavesplat as ws
        >>> surfaces = ws.Materials.preset("ct").surfaces(0.9)
        >>> picture = ws.render(ws.examples.ct_pelvis(), surfaces, size=(32, 32))

        Notes
        -----
        The surface term of Drebin, Carpenter and Hanrahan (1988); `materials_surface` has the formula.
        """
        from wavesplat._looks import materials_surface

        return materials_surface.surfaces(self, share, thickness)

    @classmethod
    @takes_its_types
    def preset(cls, name: str) -> Materials:
        """Materials by name.

        Parameters
        ----------
        name : str
            "ct": air, fat, soft tissue and bone, CT in Hounsfield units.

        Raises
        ------
        ArgumentError
            If there is no preset of that name.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.Materials.preset("ct").names
        ('air', 'fat', 'soft tissue', 'bone')
        """
        from wavesplat._looks import materials_json

        return materials_json.preset(name)

    @classmethod
    @takes_its_types
    def fit(cls, volume: VolumeLike, materials: int | Sequence[str] = 4) -> Materials:
        """Materials from the volume's histogram: a mixture of normal distributions, one for each.

        Parameters
        ----------
        volume : Volume, WaveletVolume, array, or what else `Volume` takes
            Any units.
        materials : int or sequence of str, default 4
            How many, 1 to 32, or their names in order of sample value. The lowest is clear.

        Raises
        ------
        ArgumentError
            If the volume has fewer different values than materials.
        LibraryError
            If scikit-learn is not installed (`pip install "wavesplat[fit]"`).

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.Materials.fit(ws.examples.mri_head(), ["air", "dark", "grey", "bright"]).names
        ('air', 'dark', 'grey', 'bright')

        Notes
        -----
        `materials_fit` has the method.
        """
        from wavesplat._looks import materials_fit

        return materials_fit.fit(as_volume(volume), materials)

    @classmethod
    @takes_its_types
    def from_json(cls, text: str) -> Materials:
        """The materials that a JSON text describes, as `to_json` writes it.

        Raises
        ------
        ArgumentError
            If it is not such a text; the message names the field.

        Examples
        --------
        >>> import wavesplat as ws
        >>> materials = ws.Materials.preset("ct")
        >>> ws.Materials.from_json(materials.to_json()) == materials
        True
        """
        from wavesplat._looks import materials_json

        return materials_json.parse(text)

    def to_json(self) -> str:
        """The materials as a JSON text, which `from_json` reads back exactly."""
        from wavesplat._looks import materials_json

        return materials_json.write(self)

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Materials:
        """The materials in a JSON file; see `from_json`.

        Raises
        ------
        FileError
            If the file cannot be read.
        ArgumentError
            If it does not describe materials.
        """
        from wavesplat._looks import materials_json

        return materials_json.load(path)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the materials to a JSON file.

        Raises
        ------
        FileError
            If the file cannot be written; nothing is left behind.
        """
        from wavesplat._files import json_object

        json_object.save(path, self.to_json())

    def _claims(self, values: NDArray[np.float64], side: Literal["left", "right"]) -> NDArray[np.float64]:
        """Probabilities of the materials at values, or, from the left, just below them, [n, material]."""
        return np.stack([_interpolate(material.probability, values, side) for material in self.materials], axis=1)


def _interpolate(
    nodes: tuple[tuple[float, float], ...], values: NDArray[np.float64], side: Literal["left", "right"]
) -> NDArray[np.float64]:
    at, p = np.array(nodes).T
    upper = np.searchsorted(at, values, side=side)
    a, b = np.maximum(upper - 1, 0), np.minimum(upper, len(at) - 1)
    width = at[b] - at[a]
    share = np.divide(values - at[a], width, out=np.zeros_like(values), where=width > 0)
    found: NDArray[np.float64] = p[a] + (p[b] - p[a]) * share
    return found


def _listed(materials: object) -> tuple[Material, ...]:
    listed = tuple(materials) if isinstance(materials, Iterable) else (materials,)
    for place, material in enumerate(listed):
        if not isinstance(material, Material):
            raise ArgumentError(f"materials: number {place} is a {type(material).__name__}; give a Material")
    if not listed:
        raise ArgumentError("materials: the list is empty; give at least one Material")
    return listed


def _name(name: object) -> str:
    if not isinstance(name, str) or not name:
        raise ArgumentError(f'name of a material is {described(name)}; give a text such as "bone"')
    check_text(name, "name of a material")
    return name


def _curve(name: str, nodes: Iterable[Iterable[float]]) -> tuple[tuple[float, float], ...]:
    if not isinstance(nodes, Iterable):
        raise ArgumentError(f"material {name!r}: probability is {described(nodes)}; it must be nodes (value, p)")
    checked: list[tuple[float, float]] = []
    for index, node in enumerate(nodes):
        what = f"material {name!r}: probability node {index}"
        value, p = numbers(node, what, "2 numbers (value, p)", n=2, finite=False)
        if not math.isfinite(value) or not 0.0 <= p <= 1.0:
            raise ArgumentError(
                f"{what} is {described(node, lists=True)}; give a finite value, and a probability between 0 and 1"
            )
        if checked and value < checked[-1][0]:
            raise ArgumentError(
                f"material {name!r}: the value {value:g} of probability node {index} is below that of the node "
                f"before, {checked[-1][0]:g}; sort the nodes by value"
            )
        checked.append((value, p))
    if not checked:
        raise ArgumentError(f"material {name!r}: the probability curve has no node; give at least one (value, p)")
    return tuple(checked)


def _color(name: str, color: str | Iterable[float]) -> tuple[float, float, float]:
    try:
        rgba = colors.parse(color if isinstance(color, str) else tuple(color))
    except (ArgumentError, TypeError):
        rgba = None
    if rgba is None or rgba[3] != 1.0:
        raise ArgumentError(
            f'material {name!r}: color is {described(color)}; give (r, g, b) with numbers 0..1, "#rrggbb", black, '
            "white or grey, and how much it hides as opacity"
        )
    return rgba[:3]
