"""Headers of DICOM files, by pydicom: what each frame is, where it lies, and how its stored numbers become values.

A file has one frame or many. Of many, each may have its own position, slope and dimensions, in the functional groups of
enhanced files (DICOM PS3.3, C.7.6.16), or all lie along a line, as in dose grids and tomograms of nuclear medicine.
Values are taken as bytes and read here: pydicom's own conversion warns of what scanners write.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["Frame", "Header", "header_of", "is_dicom"]

#: Modalities of files that are no images.
NO_IMAGES = {"RTSTRUCT", "RTPLAN", "RTRECORD", "SR", "PR", "KO", "DOC", "REG", "FID", "PLAN", "AU", "ECG", "HD", "RWV"}
#: Attributes by which frames of one place are told apart are all dimensions but these.
OF_PLACE = {0x00209057, 0x00200032, 0x00209301, 0x00209056, 0x00540080}
FRAME_TYPES = (0x00189226, 0x00189329, 0x00189751, 0x00189806)
#: Attributes that say when a frame was taken, the surest first, and how many of their units are a second; 0 is the
#: time of day, HHMMSS. Trigger time, frame reference time, time offset of a temporal position, acquisition and content
#: time.
CLOCKS = {0x00181060: 1000, 0x00541300: 1000, 0x0020930D: 1, 0x00080032: 0, 0x00080033: 0}
NONE = float("nan")


@dataclass(frozen=True)
class Frame:
    """One 2-D picture of a file; lengths in mm, LPS; NaN where nothing is said."""

    file: Path
    #: Its place in the file, and the file's in the series.
    index: int
    instance: int
    position: NDArray[np.float64]
    orientation: NDArray[np.float64]
    #: Between rows, and between columns.
    pixel_spacing: tuple[float, float]
    slope: float
    intercept: float
    stack: str = ""
    #: What else tells it from frames at its place: time, echo, kind.
    others: tuple[int, ...] = ()
    label: str = ""
    #: Seconds, by each of `CLOCKS`; NaN where it is not said.
    seconds: tuple[float, ...] = ()

    @property
    def name(self) -> str:
        """What messages call it."""
        return self.file.name if self.index == 0 else f"{self.file.name} (frame {self.index})"

    @property
    def normal(self) -> NDArray[np.float64]:
        """At right angles to it."""
        return np.cross(self.orientation[:3], self.orientation[3:])

    def is_placed(self) -> bool:
        """Whether position and orientation are known."""
        return bool(np.isfinite(self.position).all() and np.isfinite(self.orientation).all())


@dataclass(frozen=True)
class Header:
    """What is said once for a file."""

    file: Path
    series: str
    instance_uid: str
    description: str
    modality: str | None
    transfer_syntax: str
    size: tuple[int, int]
    n_samples: int
    photometric: str
    #: 1 where colours lie in a plane each.
    planes: int
    bits_allocated: int
    bits_stored: int
    high_bit: int
    is_signed: bool
    n_frames: int
    #: Between slices, for frames without positions.
    slice_step: float
    has_lookup_table: bool
    #: Whether its axes are a patient's, and not those of a probe.
    is_of_patient: bool
    frames: tuple[Frame, ...]


def is_dicom(file: Path) -> bool:
    """Whether a file begins as DICOM does, with its mark, or without it with a first group."""
    with file.open("rb") as stream:
        head = stream.read(132)
    return head[128:] == b"DICM" or (head[:4] in (b"\x08\x00\x05\x00", b"\x08\x00\x00\x00", b"\x08\x00\x08\x00"))


def header_of(file: Path) -> Header | None:
    """The header of a file; None of one that is DICOM and no image. Raises nearly anything if it is damaged."""
    from pydicom import dcmread

    dataset = dcmread(file, stop_before_pixels=True, force=True)
    modality = _text(dataset, 0x00080060).upper()
    rows, columns = _integer(dataset, 0x00280010), _integer(dataset, 0x00280011)
    if rows * columns == 0:
        if modality in NO_IMAGES or _text(dataset, 0x00020002) or 0x00041220 in dataset or _is_directory(dataset):
            return None
        raise ValueError("the header has no rows and columns")
    bits = _integer(dataset, 0x00280100)
    stored = _integer(dataset, 0x00280101) or bits
    n_frames = max(1, int(float(_text(dataset, 0x00280008) or 1)))
    return Header(
        file=file,
        series=_text(dataset, 0x0020000E),
        instance_uid=_text(dataset, 0x00080018),
        description=_text(dataset, 0x0008103E),
        modality=modality or None,
        transfer_syntax=str(dataset.file_meta.get("TransferSyntaxUID", "1.2.840.10008.1.2")),
        size=(columns, rows),
        n_samples=_integer(dataset, 0x00280002) or 1,
        photometric=_text(dataset, 0x00280004).upper(),
        planes=_integer(dataset, 0x00280006),
        bits_allocated=bits,
        bits_stored=stored,
        high_bit=_integer(dataset, 0x00280102) if 0x00280102 in dataset else stored - 1,
        is_signed=_integer(dataset, 0x00280103) == 1,
        n_frames=n_frames,
        slice_step=_slice_step(dataset),
        has_lookup_table=0x00283000 in dataset,
        is_of_patient=0x0020930F not in _groups(dataset, 0)[1],
        frames=tuple(_frames(dataset, file, n_frames)),
    )


def _is_directory(dataset: Dataset) -> bool:
    return str(dataset.file_meta.get("MediaStorageSOPClassUID", "")) == "1.2.840.10008.1.3.10"


def _slice_step(dataset: Dataset) -> float:
    steps = [_numbers(dataset, tag, 1)[0] for tag in (0x00180088, 0x00180050)]
    return next((float(step) for step in steps if np.isfinite(step) and step != 0), NONE)


# Frames


def _frames(dataset: Dataset, file: Path, n_frames: int) -> Iterator[Frame]:
    pointers = [_pointer(item) for item in _items(dataset, 0x00209222)]
    along = _positions_along_a_line(dataset, n_frames)
    instance = int(float(_text(dataset, 0x00200013) or 0))
    scaling = _numbers(dataset, 0x3004000E, 1)[0]  # of doses, instead of a slope
    for index in range(n_frames):
        groups = _groups(dataset, index)
        content = _in_group(groups, 0x00209111)
        values = _longs(content, 0x00209157) if content is not None else ()
        time = _longs(content, 0x00209128) if content is not None else ()
        spacing = _found(groups, dataset, 0x00289110, 0x00280030, 2)
        if not np.isfinite(spacing).all():
            spacing = _numbers(dataset, 0x00181164, 2)
        slope = _found(groups, dataset, 0x00289145, 0x00281053, 1)[0]
        intercept = _found(groups, dataset, 0x00289145, 0x00281052, 1)[0]
        position, orientation = _placed(groups, dataset)
        yield Frame(
            file=file,
            index=index,
            instance=instance,
            position=position if along is None else along[index],
            orientation=orientation,
            pixel_spacing=(float(spacing[0]), float(spacing[1])),
            slope=float(slope) if np.isfinite(slope) else float(scaling) if np.isfinite(scaling) else 1.0,
            intercept=float(intercept) if np.isfinite(intercept) else 0.0,
            stack=_text(content, 0x00209056) if content is not None else "",
            others=(*time, *(value for value, of in zip(values, pointers, strict=False) if of not in OF_PLACE)),
            label=_label(groups),
            seconds=tuple(_seconds(dataset, groups, tag, rate) for tag, rate in CLOCKS.items()),
        )


def _placed(groups: Sequence[Dataset], dataset: Dataset) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Position and orientation in the patient; else those in the volume of an ultrasound probe; else of a detector."""
    position = _found(groups, dataset, 0x00209113, 0x00200032, 3)
    orientation = _found(groups, dataset, 0x00209116, 0x00200037, 6)
    if not np.isfinite(position).all():
        position = _found(groups, dataset, 0x0020930E, 0x00209301, 3)
        orientation = _found(groups, dataset, 0x0020930F, 0x00209302, 6)
    detectors = _items(dataset, 0x00540022)
    if not np.isfinite(orientation).all() and detectors:
        position, orientation = _numbers(detectors[0], 0x00200032, 3), _numbers(detectors[0], 0x00200037, 6)
    return position, orientation


def _positions_along_a_line(dataset: Dataset, n_frames: int) -> NDArray[np.float64] | None:
    """Positions of frames that have none of their own: offsets of a dose grid, or slices of a tomogram."""
    if n_frames == 1 or _items(dataset, 0x52009230):
        return None
    position, orientation = _placed((), dataset)
    normal = np.cross(orientation[:3], orientation[3:])
    offsets = _numbers(dataset, 0x3004000C, n_frames)
    slices = _shorts(dataset, 0x00540080)
    if np.isfinite(offsets).all():
        # Either from the first frame, or places along z.
        offsets = offsets - offsets[0]
    elif len(slices) == n_frames and _items(dataset, 0x00540022):
        offsets = (np.array(slices) - 1.0) * _slice_step(dataset)
    else:
        return None
    along: NDArray[np.float64] = position + offsets[:, None] * normal
    return along


def _label(groups: Sequence[Dataset]) -> str:
    """The last word of the frame's type, which tells magnitude from phase."""
    for tag in FRAME_TYPES:
        group = _in_group(groups, tag)
        if group is not None:
            return _text(group, 0x00089007).rpartition("\\")[2].strip()
    return ""


def _seconds(dataset: Dataset, groups: Sequence[Any], tag: int, rate: int) -> float:
    """What a clock says; of enhanced files only the offset is told frame by frame."""
    if rate == 0:
        text = _text(dataset, tag)
        try:
            return 3600.0 * int(text[:2]) + 60.0 * int(text[2:4]) + float(text[4:] or 0)
        except ValueError:
            return NONE
    number = _found(groups, dataset, 0x00209310, tag, 1)[0]
    if tag == 0x0020930D:
        # A double, and not text.
        item = _in_group(groups, 0x00209310)
        content, is_little = _bytes(item if item is not None else dataset, tag)
        found = np.frombuffer(content, "<f8" if is_little else ">f8") if len(content) == 8 else np.array([number])
        number = found[0]
    return float(number) / rate if np.isfinite(number) else NONE


def _groups(dataset: Dataset, index: int) -> tuple[Any, Any]:
    """The functional groups of a frame, and those of all frames; empty where there are none."""
    frames, shared = _items(dataset, 0x52009230), _items(dataset, 0x52009229)
    return (frames[index] if index < len(frames) else {}), (shared[0] if shared else {})


def _in_group(groups: Sequence[Any], tag: int) -> Any:
    """The item of a group, the frame's own first."""
    items = (_items(group, tag) for group in groups)
    return next((found[0] for found in items if found), None)


def _found(groups: Sequence[Any], dataset: Dataset, group: int, tag: int, count: int) -> NDArray[np.float64]:
    """Numbers of an attribute: in the frame's group, in the shared one, or beside them."""
    item = _in_group(groups, group)
    numbers = np.full(count, NONE) if item is None else _numbers(item, tag, count)
    return numbers if np.isfinite(numbers).all() else _numbers(dataset, tag, count)


# Values


def _items(dataset: Any, tag: int) -> Any:
    return dataset[tag].value or () if tag in dataset else ()


def _bytes(dataset: Any, tag: int) -> tuple[bytes, bool]:
    """The bytes of a value, and whether the low ones come first."""
    if tag not in dataset:
        # Only the sequences of the file's own group are converted.
        return b"", True
    element = dataset.get_item(tag)
    value = element.value
    if isinstance(value, bytes):
        return value, bool(getattr(element, "is_little_endian", True))
    return ("" if value is None else str(value)).encode("latin-1", "replace"), True


def _text(dataset: Any, tag: int) -> str:
    return _bytes(dataset, tag)[0].decode("latin-1").strip(" \0")


def _numbers(dataset: Any, tag: int, count: int) -> NDArray[np.float64]:
    """As many decimal numbers, or NaN."""
    parts = [part.strip(" \0") for part in _text(dataset, tag).split("\\")]
    try:
        numbers = [float(part) for part in parts if part]
    except ValueError:
        numbers = []
    return np.array(numbers if len(numbers) == count else [NONE] * count)


def _binary(dataset: Any, tag: int, code: str) -> tuple[int, ...]:
    content, is_little = _bytes(dataset, tag)
    dtype = np.dtype(code).newbyteorder("<" if is_little else ">")
    return tuple(
        int(number) for number in np.frombuffer(content[: len(content) // dtype.itemsize * dtype.itemsize], dtype)
    )


def _shorts(dataset: Any, tag: int) -> tuple[int, ...]:
    return _binary(dataset, tag, "u2")


def _longs(dataset: Any, tag: int) -> tuple[int, ...]:
    return _binary(dataset, tag, "u4")


def _integer(dataset: Any, tag: int) -> int:
    return next(iter(_shorts(dataset, tag)), 0)


def _pointer(item: Any) -> int:
    """The tag that a dimension is of: two shorts, group and element."""
    group, element = (*_shorts(item, 0x00209165), 0, 0)[:2]
    return group << 16 | element
