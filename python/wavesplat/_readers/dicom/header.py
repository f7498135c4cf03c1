"""Headers of DICOM files, by pydicom: what each frame is, where it lies, and how its stored numbers become values.

A file has one frame or many. Of many, each may have its own position, slope and dimensions, in the functional groups of
enhanced files (DICOM PS3.3, C.7.6.16), or all lie along a line, as in dose grids and tomograms of nuclear medicine.
How many frames there are is checked against the pixel data first: a header of some bytes can promise millions.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesplat._readers.dicom.attributes import SEQUENCES, Value, attributes_of_frames
from wavesplat._readers.dicom.mosaic import Picture, Tiles, split_of
from wavesplat._readers.dicom.pictures import NO_PICTURES, FactsOfPictures, facts_of_pictures, sizes_of_pixels
from wavesplat._readers.dicom.pixel_data import PixelData, check_n_frames, header_dataset, pixel_data_at
from wavesplat._readers.dicom.places import N_FIRST, begins_as_dicom
from wavesplat._readers.dicom.suv import Tracer, tracer_of
from wavesplat._readers.dicom.units import ValueUnit, unit_of_values
from wavesplat._readers.dicom.values import (
    as_numbers,
    first_items,
    integer,
    items,
    numbers,
    raw_value,
    text,
    whole_numbers,
)
from wavesplat._storage import size_checks
from wavesplat._storage.reading import BoundedFile
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

# DICOM files that are no images: their content, and advice on what to name instead.
#
# By the modality (DICOM PS3.3, C.7.3.1.1.1), else by the name of the SOP class (PS3.6, annex A).


class Content(NamedTuple):
    """The content of a file and advice on what to write instead, the ends of a sentence each."""

    what: str
    instead: str


IMAGES = "name the images that it belongs to, or a folder of them"
WAVEFORMS = "waveforms are no volume; open them with pydicom (Dataset.waveform_array)"
DICOMDIR = "1.2.840.10008.1.3.10"
#: SOP classes that have rows and columns, and no pixels: raw data, which scanners add to a series, and spectra.
WITHOUT_PIXELS = ("1.2.840.10008.5.1.4.1.1.66", "1.2.840.10008.5.1.4.1.1.4.2")

#: Contents by modality.
NO_IMAGES = {
    "RTSTRUCT": Content(
        "a structure set, regions of a patient as lines (RTSTRUCT)",
        "draw it on the scan that it belongs to: wavesplat slice SCAN --contours FILE, or --labels FILE, which render "
        "takes too",
    ),
    "RTPLAN": Content(
        "a plan of a radiotherapy, its beams and fractions (RTPLAN)",
        "name the scan, or lay the dose (RTDOSE) over it: wavesplat slice SCAN --layer DOSE",
    ),
    "PLAN": Content("a plan", IMAGES),
    "RTINTENT": Content("the intent of a radiotherapy (RTINTENT)", "name the scan, or the dose (RTDOSE)"),
    "RTRAD": Content("beams of a radiotherapy (RTRAD)", "name the scan, or the dose (RTDOSE)"),
    "RTRECORD": Content("a record of a radiotherapy (RTRECORD)", "name the scan or the dose (RTDOSE) of the treatment"),
    "RTDOSE": Content("a dose without its grid (RTDOSE)", "export it with the grid of doses, or name the scan"),
    "SR": Content(
        "a structured report, text and measurements (SR)", "name the images or the segmentation (SEG) that it is about"
    ),
    "PR": Content(
        "a presentation state, how images were shown (PR)",
        "name the images themselves; how they are shown say --window and --zoom",
    ),
    "KO": Content("a list of important images (KO)", IMAGES),
    "SEG": Content(
        "a segmentation as surfaces, not as voxels (SEG)", "export it as a segmentation of voxels, such as by 3D Slicer"
    ),
    "REG": Content("a registration of two scans (REG)", "name one of the scans"),
    "FID": Content("fiducials", IMAGES),
    "ANN": Content("annotations of a slide (ANN)", "open them with a viewer of slides"),
    "M3D": Content("a surface for printing (M3D)", "take the surface out of it, such as by pydicom: it is no volume"),
    "DOC": Content("a document", "take the document out of it, such as by pydicom: it is no volume"),
    "AU": Content("sound", WAVEFORMS),
    "ECG": Content("an electrocardiogram (ECG)", WAVEFORMS),
    "EEG": Content("an electroencephalogram (EEG)", WAVEFORMS),
    "EMG": Content("an electromyogram (EMG)", WAVEFORMS),
    "EOG": Content("an electrooculogram (EOG)", WAVEFORMS),
    "POS": Content("positions of a body (POS)", WAVEFORMS),
    "HD": Content("pressures and waveforms (HD)", WAVEFORMS),
    "RESP": Content("a curve of breath (RESP)", WAVEFORMS),
    "RWV": Content("a table of real world values (RWV)", IMAGES),
}
DIRECTORY = Content("a directory of other files (DICOMDIR)", IMAGES)


def content_by(modality: str, sop_class: str, *, is_directory: bool) -> Content | None:
    """The content of a file without pixels; None where neither modality nor SOP class decides."""
    if is_directory or sop_class == DICOMDIR:
        return DIRECTORY
    if modality in NO_IMAGES:
        return NO_IMAGES[modality]
    from pydicom.uid import UID

    name = UID(sop_class).name if sop_class else ""
    if not name.endswith("Storage") or "Image" in name:
        return None
    return Content(f"something else ({name.removesuffix(' Storage')})", IMAGES)


# Headers of DICOM files, by pydicom: what each frame is, where it lies, and how its stored numbers become values.

#: Functional groups that are read: groups with attributes, and of pixels, values, positions, orientations and segments.
GROUPS = SEQUENCES | {
    *(0x0062000A, 0x00289110, 0x00289145, 0x00209113, 0x00209116, 0x0020930E, 0x0020930F, 0x00409096),
}
#: Prefix of the names of attributes by which enhanced files count frames.
INDEX = "index of "
#: Approximate memory of the description of a frame, beside its pixels, in bytes.
FRAME_BYTES = 600
NONE = float("nan")


@dataclass(frozen=True)
class Frame:
    """One 2-D picture of a file; lengths in mm, LPS; NaN where nothing is said."""

    file: Path
    #: Number of the frame in the file, and of the file in the series.
    index: int
    instance: int
    position: NDArray[np.float64]
    orientation: NDArray[np.float64]
    #: Distances between rows, and between columns.
    pixel_spacing: tuple[float, float]
    slope: float
    intercept: float
    stack: str = ""
    #: Number of the segment that it is a mask of; 0 of frames that are none.
    segment: int = 0
    #: Attributes that may distinguish it from other frames of its position, by the names of `attributes.py`.
    attributes: Mapping[str, Value] = field(default_factory=dict)
    #: Lengths of the two directions of `orientation` in the file, of which it has unit vectors.
    orientation_lengths: tuple[float, float] = (1.0, 1.0)

    @property
    def name(self) -> str:
        """Name in messages."""
        return self.file.name if self.index == 0 else f"{self.file.name} (frame {self.index})"

    @property
    def normal(self) -> NDArray[np.float64]:
        """Normal of the frame's plane."""
        return np.cross(self.orientation[:3], self.orientation[3:])

    def is_placed(self) -> bool:
        """Whether position and orientation are known."""
        return bool(np.isfinite(self.position).all() and np.isfinite(self.orientation).all())


@dataclass(frozen=True)
class Header:
    """Values that a file states once for all of its frames, and the frames."""

    file: Path
    sop_class: str
    image_type: str
    #: UIDs of the study and of the series, number of the series (None where there is none), UID of the file.
    study: str
    series: str
    series_number: int | None
    instance_uid: str
    description: str
    #: Name of the radiotracer; "" if there is none.
    drug: str
    modality: str | None
    transfer_syntax: str
    size: tuple[int, int]
    n_samples: int
    photometric: str
    #: PlanarConfiguration: 1 where each colour lies in a plane of its own.
    planes: int
    bits_allocated: int
    bits_stored: int
    high_bit: int
    is_signed: bool
    n_frames: int
    #: Place of the pixels; None where it is not known before they are read.
    pixel_data: PixelData | None
    #: The lowest and the highest stored number that stands for pixels outside of the scan.
    padding: tuple[int, int] | None
    #: Distance between slices, for frames without positions.
    slice_step: float
    has_lookup_table: bool
    #: Unit of the values once slope and intercept are applied.
    value_unit: ValueUnit
    #: Elements that uptake values need; None of files that are no PET.
    tracer: Tracer | None
    #: Whether its axes are a patient's, and not an ultrasound probe's.
    is_of_patient: bool
    frames: tuple[Frame, ...]
    #: Facts about the frames as pictures: a film, a window.
    pictures: FactsOfPictures = NO_PICTURES
    #: How the frames lie side by side in one picture, and the header of this picture; None where each is a picture of
    #: its own.
    tiles: Tiles | None = None
    whole: Header | None = None
    #: A sentence on what was assumed about the values; empty if nothing was.
    guess: str = ""

    @property
    def n_colors(self) -> int:
        """Numbers of a pixel, once looked up in the file's palette."""
        return 3 if self.photometric == "PALETTE COLOR" else self.n_samples


def is_dicom(file: Path) -> bool:
    """Whether a file begins as DICOM does: with its mark or, without one, with an element of group 8."""
    with file.open("rb") as stream:
        return begins_as_dicom(stream.read(N_FIRST))


def header_of(file: Path) -> Header | None:
    """The header of a file; None for DICOM that is no image. Raises nearly anything if it is damaged."""
    with BoundedFile(file) as stream:
        dataset, content = header_dataset(file, stream)
        modality = text(dataset, 0x00080060).upper()
        rows, columns = integer(dataset, 0x00280010), integer(dataset, 0x00280011)
        if rows * columns == 0 or text(dataset, 0x00080016) in WITHOUT_PIXELS:
            if _content(dataset) is not None:
                return None
            raise ValueError("the header has no rows and columns")
        pixel_data = pixel_data_at(content, dataset, file)
    bits = integer(dataset, 0x00280100)
    stored = integer(dataset, 0x00280101) or bits
    n_frames = _n_frames(dataset, file)
    header = Header(
        file=file,
        sop_class=text(dataset, 0x00080016),
        image_type=text(dataset, 0x00080008).upper(),
        study=text(dataset, 0x0020000D),
        series=text(dataset, 0x0020000E),
        series_number=_series_number(dataset),
        instance_uid=text(dataset, 0x00080018),
        description=text(dataset, 0x0008103E),
        drug=_drug(dataset),
        modality=modality or None,
        transfer_syntax=str(dataset.file_meta.get("TransferSyntaxUID", "1.2.840.10008.1.2")),
        size=(columns, rows),
        n_samples=integer(dataset, 0x00280002) or 1,
        photometric=text(dataset, 0x00280004).upper(),
        planes=integer(dataset, 0x00280006),
        bits_allocated=bits,
        bits_stored=stored,
        high_bit=integer(dataset, 0x00280102) if 0x00280102 in dataset else stored - 1,
        is_signed=integer(dataset, 0x00280103) == 1,
        n_frames=n_frames,
        pixel_data=pixel_data,
        padding=_padding(dataset),
        slice_step=_slice_step(dataset),
        has_lookup_table=0x00283000 in dataset,
        value_unit=ValueUnit(None),
        tracer=tracer_of(dataset) if modality == "PT" else None,
        is_of_patient=0x0020930F not in _shared_groups(dataset),
        frames=(),
    )
    if n_frames > 1:
        check_n_frames(header)
        size_checks.check_memory(n_frames * FRAME_BYTES, file)
        n_groups = len(items(dataset, 0x52009230))
        if 0 < n_groups < n_frames:
            raise FileError(
                f"the header says {n_frames} frames (NumberOfFrames) and describes {n_groups} of them "
                f"(PerFrameFunctionalGroupsSequence); copy or export it again: {file}"
            )
    frames = tuple(_frames(dataset, file, n_frames))
    # After the checks: a film has as many times as its header promises frames.
    header = replace(header, pictures=facts_of_pictures(dataset, modality, n_frames))
    header = replace(header, frames=frames, value_unit=_value_unit(dataset, frames[0], modality))
    return _split(header, dataset) if n_frames == 1 else header


def _split(header: Header, dataset: Dataset) -> Header:
    """The header of a picture with several slices side by side as one of many frames; of other pictures as it is."""
    [frame] = header.frames
    place = (frame.position, frame.orientation, frame.pixel_spacing, header.slice_step)
    found = split_of(dataset, Picture(header.image_type, header.size, *place, header.file))
    if found is None:
        return header
    own = [attributes_of_frames(item, {}, (), 1)[0] for item in found.items] or [{}] * found.tiles.n
    frames = tuple(
        replace(frame, index=k, position=position, attributes={**frame.attributes, **attributes})
        for k, (position, attributes) in enumerate(zip(found.positions, own, strict=True))
    )
    size = found.tiles.size_of_one(header.size)
    return replace(
        header, size=size, n_frames=found.tiles.n, frames=frames, tiles=found.tiles, whole=header, guess=found.guess
    )


def content_of(file: Path) -> Content:
    """The content of a DICOM file without an image."""
    with BoundedFile(file) as stream:
        dataset, _ = header_dataset(file, stream)
    return _content(dataset) or Content("something else", IMAGES)


def _content(dataset: Dataset) -> Content | None:
    sop_class = text(dataset, 0x00080016) or str(dataset.file_meta.get("MediaStorageSOPClassUID", ""))
    return content_by(text(dataset, 0x00080060).upper(), sop_class, is_directory=0x00041220 in dataset)


def _n_frames(dataset: Dataset, file: Path) -> int:
    given = text(dataset, 0x00280008).partition("\\")[0].strip()
    try:
        return max(1, int(float(given or 1)))
    except (ValueError, OverflowError):
        raise FileError(
            f"NumberOfFrames is {given[:32]!r}, and is a whole number; copy or export it again: {file}"
        ) from None


def _drug(dataset: Dataset) -> str:
    """The name of the tracer: of its code, else as somebody typed it."""
    found = items(dataset, 0x00540016)
    codes = items(found[0], 0x00540304) if found else ()
    return (text(codes[0], 0x00080104) if codes else "") or (text(found[0], 0x00180031) if found else "")


def _value_unit(dataset: Dataset, frame: Frame, modality: str) -> ValueUnit:
    own = [first_items(group, GROUPS) for group in items(dataset, 0x52009230)[:1]]
    return unit_of_values(dataset, (*own, _shared_groups(dataset)), modality, (frame.slope, frame.intercept))


def _series_number(dataset: Dataset) -> int | None:
    found = as_numbers(raw_value(dataset, 0x00200011), "decimal")
    return int(found[0]) if found and math.isfinite(found[0]) else None


def _slice_step(dataset: Dataset) -> float:
    steps = [numbers(dataset, tag, 1)[0] for tag in (0x00180088, 0x00180050)]
    return next((float(step) for step in steps if np.isfinite(step) and step != 0), NONE)


def _padding(dataset: Dataset) -> tuple[int, int] | None:
    """PixelPaddingValue, and PixelPaddingRangeLimit where there is one."""
    encoding = "i2" if integer(dataset, 0x00280103) == 1 else "u2"
    values = [value for tag in (0x00280120, 0x00280121) for value in whole_numbers(dataset, tag, encoding)[:1]]
    return (min(values), max(values)) if 0x00280120 in dataset and values else None


# Frames


def _frames(dataset: Dataset, file: Path, n_frames: int) -> Iterator[Frame]:
    dimensions = [_name_of_dimension(item) for item in items(dataset, 0x00209222)]
    along = _positions_along_a_line(dataset, n_frames)
    instance = _instance(dataset)
    own, shared = [first_items(group, GROUPS) for group in items(dataset, 0x52009230)], _shared_groups(dataset)
    attributes = attributes_of_frames(dataset, shared, own, n_frames)
    given: dict[str, Any] = {}
    for index in range(n_frames):
        # Frames without groups of their own are alike but for the place along the line.
        if index < len(own) or not given:
            groups = (own[index] if index < len(own) else {}, shared)
            given = _of_frame(dataset, groups, dimensions, attributes[index])
        else:
            given["attributes"] = attributes[index]
        if along is not None:
            given["position"] = along[index]
        yield Frame(file=file, index=index, instance=instance, **given)


def _of_frame(
    dataset: Dataset,
    groups: Sequence[Mapping[int, Any]],
    dimensions: Sequence[str],
    attributes: Mapping[str, Value],
) -> dict[str, Any]:
    """Arguments of `Frame` from its functional groups, or else from the dataset."""
    content = _in_group(groups, 0x00209111)
    indices = whole_numbers(content, 0x00209157, "u4") if content is not None else ()
    # A file may number its frames and not name the attributes that it numbers (DimensionIndexSequence).
    names = dimensions or [f"{INDEX}dimension {n}" for n in range(1, len(indices) + 1)]
    numbered = {name: float(value) for value, name in zip(indices, names, strict=False)}
    spacing = _found(groups, dataset, 0x00289110, 0x00280030, 2)
    position, orientation, lengths = _placed(groups, dataset)
    is_lost = not np.isfinite(position).all() and not (spacing > 0).all()  # some write 0 where they know none
    if is_lost or not np.isfinite(spacing).all():
        spacing = np.array(sizes_of_pixels(dataset)[0])
    segment = _in_group(groups, 0x0062000A)
    return {
        "position": position,
        "orientation": orientation,
        "orientation_lengths": lengths,
        "pixel_spacing": (float(spacing[0]), float(spacing[1])),
        # Doses have a scaling instead of a slope.
        "slope": _factor(groups, dataset, 0x00281053, _factor((), dataset, 0x3004000E, 1.0)),
        "intercept": _factor(groups, dataset, 0x00281052, 0.0),
        "stack": text(content, 0x00209056) if content is not None else "",
        "segment": 0 if segment is None else integer(segment, 0x0062000B),
        "attributes": {**attributes, **numbered} if numbered else attributes,
    }


def _instance(dataset: Dataset) -> int:
    try:
        return int(float(text(dataset, 0x00200013) or 0))
    except (ValueError, OverflowError):
        return 0


def _factor(groups: Sequence[Mapping[int, Any]], dataset: Dataset, tag: int, absent: float) -> float:
    """Slope or intercept; NaN where something is written that is no number."""
    item = _in_group(groups, 0x00289145)
    for holder in (item, dataset):
        if holder is not None and text(holder, tag):
            found = as_numbers(raw_value(holder, tag), "decimal")
            return found[0] if found and math.isfinite(found[0]) else NONE
    return absent


def _placed(
    groups: Sequence[Mapping[int, Any]], dataset: Dataset
) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[float, float]]:
    """Position and orientation in the patient; else in the volume of an ultrasound probe; else of a detector.

    The directions of rows and columns are made unit vectors, since distances are between pixels; the last two numbers
    are their lengths in the file.
    """
    position = _found(groups, dataset, 0x00209113, 0x00200032, 3)
    orientation = _found(groups, dataset, 0x00209116, 0x00200037, 6)
    if (
        not np.isfinite(position).all()
        and np.isfinite(probed := _found(groups, dataset, 0x0020930E, 0x00209301, 3, "f8")).all()
    ):
        position, orientation = probed, _found(groups, dataset, 0x0020930F, 0x00209302, 6, "f8")
    detectors = items(dataset, 0x00540022)
    if not np.isfinite(orientation).all() and detectors:
        position, orientation = numbers(detectors[0], 0x00200032, 3), numbers(detectors[0], 0x00200037, 6)
    along_row, along_column = math.hypot(*orientation[:3]), math.hypot(*orientation[3:])
    if not (along_row > 0 and along_column > 0):
        return position, np.full(6, NONE), (1.0, 1.0)
    unit = np.concatenate([orientation[:3] / along_row, orientation[3:] / along_column])
    return position, unit, (along_row, along_column)


def _positions_along_a_line(dataset: Dataset, n_frames: int) -> NDArray[np.float64] | None:
    """Positions of frames that have none of their own: offsets of a dose grid, or slices of a tomogram."""
    if n_frames == 1 or items(dataset, 0x52009230):
        return None
    position, orientation, _ = _placed((), dataset)
    normal = np.cross(orientation[:3], orientation[3:])
    offsets = numbers(dataset, 0x3004000C, n_frames)
    slices = whole_numbers(dataset, 0x00540080, "u2")
    if np.isfinite(offsets).all():
        # Offsets are from the first frame, or positions along z.
        offsets = offsets - offsets[0]
    elif len(slices) == n_frames and items(dataset, 0x00540022):
        offsets = (np.array(slices) - 1.0) * _slice_step(dataset)
    else:
        return None
    along: NDArray[np.float64] = position + offsets[:, None] * normal
    return along


def _shared_groups(dataset: Dataset) -> dict[int, Any]:
    """The functional groups of all frames, by tag."""
    shared = items(dataset, 0x52009229)
    return first_items(shared[0], GROUPS) if shared else {}


def _in_group(groups: Sequence[Mapping[int, Any]], tag: int) -> Any:
    """The item of a functional group, the frame's own rather than the shared one."""
    return next((group[tag] for group in groups if tag in group), None)


def _found(groups: Sequence[Mapping[int, Any]], dataset: Dataset, group: int, *given: Any) -> NDArray[np.float64]:
    """Numbers of an attribute: in the frame's group, in the shared one, or beside them.

    given : its tag, their count, and their encoding if it is not decimal.
    """
    item = _in_group(groups, group)
    found = np.full(given[1], NONE) if item is None else numbers(item, *given)
    return found if np.isfinite(found).all() else numbers(dataset, *given)


def _name_of_dimension(item: Any) -> str:
    """The name of a dimension: from the DICOM dictionary or, for a private element, from the file."""
    group, element = (*whole_numbers(item, 0x00209165, "u2"), 0, 0)[:2]  # two shorts
    return f"{INDEX}{_description(group << 16 | element) or text(item, 0x00209421) or f'{group:04x},{element:04x}'}"


@lru_cache
def _description(tag: int) -> str:
    from pydicom.datadict import dictionary_description, dictionary_has_tag

    return dictionary_description(tag) if dictionary_has_tag(tag) else ""
