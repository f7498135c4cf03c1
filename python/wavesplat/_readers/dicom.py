"""DICOM: a folder (also of folders), DICOMDIR or zip archive with series of slices, a slice, or a file of many frames.

`dicom_places` finds the files, `dicom_series` the series that is asked for. Headers are read by pydicom
(`dicom_header`, with `dicom_attributes`), pixels by it and SimpleITK (`dicom_pixels`);
`dicom_checks` finds impossible values, `dicom_volumes` the frames that belong together, `dicom_stack` makes slices at
even distances of them, and `dicom_samples` values. Segmentations are label maps (`dicom_segments`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from operator import is_not
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import size_checks
from wavesplat._files.cancelling import check_cancelled
from wavesplat._files.named_files import check_within
from wavesplat._files.reading import reading
from wavesplat._model import affine
from wavesplat._model.facts import COLORS, Facts
from wavesplat._model.quantities import quantity_of_image_type
from wavesplat._readers import dicom_segments
from wavesplat._readers.dicom_checks import check_alike, check_is_volume, mended
from wavesplat._readers.dicom_header import Frame, Header, content_of, header_of
from wavesplat._readers.dicom_pixel_data import NATIVE, check_enough, n_bits_of
from wavesplat._readers.dicom_pixels import frames_in, is_padding_beyond_bits
from wavesplat._readers.dicom_places import files_below, files_of_directory, is_zip, unpacked
from wavesplat._readers.dicom_samples import samples_of
from wavesplat._readers.dicom_series import (
    Unreadable,
    alike,
    chosen_series,
    named,
    scanned,
    without_copies,
)
from wavesplat._readers.dicom_stack import Stack, stacked
from wavesplat._readers.dicom_suv import uptake_of
from wavesplat._readers.dicom_units import ARBITRARY
from wavesplat._readers.dicom_volumes import FrameVolume, times_of, volumes_of
from wavesplat._readers.request import Grid, Request, SeveralError, choose, quiet, unwarned
from wavesplat.errors import FileError, LimitError

__all__ = ["read"]

T = TypeVar("T")
#: Beginning of the sentences on values that are neither scaled nor looked up.
AS_STORED = "values as they are stored"


def read(request: Request) -> Grid:
    """The volume of a DICOM series."""
    with reading("DICOM", request.path), quiet("pydicom"), unwarned("pydicom"):
        path = request.file
        if is_zip(path):
            with unpacked(path, request.kept) as folder:
                # The archive is what a document names, and its files lie elsewhere.
                return _read_files(files_below(folder), folder, replace(request, within=None))
        if path.is_dir():
            return _read_files(files_below(path, request.within, request.kept), path, request)
        first = header_of(path)
        if first is None:
            files, missing = files_of_directory(path, request.within)
            if files or missing:
                return _read_files(files, path.parent, request, missing)
            content = content_of(path)
            raise FileError(f"the file is DICOM and holds {content.what}, no image; {content.instead}: {path}")
        if dicom_segments.is_segmentation(first):
            return dicom_segments.read(first, request)
        if first.n_frames > 1:
            return _read_headers([first], {}, request)
        return _read_named(first, request)


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


def _read_files(files: Sequence[Path], root: Path, request: Request, missing: Sequence[Path] = ()) -> Grid:
    """A volume of the series that is asked for, of these files.

    root : the folder that messages name files from. missing : files that a directory names in vain.
    """
    scan = scanned(files, root, request)
    scan.unreadable |= {file: FileNotFoundError(f"no such file: {file}") for file in missing}
    found = chosen_series(scan, request)
    headers = _once({} if request.kept is None else request.kept, "copies", found, lambda: without_copies(found, None))
    unreadable: Unreadable = scan.unreadable
    if unreadable:  # files in folders of other series are no slices of this one
        folders = {header.file.parent for header in headers}
        unreadable = {file: error for file, error in unreadable.items() if file.parent in folders}
    return _read_segmentation(headers, request) or _read_headers(headers, unreadable, request)


def _read_named(first: Header, request: Request) -> Grid:
    """A volume of the file that was named and of the slices beside it; files that are none are left out."""
    beside = [file for file in sorted(first.file.parent.iterdir()) if file.is_file()]
    for file in beside:
        check_within(file, request.within)
    scan = scanned(beside, first.file.parent, request, first)
    headers = without_copies(chosen_series(scan, request, first), first.file)
    told = ""
    if first.file in {header.file for header in headers}:
        headers, told = alike(headers, first)
    if (labels := _read_segmentation(headers, request)) is not None:  # `series` may choose one beside the file
        return labels
    grid = _read_headers(headers, scan.unreadable, request)
    return grid if not told else grid._replace(facts=replace(grid.facts, guesses=(*grid.facts.guesses, told)))


def _read_headers(headers: Sequence[Header], unreadable: Unreadable, request: Request) -> Grid:
    """One volume of the frames of these files."""
    check_is_volume(headers)
    kept = {} if request.kept is None else request.kept
    all_frames, said_guesses, mends, processing = _once(kept, "frames", headers, lambda: _valued(headers, request))
    guesses = list(said_guesses)
    _once(kept, "alike", all_frames, lambda: check_alike(headers, all_frames, request))
    if sum(header.n_frames for header in headers) == 1:
        raise FileError(_single(unreadable, request))
    first = headers[0]
    is_placed = _once(kept, "places", all_frames, lambda: all(frame.is_placed() for frame in all_frames))
    wanted = {header.file for header in headers}
    if is_placed and not unreadable:  # files of other volumes need not be read
        wanted = {frame.file for frame in _chosen(all_frames, (), request, kept)[0].frames}
    pixels, damaged = _pixels([header for header in headers if header.file in wanted], request)
    if not pixels:
        raise next(iter(damaged.values()))
    if damaged:  # where files are missing, all that there are decide which frames belong together
        pixels, damaged = _pixels(headers, request, {**pixels, **damaged})
    unreadable = {**unreadable, **damaged}
    losses = [f"{named(unreadable)}, and left out"] if unreadable else []
    frames = [frame for frame in all_frames if frame.file not in damaged] if damaged else all_frames
    if len(frames) == 1:
        raise FileError(_single(unreadable, request))
    guesses += _guesses_of_values([header for header in headers if header.file in pixels])
    if is_placed:
        volume, n_times, times = _chosen(frames, losses, request, kept)
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
        value_unit="SUV" if request.suv else _value_unit(headers, [*guesses, *mends]),
        quantity=quantity_of_image_type(first.image_type),
        processing=processing,
        channels=colors,
        channel=colors[request.channel or 0] if colors else None,
        n_times=n_times,
        times=times,
        time_unit="s" if times else None,
        guesses=tuple(guesses),
    )
    return Grid(samples, stack.world_from_index, facts, (*losses, *stack.losses))


def _valued(headers: Sequence[Header], request: Request) -> tuple[list[Frame], list[str], list[str], tuple[str, ...]]:
    """The frames with slopes and intercepts to the values that are asked for, guesses, warnings, and processing."""
    frames, guesses, mends = mended(headers, request)
    if not request.suv:
        return frames, guesses, mends, ()
    uptake = uptake_of([header.tracer for header in headers], request.path)
    if mends:
        raise FileError(f"suv: {mends[0]}: {request.path}")
    scale = uptake.factor
    scaled = [replace(frame, slope=frame.slope * scale, intercept=frame.intercept * scale) for frame in frames]
    return scaled, [*guesses, *uptake.guesses], mends, (uptake.told,)


def _value_unit(headers: Sequence[Header], told: Sequence[str]) -> str | None:
    """The unit of the values; None where files differ in it, or `told` says that values are as they are stored."""
    found = {header.value_unit.name for header in headers}
    is_stored = any(one.startswith(AS_STORED) for one in told)
    if found == {ARBITRARY} and quantity_of_image_type(headers[0].image_type) is not None:
        return None  # of scans, and a map has a scale
    return found.pop() if len(found) == 1 and not is_stored and headers[0].n_samples == 1 else None


def _guesses_of_values(headers: Sequence[Header]) -> list[str]:
    """Assumptions about the stored numbers of these files, a sentence each."""
    guesses = list(dict.fromkeys(header.value_unit.told for header in headers if header.value_unit.told))
    names = sorted({header.value_unit.name or "none" for header in headers})
    if len(names) > 1:
        guesses.append(f"values of several units as if of one: files of the series name {', '.join(names)}")
    n_longer = sum(_is_longer(header) for header in headers)
    if n_longer:
        guesses.append(
            f"pixels of {n_longer} of the files from the beginning of longer pixel data: the rest is left out"
        )
    if any(is_padding_beyond_bits(header) for header in headers):
        guesses.append("padding (PixelPaddingValue), for which there are too few stored bits, as the lowest of them")
    if any(header.has_lookup_table for header in headers):
        guesses.append(f"{AS_STORED}: the table for them (Modality LUT) is not applied")
    return guesses


def _once(kept: dict[str, Any], name: str, things: Sequence[Any], made: Callable[[], T]) -> T:
    """Result of `made` for these headers or frames; kept from one time point to the next while they are the same."""
    before = kept.get(f"{name} of DICOM")
    if before is None or len(before[0]) != len(things) or any(map(is_not, before[0], things)):
        before = kept[f"{name} of DICOM"] = (things, made())
    return cast(T, before[1])


def _chosen(
    frames: Sequence[Frame],
    losses: Sequence[str],
    request: Request,
    kept: dict[str, Any],
) -> tuple[FrameVolume, int, tuple[float, ...]]:
    """The volume that is asked for, the number of volumes, and their times; errors name `losses`, a likely cause."""
    try:
        volumes = _once(kept, "volumes", frames, lambda: volumes_of(frames, request))
        if all(len(volume.frames) == 1 for volume in volumes):
            raise FileError(
                f"the frames lie at one place, and are pictures of it, no volume; name a series of slices: "
                f"{request.path}"
            )
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
    return volume, len(volumes), _once(kept, "times", volumes, lambda: times_of(volumes))


def _single(unreadable: Unreadable, request: Request) -> str:
    others = f" ({named(unreadable)})" if unreadable else ""
    return f"the series has a single slice, which is 2-D; add the other slices of the series{others}: {request.path}"


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
    check_cancelled()
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
    header = header.whole or header
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
