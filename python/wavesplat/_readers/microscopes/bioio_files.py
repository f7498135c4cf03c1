"""Files of microscopes' vendors (.czi, .lif, .nd2, .dv, ...), by bioio and its readers.

bioio takes the reader that is installed for a suffix. Readers whose licence is the GPL (of .czi), or that need Java,
are no part of the extra: whoever wants them installs them, and messages name them.
Distances are micrometres where a reader names no other unit: all of bioio's count in them.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from datetime import timedelta
from functools import partial
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.lazy.array import SlicedArray
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import COLORS, Channel, Facts, Rgb
from wavesplat._readers.levels import Levels
from wavesplat._readers.request import Request, choose, quiet, several
from wavesplat._readers.tiff.facts import guesses_of_steps
from wavesplat._storage.file_states import StoredFiles
from wavesplat._storage.reading import reading
from wavesplat._system.libraries import how_to_install
from wavesplat.errors import ArgumentError, FileError

# Colours and wavelengths of channels in the metadata of Zeiss' CZI, an XML tree.
#
# `DisplaySetting` has what the microscopist saw: `<Channel Id="Channel:0" Name="DAPI"><Color>#FF00A1FF</Color>`, alpha
# first. `Image` has what was measured: `<EmissionWavelength>465</EmissionWavelength>`, nanometres, and a colour too.


class CziChannel(NamedTuple):
    """The colour of a channel, and the wavelength of its light, nanometres, by the texts of the file."""

    color: Rgb | None = None
    emission_nm: str | None = None


def czi_channels(metadata: Any, count: int) -> list[CziChannel]:
    """Colour and wavelength of each channel in CZI metadata; None for both if the channels cannot be matched."""
    if not hasattr(metadata, "iterfind"):
        return [CziChannel()] * count
    measured = list(metadata.iterfind(".//Information/Image/Dimensions/Channels/Channel"))
    displayed = list(metadata.iterfind(".//DisplaySetting/Channels/Channel"))
    if len(measured) != count:
        return [CziChannel()] * count
    return [_czi_channel(one, _same(one, number, displayed, count)) for number, one in enumerate(measured)]


def _same(channel: Any, number: int, displayed: list[Any], count: int) -> Any:
    """The channel of `DisplaySetting` that has the same identity or name, else the same place; None without one."""
    for key in ("Id", "Name"):
        found = [one for one in displayed if one.get(key) is not None and one.get(key) == channel.get(key)]
        if len(found) == 1:
            return found[0]
    return displayed[number] if len(displayed) == count else None


def _czi_channel(measured: Any, displayed: Any) -> CziChannel:
    shown = None if displayed is None else _color(displayed.findtext("Color"))
    wavelength = measured.findtext("EmissionWavelength")
    if wavelength is None and displayed is not None:
        wavelength = displayed.findtext("DyeMaxEmission")
    return CziChannel(shown or _color(measured.findtext("Color")), wavelength)


def _color(text: str | None) -> Rgb | None:
    """A colour #AARRGGBB or #RRGGBB; None for anything else."""
    match = re.fullmatch(r"#(?:[0-9a-fA-F]{2})?([0-9a-fA-F]{6})", (text or "").strip())
    if match is None:
        return None
    red, green, blue = (int(match[1][i : i + 2], 16) / 255 for i in (0, 2, 4))
    return red, green, blue


# Files of microscopes' vendors (.czi, .lif, .nd2, .dv, ...), by bioio and its readers, which are an extra.


class Vendor(NamedTuple):
    """The content of a vendor's file, and the package that reads it where the extra does not."""

    what: str
    package: str | None = None


ZEISS = Vendor("an image of Zeiss' microscopes (CZI)", "bioio-czi (whose licence is the GPL)")
OLYMPUS = Vendor("an image of Olympus' microscopes", "bioio-bioformats (which needs Java)")
OTHER = Vendor("an image of a microscope", "bioio-bioformats (which needs Java)")
#: Suffix -> its vendor.
SUFFIXES = {
    ".czi": ZEISS,
    ".lif": Vendor("images of Leica's microscopes (LIF)"),
    ".nd2": Vendor("an image of Nikon's microscopes (ND2)"),
    **dict.fromkeys((".dv", ".r3d"), Vendor("an image of a DeltaVision microscope (DV)")),
    **dict.fromkeys((".lof", ".xlef"), Vendor("images of Leica's microscopes", "bioio-bioformats (which needs Java)")),
    **dict.fromkeys((".oib", ".oif", ".oir", ".vsi"), OLYMPUS),
    **dict.fromkeys((".ics", ".ids", ".sld"), OTHER),
    ".sldy": Vendor("an image of SlideBook (SLDY)", "bioio-sldy"),
}
#: Packages of bioio, which log what they do not find in a file: for many CZI, pages of errors about their duration.
PACKAGES = ("bioio", *(f"bioio_{name}" for name in ("bioformats", "czi", "dv", "lif", "nd2", "sldy")))
#: Advice where a reader of bioio fails, and does not say that bytes are missing.
OTHER_FORM = (
    "its reader in bioio does not take this form, such as a scan of x and z or of wavelengths; export it as OME-TIFF, "
    "as with Fiji"
)
#: Beginnings of the names that bioio gives to channels without one.
MADE_UP = ("Channel:",)
#: White, which OME's metadata say where a reader knows no colour.
OME_DEFAULT = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class _Described:
    """A volume of a file, as a Dask array [z, y, x], its steps along x, y, z, and facts."""

    array: Any
    steps: tuple[float, float, float]
    facts: Facts


def levels(request: Request) -> Levels:
    """A channel of a vendor's file, at one time."""
    with _opened(request) as image:
        found = _described(image, request)
        z, y, x = (int(n) for n in found.array.shape)
        array = SlicedArray(
            _Samples(request, found.array),
            name=request.name,
            chunks=[max(sizes) for sizes in found.array.chunks],
            opened=partial(_Samples, replace(request, kept=None)),
            dtype=np.dtype(found.array.dtype),
            shape=(z, y, x),
            n_readers=1,
            token=f"bioio {request.file} {request.series} {request.time} {request.channel}",
            files=StoredFiles([request.file]),
        )
        return Levels([array], [np.diag([*found.steps, 1.0])], found.facts, quietly=partial(_quietly, request))


class _Samples:
    """Samples that are sliced by reading their part of the file.

    Readers open the file in `compute` of their own kind of Dask array, so parts are not computed together.
    """

    def __init__(self, request: Request, array: Any = None) -> None:
        if array is None:
            with _opened(request) as image:
                array = _described(image, request).array
        self._array = array

    def __getitem__(self, index: tuple[slice, slice, slice]) -> NDArray[Any]:
        return np.asarray(self._array[index].compute(scheduler="threads"))


@contextmanager
def _quietly(request: Request) -> Iterator[None]:
    """Name the file in errors; what libraries warn of and log meanwhile is not shown."""
    with (
        reading("a microscope's file", request.path, other_form=OTHER_FORM),
        quiet(*PACKAGES),
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("ignore")
        yield


@contextmanager
def _opened(request: Request) -> Iterator[Any]:
    """The image of a file, at the scene that is asked for."""
    path = request.file
    suffix = next(suffix for suffix in SUFFIXES if path.name.lower().endswith(suffix))
    try:
        bioio: Any = import_module("bioio")
        is_read = suffix in import_module("bioio.plugins").get_plugins(use_cache=True)
    except ImportError:
        raise _not_installed(path, SUFFIXES[suffix]) from None
    if not is_read:
        raise _not_installed(path, SUFFIXES[suffix])
    with _quietly(request):
        image = _image(bioio, path)
        image.set_scene(_scene(list(image.scenes), request))
        yield image


def _image(bioio: Any, path: Path) -> Any:
    try:
        return bioio.BioImage(str(path))
    except Exception as error:
        if type(error).__name__ != "UnsupportedFileFormatError":
            raise
        raise FileError(
            "the readers of bioio that are installed do not open the file: it is of another form than they read, or "
            f"its first bytes are wrong; export it as OME-TIFF, as with Fiji: {path}"
        ) from error


def _not_installed(path: Path, vendor: Vendor) -> FileError:
    package, _, note = (vendor.package or "").partition(" ")
    how = " ".join(filter(None, (how_to_install("bio"), package, note)))
    return FileError(
        f"the file holds {vendor.what}, which bioio reads; {how}; or export it as OME-TIFF, as with Fiji: {path}"
    )


def _scene(names: list[str], request: Request) -> int:
    """The number of the scene, one of several images in a file, that is asked for, or of the only one."""
    wanted = request.series
    if wanted is None:
        if len(names) == 1:
            return 0
        listed = ", ".join(f"{number} {name}" for number, name in enumerate(names))
        message = f"the file holds {len(names)} images; choose one with series= (--series): {listed}: {request.path}"
        raise several(message, "series", range(len(names)), names)
    if str(wanted) in names:
        return names.index(str(wanted))
    if str(wanted).isdecimal() and int(wanted) < len(names):
        return int(wanted)
    raise ArgumentError(
        f"series={wanted!r}, but the file holds {len(names)} images: give 0..{len(names) - 1} or a name of "
        f"{', '.join(names)}: {request.path}"
    )


def _described(image: Any, request: Request) -> _Described:
    sizes = {name: int(getattr(image.dims, name)) for name in image.dims.order}
    n_colors = sizes.get("S", 1)
    channels = _channels(image, sizes["C"]) if n_colors == 1 else COLORS[:n_colors]
    if n_colors > 1 and sizes["C"] > 1:
        raise FileError(f"the channels are colours themselves; export it as OME-TIFF: {request.path}")
    time = choose("time", sizes["T"], request.time, request.path)
    names = [one.name for one in channels]
    channel = choose("channel", max(sizes["C"], n_colors), request.channel, request.path, described=names)
    picked = {"T": time, "C": channel} if n_colors == 1 else {"T": time, "C": 0, "S": channel}
    array = image.get_image_dask_data("ZYX", **picked)
    steps, unit, guesses = _steps(image)
    step, step_unit = _time_step(image) if sizes["T"] > 1 else (None, None)
    facts = Facts(
        unit=unit,
        modality="fluorescence" if any(one.emission_nm is not None for one in channels) else None,
        channel=channels[channel] if channel < len(channels) else None,
        channels=channels,
        n_times=sizes["T"],
        time_step=step,
        time_unit=step_unit,
        guesses=guesses,
    )
    return _Described(array, steps, facts)


def _steps(image: Any) -> tuple[tuple[float, float, float], str | None, tuple[str, ...]]:
    """Distances along x, y, z, their unit, and guesses; one that the file has not is taken from x."""
    sizes = None
    with suppress(Exception):  # of files without a scale some readers raise an error
        sizes = image.physical_pixel_sizes
    steps = [_positive(getattr(sizes, axis, None)) for axis in "XYZ"]
    named: list[str | None] = []
    for axis in "XYZ":
        own = None
        with suppress(Exception):
            own = getattr(image.dimension_properties, axis)
        unit = getattr(own, "unit", None)
        named.append("um" if unit is None else units.canonical(unit))
    xyz_units = (named[0], named[1], named[2])
    unit, factors = units.in_one_unit(xyz_units)
    steps = [None if step is None else float(f"{step * by:.7g}") for step, by in zip(steps, factors, strict=True)]
    x = steps[0] or 1.0
    y, z = (x if step is None else step for step in steps[1:])
    return (x, y, z), unit if any(steps) else None, (*guesses_of_steps(steps, x), *units.guesses_of(xyz_units))


def _channels(image: Any, count: int) -> tuple[Channel, ...]:
    """Names of the channels, with colours and wavelengths where the reader gives OME metadata; empty without any."""
    names = [str(name) for name in image.channel_names]
    names = ["" if name.isdecimal() or name.startswith(MADE_UP) else name for name in names]
    described: list[Any] = [None] * count
    with suppress(Exception):  # many readers have none, and OME's types refuse what they do not know
        described = list(image.ome_metadata.images[image.current_scene_index].pixels.channels)
    if len(names) != count or len(described) != count:
        names, described = [""] * count, [None] * count
    of_czi = [CziChannel()] * count
    with suppress(Exception):  # the metadata of each reader are objects of their own
        of_czi = czi_channels(image.metadata, count)
    made = tuple(_channel(name, one, own) for name, one, own in zip(names, described, of_czi, strict=True))
    return made if count > 1 or made != (Channel(),) else ()


def _channel(name: str, described: Any, of_czi: CziChannel) -> Channel:
    color, wavelength = of_czi.color, _positive(of_czi.emission_nm)
    if color is None:
        with suppress(Exception):
            own = tuple(part / 255 for part in described.color.as_rgb_tuple(alpha=False))
            color = None if own == OME_DEFAULT else own
    if wavelength is None:
        with suppress(Exception):
            size = units.metres(units.canonical(described.emission_wavelength_unit.value))
            wavelength = _positive(described.emission_wavelength * (size or 0) / 1e-9)
    return Channel(name, color, None if wavelength is None else float(f"{wavelength:.9g}"))


def _time_step(image: Any) -> tuple[float | None, str | None]:
    """Time between time points, and its unit."""
    step = image.time_interval
    if isinstance(step, timedelta):
        return _positive(step.total_seconds()), "s"
    return _positive(step), None


def _positive(number: Any) -> float | None:
    """A finite number above 0; None for anything else."""
    try:
        value = float(number)
    except (TypeError, ValueError):
        return None
    return value if isfinite(value) and value > 0 else None
