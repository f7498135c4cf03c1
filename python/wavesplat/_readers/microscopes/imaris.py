"""Imaris files (.ims), by h5py: HDF5 with a dataset for each resolution level, time point and channel.

The box of an image is `ExtMin` to `ExtMax`, its faces, not the centres of its first and last samples. Datasets are as
large as whole chunks; `ImageSizeX`, ... are the samples that count. Attributes are texts, stored letter by letter.
Source: Bitplane, "Imaris 5.5 File Format Description", https://imaris.oxinst.com (ImarisWriter has it too).
"""

from __future__ import annotations

from datetime import datetime
from itertools import pairwise
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.hdf5 import read_hdf5
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Channel, Facts
from wavesplat._readers.hdf5.levels import StoredImage, StoredLevel, checked_dataset, levels_of, member_at, numbered
from wavesplat._readers.levels import Levels
from wavesplat._readers.request import Request, choose, level_numbers, window_of
from wavesplat.errors import FileError

if TYPE_CHECKING:
    import h5py


#: Names that Imaris writes where a channel has none.
UNNAMED = {"", "(name not specified)"}


def levels(request: Request) -> Levels:
    """A channel of an Imaris file at one time."""
    with read_hdf5(request.file) as file:
        return levels_of(file, _described(file, request), request)


def _described(file: h5py.File, request: Request) -> StoredImage:
    """Levels, place and facts of the channel and time that are asked for."""
    levels = numbered(member_at(file, "DataSet", request), "ResolutionLevel")
    times = numbered(member_at(file, "DataSet/ResolutionLevel 0", request), "TimePoint")
    numbers = numbered(member_at(file, "DataSet/ResolutionLevel 0/TimePoint 0", request), "Channel")
    if levels[:1] != [0] or times[:1] != [0] or not numbers:
        raise FileError(
            "the file has no resolution level 0 with a time point 0 and a channel, so no image; export it again: "
            f"{request.safe_path}"
        )
    channels = [_channel(_info(file, f"Channel {number}", request)) for number in numbers]
    time = choose("time", len(times), request.time, request.safe_path)
    channel = choose(
        "channel", len(numbers), request.channel, request.safe_path, described=[one.name for one in channels]
    )
    inside = f"TimePoint {times[time]}/Channel {numbers[channel]}"
    groups = [f"DataSet/ResolutionLevel {level}/{inside}" for level in levels]
    shapes = [_shape(file, group, request) for group in groups]
    image = _info(file, "Image", request)
    lower, upper, guesses = _box(image, shapes[0])
    unit, factor = units.of_file(_text(image, "Unit"))
    lower, upper = lower * factor, upper * factor
    wanted = level_numbers(len(levels), request)
    stored = [StoredLevel(f"{groups[k]}/Data", shapes[k], _world_from_index(lower, upper, shapes[k])) for k in wanted]
    moments, moments_unit = _times(_info(file, "TimeInfo", request), times)
    facts = Facts(
        unit=unit,
        modality="fluorescence" if any(one.emission_nm is not None for one in channels) else None,
        channel=channels[channel],
        channels=tuple(channels),
        n_times=len(times),
        times=moments,
        time_unit=moments_unit,
        levels=tuple(shapes) if len(shapes) > 1 else (),
        guesses=guesses,
    )
    return StoredImage(request.file, stored, facts)


def _info(file: h5py.File, name: str, request: Request) -> Any:
    return member_at(file, f"DataSetInfo/{name}", request)


def _shape(file: h5py.File, group: str, request: Request) -> tuple[int, int, int]:
    """Samples along z, y, x of a level, without those that fill the last chunks."""
    stored = checked_dataset(file, f"{group}/Data", request).shape
    sizes = [_number(file[group], f"ImageSize{axis}") or size for axis, size in zip("ZYX", stored, strict=True)]
    z, y, x = (min(max(int(size), 1), held) for size, held in zip(sizes, stored, strict=True))
    return z, y, x


def _box(image: Any, shape: tuple[int, int, int]) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[str, ...]]:
    """Corners (x, y, z) of the image's box, and guesses; samples 1 apart where the file has no box."""
    ends = [[_number(image, f"{name}{axis}") for axis in range(3)] for name in ("ExtMin", "ExtMax")]
    lower, upper = (np.array([np.nan if end is None else end for end in row]) for row in ends)
    if not (np.isfinite(upper - lower).all() and (upper != lower).all()):
        size = np.array(shape[::-1], np.float64)
        return np.full(3, -0.5), size - 0.5, ("distances of samples 1, 1, 1: ExtMin and ExtMax of the file give none",)
    mirrored = [axis for axis, is_mirrored in zip("xyz", upper < lower, strict=True) if is_mirrored]
    guess = f"axes {', '.join(mirrored)} mirrored: ExtMin is larger than ExtMax in the file"
    return lower, upper, (guess,) if mirrored else ()


def _world_from_index(
    lower: NDArray[np.float64], upper: NDArray[np.float64], shape: tuple[int, int, int]
) -> NDArray[np.float64]:
    """The affine of a level whose samples fill the box; the first one lies half a step inside."""
    steps = (upper - lower) / np.array(shape[::-1])
    # Extents are written with few digits; their rounding is not to be shown as a distance.
    steps = np.array([float(f"{step:.9g}") for step in steps])
    matrix = np.diag([*steps, 1.0])
    matrix[:3, 3] = lower + steps / 2
    return matrix


def _channel(group: Any) -> Channel:
    name = _text(group, "Name")
    wavelength = _number(group, "LSMEmissionWavelength")
    window = _text(group, "ColorRange").split()
    return Channel(
        "" if name in UNNAMED else name,
        _color(_text(group, "Color").split()),
        wavelength if wavelength is not None and wavelength > 0 else None,
        window_of(*window) if len(window) == 2 else None,
    )


def _color(parts: list[str]) -> tuple[float, float, float] | None:
    """Red, green and blue, 0 to 1; None where they are none, or black, which stands for a table of colours."""
    try:
        red, green, blue = (min(max(float(part), 0.0), 1.0) for part in parts)
    except ValueError:
        return None
    return (red, green, blue) if max(red, green, blue) > 0 else None


def _times(info: Any, numbers: list[int]) -> tuple[tuple[float, ...], str | None]:
    """Seconds from the first time point to each; empty where the file has no growing times."""
    if len(numbers) < 2:
        return (), None
    try:
        moments = [datetime.fromisoformat(_text(info, f"TimePoint{number + 1}")) for number in numbers]
    except ValueError:
        return (), None
    seconds = tuple((moment - moments[0]).total_seconds() for moment in moments)
    is_growing = all(a < b for a, b in pairwise(seconds))
    return (seconds, "s") if is_growing else ((), None)


def _text(group: Any, name: str) -> str:
    """A text that is an attribute of a group; empty where there is none."""
    value = getattr(group, "attrs", {}).get(name)
    if value is None:
        return ""
    if isinstance(value, np.ndarray):
        value = b"".join(value.astype("S").ravel().tolist())
    return (value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)).strip().strip("\0")


def _number(group: Any, name: str) -> float | None:
    """A finite number that an attribute has as a text; None where it has none."""
    try:
        number = float(_text(group, name))
    except ValueError:
        return None
    return number if isfinite(number) else None
