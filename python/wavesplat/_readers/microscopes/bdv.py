"""BigDataViewer: an XML with places, and an HDF5 file or a folder of N5 with an array for each time and setup.

Either may be named; the samples find the XML beside them. Setups are channels here, each at the place of its
registration, also those that are tiles or angles.
Datasets of int16 hold uint16: HDF5 files of BigDataViewer are written so. A sample of a coarser level is the mean of a
block, in whose middle it lies. Source: https://imagej.net/plugins/bdv, "File format".
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.hdf5 import read_hdf5
from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Channel, Facts
from wavesplat._readers.hdf5.levels import StoredImage, StoredLevel, checked_dataset, levels_of, member_at, numbered
from wavesplat._readers.levels import Levels
from wavesplat._readers.microscopes.bdv_n5 import N5Samples
from wavesplat._readers.request import Request, choose, level_numbers
from wavesplat._readers.unsupported_formats import OF_N5
from wavesplat._storage.paths import check_named_file, check_within
from wavesplat.errors import FileError

if TYPE_CHECKING:
    import h5py

# BigDataViewer's XML (SpimData): setups, time points, and where each view of them lies.
#
# A view is a setup at a time point. A setup has attributes: a channel, a tile, an angle, a direction of light. The
# transforms of a view are multiplied in the order in which they are listed, so that the last one is applied first; they
# lead from the numbers of samples (x, y, z) to the world.
# Source: Pietzsch et al., "BigDataViewer" (2015), https://imagej.net/plugins/bdv; the library spim_data.

#: Largest XML that is read, in bytes; files with thousands of views have some million.
MAX_XML_BYTES = 1 << 26
#: Largest number of time points.
MAX_TIMES = 1 << 20


@dataclass(frozen=True)
class Setup:
    """A setup: its number, name, distances of samples (x, y, z) with their unit, and attributes."""

    number: int
    name: str = ""
    voxel: tuple[float, float, float] | None = None
    unit: str | None = None
    #: Kind of an attribute ("channel", "tile", ...) -> the name of its value, else its number.
    attributes: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class SpimData:
    """The content of an XML: format and path of the samples, setups, numbers of time points, and registrations."""

    format: str
    #: Path of the samples as it is written, from the folder of the XML; empty where there is none.
    samples: str
    setups: tuple[Setup, ...]
    times: tuple[int, ...]
    #: (time point, setup) -> world from index.
    registrations: dict[tuple[int, int], NDArray[np.float64]] = field(default_factory=dict)
    missing: frozenset[tuple[int, int]] = frozenset()


def parsed(path: Path) -> SpimData | None:
    """The content of an XML; None if it is none of BigDataViewer, a `FileError` if it is damaged."""
    with path.open("rb") as file:
        text = file.read(MAX_XML_BYTES + 1)
    if b"<SpimData" not in text:
        return None
    if len(text) > MAX_XML_BYTES:
        raise FileError(f"the XML is larger than {MAX_XML_BYTES >> 20} MiB, which none of BigDataViewer is: {path}")
    if b"<!DOCTYPE" in text or b"\0" in text:  # entities could grow without bound
        raise FileError(f"the XML has a document type, which BigDataViewer's has not; export it again: {path}")
    try:
        return _spim_data(ET.fromstring(text))  # noqa: S314 - see above
    except (ET.ParseError, ValueError, OverflowError) as error:
        raise FileError(f"damaged: the XML of BigDataViewer says {error}; copy or export it again: {path}") from error


def _spim_data(root: ET.Element) -> SpimData:
    sequence = root.find("SequenceDescription")
    loader = None if sequence is None else sequence.find("ImageLoader")
    if sequence is None or loader is None:
        raise ValueError("nothing of its images")
    views = [(_whole(view, "timepoint"), _whole(view, "setup")) for view in sequence.iter("MissingView")]
    return SpimData(
        loader.get("format", ""),
        _path_of_samples(root, loader),
        _setups(sequence),
        _times(sequence.find("Timepoints")),
        {
            (_whole(view, "timepoint"), _whole(view, "setup")): _registration(view)
            for view in root.iterfind("ViewRegistrations/ViewRegistration")
        },
        frozenset(views),
    )


def _path_of_samples(root: ET.Element, loader: ET.Element) -> str:
    named = next((loader.find(name) for name in ("hdf5", "n5", "zarr") if loader.find(name) is not None), None)
    if named is None:
        return ""
    name = (named.text or "").strip()
    if named.get("type", "relative") != "relative":
        return name
    return (Path((root.findtext("BasePath") or ".").strip()) / name).as_posix()


def _setups(sequence: ET.Element) -> tuple[Setup, ...]:
    names = _names_of_attributes(sequence)
    found = []
    for part in sequence.iterfind("ViewSetups/ViewSetup"):
        size = _floats(part.findtext("voxelSize/size") or "")
        given = {one.tag: (one.text or "").strip() for one in part.findall("attributes/*")}
        attributes = {kind: names.get((kind, value)) or value for kind, value in given.items()}
        found.append(
            Setup(
                int(part.findtext("id") or ""),
                (part.findtext("name") or "").strip(),
                (size[0], size[1], size[2]) if len(size) == 3 and all(step > 0 for step in size) else None,
                units.canonical(part.findtext("voxelSize/unit")),
                attributes,
            )
        )
    if len({one.number for one in found}) != len(found) or not found:
        raise ValueError("no setups, or two of one number")
    return tuple(sorted(found, key=lambda one: one.number))


def _names_of_attributes(sequence: ET.Element) -> dict[tuple[str, str], str]:
    """(kind, number) of attributes -> their names, such as ("channel", "0") -> "DAPI"."""
    found = {}
    for group in sequence.iterfind("ViewSetups/Attributes"):
        for part in group:
            number, name = (part.findtext("id") or "").strip(), (part.findtext("name") or "").strip()
            if name:
                found[(group.get("name", ""), number)] = name
    return found


def _times(part: ET.Element | None) -> tuple[int, ...]:
    """Numbers of the time points: a range, a list, or a pattern such as "0-9:3, 12"."""
    if part is None:
        return (0,)
    kind = part.get("type", "range")
    if kind == "range":
        numbers: Iterable[int] = range(int(part.findtext("first") or "0"), int(part.findtext("last") or "0") + 1)
    elif kind == "pattern":
        numbers = _of_pattern(part.findtext("integerpattern") or "")
    else:
        numbers = sorted(int(one.findtext("id") or "") for one in part.iter("Timepoint"))
    times = tuple(dict.fromkeys(number for number, _ in zip(numbers, range(MAX_TIMES + 1), strict=False)))
    if not 1 <= len(times) <= MAX_TIMES:
        raise ValueError("no time points, or too many")
    return times


def _of_pattern(text: str) -> Iterator[int]:
    for part in filter(None, (one.strip() for one in text.split(","))):
        ends, _, step = part.partition(":")
        first, _, last = ends.partition("-")
        yield from range(int(first), int(last or first) + 1, int(step or "1"))


def _registration(view: ET.Element) -> NDArray[np.float64]:
    matrix = np.eye(4)
    for part in view.iterfind("ViewTransform/affine"):
        numbers = _floats(part.text or "")
        if len(numbers) != 12:
            raise ValueError(f"an affine of {len(numbers)} numbers, not 12")
        matrix = matrix @ np.vstack([np.reshape(numbers, (3, 4)), (0.0, 0.0, 0.0, 1.0)])
    if not (np.isfinite(matrix).all() and np.linalg.det(matrix) != 0):
        raise ValueError("an affine that cannot be inverted")
    return matrix


def _floats(text: str) -> list[float]:
    return [float(number) for number in text.split()]


def _whole(element: ET.Element, name: str) -> int:
    return int(element.get(name, ""))


# BigDataViewer: an XML with places, and an HDF5 file or a folder of N5 with an array for each time, setup and level.

#: XML files that are looked into beside samples, at most.
MAX_BESIDE = 50
#: Levels of an image, at most.
MAX_LEVELS = 64
#: Relative difference of lengths that is no other scale: registrations of several views stretch a little.
SAME_SCALE = 0.1
#: Relative difference up to which lengths are the same but for rounding.
ROUNDING = 1e-4


def levels(request: Request) -> Levels:
    """A setup of BigDataViewer's at one time."""
    with _opened(request) as (samples, data):
        return samples.levels(_described(samples, data, request))


@contextmanager
def _opened(request: Request) -> Iterator[tuple[Samples, SpimData | None]]:
    """The samples of a request, which names them or their XML, and the content of the XML; None where there is none."""
    path = request.file
    if path.suffix.lower() != ".xml":
        data = _beside(path, request)
    else:
        data = parsed(path)
        if data is None:
            raise FileError(f"the XML is none of BigDataViewer (SpimData); name the image that it belongs to: {path}")
        path = _samples_of(data, request)
    if path.is_dir():
        yield N5Samples(path, request), data
        return
    with read_hdf5(path) as file:
        yield Hdf5Samples(file, request), data


class Samples(Protocol):
    """Arrays of BigDataViewer in HDF5 or N5, by name; a view (time point, setup) has one array for each level."""

    path: Path

    def setups(self) -> list[int]:
        """Numbers of the setups that are there."""

    def times(self) -> list[int]:
        """Numbers of the time points that are there."""

    def factors(self, setup: int) -> Any:
        """Samples of the finest level, along x, y, z, for one of each level; None where nothing says so."""

    def name(self, view: tuple[int, int], level: int) -> str:
        """The array of a view (time point, setup) at a level."""

    def shape(self, name: str) -> tuple[int, int, int]:
        """Shape (z, y, x) of an array of samples; a `FileError` if it is none."""

    def is_unsigned(self, setup: int, name: str) -> bool:
        """Whether int16 stands for uint16."""

    def levels(self, image: StoredImage) -> Levels:
        """The arrays of all levels of the image."""


class Hdf5Samples:
    """Samples in an HDF5 file that is open."""

    def __init__(self, file: h5py.File, request: Request) -> None:
        self.path = Path(file.filename)
        self._file, self._request = file, request

    def setups(self) -> list[int]:
        """Numbers of the setups in the file."""
        return numbered(self._file["/"], "s")

    def times(self) -> list[int]:
        """Numbers of the time points in the file."""
        return numbered(self._file["/"], "t")

    def factors(self, setup: int) -> Any:
        """Samples of the finest level, along x, y, z, for one of each level; None where the file does not say."""
        found = member_at(self._file, f"s{setup:02d}/resolutions", self._request)
        is_table = found is not None and getattr(found, "size", 0) <= 3 * MAX_LEVELS
        return found[...] if is_table else None

    def name(self, view: tuple[int, int], level: int) -> str:
        """The dataset of a view (time point, setup) at a level."""
        return f"t{view[0]:05d}/s{view[1]:02d}/{level}/cells"

    def shape(self, name: str) -> tuple[int, int, int]:
        """Shape (z, y, x) of a dataset of samples."""
        z, y, x = (int(n) for n in checked_dataset(self._file, name, self._request).shape)
        return z, y, x

    def is_unsigned(self, setup: int, name: str) -> bool:
        """Whether int16 stands for uint16: so it is unless the setup names another type."""
        declared = self._file[f"s{setup:02d}"].attrs.get("dataType", b"")
        declared = declared.decode("ascii", "replace") if isinstance(declared, bytes) else str(declared)
        return bool(self._file[name].dtype == np.int16) and declared != "int16"

    def levels(self, image: StoredImage) -> Levels:
        """The arrays of all levels of the image."""
        return levels_of(self._file, image, self._request)


def _samples_of(data: SpimData, request: Request) -> Path:
    """The HDF5 file or the folder of N5 that an XML names; an error for other formats."""
    if data.format not in ("bdv.hdf5", "bdv.n5"):
        raise FileError(_other_format(data, request))
    is_folder = data.format == "bdv.n5"
    check_named_file(
        data.samples, request.file, anywhere=request.external_files, within=request.within, is_folder=is_folder
    )
    path = request.file.parent / data.samples
    if not (path.is_dir() if is_folder else path.is_file()):
        what = "folder" if is_folder else "file"
        raise FileError(
            f"the samples are not there ({data.samples!r}); put their {what} beside the XML: {request.path}"
        )
    return path


def _other_format(data: SpimData, request: Request) -> str:
    if "zarr" in data.format:
        what, way = "OME-Zarr", f"name one of the images in it ({data.samples or 'the .zarr beside it'})"
    else:
        what, way = f"another form ({data.format[:40] or 'without a name'})", OF_N5
    return f"the samples of this XML are in {what}; {way}: {request.path}"


def _beside(path: Path, request: Request) -> SpimData | None:
    """The content of the XML beside samples: of the same name, else one that names them."""
    own = path.with_suffix(".xml")
    others = sorted(one for one in path.parent.glob("*.xml") if one != own)[:MAX_BESIDE]
    for xml in (own, *others):
        if not xml.is_file():
            continue
        check_within(xml, request.within)
        try:
            data = parsed(xml)
        except FileError:
            if xml == own:
                raise
            continue
        if data is not None and (xml == own or (xml.parent / data.samples).resolve() == path.resolve()):
            return data
    return None


def _described(samples: Samples, data: SpimData | None, request: Request) -> StoredImage:
    """Levels, place and facts of the setup and time that are asked for."""
    setups = data.setups if data else tuple(Setup(number) for number in samples.setups())
    times = data.times if data else tuple(samples.times())
    channels = [Channel(name) for name in _names(setups)]
    time = choose("time", len(times), request.time, request.safe_path)
    number = choose(
        "channel", len(setups), request.channel, request.safe_path, described=[one.name for one in channels]
    )
    setup, view = setups[number], (times[time], setups[number].number)
    if data is not None and view in data.missing:
        raise FileError(f"the view of time {time} and channel {number} is missing, as the XML says: {request.path}")
    factors = _factors(samples, setup, request)
    names = [samples.name(view, level) for level in range(len(factors))]
    shapes = [samples.shape(name) for name in names]
    finest, guesses = _place(data, setup, view)
    unit, factor = units.of_file(setup.unit)
    finest[:3] *= factor
    wanted = level_numbers(len(names), request)
    stored = [StoredLevel(names[k], shapes[k], finest @ _of_blocks(factors[k] / factors[0])) for k in wanted]
    # A single setup without a name may be of anything, electrons too; a channel would stand for a dye.
    is_described = len(channels) > 1 or bool(channels[0].name)
    facts = Facts(
        unit=unit,
        channel=channels[number] if is_described else None,
        channels=tuple(channels) if is_described else (),
        n_times=len(times),
        levels=tuple(shapes) if len(shapes) > 1 else (),
        guesses=(*guesses, *_notes_on_setups(setups)),
    )
    return StoredImage(samples.path, stored, facts, is_unsigned=samples.is_unsigned(setup.number, names[0]))


def _factors(samples: Samples, setup: Setup, request: Request) -> NDArray[np.float64]:
    """Samples of the finest level, along x, y, z, for one of each level."""
    found = samples.factors(setup.number)
    try:
        factors = np.asarray([] if found is None else found, np.float64)
    except (TypeError, ValueError):
        factors = np.zeros(0)
    is_table = factors.ndim == 2 and factors.shape[1] == 3 and len(factors) <= MAX_LEVELS
    if not is_table or not (np.isfinite(factors).all() and (factors > 0).all()):
        raise FileError(
            f"nothing is said of the levels of setup {setup.number} (resolutions, downsamplingFactors); copy or "
            f"export it again: {request.path}"
        )
    return factors


def _of_blocks(factors: NDArray[np.float64]) -> NDArray[np.float64]:
    """The affine from samples that are means of blocks to the samples in these."""
    matrix = np.diag([*factors, 1.0])
    matrix[:3, 3] = (factors - 1) / 2
    return matrix


def _place(data: SpimData | None, setup: Setup, view: tuple[int, int]) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """The affine of a view's finest level, in the unit of the setup, and guesses."""
    voxel = setup.voxel
    if data is None:
        return np.eye(4), ("distances of samples 1, 1, 1: BigDataViewer's .xml is not beside the file",)
    if setup.unit is None and voxel == (1.0, 1.0, 1.0):
        voxel = None  # what programs write for images without a scale
    matrix = data.registrations.get(view)
    if matrix is None:
        if voxel is None:
            return np.eye(4), ("distances of samples 1, 1, 1: the XML has none",)
        return np.diag([*voxel, 1.0]), ()
    if voxel is None:
        return matrix.copy(), ("distances of samples by the registration of the view: the XML has no voxelSize",)
    scale = _scale_of_registrations(data)
    if scale is None:
        steps = " x ".join(f"{step:.4g}" for step in np.linalg.norm(matrix[:3, :3], axis=0))
        text = " x ".join(f"{step:.4g}" for step in voxel)
        return matrix.copy(), (f"distances of samples {steps} by the registration of the view: voxelSize says {text}",)
    if scale == 1:
        return matrix.copy(), ()
    scaled = matrix.copy()
    scaled[:3] *= scale
    text = f"{scale:.6g} {setup.unit or 'of voxelSize'}".rstrip()
    return scaled, (f"registrations taken for numbers of {text}: so they fit to voxelSize",)


def _scale_of_registrations(data: SpimData) -> float | None:
    """Lengths of voxelSize in a unit of the registrations, by the first view that has both; None if they do not fit.

    One scale for all views, so that these stay where they are beside each other. Fiji writes registrations in the unit
    of voxelSize; BigStitcher in the smallest distance of samples.
    """
    voxels = {setup.number: setup.voxel for setup in data.setups}
    for (_, number), matrix in sorted(data.registrations.items(), key=lambda item: item[0]):
        voxel = voxels.get(number)
        if voxel is None:
            continue
        ratios = np.array(voxel) / np.linalg.norm(matrix[:3, :3], axis=0)
        if np.ptp(ratios) > SAME_SCALE * ratios.min():
            return None
        scale = float(np.exp(np.log(ratios).mean()))
        # The smallest distance itself, where it is one, without the last digits of a mean.
        scale = min(voxel) if abs(scale / min(voxel) - 1) < ROUNDING else scale
        return 1.0 if abs(scale - 1) < SAME_SCALE else scale
    return None


def _names(setups: tuple[Setup, ...]) -> list[str]:
    """Names of setups: by the attributes that distinguish them, else their own."""
    varying = _varying(setups)
    if varying == ["channel"]:
        return [_named("channel", setup.attributes.get("channel", "")) for setup in setups]
    if varying:
        parts = [[_named(kind, setup.attributes.get(kind, "")) for kind in varying] for setup in setups]
        return [", ".join(filter(None, one)) for one in parts]
    return [setup.name for setup in setups]


def _named(kind: str, value: str) -> str:
    """A value of an attribute for people: its own name, or "tile 3"."""
    is_number = value.replace(".", "", 1).isdigit()
    return f"{kind} {value}" if is_number else value


def _varying(setups: tuple[Setup, ...]) -> list[str]:
    """Kinds of attributes that are not the same for all setups."""
    kinds = dict.fromkeys(kind for setup in setups for kind in setup.attributes)
    return [kind for kind in kinds if len({setup.attributes.get(kind) for setup in setups}) > 1]


def _notes_on_setups(setups: tuple[Setup, ...]) -> tuple[str, ...]:
    """A guess where setups are no channels: they are drawn as such."""
    others: list[Any] = [kind for kind in _varying(setups) if kind != "channel"]
    if not others:
        return ()
    return (f"{len(setups)} setups, which differ in {', '.join(others)}, are channels, each at its registered place",)
