"""Folders of TIFF files of one slice each, and the chain of pages of one file."""

from __future__ import annotations

import re
import struct
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.facts import COLORS, Channel, Facts
from wavesplat._readers.request import Request, choose
from wavesplat._readers.tiff.facts import TiffPlace, place_of
from wavesplat._storage.paths import check_within, natural_key
from wavesplat.errors import FileError

# The chain of pages of a TIFF file: each names the place of the next, and a damaged one may lead back.
#
# tifffile follows such a chain for minutes. Format: TIFF 6.0, section 2, and BigTIFF.

#: Version of the format -> forms of an offset and of a number of entries, bytes of an entry, place of the first offset.
FORMS = {42: ("I", "H", 12, 4), 43: ("Q", "Q", 20, 8)}


def check_pages(path: Path) -> None:
    """Raise a `FileError` if the chain of pages comes back to a page. What else is wrong, tifffile says."""
    with path.open("rb") as file:
        head = file.read(4)
        order = {b"II": "<", b"MM": ">"}.get(head[:2])
        if order is None or len(head) < 4:
            return
        form = FORMS.get(struct.unpack(f"{order}H", head[2:])[0])
        if form is None:
            return
        offset_form, count_form, entry_bytes, place = form
        seen: set[int] = set()
        while True:
            file.seek(place)
            found = file.read(struct.calcsize(offset_form))
            if len(found) < struct.calcsize(offset_form):
                return
            (offset,) = struct.unpack(order + offset_form, found)
            if offset in seen:
                raise FileError(f"damaged: its pages lead in a circle; copy or export it again: {path}")
            if not 0 < offset < 1 << 62:
                return
            seen.add(offset)
            file.seek(offset)
            count = file.read(struct.calcsize(count_form))
            if len(count) < struct.calcsize(count_form):
                return
            place = offset + len(count) + struct.unpack(order + count_form, count)[0] * entry_bytes
            if place >= 1 << 62:
                return


# Folders of TIFF files of one slice each: their order, distances, and the channels and times in their names.

NO_DISTANCES = "distances of samples 1, 1, 1: a folder of slices has none"
#: How names of files number channels and times: c001, ch0, C00, channel_2; t0, T00003, time-5.
IN_NAMES = {
    "channel": re.compile(r"(?<![a-z])(?:channel|chan|ch|c)[-_=]?(\d+)", re.IGNORECASE),
    "time": re.compile(r"(?<![a-z])(?:time|t)[-_=]?(\d+)", re.IGNORECASE),
}


@dataclass(frozen=True)
class Slices:
    """The slices of one channel and time in a folder, in their order."""

    files: list[Path]
    #: The samples of the first.
    first: NDArray[Any]
    world_from_index: NDArray[np.float64]
    facts: Facts


def slices_in(folder: Path, request: Request) -> Slices:
    """The slices in a folder, of the channel and the time that are asked for where names of files have several."""
    import tifffile

    files = _files_in(folder, request)
    check_pages(files[0])
    with tifffile.TiffFile(files[0]) as tiff:
        place = place_of(tiff)
    pixels = tifffile.imread(files[0])
    if pixels.ndim == 2:
        files, facts = _by_names(files, request)
    else:
        facts = Facts(channels=COLORS[: pixels.shape[-1]] if pixels.shape[-1] in (3, 4) else ())
    number = request.channel or 0
    facts = replace(facts, channel=facts.channels[number] if number < len(facts.channels) else None)
    if place.facts.unit is None:
        place = TiffPlace(
            (1.0, 1.0, 1.0), Facts(guesses=("distances of samples 1, 1, 1: a folder of slices has none",))
        )
    facts = replace(facts, unit=place.facts.unit, guesses=(*place.facts.guesses, *facts.guesses))
    first = slice_of(pixels, files[0], request)
    return Slices(files, first, np.diag([*np.abs(place.steps), 1.0]), facts)


def _files_in(folder: Path, request: Request) -> list[Path]:
    found = [file for file in folder.iterdir() if file.suffix.lower() in (".tif", ".tiff")]
    for file in found:
        check_within(file, request.within)
    return sorted(found, key=lambda file: natural_key(file.name))


def _by_names(files: list[Path], request: Request) -> tuple[list[Path], Facts]:
    """The files of one channel and time, and facts: of those two that several slices each have in their names."""
    facts = Facts()
    for what, pattern in IN_NAMES.items():
        groups = _groups(files, pattern)
        if len(groups) < 2:
            continue
        names = list(groups)
        asked_for = request.channel if what == "channel" else request.time
        number = choose(what, len(groups), asked_for, request.path, described=names)
        files = groups[names[number]]
        guess = f"{what}s {', '.join(names[:8])}{', ...' if len(names) > 8 else ''}: by the names of the files"
        facts = replace(facts, guesses=(*facts.guesses, guess))
        if what == "channel":
            facts = replace(facts, channels=tuple(Channel(name) for name in names))
        else:
            facts = replace(facts, n_times=len(names))
    return files, facts


def _groups(files: Sequence[Path], pattern: re.Pattern[str]) -> dict[str, list[Path]]:
    """Number in the name -> its files, where each number has the same slices, two at least; else none."""
    groups: dict[str, list[Path]] = {}
    rests: dict[str, list[str]] = {}
    for file in files:
        match = pattern.search(file.stem)
        if match is None:
            return {}
        groups.setdefault(match[0], []).append(file)
        rests.setdefault(match[0], []).append(file.stem[: match.start()] + file.stem[match.end() :])
    first, *others = rests.values()
    is_even = len(first) >= 2 and all(other == first for other in others)
    return dict(sorted(groups.items(), key=lambda group: natural_key(group[0]))) if is_even else {}


def slice_of(pixels: NDArray[Any], file: Path, request: Request) -> NDArray[Any]:
    """One 2-D slice, of one channel."""
    if pixels.ndim == 3 and pixels.shape[-1] in (2, 3, 4):
        return pixels[..., choose("channel", pixels.shape[-1], request.channel, file)]
    if pixels.ndim != 2:
        raise FileError(
            f"a slice in the folder is {pixels.ndim}-D, shape {pixels.shape}; open that file alone, or several of them "
            f"as times, with wavesplat.Series: {file}"
        )
    return pixels
