"""Points in space, as balls or as discs of one size in pixels."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry import foreign_shapes
from wavesplat._geometry.paint import Color, checked_paint, paint_of
from wavesplat._geometry.positions import checked_positions, checked_size
from wavesplat._geometry.shape import Shape
from wavesplat._model.arguments.types import check_text
from wavesplat._public import public
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat import _native

#: Colour of points without one, and their diameter in pixels.
YELLOW, SIZE_PX = (1.0, 0.9, 0.2), 6.0


@public
@dataclass(frozen=True, eq=False, repr=False)
class Points(Shape):
    """Points in space: spots, cells, electrodes, landmarks.

    Parameters
    ----------
    positions : array, shape (n, 3), or an object that has points
        World positions (x, y, z). Or a layer of points of napari, or a point cloud of PyVista, VTK or trimesh.
    color, values, cmap, clim, quantity, value_unit
        As for `Surface`, with one for each point; a point whose value is NaN is not drawn. None is yellow.
    radius : float or array, shape (n,), optional
        Balls of this radius, world units.
    size : float or array, shape (n,), optional
        Instead of `radius`: discs of this diameter in pixels, at every distance. None of the two is a size of 6.
    labels : sequence of str, optional
        A name for each point, written beside it; an empty one is not.
    opacity, lit, clipped, visible, name
        As for `Surface`.

    Raises
    ------
    ArgumentError
        If an argument cannot work; the message names it, the row, and how to mend it.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Points([(0, 0, 0), (10, 0, 5)], radius=2, color="red", labels=["A1", "A2"], name="electrodes")
    <Points 'electrodes': 2>
    """

    KIND: ClassVar[str] = "points"
    OF_FILE: ClassVar[frozenset[str]] = frozenset({"positions", "values"})

    positions: Any
    _: KW_ONLY
    color: Color = None
    values: Any = None
    cmap: str | None = None
    clim: Any = None
    quantity: str | None = None
    value_unit: str | None = None
    radius: Any = None
    size: Any = None
    labels: Any = None
    opacity: float = 1.0
    lit: bool = True
    clipped: bool = False
    visible: bool = True
    name: str | None = None

    def __post_init__(self) -> None:
        self._take(foreign_shapes.points_of(self.positions, self.values))
        self._check_style()
        positions = checked_positions(self.positions, f"positions of {self._title}", "point")
        n = len(positions)
        color, values, cmap, clim = checked_paint(
            self.color, self.values, self.cmap, self.clim, n=n, what=self._title, each="point"
        )
        if self.radius is not None and self.size is not None:
            raise ArgumentError(
                f"radius and size of {self._title} both say how large they are; give the radius in world units, or the "
                "size in pixels"
            )
        for name in ("radius", "size"):
            if (given := getattr(self, name)) is not None:
                self._set(**{name: checked_size(given, n, f"{name} of {self._title}")})
        labels = None if self.labels is None else _labels(self.labels, n, self._title)
        self._set(positions=positions, color=color, values=values, cmap=cmap, clim=clim, labels=labels)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Corners (lower, upper) of the world box around them, shape (2, 3), as (x, y, z)."""
        reach = 0.0 if self.radius is None else np.reshape(self.radius, (-1, 1))
        positions: NDArray[np.float64] = self.positions
        return np.stack([(positions - reach).min(axis=0), (positions + reach).max(axis=0)])

    @property
    def _positions(self) -> NDArray[np.float64]:
        positions: NDArray[np.float64] = self.positions
        return positions

    def _arrays(self) -> _native.PointArrays:
        """The points as the compiled module takes them."""
        n = len(self.positions)
        paint, opacity = paint_of(self.color, self._mapped, self.opacity, YELLOW)
        given = SIZE_PX if self.size is None else self.size
        sizes = np.broadcast_to(np.asarray(given if self.radius is None else self.radius, np.float64), n).copy()
        return {
            "centers": self.positions,
            "radii": None if self.radius is None else sizes,
            "diameters_px": sizes if self.radius is None else None,
            "paint": paint,
            "style": (opacity, self.lit, self.clipped),
        }

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"<Points{name}: {len(self.positions)}>"


def _labels(given: Any, n: int, title: str) -> tuple[str, ...]:
    """Checked names, "" for none."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise ArgumentError(f"labels of {title} is {described(given)}; give a name for each of the {n} points")
    labels = tuple("" if label is None else str(label) for label in given)
    if len(labels) != n:
        raise ArgumentError(f"labels of {title} has {len(labels)} names, and there are {n} points; give one for each")
    for row, label in enumerate(labels):
        check_text(label, f"labels[{row}] of {title}")
        if not label.isprintable():
            raise ArgumentError(f"labels[{row}] of {title} is {described(label)}; give letters that can be printed")
    return labels
