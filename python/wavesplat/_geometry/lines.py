"""Lines through points of space."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry import foreign_shapes
from wavesplat._geometry.paint import Color, checked_paint, paint_of
from wavesplat._geometry.positions import Chains, chains_of, checked_size
from wavesplat._geometry.shape import Shape
from wavesplat._public import public
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat import _native

#: Colour of lines without one, and their width in pixels.
AMBER, WIDTH_PX = (1.0, 0.75, 0.2), 2.0
#: Colour that says the direction: red from left to right, green from back to front, blue from below.
BY_DIRECTION = "direction"


@public
@dataclass(frozen=True, eq=False, repr=False)
class Lines(Shape):
    """Lines through points of space: tracts, tracks, streamlines, contours.

    Parameters
    ----------
    paths : array, shape (n, 3), several of them in a list, or an object that has lines
        World positions (x, y, z) along each line. Or streamlines or a tractogram of nibabel, a mesh of PyVista or VTK
        with lines, or a layer of tracks or shapes of napari.
    color : colour, "direction" or array, optional
        Of all; one for each position of all paths, shape (n, 3) or (n, 4); or one for each path. "direction" is the
        convention of tractography: red along x, green along y, blue along z. None is amber.
    values : array, optional
        Instead of `color`: a value for each position of all paths, one after the other, or for each path, coloured by
        `cmap`; where it is NaN nothing is drawn. Of a mesh of PyVista also the name of one of its arrays.
    cmap, clim, quantity, value_unit
        As for `Surface`.
    radius : float, optional
        Tubes of this radius, world units: their thickness depends on the distance.
    width : float, optional
        Instead of `radius`: strokes of this width in pixels, everywhere. None of the two is a width of 2.
    opacity, lit, clipped, visible, name
        As for `Surface`.

    Raises
    ------
    ArgumentError
        If an argument cannot work; the message names it, the path, and how to mend it.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> t = np.linspace(0, 6, 50)
    >>> ws.Lines(np.stack([np.cos(t), np.sin(t), t], axis=1), values=t, radius=0.05, name="helix")
    <Lines 'helix': 1 path, 50 positions>
    """

    KIND: ClassVar[str] = "lines"
    OF_FILE: ClassVar[frozenset[str]] = frozenset({"paths", "values"})

    paths: Any
    _: KW_ONLY
    color: Color = None
    values: Any = None
    cmap: str | None = None
    clim: Any = None
    quantity: str | None = None
    value_unit: str | None = None
    radius: float | None = None
    width: float | None = None
    opacity: float = 1.0
    lit: bool = True
    clipped: bool = False
    visible: bool = True
    name: str | None = None

    def __post_init__(self) -> None:
        self._take(foreign_shapes.lines_of(self.paths, self.values))
        self._check_style()
        chains = chains_of(self.paths, f"paths of {self._title}")
        n = len(chains.positions)
        is_by_direction = isinstance(self.color, str) and self.color == BY_DIRECTION
        given = None if is_by_direction else _on_positions(self.color, chains, 2)
        values = _on_positions(self.values, chains, 1)
        if is_by_direction and values is not None:
            raise ArgumentError(f"color and values of {self._title} both say its colours; give one of them")
        color, values, cmap, clim = checked_paint(
            given, values, self.cmap, self.clim, n=n, what=self._title, each="position"
        )
        if self.radius is not None and self.width is not None:
            raise ArgumentError(
                f"radius and width of {self._title} both say how thick it is; give the radius in world units, or the "
                "width in pixels"
            )
        for name in ("radius", "width"):
            if (size := getattr(self, name)) is not None:
                self._set(**{name: _number(size, f"{name} of {self._title}")})
        kept = BY_DIRECTION if is_by_direction else color
        self._set(paths=chains, color=kept, values=values, cmap=cmap, clim=clim)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Corners (lower, upper) of the world box around it, shape (2, 3), as (x, y, z)."""
        seen, reach = self._positions, self.radius or 0.0
        return np.stack([seen.min(axis=0) - reach, seen.max(axis=0) + reach])

    @property
    def _positions(self) -> NDArray[np.float64]:
        positions: NDArray[np.float64] = self.paths.positions
        return positions

    def _arrays(self) -> _native.PathArrays:
        """The lines as the compiled module takes them."""
        chains: Chains = self.paths
        color = self.color
        if isinstance(color, str):
            color = np.ones((len(chains.positions), 4), np.float32)
            color[:, :3] = np.abs(chains.directions())
            np.minimum(color, 1, out=color)
        paint, opacity = paint_of(color, self._mapped, self.opacity, AMBER)
        return {
            "positions": chains.positions,
            "starts": chains.starts,
            "radius": self.radius,
            "width_px": None if self.radius is not None else (self.width or WIDTH_PX),
            "paint": paint,
            "style": (opacity, self.lit, self.clipped),
        }

    def __repr__(self) -> str:
        name, n = f" {self.name!r}" if self.name else "", len(self.paths)
        return f"<Lines{name}: {n} path{'s' if n != 1 else ''}, {len(self.paths.positions)} positions>"


def _on_positions(given: Any, chains: Chains, ndim: int) -> Any:
    """Values or colours for each position, where they are given for each position or path; others as they are.

    ndim : 1 of values, 2 of colours.
    """
    if given is None or isinstance(given, str):
        return given
    if isinstance(given, list | tuple) and len(given) == len(chains) and all(np.ndim(part) == ndim for part in given):
        return np.concatenate([np.asarray(part) for part in given])
    try:
        array = np.asarray(given)
    except ValueError:
        return given
    if array.ndim == ndim and len(array) == len(chains) != len(chains.positions):
        return np.repeat(array, chains.lengths, axis=0)
    return given


def _number(size: Any, what: str) -> float:
    checked = checked_size(size, 1, what)
    if not isinstance(checked, float):
        raise ArgumentError(f"{what} is {described(size)}; give one positive number for all paths")
    return checked
