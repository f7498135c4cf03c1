"""DICOM segmentations (SEG) as label maps: the number of its segment for every voxel, 0 where there is none.

A file has a mask of one segment a frame (BINARY), shares of voxels instead (FRACTIONAL), or numbers of segments in one
frame a slice (LABELMAP). Frames come in any order, and slices in which there is nothing of a segment are left out: each
frame is put at its own place, on a grid of the frames' pixels and of the distance of slices that the header gives.
Format: DICOM PS3.3, A.51, A.101 and C.8.20. Names and colours come from `SegmentSequence`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import affine
from wavesplat._model.volume.facts import Channel, Facts
from wavesplat._readers.dicom.header import Frame, Header, header_of, is_dicom
from wavesplat._readers.dicom.pixel_data import header_dataset
from wavesplat._readers.dicom.pixels import frame_by_frame
from wavesplat._readers.dicom.series import mended
from wavesplat._readers.dicom.values import first_items, integer, items, numbers, text
from wavesplat._readers.request import Grid, Request, choose, quiet, unwarned
from wavesplat._storage import size_checks
from wavesplat._storage.reading import BoundedFile, reading
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

SOP_CLASSES = {"1.2.840.10008.5.1.4.1.1.66.4", "1.2.840.10008.5.1.4.1.1.66.7"}
#: Words of SegmentationType (0062,0001).
KINDS = ("BINARY", "FRACTIONAL", "LABELMAP")
#: Share of a voxel from which on it counts as a segment's.
HALF = 0.5
#: Positions nearer than this, mm, are of one slice: headers round them.
PLACE_MM = 0.01
#: Tolerances of slice positions, as parts of their distance, and of directions.
TOLERANCE, DIRECTION = 0.05, 1e-3
#: Slices at most, those left out included; no scan has as many.
MAX_SLICES = 1 << 16
#: Segments that a message names, at most.
N_NAMED = 4


@dataclass(frozen=True)
class Segment:
    """A segment: its number in the file, its name, and its colour in CIE Lab (L 0..100, a and b -128..127)."""

    number: int
    name: str
    lab: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Segmentation:
    """Statements of the header about all frames."""

    #: BINARY, FRACTIONAL or LABELMAP.
    kind: str
    #: In the order of the file, without the background of label maps.
    segments: tuple[Segment, ...]
    #: The stored number that is a whole voxel, of shares.
    whole: int
    #: Distance of slices, mm, and their thickness; NaN where the file gives none.
    between: float
    thickness: float
    is_tiled: bool


def is_segmentation(header: Header) -> bool:
    """Whether the frames of a file are masks."""
    return header.modality == "SEG" or header.sop_class in SOP_CLASSES


def segments_in(file: Path) -> tuple[Segment, ...]:
    """The segments that a file describes."""
    return _described(file).segments


def read(header: Header, request: Request, wanted: Sequence[int] | None = None) -> Grid:
    """The label map of a segmentation, or with `request.channel` one segment by itself.

    wanted : numbers of the segments that are taken; all if None.
    """
    about = _described(header.file)
    if about.is_tiled:
        raise FileError(
            f"the file segments a slide (whole-slide microscopy) in tiles, and no volume; open it with a viewer of "
            f"slides: {header.file}"
        )
    if about.kind not in KINDS:
        raise FileError(
            f"the kind of the segmentation is {about.kind[:32]!r} (SegmentationType, 0062,0001), and must be one of "
            f"{', '.join(KINDS)}; export it again: {header.file}"
        )
    if header.n_samples != 1:
        raise FileError(f"the file says that it is a segmentation, and has colours; export it again: {header.file}")
    choose("time", 1, request.time, request.path)
    frames, guesses, _ = mended([header], request)
    if not all(frame.is_placed() for frame in frames):
        raise FileError(
            f"the file segments a flat picture: its frames do not say where they lie in the patient; name the "
            f"segmentation of a volume: {header.file}"
        )
    slices, n_slices, matrix, notes = _grid(frames, about, header)
    several = Counter(zip([frame.segment for frame in frames], slices.tolist(), strict=True))
    if n_doubled := sum(count > 1 for count in several.values()):
        notes.append(f"frames of one segment and slice as one mask: {n_doubled} slices have several of them")
    pixels = frame_by_frame(replace(header, photometric="MONOCHROME2"))  # a palette is for display
    shape = (n_slices, header.size[1], header.size[0])
    facts = Facts(unit="mm", is_anatomical=header.is_of_patient, modality="SEG", guesses=(*guesses, *notes))
    if undescribed := sorted({frame.segment for frame in frames} - {one.number for one in about.segments} - {0}):
        about = replace(about, segments=(*about.segments, *(Segment(n, f"segment {n}") for n in undescribed)))
    chosen = about.segments if wanted is None else tuple(one for one in about.segments if one.number in wanted)
    masks = _Masks(about, frames, slices, pixels)
    if request.channel is not None:
        samples, own = _of_one(masks, request.channel, shape, request)
        return Grid(samples, matrix, replace(facts, channel=own.channel, channels=own.channels))
    if about.kind == "LABELMAP":
        return Grid(_numbers_of(masks, header, shape, wanted), matrix, facts)
    samples, overlap = _label_map(masks, chosen, shape, request)
    losses: tuple[str, ...] = ()
    if about.kind == "FRACTIONAL":
        losses = (
            f"shares of voxels (FRACTIONAL) as whole ones, from {HALF:g} on; channel=0 has the first segment's shares",
        )
    return Grid(samples, matrix, facts, losses, overlap)


# The header


def _described(file: Path) -> Segmentation:
    with BoundedFile(file) as stream:
        dataset, _ = header_dataset(file, stream)
    measures = _measures(dataset)
    found = tuple(_segment(item) for item in items(dataset, 0x00620002))
    between, thickness = (
        abs(float(numbers(measures, tag, 1)[0])) if measures is not None else float("nan")
        for tag in (0x00180088, 0x00180050)
    )
    return Segmentation(
        kind=text(dataset, 0x00620001).upper() or "BINARY",
        segments=tuple(one for one in found if one.number != 0),
        whole=integer(dataset, 0x0062000E) or 1,
        between=between,
        thickness=thickness,
        is_tiled=0x00480006 in dataset or text(dataset, 0x00209311).upper().startswith("TILED"),
    )


def _segment(item: Any) -> Segment:
    number = integer(item, 0x00620004)
    stored = item.get("RecommendedDisplayCIELabValue")
    lab = None
    if stored is not None and len(stored) == 3:
        # PS3.3, C.10.7.1.1: 16 bits over 0..100, and over -128..127.
        light, a, b = (float(value) / 65535 for value in stored)
        lab = (100 * light, 255 * a - 128, 255 * b - 128)
    return Segment(number, str(item.get("SegmentLabel") or "").strip() or f"segment {number}", lab)


def _measures(dataset: Dataset) -> Any:
    """The pixel measures of all frames, or of the first."""
    for groups in (items(dataset, 0x52009229), items(dataset, 0x52009230)):
        if groups and (found := first_items(groups[0], {0x00289110})):
            return found[0x00289110]
    return None


# The grid


def _grid(
    frames: Sequence[Frame], about: Segmentation, header: Header
) -> tuple[NDArray[np.int64], int, NDArray[np.float64], list[str]]:
    """The slice of each frame, the number of slices, the affine, and assumptions, a sentence each."""
    first = frames[0]
    if any(np.abs(frame.orientation - first.orientation).max() > DIRECTION for frame in frames):
        raise FileError(f"the frames of the segmentation are not parallel; export it again: {header.file}")
    positions = np.array([frame.position for frame in frames])
    along = positions @ first.normal
    order = np.argsort(along, kind="stable")
    is_next = np.diff(along[order], prepend=along[order[0]]) > PLACE_MM
    place = np.empty(len(frames), np.int64)
    place[order] = np.cumsum(is_next)
    places = positions[order][np.r_[True, is_next[1:]]]  # one position for each place, in order
    if len(places) == 1:
        step = about.between if about.between > 0 else about.thickness
        notes = ["an empty slice on each side of the only one, since a volume has several"]
        if not step > 0:
            step = min(first.pixel_spacing)
            notes += [f"the only slice {step:.4g} mm thick, as its pixels are wide: the file does not say it"]
        return place + 1, 3, _world_from_index(first, places[0] - step * first.normal, step * first.normal), notes
    way = places[-1] - places[0]
    length = float(np.linalg.norm(way))
    offsets = (places - places[0]) @ way / length
    beside = np.linalg.norm(places - places[0] - offsets[:, None] * way / length, axis=1).max()
    smallest = float(np.diff(offsets).min())
    if beside > TOLERANCE * smallest:
        raise FileError(
            f"the frames of the segmentation are shifted against each other by {beside:.3g} mm; export it again: "
            f"{header.file}"
        )
    for step in (about.between, smallest):
        if (numbered := _numbered(offsets, step)) is not None:
            notes = []
            if len(places) < numbered[-1] + 1 and step == smallest and not about.between > 0:
                reason = "the file does not say it, and leaves out slices without segments"
                notes = [f"slices {smallest:.4g} mm apart, the smallest distance of frames: {reason}"]
            n_slices = int(numbered[-1]) + 1
            return numbered[place], n_slices, _world_from_index(first, places[0], way / numbered[-1]), notes
    listed = ", ".join(f"{distance:.4g}" for distance in np.unique(np.round(np.diff(offsets), 3))[:N_NAMED])
    raise FileError(
        f"the frames of the segmentation lie at uneven distances ({listed} mm), which are no multiples of one; "
        f"export it again: {header.file}"
    )


def _numbered(offsets: NDArray[np.float64], step: float) -> NDArray[np.int64] | None:
    """Numbers of slices at these offsets; None if they are no multiples of the step."""
    if not (step > 0 and offsets[-1] < step * MAX_SLICES):
        return None
    n_steps = round(float(offsets[-1]) / step)
    if n_steps < len(offsets) - 1:
        return None
    steps = offsets * n_steps / offsets[-1]  # a rounded step would add up over many slices
    whole = np.round(steps).astype(np.int64)
    is_even = np.abs(steps - whole).max() <= TOLERANCE and abs(offsets[-1] / step - n_steps) <= TOLERANCE * n_steps
    return whole if is_even and (np.diff(whole) > 0).all() else None


def _world_from_index(first: Frame, position: NDArray[np.float64], step: NDArray[np.float64]) -> NDArray[np.float64]:
    matrix = np.eye(4)
    matrix[:3, 0] = first.orientation[:3] * first.pixel_spacing[1]
    matrix[:3, 1] = first.orientation[3:] * first.pixel_spacing[0]
    matrix[:3, 2], matrix[:3, 3] = step, position
    return affine.RAS_FROM_LPS @ matrix


# The samples


class _Masks:
    """Masks of segments, read frame by frame."""

    def __init__(
        self,
        about: Segmentation,
        frames: Sequence[Frame],
        slices: NDArray[np.int64],
        pixels: Callable[[int], NDArray[Any]],
    ) -> None:
        self.about, self.frames, self.slices, self.pixels = about, frames, slices, pixels

    def of(self, segment: Segment) -> Iterator[tuple[int, NDArray[Any]]]:
        """The slice of each frame with the segment, and the share of the segment in its voxels, 0..1 or a mask."""
        for frame, at in zip(self.frames, self.slices.tolist(), strict=True):
            if self.about.kind == "LABELMAP":
                yield at, self.pixels(frame.index) == segment.number
            elif frame.segment == segment.number or (frame.segment == 0 and len(self.about.segments) == 1):
                stored = self.pixels(frame.index)
                yield (
                    at,
                    stored.astype(np.float32) / self.about.whole if self.about.kind == "FRACTIONAL" else stored != 0,
                )


def _of_one(masks: _Masks, number: int, shape: tuple[int, int, int], request: Request) -> tuple[NDArray[Any], Facts]:
    """One segment: its shares, or 0 and 1; and the facts about it."""
    segments = masks.about.segments
    if not 0 <= number < len(segments):
        listed = ", ".join(f"{n} {segment.name}" for n, segment in enumerate(segments))
        raise ArgumentError(f"channel={number}, but the segmentation holds: {listed}: {request.path}")
    dtype = np.dtype(np.float32 if masks.about.kind == "FRACTIONAL" else np.uint8)
    size_checks.check_memory(size_checks.n_bytes(shape, dtype), request.path)
    samples = np.zeros(shape, dtype)
    for at, share in masks.of(segments[number]):
        np.maximum(samples[at], share, out=samples[at])
    channels = tuple(Channel(segment.name) for segment in segments)
    return samples, Facts(channel=channels[number], channels=channels)


def _label_map(
    masks: _Masks, segments: Sequence[Segment], shape: tuple[int, int, int], request: Request
) -> tuple[NDArray[Any], str | None]:
    """Numbers of the segments; where they overlap, the later one, and a sentence on the others."""
    most = max((segment.number for segment in segments), default=0)
    dtype = np.dtype(np.uint8 if most < 256 else np.uint16)
    size_checks.check_memory(size_checks.n_bytes(shape, dtype), request.path)
    samples = np.zeros(shape, dtype)
    counts, hidden = np.zeros(most + 1, np.int64), np.zeros(most + 1, np.int64)
    for segment in segments:
        for at, share in masks.of(segment):
            mask = share >= HALF
            below = samples[at][mask]
            hidden += np.bincount(below[below != segment.number], minlength=most + 1)
            counts[segment.number] += np.count_nonzero(below != segment.number)
            samples[at][mask] = segment.number
    names = [
        f"{hidden[segment.number]} of {counts[segment.number]} voxels of {segment.name!r}"
        for segment in segments
        if hidden[segment.number]
    ]
    if not names:
        return samples, None
    more = ", ..." if len(names) > N_NAMED else ""
    shown = f"the last of the file is shown in {hidden[1:].sum()} voxels"
    return samples, f"segments overlap, and {shown}: hidden are {', '.join(names[:N_NAMED])}{more}"


def _numbers_of(
    masks: _Masks, header: Header, shape: tuple[int, int, int], wanted: Sequence[int] | None
) -> NDArray[Any]:
    """The numbers of a label map; 0 for padding, and for segments that are not wanted."""
    dtype = np.dtype(np.uint8 if header.bits_allocated <= 8 else np.uint16)
    size_checks.check_memory(size_checks.n_bytes(shape, dtype), header.file)
    samples = np.zeros(shape, dtype)
    none = header.padding or (0, 0)
    for frame, at in zip(masks.frames, masks.slices.tolist(), strict=True):
        stored = masks.pixels(frame.index)
        is_label = (stored < none[0]) | (stored > none[1]) if wanted is None else np.isin(stored, wanted)
        samples[at][is_label] = stored[is_label]
    return samples


# DICOM files of segmentations, for those who know a path alone: their segments, and some of them by themselves.


def segmentation_at(path: Path) -> Path | None:
    """The DICOM segmentation at a path: the file, or the only DICOM file of the folder; None if it is none."""
    with quiet("pydicom"), unwarned("pydicom"):
        if not path.is_dir():
            return path if _is_segmentation(path) else None
        found = islice((entry for entry in sorted(path.iterdir()) if entry.is_file() and is_dicom(entry)), 2)
        files = list(found)
        return files[0] if len(files) == 1 and _is_segmentation(files[0]) else None


def _is_segmentation(file: Path) -> bool:
    # Parsers of damaged files raise nearly anything; whoever reads the volume says what is wrong.
    try:
        header = header_of(file) if is_dicom(file) else None
    except Exception:  # noqa: BLE001
        return False
    return header is not None and is_segmentation(header)


def segments_at(path: Path) -> tuple[Segment, ...]:
    """The segments of the DICOM segmentation at a path; none if it is none."""
    file = segmentation_at(path)
    if file is None:
        return ()
    with reading("DICOM", path), quiet("pydicom"), unwarned("pydicom"):
        return segments_in(file)


def with_segments(file: Path, numbers: Sequence[int]) -> Grid:
    """The label map of a DICOM segmentation with these segments alone."""
    with reading("DICOM", file), quiet("pydicom"), unwarned("pydicom"):
        header = header_of(file)
        assert header is not None, "the volume was read before"
        return read(header, Request(file), numbers)
