"""Files of a single plane, such as a picture of a microscope or one slice: no volume, but a slice shows them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from wavesplat._readers.request import PLANE_PX, PLANES_ARE_TAKEN, Grid, PictureError, Request

PLANE_NOTE = "a single plane: it is shown as it is, and has no thickness"


def is_single_plane(volume: Any) -> bool:
    """Whether a volume is a plane of its file, as `as_volume` makes it."""
    return PLANE_NOTE in volume.facts.guesses


def shape_in_file(volume: Any) -> tuple[int, ...]:
    """The shape of a volume, of a single plane without the copy of it."""
    shape: tuple[int, ...] = volume.shape
    return tuple(1 if n == min(shape) else n for n in shape) if is_single_plane(volume) else shape


def check_thickness(shape: Sequence[int], request: Request, n_times: int = 1) -> None:
    """Raise a `PictureError` for samples [z, y, x] of a single plane where these are not taken."""
    if len(shape) != 3 or min(shape) != 1 or sorted(shape)[1] < 2 or PLANES_ARE_TAKEN.get():
        return
    z, y, x = shape
    what, way = f"a single plane of x {x}, y {y}, z {z} samples, which fills no space", "`wavesplat slice` shows it"
    if n_times > 1:
        what = f"a film of {n_times} pictures of x {x}, y {y}, z {z} samples, which fill no space"
        way = "`wavesplat movie` shows all of them, `wavesplat slice --time N` one"
    error = PictureError(
        f"the file holds {what}; {way}, and a volume is a file or a folder of several slices: {request.safe_path}"
    )
    error.n_times = n_times
    raise error


def level_of_plane(shapes: Sequence[Sequence[int]], request: Request) -> int | None:
    """The coarsest level of a single plane that has the pixels of its picture, else the finest; None for volumes.

    shapes : of all levels (z, y, x), the finest first. A level that is asked for is that one.
    """
    if request.level is not None or not PLANES_ARE_TAKEN.get() or min(shapes[0]) > 1:
        return None
    return max((number for number, shape in enumerate(shapes) if max(shape) >= PLANE_PX.get()), default=0)


def note_on_level(level: int, n_levels: int) -> str:
    """The note that a coarser level of a plane is shown."""
    return f"level {level} of 0..{n_levels - 1} has the pixels of the picture; --level 0 shows all samples"


def as_volume(grid: Grid, request: Request) -> Grid:
    """The grid itself; of a single plane two equal ones around it where these are taken, else a `FileError`."""
    samples = np.asarray(grid.samples) if np.ndim(grid.samples) == 2 else grid.samples
    shape = (1, *samples.shape) if samples.ndim == 2 else samples.shape
    if len(shape) != 3 or min(shape) != 1 or sorted(shape)[1] < 2:
        return grid
    axis = shape.index(1)
    check_thickness(shape, request, grid.facts.n_times)
    matrix = np.array(grid.world_from_index, np.float64)
    across = 2 - axis
    column = matrix[:3, across]
    if not np.linalg.norm(column) > 0:
        one, other = (matrix[:3, number] for number in range(3) if number != across)
        normal = np.cross(one, other)
        column = normal / np.linalg.norm(normal) * min(np.linalg.norm(one), np.linalg.norm(other))
        matrix[:3, across] = column
    matrix[:3, 3] -= column / 2
    facts = replace(grid.facts, guesses=(*grid.facts.guesses, PLANE_NOTE))
    return grid._replace(samples=np.repeat(np.reshape(samples, shape), 2, axis), world_from_index=matrix, facts=facts)
