"""A picture on the screen, and as a figure of matplotlib."""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

from wavesplat._files.libraries import library
from wavesplat._model import units
from wavesplat.errors import LibraryError

if TYPE_CHECKING:
    from wavesplat._picture.picture import Picture

#: Pixels per inch of matplotlib's figures where a picture does not have its own.
DPI = 100.0


def show(picture: Picture) -> None:
    """Show a picture below the cell of a notebook, or in the system's viewer."""
    interactive = sys.modules.get("IPython")
    shell = interactive.get_ipython() if interactive else None
    if shell is not None and hasattr(shell, "kernel"):
        import_module("IPython.display").display(picture)
        return
    from PIL import ImageShow

    if not ImageShow.show(picture.to_pil(), title="wavesplat"):
        raise LibraryError('this system has no viewer of pictures; write a file with picture.save("picture.png")')


def figure(picture: Picture) -> Any:
    """A figure as large as the picture, with axes around it."""
    library("matplotlib", extra="figure")
    from matplotlib.figure import Figure

    width, height = picture.size
    made = Figure(figsize=(width / DPI + 1, height / DPI + 1), dpi=DPI, layout="constrained")
    axes = made.add_subplot()
    if picture.pixel is None:
        axes.imshow(picture)
        axes.set_axis_off()
        return made
    across, left, right = _axis(picture, "right", width)
    along, top, bottom = _axis(picture, "down", height)
    axes.imshow(picture, extent=(left, right, bottom, top))
    unit = f" ({units.written(picture.unit)})" if picture.unit else ""
    axes.set_xlabel(across + unit)
    axes.set_ylabel(along + unit)
    return made


def _axis(picture: Picture, way: str, n_px: int) -> tuple[str, float, float]:
    """The label of an axis of the picture, and the coordinates of its first and last edge."""
    report, pixel = picture.report, picture.pixel or 1.0
    direction, origin = report.get(way), report.get("origin")
    if direction is not None and origin is not None:
        for name, share, place in zip("xyz", direction, origin, strict=True):
            if abs(share) == 1:
                first = place - share * pixel / 2
                return name, first, first + share * n_px * pixel
    half = n_px * pixel / 2
    return ("right", -half, half) if way == "right" else ("up", half, -half)
