"""DICOM series of a place: headers of its files, checked for impossible values, and the series that is read.

A series is chosen by its number (SeriesNumber), its description, its modality, or the start of its UID, as `wavesplat
info` lists them.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeAlias

import numpy as np

from wavesplat._readers.dicom.header import Frame, Header, content_of, header_of, is_dicom
from wavesplat._readers.dicom.mosaic import unsplit_note
from wavesplat._readers.dicom.places import SUFFIXES, is_zip
from wavesplat._readers.dicom.slice_order import N_NAMED
from wavesplat._readers.request import Request, several
from wavesplat._readers.unsupported_formats import foreign_folder
from wavesplat._system.threads import check_cancelled
from wavesplat.errors import ArgumentError, FileError, LimitError

# Impossible values in DICOM headers: refused with the file's name, or replaced and reported.

#: Tolerances of directions: from unit length and between frames; and the cosine of the angle between them.
DIRECTION, RIGHT_ANGLE = 1e-3, 1e-2
WHOLE_SLIDE = "1.2.840.10008.5.1.4.1.1.77.1.6"


def check_is_volume(headers: Sequence[Header]) -> None:
    """Raise a `FileError` if frames are tiles of a picture, or pictures of several slices, and no slices."""
    for header in headers:
        if header.n_frames == 1 and header.tiles is None and (found := unsplit_note(header.image_type)):
            raise FileError(f"{found}: {header.file}")
        if header.sop_class == WHOLE_SLIDE or header.modality == "SM":
            raise FileError(
                f"the file holds tiles of a slide (whole-slide microscopy), and no volume; open it with a viewer of "
                f"slides: {header.file}"
            )


def check_alike(headers: Sequence[Header], frames: Sequence[Frame], request: Request) -> None:
    """Raise a `FileError` if slices differ in size, direction or distance of pixels."""
    first = headers[0]
    for one in headers[1:]:
        if (one.size, one.n_samples) != (first.size, first.n_samples):
            raise FileError(
                f"slices differ in size: {first.file.name} has {first.size} pixels, "
                f"{one.file.name} has {one.size}; {_name_one(frames, request)}: {request.path}"
            )
    of_stack: dict[str, list[Frame]] = {}
    for frame in frames:
        of_stack.setdefault(frame.stack, []).append(frame)
    for name, stack in of_stack.items():
        _check_stack(stack, request, may_turn=name != "")


def _check_stack(frames: Sequence[Frame], request: Request, *, may_turn: bool) -> None:
    like = frames[0]
    orientations = np.array([frame.orientation for frame in frames])
    alike = np.isclose(orientations, like.orientation, rtol=0, atol=DIRECTION, equal_nan=True).all(axis=1)
    if not may_turn and not alike.all():
        n_directions = len(np.unique(np.round(orientations, 2), axis=0))
        raise FileError(
            f"slices are not parallel: {like.name} and {frames[int(np.argmin(alike))].name}, {n_directions} directions "
            f"in all (a survey, a scout or a radial series?); {_name_one(frames, request)}: {request.path}"
        )
    spacings = np.array([frame.pixel_spacing for frame in frames])
    alike = np.isclose(spacings, like.pixel_spacing, rtol=1e-3, atol=0, equal_nan=True).all(axis=1)
    if request.spacing is None and not alike.all():
        other = frames[int(np.argmin(alike))]
        raise FileError(
            f"slices differ in the spacing of their pixels: {like.name} has {like.pixel_spacing} mm, "
            f"{other.name} has {other.pixel_spacing}; {_name_one(frames, request)}; or pass spacing=(x, y, z): "
            f"{request.path}"
        )


def _name_one(frames: Sequence[Frame], request: Request) -> str:
    """Advice for a series with several kinds of frames: a named file opens the frames of its own kind."""
    if len({frame.file for frame in frames}) == 1:
        return "export each kind by itself"
    before = "unpack the archive, and " if is_zip(request.file) else ""
    return f"{before}name one file of the kind that is wanted, such as {frames[0].file.name}, and others are left out"


def mended(headers: Sequence[Header], request: Request) -> tuple[list[Frame], list[str], list[str]]:
    """The frames with impossible values replaced, guesses, and warnings.

    A slope of 0 in all frames counts as none, as in NIfTI; in some of them it is refused, since values of the others
    are no stored numbers.
    """
    frames = [frame for header in headers for frame in header.frames]
    guesses, losses = [], []
    if wrong := [frame for frame in frames if min(frame.pixel_spacing) <= 0]:
        if request.spacing is None:
            row, column = wrong[0].pixel_spacing
            raise FileError(
                f"PixelSpacing of {wrong[0].name} is {row:g} and {column:g} mm, and must be positive; "
                f"pass spacing=(x, y, z) instead: {request.path}"
            )
        frames = _changed(frames, lambda frame: min(frame.pixel_spacing) <= 0, pixel_spacing=(1.0, 1.0))
    directions = np.array([frame.orientation for frame in frames])
    angles = np.abs((directions[:, :3] * directions[:, 3:]).sum(axis=1))
    if (angles > RIGHT_ANGLE).any():
        raise FileError(
            f"ImageOrientationPatient of {frames[int(np.argmax(angles > RIGHT_ANGLE))].name} is not two directions at "
            f"right angles; export it again: {request.path}"
        )
    if long := [frame for frame in frames if max(abs(length - 1) for length in frame.orientation_lengths) > DIRECTION]:
        row, column = long[0].orientation_lengths
        guesses.append(
            f"ImageOrientationPatient as directions alone: in {_counted(long)} its vectors have lengths "
            f"{row:.4g} and {column:.4g}, and must have 1"
        )
    if wrong := [frame for frame in frames if not _is_scale(frame)]:
        found = f"slope {wrong[0].slope:g} and intercept {wrong[0].intercept:g}"
        if len(wrong) < len(frames):
            raise FileError(
                f"values of {_counted(wrong)} are unknown: {wrong[0].name} has {found} (RescaleSlope, "
                f"RescaleIntercept), others have usable ones; move these files away, or export them again: "
                f"{request.path}"
            )
        frames = _changed(frames, lambda _: True, slope=1.0, intercept=0.0)
        losses.append(f"values as they are stored: {found} (RescaleSlope, RescaleIntercept) cannot be")
    return frames, guesses, losses


def _is_scale(frame: Frame) -> bool:
    return math.isfinite(frame.slope) and math.isfinite(frame.intercept) and frame.slope != 0


def _changed(frames: Sequence[Frame], which: Callable[[Frame], bool], **changes: object) -> list[Frame]:
    return [replace(frame, **changes) if which(frame) else frame for frame in frames]  # type: ignore[arg-type]


def _counted(frames: Sequence[Frame]) -> str:
    files: set[Path] = {frame.file for frame in frames}
    n, what = (len(frames), "frame") if len(files) == 1 else (len(files), "file")
    return f"{n} {what}{'' if n == 1 else 's'}"


# DICOM series of a place: headers of its files, the series that they belong to, and the one that is asked for.

#: Files that cannot be read, and why.
Unreadable: TypeAlias = Mapping[Path, Exception]
HOW = "by its number, its description, its modality or the start of its UID"
#: Modalities by the words that people have for them.
MODALITIES = {"pet": "PT", "mri": "MR", "dose": "RTDOSE"}
#: Series that a message lists, at most.
N_LISTED = 20


@dataclass
class Scan:
    """Headers of all images of a place, image files that cannot be read, and DICOM files that are no images."""

    #: The folder that messages name files from.
    root: Path
    headers: list[Header] = field(default_factory=list)
    unreadable: dict[Path, Exception] = field(default_factory=dict)
    others: list[Path] = field(default_factory=list)


def scanned(files: Iterable[Path], root: Path, request: Request, known: Header | None = None) -> Scan:
    """The headers of files below the folder `root`.

    Headers are kept from one time point of a series to the next, as long as their files stay as they are. `known`: a
    header that has been read.
    """
    scan = Scan(root)
    kept = {} if request.kept is None else request.kept.setdefault("headers of DICOM", {})
    for file in files:
        check_cancelled()
        state = file.stat()
        key = (str(file), state.st_mtime_ns, state.st_size)  # a text, since the hash of a path is slow
        if known is not None and file == known.file:
            kept[key] = known
        if key not in kept:
            looks_like = file.suffix.lower() in SUFFIXES
            kept[key] = _header_or_error(file) if looks_like or _is_dicom(file) else ()
        header = kept[key]
        if header is None:
            scan.others.append(file)
        elif isinstance(header, Header):
            scan.headers.append(header)
        elif isinstance(header, Exception):
            scan.unreadable[file] = header
    return scan


def _header_or_error(file: Path) -> Header | Exception | None:
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


def chosen_series(scan: Scan, request: Request, known: Header | None = None) -> list[Header]:
    """The headers of the series that is asked for, else of the file that was named or the only one; errors list all.

    known : the header of the file that was named.
    """
    series, wanted = _series_of(scan.headers), request.series
    if wanted is None and known is not None:
        return series[known.series]
    if not series:
        raise _nothing(scan, request)
    if wanted is None and len(series) > 1:
        described = _described(series, scan.root)
        message = (
            f"the {_place(request)} holds {len(series)} series; choose one with series= (--series), {HOW}: "
            f"{_listed(described)}: {request.path}"
        )
        raise several(message, "series", list(series), described)
    uids = list(series) if wanted is None else _matching(series, wanted)
    if len(uids) != 1:
        which = {uid: series[uid] for uid in uids} or series
        found = f"{len(uids)} series match series={wanted!r}" if uids else f"no series {wanted!r}"
        raise ArgumentError(
            f"{found}; choose one {HOW}: {_listed(_described(which, scan.root, with_uids=bool(uids)))}: {request.path}"
        )
    return series[uids[0]]


def _nothing(scan: Scan, request: Request) -> FileError:
    """The error for a place without images."""
    if scan.unreadable:
        first = next(iter(scan.unreadable.values()))
        if isinstance(first, FileError):  # which says more
            return first
        error = FileError(f"{named(scan.unreadable)}; copy or export them again: {request.path}")
        error.__cause__ = first
        return error
    if scan.others:
        content = content_of(scan.others[0])
        return FileError(
            f"the {_place(request)} holds DICOM files without images ({scan.others[0].name} holds {content.what}); "
            f"{content.instead}: {request.path}"
        )
    return foreign_folder(request.file, depth=2) or FileError(
        f"the folder holds no DICOM series, no TIFF slices and no Zarr array; name another: {request.path}"
    )


def _place(request: Request) -> str:
    """The word for the thing that holds the files."""
    if request.file.is_dir():
        return "folder"
    return "zip archive" if request.file.suffix.lower() == ".zip" else "directory"


def _series_of(headers: Iterable[Header]) -> dict[str, list[Header]]:
    """Headers by UID of their series, studies as they come, and the series of each in the order of their numbers."""
    series: dict[str, list[Header]] = {}
    for header in headers:
        series.setdefault(header.series, []).append(header)
    studies = list(dict.fromkeys(found[0].study for found in series.values()))

    def place(item: tuple[str, list[Header]]) -> tuple[int, bool, int]:
        first = item[1][0]
        return studies.index(first.study), first.series_number is None, first.series_number or 0

    return dict(sorted(series.items(), key=place))


def _matching(series: Mapping[str, Sequence[Header]], wanted: str | int) -> list[str]:
    """UIDs of the series that a number, a description, a modality or the start of a UID stands for.

    The first way that fits one counts.
    """
    text = str(wanted).strip()
    firsts = {uid: headers[0] for uid, headers in series.items()}
    folded = text.casefold()
    modality = MODALITIES.get(folded, text.upper())
    ways = [
        [uid for uid in firsts if uid == text],
        [uid for uid, one in firsts.items() if text.isdecimal() and one.series_number == int(text)],
        [uid for uid, one in firsts.items() if one.description.casefold() == folded],
        [uid for uid in firsts if "." in text and uid.startswith(text)],
        [uid for uid, one in firsts.items() if not text.isdecimal() and folded in one.description.casefold()],
        [uid for uid, one in firsts.items() if modality and one.modality == modality],
    ]
    return next((way for way in ways if way), []) if text else []


def _described(series: Mapping[str, Sequence[Header]], root: Path, *, with_uids: bool = False) -> list[str]:
    """A line for each series: number, modality, description, number of files, and what else distinguishes it."""
    numbers = [headers[0].series_number for headers in series.values()]
    folders = {uid: _folder(headers[0].file, root) for uid, headers in series.items()}
    lines = []
    for uid, headers in series.items():
        first = headers[0]
        is_clear = first.series_number is not None and numbers.count(first.series_number) == 1
        parts = ["" if first.series_number is None else str(first.series_number), first.modality or ""]
        parts += [f'"{first.description}"' if first.description else ""]
        parts += [uid if with_uids or not is_clear else ""]
        files = f"{len(headers)} file{'' if len(headers) == 1 else 's'}"
        where = f" in {folders[uid]}" if folders[uid] and len(set(folders.values())) > 1 else ""
        lines.append(f"{' '.join(part for part in parts if part)} ({files}{where})")
    return lines


def _folder(file: Path, root: Path) -> str:
    """The folder of a file as seen from `root`; "" for that itself."""
    folder = os.path.relpath(file.parent, root)
    return "" if folder == "." else Path(folder).as_posix()


def _listed(described: Sequence[str]) -> str:
    more = f", and {len(described) - N_LISTED} more" if len(described) > N_LISTED else ""
    return ", ".join(described[:N_LISTED]) + more


def named(unreadable: Unreadable) -> str:
    """A sentence on the files that cannot be read, or are missing."""
    gone = [file for file, error in unreadable.items() if isinstance(error, FileNotFoundError)]
    damaged = [file for file in unreadable if file not in gone]
    text = []
    if damaged:
        are = "1 file of the folder is" if len(damaged) == 1 else f"{len(damaged)} files of the folder are"
        text.append(f"{are} damaged and cannot be read ({_names(damaged)})")
    if gone:
        are = "1 file is" if len(gone) == 1 else f"{len(gone)} files are"
        text.append(f"{are} missing that the directory (DICOMDIR) names ({_names(gone)})")
    return ", and ".join(text)


def _names(files: Sequence[Path]) -> str:
    return ", ".join(file.name for file in files[:N_NAMED]) + (", ..." if len(files) > N_NAMED else "")


def alike(headers: Sequence[Header], known: Header) -> tuple[list[Header], str]:
    """The files of a series that can be slices beside the one that was named, and a sentence on those left out.

    A series may also hold scouts, and pictures of other sizes: these must not hinder the file that was named.
    """
    first = known.frames[0]
    fitting = [
        one
        for one in headers
        if (one.size, one.n_samples) == (known.size, known.n_samples)
        and np.allclose(one.frames[0].orientation, first.orientation, rtol=0, atol=DIRECTION, equal_nan=True)
        and np.allclose(one.frames[0].pixel_spacing, first.pixel_spacing, rtol=1e-3, atol=0, equal_nan=True)
    ]
    n_left = len(headers) - len(fitting)
    if not n_left:
        return fitting, ""
    are = "1 file" if n_left == 1 else f"{n_left} files"
    differ = "size, direction or distance of pixels"
    return fitting, f"without {are} of the series, whose {differ} is not as in {known.file.name}"


def without_copies(headers: Sequence[Header], named_file: Path | None) -> list[Header]:
    """One file of each group of copies, the one that was named if it is among them.

    Some programs give all files one UID, so a file with another position or other attributes is no copy.
    """
    first: dict[Hashable, Header] = {}
    for header in headers:
        frame = header.frames[0]
        identity = (frame.instance, frame.position.tobytes(), tuple(sorted(frame.attributes.items())))
        key = (header.instance_uid, identity) if header.instance_uid else header.file
        if key not in first or header.file == named_file:
            first[key] = header
    return list(first.values())
