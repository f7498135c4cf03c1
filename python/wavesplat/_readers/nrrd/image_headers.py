"""Headers of NRRD and MetaImage files, for what SimpleITK leaves out: units, anatomy, modality, and zlib streams.

NRRD: https://teem.sourceforge.net/nrrd/format.html. Lines are `field: value` or `key:=value`, and only the former are
the format's own. MetaImage: https://docs.itk.org/en/latest/learn/metaio.html, lines `Field = value`.
"""

from __future__ import annotations

import re
import zlib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.itk_image import SIGNS_OF_ITK, UNIT, VALUE_UNIT, modality_of, ras_signs_of
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Facts, value_unit_of
from wavesplat._model.volume.grid import NO_PLACE
from wavesplat._readers.nrrd.nrrd_for_itk import PLACE_FIELDS, ListedAxis, is_space_with_time, listed_axis
from wavesplat.errors import FileError

N_HEADER_BYTES = 2**20
#: Names of fields that may also be written together.
SPELLINGS = {name.replace(" ", ""): name for name in PLACE_FIELDS}
QUOTED = re.compile(r'"((?:[^"\\]|\\.)*)"')
META_TYPES = {
    "MET_CHAR": "i1",
    "MET_UCHAR": "u1",
    "MET_SHORT": "i2",
    "MET_USHORT": "u2",
    "MET_INT": "i4",
    "MET_UINT": "u4",
    "MET_LONG": "i4",
    "MET_ULONG": "u4",
    "MET_LONG_LONG": "i8",
    "MET_ULONG_LONG": "u8",
    "MET_FLOAT": "f4",
    "MET_DOUBLE": "f8",
}


@dataclass(frozen=True)
class Header:
    """The fields of a header, names in lower case, and their meaning."""

    fields: dict[str, str]
    facts: Facts
    #: Factors that convert lengths along the index axes, and along the world's axes, to the unit of `facts`.
    index_factors: tuple[float, float, float] = (1.0, 1.0, 1.0)
    world_factors: tuple[float, float, float] = (1.0, 1.0, 1.0)
    keys: dict[str, str] = field(default_factory=dict)
    #: The axis that ITK takes for the components of a sample: an axis of times, or of channels.
    listed: ListedAxis | None = None
    #: Signs by which ITK's world becomes RAS, of a patient.
    ras_signs: tuple[float, float, float] = SIGNS_OF_ITK

    def in_one_unit(self, world_from_index: NDArray[np.float64]) -> NDArray[np.float64]:
        """The affine with all lengths in one unit."""
        matrix = world_from_index.copy()
        matrix[:3, :3] *= self.index_factors
        matrix[:3] *= np.array(self.world_factors)[:, None]
        return matrix


# NRRD


def of_nrrd(path: Path) -> Header:
    """The header of an NRRD file, up to an empty line or a list of file names.

    pynrrd 1.1.3 is no help: it failed on 47 of 164 headers that are read here. It knows no lists and patterns of files,
    no "hex", no blanks in vectors, takes the key in `kinds:=` for the field, and drops letters such as the micro sign.
    """
    fields: dict[str, str] = {}
    keys: dict[str, str] = {}
    for line in _lines(path)[1:]:
        if not line:
            break
        name, colon, value = line.partition(":")
        if line.startswith("#") or not colon:
            continue
        # In `key:=value` anything may be a key, also the name of a field.
        if value.startswith("="):
            keys[name.strip().lower()] = value[1:].strip()
            continue
        name = name.strip().lower()
        fields[SPELLINGS.get(name, name)] = value.strip()
        if name in ("data file", "datafile") and value.strip().upper().startswith("LIST"):
            break
    signs = ras_signs_of(fields.get("space", ""))
    is_anatomical = signs is not None
    axis = listed_axis(fields)
    named = _three_units(fields.get("space units", ""), without=3 if is_space_with_time(fields) else None)
    unit, world_factors = units.in_one_unit(named)
    index_factors = (1.0, 1.0, 1.0)
    if unit is None and "space directions" not in fields:
        named = _three_units(fields.get("units", ""))
        unit, index_factors = units.in_one_unit(named)
    if unit is None:  # ITK has no units, and keeps one as a key
        unit, factor = units.of_file(keys.get(UNIT))
        world_factors = (factor, factor, factor)
    conventions = []
    if unit is None and is_anatomical:
        unit = "mm"
        conventions.append("unit mm: the file names none; programs that read NRRD of patients take millimetres")
    modality = modality_of(keys)
    if conventions and modality is None and _has_no_place(fields):
        conventions.append(NO_PLACE)
    guesses = (
        [] if {"spacings", "space directions"} & set(fields) else ["distances of samples 1, 1, 1: the file has none"]
    )
    guesses += units.guesses_of(named)
    facts = Facts(
        unit=unit,
        is_anatomical=is_anatomical,
        modality=modality,
        value_unit=value_unit_of(fields.get("sample units", "").strip('"') or keys.get(VALUE_UNIT)),
        conventions=tuple(conventions),
        guesses=tuple(guesses),
    )
    facts = replace(facts, **_times(axis, fields, keys))
    return Header(fields, facts, index_factors, world_factors, keys, axis, signs or SIGNS_OF_ITK)


def _has_no_place(fields: dict[str, str]) -> bool:
    """Whether directions and origin of an NRRD file are those that ITK writes for an image without a place."""
    directions, origin = (
        _floats(re.sub(r"[(),]", " ", fields.get(name, "")).split()) for name in ("space directions", "space origin")
    )
    return directions == [1, 0, 0, 0, 1, 0, 0, 0, 1] and origin in ([], [0, 0, 0])


def _times(listed: ListedAxis | None, fields: dict[str, str], keys: dict[str, str]) -> dict[str, Any]:
    """Facts about times: of an axis beside the axes of space, or the unit of the fourth axis of a space with time."""
    if listed is not None:
        return _listed_times(listed.number, listed.size, fields, keys)
    named = _quoted(fields.get("space units", ""))
    return {"time_unit": named[3] or None} if is_space_with_time(fields) and len(named) == 4 else {}


def _listed_times(axis: int, count: int, fields: dict[str, str], keys: dict[str, str]) -> dict[str, Any]:
    """Times of an axis: as 3D Slicer writes them for sequences and multi-volumes, or by the axis' own spacing."""
    values = keys.get(f"axis {axis} index values", "").split() or keys.get("multivolume.framelabels", "").split(",")
    times = _floats(values)
    named = _quoted(fields.get("units", ""))
    unit = keys.get("multivolume.frameidentifyingdicomtagunits") or (named[axis] if len(named) == 4 else None)
    if len(times) == count:
        return {"n_times": count, "times": tuple(times), "time_unit": unit or None}
    steps = _floats(fields.get("spacings", "").split())
    step = steps[axis] if len(steps) == 4 and np.isfinite(steps[axis]) and steps[axis] > 0 else None
    return {"n_times": count, "time_step": step, "time_unit": (unit or None) if step else None}


def _floats(texts: list[str]) -> list[float]:
    try:
        return [float(text) for text in texts]
    except ValueError:
        return []


def _quoted(text: str) -> list[str]:
    """Texts in quotation marks; quotation marks inside are escaped by a backslash."""
    found: list[str] = []
    at = text.find('"')
    # Not `findall`: after each opening mark without a closing one it would scan the rest again.
    while at >= 0 and (match := QUOTED.match(text, at)):
        found.append(match[1])
        at = text.find('"', match.end())
    return found


def _three_units(text: str, without: int | None = None) -> tuple[str | None, str | None, str | None]:
    """The units in `"mm" "mm" "mm"`; of four axes those but `without`, else the last: vectors' come first."""
    named = [units.canonical(name) for name in _quoted(text)]
    if without is not None and len(named) == 4:
        del named[without]
    return (named[-3], named[-2], named[-1]) if len(named) >= 3 else (None, None, None)


# MetaImage


def of_meta_image(path: Path) -> Header:
    """The header of a MetaImage, up to ElementDataFile."""
    fields: dict[str, str] = {}
    for line in _lines(path):
        name, _, value = line.partition("=")
        fields[name.strip().lower()] = value.strip()
        if "elementdatafile" in fields:
            break
    unit, factor = units.of_file(fields.get("distanceunits", "").replace("?", ""))
    conventions = ["axes of a patient: MetaImage is ITK's format, and these are ITK's"]
    if unit is None:
        unit = "mm"
        conventions.append("unit mm: the file names none; millimetres are ITK's convention")
    modality = modality_of(fields)
    if len(conventions) > 1 and modality is None and _has_no_place_of_meta_image(fields):
        conventions.append(NO_PLACE)
    facts = Facts(unit=unit, is_anatomical=True, modality=modality, conventions=tuple(conventions))
    return Header(fields, facts, world_factors=(factor, factor, factor))


def _has_no_place_of_meta_image(fields: dict[str, str]) -> bool:
    """Whether distances, directions and origin of a MetaImage are missing or the format's defaults."""
    defaults = (
        (("elementspacing", "elementsize"), [1, 1, 1]),
        (("transformmatrix", "rotation", "orientation"), [1, 0, 0, 0, 1, 0, 0, 0, 1]),
        (("offset", "origin", "position"), [0, 0, 0]),
    )
    return all(_floats(fields[name].split()) == usual for names, usual in defaults for name in names if name in fields)


def inflated(path: Path, header: Header, shape: tuple[int, ...]) -> NDArray[Any]:
    """Samples of a zlib stream whose length the header does not give, which ITK would read wrong."""
    fields = header.fields
    name = fields.get("elementdatafile", "LOCAL")
    content = path.read_bytes() if name.upper() == "LOCAL" else (path.parent / name).read_bytes()
    if name.upper() == "LOCAL":
        line = re.search(rb"(?:\A|\n)[ \t]*ElementDataFile[ \t]*=[^\n]*\n", content)
        content = content[line.end() :] if line else b""
    is_big = fields.get("binarydatabyteordermsb", fields.get("elementbyteordermsb", "False")).lower()[:1] == "t"
    dtype = np.dtype(META_TYPES[fields["elementtype"]]).newbyteorder(">" if is_big else "<")
    needed = int(np.prod(shape)) * dtype.itemsize
    # zlib or gzip, as MetaIO takes.
    stream = zlib.decompressobj(wbits=47)
    data = stream.decompress(content, needed)
    if len(data) != needed or (not stream.eof and stream.decompress(stream.unconsumed_tail, 1)) or not stream.eof:
        raise FileError(
            f"truncated, or a wrong header: it promises {needed} bytes of samples, the zlib stream holds "
            f"{len(data)}{'' if len(data) < needed else ' and more'}; copy or export it again: {path}"
        )
    return np.frombuffer(data, dtype).reshape(shape)


def _lines(path: Path) -> list[str]:
    """Lines of the start of the file, split at line feeds alone, without carriage returns at their ends."""
    with path.open("rb") as file:
        return [line.rstrip("\r") for line in file.read(N_HEADER_BYTES).decode("latin-1").split("\n")]
