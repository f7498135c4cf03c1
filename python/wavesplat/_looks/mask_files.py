"""Masks in a file each, named after what they show, as one segmentation: `liver.nii.gz`, `spleen.nii.gz`, ...

So TotalSegmentator writes them, and other programs that find organs one by one. The masks lie on the first one's
samples; where two overlap, the later file counts.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from os import PathLike
from pathlib import PurePath
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks import label_grids
from wavesplat._model.volume import Volume
from wavesplat._readers.opening import open as open_volume
from wavesplat.errors import ArgumentError

#: Suffixes of formats, also double ones such as .seg.nrrd.
SUFFIXES = re.compile(r"(\.(nii|img|hdr|ome|seg))?\.[A-Za-z][A-Za-z0-9]{1,5}$", re.IGNORECASE)
#: Largest number of masks: codes have 16 bits.
MAX_MASKS = 65_534
#: Names that a note lists.
N_LISTED = 3


class Masks(NamedTuple):
    """Masks as one volume of numbers, from 1 in the order of the files; their names, and notes on what was lost."""

    volume: Volume
    names: dict[int, str]
    notes: tuple[str, ...]


def name_of(path: str | PathLike[str]) -> str:
    """The name of a mask: its file's name without suffixes."""
    return SUFFIXES.sub("", PurePath(path).name)


def merged(paths: Sequence[str]) -> Masks:
    """Masks in files as one segmentation.

    Raises
    ------
    FileError
        If a file cannot be read.
    ArgumentError
        If a file holds several numbers beside 0, or a mask lies beside the first one.
    """
    if len(paths) > MAX_MASKS:
        raise ArgumentError(f"labels: {len(paths)} masks; {MAX_MASKS} are the most")
    first = open_volume(paths[0])
    numbers = np.zeros(first.shape, np.uint8 if len(paths) < 256 else np.uint16)
    names: dict[int, str] = {}
    empty, covered, n_covered = list[str](), list[str](), 0
    for number, path in enumerate(paths, 1):
        volume = first if number == 1 else open_volume(path)
        name = name_of(path)
        mask = _on_first(_mask(volume, path), volume, first, path)
        if not mask.any():
            empty.append(name)
            continue
        n_twice = int(np.count_nonzero(numbers[mask]))
        if n_twice:
            covered.append(name)
            n_covered += n_twice
        numbers[mask] = number
        names[number] = name
    notes = []
    if covered:
        notes.append(f"labels overlap in {n_covered} samples, where the later file counts: {_listed(covered)}")
    if empty:
        notes.append(f"labels without a sample: {_listed(empty)}")
    n_left = np.bincount(numbers.ravel(), minlength=len(paths) + 1)
    if hidden := [name for number, name in names.items() if not n_left[number]]:
        notes.append(f"labels that later ones cover whole: {_listed(hidden)}")
        names = {number: name for number, name in names.items() if name not in hidden}
    volume = Volume(numbers, world_from_index=first.world_from_index, name="labels", facts=first.facts)
    return Masks(volume, names, tuple(notes))


def _mask(volume: Volume, path: str) -> NDArray[np.bool_]:
    """Samples of a mask as bools."""
    samples = np.asarray(volume.samples)
    # Besides 0 there is one number, such as 1 or 255.
    if not ((samples == 0) | (samples == samples.max())).all():
        raise ArgumentError(
            f"labels: the file holds more than one number beside 0, and of several files each is one mask: {path}"
        )
    return np.asarray(samples != 0, bool)


def _on_first(mask: NDArray[np.bool_], volume: Volume, first: Volume, path: str) -> NDArray[np.bool_]:
    if volume is first:
        return mask
    try:
        label_grids.check_unit(volume.unit, first)
        return label_grids.placed(mask, volume.world_from_index, 0, first).codes
    except ArgumentError as error:
        raise ArgumentError(f"{error}: {path}") from None


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - N_LISTED} more" if len(names) > N_LISTED else ""
    return ", ".join(names[:N_LISTED]) + more
