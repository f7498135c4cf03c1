"""DICOM: a folder with a series of slices, one of its files, or a file of many frames.

Headers are read by pydicom (`dicom_header`, with `dicom_attributes`), pixels by it and SimpleITK (`dicom_pixels`);
`dicom_checks` finds impossible values, `dicom_volumes` the frames that belong together, `dicom_stack` makes slices at
even distances of them, and `dicom_samples` values. Segmentations are label maps (`dicom_segments`).
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import size_checks
from wavesplat._files.named_files import check_within
from wavesplat._files.reading import reading
from wavesplat._model import affine
from wavesplat._model.facts import Facts
from wavesplat._readers import dicom_segments
from wavesplat._readers.dicom_checks import check_alike, check_is_volume, mended
from wavesplat._readers.dicom_header import Frame, Header, content_of, header_of, is_dicom
from wavesplat._readers.dicom_pixel_data import NATIVE, check_enough, n_bits_of
from wavesplat._readers.dicom_pixels import frames_in, is_padding_beyond_bits
from wavesplat._readers.dicom_samples import samples_of
from wavesplat._readers.dicom_stack import N_NAMED, Stack, stacked
from wavesplat._readers.dicom_volumes import FrameVolume, times_of, volumes_of
from wavesplat._readers.request import COLORS, Grid, Request, SeveralError, choose, quiet, several, unwarned
from wavesplat.errors import ArgumentError, FileError, LimitError

__all__ = ["read"]

#: Files that cannot be read, and why.
Unreadable: TypeAlias = Mapping[Path, Exception]
SUFFIXES = (".dcm", ".ima", ".dicom")
#: The word by which Siemens marks slices side by side in one picture, in the image type.
MOSAIC = "MOSAIC"


def read(request: Request) -> Grid:
    """The volume of a DICOM series."""
    with reading("DICOM", request.path), quiet("pydicom"), unwarned("pydicom"):
        path = request.file
        if path.is_dir():
            return _read_series(path, request.series, request)
        first = header_of(path)
        if first is None:
            content = content_of(path)
            raise FileError(f"the file is DICOM and holds {content.what}, no image; {content.instead}: {path}")
        if dicom_segments.is_segmentation(first):
            return dicom_segments.read(first, request)
        if first.n_frames > 1:
            return _read_headers([first], {}, request)
        return _read_series(path.parent, request.series or first.series, request, named=first)


def _read_series(folder: Path, uid: str | None, request: Request, named: Header | None = None) -> Grid:
    headers, unreadable, others = _scanned(folder, request, named)
    series: dict[str, list[Header]] = {}
    for header in headers:
        series.setdefault(header.series, []).append(header)
    if not series and unreadable:
        first = next(iter(unreadable.values()))
        if isinstance(first, FileError):  # which says more
            raise first
        raise FileError(f"{_named(unreadable)}; copy or export them again: {request.path}") from first
    if not series and others:
        raise FileError(
            f"the folder holds DICOM files without images ({others[0].name} holds {content_of(others[0]).what}); "
            f"{content_of(others[0]).instead}: {request.path}"
        )
    if not series:
        raise FileError(
            f"the folder holds no DICOM series, no TIFF slices and no Zarr array; name another: {request.path}"
        )
    if uid is None and len(series) > 1:
        message = (
            f"the folder holds {len(series)} series; choose one with series= (--series): "
            f"{_listed(series)}: {request.path}"
        )
        described = [f"{uid} {found[0].description} ({len(found)} files)" for uid, found in series.items()]
        raise several(message, "series", list(series), described)
    uid = next(iter(series)) if uid is None else uid
    if uid not in series:
        raise ArgumentError(f"no series {uid!r}; the folder holds: {_listed(series)}: {request.path}")
    found = _without_copies(series[uid], named.file if named else None)
    return _read_segmentation(found, request) or _read_headers(found, unreadable, request)


def _read_segmentation(headers: Sequence[Header], request: Request) -> Grid | None:
    """The segmentation of a series; None if it is none. Each file is one, and files are not mixed."""
    if not dicom_segments.is_segmentation(headers[0]):
        return None
    if len(headers) > 1:
        raise FileError(
            f"the series holds {len(headers)} segmentations; name one of the files, such as "
            f"{headers[0].file.name}: {request.path}"
        )
    return dicom_segments.read(headers[0], request)


def _without_copies(headers: Sequence[Header], named: Path | None) -> list[Header]:
    """One file of each group of copies, the one that was named if it is among them.

    Some programs give all files one UID, so a file with another position or other attributes is no copy.
    """
    first: dict[Hashable, Header] = {}
    for header in headers:
        frame = header.frames[0]
        said = (frame.instance, frame.position.tobytes(), tuple(sorted(frame.attributes.items())))
        key = (header.instance_uid, said) if header.instance_uid else header.file
        if key not in first or header.file == named:
            first[key] = header
    return list(first.values())


def _scanned(folder: Path, request: Request, named: Header | None) -> tuple[list[Header], Unreadable, list[Path]]:
    """Headers of all images in a folder, image files that cannot be read, and DICOM files that are no images.

    Headers are kept from one time point of a series to the next, as long as their files stay as they are. `named`: the
    header of the file that was named, which has been read.
    """
    headers, unreadable, others = [], {}, []
    kept = {} if request.kept is None else request.kept.setdefault("headers of DICOM", {})
    for file in sorted(entry for entry in folder.iterdir() if entry.is_file()):
        check_within(file, request.within)
        looks_like = file.suffix.lower() in SUFFIXES
        state = file.stat()
        key = (file, state.st_mtime_ns, state.st_size)
        header = named if named is not None and file == named.file else kept.get(key)
        if header is None and (looks_like or _is_dicom(file)):
            header = _scanned_file(file)
            kept[key] = header
            if header is None:
                others.append(file)
        if isinstance(header, Header):
            headers.append(header)
        elif header is not None:
            unreadable[file] = header
    return headers, unreadable, others


def _scanned_file(file: Path) -> Header | Exception | None:
    # Parsers of damaged files raise nearly anything.
    try:
        return header_of(file)
    except (ImportError, LimitError):
        raise
    except Exception as error:  # noqa: BLE001
        return error


def _is_dicom(file: Path) -> bool:
    try:
        return is_dicom(file)
    except OSError:
        return False


def _listed(series: dict[str, list[Header]]) -> str:
    return ", ".join(f"{uid} ({len(headers)} files)" for uid, headers in series.items())


def _named(unreadable: Unreadable) -> str:
    files = list(unreadable)
    names = ", ".join(file.name for file in files[:N_NAMED]) + (", ..." if len(files) > N_NAMED else "")
    what = "1 file of the folder is" if len(files) == 1 else f"{len(files)} files of the folder are"
    return f"{what} damaged and cannot be read ({names})"


def _read_headers(headers: Sequence[Header], unreadable: Unreadable, request: Request) -> Grid:
    """One volume of the frames of these files."""
    check_is_volume(headers)
    all_frames, guesses, mends = mended(headers, request)
    check_alike(headers, all_frames, request)
    if sum(header.n_frames for header in headers) == 1:
        raise FileError(_single(headers[0], unreadable, request))
    first = headers[0]
    is_placed = all(frame.is_placed() for frame in all_frames)
    wanted = {header.file for header in headers}
    if is_placed and not unreadable:  # files of other volumes need not be read
        wanted = {frame.file for frame in _chosen(all_frames, (), headers, request)[0].frames}
    pixels, damaged = _pixels([header for header in headers if header.file in wanted], request)
    if not pixels:
        raise next(iter(damaged.values()))
    if damaged:  # where files are missing, all that there are decide which frames belong together
        pixels, damaged = _pixels(headers, request, {**pixels, **damaged})
    unreadable = {**unreadable, **damaged}
    losses = [f"{_named(unreadable)}, and left out"] if unreadable else []
    frames = [frame for frame in all_frames if frame.file not in damaged]
    if len(frames) == 1:
        raise FileError(_single(headers[0], unreadable, request))
    guesses += _guesses_of_values([header for header in headers if header.file in pixels])
    if is_placed:
        volume, n_times, times = _chosen(frames, losses, headers, request)
        stack = stacked(volume.frames, request)
        losses += [*mends, *([volume.loss] if volume.loss else [])]
        if volume.guess:
            (losses if volume.is_by_names else guesses).append(volume.guess)
    else:
        choose("time", 1, request.time, request.path)
        n_times, times = 1, ()
        losses += mends
        stack = _as_they_come(frames, first)
        guesses.append(f"frames as slices, {_distances(stack)} mm apart: the file does not say where they lie")
    if not np.isfinite(first.frames[0].pixel_spacing).all():
        guesses.append("distances of pixels 1, 1: the file has none")
        stack = _with_pixels_of_1(stack)
    samples, told = samples_of(stack, pixels, {header.file: header for header in headers}, request)
    guesses += [told] if told else []
    colors = COLORS[:3] if first.n_samples == 3 else ()
    facts = Facts(
        unit="mm" if np.isfinite(first.frames[0].pixel_spacing).all() else None,
        is_anatomical=first.is_of_patient and is_placed,
        modality=first.modality,
        channels=colors,
        channel=colors[request.channel or 0] if colors else None,
        n_times=n_times,
        times=times,
        time_unit="s" if times else None,
        guesses=tuple(guesses),
    )
    return Grid(samples, stack.world_from_index, facts, (*losses, *stack.losses))


def _guesses_of_values(headers: Sequence[Header]) -> list[str]:
    """Assumptions about the stored numbers of these files, a sentence each."""
    guesses = []
    n_longer = sum(_is_longer(header) for header in headers)
    if n_longer:
        guesses.append(
            f"pixels of {n_longer} of the files from the beginning of longer pixel data: the rest is left out"
        )
    if any(is_padding_beyond_bits(header) for header in headers):
        guesses.append("padding (PixelPaddingValue), for which there are too few stored bits, as the lowest of them")
    if any(header.has_lookup_table for header in headers):
        guesses.append("values as they are stored: the table for them (Modality LUT) is not applied")
    return guesses


def _chosen(
    frames: Sequence[Frame], losses: Sequence[str], headers: Sequence[Header], request: Request
) -> tuple[FrameVolume, int, tuple[float, ...]]:
    """The volume that is asked for, the number of volumes, and their times; errors name `losses`, a likely cause."""
    try:
        volumes = volumes_of(frames, request)
        if all(len(volume.frames) == 1 for volume in volumes):
            raise FileError(_at_one_place(headers[0], request))
        labels = [volume.label for volume in volumes]
        number = choose("time", len(volumes), request.time, request.path, described=labels)
        volume = volumes[number]
        if len(volume.frames) == 1:
            raise FileError(
                f"volume {number} of the series ({volume.label}) has a single slice, others have more; "
                f"choose another with time= (--time): {request.path}"
            )
        if volume.loss and request.gaps == "refuse":
            raise FileError(f"{volume.loss}; add the missing slices: {request.path}")
    except FileError as error:
        if not losses or isinstance(error, SeveralError):
            raise
        raise FileError(f"{losses[0]}; then {error}") from None
    return volume, len(volumes), times_of(volumes)


def _single(header: Header, unreadable: Unreadable, request: Request) -> str:
    if MOSAIC in header.image_type:
        return _mosaic(request)
    others = f" ({_named(unreadable)})" if unreadable else ""
    return f"the series has a single slice, which is 2-D; add the other slices of the series{others}: {request.path}"


def _at_one_place(header: Header, request: Request) -> str:
    if MOSAIC in header.image_type:
        return _mosaic(request)
    return f"the frames lie at one place, and are pictures of it, no volume; name a series of slices: {request.path}"


def _mosaic(request: Request) -> str:
    return (
        "each file holds a mosaic (Siemens): the slices of a volume side by side in one picture; "
        f"convert the series to NIfTI first, such as by dcm2niix: {request.path}"
    )


def _pixels(
    headers: Sequence[Header], request: Request, known: Mapping[Path, NDArray[Any] | Exception] | None = None
) -> tuple[dict[Path, NDArray[Any]], Unreadable]:
    """Stored numbers of all frames by file, and the files whose pixels cannot be read. `known`: read before."""
    size_checks.check_memory(sum(_n_bytes(header) for header in headers), request.path)
    known = known or {}
    found = {header.file: known[header.file] if header.file in known else _pixels_of(header) for header in headers}
    pixels = {file: one for file, one in found.items() if not isinstance(one, Exception)}
    return pixels, {file: one for file, one in found.items() if isinstance(one, Exception)}


def _pixels_of(header: Header) -> NDArray[Any] | Exception:
    try:
        return frames_in(header)
    except (ImportError, LimitError):
        raise
    except Exception as error:  # noqa: BLE001 - as above
        return error


def _n_bytes(header: Header) -> int:
    return header.size[0] * header.size[1] * header.n_frames * header.n_samples * max(header.bits_allocated // 8, 1)


def _is_longer(header: Header) -> bool:
    """Whether uncompressed pixels are followed by more than the byte that makes their number even."""
    data = header.pixel_data
    if data is None or header.transfer_syntax not in NATIVE:
        return False
    return data.n_bytes > check_enough(header, data.n_bytes, n_bits_of(data.tag, header)) + 1


def _as_they_come(frames: Sequence[Frame], header: Header) -> Stack:
    """A stack of frames without positions: by number, along z."""
    ordered = sorted(frames, key=lambda frame: (frame.instance, frame.file.name, frame.index))
    row, column = (abs(step) if np.isfinite(step) else 1.0 for step in ordered[0].pixel_spacing)
    step = abs(header.slice_step) if np.isfinite(header.slice_step) else column
    slices = [(n, n, 0.0) for n in range(len(ordered))]
    return Stack(ordered, slices, affine.RAS_FROM_LPS @ np.diag([column, row, step, 1.0]))


def _distances(stack: Stack) -> str:
    return f"{affine.spacing_of(stack.world_from_index)[2]:.4g}"


def _with_pixels_of_1(stack: Stack) -> Stack:
    matrix = np.where(np.isfinite(stack.world_from_index), stack.world_from_index, 0.0)
    orientation = stack.frames[0].orientation
    if np.isfinite(orientation).all():
        matrix[:3, :2] = affine.RAS_FROM_LPS[:3, :3] @ orientation.reshape(2, 3).T
    return Stack(stack.frames, stack.slices, matrix, stack.losses)
