"""Groups of OME-Zarr: series, plates and their wells, labels; and the facts of each image by its metadata.

Series: images `0`, `1`, ..., with their names in `OME/METADATA.ome.xml`. Plates: wells by row and column, each with an
image for each field of view. Labels: images of numbers in the group `labels` of an image. Only attributes are read, as
JSON, and only taken where they have the form of https://ngff.openmicroscopy.org/0.5/.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any, TypeAlias
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Channel, Facts
from wavesplat._readers.request import window_of
from wavesplat._storage.zarr.place import ZarrPlace

#: Images of a series that are looked for by number, wells of a plate, fields of a well, and labels, at most.
MAX_IMAGES, MAX_WELLS, MAX_FIELDS, MAX_LABELS = 1000, 6144, 1000, 65_535

#: The name of a label and its colour, 0..1, where it has one.
Look: TypeAlias = "tuple[str, tuple[float, float, float] | None]"


@dataclass(frozen=True)
class Well:
    """A well of a plate: its name, such as A1, its path in the store, and the names of its images, one for each field.

    fields : of the first well where the store is on a server, which is not asked for the fields of every well.
    """

    name: str
    path: str
    fields: tuple[str, ...]

    @property
    def images(self) -> tuple[str, ...]:
        """Paths of its images in the store."""
        return tuple(f"{self.path}/{field}".strip("/") for field in self.fields)


def attributes_at(place: ZarrPlace, path: str) -> dict[str, Any] | None:
    """OME-Zarr's attributes of the group at a path; empty where it has none, None where there is no group."""
    found = None
    for name in ("zarr.json", ".zattrs", ".zgroup"):
        text = place.read(f"{path}/{name}".strip("/"))
        if text is None:
            continue
        try:
            document = json.loads(text)
        except ValueError:
            document = {}
        document = document if isinstance(document, dict) else {}
        found = document.get("attributes", {}) if name == "zarr.json" else document if name == ".zattrs" else {}
        break
    if found is None:
        return None
    own = found.get("ome", found) if isinstance(found, dict) else {}
    return own if isinstance(own, dict) else {}


def series_of(place: ZarrPlace, path: str = "") -> tuple[str, ...]:
    """Names of the images in a group that bioformats2raw made; empty for other groups."""
    if "bioformats2raw.layout" not in (attributes_at(place, path) or {}):
        return ()
    listed = _texts((attributes_at(place, _joined(path, "OME")) or {}).get("series"))
    if listed:
        return listed[:MAX_IMAGES]
    names: list[str] = []
    for number in count():
        if len(names) == MAX_IMAGES or attributes_at(place, _joined(path, str(number))) is None:
            break
        names.append(str(number))
    return tuple(names)


def series_names(place: ZarrPlace, path: str, n: int) -> tuple[str, ...]:
    """Names of the `n` images of a series for people, by the OME-XML beside them; empty texts where there are none."""
    text = place.read(_joined(path, "OME/METADATA.ome.xml"))
    names: list[str] = []
    if text is not None and b"<!DOCTYPE" not in text:  # entities could grow without end
        try:
            root = ET.fromstring(text)  # noqa: S314 - there is no document type
            names = [one.get("Name") or "" for one in root if one.tag.rpartition("}")[2] == "Image"]
        except ET.ParseError:
            names = []
    return tuple([*names, *[""] * n][:n])


def wells_of(place: ZarrPlace, path: str = "") -> tuple[Well, ...]:
    """The wells of the plate at a path, or the well that is there; empty for other groups."""
    attributes = attributes_at(place, path) or {}
    if isinstance(attributes.get("well"), dict):
        where = path or ("" if place.root is None else "/".join(place.root.absolute().parts[-2:]))
        return (Well(_well_name(where), path, _fields(attributes)),)
    plate = attributes.get("plate")
    listed = plate.get("wells") if isinstance(plate, dict) else None
    paths = _texts([well.get("path") for well in listed if isinstance(well, dict)]) if isinstance(listed, list) else ()
    wells: list[Well] = []
    for own in paths[:MAX_WELLS]:
        inner = _joined(path, own)
        fields = wells[0].fields if wells and not place.is_local else _fields(attributes_at(place, inner) or {})
        wells.append(Well(_well_name(own), inner, fields))
    return tuple(wells)


def well_of(image: Path) -> tuple[str, str] | None:
    """The name of the well that a folder is an image of, and of its field; None for other folders."""
    folder = image.absolute().parent
    if not folder.is_dir() or "well" not in (attributes_at(ZarrPlace(folder), "") or {}):
        return None
    return _well_name("/".join(folder.parts[-2:])), image.name


def label_names(place: ZarrPlace, path: str = "") -> tuple[str, ...]:
    """Names of the segmentations of the image at a path, in its group `labels`."""
    return _texts((attributes_at(place, _joined(path, "labels")) or {}).get("labels"))


def label_looks(place: ZarrPlace, path: str = "") -> dict[int, Look]:
    """Names and colours of the labels of the segmentation at a path, by number."""
    described = (attributes_at(place, path) or {}).get("image-label")
    if not isinstance(described, dict):
        return {}
    found: dict[int, Look] = {}
    for one in _objects(described.get("colors")):
        number, rgba = _whole(one.get("label-value")), one.get("rgba")
        is_color = isinstance(rgba, list) and len(rgba) in (3, 4) and all(_is_byte(share) for share in rgba)
        if number is not None and isinstance(rgba, list) and is_color:
            found[number] = (str(number), (rgba[0] / 255, rgba[1] / 255, rgba[2] / 255))
    for one in _objects(described.get("properties")):
        number = _whole(one.get("label-value"))
        names = [one[key] for key in ("name", "label", "class") if isinstance(one.get(key), str) and one[key]]
        if number is not None and names:
            found[number] = (names[0], found.get(number, ("", None))[1])
    return found


def _fields(attributes: dict[str, Any]) -> tuple[str, ...]:
    well = attributes.get("well")
    images = well.get("images") if isinstance(well, dict) else None
    return _texts([one.get("path") for one in _objects(images)])[:MAX_FIELDS]


def _well_name(path: str) -> str:
    """The name of a well, such as A1, by its path, A/1."""
    return path.strip("/").replace("/", "")


def _joined(path: str, inner: str) -> str:
    return f"{path.strip('/')}/{inner.strip('/')}".strip("/")


def _objects(found: Any) -> list[dict[str, Any]]:
    return [one for one in found[:MAX_LABELS] if isinstance(one, dict)] if isinstance(found, list) else []


def _texts(found: Any) -> tuple[str, ...]:
    return tuple(one for one in found if isinstance(one, str) and one) if isinstance(found, list) else ()


def _whole(number: Any) -> int | None:
    """A whole number, also one that is written as 1.0; None for anything else."""
    if isinstance(number, bool) or not isinstance(number, int | float):
        return None
    return int(number) if isinstance(number, int) or number.is_integer() else None


def _is_byte(number: Any) -> bool:
    return isinstance(number, int | float) and not isinstance(number, bool) and 0 <= number <= 255


# Facts of an OME-Zarr image, by its metadata: units of axes, channels, times, levels.

#: OME-Zarr's names of the units of time -> ours.
TIME_UNITS = {"second": "s", "millisecond": "ms", "microsecond": "us", "nanosecond": "ns", "minute": "min", "hour": "h"}


@dataclass(frozen=True)
class Axes:
    """Names of an array's axes, in order, and their units as the file has them."""

    names: tuple[str, ...]
    units: tuple[str | None, ...]

    @classmethod
    def of(cls, multiscales: dict[str, Any]) -> Axes:
        """The axes of an image; before OME-Zarr 0.3 they are not named."""
        axes = multiscales.get("axes")
        if axes is None and multiscales.get("coordinateSystems"):
            axes = multiscales["coordinateSystems"][0]["axes"]
        if axes is None:
            return cls(("t", "c", "z", "y", "x"), (None,) * 5)
        named = [{"name": axis} if isinstance(axis, str) else axis for axis in axes]
        return cls(
            tuple(str(axis["name"]) for axis in named),
            tuple(None if axis.get("unit") is None else str(axis["unit"]) for axis in named),
        )

    def unit_of(self, name: str) -> str | None:
        """The unit of an axis."""
        return self.units[self.names.index(name)] if name in self.names else None

    def in_one_unit(self) -> tuple[str | None, NDArray[np.float64]]:
        """One unit for x, y and z, and the factors that bring the world's axes to it."""
        x, y, z = (units.canonical(self.unit_of(name)) for name in "xyz")
        unit, factors = units.in_one_unit((x, y, z))
        return unit, np.array(factors)

    def guesses(self) -> list[str]:
        """Guesses for axes without a unit, or with one that is unknown, beside those that have one."""
        unit, _ = self.in_one_unit()
        x, y, z = (units.canonical(self.unit_of(name)) for name in "xyz")
        bare = [name for name, own in zip("xyz", (x, y, z), strict=True) if own is None and name in self.names]
        none = f"distances along {', '.join(bare)} in {unit}: the file names no unit for them"
        return [*([none] if unit and bare else []), *units.guesses_of((x, y, z))]


def channels_of(attributes: dict[str, Any]) -> tuple[Channel, ...]:
    """The channels that `omero` describes."""
    omero = attributes.get("omero")
    described = omero.get("channels") if isinstance(omero, dict) else None
    if not isinstance(described, list):
        return ()
    return tuple(_channel(channel) for channel in described if isinstance(channel, dict))


def _channel(channel: dict[str, Any]) -> Channel:
    color = str(channel.get("color") or "").removeprefix("#")
    wavelength = channel.get("emission_wavelength", channel.get("emissionWavelength"))
    is_length = isinstance(wavelength, int | float) and np.isfinite(wavelength) and wavelength > 0
    window = channel.get("window")
    return Channel(
        str(channel.get("label") or ""),
        _hex(color),
        float(wavelength or 0) if is_length else None,
        window_of(window.get("start"), window.get("end")) if isinstance(window, dict) else None,
        channel.get("active") is not False,
    )


def _hex(text: str) -> tuple[float, float, float] | None:
    """The colour RRGGBB, which some follow by an alpha; None for anything else."""
    try:
        red, green, blue = (int(text[i : i + 2], 16) / 255 for i in (0, 2, 4))
    except ValueError:
        return None
    return red, green, blue


def facts_of(
    axes: Axes,
    channels: Sequence[Channel],
    *,
    channel: int,
    shape: Sequence[int],
    levels: Sequence[Sequence[int]],
    matrix: NDArray[np.float64],
) -> Facts:
    """The facts of one level. `levels`: shapes of all, in order of the axes; `matrix`: world from index, all axes."""
    unit, _ = axes.in_one_unit()
    n_times, time_step = 1, None
    if "t" in axes.names:
        place = axes.names.index("t")
        n_times = int(shape[place])
        time_step = float(matrix[place, place])
    has_units_of_time = units.canonical(axes.unit_of("t")) is not None
    zyx = [axes.names.index(name) if name in axes.names else None for name in "zyx"]
    emits = any(one.emission_nm is not None for one in channels)
    return Facts(
        unit=unit,
        modality="fluorescence" if emits else None,
        channel=channels[channel] if channel < len(channels) else None,
        channels=tuple(channels),
        n_times=n_times,
        # A scale of 1 without a unit is what writers put where they know nothing.
        time_step=time_step if n_times > 1 and has_units_of_time else None,
        time_unit=TIME_UNITS.get(str(axes.unit_of("t")), axes.unit_of("t")) if n_times > 1 else None,
        levels=tuple(_shape(level, zyx) for level in levels) if len(levels) > 1 else (),
        guesses=tuple(axes.guesses()),
    )


def _shape(level: Sequence[int], zyx: Sequence[int | None]) -> tuple[int, int, int]:
    """Samples along z, y, x of a level; 1 along an axis that it does not have."""
    z, y, x = (1 if axis is None else int(level[axis]) for axis in zyx)
    return z, y, x
