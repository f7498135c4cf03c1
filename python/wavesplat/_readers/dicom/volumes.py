"""Volumes of DICOM frames: which frames of each place belong together, and what distinguishes the volumes.

A series may show every place several times: times, echoes, magnitude and phase, b-values, heart phases. Frames of a
place are split by the attributes that vary and have the same values at every place; then by numbers and clocks that
differ from slice to slice, of which only the order at each place counts; instance numbers have the last word, since
scanners and archives give them as they like, and then a guess says so. Enhanced and classic files take the same way.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._readers.dicom.attributes import ATTRIBUTES, Attribute, Value
from wavesplat._readers.dicom.header import INDEX, Frame
from wavesplat._readers.request import Request
from wavesplat._storage.paths import natural_key
from wavesplat.errors import FileError

#: Positions nearer than this, in mm and in parts of the distance of pixels, are one place: headers round them.
PLACE_MM, PLACE_PIXELS = 0.01, 0.01
#: Words of image types for the parts of a complex image, in the order of their volumes.
PARTS = {"M": 0, "MAGNITUDE": 0, "P": 1, "PHASE": 1, "R": 2, "REAL": 2, "I": 3, "IMAGINARY": 3}
#: Attributes of diffusion.
OF_DIFFUSION = {"b-value", "diffusion", "direction"}
#: The attribute of frames that only their numbers distinguish.
NUMBER = Attribute("number", "", ())


@dataclass(frozen=True)
class FrameVolume:
    """The frames of a volume in order along their normal, its label, guesses and losses."""

    frames: list[Frame]
    #: Attributes that distinguish it from the others of the series; empty where there are none.
    label: str = ""
    #: Whether it differs from the others by when it was taken, and by nothing else.
    is_time: bool = False
    #: Sentence on how the frames were split, where headers do not say it; whether file names alone decided it.
    guess: str = ""
    is_by_names: bool = False
    #: Slices that other volumes have and this one lacks at its ends, as a sentence.
    loss: str = ""


@dataclass(frozen=True)
class _Key:
    """An attribute that splits frames, with its value for each frame, and the key that is compared (value or rank)."""

    attribute: Attribute
    values: Sequence[Value | None]
    compared: Sequence[Hashable]


def volumes_of(frames: Sequence[Frame], request: Request) -> list[FrameVolume]:
    """The volumes of frames with positions: the volumes of each stack, in order of their attributes."""
    stacks: dict[Hashable, list[Frame]] = {}
    has_stacks = any(frame.stack for frame in frames)  # else they are classic files, and must be parallel
    for frame in frames:
        orientation = tuple(np.round(frame.orientation, 3).tolist()) if has_stacks else ()
        stacks.setdefault((frame.stack, orientation), []).append(frame)
    if len(stacks) == 1:
        return _split(list(frames), request)
    volumes = []
    for stack in stacks.values():
        name = f"stack {stack[0].stack}"
        for one in _split(stack, request):
            label = f"{name}, {one.label}" if one.label else name
            volumes.append(replace(one, label=label, is_time=False))
    return volumes


def times_of(volumes: Sequence[FrameVolume]) -> tuple[float, ...]:
    """When each volume was taken, in seconds after the first, by the first clock that goes on from volume to volume.

    Empty where no clock does, or where volumes differ by more than time.
    """
    if len(volumes) < 2 or not all(volume.is_time for volume in volumes):
        return ()
    for clock in ATTRIBUTES:
        if clock.units_per_second == 0:
            continue
        found = [[frame.attributes.get(clock.name) for frame in volume.frames] for volume in volumes]
        if all(isinstance(value, float) for values in found for value in values):
            times = np.array([min(values) for values in found]) / clock.units_per_second  # type: ignore[type-var]
            if (np.diff(times) > 0).all():
                return tuple(round(float(time - times[0]), 6) for time in times)
    return ()


# Splitting


def _split(frames: list[Frame], request: Request) -> list[FrameVolume]:
    """The volumes of one stack."""
    places = _places(frames)
    n_volumes = max(len(place) for place in places)
    if n_volumes == 1:
        return [FrameVolume([frames[n] for place in places for n in place])]
    codes, keys = _distinguished(frames, places)
    guess, is_by_names = "", False
    if not _is_unique(codes, places):
        if len({len(place) for place in places}) > 1:
            raise FileError(_missing_or_doubled(frames, places, codes, request))
        guess, is_by_names = _by_numbers(frames, places)
        ranks = _ranks(_numbers(frames), codes, places)
        codes = _joint(codes, ranks)
        keys = [*keys, _Key(NUMBER, [float(rank + 1) for rank in ranks], ranks)]
    whole = next(place for place in places if len(place) == n_volumes)
    keys.sort(key=lambda key: key.attribute.is_time or key.attribute is NUMBER)  # kinds before times
    leading = _leading(frames, places) or _as_acquired(frames, places, codes, keys)
    sorted_by = [_sort_keys(key, frames) for key in (*leading, *keys)]
    first = sorted(whole, key=lambda n: [values[n] for values in sorted_by])
    labels = _labels(keys, first)
    is_time = all(key.attribute.is_time or key.attribute is NUMBER for key in keys)
    by_code: dict[int, list[int | None]] = {codes[n]: [] for n in first}
    for place in places:
        here = {codes[n]: n for n in place}
        for code, found in by_code.items():
            found.append(here.get(code))
    volumes = []
    for n, label in zip(first, labels, strict=True):
        slices = by_code[codes[n]]
        own = [frames[k] for k in slices if k is not None]
        volumes.append(FrameVolume(own, label, is_time, guess, is_by_names, _missing_at_ends(slices)))
    return volumes


def _places(frames: Sequence[Frame]) -> list[list[int]]:
    """Numbers of the frames at each place, places in order along the normal.

    Coordinates are sorted axis by axis and cut at their gaps: rounding to a grid would part equal places at its edges.
    """
    positions = np.array([frame.position for frame in frames])
    pixel = np.nanmin([*frames[0].pixel_spacing, 1.0])
    tolerance = min(PLACE_MM, PLACE_PIXELS * float(pixel))
    cells = np.empty(positions.shape, np.int64)
    for axis in range(3):
        order = np.argsort(positions[:, axis])
        steps = np.diff(positions[order, axis], prepend=positions[order[:1], axis])
        cells[order, axis] = np.cumsum(steps > tolerance)
    along: NDArray[np.float64] = positions @ frames[0].normal
    places: dict[tuple[int, ...], list[int]] = {}
    for n in np.argsort(along, kind="stable").tolist():
        places.setdefault(tuple(cells[n].tolist()), []).append(n)
    return list(places.values())


def _distinguished(frames: Sequence[Frame], places: Sequence[Sequence[int]]) -> tuple[list[int], list[_Key]]:
    """A code for each frame, equal for frames that no attribute distinguishes, and the attributes that distinguish."""
    codes = [0] * len(frames)
    keys: list[_Key] = []
    known = [attribute for attribute in ATTRIBUTES if _varies(frames, attribute.name)]
    for attribute in (*known, *_dimensions(frames)):
        values = [frame.attributes.get(attribute.name) for frame in frames]
        if (finer := _refined(codes, values, places)) is not None:
            codes, keys = finer, [*keys, _Key(attribute, values, values)]
    if len({len(place) for place in places}) > 1:
        return codes, keys  # ranks mean nothing where frames are missing
    for attribute in known:
        values = [frame.attributes.get(attribute.name) for frame in frames]
        if all(isinstance(value, float) for value in values):
            ranks = _ranks(values, codes, places)
            if (finer := _refined(codes, ranks, places)) is not None:
                codes, keys = finer, [*keys, _Key(attribute, values, ranks)]
    return codes, keys


def _varies(frames: Sequence[Frame], name: str) -> bool:
    first = frames[0].attributes.get(name)
    return any(frame.attributes.get(name) != first for frame in frames)


def _refined(codes: Sequence[int], values: Sequence[Hashable], places: Sequence[Sequence[int]]) -> list[int] | None:
    """Codes that also distinguish these values; None if no place gets more of them, or they differ between places.

    Places with fewer frames than others must have a subset of the codes of the complete places.
    """
    finer = _joint(codes, values)
    n_most = max(len(place) for place in places)
    whole = next(place for place in places if len(place) == n_most)
    if len({finer[n] for n in whole}) == len({codes[n] for n in whole}):
        return None
    wanted = Counter(finer[n] for n in whole)
    pattern = sorted(wanted.elements())
    for place in places:
        if len(place) == n_most:
            if sorted(finer[n] for n in place) != pattern:
                return None
        elif Counter(finer[n] for n in place) - wanted:
            return None
    return finer


def _joint(codes: Sequence[int], values: Sequence[Hashable]) -> list[int]:
    numbers: dict[tuple[int, Hashable], int] = {}
    return [numbers.setdefault(pair, len(numbers)) for pair in zip(codes, values, strict=True)]


def _ranks(values: Sequence[Any], codes: Sequence[int], places: Sequence[Sequence[int]]) -> list[int]:
    """Rank of each frame: the number of smaller distinct values among the frames of its place and code."""
    ranks = [0] * len(codes)
    for place in places:
        groups: dict[int, list[int]] = {}
        for n in place:
            groups.setdefault(codes[n], []).append(n)
        for group in groups.values():
            rank = {value: k for k, value in enumerate(sorted({values[n] for n in group}))}
            for n in group:
                ranks[n] = rank[values[n]]
    return ranks


def _is_unique(codes: Sequence[int], places: Sequence[Sequence[int]]) -> bool:
    return all(len({codes[n] for n in place}) == len(place) for place in places)


def _leading(frames: Sequence[Frame], places: Sequence[Sequence[int]]) -> list[_Key]:
    """Attributes that order volumes before their kinds do: the file's own indices; or one that counts all volumes.

    Not a clock: it may be the time at which pictures were computed.
    """
    codes = [0] * len(frames)
    keys: list[_Key] = []
    for attribute in _dimensions(frames):
        values = [frame.attributes.get(attribute.name) for frame in frames]
        if (finer := _refined(codes, values, places)) is not None:
            codes, keys = finer, [*keys, _Key(attribute, values, values)]
    if keys and _is_unique(codes, places):
        return keys
    for attribute in ATTRIBUTES:
        if attribute.is_time and not _is_clock(attribute) and _varies(frames, attribute.name):
            values = [frame.attributes.get(attribute.name) for frame in frames]
            codes = _refined([0] * len(frames), values, places) or [0] * len(frames)
            if _is_unique(codes, places):
                return [_Key(attribute, values, values)]
    return keys


def _as_acquired(
    frames: Sequence[Frame], places: Sequence[Sequence[int]], codes: Sequence[int], keys: Sequence[_Key]
) -> list[_Key]:
    """The order of instance numbers for diffusion directions, if it is the same at every place.

    A .bvec file lists directions as they were acquired, with pictures without diffusion between them.
    """
    kinds = {key.attribute.name for key in keys if not (key.attribute.is_time or key.attribute is NUMBER)}
    if "direction" not in kinds or kinds - OF_DIFFUSION:
        return []
    orders = set()
    for place in places:
        numbers = [(frames[n].instance, frames[n].index) for n in place]
        if len(set(numbers)) < len(numbers):
            return []
        orders.add(tuple(codes[n] for _, n in sorted(zip(numbers, place, strict=True))))
    if len(orders) > 1:
        return []
    [order] = orders
    ranks = [float(order.index(code)) for code in codes]
    return [_Key(NUMBER, ranks, ranks)]


def _dimensions(frames: Sequence[Frame]) -> list[Attribute]:
    """Indices by which enhanced files order their frames, in the file's order, where they differ."""
    names = dict.fromkeys(name for frame in frames for name in frame.attributes if name.startswith(INDEX))
    return [Attribute(name, "", ()) for name in names if _varies(frames, name)]


def _sort_keys(key: _Key, frames: Sequence[Frame]) -> list[tuple[Any, ...]]:
    """Sort keys of the frames: the value, frames without one first.

    Texts and directions have no order of their own: they are sorted by the mean time and instance number of their
    frames (arterial before venous), but for magnitude, phase, real and imaginary part, which come in this order.
    """
    if not any(isinstance(value, str | tuple) for value in key.compared):
        return [(0, 0) if value is None else (1, value) for value in key.compared]
    clock = next((one.name for one in ATTRIBUTES if one.is_time and _is_clock_of(frames, one.name)), "")
    places: dict[Hashable, list[tuple[float, int]]] = {}
    for frame, value in zip(frames, key.compared, strict=True):
        time = frame.attributes.get(clock, 0.0)
        places.setdefault(value, []).append((time if isinstance(time, float) else 0.0, frame.instance))
    mean = {
        value: tuple(round(float(np.mean(column)), 6) for column in zip(*found, strict=True))
        for value, found in places.items()
    }
    return [
        (0,) if value is None else (1, _place_of_part(value), mean[value], isinstance(value, tuple), value)
        for value in key.compared
    ]


def _is_clock_of(frames: Sequence[Frame], name: str) -> bool:
    """Whether all frames have a number for this attribute, and not all the same."""
    return _varies(frames, name) and all(isinstance(frame.attributes.get(name), float) for frame in frames)


def _place_of_part(value: Hashable) -> int:
    """Rank of magnitude, phase, real and imaginary part, by the first word of an image type that names one."""
    for word in str(value).split("\\"):
        head = word.partition("_")[0].strip()
        if head in PARTS:
            return PARTS[head]
    return len(PARTS)


# Numbers, labels and messages


def _numbers(frames: Sequence[Frame]) -> list[tuple[Any, ...]]:
    return [(frame.instance, tuple(natural_key(frame.file.name)), frame.index) for frame in frames]


def _by_numbers(frames: Sequence[Frame], places: Sequence[Sequence[int]]) -> tuple[str, bool]:
    """A sentence on frames that only their numbers or names distinguish, and whether it is names."""
    if len({frame.file for frame in frames}) == 1:
        return "frames of one place in the order of the file: nothing in it says which belong together", False
    n = len(places[0])
    if all(len({(frames[k].instance, frames[k].index) for k in place}) == len(place) for place in places):
        text = f"the {n} slices of each place in the order of their instance numbers: nothing else in the headers says "
        return f"{text}which belong together", False
    return (
        f"nothing in the headers says which of the {n} slices of each place belong together, not even their instance "
        "numbers: taken in the order of file names"
    ), True


def _labels(keys: Sequence[_Key], frames: Sequence[int]) -> list[str]:
    """Labels of volumes, one for each of these frames: the attributes that distinguish its volume."""
    if [key.attribute for key in keys] == [NUMBER]:
        return [""] * len(frames)
    columns = [_described(key.attribute, [key.values[n] for n in frames]) for key in keys]
    return [", ".join(part for part in parts if part) for parts in zip(*columns, strict=True)]


def _described(attribute: Attribute, values: Sequence[Value | None]) -> list[str]:
    if attribute.name == "":  # the image type: the words that differ
        parts = [str(value or "").split("\\") for value in values]
        longest = max(len(words) for words in parts)
        padded = [[*words, *[""] * (longest - len(words))] for words in parts]
        differ = [k for k in range(longest) if len({words[k] for words in padded}) > 1]
        return [" ".join(dict.fromkeys(words[k].strip() for k in differ if words[k])) for words in padded]
    if _is_clock(attribute):
        seconds = [value for value in values if isinstance(value, float)]
        values = [value - min(seconds) if isinstance(value, float) else None for value in values]
    sign, unit = "+" if _is_clock(attribute) else "", f" {attribute.unit}" if attribute.unit else ""
    return [
        f"no {attribute.name}" if value is None else f"{attribute.name} {sign}{_written(value)}{unit}"
        for value in values
    ]


def _is_clock(attribute: Attribute) -> bool:
    """Whether an attribute is a time of day."""
    return any(source.encoding in ("time", "datetime") for source in attribute.sources)


def _written(value: Value) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(f'{number:.3g}' for number in value)})"
    return f"{value:.6g}" if isinstance(value, float) else value.replace("\\", " ")


def _missing_at_ends(slices: Sequence[int | None]) -> str:
    there = [n for n, found in enumerate(slices) if found is not None]
    before, after = there[0], len(slices) - 1 - there[-1]
    if before + after == 0:
        return ""
    is_one = before + after == 1
    where = "its end" if before == 0 else "its beginning" if after == 0 else "its ends"
    return (
        f"{before + after} {'slice is' if is_one else 'slices are'} missing at {where}, which other volumes of the "
        f"series have: it has {len(slices) - before - after} of {len(slices)}"
    )


def _missing_or_doubled(
    frames: Sequence[Frame], places: Sequence[Sequence[int]], codes: Sequence[int], request: Request
) -> str:
    """Message for places with more frames than others, where attributes do not show the missing or doubled ones."""
    counts = [len(place) for place in places]
    place = places[counts.index(max(counts))]
    count = Counter(codes[n] for n in place)
    alike = [frames[n] for n in place if count[codes[n]] > 1]
    position = tuple(round(float(x), 2) + 0.0 for x in frames[place[0]].position)
    mend = "move the extra files away" if len({frame.file for frame in frames}) > 1 else "export the file again"
    return (
        f"{max(counts)} slices at position {position}, {min(counts)} at others: a slice is missing or doubled, and "
        f"nothing in the headers distinguishes {alike[0].name} from {alike[1].name}; {mend}: {request.path}"
    )
