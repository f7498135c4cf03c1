"""DICOM: a folder with a series of slices, one of its files, or a multi-frame file, by SimpleITK (GDCM).

The affine comes from the slices' own positions, so that a gantry-tilted stack keeps its shear; ITK would straighten it.
Slices that are not evenly spaced are refused, because a gap drawn as if it were none is a lie about the patient.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import payload
from wavesplat._files.reading import reading
from wavesplat._files.silence import silenced
from wavesplat._model import affine
from wavesplat._readers.itk import affine_of, simple_itk
from wavesplat._readers.request import Grid, Request, choose
from wavesplat.errors import ArgumentError, FileError

__all__ = ["read"]

#: Part of the slice distance by which a slice may be off its place: positions are rounded by scanners.
TOLERANCE = 0.05


@dataclass(frozen=True)
class Slice:
    """What the header of one file says, lengths in mm, LPS; NaN where it says nothing."""

    file: Path
    instance_uid: str
    number: int
    n_frames: int
    position: NDArray[np.float64]
    orientation: NDArray[np.float64]
    pixel_spacing: tuple[float, float]
    size: tuple[int, int]


def read(request: Request) -> Grid:
    """The volume of a DICOM series."""
    with reading("DICOM", request.path), silenced():
        path = request.file
        if path.is_dir():
            return _read_series(path, request.series, request)
        first = _header(path)
        if first.n_frames > 1:
            return _read_files([path], request, None)
        return _read_series(path.parent, request.series or _series_uid(path), request)


def _read_series(folder: Path, uid: str | None, request: Request) -> Grid:
    reader = simple_itk().ImageSeriesReader
    uids = reader.GetGDCMSeriesIDs(str(folder))
    if not uids:
        raise FileError(
            f"the folder holds no DICOM series, no TIFF slices and no Zarr array; name another: {request.path}"
        )
    if uid is None:
        if len(uids) > 1:
            raise FileError(
                f"the folder holds {len(uids)} series; choose one with series= (--series): "
                f"{_listed(folder, uids)}: {request.path}"
            )
        uid = uids[0]
    if uid not in uids:
        raise ArgumentError(f"no series {uid!r}; the folder holds: {_listed(folder, uids)}: {request.path}")
    slices = [_header(Path(name)) for name in reader.GetGDCMSeriesFileNames(str(folder), uid)]
    slices = list({one.instance_uid or str(one.file): one for one in slices}.values())
    if len(slices) == 1 and slices[0].n_frames > 1:
        return _read_files([slices[0].file], request, None)
    _check_alike(slices, request)
    if not all(np.isfinite([*one.position, *one.orientation]).all() for one in slices):
        # Nothing to sort or place by: the order and geometry that GDCM found.
        return _read_files([one.file for one in slices], request, None)
    slices = _one_time_point(_sorted(slices), request)
    if len(slices) == 1:
        raise FileError(
            f"the series has a single slice, which is 2-D; add the other slices of the series: {request.path}"
        )
    return _read_files([one.file for one in slices], request, _world_from_index(slices, request))


def _header(file: Path) -> Slice:
    reader = simple_itk().ImageFileReader()
    reader.SetFileName(str(file))
    reader.ReadImageInformation()

    def numbers(tag: str, count: int) -> NDArray[np.float64]:
        text = reader.GetMetaData(tag) if reader.HasMetaDataKey(tag) else ""
        parts = [float(part) for part in text.split("\\") if part.strip()]
        return np.array(parts if len(parts) == count else [np.nan] * count)

    def text(tag: str) -> str:
        return str(reader.GetMetaData(tag)).strip() if reader.HasMetaDataKey(tag) else ""

    spacing = numbers("0028|0030", 2)
    return Slice(
        file=file,
        instance_uid=text("0008|0018"),
        number=int(text("0020|0013") or 0),
        n_frames=int(text("0028|0008") or 1),
        position=numbers("0020|0032", 3),
        orientation=numbers("0020|0037", 6),
        pixel_spacing=(float(spacing[0]), float(spacing[1])) if np.isfinite(spacing).all() else (1.0, 1.0),
        size=(int(reader.GetSize()[0]), int(reader.GetSize()[1])),
    )


def _series_uid(file: Path) -> str:
    reader = simple_itk().ImageFileReader()
    reader.SetFileName(str(file))
    reader.ReadImageInformation()
    return str(reader.GetMetaData("0020|000e")).strip()


def _listed(folder: Path, uids: Sequence[str]) -> str:
    names = simple_itk().ImageSeriesReader.GetGDCMSeriesFileNames
    return ", ".join(f"{uid} ({len(names(str(folder), uid))} files)" for uid in uids)


def _check_alike(slices: Sequence[Slice], request: Request) -> None:
    for one in slices[1:]:
        if one.size != slices[0].size:
            raise FileError(
                f"slices differ in size: {slices[0].file.name} has {slices[0].size} pixels, "
                f"{one.file.name} has {one.size}; "
                f"move one kind to another folder: {request.path}"
            )
        if not np.allclose(one.orientation, slices[0].orientation, atol=1e-3, equal_nan=True):
            raise FileError(
                f"slices are not parallel: {slices[0].file.name} and {one.file.name} (a scout or a radial series?); "
                f"move one kind to another folder: {request.path}"
            )


def _sorted(slices: Sequence[Slice]) -> list[Slice]:
    """In order along the normal of the slices, then of acquisition."""
    first = slices[0].orientation
    normal = np.cross(first[:3], first[3:])
    return sorted(slices, key=lambda one: (round(float(one.position @ normal), 3), one.number))


def _one_time_point(slices: list[Slice], request: Request) -> list[Slice]:
    """Slices of one time point (or echo, or phase), where every position was taken the same number of times."""
    places = Counter(tuple(np.round(one.position, 2)) for one in slices)
    repeats = set(places.values())
    if len(repeats) > 1:
        place = next(place for place, count in places.items() if count == max(repeats))
        raise FileError(
            f"{max(repeats)} slices at position {tuple(float(x) for x in place)}, {min(repeats)} at others: "
            f"a slice is missing or doubled; "
            f"move the extra files away: {request.path}"
        )
    n_times = repeats.pop()
    return slices[choose("time", n_times, request.time, request.path) :: n_times]


def _world_from_index(slices: Sequence[Slice], request: Request) -> NDArray[np.float64]:
    """World (RAS) from index, from the positions of the first and the last slice, which must be evenly spaced."""
    positions = np.array([one.position for one in slices])
    step = (positions[-1] - positions[0]) / (len(slices) - 1)
    even = positions[0] + np.arange(len(slices))[:, None] * step
    off = np.linalg.norm(positions - even, axis=1).max()
    if off > TOLERANCE * np.linalg.norm(step) and request.spacing is None:
        raise FileError(_uneven(slices, positions, request))
    first = slices[0]
    matrix = np.eye(4)
    matrix[:3, 0] = first.orientation[:3] * first.pixel_spacing[1]  # PixelSpacing is (between rows, between columns)
    matrix[:3, 1] = first.orientation[3:] * first.pixel_spacing[0]
    matrix[:3, 2] = step
    matrix[:3, 3] = positions[0]
    return affine.RAS_FROM_LPS @ matrix


def _uneven(slices: Sequence[Slice], positions: NDArray[np.float64], request: Request) -> str:
    orientation = slices[0].orientation
    distances = np.diff(positions @ np.cross(orientation[:3], orientation[3:]))
    counts = Counter(float(distance) for distance in np.round(distances, 2))
    rarest = min(counts, key=lambda distance: counts[distance])
    place = int(np.flatnonzero(np.round(distances, 2) == rarest)[0])
    listed = ", ".join(f"{distance:g} mm ({count}x)" for distance, count in counts.most_common())
    return (
        f"slices are not evenly spaced, so some are missing or two stacks are mixed: distances {listed}; "
        f"{rarest:g} mm lie between {slices[place].file.name} and {slices[place + 1].file.name}; "
        f"add the missing slices, or pass spacing=(x, y, z) to draw them as if they were even: {request.path}"
    )


def _read_files(files: Sequence[Path], request: Request, world_from_index: NDArray[np.float64] | None) -> Grid:
    sitk = simple_itk()
    if len(files) == 1:
        image = sitk.ReadImage(str(files[0]))
    else:
        size = sum(file.stat().st_size for file in files)
        payload.check_memory(size, request.path)
        reader = sitk.ImageSeriesReader()
        reader.SetFileNames([str(file) for file in files])
        image = reader.Execute()
    samples = sitk.GetArrayFromImage(image)
    channel = choose("channel", image.GetNumberOfComponentsPerPixel(), request.channel, request.path)
    if image.GetNumberOfComponentsPerPixel() > 1:
        samples = samples[..., channel]
    if world_from_index is None:
        world_from_index = affine.RAS_FROM_LPS @ affine_of(image)
    return Grid(_narrowed(samples), world_from_index)


def _narrowed(samples: NDArray[Any]) -> NDArray[Any]:
    """Back to 16 bits, or to float32, what ITK widened to apply the rescale slope; DICOM pixels have at most 16."""
    if samples.dtype == np.float64:
        return samples.astype(np.float32)
    if samples.dtype.itemsize > 2 and samples.dtype.kind in "iu":
        for dtype in (np.int16, np.uint16):
            if np.iinfo(dtype).min <= samples.min() and samples.max() <= np.iinfo(dtype).max:
                return samples.astype(dtype)
    return samples
