"""Groups of OME-Zarr that hold several images: series of bioformats2raw, plates and their wells, labels of an image.

Series: images `0`, `1`, ..., with their names in `OME/METADATA.ome.xml`. Plates: wells by row and column, each with an
image for each field of view. Labels: images of numbers in the group `labels` of an image. Only attributes are read, as
JSON, and only taken where they have the form of https://ngff.openmicroscopy.org/0.5/.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any, TypeAlias
from xml.etree import ElementTree as ET

from wavesplat._files.zarr_place import ZarrPlace

#: Images of a series that are looked for by number, wells of a plate, fields of a well, and labels, at most.
MAX_IMAGES, MAX_WELLS, MAX_FIELDS, MAX_LABELS = 1000, 6144, 1000, 65_535

#: The name of a label and its colour, 0..1, where it has one.
Look: TypeAlias = "tuple[str, tuple[float, float, float] | None]"


@dataclass(frozen=True)
class Well:
    """A well of a plate: its name, such as A1, its path in the store, and the names of its images, one for each field.

    fields : those of the first well where the store is on a server, which is not asked for all.
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
