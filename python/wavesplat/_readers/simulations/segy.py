"""SEG-Y: a cube of seismic traces, by inline, crossline and sample, by segyio.

The traces go down: z of the world is minus the time, or depth, of a sample; x and y are the place of the trace.
Each trace says its inline and crossline, so a survey may have gaps and any outline: there samples are NaN.
Format: SEG-Y revision 2.1, https://library.seg.org/pb-assets/technical-standards.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import UPRIGHT
from wavesplat._readers.request import Grid, Request
from wavesplat._storage import size_checks
from wavesplat._storage.reading import reading
from wavesplat._system.libraries import library
from wavesplat.errors import FileError

EXTRA = "segy"
#: Bytes of a header of traces: inline and crossline, distance of source and receiver, place, and the scale of places.
INLINE, CROSSLINE, OFFSET, X, Y, SCALE = 189, 193, 37, 181, 185, 71
#: Place of the code of the samples' type in a file, and codes that segyio reads; it takes others for IBM's floats.
FORMAT_AT, FORMATS = 3224, (1, 2, 3, 5, 6, 8, 9, 10, 11, 12, 16)
MAX_FORMATS = 16
#: Code of the measurement system -> its unit of length.
SYSTEMS = {1: "m", 2: "foot"}
#: Traces of a regular survey are off by at most this fraction of a step.
TOLERANCE = 0.5
#: Parts of steps below this fraction of the shortest are errors of the fit.
ROUNDING = 1e-9
#: A grid of inlines and crosslines with fewer traces than this share is taken for numbers that mean something else.
MIN_SHARE = 0.05


class _Axis(NamedTuple):
    """Numbers of inlines, or of crosslines: the first, the step, how many there are, and which one each trace has."""

    first: int
    step: int
    n: int
    of_trace: NDArray[np.intp]


def read(request: Request) -> Grid:
    """The cube of a file: z is the sample, y the inline, x the crossline; each grows."""
    segyio = library("segyio", extra=EXTRA)
    path = request.file
    with reading("SEG-Y", path):
        try:
            opened = segyio.open(str(path), "r", ignore_geometry=True, endian=_byte_order(path))
        except IndexError as error:
            raise FileError(f"the file has headers and no traces; copy or export it again: {path}") from error
        except (RuntimeError, ValueError) as error:
            raise FileError(
                "the traces do not fill the file: they differ in length, have longer headers of revision 2.1, or the "
                f"file is truncated; write it with traces of one length, or copy it again: {path}"
            ) from error
        with opened as file:
            inlines, crosslines = _axes(file, request)
            n_samples = len(file.samples)
            shape = (n_samples, inlines.n, crosslines.n)
            size_checks.check_memory(2 * size_checks.n_bytes(shape, np.dtype("f4")), path)
            step = float(np.diff(file.samples).mean()) if n_samples > 1 else 1.0
            first = float(file.samples[0])
            steps, guesses, own = _steps(segyio, file, inlines, crosslines)
            cube, missing = _cube(file.trace.raw[:], inlines, crosslines)
    matrix = np.eye(4)
    matrix[:3, :2], matrix[:3, 3] = steps[:, :2], steps[:, 2]
    matrix[2, 2], matrix[2, 3] = -step, -first
    unit, factor = units.of_file(own)
    matrix[:3] *= factor
    way = f"1 of them drawn as 1 {own or 'unit of x and y'}, downwards"
    length = own or "m"
    guesses = (
        f"samples are {step:g} ms apart, or {length} if traces are in depth, which the file does not say: {way}",
        *guesses,
    )
    return Grid(cube, matrix, Facts(unit=unit, conventions=(UPRIGHT,), guesses=guesses + missing))


def _byte_order(path: Path) -> Literal["big", "little"]:
    """The order in which the code of the samples' type is one: big in most files, little in some of revision 2."""
    with path.open("rb") as file:
        file.seek(FORMAT_AT)
        code = file.read(2)
    orders: tuple[Literal["big", "little"], ...] = ("big", "little")
    for order in orders:
        if 1 <= (number := int.from_bytes(code, order)) <= MAX_FORMATS:
            if number not in FORMATS:
                raise FileError(
                    f"its samples are of format {number}, which segyio does not read; write them as IEEE floats "
                    f"(format 5): {path}"
                )
            return order
    raise FileError(f"the header has no known format of samples, so this is no SEG-Y file, or damaged: {path}")


def _axes(file: Any, request: Request) -> tuple[_Axis, _Axis]:
    """Inlines and crosslines, or a `FileError` where traces do not say them, or several say the same."""
    numbers = [np.asarray(file.attributes(field)[:], np.int64) for field in (INLINE, CROSSLINE)]
    inlines, crosslines = (_axis(one) for one in numbers)
    n_traces, n_places = len(numbers[0]), inlines.n * crosslines.n
    if n_traces > 1 and n_places < n_traces:
        n_offsets = len(np.unique(file.attributes(OFFSET)[:]))
        if n_places > 1 and n_offsets > 1:
            raise FileError(
                f"{n_traces} traces have {n_places} places and {n_offsets} offsets; stack them first, as with "
                f"wavesplat.Volume(segyio.tools.cube(path).mean(axis=2).transpose(2, 0, 1)): {request.path}"
            )
        raise FileError(
            f"{n_traces} traces have {inlines.n} x {crosslines.n} numbers of inlines (byte 189) and crosslines (byte "
            "193), so they are a line, a gather or have the numbers elsewhere; give their cube, as segyio.open(path, "
            f"iline=BYTE, xline=BYTE) finds it, to wavesplat.Volume: {request.path}"
        )
    if n_traces < MIN_SHARE * n_places:
        raise FileError(
            f"{n_traces} traces are scattered over {inlines.n} inlines (byte 189) and {crosslines.n} crosslines (byte "
            "193), so the numbers are elsewhere; give their cube, as segyio.open(path, iline=BYTE, xline=BYTE) finds "
            f"it, to wavesplat.Volume: {request.path}"
        )
    places = inlines.of_trace * crosslines.n + crosslines.of_trace
    if len(np.unique(places)) < n_traces:
        raise FileError(
            f"{n_traces - len(np.unique(places))} traces have the inline and crossline of another one; stack or drop "
            f"them first: {request.path}"
        )
    return inlines, crosslines


def _axis(numbers: NDArray[np.int64]) -> _Axis:
    there = np.unique(numbers)
    step = int(np.gcd.reduce(np.diff(there))) if len(there) > 1 else 1
    first = int(there[0])
    return _Axis(first, step, (int(there[-1]) - first) // step + 1, ((numbers - first) // step).astype(np.intp))


def _cube(traces: NDArray[Any], inlines: _Axis, crosslines: _Axis) -> tuple[NDArray[Any], tuple[str, ...]]:
    """The samples [sample, inline, crossline], NaN where there is no trace, and a sentence on that."""
    shape = (traces.shape[1], inlines.n, crosslines.n)
    n_places = inlines.n * crosslines.n
    guesses: tuple[str, ...] = ()
    if len(traces) == n_places:
        cube = np.empty(shape, traces.dtype)
    else:
        cube = np.full(shape, np.nan, np.result_type(traces.dtype, np.float32))
        guesses = (f"{n_places - len(traces)} of {n_places} places have no trace, and nothing is drawn there",)
    cube[:, inlines.of_trace, crosslines.of_trace] = traces.T
    return cube, guesses


def _steps(
    segyio: Any, file: Any, inlines: _Axis, crosslines: _Axis
) -> tuple[NDArray[np.float64], tuple[str, ...], str | None]:
    """Steps [x, y, z] from crossline to crossline and from inline to inline, and the first place, each a column."""
    scale = np.asarray(file.attributes(SCALE)[:], np.float64)
    scale[scale == 0] = 1.0
    factor = np.where(scale < 0, 1 / np.abs(scale), scale)
    places = np.stack([np.asarray(file.attributes(field)[:], np.float64) * factor for field in (X, Y)], axis=1)
    known = places.any(axis=1)  # dead traces have no place
    if inlines.n > 1 and crosslines.n > 1 and known.any():
        numbers = np.stack([crosslines.of_trace, inlines.of_trace, np.ones(len(places))], axis=1)[known]
        middle = places[known].mean(axis=0)  # coordinates of maps are large numbers
        found, _, rank, _ = np.linalg.lstsq(numbers, places[known] - middle, rcond=None)
        off = np.linalg.norm(numbers @ found + middle - places[known], axis=1).max()
        found[2] += middle
        shortest = np.linalg.norm(found[:2], axis=1).min()
        found[np.abs(found) < ROUNDING * shortest] = 0.0  # axes of the world stay such
        area = abs(found[0, 0] * found[1, 1] - found[0, 1] * found[1, 0])
        if rank == 3 and area > 0 and off <= TOLERANCE * shortest:
            system = int(file.bin[segyio.BinField.MeasurementSystem])
            columns = np.concatenate([found.T, np.zeros((1, 3))])
            unknown = f"distances of traces: the file's measurement system, {system}, is unknown; 1 is m, 2 is feet"
            return columns, () if system in (0, *SYSTEMS) else (unknown,), SYSTEMS.get(system)
    guesses = ("distance of inlines and crosslines 1: the traces have no places (CDP X and Y) on a regular grid",)
    return np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 0]]), guesses, None
