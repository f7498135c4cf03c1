"""Names and colours of labels, from the segmentation's file or from a table beside it.

In the file: segments of 3D Slicer (.seg.nrrd: `Segment0_LabelValue`, `_Name`, `_Color`), the label table of Connectome
Workbench (code 30) and TotalSegmentator (code 0) in extensions of NIfTI (`<Label Key="1" Red="1" ...>liver</Label>`),
the segments of DICOM segmentations (`SegmentLabel`, `RecommendedDisplayCIELabValue`), and `image-label` of OME-Zarr.
Tables: ITK-SNAP's label descriptions, 3D Slicer's colour tables (.ctbl), lists of Connectome Workbench (a line with the
name, then one with number and RGBA), and the look-up tables of BIDS (.tsv with the columns index, name and, if
they are there, color).
"""

from __future__ import annotations

import csv
import fnmatch
import re
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import unescape
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from wavesplat._looks.curves.colors import rgb_from_lab
from wavesplat._model.volume.volume import Volume
from wavesplat._storage.addresses import is_address
from wavesplat._storage.paths import expanded, read_text
from wavesplat.errors import ArgumentError, FileError

#: A label's name, and its colour, 0..1, where there is one.
Named: TypeAlias = "tuple[str, tuple[float, float, float] | None]"

#: Longest header that is searched for names, bytes.
MAX_HEADER_BYTES = 2**22
#: Maximum number of digits of a label's number: numbers of 64 bits have at most 20.
MAX_DIGITS = 20
#: Letters of a line in messages, at most.
MAX_LETTERS = 100


def in_file(path: str | PathLike[str], dataset: str | None = None) -> dict[int, Named]:
    """Names and colours in a segmentation's own file, by number; empty where it has none.

    dataset : the path of the segmentation in an OME-Zarr image.
    """
    # Here, since most pictures have no segmentation, and these readers are half of the readers' modules.
    from wavesplat._readers.opening import is_zarr

    if is_zarr(path):
        from wavesplat._readers.zarr import ome_zarr

        return ome_zarr.label_looks(path, dataset)
    place = expanded(path)
    name = place.name.lower()
    if name.endswith((".nrrd", ".nhdr")):
        return _segments(_nrrd_header(place))
    if name.endswith((".nii", ".nii.gz")):
        return _nifti_labels(place)
    from wavesplat._readers.dicom.segments import segments_at

    return {segment.number: (segment.name, _of_lab(segment.lab)) for segment in segments_at(place)}


def of_volume(volume: Volume) -> dict[int, Named]:
    """Names and colours in the file that a segmentation was opened from; empty where it has none, or is gone."""
    source = volume._source or {}
    path = source.get("path")
    if not isinstance(path, str) or is_address(path):
        return {}
    try:
        return in_file(path, source.get("dataset"))
    except (FileError, OSError):
        return {}


def in_table(path: str | PathLike[str]) -> dict[int, Named]:
    """A table of names.

    Raises
    ------
    FileError
        If it cannot be read, or is none of the known tables.
    """
    text = read_text(path, "table of labels")
    read = _bids if str(path).lower().endswith(".tsv") else _pairs if _is_of_pairs(text) else _columns
    try:
        found = read(text)
    except (ArgumentError, ValueError, IndexError, TypeError, csv.Error) as error:
        raise FileError(f"the table of labels: {error}: {path}") from None
    if not found:
        raise FileError(
            "the table of labels holds none; give ITK-SNAP's label descriptions, a colour table of 3D Slicer (.ctbl), "
            f"a label list of Connectome Workbench, or a .tsv with the columns index and name: {path}"
        )
    return found


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


def _nrrd_header(path: Path) -> dict[str, str]:
    """The pairs `key:=value` of a header, which ends at the first empty line."""
    with path.open("rb") as file:
        header = re.split(rb"\r?\n\r?\n", file.read(MAX_HEADER_BYTES), maxsplit=1)[0]
    pairs = (line.partition(":=") for line in header.decode("utf-8", "replace").splitlines() if ":=" in line)
    return {key.strip(): value.strip() for key, _, value in pairs}


def _segments(header: dict[str, str]) -> dict[int, Named]:
    found: dict[int, Named] = {}
    for key, value in header.items():
        match = re.fullmatch(r"(Segment\d+)_LabelValue", key)
        if match is None or (number := _number(value)) is None:
            continue
        numbers = _floats(header.get(f"{match[1]}_Color", "").split())
        name = header.get(f"{match[1]}_Name") or header.get(f"{match[1]}_ID") or value
        found[number] = (name, _color(numbers, 1.0))
    return found


def _nifti_labels(path: Path) -> dict[int, Named]:
    import nibabel

    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", module="nibabel")
            image = nibabel.load(path)
        extensions = list(getattr(image.header, "extensions", []))
    except Exception:  # noqa: BLE001 - nibabel raises anything on a damaged extension; the samples may be sound
        return {}
    found: dict[int, Named] = {}
    for extension in extensions:
        text = _bytes_of(extension).decode("utf-8", "replace")
        for values, name in _label_elements(text):
            number = _number(values.get("Key", values.get("Index", "")))
            if number is not None:
                numbers = _floats([values.get(channel, "") for channel in ("Red", "Green", "Blue")])
                found[number] = (name or str(number), _color(numbers, 1.0))
    return found


def _bytes_of(extension: Any) -> bytes:
    """The bytes of an extension of NIfTI; empty if nibabel does not give them.

    nibabel has no form of most codes, among them Connectome Workbench's, and raises where it is asked for one; from 5.3
    on it has the bytes themselves.
    """
    try:
        content = extension.content if hasattr(extension, "content") else extension.get_content()
    except Exception:  # noqa: BLE001 - an extension of another kind, which nibabel cannot write again
        return b""
    return content if isinstance(content, bytes) else str(content).encode()


def _label_elements(text: str) -> Iterator[tuple[dict[str, str], str]]:
    """Attributes and content of each `<Label>`; by splits, since expressions that search for ends take n^2 steps."""
    for element in text.split("<Label")[1:]:
        start, is_closed, rest = element.partition(">")
        content, is_ended, _ = rest.partition("</Label>")
        if not (start[:1].isspace() and is_closed and is_ended):
            continue
        values = {}
        parts = start.split('"')
        for before, value in zip(parts[::2], parts[1::2], strict=False):
            if words := before.rstrip().removesuffix("=").split():
                values[words[-1]] = value
        plain = content.replace("<![CDATA[", "").replace("]]>", "")
        yield values, _unescaped(plain).strip()


def _unescaped(text: str) -> str:
    try:
        return unescape(text)
    except ValueError:  # the number of a letter with more than 4300 digits
        return text


def _number(text: str) -> int | None:
    """A label's number; None for other text, and for more digits than any type of samples has."""
    return int(text) if text.isdecimal() and len(text) <= MAX_DIGITS else None


def _columns(text: str) -> dict[int, Named]:
    """Labels of ITK-SNAP (`1 255 0 0 1 1 1 "liver"`) or 3D Slicer (`1 liver 255 0 0 255`, underscores for blanks)."""
    found: dict[int, Named] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        before, is_quoted, name = line.strip().partition('"')
        fields = line.split()
        index = _number(fields[0])
        if index is not None and is_quoted and name.endswith('"') and before[-1:].isspace():
            found[index] = (name[:-1], _color(_floats(before.split()[1:4]), 255.0))
        elif index is not None and len(fields) >= 5:
            found[index] = (fields[1].replace("_", " "), _color(_floats(fields[2:5]), 255.0))
        else:
            shown = line.strip()
            shown = repr(shown) if len(shown) <= MAX_LETTERS else f"{shown[:MAX_LETTERS]!r}..."
            raise ArgumentError(f"line {number} is {shown}; it must be a number, a name and a colour 0..255")
    return found


def _lines(text: str) -> list[str]:
    return [line.strip() for line in text.splitlines() if line.strip()]


def _is_of_pairs(text: str) -> bool:
    """Whether a table has a line with a name, then one of five whole numbers, as Connectome Workbench lists labels."""
    lines = _lines(text)
    numbers = [line.split() for line in lines[1::2]]
    return (
        len(lines) % 2 == 0
        and bool(lines)
        and all(len(fields) == 5 and all(field.lstrip("-").isdecimal() for field in fields) for fields in numbers)
    )


def _pairs(text: str) -> dict[int, Named]:
    """Labels of Connectome Workbench: `left kidney`, and in the next line `5 255 0 51 255`, number and RGBA."""
    lines = _lines(text)
    found: dict[int, Named] = {}
    for name, line in zip(lines[::2], lines[1::2], strict=True):
        number, *rgba = line.split()
        found[int(number)] = (name, _color(_floats(rgba[:3]), 255.0))
    return found


def _bids(text: str) -> dict[int, Named]:
    rows = csv.DictReader(text.splitlines(), delimiter="\t")
    if not {"index", "name"} <= set(rows.fieldnames or ()):
        raise ArgumentError("its first line must name the columns index and name")
    found: dict[int, Named] = {}
    for row in rows:
        code = (row.get("color") or "").lstrip("#")
        is_code = re.fullmatch(r"[0-9a-fA-F]{6}", code) is not None
        numbers = [float(int(code[i : i + 2], 16)) for i in (0, 2, 4)] if is_code else []
        found[int(row["index"])] = (row["name"] or row["index"], _color(numbers, 255.0))
    return found


def _floats(fields: Iterable[str]) -> list[float]:
    try:
        return [float(field) for field in fields]
    except ValueError:
        return []


def _color(numbers: list[float], white: float) -> tuple[float, float, float] | None:
    """Three numbers as a colour; None if they are no colour."""
    if len(numbers) != 3 or not all(0 <= number <= white for number in numbers):
        return None
    red, green, blue = (number / white for number in numbers)
    return red, green, blue


def _of_lab(lab: tuple[float, float, float] | None) -> tuple[float, float, float] | None:
    """A colour of CIE Lab in sRGB."""
    if lab is None:
        return None
    red, green, blue = rgb_from_lab(np.array(lab)).tolist()
    return red, green, blue
