"""DICOM files of segmentations, for those who know a path alone: their segments, and some of them by themselves."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from pathlib import Path

from wavesplat._files.reading import reading
from wavesplat._readers import dicom_segments
from wavesplat._readers.dicom_header import header_of, is_dicom
from wavesplat._readers.dicom_segments import Segment
from wavesplat._readers.request import Grid, Request, quiet, unwarned


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
    return header is not None and dicom_segments.is_segmentation(header)


def segments_at(path: Path) -> tuple[Segment, ...]:
    """The segments of the DICOM segmentation at a path; none if it is none."""
    file = segmentation_at(path)
    if file is None:
        return ()
    with reading("DICOM", path), quiet("pydicom"), unwarned("pydicom"):
        return dicom_segments.segments_in(file)


def with_segments(file: Path, numbers: Sequence[int]) -> Grid:
    """The label map of a DICOM segmentation with these segments alone."""
    with reading("DICOM", file), quiet("pydicom"), unwarned("pydicom"):
        header = header_of(file)
        assert header is not None, "the volume was read before"
        return dicom_segments.read(header, Request(file), numbers)
