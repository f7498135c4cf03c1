"""Materials: what a sample value may be made of, and the mixture as a transfer function.

Each material claims sample values by a piecewise-linear curve of probabilities; curves may overlap.
Claims that sum to more than 1 are scaled to 1, and give the material percentages p_i of a value; what no material
claims is clear.
The mixture's associated colour is sum p_i alpha_i rgb_i, its opacity sum p_i alpha_i.
Source: Drebin, Carpenter and Hanrahan, Volume Rendering, SIGGRAPH 1988.
There the percentages are a volume of their own; here they are a function of the reconstructed value, as all colour is.
`curves` makes nodes of it.

With p_i(v) the share of material i in a sample of value v and rho_i its number (`Material.density`), the strength of a
surface is the gradient of D(v) = sum p_i rho_i. D depends on the place through the value alone, so that

    S = |grad D| = |D'(v)| |grad v|

Source: Drebin, Carpenter and Hanrahan, Volume Rendering, SIGGRAPH 1988, section 4. There S scales what a surface
reflects; here it scales the opacity, so that the inside of materials recedes and their boundaries stay:

    alpha(v, |grad v|) = alpha(v) ((1 - share) + share min(1, thickness S))
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat._looks.curves import colors
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._model.arguments.types import check_text, takes_its_types
from wavesplat._model.volume.volume_like import VolumeLike, as_volume
from wavesplat._public import public
from wavesplat._system.values import described, number, numbers, share
from wavesplat.errors import ArgumentError

# Surfaces between materials: Drebin's surface term, as a function of value and gradient magnitude.

#: Size of the table: columns between the first and the last node, and rows up to the gradient of complete surfaces.
N_VALUES = 256
N_MAGNITUDES = 48
#: Least slope of a boundary, as a share of the steepest one's.
FLAT = 1e-3
#: Largest change of D from column to column that is rounding.
ROUNDING = 1e-9


def surfaces(materials: Materials, share: float, thickness: float) -> TransferFunction2D:
    """See `Materials.surfaces`."""
    if not 0 <= share <= 1:
        raise ArgumentError(f"materials: the share of the surfaces is {share!r}; give a number 0..1")
    if not (np.isfinite(thickness) and thickness > 0):
        raise ArgumentError(f"materials: the thickness of surfaces is {thickness!r}; give a positive number")
    nodes = [value for material in materials.materials for value, _ in material.probability]
    lo, hi = min(nodes), max(nodes)
    # Beyond the last node nothing changes any more, which one more column shows.
    margin = (hi - lo) / N_VALUES or 1.0
    columns = np.unique([lo - margin, *np.linspace(lo, hi, N_VALUES), *nodes, hi + margin])
    mixture = materials.transfer_function()
    rgba = mixture(columns)
    densities = np.array([material.density for material in materials.materials], dtype=np.float64)
    numbers = materials.percentages(columns) @ densities
    slope = np.abs(np.gradient(numbers, columns))
    if slope.max() * margin < ROUNDING:
        raise ArgumentError("materials: none of them has a boundary with another; their densities or curves are equal")
    # The strength of every column grows with the magnitude up to one of these, and is constant beyond.
    complete = 1 / (thickness * slope[slope > FLAT * slope.max()])
    rows = np.unique([0.0, *np.quantile(complete, np.linspace(0, 1, N_MAGNITUDES))])
    strength = np.minimum(1.0, thickness * slope * rows[:, None])
    table = np.repeat(rgba[None], len(rows), axis=0)
    table[:, :, 3] *= (1 - share) + share * strength
    return TransferFunction2D(columns.tolist(), rows.tolist(), table, mixture.opacity_unit)


# The mixture of materials as piecewise-linear curves of opacity and colour.
#
# Between two nodes, opacity and colour of the mixture are quotients of linear functions, N(t) / D(t): of the sum of the
# claims where it exceeds 1, and of the opacity.
# Such a curve is A + B / D.
# A chord over a stretch where D grows from d by a factor q is wrong by |B| (1/d - 1/(q d)) (r - 1) / (r + 1) at most,
# with r = sqrt(q), so nodes at equal factors of D make the error of the associated colour the same on all stretches.

Array = NDArray[np.float64]

#: Largest error of the transfer function's colour, and of its opacity: together they stay below 1e-3.
TOLERANCE = 5e-4


def curves(values: Array, totals: Array, parts: Array) -> tuple[list[tuple[float, float]], list[tuple[float, ...]]]:
    """Nodes (value, opacity) and (value, red, green, blue) of a mixture, exact to `TOLERANCE` between them.

    values : in order; where the claims jump, twice, for what is below and above.
    totals : sum of the claims at each.
    parts : sum of the claims times opacity times (red, green, blue, 1) at each, shape (n, 4).
    """
    opacity: list[tuple[float, float]] = []
    color: list[tuple[float, ...]] = []
    points = _points(values, totals, parts)
    # A single point stands for itself.
    for start, end in zip(points, [*points[1:], points[-1]], strict=True):
        opacity += _opacity_nodes(start, end)
        color += _color_nodes(start, end)
    # Where everything is clear any colour will do; black adds nothing.
    return _once(opacity), _once(color) or [(points[0].value, 0.0, 0.0, 0.0)]


def _points(values: Array, totals: Array, parts: Array) -> list[_Point]:
    """The mixture at every value, and where the claims begin to exceed 1."""
    points: list[_Point] = []
    for value, total, part in zip(values, totals, parts, strict=True):
        if points and (share := _crossing(points[-1].total, total)) is not None:
            before = points[-1]
            crossing = before.value + share * (value - before.value)
            points.append(_Point(crossing, 1.0, before.part + share * (part - before.part)))
        points.append(_Point(float(value), float(total), part))
    return [_Point(value, max(total, 1.0), part) for value, total, part in points]


class _Point(NamedTuple):
    """The mixture at a value, before it is divided by the claims' sum: linear from point to point."""

    value: float
    total: float
    part: NDArray[np.float64]
    """Associated red, green, blue, and opacity."""

    @property
    def opacity(self) -> float:
        return min(float(self.part[3]) / self.total, 1.0)

    @property
    def color(self) -> NDArray[np.float64]:
        clipped: NDArray[np.float64] = np.clip(self.part[:3] / self.part[3], 0.0, 1.0)
        return clipped


def _opacity_nodes(start: _Point, end: _Point) -> list[tuple[float, float]]:
    """Nodes of the opacity curve between two points: relative errors count, since thin fog adds up."""
    change = abs(end.opacity - start.opacity)
    ratio = max(start.total, end.total) / min(start.total, end.total)
    tolerance = TOLERANCE * max(start.opacity, end.opacity) / ratio
    points = _between(start, end, (start.total, end.total), change, tolerance)
    return [(point.value, point.opacity) for point in points]


def _color_nodes(start: _Point, end: _Point) -> list[tuple[float, ...]]:
    """Nodes of the colour curve between two points: errors count as much as the opacity shows."""
    least, most = sorted((float(start.part[3]), float(end.part[3])))
    if most == 0.0:
        return []
    if least <= ROUNDING * most:
        # All opacities begin or end here, so their shares, and with them the colour, do not change.
        color = (end if end.part[3] > start.part[3] else start).color
        return [(start.value, *color), (end.value, *color)]
    change = float(np.abs(end.color - start.color).max())
    points = _between(start, end, (float(start.part[3]), float(end.part[3])), change, TOLERANCE / most)
    return [(point.value, *point.color) for point in points]


def _between(
    start: _Point, end: _Point, divisors: tuple[float, float], change: float, tolerance: float
) -> list[_Point]:
    """Both points, and those between them at equal factors of D that keep chords within the tolerance where D is most.

    The quotient changes by `change`, and `divisors` are D at the points; see the head of the file.
    """
    d0, d1 = divisors
    ratio = max(d0, d1) / min(d0, d1)
    pieces = 1
    if change > tolerance and ratio > 1.0 and start.value < end.value:
        while change / (ratio - 1.0) * _bend(ratio ** (1.0 / pieces)) > tolerance:
            pieces += 1
    shares = ((d0 * (d1 / d0) ** (piece / pieces) - d0) / (d1 - d0) for piece in range(1, pieces))
    inner = (_Point(*((1.0 - share) * a + share * b for a, b in zip(start, end, strict=True))) for share in shares)
    return [start, *inner, end]


def _bend(factor: float) -> float:
    """Largest distance of 1 / D from its chord where D grows by `factor` to 1."""
    root = math.sqrt(factor)
    return (factor - 1.0) * (root - 1.0) / (root + 1.0)


def _crossing(before: float, after: float) -> float | None:
    """Place between two points where the sum of the claims passes 1, as a share of the way; None if it does not."""
    apart = min(abs(before - 1.0), abs(after - 1.0)) > ROUNDING
    return (1.0 - before) / (after - before) if apart and (before < 1.0) != (after < 1.0) else None


def _once(nodes: list[Any]) -> list[Any]:
    """The nodes, without those that repeat the one before."""
    return [node for number, node in enumerate(nodes) if number == 0 or node != nodes[number - 1]]


# Materials: what a sample value may be made of, and the mixture as a transfer function.


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
        opacity, color = curves(np.repeat(values, 2), claims.sum(axis=1), claims @ looks)
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
        The surface term of Drebin, Carpenter and Hanrahan (1988): with S the magnitude of the gradient of the mixture's
        density, opacity times 1 - share + share min(1, thickness S).
        """
        return surfaces(self, share, thickness)

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
        from wavesplat._looks.curves import materials_json

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
        from wavesplat._looks.curves import materials_fit

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
        from wavesplat._looks.curves import materials_json

        return materials_json.parse(text)

    def to_json(self) -> str:
        """The materials as a JSON text, which `from_json` reads back exactly."""
        from wavesplat._looks.curves import materials_json

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
        from wavesplat._looks.curves import materials_json

        return materials_json.load(path)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the materials to a JSON file.

        Raises
        ------
        FileError
            If the file cannot be written; nothing is left behind.
        """
        from wavesplat._storage import json_texts

        json_texts.save(path, self.to_json())

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
