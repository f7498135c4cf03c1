"""Names of layers that the user did not name: in legends, colour bars, titles and reports, decided here alone.

A file's own name is shown, without its folders, where it may be the only name that there is: of microscopes and
simulations. Scans of patients are often in files and folders with the patients' names, so they are called by channel,
quantity or modality, else by the kind of their data; where two would be the same, by the description of the series too,
else by a number.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from wavesplat._looks.kinds.kinds import kind_of, unit_of_values
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume import grid
from wavesplat._model.volume.grid import name_of_facts
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._storage.paths import FileName

AnyVolume: TypeAlias = Volume | WaveletVolume
#: Name of a scan whose kind is not known before its samples are read.
UNKNOWN = "scan"


class FoundName(str):
    """A layer's default name, not given by the user; scenes change it if two layers have the same."""


def is_of_patient(volume: AnyVolume) -> bool:
    """Whether the name of a volume was taken from a file or folder, and may be a patient's."""
    if grid.is_of_patient(volume):
        return True
    return isinstance(volume.name, FileName) and not isinstance(volume, LazyVolume) and unit_of_values(volume) == "HU"


def layer_name_of(thing: AnyVolume | Series, time: int = 0) -> str:
    """The default name of a layer that shows a volume or series; a `FoundName` if it is not the volume's name.

    time : the volume of a series to look at; a series has one name at all times.
    """
    if isinstance(thing, Series):
        if not isinstance(thing.name, FileName):
            return thing.name
        if thing._shown_name is None:
            found = layer_name_of(thing[time])
            thing._shown_name = found if isinstance(found, FoundName) else str(thing.name)
        return thing._shown_name
    return FoundName(name_of_facts(thing.facts) or _kind(thing)) if is_of_patient(thing) else str(thing.name)


def distinct_names(names: Sequence[str], description: Callable[[int], str | None]) -> list[str]:
    """Names of layers, with a found name changed if another layer has it too.

    description : of the volume of a layer, by the number of the layer.
    """
    made = list(names)
    for name in dict.fromkeys(names):
        same = [n for n, one in enumerate(names) if one == name]
        if len(same) == 1 or not any(isinstance(names[n], FoundName) for n in same):
            continue
        described = [description(n) for n in same]
        is_enough = all(described) and len(set(described)) == len(same)
        for place, n in enumerate(same):
            if isinstance(names[n], FoundName):
                made[n] = FoundName(f"{name}, {described[place]}" if is_enough else f"{name} {place + 1}")
    return made


def _kind(volume: AnyVolume) -> str:
    # A lazy volume is not read for its name.
    return UNKNOWN if isinstance(volume, LazyVolume) else kind_of(volume)
