"""Looks by name: ours, and those of 3D Slicer; `crates/look` has their numbers (`presets`).

How a name is written does not matter: case, and `-`, `_` or a blank between words, are alike.
Where Slicer has a preset of the same name as ours, the plain name is ours, and `slicer-` before it means Slicer's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cache, partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from wavesplat import _native
from wavesplat._looks import look_files
from wavesplat._looks.body.brain import brain_of
from wavesplat._looks.interchange import slicer_files
from wavesplat._looks.kinds.histogram import is_hounsfield
from wavesplat._looks.kinds.kinds import Evidence, Kind, evidence, offset_of
from wavesplat._looks.look import Look
from wavesplat._system.threads import warn
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

#: Kinds of data that presets are for, in the order of lists, and their titles.
GROUPS: dict[str, str] = _native.PRESET_GROUPS
#: A name without differences that do not matter: case and kinds of separators.
plain = _native.plain_name
#: Kinds of presets for each kind of data.
KINDS_FOR: dict[Kind, tuple[str, ...]] = {
    "CT": ("ct",),
    "MR": ("mr",),
    "PET": ("pet",),
    "dose": (),
    "ultrasound": (),
    "fluorescence": ("microscopy",),
    "EM": ("microscopy",),
    "FA": (),
    "probability": (),
    "map": (),
    "p-values": (),
    "signed field": ("simulation",),
    "field": ("microscopy", "simulation"),
    "mask": (),
    "labels": (),
    "scan": ("mr", "microscopy", "simulation"),
}
#: Largest number of names that are offered for an unknown one, and least similarity of a near one.
N_OFFERED = 6
CLOSE = 0.5


@dataclass(frozen=True)
class Preset:
    """A preset of the catalogue; `kind` is one of `GROUPS`."""

    name: str
    kind: str
    description: str
    is_hounsfield: bool
    build: Callable[[Volume | WaveletVolume | None], Look]
    #: Part of the body that it draws; None is all.
    part: str | None = None


@cache
def catalogue() -> dict[str, Preset]:
    """All presets but `auto`, by name, in groups; names within a group are in alphabetical order."""
    found = [_of_document(document) for document in _native.presets()]
    for name, has_units, fields in _native.slicer_presets():
        one = slicer_files.VolumeProperty(**fields)
        found.append(Preset(name, "slicer", _in_words(one), has_units, one.look))
    return {preset.name: preset for preset in found}


def names() -> list[str]:
    """Names of all presets, `auto` first."""
    return ["auto", *catalogue()]


def preset(name: str, volume: Volume | WaveletVolume | None) -> Look:
    """See `Look.preset`."""
    found = checked_name(name)
    if found == "auto":
        if volume is None:
            raise ArgumentError("preset 'auto' is made from a volume's histogram; pass the volume too")
        return Look.auto(volume)
    entry = catalogue()[found]
    look = replace(entry.build(_looked_at(entry, volume)), name=found)
    if not (entry.is_hounsfield and volume is not None):
        return look
    offset = added_to_hounsfield(f"preset {found!r}", volume)
    return replace(look, transfer_function=look.transfer_function._moved(offset)) if offset else look


def _looked_at(entry: Preset, volume: Volume | WaveletVolume | None) -> Volume | WaveletVolume | None:
    """The volume whose values a preset is fitted to: the part that it draws, where that is found."""
    if entry.part != "brain" or volume is None:
        return volume
    found = brain_of(volume)
    return volume if isinstance(found, str) else found


def fitting(volume: Volume | WaveletVolume) -> list[Preset]:
    """Our presets that fit the kind of data that a volume seems to hold; where it is uncertain, a few more."""
    known = evidence(volume)
    kinds = _kinds(known)
    low, high = volume.value_range
    # Left out where no value is negative, or where none is positive and has a logarithm.
    out = {"signed"} if low >= 0 else set()
    out |= {"log"} if high <= 0 else set()
    # Left out where a dark background would show as a black box.
    out |= {"em"} if known.kind != "EM" else set()
    return [preset for preset in catalogue().values() if preset.kind in kinds and preset.name not in out]


def _kinds(known: Evidence) -> tuple[str, ...]:
    fitting = (*KINDS_FOR[known.kind], "any")
    # A patient's scan, from an unknown machine.
    return ("mr", "pet", "any") if known.kind in ("MR", "PET") and known.is_guess else fitting


def added_to_hounsfield(what: str, volume: Volume | WaveletVolume) -> float:
    """The offset that is added to a volume's Hounsfield units, by which looks for them must move: 0, 1000 or 1024.

    Warn if it is moved, and if the values do not look like Hounsfield units: by modality, or without air and tissue.
    """
    modality = volume.modality
    if not modality and is_hounsfield(volume):
        return 0.0
    if offset := offset_of(volume):
        warn(
            f"{what} is moved up by {offset:g}, which seems to be added to the Hounsfield units of volume "
            f"{volume.name!r}: a guess by its values",
            stacklevel=4,
        )
        return offset
    if modality == "CT":
        return 0.0
    why = f"the file says {modality}" if modality else "there is no air near -1000 with soft tissue near 0"
    low, high = volume.value_range
    warn(
        f"{what} is for Hounsfield units, and the values of volume {volume.name!r}, {low:g} to {high:g}, do not look "
        f"like them: {why}; what it shows may be wrong",
        stacklevel=4,
    )
    return 0.0


def _of_document(document: dict[str, Any]) -> Preset:
    is_hounsfield = document["transfer_function"]["values"] == "hounsfield"
    build = partial(look_files.build, document)
    return Preset(document["name"], document["kind"], document["description"], is_hounsfield, build, document["part"])


def _in_words(one: slicer_files.VolumeProperty) -> str:
    """A description of a preset of Slicer, which has none: from what value on it shows, and whether it is lit."""
    low = next((at for (at, _), (_, after) in pairwise(one.opacity) if after > 0), one.opacity[0][0])
    lit = "lit" if one.shade else "without light"
    return f"Shows what is above {low:g}, {lit}."


def checked_name(name: str) -> str:
    """The preset's own spelling of a name, or an `ArgumentError` that offers near ones."""
    wanted = plain(name)
    spellings = {plain(known): known for known in names()}
    # Slicer's own names have no prefix; all of them may have it.
    of_slicer = [known.name for known in catalogue().values() if known.kind == "slicer"]
    spellings |= {_native.SLICER_PREFIX + plain(known): known for known in of_slicer}
    if wanted in spellings:
        return spellings[wanted]
    within = [known for spelled, known in spellings.items() if wanted and wanted in spelled]
    near = [spellings[spelled] for spelled in get_close_matches(wanted, spellings, N_OFFERED, CLOSE)]
    offered = list(dict.fromkeys([*within, *near]))[:N_OFFERED]
    hint = f"did you mean {', '.join(offered)}? " if offered else ""
    raise ArgumentError(f"unknown preset {name!r}; {hint}`wavesplat presets` lists all")
