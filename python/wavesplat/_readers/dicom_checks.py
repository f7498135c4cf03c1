"""Impossible values in DICOM headers: refused with the file's name, or replaced and reported."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from wavesplat._readers.dicom_header import Frame, Header
from wavesplat._readers.dicom_mosaic import unsplit_note
from wavesplat._readers.dicom_places import is_zip
from wavesplat._readers.request import Request
from wavesplat.errors import FileError

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
                f"values of {_counted(wrong)} cannot be told: {wrong[0].name} has {found} (RescaleSlope, "
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
