"""Frames of DICOM files as one volume: in order along their normal, of one time, at even distances.

The affine comes from the frames' own positions, so that a gantry-tilted stack keeps its shear; ITK would straighten it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wavesplat._model import affine
from wavesplat._readers.dicom_header import Frame
from wavesplat._readers.request import Request, choose
from wavesplat.errors import FileError

__all__ = ["Stack", "in_order", "one_volume", "stacked"]

#: Part of the slice distance by which a slice may be off its place: positions are rounded by scanners.
TOLERANCE = 0.05
#: More slices than this, for each that is there, are no gap but a stray slice.
MOST_FILLED = 4
#: Files that a message names.
N_NAMED = 4


@dataclass(frozen=True)
class Stack:
    """Which frames make each slice: two and the share of the second; and where the slices lie."""

    frames: Sequence[Frame]
    slices: list[tuple[int, int, float]]
    world_from_index: NDArray[np.float64]
    losses: tuple[str, ...] = ()


def in_order(frames: Sequence[Frame]) -> list[Frame]:
    """Along the normal, and at one place by time and the like, then by number."""
    normal = frames[0].normal
    return sorted(frames, key=lambda one: (round(float(one.position @ normal), 3), one.others, one.instance, one.index))


def one_volume(frames: Sequence[Frame], request: Request) -> tuple[list[Frame], int, tuple[float, ...]]:
    """The frames of one stack and time (or echo, or phase), how many of these there are, and their times.

    Times are seconds after the first, and empty where nothing tells one from another.
    Every position of a stack must have been taken as often as the others.
    """
    stacks: dict[tuple[object, ...], list[Frame]] = {}
    for frame in frames:
        key = (frame.stack, *np.round(frame.orientation, 3).tolist()) if _has_stacks(frames) else ()
        stacks.setdefault(key, []).append(frame)
    volumes: list[list[Frame]] = []
    for stack in stacks.values():
        ordered = in_order(stack)
        n_times = _n_times(ordered, request)
        volumes += [ordered[time::n_times] for time in range(n_times)]
    labels = [volume[0].label for volume in volumes]
    number = choose("time", len(volumes), request.time, request.path, described=labels)
    return volumes[number], len(volumes), _times(volumes)


def _times(volumes: Sequence[Sequence[Frame]]) -> tuple[float, ...]:
    """When the first frame of each volume was taken, by the first clock that goes on from volume to volume."""
    for clock in range(min(len(frame.seconds) for volume in volumes for frame in volume)):
        times = np.array([min(frame.seconds[clock] for frame in volume) for volume in volumes])
        if len(volumes) > 1 and np.isfinite(times).all() and (np.diff(times) > 0).all():
            return tuple(round(float(time - times[0]), 6) for time in times)
    return ()


def _has_stacks(frames: Sequence[Frame]) -> bool:
    """Whether the frames are of an enhanced file, which may hold several stacks."""
    return any(frame.stack for frame in frames)


def _n_times(frames: Sequence[Frame], request: Request) -> int:
    places = Counter(tuple(np.round(frame.position, 2)) for frame in frames)
    repeats = set(places.values())
    if len(repeats) > 1:
        place = next(place for place, count in places.items() if count == max(repeats))
        raise FileError(
            f"{max(repeats)} slices at position {tuple(float(x) for x in place)}, {min(repeats)} at others: "
            f"a slice is missing or doubled; "
            f"move the extra files away: {request.path}"
        )
    return repeats.pop()


def stacked(frames: Sequence[Frame], request: Request) -> Stack:
    """The frames at even distances, those that are missing filled in from their neighbours."""
    positions = np.array([frame.position for frame in frames])
    step = (positions[-1] - positions[0]) / (len(frames) - 1)
    even = positions[0] + np.arange(len(frames))[:, None] * step
    off = np.linalg.norm(positions - even, axis=1).max()
    slices = [(n, n, 0.0) for n in range(len(frames))]
    if off <= TOLERANCE * np.linalg.norm(step) or request.spacing is not None:
        return Stack(frames, slices, _world_from_index(frames[0], step))
    slices, step, loss = _filled(frames, positions, request)
    return Stack(frames, slices, _world_from_index(frames[0], step), (loss,))


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
    """Slices at even distances, their step, and what was done."""
    way = positions[-1] - positions[0]
    length = float(np.linalg.norm(way))
    along = (positions - positions[0]) @ (way / length)
    distances = np.diff(along)
    counts = Counter(float(distance) for distance in np.round(distances, 2))
    usual = min(counts, key=lambda distance: (-counts[distance], distance))
    listed = ", ".join(f"{distance:g} mm ({count}x)" for distance, count in counts.most_common())
    beside = np.linalg.norm(positions - positions[0] - along[:, None] * way / length, axis=1).max()
    n_slices = round(length / usual) + 1 if usual > 0 else 0
    if request.gaps == "refuse" or beside > TOLERANCE * usual or not 2 <= n_slices <= MOST_FILLED * len(frames) + 1:
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


def _uneven(frames: Sequence[Frame], distances: NDArray[np.float64], listed: str, request: Request) -> str:
    rounded = np.round(distances, 2)
    counts = Counter(rounded.tolist())
    rarest = min(counts, key=lambda distance: counts[distance])
    place = int(np.flatnonzero(rounded == rarest)[0])
    return (
        f"slices are not evenly spaced, so some are missing or two stacks are mixed: distances {listed}; "
        f"{rarest:g} mm lie between {frames[place].name} and {frames[place + 1].name}; "
        f"add the missing slices, or pass spacing=(x, y, z) to draw them as if they were even: {request.path}"
    )
