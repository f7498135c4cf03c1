"""Names of scans by channel, quantity or modality, not by files or folders, which may be named after a patient."""

from __future__ import annotations

from wavesplat._files.file_names import NAMELESS, FileName
from wavesplat._model.facts import Facts
from wavesplat._model.grid import Grid

#: Modalities of samples that are no patients, whose files are named after what they show.
MICROSCOPY = ("fluorescence", "EM")
#: Words for modalities whose codes few people say.
WORDS = {"PT": "PET", "RTDOSE": "dose", "SEG": "labels", "US": "ultrasound", "IVUS": "ultrasound"}


def name_of_facts(facts: Facts) -> str | None:
    """The channel, else the quantity, else the modality; None if the file names none of them."""
    channel = facts.channel.name if facts.channel is not None else ""
    modality = None if facts.modality is None else WORDS.get(facts.modality, facts.modality)
    return channel or facts.quantity or modality


def is_scan(facts: Facts) -> bool:
    """Whether a file says that it holds a scan of a patient."""
    return facts.is_anatomical or facts.modality not in (None, *MICROSCOPY)


def is_of_patient(grid: Grid) -> bool:
    """Whether the name of a volume was taken from a file or folder, and may be a patient's, by what the file says."""
    return isinstance(grid.name, FileName) and (grid.name.is_private or is_scan(grid.facts))


def name_in_files(grid: Grid) -> str:
    """The name that files say a volume has."""
    return name_of_facts(grid.facts) or NAMELESS if is_of_patient(grid) else grid.name
