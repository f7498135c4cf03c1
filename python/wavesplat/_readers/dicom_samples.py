"""Values of DICOM frames: each frame by its own slope and intercept, in a type that holds all of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import size_checks
from wavesplat._readers.dicom_header import Frame, Header
from wavesplat._readers.dicom_stack import Stack
from wavesplat._readers.request import Request, choose


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
    """Set padding that is brighter than the darkest sample of the scan to that, in place; return a sentence on it.

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
