"""SEG-Y: a cube of seismic traces, by inline, crossline and sample, by segyio.

The traces go down: z of the world is minus the time, or depth, of a sample, and x and y those of the traces.
Format: SEG-Y revision 2.1, https://library.seg.org/pb-assets/technical-standards.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import size_checks
from wavesplat._files.libraries import library
from wavesplat._files.reading import reading
from wavesplat._model.facts import Facts
from wavesplat._readers.request import Grid, Request
from wavesplat.errors import FileError

__all__ = ["read"]

EXTRA = "segy"
#: Code of the unit of coordinates that is a length, not an angle (CoordinateUnits, bytes 89 and 90 of a trace).
LENGTH = 1
#: Traces at the four corners of a regular survey are off by at most this fraction of a step.
TOLERANCE = 0.5


def read(request: Request) -> Grid:
    """The cube of a file: z is the sample, y the inline, x the crossline."""
    segyio = library("segyio", extra=EXTRA)
    path = request.file
    with reading("SEG-Y", path):
        try:
            opened = segyio.open(str(path), "r")
        except (RuntimeError, ValueError) as error:
            raise FileError(
                "the traces are no regular grid of inlines (byte 189) and crosslines (byte 193), or are damaged; "
                f"give their cube, as segyio.open(path, iline=, xline=) finds it, to wavesplat.Volume: {path}"
            ) from error
        with opened as file:
            n_inlines, n_crosslines, n_samples = len(file.ilines), len(file.xlines), len(file.samples)
            shape = (n_inlines, n_crosslines, n_samples)
            size_checks.check_stored(shape, np.dtype("u1"), path.stat().st_size, path, held=(1,))
            size_checks.check_memory(2 * size_checks.n_bytes(shape, np.dtype("f4")), path)
            if len(file.offsets) > 1:
                raise FileError(f"the traces have {len(file.offsets)} offsets; stack them first: {path}")
            cube = segyio.tools.cube(file)
            step = float(np.diff(file.samples).mean()) if n_samples > 1 else 1.0
            first = float(file.samples[0])
            steps, told, unit = _steps(segyio, file, shape)
    matrix = np.eye(4)
    matrix[:3, :2], matrix[:3, 3] = steps[:, :2], steps[:, 2]
    matrix[2, 2], matrix[2, 3] = -step, -first
    way = f"1 of them drawn as 1 {unit or 'unit of x and y'}, downwards"
    told = (f"samples are {step:g} ms apart, or m if traces are in depth, which the file does not say: {way}", *told)
    return Grid(np.ascontiguousarray(np.transpose(cube, (2, 0, 1))), matrix, Facts(unit=unit, guesses=told))


def _steps(
    segyio: Any, file: Any, shape: tuple[int, int, int]
) -> tuple[NDArray[np.float64], tuple[str, ...], str | None]:
    """Steps [x, y, z] from crossline to crossline and from inline to inline, and the first place, each a column."""
    n_inlines, n_crosslines, _ = shape
    fast_is_crossline = file.sorting == segyio.TraceSortingFormat.INLINE_SORTING

    def place(inline: int, crossline: int) -> NDArray[np.float64]:
        number = inline * n_crosslines + crossline if fast_is_crossline else crossline * n_inlines + inline
        header = file.header[number]
        x, y = (float(header[key]) for key in (segyio.TraceField.CDP_X, segyio.TraceField.CDP_Y))
        scale = float(header[segyio.TraceField.SourceGroupScalar]) or 1.0
        factor = 1 / -scale if scale < 0 else scale
        return np.array([x * factor, y * factor, 0.0])

    first = place(0, 0)
    along_x = (place(0, n_crosslines - 1) - first) / max(n_crosslines - 1, 1)
    along_y = (place(n_inlines - 1, 0) - first) / max(n_inlines - 1, 1)
    last = first + along_x * (n_crosslines - 1) + along_y * (n_inlines - 1)
    area = abs(along_x[0] * along_y[1] - along_x[1] * along_y[0])
    shortest = min(np.linalg.norm(along_x), np.linalg.norm(along_y))
    off = np.linalg.norm(place(n_inlines - 1, n_crosslines - 1) - last)
    if area > 0 and off <= TOLERANCE * shortest:
        system = int(file.bin[segyio.BinField.MeasurementSystem])
        return np.stack([along_x, along_y, first], axis=1), (), {1: "m", 2: "foot"}.get(system)
    told = ("distance of inlines and crosslines 1: the traces have no places (CDP X and Y) on a regular grid",)
    return np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 0]]), told, None
