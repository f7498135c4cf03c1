"""Frames of a DICOM volume, in order along their normal, as slices at even distances, and their values.

The affine comes from the frames' own positions, so that a gantry-tilted stack keeps its shear; ITK would straighten it.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import affine
from wavesplat._readers.dicom.header import Frame, Header
from wavesplat._readers.request import Request, choose
from wavesplat._storage import size_checks
from wavesplat.errors import FileError

#: Tolerance of slice positions, as a fraction of the slice distance: scanners round positions.
TOLERANCE = 0.05
#: Slices for each that is there, at most, after gaps are filled: more mean a stray slice, and no gap.
MAX_FILLED = 4
#: Files that a message names, at most.
N_NAMED = 4


@dataclass(frozen=True)
class Stack:
    """Frames, the two that make each slice with the share of the second, and the affine."""

    frames: Sequence[Frame]
    slices: list[tuple[int, int, float]]
    world_from_index: NDArray[np.float64]
    losses: tuple[str, ...] = ()


def stacked(frames: Sequence[Frame], request: Request) -> Stack:
    """The frames as a stack at even distances, missing ones filled in from their neighbours."""
    positions = np.array([frame.position for frame in frames])
    step = (positions[-1] - positions[0]) / (len(frames) - 1)
    even = positions[0] + np.arange(len(frames))[:, None] * step
    off = np.linalg.norm(positions - even, axis=1).max()
    slices = [(n, n, 0.0) for n in range(len(frames))]
    if off <= TOLERANCE * np.linalg.norm(step) or request.spacing is not None:
        return Stack(frames, slices, _world_from_index(frames[0], step))
    slices, step, loss = _filled(frames, positions, request)
    return Stack(frames, slices, _world_from_index(frames[0], step), (loss,))


def single(frame: Frame, thickness: float) -> Stack:
    """A slice alone, of a thickness in mm, NaN where it is unknown."""
    step = abs(thickness) if math.isfinite(thickness) and thickness != 0 else min(frame.pixel_spacing)
    return Stack([frame], [(0, 0, 0.0)], _world_from_index(frame, frame.normal * step))


def _world_from_index(first: Frame, step: NDArray[np.float64]) -> NDArray[np.float64]:
    matrix = np.eye(4)
    matrix[:3, 0] = first.orientation[:3] * first.pixel_spacing[1]
    matrix[:3, 1] = first.orientation[3:] * first.pixel_spacing[0]
    matrix[:3, 2] = step
    matrix[:3, 3] = first.position
    return affine.RAS_FROM_LPS @ matrix


def _filled(
    frames: Sequence[Frame], positions: NDArray[np.float64], request: Request
) -> tuple[list[tuple[int, int, float]], NDArray[np.float64], str]:
    """Slices at even distances, their step, and a sentence on what was filled or resampled."""
    way = positions[-1] - positions[0]
    length = float(np.linalg.norm(way))
    along = (positions - positions[0]) @ (way / length)
    distances = np.diff(along)
    counts = Counter(_rounded(distances).tolist())
    usual = min(counts, key=lambda distance: (-counts[distance], distance))
    usual = float(distances[np.abs(distances - usual) <= TOLERANCE * usual].mean()) if usual > 0 else 0.0
    listed = ", ".join(f"{distance:g} mm ({count}x)" for distance, count in counts.most_common())
    beside = float(np.linalg.norm(positions - positions[0] - along[:, None] * way / length, axis=1).max())
    n_slices = round(length / usual) + 1 if usual > 0 else 0
    if beside > TOLERANCE * usual:
        raise FileError(_off_line(frames, positions, request))
    if request.gaps == "refuse" or not 2 <= n_slices <= MAX_FILLED * len(frames) + 1:
        raise FileError(_uneven(frames, distances, listed, request))
    places = np.linspace(0.0, length, n_slices)
    after = np.clip(np.searchsorted(along, places), 1, len(frames) - 1)
    slices = []
    for place, b in zip(places, after.tolist(), strict=True):
        share = float(np.clip((place - along[b - 1]) / max(along[b] - along[b - 1], 1e-9), 0, 1))
        near = TOLERANCE * usual / max(along[b] - along[b - 1], 1e-9)
        slices.append((b - 1, b, 0.0 if share < near else 1.0 if share > 1 - near else share))
    steps = distances / usual
    if np.abs(steps - np.round(steps)).max() > TOLERANCE * n_slices / len(frames):
        loss = f"slices are not evenly spaced (distances {listed}): resampled to {length / (n_slices - 1):.4g} mm"
    else:
        gaps = [f"{frames[n].name} and {frames[n + 1].name}" for n in np.flatnonzero(np.round(steps) > 1).tolist()]
        named = "; ".join(gaps[:N_NAMED]) + (" and others" if len(gaps) > N_NAMED else "")
        missing = n_slices - len(frames)
        are = "slice is" if missing == 1 else "slices are"
        loss = f"{missing} {are} missing (distances {listed}), between {named}: filled in from their neighbours"
    return slices, way / (n_slices - 1), loss


def _rounded(distances: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distances to be counted: to 0.01 mm; where the usual one is below a millimetre, to three digits of it."""
    usual = float(np.median(distances))
    rounded: NDArray[np.float64] = np.round(distances, 2 - min(math.floor(math.log10(usual)), 0) if usual > 0 else 2)
    return rounded


def _uneven(frames: Sequence[Frame], distances: NDArray[np.float64], listed: str, request: Request) -> str:
    rounded = _rounded(distances)
    counts = Counter(rounded.tolist())
    rarest = min(counts, key=lambda distance: counts[distance])
    place = int(np.flatnonzero(rounded == rarest)[0])
    return (
        f"slices are not evenly spaced, so some are missing or two stacks are mixed: distances {listed}; "
        f"{rarest:g} mm lie between {frames[place].name} and {frames[place + 1].name}; "
        f"add the missing slices, or pass spacing=(x, y, z) to draw them as if they were even: {request.path}"
    )


def _off_line(frames: Sequence[Frame], positions: NDArray[np.float64], request: Request) -> str:
    """Message for slices that are shifted: it names the frame farthest from the line through most of the others."""
    steps = np.diff(positions, axis=0)
    usual = np.median(steps / np.linalg.norm(steps, axis=1)[:, None], axis=0)
    usual /= np.linalg.norm(usual)
    across = positions - (positions @ usual)[:, None] * usual
    off = np.linalg.norm(across - np.median(across, axis=0), axis=1)
    worst = int(np.argmax(off))
    return (
        f"slices are shifted against each other: {frames[worst].name} lies {off[worst]:.3g} mm beside the line of the "
        f"others; move it away, or pass spacing=(x, y, z) to draw them as if they were in line: {request.path}"
    )


# Values of DICOM frames: each frame by its own slope and intercept, in a type that holds all of them.


def samples_of(
    stack: Stack, pixels: dict[Path, NDArray[Any]], headers: dict[Path, Header], request: Request
) -> tuple[NDArray[Any], str]:
    """Values of a stack, and a sentence on changed padding, empty if none was changed."""
    used = [stack.frames[n] for n in sorted({n for a, b, _ in stack.slices for n in (a, b)})]
    first = pixels[used[0].file]
    n_components = first.shape[3] if first.ndim == 4 else 1
    channel = choose("channel", n_components, request.channel, request.path)
    dtype = _type_of_all(used, pixels, headers)
    shape = (len(stack.slices), *first.shape[1:3])
    size_checks.check_memory(size_checks.n_bytes(shape, dtype), request.path)
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
    note = _without_padding(samples, stack, pixels, headers) if n_components == 1 else ""
    is_wider = dtype.itemsize > max(one.dtype.itemsize for one in pixels.values())
    return (_narrowed(samples) if is_wider else samples), note


def _without_padding(
    samples: NDArray[Any], stack: Stack, pixels: dict[Path, NDArray[Any]], headers: dict[Path, Header]
) -> str:
    """Set padding that is brighter than the scan's darkest sample to this sample, in place; return a sentence on it.

    Padding fills a round field of view up to a square. Mostly it is darker than all else, and is left as it is.
    """
    if all(headers[file].padding is None for file in pixels):
        return ""
    low = samples.min()
    if all((samples[number][mask] <= low).all() for number, mask in _padding(stack, pixels, headers)):
        return ""
    padding = dict(_padding(stack, pixels, headers))
    kept = (samples[n][~padding[n]] if n in padding else samples[n] for n in range(len(samples)))
    lows = [values.min() for values in kept if values.size]
    if not lows or all((samples[number][mask] <= min(lows)).all() for number, mask in padding.items()):
        return ""
    for number, mask in padding.items():
        samples[number][mask] = min(lows)
    count = sum(int(mask.sum()) for mask in padding.values())
    return f"{count} samples outside of the scan (PixelPaddingValue) as the lowest value in it, {min(lows):g}"


def _padding(
    stack: Stack, pixels: dict[Path, NDArray[Any]], headers: dict[Path, Header]
) -> Iterator[tuple[int, NDArray[np.bool_]]]:
    """Slices with padding, and its mask; a slice between two frames has the padding of both."""
    for number, (a, b, share) in enumerate(stack.slices):
        frames = [stack.frames[n] for n, weight in ((a, 1 - share), (b, share)) if weight > 0]
        masks = [_is_padding(pixels[frame.file][frame.index], headers[frame.file]) for frame in frames]
        there = [mask for mask in masks if mask is not None and mask.any()]
        if there:
            yield number, np.logical_or.reduce(there)


def _is_padding(stored: NDArray[Any], header: Header) -> NDArray[np.bool_] | None:
    """Mask of padding; None if the file has none, or names a number that the type of the stored numbers cannot hold."""
    if header.padding is None or stored.dtype.kind not in "iu":
        return None
    low, high = header.padding
    if high < np.iinfo(stored.dtype).min or low > np.iinfo(stored.dtype).max:
        return None
    mask: NDArray[np.bool_] = (stored >= low) & (stored <= high)
    return mask


def _type_of_all(
    frames: Sequence[Frame], pixels: dict[Path, NDArray[Any]], headers: dict[Path, Header]
) -> np.dtype[Any]:
    """A type for the values of all frames, by the range of the stored bits, not by the values themselves."""
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
    """The samples, in 16 bits where these hold all values."""
    if samples.dtype.kind in "iu":
        for dtype in (np.int16, np.uint16):
            if np.iinfo(dtype).min <= samples.min() and samples.max() <= np.iinfo(dtype).max:
                return samples.astype(dtype)
    return samples
