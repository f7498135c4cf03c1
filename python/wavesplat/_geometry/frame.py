"""A box around what is shown, with ticks and numbers along its edges."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from itertools import product
from math import ceil, floor, log10
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.paint import checked_color, paint_of
from wavesplat._geometry.positions import checked_size, numbers_of
from wavesplat._geometry.shape import Shape
from wavesplat._public import public
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat import _native
    from wavesplat._model.camera.camera import Camera

#: Lower and upper corner of a box along the world's axes.
Box: TypeAlias = NDArray[np.float64]

#: Colour of a frame without one, which shows on black and on white.
GREY = (0.55, 0.55, 0.55)
#: Width of grid lines as a share of the width of edges, and opacity of grid lines.
GRID_WIDTH, GRID_OPACITY = 0.6, 0.5
#: Number of steps between ticks along an axis, about.
N_STEPS = 5
#: Lengths of steps that are round, in powers of ten.
ROUND = (1.0, 2.0, 5.0, 10.0)


@public
@dataclass(frozen=True, eq=False, repr=False)
class Frame(Shape):
    """A box with ticks, numbers and titles along its edges, in world units.

    Its edges stand in space: matter hides them. Numbers and titles are written over the picture, along the edges at its
    rim.

    Parameters
    ----------
    box : (lower, upper), optional
        Corners of the box, world positions (x, y, z); None is the box of the scene's first volume.
    ticks : bool, default True
        Ticks at round places, with numbers and the names of the axes: x, y, z or, of a patient, R, A, S.
    units : bool, default True
        The unit of the world's lengths behind the names of the axes, where a file names one.
    grid : bool, default False
        Lines through the ticks on the three sides that lie behind the volume.
    color : colour, optional
        Of edges and grid; None is grey.
    width : float, default 1.5
        Of the edges, pixels.
    opacity : float, 0..1, default 1
        Of edges and grid.
    visible : bool, default True
        Whether it is drawn; a hidden one stays in the scene.
    name : str, optional
        What messages call it.

    Raises
    ------
    ArgumentError
        If an argument cannot work.

    Examples
    --------
    >>> import wavesplat as ws
    >>> scene = ws.Scene(ws.examples.ct_pelvis(), "ct-bone", geometry=[ws.Frame(grid=True)])
    >>> scene.render(size=(64, 64)).report["geometry"]
    [{'kind': 'frame', 'name': None, 'count': 1}]
    """

    KIND: ClassVar[str] = "frame"

    box: Any = None
    _: KW_ONLY
    ticks: bool = True
    units: bool = True
    grid: bool = False
    color: Any = None
    width: float = 1.5
    opacity: float = 1.0
    visible: bool = True
    name: str | None = None

    def __post_init__(self) -> None:
        self._check_style()
        for switch in ("ticks", "units", "grid"):
            if not isinstance(getattr(self, switch), bool):
                given = described(getattr(self, switch))
                raise ArgumentError(f"{switch} of {self._title} is {given}; give True or False")
        if self.box is not None:
            self._set(box=_checked_box(self.box, self._title))
        if self.color is not None:
            self._set(color=checked_color(self.color, 1, f"color of {self._title}", "frame"))
        self._set(width=checked_size(self.width, 1, f"width of {self._title}"))

    def _around(self, bounds: Box) -> Box:
        """The box: that given, else the one around the volume."""
        if self.box is None:
            return bounds
        return np.array(self.box)

    def _arrays(self, bounds: Box, far: tuple[bool, bool, bool]) -> list[_native.PathArrays]:
        """Edges, and grid lines, as the compiled module takes them.

        bounds : box of the scene's first volume. far : for x, y, z whether the upper side of the box lies behind it.
        """
        box = self._around(bounds)
        made = [self._lines(_edges(box), self.width, self.opacity)]
        if self.grid:
            segments = _grid(box, far)
            if segments:
                made.append(self._lines(segments, GRID_WIDTH * self.width, GRID_OPACITY * self.opacity))
        return made

    def _lines(self, segments: list[Any], width: float, opacity: float) -> _native.PathArrays:
        paint, alpha = paint_of(self.color, None, opacity, GREY)
        return {
            "positions": np.array(segments, np.float64).reshape(-1, 3),
            "starts": np.arange(0, 2 * len(segments) + 1, 2, dtype=np.uint32),
            "radius": None,
            "width_px": width,
            "paint": paint,
            "style": (alpha, False, False),
        }

    def __repr__(self) -> str:
        return f"<Frame{'' if self.name is None else f' {self.name!r}'}>"


def ticks_of(low: float, high: float) -> list[float]:
    """Round places from `low` to `high`, about `N_STEPS` steps apart."""
    if not high > low:
        return []
    wanted = (high - low) / N_STEPS
    power = 10.0 ** floor(log10(wanted))
    step = power * min(ROUND, key=lambda length: abs(length - wanted / power))
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    return [float(f"{number * step:.12g}") for number in range(first, last + 1)]


def far_sides(camera: Camera, box: Box) -> tuple[bool, bool, bool]:
    """For x, y, z whether the upper side of a box, and not the lower one, lies behind it, as the camera sees it."""
    if camera.view_angle is None:
        ahead = np.subtract(camera.focal_point, camera.position)
    else:
        ahead = box.mean(axis=0) - camera.position
    x, y, z = (bool(part > 0) for part in ahead)
    return x, y, z


def _edges(box: Box) -> list[Any]:
    """The twelve edges of a box, two ends each."""
    found = []
    for axis in range(3):
        for corner in product((0, 1), repeat=2):
            ends = np.empty((2, 3))
            others = [other for other in range(3) if other != axis]
            ends[:, axis] = box[:, axis]
            ends[:, others] = [box[corner[0], others[0]], box[corner[1], others[1]]]
            found.append(ends)
    return found


def _grid(box: Box, far: tuple[bool, bool, bool]) -> list[Any]:
    """Lines through the ticks, on the sides of a box that lie behind it, two ends each."""
    found = []
    for side in range(3):  # the axis across the side
        place = box[1 if far[side] else 0, side]
        for across in (other for other in range(3) if other != side):
            along = 3 - side - across
            for tick in ticks_of(*box[:, across]):
                ends = np.empty((2, 3))
                ends[:, side], ends[:, across], ends[:, along] = place, tick, box[:, along]
                found.append(ends)
    return found


def _checked_box(given: Any, title: str) -> Box:
    form = "(lower, upper), two world positions (x, y, z), each number of the second larger"
    box = numbers_of(given, f"box of {title}", form)
    if box.shape != (2, 3) or not np.isfinite(box).all() or not (box[0] < box[1]).all():
        raise ArgumentError(f"box of {title} is {described(given, lists=True)}; give {form}")
    return box
