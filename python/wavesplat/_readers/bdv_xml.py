"""BigDataViewer's XML (SpimData): setups, time points, and where each view of them lies.

A view is a setup at a time point. A setup has attributes: a channel, a tile, an angle, a direction of light. The
transforms of a view are multiplied in the order in which they are listed, so that the last one is applied first; they
lead from the numbers of samples (x, y, z) to the world.
Source: Pietzsch et al., "BigDataViewer" (2015), https://imagej.net/plugins/bdv; the library spim_data.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from wavesplat._model import units
from wavesplat.errors import FileError

#: Largest XML that is read, in bytes; those with thousands of views have some million.
MAX_XML_BYTES = 1 << 26
#: Largest number of time points.
MAX_TIMES = 1 << 20


@dataclass(frozen=True)
class Setup:
    """A setup: its number, name, distances of samples (x, y, z) with their unit, and attributes."""

    number: int
    name: str = ""
    voxel: tuple[float, float, float] | None = None
    unit: str | None = None
    #: Kind of an attribute ("channel", "tile", ...) -> the name of its value, else its number.
    attributes: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class SpimData:
    """The content of an XML: format and path of the samples, setups, numbers of time points, and registrations."""

    format: str
    #: Path of the samples as it is written, from the folder of the XML; empty where there is none.
    samples: str
    setups: tuple[Setup, ...]
    times: tuple[int, ...]
    #: (time point, setup) -> world from index.
    registrations: dict[tuple[int, int], NDArray[np.float64]] = field(default_factory=dict)
    missing: frozenset[tuple[int, int]] = frozenset()


def parsed(path: Path) -> SpimData | None:
    """The content of an XML; None if it is none of BigDataViewer, a `FileError` if it is damaged."""
    with path.open("rb") as file:
        text = file.read(MAX_XML_BYTES + 1)
    if b"<SpimData" not in text:
        return None
    if len(text) > MAX_XML_BYTES:
        raise FileError(f"the XML is larger than {MAX_XML_BYTES >> 20} MiB, which none of BigDataViewer is: {path}")
    if b"<!DOCTYPE" in text or b"\0" in text:  # entities could grow without bound
        raise FileError(f"the XML has a document type, which BigDataViewer's has not; export it again: {path}")
    try:
        return _spim_data(ET.fromstring(text))  # noqa: S314 - see above
    except (ET.ParseError, ValueError, OverflowError) as error:
        raise FileError(f"damaged: the XML of BigDataViewer says {error}; copy or export it again: {path}") from error


def _spim_data(root: ET.Element) -> SpimData:
    sequence = root.find("SequenceDescription")
    loader = None if sequence is None else sequence.find("ImageLoader")
    if sequence is None or loader is None:
        raise ValueError("nothing of its images")
    views = [(_whole(view, "timepoint"), _whole(view, "setup")) for view in sequence.iter("MissingView")]
    return SpimData(
        loader.get("format", ""),
        _path_of_samples(root, loader),
        _setups(sequence),
        _times(sequence.find("Timepoints")),
        {
            (_whole(view, "timepoint"), _whole(view, "setup")): _registration(view)
            for view in root.iterfind("ViewRegistrations/ViewRegistration")
        },
        frozenset(views),
    )


def _path_of_samples(root: ET.Element, loader: ET.Element) -> str:
    named = next((loader.find(name) for name in ("hdf5", "n5", "zarr") if loader.find(name) is not None), None)
    if named is None:
        return ""
    name = (named.text or "").strip()
    if named.get("type", "relative") != "relative":
        return name
    return (Path((root.findtext("BasePath") or ".").strip()) / name).as_posix()


def _setups(sequence: ET.Element) -> tuple[Setup, ...]:
    names = _names_of_attributes(sequence)
    found = []
    for part in sequence.iterfind("ViewSetups/ViewSetup"):
        size = _floats(part.findtext("voxelSize/size") or "")
        given = {one.tag: (one.text or "").strip() for one in part.findall("attributes/*")}
        attributes = {kind: names.get((kind, value)) or value for kind, value in given.items()}
        found.append(
            Setup(
                int(part.findtext("id") or ""),
                (part.findtext("name") or "").strip(),
                (size[0], size[1], size[2]) if len(size) == 3 and all(step > 0 for step in size) else None,
                units.canonical(part.findtext("voxelSize/unit")),
                attributes,
            )
        )
    if len({one.number for one in found}) != len(found) or not found:
        raise ValueError("no setups, or two of one number")
    return tuple(sorted(found, key=lambda one: one.number))


def _names_of_attributes(sequence: ET.Element) -> dict[tuple[str, str], str]:
    """(kind, number) of attributes -> their names, such as ("channel", "0") -> "DAPI"."""
    found = {}
    for group in sequence.iterfind("ViewSetups/Attributes"):
        for part in group:
            number, name = (part.findtext("id") or "").strip(), (part.findtext("name") or "").strip()
            if name:
                found[(group.get("name", ""), number)] = name
    return found


def _times(part: ET.Element | None) -> tuple[int, ...]:
    """Numbers of the time points: a range, a list, or a pattern such as "0-9:3, 12"."""
    if part is None:
        return (0,)
    kind = part.get("type", "range")
    if kind == "range":
        numbers: Iterable[int] = range(int(part.findtext("first") or "0"), int(part.findtext("last") or "0") + 1)
    elif kind == "pattern":
        numbers = _of_pattern(part.findtext("integerpattern") or "")
    else:
        numbers = sorted(int(one.findtext("id") or "") for one in part.iter("Timepoint"))
    times = tuple(dict.fromkeys(number for number, _ in zip(numbers, range(MAX_TIMES + 1), strict=False)))
    if not 1 <= len(times) <= MAX_TIMES:
        raise ValueError("no time points, or too many")
    return times


def _of_pattern(text: str) -> Iterator[int]:
    for part in filter(None, (one.strip() for one in text.split(","))):
        ends, _, step = part.partition(":")
        first, _, last = ends.partition("-")
        yield from range(int(first), int(last or first) + 1, int(step or "1"))


def _registration(view: ET.Element) -> NDArray[np.float64]:
    matrix = np.eye(4)
    for part in view.iterfind("ViewTransform/affine"):
        numbers = _floats(part.text or "")
        if len(numbers) != 12:
            raise ValueError(f"an affine of {len(numbers)} numbers, not 12")
        matrix = matrix @ np.vstack([np.reshape(numbers, (3, 4)), (0.0, 0.0, 0.0, 1.0)])
    if not (np.isfinite(matrix).all() and np.linalg.det(matrix) != 0):
        raise ValueError("an affine that cannot be inverted")
    return matrix


def _floats(text: str) -> list[float]:
    return [float(number) for number in text.split()]


def _whole(element: ET.Element, name: str) -> int:
    return int(element.get(name, ""))
