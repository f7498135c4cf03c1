"""Distances, units and channels of TIFF files, by OME's XML or ImageJ's lines; a bare TIFF has none.

OME: https://docs.openmicroscopy.org/ome-model/latest/. ImageJ: the lines `name=value` of its description, its look-up
tables, and the tags of resolution, which are pixels per unit.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Channel, Facts
from wavesplat._readers.request import window_of

if TYPE_CHECKING:
    from tifffile import TiffFile

#: A nanometre in metres, for wavelengths.
NM = 1e-9
#: Guess about an OME-TIFF without metadata of its own, `BinaryOnly`.
PART_OF_SET = (
    "one file of several, whose planes, distances and channels are described in another (.companion.ome), which is not "
    "read: for planes of one channel, open the folder"
)
#: How the position of the stage is interpreted.
STAGE_IS_FIRST = "which OME-TIFF has for each plane; it is taken for the place of the first sample"
#: OME's names of modes in which the light of a dye is measured.
FLUORESCENCE = {
    "Fluorescence",
    "LaserScanningConfocalMicroscopy",
    "LaserScanningMicroscopy",
    "SpinningDiskConfocal",
    "SlitScanConfocal",
    "MultiPhotonMicroscopy",
    "SingleMoleculeImaging",
    "TotalInternalReflection",
    "FluorescenceLifetime",
    "FluorescenceCorrelationSpectroscopy",
    "StructuredIllumination",
    "STED",
    "PALM",
    "STORM",
    "SPIM",
}


@dataclass(frozen=True)
class TiffPlace:
    """Steps along x, y, z, which may be negative, the place of the first sample, and the facts."""

    steps: tuple[float, float, float]
    facts: Facts
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class _FromFile:
    """Values that the metadata state; None where they do not."""

    steps: tuple[float | None, float | None, float | None] = (None, None, None)
    units: tuple[str | None, str | None, str | None] = (None, None, None)
    #: Invalid values in the place of distances: 0, "nan", "abc".
    odd: tuple[Any, Any, Any] = (None, None, None)
    #: Where the stage was at the first plane, along x, y, z, in metres.
    stage_m: tuple[float | None, float | None, float | None] = (None, None, None)
    facts: Facts = field(default_factory=Facts)


def place_of(tiff: TiffFile, *, has_z: bool = True, time: int = 0, channel: int = 0) -> TiffPlace:
    """Distances, unit, place and facts of the first image in the file.

    has_z : whether it has slices, not only times. time, channel : those whose place is asked for.
    """
    own = _of_ome(tiff, time, channel) if tiff.is_ome else _of_imagej(tiff) if tiff.is_imagej else _FromFile()
    unit, factors = units.in_one_unit(own.units)
    steps = [None if step is None else step * factor for step, factor in zip(own.steps, factors, strict=True)]
    # A missing distance is taken from x: then the stack keeps its proportions at least in scale.
    x = steps[0] or 1.0
    y, z = (abs(x) if step is None else step for step in steps[1:])
    guesses = [*own.facts.guesses, *guesses_of_steps(steps, x), *_odd_guesses(own)]
    if not has_z and (own.steps[2] is None or own.facts.time_step is not None):
        n = own.facts.n_times
        guesses.append(
            f"a time series of {n} planes: time points are drawn as slices along z, as the file has no slices"
        )
    guesses += units.guesses_of(own.units)
    described = zip("xyz", own.units, own.steps, strict=True)
    bare = ", ".join(name for name, one, step in described if one is None and step is not None)
    if unit is not None and bare:
        guesses.append(f"distances along {bare} in {unit}: the file names no unit for them")
    size = units.metres(unit)
    stage = [0.0 if at is None or size is None else float(f"{at / size:.9g}") for at in own.stage_m]
    conventions = [f"placed where the stage was, {STAGE_IS_FIRST}"] if any(stage) else []
    facts = replace(own.facts, unit=unit, guesses=tuple(guesses), conventions=tuple(conventions))
    return TiffPlace((x, y, z), facts, (stage[0], stage[1], stage[2]))


def _odd_guesses(own: _FromFile) -> list[str]:
    """Guesses for distances that are invalid or negative."""
    odd = [(axis, text) for axis, text in zip("xyz", own.odd, strict=True) if text is not None]
    guesses = [f"distance along {axis}: the file says {str(text)[:24]!r}, which is none" for axis, text in odd]
    if mirrored := [axis for axis, step in zip("xyz", own.steps, strict=True) if step is not None and step < 0]:
        guesses.append(f"axes {', '.join(mirrored)} mirrored: their distances in the file are negative")
    return guesses


def guesses_of_steps(steps: list[float | None], x: float) -> list[str]:
    """A sentence for distances along x, y, z that a file does not have, and are taken from `x`."""
    if all(step is None for step in steps):
        return ["distances of samples 1, 1, 1: the file has none"]
    missing = [name for name, step in zip("xyz", steps, strict=True) if step is None]
    if not missing:
        return []
    if missing == ["z"]:
        return [f"distance of slices {abs(x):.6g}: the file has none, taken from x"]
    return [f"distances of samples along {', '.join(missing)} {abs(x):.6g}: the file has none, taken from x"]


# ImageJ


def _of_imagej(tiff: TiffFile) -> _FromFile:
    metadata: dict[str, Any] = tiff.imagej_metadata or {}
    unit = units.canonical(metadata.get("unit"))
    own = [units.canonical(metadata.get(f"{axis}unit")) or unit for axis in "yz"]
    page: Any = tiff.pages[0]
    x, y = (_between_pixels(page, tag) for tag in ("XResolution", "YResolution"))
    return _FromFile(
        steps=(x, y, _number(metadata.get("spacing"))),
        units=(unit, own[0], own[1]),
        odd=(None, None, _odd(metadata.get("spacing"))),
        facts=Facts(
            channels=_imagej_channels(metadata),
            n_times=max(int(metadata.get("frames", 1) or 1), 1),
            time_step=_number(metadata.get("finterval")),
            time_unit=_time_unit(metadata.get("tunit"), metadata.get("finterval")),
        ),
    )


def _between_pixels(page: Any, tag: str) -> float | None:
    """Distance between pixels by a tag of pixels per unit, as ImageJ writes it: 1 for an image without a scale."""
    if tag not in page.tags:
        return None
    n_pixels, n_units = page.tags[tag].value
    return n_units / n_pixels if n_pixels and n_units else None


def _time_unit(name: Any, step: Any) -> str | None:
    if step is None:
        return None
    return {"sec": "s", "seconds": "s", "": "s"}.get(str(name or ""), str(name or "s"))


def _imagej_channels(metadata: dict[str, Any]) -> tuple[Channel, ...]:
    """ImageJ's channels: their colours are the last entries of the look-up tables; grey is no colour."""
    n_channels = int(metadata.get("channels", 1) or 1)
    tables = metadata.get("LUTs") or []
    if len(tables) < n_channels or (n_channels == 1 and str(metadata.get("mode", "")) == "grayscale"):
        tables = []
    colors = [_table_color(table) for table in tables[:n_channels]] or [None] * n_channels
    windows = _imagej_windows(metadata, n_channels)
    if n_channels == 1 and not any(colors) and not any(windows):
        return ()
    return tuple(Channel("", color, window=window) for color, window in zip(colors, windows, strict=True))


def _imagej_windows(metadata: dict[str, Any], n_channels: int) -> list[tuple[float, float] | None]:
    """The display range of each channel; for a single one it is in two lines of the description."""
    ranges = list(metadata.get("Ranges") or ())
    if len(ranges) < 2 * n_channels:
        ranges = [metadata.get("min"), metadata.get("max")]
    windows = [window_of(low, high) for low, high in zip(ranges[::2], ranges[1::2], strict=False)]
    return (windows + [None] * n_channels)[:n_channels]


def _table_color(table: Any) -> tuple[float, float, float] | None:
    entries = np.asarray(table)
    if entries.ndim != 2 or entries.shape[0] != 3:
        return None
    red, green, blue = (float(value) / 255 for value in entries[:, -1])
    is_grey = red == green == blue
    return None if is_grey else (red, green, blue)


# OME


def _of_ome(tiff: TiffFile, time: int, channel: int) -> _FromFile:
    root = _parsed(tiff.ome_metadata or "")
    image = None if root is None else next(_named(root, "Image"), None)
    pixels = None if image is None else next(_named(image, "Pixels"), None)
    if root is None or pixels is None:
        named = None if root is None else next(_named(root, "BinaryOnly"), None)
        return _FromFile(facts=Facts(guesses=() if named is None else (PART_OF_SET,)))
    steps = tuple(_number(pixels.get(f"PhysicalSize{axis}")) for axis in "XYZ")
    odd = [_odd(pixels.get(f"PhysicalSize{axis}")) for axis in "XYZ"]
    # The standard's default is the micrometre.
    of_axes = tuple(
        None if step is None else units.canonical(pixels.get(f"PhysicalSize{axis}Unit", "µm"))
        for axis, step in zip("XYZ", steps, strict=True)
    )
    described = list(_named(pixels, "Channel"))
    n_times = max(int(pixels.get("SizeT", "1")), 1)
    times, times_unit = _ome_times(pixels, n_times)
    time_step = _number(pixels.get("TimeIncrement"))
    return _FromFile(
        steps=(steps[0], steps[1], steps[2]),
        units=(of_axes[0], of_axes[1], of_axes[2]),
        odd=(odd[0], odd[1], odd[2]),
        stage_m=_ome_stage(pixels, time, channel),
        facts=Facts(
            modality=_ome_modality(described),
            channels=tuple(_ome_channel(channel) for channel in described),
            n_times=n_times,
            time_step=time_step,
            time_unit=times_unit if time_step is None else pixels.get("TimeIncrementUnit", "s"),
            times=times if time_step is None else (),
        ),
    )


def _ome_stage(pixels: ET.Element, time: int, channel: int) -> tuple[float | None, float | None, float | None]:
    """Where the stage was at the first plane of a time and channel, else of all, metres; None without a length's unit.

    The standard's default, a reference frame of unknown size, is none.
    """
    first = [plane for plane in _named(pixels, "Plane") if plane.get("TheZ", "0") == "0"]
    wanted = (str(time), str(channel))
    own = [plane for plane in first if (plane.get("TheT", "0"), plane.get("TheC", "0")) == wanted]
    planes = own or first
    if not planes:
        return None, None, None
    found = []
    for axis in "XYZ":
        at = _number(planes[0].get(f"Position{axis}"))
        size = units.metres(units.canonical(planes[0].get(f"Position{axis}Unit")))
        found.append(None if at is None or size is None else at * size)
    return found[0], found[1], found[2]


def _ome_times(pixels: ET.Element, n_times: int) -> tuple[tuple[float, ...], str | None]:
    """When the first plane of each time point was taken, and the unit; empty if it is not said of all."""
    first: dict[int, tuple[float, str]] = {}
    for plane in _named(pixels, "Plane") if n_times > 1 else ():
        if plane.get("TheZ", "0") == plane.get("TheC", "0") == "0" and plane.get("DeltaT") is not None:
            first[int(plane.get("TheT", "0"))] = (float(plane.get("DeltaT")), plane.get("DeltaTUnit", "s"))
    found = [first[number] for number in range(n_times) if number in first]
    if len(found) < n_times or len({unit for _, unit in found}) != 1 or not all(isfinite(time) for time, _ in found):
        return (), None
    return tuple(time for time, _ in found), found[0][1]


def _parsed(text: str) -> ET.Element | None:
    """The parsed XML; None with a document type, whose entities could grow without bound, or if it is damaged."""
    if "<!DOCTYPE" in text or "\0" in text:
        return None
    try:
        return ET.fromstring(text)  # noqa: S314 - see above
    except ET.ParseError:
        return None


def _named(element: ET.Element, name: str) -> Any:
    """Descendants of that name, in whichever namespace."""
    return (one for one in element.iter() if one.tag.rpartition("}")[2] == name)


def _ome_channel(channel: ET.Element) -> Channel:
    wavelength = _number(channel.get("EmissionWavelength"))
    if wavelength is not None:
        size = units.metres(units.canonical(channel.get("EmissionWavelengthUnit", "nm")))
        wavelength = None if size is None or wavelength <= 0 else float(f"{wavelength * size / NM:.9g}")
    color = channel.get("Color")
    return Channel(
        channel.get("Name") or channel.get("Fluor") or "",
        None if color is None else _rgba_color(int(color)),
        wavelength,
    )


def _rgba_color(number: int) -> tuple[float, float, float]:
    """Colour of OME's signed 32-bit integer: red, green, blue, alpha, the first in the highest byte."""
    red, green, blue = (((number >> shift) & 255) / 255 for shift in (24, 16, 8))
    return red, green, blue


def _ome_modality(channels: list[ET.Element]) -> str | None:
    for channel in channels:
        if {channel.get("ContrastMethod"), channel.get("AcquisitionMode")} & FLUORESCENCE:
            return "fluorescence"
        if channel.get("EmissionWavelength") is not None or channel.get("Fluor"):
            return "fluorescence"
    return None


def _odd(text: Any) -> Any:
    """The value where it is no number other than zero; None where it is one, or there is nothing."""
    return text if text not in (None, "") and _number(text) is None else None


def _number(text: Any) -> float | None:
    """A finite number other than zero, or None."""
    try:
        number = float(text)
    except (TypeError, ValueError):
        return None
    return number if isfinite(number) and number != 0 else None
