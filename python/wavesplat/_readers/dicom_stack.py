"""Frames of a DICOM volume, in order along their normal, as slices at even distances.

The affine comes from the frames' own positions, so that a gantry-tilted stack keeps its shear; ITK would straighten it.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wavesplat._model import affine
from wavesplat._readers.dicom_header import Frame
from wavesplat._readers.request import Request
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
    """Distances to be counted: to 0.01 mm, and where they are usually below a millimetre to three digits of that."""
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
