"""Regions of a structure set (RTSTRUCT) as labels, filled on the samples of a scan.

Regions of radiotherapy enclose each other (tumour, margins, organ, body), so where they overlap the smallest one is
shown; the outline of the patient (EXTERNAL), which has all others in it, only where it is asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import size_checks
from wavesplat._files.notes import warn
from wavesplat._looks.label_names import Named, chosen_numbers
from wavesplat._looks.region_masks import Mask, mask_of
from wavesplat._model import units
from wavesplat._model.argument_types import described
from wavesplat._model.facts import Facts
from wavesplat._model.grid import Grid
from wavesplat._model.volume import Volume
from wavesplat._readers.dicom_structures import Structure, structures_in
from wavesplat.errors import ArgumentError, FileError, FileWarning

#: The kind of region that is the outline of the patient.
OUTLINE = "EXTERNAL"
MAX_NUMBER = 65_535
#: Regions that a message names, at most.
N_NAMED = 4


def labels_of_structures(
    file: Path, scan: Grid | None, segments: Sequence[str | int] | None
) -> tuple[Volume, dict[int, Named]]:
    """The numbers of an RTSTRUCT's regions on the samples of a scan, and their names and colours.

    segments : as of `chosen_numbers`; None: all but the outline of the patient.
    """
    if scan is None:
        raise ArgumentError(
            "a structure set (RTSTRUCT) has lines, and no samples: give the scan on whose samples its regions are "
            f"filled, wavesplat.Labels.open(path, scan=scan), or `wavesplat render SCAN --labels FILE`: {file}"
        )
    if not isinstance(scan, Grid):
        raise ArgumentError(f"scan is {described(scan)}; give a wavesplat.Volume, as from wavesplat.open(path)")
    found = chosen_structures(structures_in(file), segments, file)
    masks = [(one, mask_of(in_unit_of(scan, one.lines), scan)) for one in found]
    outside = [one.name for one, mask in masks if one.lines and not mask.inside.any()]
    if len(outside) == sum(bool(one.lines) for one in found):
        raise FileError(
            f"no region of the structure set (RTSTRUCT) lies in the scan; open the scan that it was drawn on: {file}"
        )
    samples, covered = _numbered(masks, scan, file)
    oblique = [f"{mask.n_oblique} lines of {one.name!r}" for one, mask in masks if mask.n_oblique]
    for problem, listed in (
        ("regions overlap, and the smallest is shown: hidden are", covered),
        ("regions that are not in the scan:", outside),
        ("lines that lie in no slice of the scan are left out:", oblique),
    ):
        if listed:
            more = ", ..." if len(listed) > N_NAMED else ""
            _warn(f"{problem} {', '.join(listed[:N_NAMED])}{more}", file, stacklevel=5)
    facts = Facts(unit=scan.unit, is_anatomical=scan.is_anatomical, modality="RTSTRUCT")
    volume = Volume(samples, world_from_index=scan.world_from_index, name="labels", facts=facts)
    return volume, {one.number: (one.name, one.color) for one in found}


def _numbered(masks: Sequence[tuple[Structure, Mask]], scan: Grid, file: Path) -> tuple[NDArray[Any], list[str]]:
    """Numbers of the regions on the samples of a scan, the smallest on top, and how much of others is hidden.

    So a region inside another one, such as a tumour in an organ, is always visible.
    """
    most = max(one.number for one, _ in masks)
    dtype = np.dtype(np.uint8 if most < 256 else np.uint16)
    size_checks.check_memory(size_checks.n_bytes(scan.shape, dtype), file)
    samples, hidden = np.zeros(scan.shape, dtype), np.zeros(most + 1, np.int64)
    sizes = {one.number: int(mask.inside.sum()) for one, mask in masks}
    for one, mask in sorted(masks, key=lambda pair: -sizes[pair[0].number]):
        part = samples[mask.box]
        hidden += np.bincount(part[mask.inside], minlength=most + 1)
        part[mask.inside] = one.number
    return samples, [
        f"{hidden[one.number]} of {sizes[one.number]} voxels of {one.name!r}" for one, _ in masks if hidden[one.number]
    ]


def chosen_structures(
    structures: Sequence[Structure], segments: Sequence[str | int] | None, file: Path, *, has_outline: bool = False
) -> list[Structure]:
    """The regions that are wanted, all with numbers of labels; those without lines are named in a warning.

    has_outline : whether the outline of the patient is one of them also where none is named.
    """
    numbers = {one.number for one in structures}
    if len(numbers) < len(structures) or not all(0 < number <= MAX_NUMBER for number in numbers):
        structures = [replace(one, number=place) for place, one in enumerate(structures, 1)]
    if segments is not None:
        wanted = chosen_numbers(segments, {one.number: one.name for one in structures}, file)
        chosen = [one for one in structures if one.number in wanted]
    elif has_outline:
        chosen = list(structures)
    else:
        chosen = [one for one in structures if one.kind != OUTLINE] or list(structures)
        left_out = [one.name for one in structures if one not in chosen]
        if left_out:
            _warn(
                f"the outline of the patient is left out, since all else lies in it: {', '.join(left_out)}; name it as "
                "a segment to see it",
                file,
            )
    if empty := [one.name for one in chosen if not one.lines]:
        _warn(
            f"regions without closed lines: {', '.join(empty[:N_NAMED])}{', ...' if len(empty) > N_NAMED else ''}", file
        )
    if len(empty) == len(chosen):
        raise FileError(f"the structure set (RTSTRUCT) has no closed lines of these regions; name others: {file}")
    return chosen


def in_unit_of(scan: Grid, lines: Sequence[NDArray[np.float64]]) -> list[NDArray[np.float64]]:
    """Lines in a patient, mm, in the world of a scan.

    Raises
    ------
    ArgumentError
        If the scan does not say where it lies in the patient, or its unit has no size that is known.
    """
    if not scan.is_anatomical:
        raise ArgumentError(
            f"the scan {scan.name!r} says nothing of a patient, and lines of a structure set (RTSTRUCT) lie in one; "
            "open the DICOM or NIfTI series that it was drawn on"
        )
    scale = units.factor("mm", scan.unit)
    if scale is None:
        raise ArgumentError(
            f"lines of a structure set (RTSTRUCT) are in millimetres, and the size of {scan.unit!r}, the unit of the "
            f"scan {scan.name!r}, is unknown; open it with spacing= and unit='mm'"
        )
    return [line * scale for line in lines]


def _warn(text: str, file: Path, *, stacklevel: int = 6) -> None:
    warn(f"{text}: {file}", FileWarning, stacklevel=stacklevel)
