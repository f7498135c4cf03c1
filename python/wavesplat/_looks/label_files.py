"""Segmentations in files: a volume of numbers, with names and colours, and a choice among its segments."""

from __future__ import annotations

import fnmatch
import warnings
from collections.abc import Mapping, Sequence
from os import PathLike

import numpy as np

from wavesplat._files.paths import expanded
from wavesplat._looks import label_names
from wavesplat._looks.label_names import Named
from wavesplat._model.volume import Volume
from wavesplat._readers import dicom_labels
from wavesplat._readers.opening import open as open_volume
from wavesplat.errors import ArgumentError, FileWarning

__all__ = ["chosen_numbers", "opened_segmentation"]


def opened_segmentation(
    path: str | PathLike[str], segments: Sequence[str | int] | None
) -> tuple[Volume, dict[int, Named]]:
    """The numbers in a file, and names of labels.

    segments : of a DICOM segmentation those that others must not cover, as of `chosen_numbers`; None: all.
    """
    if segments is None or (file := dicom_labels.segmentation_at(expanded(path))) is None:
        return open_volume(path), label_names.in_file(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FileWarning)  # of segments that may not be shown
        volume = open_volume(path)
    named = label_names.in_file(path)
    alone = dicom_labels.with_segments(
        file, chosen_numbers(segments, {number: name for number, (name, _) in named.items()}, path)
    )
    for loss in alone.losses:
        warnings.warn(f"{loss}: {path}", FileWarning, stacklevel=5)
    if np.array_equal(alone.samples != 0, np.isin(volume.samples, np.unique(alone.samples[alone.samples != 0]))):
        return volume, named  # which documents can name
    return Volume(alone.samples, world_from_index=volume.world_from_index, name=volume.name, facts=volume.facts), named


def chosen_numbers(segments: Sequence[str | int], names: Mapping[int, str], path: object) -> list[int]:
    """Numbers of the segments that are named: by number, by name, or by a pattern of names such as `"rib*"`.

    Raises
    ------
    ArgumentError
        If there is no such segment.
    """
    chosen: list[int] = []
    for one in [segments] if isinstance(segments, str) else segments:
        if isinstance(one, str):
            found = [number for number, name in names.items() if name == one] or [
                number for number, name in names.items() if fnmatch.fnmatchcase(name.lower(), one.strip().lower())
            ]
        else:
            found = [number for number in names if number == one]
        if not found:
            listed = ", ".join(f"{number} {name!r}" for number, name in list(names.items())[:20])
            more = ", ..." if len(names) > 20 else ""
            raise ArgumentError(f"there is no segment {one!r}; there are: {listed or 'none'}{more}: {path}")
        chosen += [number for number in found if number not in chosen]
    return chosen
