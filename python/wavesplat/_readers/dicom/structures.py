"""Structure sets of radiotherapy (RTSTRUCT): regions of a patient, each as closed lines in planes.

A region (ROI) has a name and a colour, and lines in the patient's coordinates, mostly one or a few in each slice of the
scan that they were drawn on. Format: DICOM PS3.3, A.19, C.8.8.5, C.8.8.6 and C.8.8.8.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import affine
from wavesplat._readers.dicom.header import is_dicom
from wavesplat._readers.dicom.pixel_data import header_dataset
from wavesplat._readers.dicom.values import as_numbers, items, raw_value, text
from wavesplat._readers.request import quiet, unwarned
from wavesplat._storage.reading import BoundedFile, reading
from wavesplat.errors import FileError

SOP_CLASS = "1.2.840.10008.5.1.4.1.1.481.3"
#: Lines that enclose something; the others are points and open lines.
CLOSED = {"CLOSED_PLANAR", "CLOSEDPLANAR_XOR"}
#: Distance from the origin that no point of a patient has.
FAR_MM = 1e6


@dataclass(frozen=True)
class Structure:
    """A region of a structure set."""

    number: int
    name: str
    #: 0..1 each; None where the file has none.
    color: tuple[float, float, float] | None
    #: RT ROI Interpreted Type, such as EXTERNAL (the outline of the patient), ORGAN, PTV; empty where there is none.
    kind: str
    #: Closed lines, shape (points, 3) each, RAS, mm.
    lines: tuple[NDArray[np.float64], ...]
    #: Points and open lines of the file, which are left out.
    n_open: int


def is_structure_set(path: Path) -> bool:
    """Whether a file is an RTSTRUCT; also False where it cannot be read."""
    try:
        if not path.is_file() or not is_dicom(path):
            return False
        with quiet("pydicom"), unwarned("pydicom"), BoundedFile(path) as stream:
            dataset, _ = header_dataset(path, stream)
            return text(dataset, 0x00080060).upper() == "RTSTRUCT" or text(dataset, 0x00080016) == SOP_CLASS
    except Exception:  # noqa: BLE001 - parsers of damaged files raise nearly anything; who opens it says what is wrong
        return False


def structures_in(path: Path) -> list[Structure]:
    """The regions of an RTSTRUCT file, in its order.

    Raises
    ------
    FileError
        If it cannot be read, or holds no region.
    """
    with reading("DICOM", path), quiet("pydicom"), unwarned("pydicom"), BoundedFile(path) as stream:
        dataset, _ = header_dataset(path, stream)
        kinds = {_number(item, 0x30060084): text(item, 0x300600A4).upper() for item in items(dataset, 0x30060080)}
        drawn = {_number(item, 0x30060084): item for item in items(dataset, 0x30060039)}
        found = [
            _structure(_number(item, 0x30060022), item, drawn, kinds.get(_number(item, 0x30060022), ""), path)
            for item in items(dataset, 0x30060020)
        ]
    if not found:
        raise FileError(f"the structure set (RTSTRUCT) holds no region; export it again: {path}")
    return found


def _structure(number: int, roi: Any, drawn: Mapping[int, Any], kind: str, path: Path) -> Structure:
    lines, n_open, color = [], 0, None
    contours = drawn.get(number)
    if contours is not None:
        rgb = as_numbers(raw_value(contours, 0x3006002A), "decimal")
        if len(rgb) == 3 and all(0 <= part <= 255 for part in rgb):
            color = (rgb[0] / 255, rgb[1] / 255, rgb[2] / 255)
        for item in items(contours, 0x30060040):
            numbers = as_numbers(raw_value(item, 0x30060050), "decimal")
            if len(numbers) % 3:
                raise FileError(f"a contour has {len(numbers)} numbers, not three a point; export it again: {path}")
            if not (np.abs(numbers) < FAR_MM).all():
                raise FileError(
                    f"a point of a contour lies more than {FAR_MM / 1e6:g} km away; export it again: {path}"
                )
            if text(item, 0x30060042).upper() not in CLOSED or len(numbers) < 9:
                n_open += 1
                continue
            lines.append(np.reshape(numbers, (-1, 3)) @ affine.RAS_FROM_LPS[:3, :3].T)
    name = str(roi.get("ROIName") or "").strip() or f"region {number}"
    return Structure(number, name, color, kind, tuple(lines), n_open)


def _number(item: Any, tag: int) -> int:
    found = as_numbers(raw_value(item, tag), "decimal")
    return int(found[0]) if found else -1
