"""DICOM: a folder (also of folders), DICOMDIR or zip archive with series of slices, a slice, or a file of many frames.

Frames that lie nowhere in a body are pictures: a film is a series of times, and they have x to the right and y down.

`places.py` finds the files, `series.py` the series that is asked for. Headers are read by pydicom (`header.py`, with
`attributes.py`), pixels by it and SimpleITK (`pixels.py`); `volumes.py` finds the frames that belong together, and
`slice_order.py` makes slices at even distances of them, with their values. Segmentations are label maps
(`segments.py`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from operator import is_not
from pathlib import Path
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import affine
from wavesplat._model.volume.facts import COLORS, Channel, Facts, description_of, quantity_of_image_type
from wavesplat._readers.dicom import segments
from wavesplat._readers.dicom.header import Frame, Header, content_of, header_of
from wavesplat._readers.dicom.pixel_data import NATIVE, check_enough, n_bits_of
from wavesplat._readers.dicom.pixels import frames_in, is_padding_beyond_bits
from wavesplat._readers.dicom.places import files_below, files_of_directory, is_zip, unpacked
from wavesplat._readers.dicom.series import (
    Unreadable,
    alike,
    check_alike,
    check_is_volume,
    chosen_series,
    mended,
    named,
    scanned,
    without_copies,
)
from wavesplat._readers.dicom.slice_order import Stack, samples_of, single, stacked
from wavesplat._readers.dicom.suv import uptake_of
from wavesplat._readers.dicom.units import ARBITRARY
from wavesplat._readers.dicom.volumes import PLACE_MM, FrameVolume, times_of, volumes_of
from wavesplat._readers.request import (
    PLANES_ARE_TAKEN,
    Grid,
    PictureError,
    Request,
    SeveralError,
    choose,
    quiet,
    unwarned,
)
from wavesplat._storage import size_checks
from wavesplat._storage.paths import check_within
from wavesplat._storage.reading import reading
from wavesplat._system.threads import check_cancelled
from wavesplat.errors import FileError, LimitError

T = TypeVar("T")
#: Beginning of the sentences on values that are neither scaled nor looked up.
AS_STORED = "values as they are stored"


def read(request: Request) -> Grid:
    """The volume of a DICOM series."""
    request = request if request.kept is not None else replace(request, kept={})
    with reading("DICOM", request.path), quiet("pydicom"), unwarned("pydicom"):
        path = request.file
        if is_zip(path):
            with unpacked(path, request.kept) as folder:
                # The archive is what a document names, and its files lie elsewhere.
                return _read_files(files_below(folder), folder, replace(request, within=None))
        if path.is_dir():
            return _read_files(files_below(path, request.within, request.kept), path, request)
        scan = scanned([path], path.parent, request)  # which is kept from one frame of a film to the next
        first = scan.headers[0] if scan.headers else header_of(path)
        if first is None:
            files, missing = files_of_directory(path, request.within)
            if files or missing:
                return _read_files(files, path.parent, request, missing)
            content = content_of(path)
            raise FileError(f"the file is DICOM and holds {content.what}, no image; {content.instead}: {path}")
        if segments.is_segmentation(first):
            return segments.read(first, request)
        is_alone = first.pictures.is_picture and request.series is None and not first.frames[0].is_placed()
        if first.n_frames > 1 or is_alone:
            return _read_headers([first], {}, request)
        return _read_named(first, request)


def _read_segmentation(headers: Sequence[Header], request: Request) -> Grid | None:
    """The segmentation of a series; None if it is none. Each file is one, and files are not mixed."""
    if not segments.is_segmentation(headers[0]):
        return None
    if len(headers) > 1:
        raise FileError(
            f"the series holds {len(headers)} segmentations; name one of the files, such as "
            f"{headers[0].file.name}: {request.path}"
        )
    return segments.read(headers[0], request)


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
    note = ""
    if first.file in {header.file for header in headers}:
        headers, note = alike(headers, first)
        if request.series is None and request.time is None and _are_of_one_place(headers):
            headers = [first]  # of pictures of one place the one that was named
    if (labels := _read_segmentation(headers, request)) is not None:  # `series` may choose one beside the file
        return labels
    grid = _read_headers(headers, scan.unreadable, request)
    return grid if not note else grid._replace(facts=replace(grid.facts, guesses=(*grid.facts.guesses, note)))


def _are_of_one_place(headers: Sequence[Header]) -> bool:
    positions = np.array([frame.position for header in headers for frame in header.frames])
    return bool(np.isfinite(positions).all() and np.ptp(positions, axis=0).max() <= PLACE_MM)


class _Placed(NamedTuple):
    """Frames as a stack in the world, how many times there are, and when; guesses and losses about them."""

    stack: Stack
    n_times: int
    times: tuple[float, ...]
    guesses: list[str]
    losses: list[str]


def _read_headers(headers: Sequence[Header], unreadable: Unreadable, request: Request) -> Grid:
    """One volume of the frames of these files."""
    check_is_volume(headers)
    kept = {} if request.kept is None else request.kept
    all_frames, guesses, mends, processing = _once(kept, "frames", headers, lambda: _valued(headers, request))
    _once(kept, "alike", all_frames, lambda: check_alike(headers, all_frames, request))
    first = headers[0]
    _check_is_wanted(all_frames, unreadable, request)
    is_placed = _once(kept, "places", all_frames, lambda: all(frame.is_placed() for frame in all_frames))
    film = None if is_placed else _film(headers, all_frames, request)
    pixels, damaged = _pixels_for(headers, all_frames, unreadable, film, request)
    if not pixels:
        raise next(iter(damaged.values()))
    unreadable = {**unreadable, **damaged}
    losses = [f"{named(unreadable)}, and left out"] if unreadable else []
    frames = [frame for frame in all_frames if frame.file not in damaged] if damaged else all_frames
    _check_is_wanted(frames, unreadable, request)
    guesses = [*guesses, *_guesses_of_values([header for header in headers if header.file in pixels])]
    if is_placed:
        placed = _of_volumes(frames, losses, mends, headers, request)
    else:
        placed = _of_pictures(frames, film, first, request)
        placed = placed._replace(losses=[*losses, *mends])
    stack, has_sizes = placed.stack, bool(np.isfinite(first.frames[0].pixel_spacing).all())
    guesses += placed.guesses
    if not has_sizes:
        guesses.append("distances of pixels 1, 1: the file has none")
        stack = _with_pixels_of_1(stack, is_placed=is_placed)
    elif first.pictures.spacing_source:
        guesses.append(first.pictures.spacing_source)
    if not (first.is_of_patient and is_placed):
        stack = replace(stack, world_from_index=affine.RAS_FROM_LPS @ stack.world_from_index)
    of_pixels = request if film is None else replace(request, channel=None)  # which has been chosen
    samples, note = samples_of(stack, pixels, {header.file: header for header in headers}, of_pixels)
    guesses += [note] if note else []
    colors = _colors_of(first)
    is_picture = len(stack.frames) == 1 and not colors
    facts = Facts(
        unit="mm" if has_sizes else None,
        is_anatomical=first.is_of_patient and is_placed,
        modality=first.modality,
        value_unit="SUV" if request.suv else _value_unit(headers, [*guesses, *mends]),
        quantity=quantity_of_image_type(first.image_type),
        description=description_of(first.drug, first.description),
        processing=processing,
        window=first.pictures.window if is_picture and not request.suv else None,
        is_inverted=first.pictures.is_inverted and is_picture,
        channels=colors,
        channel=colors[request.channel or 0] if colors else None,
        n_times=placed.n_times,
        times=placed.times,
        time_unit="s" if placed.times else None,
        guesses=tuple(guesses),
    )
    return Grid(samples, stack.world_from_index, facts, (*placed.losses, *stack.losses))


def _colors_of(header: Header) -> tuple[Channel, ...]:
    """Red, green and blue as channels, with their range if it is not the range of their type; empty for greys."""
    if header.n_colors != 3:
        return ()
    is_whole = header.photometric == "PALETTE COLOR" or header.bits_stored == header.bits_allocated
    window = None if is_whole else (0.0, float((1 << header.bits_stored) - 1))
    return tuple(replace(color, window=window) for color in COLORS[:3])


def _check_is_wanted(frames: Sequence[Frame], unreadable: Unreadable, request: Request) -> None:
    """Raise a `PictureError` for a single frame that is what damaged files left of a volume."""
    if len(frames) == 1 and unreadable and not PLANES_ARE_TAKEN.get():
        raise PictureError(
            "the series has a single slice, which is 2-D; add the other slices of the series "
            f"({named(unreadable)}): {request.path}"
        )


def _pixels_for(
    headers: Sequence[Header],
    frames: Sequence[Frame],
    unreadable: Unreadable,
    film: Sequence[float] | None,
    request: Request,
) -> tuple[dict[Path, NDArray[Any]], Unreadable]:
    """Stored numbers of the files that are needed, and those that cannot be read."""
    kept = {} if request.kept is None else request.kept
    if film is not None:
        choose("time", len(frames), request.time, request.path)
        return _once(kept, "film", headers, lambda: _pixels_of_film(headers[0], request))
    wanted = {header.file for header in headers}
    if not unreadable and all(frame.is_placed() for frame in frames):  # files of other volumes need not be read
        wanted = {frame.file for frame in _chosen(frames, (), request, kept)[0].frames}
    pixels, damaged = _pixels([header for header in headers if header.file in wanted], request)
    if pixels and damaged:  # with files missing, the remaining ones decide which frames belong together
        pixels, damaged = _pixels(headers, request, {**pixels, **damaged})
    return pixels, damaged


def _of_volumes(
    frames: Sequence[Frame],
    losses: Sequence[str],
    mends: Sequence[str],
    headers: Sequence[Header],
    request: Request,
) -> _Placed:
    """The volume that is asked for, of frames that lie in a body."""
    kept = {} if request.kept is None else request.kept
    volume, n_times, times = _chosen(frames, losses, request, kept)
    first, is_one = headers[0], len(volume.frames) == 1
    stack = single(volume.frames[0], first.slice_step) if is_one else stacked(volume.frames, request)
    own_guesses: list[str] = []
    lost = [*losses, *mends, *([volume.loss] if volume.loss else [])]
    if volume.guess:
        (lost if volume.is_by_names else own_guesses).append(volume.guess)
    if n_times > 1 and not times and len(first.pictures.times) == n_times:
        times = first.pictures.times
    return _Placed(stack, n_times, times, own_guesses, lost)


def _of_pictures(frames: Sequence[Frame], film: tuple[float, ...] | None, first: Header, request: Request) -> _Placed:
    """The frame of a film that is asked for, or all frames as slices, where the file does not say where they lie."""
    if film is not None:
        stack = _as_they_come([frames[request.time or 0]], first)
        return _Placed(stack, len(frames), film if any(film) else (), [_way_of(stack)], [])
    choose("time", 1, request.time, request.path)
    stack = _as_they_come(frames, first)
    return _Placed(stack, 1, (), [_way_of(stack)], [])


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
    return scaled, [*guesses, *uptake.guesses], mends, (uptake.description,)


def _value_unit(headers: Sequence[Header], guesses: Sequence[str]) -> str | None:
    """The unit of the values; None where files differ in it, or `guesses` says that values are as they are stored."""
    found = {header.value_unit.name for header in headers}
    is_stored = any(one.startswith(AS_STORED) for one in guesses)
    if found == {ARBITRARY} and quantity_of_image_type(headers[0].image_type) is not None:
        return None  # of scans, and a map has a scale
    return found.pop() if len(found) == 1 and not is_stored and headers[0].n_colors == 1 else None


def _guesses_of_values(headers: Sequence[Header]) -> list[str]:
    """Assumptions about the stored numbers of these files, a sentence each."""
    notes = (one for header in headers for one in (header.value_unit.note, header.guess) if one)
    guesses = list(dict.fromkeys(notes))
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
        are_pictures = all(len(volume.frames) == 1 for volume in volumes)
        labels = [volume.label for volume in volumes]
        number = choose("time", len(volumes), request.time, request.path, described=labels)
        volume = volumes[number]
        if len(volume.frames) == 1 and not are_pictures:
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
    return header.size[0] * header.size[1] * header.n_frames * header.n_colors * max(header.bits_allocated // 8, 1)


def _is_longer(header: Header) -> bool:
    """Whether uncompressed pixels are followed by more than the byte that makes their number even."""
    header = header.whole or header
    data = header.pixel_data
    if data is None or header.transfer_syntax not in NATIVE:
        return False
    return data.n_bytes > check_enough(header, data.n_bytes, n_bits_of(data.tag, header)) + 1


def _film(headers: Sequence[Header], frames: Sequence[Frame], request: Request) -> tuple[float, ...] | None:
    """Times of the frames of a film in seconds, all 0 if unknown; None if the frames are not a film."""
    first = headers[0]
    if all(header.n_frames == 1 for header in headers):
        return None
    times = first.pictures.times or times_of([FrameVolume([frame], is_time=True) for frame in frames])
    if not (times or first.pictures.is_film):
        return None
    if len(headers) > 1:
        raise FileError(
            f"the series holds {len(headers)} files with films or pictures, which are no slices of a volume; name one "
            f"of the files, such as {first.file.name}: {request.path}"
        )
    return times if len(times) == len(frames) else (0.0,) * len(frames)


def _pixels_of_film(header: Header, request: Request) -> tuple[dict[Path, NDArray[Any]], Unreadable]:
    """Stored numbers of all frames of a film, of the channel that is asked for alone: they are kept for all times."""
    channel = choose("channel", header.n_colors, request.channel, request.path)
    pixels, damaged = _pixels([header], request)
    return {file: one[..., channel].copy() if one.ndim == 4 else one for file, one in pixels.items()}, damaged


def _way_of(stack: Stack) -> str:
    """The guess about frames that lie nowhere in a body."""
    way = "with x to the right and y down, as pixels come: the file does not say where"
    if len(stack.frames) == 1:
        return f"the picture {way} it lies"
    return f"frames as slices, {_distances(stack)} apart, {way} they lie"


def _as_they_come(frames: Sequence[Frame], header: Header) -> Stack:
    """A stack of frames without positions: by number, along z."""
    ordered = sorted(frames, key=lambda frame: (frame.instance, frame.file.name, frame.index))
    row, column = map(abs, ordered[0].pixel_spacing)
    if not np.isfinite((row, column)).all():
        row, column = (side / min(header.pictures.aspect) for side in header.pictures.aspect)
    step = abs(header.slice_step) if np.isfinite(header.slice_step) else column
    slices = [(n, n, 0.0) for n in range(len(ordered))]
    # All but what lies in a patient is turned from LPS at the end.
    return Stack(ordered, slices, affine.RAS_FROM_LPS @ np.diag([column, row, step, 1.0]))


def _distances(stack: Stack) -> str:
    unit = " mm" if np.isfinite(stack.frames[0].pixel_spacing).all() else ""
    return f"{affine.spacing_of(stack.world_from_index)[2]:.4g}{unit}"


def _with_pixels_of_1(stack: Stack, *, is_placed: bool) -> Stack:
    matrix = np.where(np.isfinite(stack.world_from_index), stack.world_from_index, 0.0)
    if is_placed:
        matrix[:3, :2] = affine.RAS_FROM_LPS[:3, :3] @ stack.frames[0].orientation.reshape(2, 3).T
    return replace(stack, world_from_index=matrix)
