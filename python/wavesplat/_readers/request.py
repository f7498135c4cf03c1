"""Requests to readers, and the grids that they return."""

from __future__ import annotations

import logging
import math
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from os import PathLike, fspath
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Facts
from wavesplat._readers.options import OpenValues
from wavesplat._storage.addresses import checked, is_address, last_part, safe_address
from wavesplat._storage.paths import NAMELESS, FileName, check_within, expanded
from wavesplat.errors import ArgumentError, FileError

#: Names that a message lists, at most.
MAX_LISTED = 40
#: Samples along the longest side of a grid that is made of another, at most.
MAX_RESAMPLED = 4096


class Grid(NamedTuple):
    """Samples [z, y, x], the affine from their index (x, y, z) to the world, and the file's facts."""

    samples: NDArray[Any]
    world_from_index: NDArray[np.float64]
    facts: Facts = Facts()
    #: Parts of the file that are missing, a sentence each: warnings in Python, and guesses as well.
    losses: tuple[str, ...] = ()
    #: A sentence on segments that overlap, of which one label map hides some voxels; None where none do.
    overlap: str | None = None

    @property
    def all_losses(self) -> tuple[str, ...]:
        """The losses, overlapping segments included."""
        return self.losses if self.overlap is None else (*self.losses, self.overlap)


class SeveralError(FileError):
    """The file holds several volumes or arrays, and none was chosen; `wavesplat info` lists them instead."""

    #: The argument of `wavesplat.open` that chooses, and what it may be.
    option: str = ""
    names: tuple[str | int, ...] = ()
    #: Description of each for people; the names themselves if empty.
    described: tuple[str, ...] = ()
    #: Whether the file says what they are; else another option may be the one that chooses.
    is_known: bool = True
    #: Whether channels are light of colours that add up; channels of simulations are runs, months or species.
    are_light: bool = True


class PictureError(FileError):
    """The file holds a picture or a film, which fills no space, and was not asked for as such."""

    #: Pictures of a film.
    n_times: int = 1


def several(
    message: str, option: str, names: Sequence[str | int], described: Sequence[str] = (), *, is_known: bool = True
) -> SeveralError:
    """The error for several volumes or arrays, with the option that chooses one."""
    error = SeveralError(message)
    error.option, error.names, error.described, error.is_known = option, tuple(names), tuple(described), is_known
    return error


@dataclass(frozen=True)
class Request(OpenValues):
    """The arguments of `wavesplat.open`: a path, and the values of `OpenOptions`."""

    path: str | PathLike[str]
    #: The folder of the document that names the file, which must lie in it; None where the user names it.
    within: Path | None = None
    #: State that readers keep from one time point of a file to the next, such as a file that is read on.
    kept: dict[str, Any] | None = field(default=None, compare=False, repr=False)

    @property
    def file(self) -> Path:
        """The path, with ~ resolved."""
        return expanded(self.path)

    @property
    def safe_path(self) -> str:
        """The path for messages; of an address without what may be a password."""
        return safe_address(self.path)

    @property
    def is_url(self) -> bool:
        """Whether the path is an address, not the name of a file."""
        return is_address(self.path)

    @property
    def name(self) -> FileName:
        """The last part of the path; of a folder, whose name may be a patient's, another one."""
        if self.is_url:
            return FileName(last_part(str(self.path)))
        if self.file.is_dir() and self.file.suffix.lower() != ".zarr":
            return FileName(NAMELESS, is_private=True)
        return FileName(fspath(self.path).rstrip("/").rpartition("/")[2] or fspath(self.path))

    def given(self) -> set[str]:
        """Names of the options that were set."""
        return {
            f.name
            for f in fields(self)
            if f.name not in ("path", "kept", "memory", "holes", "within", "cache")
            and not _is_same(getattr(self, f.name), f.default)
        }


def requested(path: str | PathLike[str], **options: Any) -> Request:
    """The request that a path and options of `wavesplat.open` make, checked as far as no file is needed."""
    expanded(path)  # or an error
    path = checked(str(path)) if is_address(path) else path
    request = Request(path, within=NAMED_WITHIN.get(), **{**options, "unit": units.checked(options.get("unit"))})
    if not request.is_url:
        check_within(request.file, request.within)
    if request.gaps not in ("fill", "refuse"):
        raise ArgumentError(f'gaps is {request.gaps!r}; use "fill" or "refuse"')
    if request.component not in (None, "x", "y", "z", "magnitude"):
        raise ArgumentError(f'component is {request.component!r}; use "x", "y", "z" or "magnitude"')
    if request.resample is not None and not 2 <= request.resample <= MAX_RESAMPLED:
        raise ArgumentError(f"resample is {request.resample!r}; give a number of samples, 2 to {MAX_RESAMPLED}")
    if str(path).lower().endswith(".wavelets"):
        raise ArgumentError(
            f"this is a file of wavelet coefficients; load it with wavesplat.WaveletVolume.load: {safe_address(path)}"
        )
    return request


#: `within` of the requests that are made now. Not an argument of functions that open: users have no document. Requests
#: keep it, also for later reads.
NAMED_WITHIN: ContextVar[Path | None] = ContextVar("named_within", default=None)


def level_numbers(count: int, request: Request) -> list[int]:
    """The levels that are asked for: all, or the one of `level=`."""
    level = request.level
    if level is None:
        return list(range(count))
    if not 0 <= level < count:
        raise ArgumentError(
            f"level={level}, but there are {count} levels, 0..{count - 1}; 0 is the finest: {request.safe_path}"
        )
    return [level]


#: Whether a single plane is taken as two equal ones beside each other. Not an argument of functions that open, whose
#: volumes are drawn.
PLANES_ARE_TAKEN: ContextVar[bool] = ContextVar("planes_are_taken", default=False)


#: Pixels that a picture needs along the longer side of a single plane: a coarser level of a pyramid may have enough.
PLANE_PX: ContextVar[float] = ContextVar("plane_px", default=math.inf)


@contextmanager
def taking_planes(n_pixels: float = math.inf) -> Iterator[None]:
    """Allow files of a single plane in this block, for pictures of `n_pixels` along the longer side."""
    token, token_of_px = PLANES_ARE_TAKEN.set(True), PLANE_PX.set(n_pixels)
    try:
        yield
    finally:
        PLANES_ARE_TAKEN.reset(token)
        PLANE_PX.reset(token_of_px)


@contextmanager
def named_within(folder: Path | None) -> Iterator[None]:
    """Confine the requests made meanwhile to the folder of the document that names files; None: the user names them."""
    token = NAMED_WITHIN.set(folder)
    try:
        yield
    finally:
        NAMED_WITHIN.reset(token)


def _is_same(value: object, default: object) -> bool:
    """Whether an option has its default; also for arrays, whose comparison is an array."""
    return value is default or (isinstance(value, int | str) and value == default)


@contextmanager
def quiet(*libraries: str) -> Iterator[None]:
    """Keep libraries, with the modules in them, from logging about what we report ourselves."""
    before = [(logger, logger.level) for logger in map(logging.getLogger, libraries)]
    for logger, _ in before:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in before:
            logger.setLevel(level)


@contextmanager
def unwarned(library: str) -> Iterator[None]:
    """Keep a library from warning about what we report ourselves; not for threads, which share the filters."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", module=library)
        yield


def listed(names: Sequence[object], most: int = MAX_LISTED) -> str:
    """Names for a message: the first of them where there are many."""
    return ", ".join(map(str, names[:most])) + (", ..." if len(names) > most else "")


def no_such_name(what: str, wanted: str, names: Sequence[str], request: Request) -> ArgumentError:
    """The error for a dataset that is not in a file, with the name that may be meant.

    what : what the names are, such as "array".
    """
    alike = {name.lower(): name for name in names}
    near = get_close_matches(wanted.lower(), alike, 1, 0.6)
    hint = f"did you mean {alike[near[0]]!r}? " if near else ""
    holds = f"the file holds {listed(names)}" if names else f"the file holds no {what}"
    return ArgumentError(f"no {what} {wanted!r}; {hint}{holds}: {request.path}")


#: Time points or channels that an error describes, at most.
N_DESCRIBED = 6
WHAT = {"time": "time points", "channel": "channels"}


def choose(option: str, count: int, number: int | None, path: object, *, described: Sequence[str] = ()) -> int:
    """The index of a time point or channel: what was asked for, or 0 if there is only one."""
    if number is None:
        if count == 1:
            return 0
        listed = ", ".join(f"{n} {text}" for n, text in enumerate(described[:N_DESCRIBED])) if any(described) else ""
        listed = f" ({listed}{', ...' if count > N_DESCRIBED else ''})" if listed else ""
        message = (
            f"the file holds {count} {WHAT[option]}{listed}; choose one with {option}=0..{count - 1} "
            f"(on the command line --{option} N): {path}"
        )
        raise several(message, option, range(count), described)
    if not 0 <= number < count:
        raise ArgumentError(f"{option}={number}, but the file holds {count} {WHAT[option]}, 0..{count - 1}: {path}")
    return number


def index_unnamed_axes(shape: Sequence[int], request: Request) -> tuple[Any, ...]:
    """Index of one volume in an array whose axes have no names: time is the first axis, channel the last."""
    n_extra = len(shape) - 3
    wanted = (request.time is not None) + (request.channel is not None)
    if n_extra > 0 and wanted < n_extra:
        message = (
            f"the array is {len(shape)}-D, shape {tuple(shape)}; choose one volume with "
            f"time=0..{shape[0] - 1} (first axis) or channel=0..{shape[-1] - 1} (last axis): {request.safe_path}"
        )
        # Time is the more usual one of a single further axis.
        is_time = request.time is None and (request.channel is not None or not _ends_with_components(shape))
        option, count = ("time", shape[0]) if is_time else ("channel", shape[-1])
        raise several(message, option, range(count), is_known=False)
    if wanted > max(n_extra, 0):
        raise ArgumentError(
            f"the array is {len(shape)}-D, shape {tuple(shape)}; leave out time and channel: {request.safe_path}"
        )
    first = () if request.time is None else (choose("time", shape[0], request.time, request.safe_path),)
    last = () if request.channel is None else (choose("channel", shape[-1], request.channel, request.safe_path),)
    return (*first, ..., *last)


def _ends_with_components(shape: Sequence[int]) -> bool:
    """Whether the last axis is more likely one of components than the first is one of times: 2 or 3, and shorter."""
    return shape[-1] in (2, 3) and min(shape[:-1]) > 3


def window_of(low: Any, high: Any) -> tuple[float, float] | None:
    """The window of values with which a file shows a channel; None if its ends are no two growing numbers."""
    try:
        ends = float(low), float(high)
    except (TypeError, ValueError, OverflowError):
        return None
    return ends if np.isfinite(ends).all() and ends[0] < ends[1] else None


def n_times_of(shape: Sequence[int], request: Request) -> int:
    """Time points of an array whose axes have no names."""
    return int(shape[0]) if len(shape) > 3 and request.time is not None else 1
