"""DICOM: a folder with a series of slices, one of its files, or a file of many frames.

Headers are read by pydicom (`dicom_header`), pixels by it and SimpleITK (`dicom_pixels`); `dicom_stack` puts the frames
in order. Each frame has its own slope and intercept, and the samples are of a type that holds all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import payload
from wavesplat._files.reading import reading
from wavesplat._model import affine
from wavesplat._model.facts import Facts
from wavesplat._readers.dicom_header import Frame, Header, header_of, is_dicom
from wavesplat._readers.dicom_pixels import frames_in
from wavesplat._readers.dicom_stack import N_NAMED, Stack, one_volume, stacked
from wavesplat._readers.request import COLORS, Grid, Request, SeveralError, choose, quiet, several
from wavesplat.errors import ArgumentError, FileError

__all__ = ["read"]

SUFFIXES = (".dcm", ".ima", ".dicom")


def read(request: Request) -> Grid:
    """The volume of a DICOM series."""
    with reading("DICOM", request.path), quiet("pydicom"):
        path = request.file
        if path.is_dir():
            return _read_series(path, request.series, request)
        first = header_of(path)
        if first is None:
            raise FileError(f"the file is DICOM, but no image; name one of the images: {path}")
        if first.n_frames > 1:
            return _read_headers([first], [], request)
        return _read_series(path.parent, request.series or first.series, request)


def _read_series(folder: Path, uid: str | None, request: Request) -> Grid:
    headers, unreadable = _scanned(folder)
    series: dict[str, list[Header]] = {}
    for header in headers:
        series.setdefault(header.series, []).append(header)
    if not series and unreadable:
        raise FileError(f"{_named(unreadable)}; copy or export them again: {request.path}")
    if not series:
        raise FileError(
            f"the folder holds no DICOM series, no TIFF slices and no Zarr array; name another: {request.path}"
        )
    if uid is None and len(series) > 1:
        message = (
            f"the folder holds {len(series)} series; choose one with series= (--series): "
            f"{_listed(series)}: {request.path}"
        )
        described = [f"{uid} {found[0].description} ({len(found)} files)" for uid, found in series.items()]
        raise several(message, "series", list(series), described)
    uid = next(iter(series)) if uid is None else uid
    if uid not in series:
        raise ArgumentError(f"no series {uid!r}; the folder holds: {_listed(series)}: {request.path}")
    found = list({one.instance_uid or str(one.file): one for one in series[uid]}.values())
    return _read_headers(found, unreadable, request)


def _scanned(folder: Path) -> tuple[list[Header], list[Path]]:
    """Headers of all images in a folder, and the files that should be some but cannot be read."""
    headers, unreadable = [], []
    for file in sorted(entry for entry in folder.iterdir() if entry.is_file()):
        looks_like = file.suffix.lower() in SUFFIXES
        header = _scanned_file(file) if looks_like or _is_dicom(file) else None
        if isinstance(header, Header):
            headers.append(header)
        elif header is not None:
            unreadable.append(file)
    return headers, unreadable


def _scanned_file(file: Path) -> Header | Exception | None:
    # Parsers of damaged files raise nearly anything.
    try:
        return header_of(file)
    except ImportError:
        raise
    except Exception as error:  # noqa: BLE001
        return error


def _is_dicom(file: Path) -> bool:
    try:
        return is_dicom(file)
    except OSError:
        return False


def _listed(series: dict[str, list[Header]]) -> str:
    return ", ".join(f"{uid} ({len(headers)} files)" for uid, headers in series.items())


def _named(files: Sequence[Path]) -> str:
    names = ", ".join(file.name for file in files[:N_NAMED]) + (", ..." if len(files) > N_NAMED else "")
    what = "1 file of the folder is" if len(files) == 1 else f"{len(files)} files of the folder are"
    return f"{what} damaged and cannot be read ({names})"


def _read_headers(headers: Sequence[Header], unreadable: list[Path], request: Request) -> Grid:
    """One volume of the frames of these files."""
    _check_alike(headers, request)
    pixels, damaged = _pixels(_of_one_time(headers, request) if not unreadable else headers, request)
    if damaged:  # where files are missing, all that there are decide which frames are of one time
        pixels, damaged = _pixels(headers, request)
    unreadable = [*unreadable, *damaged]
    headers = [header for header in headers if header.file not in damaged]
    losses = [f"{_named(unreadable)}, and left out"] if unreadable else []
    frames = [frame for header in headers for frame in header.frames]
    if len(frames) == 1:
        raise FileError(
            f"the series has a single slice, which is 2-D; add the other slices of the series: {request.path}"
        )
    first = headers[0]
    guesses = []
    if any(header.has_lookup_table for header in headers):
        guesses.append("values as they are stored: the table for them (Modality LUT) is not applied")
    if all(frame.is_placed() for frame in frames):
        chosen, n_times, times = _one_volume(frames, losses, request)
        if len(chosen) == 1:
            raise FileError(f"the frames lie at one place, and are pictures of it, no volume: {request.path}")
        stack = stacked(chosen, request)
    else:
        choose("time", 1, request.time, request.path)
        n_times, times = 1, ()
        stack = _as_they_come(frames, first)
        guesses.append(f"frames as slices, {_distances(stack)} mm apart: the file does not say where they lie")
    if not np.isfinite(first.frames[0].pixel_spacing).all():
        guesses.append("distances of pixels 1, 1: the file has none")
        stack = _with_pixels_of_1(stack)
    samples = _samples(stack, pixels, {header.file: header for header in headers}, request)
    is_anatomical = first.is_of_patient and all(frame.is_placed() for frame in frames)
    colors = COLORS[:3] if first.n_samples == 3 else ()
    facts = Facts(
        unit="mm" if np.isfinite(first.frames[0].pixel_spacing).all() else None,
        is_anatomical=is_anatomical,
        modality=first.modality,
        channels=colors,
        channel=colors[request.channel or 0] if colors else None,
        n_times=n_times,
        times=times,
        time_unit="s" if times else None,
        guesses=tuple(guesses),
    )
    return Grid(samples, stack.world_from_index, facts, (*losses, *stack.losses))


def _of_one_time(headers: Sequence[Header], request: Request) -> Sequence[Header]:
    """The files of the time that is asked for: those of others need not be read."""
    frames = [frame for header in headers for frame in header.frames]
    if len(frames) < 2 or not all(frame.is_placed() for frame in frames):
        return headers
    files = {frame.file for frame in one_volume(frames, request)[0]}
    return [header for header in headers if header.file in files]


def _one_volume(
    frames: Sequence[Frame], losses: Sequence[str], request: Request
) -> tuple[list[Frame], int, tuple[float, ...]]:
    """As of `dicom_stack`; what was left out may be why it fails."""
    try:
        return one_volume(frames, request)
    except FileError as error:
        if not losses or isinstance(error, SeveralError):
            raise
        raise FileError(f"{losses[0]}; then {error}") from None


def _check_alike(headers: Sequence[Header], request: Request) -> None:
    first = headers[0]
    for one in headers[1:]:
        if (one.size, one.n_samples) != (first.size, first.n_samples):
            raise FileError(
                f"slices differ in size: {first.file.name} has {first.size} pixels, "
                f"{one.file.name} has {one.size}; "
                f"move one kind to another folder: {request.path}"
            )
    frames = [frame for header in headers for frame in header.frames]
    of_stack: dict[str, Frame] = {}
    for frame in frames:
        like = of_stack.setdefault(frame.stack, frame)
        if not frame.stack and not np.allclose(frame.orientation, like.orientation, atol=1e-3, equal_nan=True):
            raise FileError(
                f"slices are not parallel: {like.name} and {frame.name} (a scout or a radial series?); "
                f"move one kind to another folder: {request.path}"
            )
        if request.spacing is None and not np.allclose(
            frame.pixel_spacing, like.pixel_spacing, rtol=1e-3, equal_nan=True
        ):
            raise FileError(
                f"slices differ in the spacing of their pixels: {like.name} has {like.pixel_spacing} mm, "
                f"{frame.name} has {frame.pixel_spacing}; move one kind to another folder, or pass spacing=(x, y, z): "
                f"{request.path}"
            )


def _pixels(headers: Sequence[Header], request: Request) -> tuple[dict[Path, NDArray[Any]], list[Path]]:
    """Stored numbers of all frames by file, and the files whose pixels cannot be read."""
    payload.check_memory(sum(_n_bytes(header) for header in headers), request.path)
    pixels: dict[Path, NDArray[Any]] = {}
    failed: dict[Path, Exception] = {}
    for header in headers:
        found = _pixels_of(header)
        if isinstance(found, Exception):
            failed[header.file] = found
        else:
            pixels[header.file] = found
    if not pixels:
        raise next(iter(failed.values()))
    return pixels, list(failed)


def _pixels_of(header: Header) -> NDArray[Any] | Exception:
    try:
        return frames_in(header)
    except Exception as error:  # noqa: BLE001 - as above
        return error


def _n_bytes(header: Header) -> int:
    return header.size[0] * header.size[1] * header.n_frames * header.n_samples * max(header.bits_allocated // 8, 1)


def _as_they_come(frames: Sequence[Frame], header: Header) -> Stack:
    """Frames without places: by number, along z."""
    ordered = sorted(frames, key=lambda frame: (frame.instance, frame.file.name, frame.index))
    row, column = (abs(step) if np.isfinite(step) else 1.0 for step in ordered[0].pixel_spacing)
    step = abs(header.slice_step) if np.isfinite(header.slice_step) else column
    slices = [(n, n, 0.0) for n in range(len(ordered))]
    return Stack(ordered, slices, affine.RAS_FROM_LPS @ np.diag([column, row, step, 1.0]))


def _distances(stack: Stack) -> str:
    return f"{affine.spacing_of(stack.world_from_index)[2]:.4g}"


def _with_pixels_of_1(stack: Stack) -> Stack:
    matrix = np.where(np.isfinite(stack.world_from_index), stack.world_from_index, 0.0)
    orientation = stack.frames[0].orientation
    if np.isfinite(orientation).all():
        matrix[:3, :2] = affine.RAS_FROM_LPS[:3, :3] @ orientation.reshape(2, 3).T
    return Stack(stack.frames, stack.slices, matrix, stack.losses)


# Values


def _samples(
    stack: Stack, pixels: dict[Path, NDArray[Any]], headers: dict[Path, Header], request: Request
) -> NDArray[Any]:
    """Each frame by its own slope and intercept, in a type that holds all of them."""
    used = [stack.frames[n] for n in sorted({n for a, b, _ in stack.slices for n in (a, b)})]
    first = pixels[used[0].file]
    n_components = first.shape[3] if first.ndim == 4 else 1
    channel = choose("channel", n_components, request.channel, request.path)
    dtype = _type_of_all(used, pixels, headers)
    shape = (len(stack.slices), *first.shape[1:3])
    payload.check_memory(payload.n_bytes(shape, dtype), request.path)
    samples = np.empty(shape, dtype)

    def values(frame: Frame) -> Any:
        stored = pixels[frame.file][frame.index]
        stored = stored[..., channel] if stored.ndim == 3 else stored
        if (frame.slope, frame.intercept) == (1.0, 0.0):
            return stored
        if dtype.kind == "f":
            return stored * np.float64(frame.slope) + frame.intercept
        return stored.astype(np.int64) * int(frame.slope) + int(frame.intercept)

    for number, (a, b, share) in enumerate(stack.slices):
        if share in (0.0, 1.0):
            samples[number] = values(stack.frames[b if share else a])
        else:
            between = (1 - share) * values(stack.frames[a]) + share * values(stack.frames[b])
            samples[number] = np.rint(between) if dtype.kind in "iu" else between
    return _narrowed(samples) if dtype.itemsize > max(one.dtype.itemsize for one in pixels.values()) else samples


def _type_of_all(
    frames: Sequence[Frame], pixels: dict[Path, NDArray[Any]], headers: dict[Path, Header]
) -> np.dtype[Any]:
    """By what the stored bits can hold, and without a look at the values."""
    types = {pixels[frame.file].dtype for frame in frames}
    scales = {(frame.slope, frame.intercept) for frame in frames}
    if len(types) == 1 and scales == {(1.0, 0.0)}:
        return types.pop()
    is_wide = max(dtype.itemsize for dtype in types) > 2
    if any(dtype.kind == "f" for dtype in types) or not all(
        slope.is_integer() and intercept.is_integer() for slope, intercept in scales
    ):
        return np.dtype(np.float64 if is_wide else np.float32)
    ends: list[int] = []
    for file, slope, intercept in {(frame.file, frame.slope, frame.intercept) for frame in frames}:
        n_bits = min(headers[file].bits_stored, 8 * pixels[file].dtype.itemsize)
        low, high = (-(1 << n_bits - 1), (1 << n_bits - 1) - 1) if headers[file].is_signed else (0, (1 << n_bits) - 1)
        ends += [low * int(slope) + int(intercept), high * int(slope) + int(intercept)]
    for dtype in (np.dtype(np.int16), np.dtype(np.uint16), np.dtype(np.int32)):
        if np.iinfo(dtype).min <= min(ends) and max(ends) <= np.iinfo(dtype).max:
            return dtype
    return np.dtype(np.float64)


def _narrowed(samples: NDArray[Any]) -> NDArray[Any]:
    """In 16 bits where these hold all values."""
    if samples.dtype.kind in "iu":
        for dtype in (np.int16, np.uint16):
            if np.iinfo(dtype).min <= samples.min() and samples.max() <= np.iinfo(dtype).max:
                return samples.astype(dtype)
    return samples
