"""Attributes of DICOM frames that distinguish frames of one position: kinds of picture (echo, b-value, ...) and times.

A table has each attribute with its tags, in the order in which frames are split by them (`volumes.py`). An attribute
lies beside the pixels in classic files, and in functional groups of all frames or of one in enhanced files (DICOM
PS3.3, C.7.6.16); here both are read by one walk over the same tags. Private tags are those that the vendors' DICOM
conformance statements list for diffusion.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from typing import TYPE_CHECKING, Any, TypeAlias

from wavesplat._readers.dicom.values import MANUFACTURER, Creator, as_numbers, as_text, first_items, raw_value

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

#: Value of an attribute: a number, a direction, or a text.
Value: TypeAlias = float | tuple[float, ...] | str
#: Bytes of a value, and whether its low bytes come first.
Raw: TypeAlias = tuple[bytes, bool]


@dataclass(frozen=True)
class Source:
    """A tag that holds an attribute, and how its bytes are read.

    encoding : "text", "decimal" (a number as text), "f4", "f8", "u2", "u4" (binary), "time", "datetime", "comment" (a
        direction as Canon and Toshiba write it among comments).
    """

    tag: int
    encoding: str
    #: Further tags of the components of a direction, or the date that a time belongs to.
    others: tuple[int, ...] = ()
    creator: Creator | None = None
    count: int = 1


@dataclass(frozen=True)
class Attribute:
    """An attribute by which frames may differ."""

    #: Name in labels.
    name: str
    unit: str
    #: Sources of the value; the first that is there counts.
    sources: tuple[Source, ...]
    #: Whether it orders frames in time, and how many of its units are a second (0: it is a count, and no time).
    is_time: bool = False
    units_per_second: float = 0.0


def _kind(name: str, *sources: Source, unit: str = "") -> Attribute:
    return Attribute(name, unit, sources)


def _time(name: str, *sources: Source, unit: str = "", units_per_second: float = 0.0) -> Attribute:
    return Attribute(name, unit, sources, is_time=True, units_per_second=units_per_second)


SIEMENS, GE_ACQUISITION, GE_PARAMETERS = (
    Creator(0x00190010, "SIEMENS MR HEADER", "SIEMENS"),
    Creator(0x00190010, "GEMS_ACQU", "GE"),
    Creator(0x00430010, "GEMS_PARM", "GE"),
)
PHILIPS = Creator(0x20010010, "Philips Imaging", "PHILIPS")
PHILIPS_MR = Creator(0x20050010, "Philips MR", "PHILIPS")
UIH = Creator(0x00650010, "Image Private Header", "UIH")

#: Attributes in the order in which they split frames, the surest first: kinds of picture, identifiers of times, clocks.
ATTRIBUTES = (
    _kind("", Source(0x00089007, "text"), Source(0x00080008, "text")),  # image type: M, P, ...; its own label
    _kind("component", Source(0x00089208, "text")),
    _kind("echo time", Source(0x00189082, "f8"), Source(0x00180081, "decimal"), unit="ms"),
    _kind("echo", Source(0x00180086, "decimal")),
    _kind("flip angle", Source(0x00181314, "decimal"), unit="degrees"),
    _kind("inversion time", Source(0x00189079, "f8"), Source(0x00180082, "decimal"), unit="ms"),
    _kind(
        "b-value",
        Source(0x00189087, "f8"),
        Source(0x0019100C, "decimal", creator=SIEMENS),
        Source(0x00431039, "decimal", creator=GE_PARAMETERS),
        Source(0x20011003, "f4", creator=PHILIPS),
        Source(0x00651009, "f8", creator=UIH),
    ),
    _kind("diffusion", Source(0x00189075, "text")),
    _kind(
        "direction",
        Source(0x00189089, "f8", count=3),
        Source(0x0019100E, "f8", count=3, creator=SIEMENS),
        Source(0x001910BB, "decimal", (0x001910BC, 0x001910BD), creator=GE_ACQUISITION),
        Source(0x200510B0, "f4", (0x200510B1, 0x200510B2), creator=PHILIPS_MR),
        Source(0x00651037, "f8", count=3, creator=UIH),
        Source(0x00204000, "comment"),
    ),
    _kind("velocity direction", Source(0x00189090, "f8", count=3)),
    _kind("spin labelling", Source(0x00189257, "text")),
    _kind("contrast phase", Source(0x00189344, "text")),
    _kind("contrast agent", Source(0x00180010, "text")),
    _kind("tube voltage", Source(0x00180060, "decimal"), unit="kV"),
    _kind("energy", Source(0x0018937C, "f8"), unit="keV"),
    _kind("reconstruction kernel", Source(0x00181210, "text")),
    _kind("coil", Source(0x00181250, "text")),
    _kind("energy window", Source(0x00540010, "u2")),
    _kind("detector", Source(0x00540020, "u2")),
    _kind("phase", Source(0x00540030, "u2")),
    _kind("rotation", Source(0x00540050, "u2")),
    _kind("angular view", Source(0x00540090, "u2")),
    _time("cardiac phase", Source(0x00209241, "f4"), unit="%"),
    _time("respiratory phase", Source(0x00209245, "f4"), unit="%"),
    _time("RR interval", Source(0x00540060, "u2")),
    _time("time slot", Source(0x00540070, "u2")),
    _time("time slice", Source(0x00540100, "u2")),
    _time("temporal position", Source(0x00209128, "u4"), Source(0x00200100, "decimal")),
    _time("time offset", Source(0x0020930D, "f8"), unit="s", units_per_second=1),
    _time("trigger delay", Source(0x00209153, "f8"), unit="ms", units_per_second=1000),
    _time("respiratory delay", Source(0x00209255, "f8"), unit="ms", units_per_second=1000),
    _time("trigger time", Source(0x00181060, "decimal"), unit="ms", units_per_second=1000),
    _time("reference time", Source(0x00541300, "decimal"), unit="ms", units_per_second=1000),
    # Attributes that may also change from slice to slice for other reasons.
    _kind("repetition time", Source(0x00180080, "decimal"), unit="ms"),
    _kind("sequence", Source(0x00180024, "text")),
    _kind("scan options", Source(0x00180022, "text")),
    _kind("protocol", Source(0x00181030, "text")),
    _kind("series", Source(0x00200011, "decimal")),
    _kind("description", Source(0x0008103E, "text")),
    _time("acquisition", Source(0x00209156, "u2"), Source(0x00200012, "decimal")),
    _time(
        "acquisition date and time",
        Source(0x00189074, "datetime"),
        Source(0x0008002A, "datetime"),
        unit="s",
        units_per_second=1,
    ),
    _time("acquisition time", Source(0x00080032, "time", (0x00080022,)), unit="s", units_per_second=1),
    _time("reference date and time", Source(0x00189151, "datetime"), unit="s", units_per_second=1),
    _time("content time", Source(0x00080033, "time", (0x00080023,)), unit="s", units_per_second=1),
)

#: Sequences with attributes: of frame contents, echoes, timing, modifiers, diffusion and its direction, velocity,
#: spin labelling, heart and breath, temporal position, contrast, X-ray, receive coil, and the types of frames of MR,
#: CT, PET and X-ray.
SEQUENCES = frozenset({
    0x00209111, 0x00189114, 0x00189112, 0x00189115, 0x00189117, 0x00189076, 0x00189197, 0x00189251, 0x00189118,
    0x00209253, 0x00209310, 0x00189341, 0x00189325, 0x00189042, 0x00189226, 0x00189329, 0x00189751, 0x00189504,
})  # fmt: skip
TAGS = frozenset(
    tag
    for attribute in ATTRIBUTES
    for source in attribute.sources
    for tag in (source.tag, *source.others, *(() if source.creator is None else (source.creator.tag, MANUFACTURER)))
)
#: Tags of nuclear medicine whose values have a number for each frame of the file.
VECTORS = (0x00540010, 0x00540020, 0x00540030, 0x00540050, 0x00540060, 0x00540070, 0x00540090, 0x00540100)
#: Significant digits of numbers, so that numbers which were rounded differently are equal.
N_DIGITS = 6
#: GE adds multiples of this to b-values.
GE_B_VALUE = 100_000
SECONDS_PER_DAY = 86400
#: A comment such as b=1500(0.895,0.000,-0.445).
COMMENT = re.compile(r"b=\d+\((-?\d+\.\d+),(-?\d+\.\d+),(-?\d+\.\d+)\)$")


def attributes_of_frames(
    dataset: Dataset, shared: Mapping[int, Any], own: Sequence[Mapping[int, Any]], n_frames: int
) -> list[dict[str, Value]]:
    """Attributes of each frame of a file, by name.

    shared, own : functional groups of all frames, and of each, by tag; empty where there are none.
    """
    found: dict[int, Raw] = {}
    _collect(dataset, found)
    _collect_groups(shared, found)
    vectors = {tag: as_numbers(found.pop(tag), "u2") for tag in VECTORS if tag in found}
    vectors = {tag: numbers for tag, numbers in vectors.items() if len(numbers) == n_frames}
    common = _values(found)
    if not own and not vectors:
        return [common] * n_frames
    frames = []
    for index in range(n_frames):
        of_frame: dict[int, Raw] = {}
        if index < len(own):
            _collect_groups(own[index], of_frame)
        counted = {name: vectors[tag][index] for tag, name in _NAMES_OF_VECTORS.items() if tag in vectors}
        frames.append({**common, **_values(of_frame), **counted})
    return frames


_NAMES_OF_VECTORS = {
    source.tag: attribute.name for attribute in ATTRIBUTES for source in attribute.sources if source.tag in VECTORS
}


def _collect(dataset: Any, found: dict[int, Raw]) -> None:
    """Raw values of all known tags of a dataset and of the sequences in it."""
    for tag in dataset.keys():  # noqa: SIM118 - a dataset iterates over its elements, and converts them
        if tag in TAGS:
            found[int(tag)] = raw_value(dataset, tag)
    _collect_groups(first_items(dataset, SEQUENCES), found)


def _collect_groups(groups: Mapping[int, Any], found: dict[int, Raw]) -> None:
    for tag, item in groups.items():
        if tag in SEQUENCES:
            _collect(item, found)


def _values(found: Mapping[int, Raw]) -> dict[str, Value]:
    values = {}
    for attribute in ATTRIBUTES:
        for source in attribute.sources:
            value = _value(source, found) if source.tag in found else None
            if value is not None:
                values[attribute.name] = value
                break
    return values


def _value(source: Source, found: Mapping[int, Raw]) -> Value | None:
    if source.creator is not None:
        creator, maker = (as_text(found.get(tag, (b"", True))) for tag in (source.creator.tag, MANUFACTURER))
        if not source.creator.owns(creator, maker):
            return None
    if source.encoding == "text":
        return as_text(found[source.tag]) or None
    if source.encoding == "comment":
        parts = COMMENT.match(as_text(found[source.tag]))
        return None if parts is None else tuple(_rounded(float(part)) for part in parts.groups())
    if source.encoding == "time":
        dates = (as_text(found[tag]) for tag in source.others if tag in found)
        return seconds_of(next(dates, ""), as_text(found[source.tag]))
    if source.encoding == "datetime":
        text = as_text(found[source.tag])
        return seconds_of(text[:8], text[8:])
    tags = (source.tag, *source.others)
    numbers = [number for tag in tags if tag in found for number in as_numbers(found[tag], source.encoding)]
    n_wanted = source.count + len(source.others)
    if len(numbers) < n_wanted or not all(map(math.isfinite, numbers[:n_wanted])):
        return None
    if n_wanted > 1:
        return tuple(_rounded(number) for number in numbers[:n_wanted])
    return _rounded(numbers[0] % GE_B_VALUE if source.creator == GE_PARAMETERS else numbers[0])


def _rounded(number: float) -> float:
    return float(f"{number:.{N_DIGITS}g}")


def seconds_of(day: str, time: str) -> float | None:
    """Seconds since the year 1, or since midnight where no date is given: a scan may go on past midnight.

    Days as YYYYMMDD, times as HHMMSS.FFFFFF with parts left out at the end, or as HH:MM:SS as before 1993; what
    follows (the offset from UTC, which is one for all frames) is left out.
    """
    digits = time.replace(":", "").partition("+")[0].partition("-")[0].strip()
    try:
        seconds = 3600.0 * int(digits[:2]) + 60.0 * int(digits[2:4] or 0) + float(digits[4:] or 0)
    except ValueError:
        return None
    try:
        days = date(int(day[:4]), int(day[4:6]), int(day[6:8])).toordinal()
    except ValueError:
        days = 0
    return round(days * SECONDS_PER_DAY + seconds, 6)
