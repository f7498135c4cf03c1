"""HDF5 datasets: the place of their samples, and the files that hold them.

Where a relative name starts depends on the kind (external storage: the working folder; virtual sources: the folder of
the file, then the working folder), on the library's version and on the environment, so all places where a file could be
are looked at.
Sources: https://support.hdfgroup.org/documentation, H5Pset_external, H5Pset_virtual_prefix.
"""

from __future__ import annotations

import os
import weakref
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import units
from wavesplat._model.volume.facts import Facts
from wavesplat._storage.file_states import StoredFiles
from wavesplat._storage.paths import refused
from wavesplat._system.memory import check_room
from wavesplat.errors import FileError

if TYPE_CHECKING:
    import h5py

# Place of an HDF5 dataset's samples: by `element_size_um`, or as a mesh of openPMD; HDF5 itself defines none.
#
# openPMD: the attributes axisLabels, gridSpacing, gridGlobalOffset and gridUnitSI of a mesh, whose components may be
# datasets below it. Source: https://github.com/openPMD/openPMD-standard, STANDARD.md, "Mesh Based Records".


@dataclass(frozen=True)
class Place:
    """Affine, facts, and the numbers of z, y and x among the last three axes of the array."""

    world_from_index: NDArray[np.float64]
    facts: Facts
    zyx: tuple[int, int, int] = (0, 1, 2)


def place_of(dataset: h5py.Dataset) -> Place:
    """The place by the attributes of a dataset, or of the mesh it is a component of; the identity without any."""
    sizes = dataset.attrs.get("element_size_um")
    if sizes is not None and np.size(sizes) == 3:
        z, y, x = (float(size) for size in np.ravel(sizes))
        return Place(_diagonal((x, y, z)), Facts(unit="um"))
    mesh = next((node for node in (dataset, dataset.parent) if "gridSpacing" in node.attrs), None)
    if mesh is not None and np.size(mesh.attrs["gridSpacing"]) == 3 and np.size(mesh.attrs.get("axisLabels", ())) == 3:
        return _of_mesh(mesh, dataset)
    return Place(np.eye(4), Facts())


def _of_mesh(mesh: Any, component: h5py.Dataset) -> Place:
    labels = [text(label) for label in np.ravel(mesh.attrs["axisLabels"])]
    spacing = np.ravel(mesh.attrs["gridSpacing"]).astype(np.float64)
    offset = numbers(mesh, "gridGlobalOffset", np.zeros(3)) + numbers(component, "position", np.zeros(3)) * spacing
    if text(mesh.attrs.get("dataOrder", "C")).upper() == "F":
        # Their first axis is the fastest: in the array it is the last one.
        labels, spacing, offset = labels[::-1], spacing[::-1], offset[::-1]
    guesses: tuple[str, ...] = ()
    if sorted(labels) != ["x", "y", "z"]:
        guesses = (f"axes {', '.join(labels)} drawn as z, y, x, in their order in the file",)
        labels = ["z", "y", "x"]
    to_xyz = [labels.index(name) for name in "xyz"]
    unit, factor = best_unit(spacing, float(np.ravel(mesh.attrs.get("gridUnitSI", 1.0))[0]))
    matrix = _diagonal(tuple(spacing[to_xyz] * factor))
    matrix[:3, 3] = offset[to_xyz] * factor
    z, y, x = (labels.index(name) for name in "zyx")
    return Place(matrix, Facts(unit=unit, guesses=guesses), (z, y, x))


def best_unit(spacing: NDArray[np.float64], metres: float) -> tuple[str, float]:
    """The largest unit in which the finest spacing is 0.01 or more, and the factor that converts lengths to it."""
    finest = float(np.abs(spacing).min()) * metres
    unit = next((unit for unit in ("m", "mm", "um", "nm") if finest >= 0.01 * (units.metres(unit) or 1.0)), "pm")
    return unit, float(f"{metres / (units.metres(unit) or 1.0):.12g}")


def _diagonal(xyz: tuple[float, ...]) -> NDArray[np.float64]:
    """The affine of these steps, unchecked: the volume refuses steps that are zero or not finite."""
    return np.diag([*xyz, 1.0])


def numbers(node: Any, name: str, default: NDArray[np.float64]) -> NDArray[np.float64]:
    """The numbers of an attribute, or `default` where it has not as many."""
    value = np.ravel(node.attrs.get(name, default))
    return value.astype(np.float64) if value.size == default.size else default


def text(value: Any) -> str:
    """An attribute as text."""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


# Files that hold the samples of an HDF5 dataset: its own, files of external storage, and sources of virtual ones.

#: Nesting of virtual datasets whose files are found, at most.
MAX_DEPTH = 8
#: Nesting of virtual datasets that are read, at most. HDF5 calls itself for each and has no limit of its own.
MAX_NESTED = 32
#: Sources that HDF5 opens for one virtual dataset, at most, counted again for each way to them: it closes 80 million a
#: second (x86-64, HDF5 1.14), and 16 sources in each of 12 datasets are 2e13.
MAX_SOURCES = 10_000_000
#: Environment variables that change where other files are looked for.
PREFIXES = ("HDF5_EXTFILE_PREFIX", "HDF5_VDS_PREFIX")


#: Datasets that lazy arrays of this process hold open, and their files, by a number. Without a lock, which a fork could
#: leave locked: single steps of a dict are whole.
_HELD: dict[int, tuple[weakref.ref[Any], StoredFiles]] = {}
_NUMBERS = count()


def open_hdf5(file: str, name: str) -> Any:
    """A dataset of a file, which stays open."""
    dataset = read_hdf5(Path(file))[name]
    _HELD[next(_NUMBERS)] = weakref.ref(dataset), files_of_dataset(dataset)
    return dataset


def read_hdf5(path: Path) -> h5py.File:
    """Open a file to read, in its current state.

    The library shares the data it has read of a file among all handles of this process, also for the sources of virtual
    datasets. So held datasets whose files have changed are closed; reading from them is an error in any case.
    """
    import h5py

    for number, (ref, files) in list(_HELD.items()):
        dataset = ref()
        if dataset is None:
            _HELD.pop(number, None)
        elif files.have_changed() and _HELD.pop(number, None) is not None:
            dataset.file.close()
    return h5py.File(path, "r")


def held_hdf5(path: Path) -> h5py.File:
    """Open a file that holds all of its samples, and stays open: it is closed once it has changed and is read anew."""
    file = read_hdf5(path)
    _HELD[next(_NUMBERS)] = weakref.ref(file), StoredFiles([path])
    return file


def check_links(path: Path, *, external_files: bool = False) -> None:
    """Raise a `FileError` if parts of a file lie in other files, or with these allowed, if HDF5 cannot read a dataset.

    See `check_nesting`.
    """
    import h5py

    def check(name: str, node: Any) -> None:
        if isinstance(node, h5py.Dataset):
            if external_files:
                check_nesting(node, path)
            elif node.external or node.is_virtual:
                raise refused(f"another file as the place of {name!r}", path)
            return
        if external_files:
            return
        if not isinstance(node, h5py.Group):
            return
        for part in node:
            link = node.get(part, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise refused(f"{link.filename!r} as the place of {part!r}", path)

    with read_hdf5(path) as file:
        check("/", file)
        file.visititems(check)


def check_nesting(dataset: h5py.Dataset, path: object) -> None:
    """Raise a `FileError` if sources of a virtual dataset, also in other files, form a circle or are nested too deep.

    HDF5 follows them without a limit: circles end the process, and nested ones can take more than a lifetime. Also a
    `LimitError` if a chunk does not fit into memory, whatever is read of it.
    """
    _Nesting(path).of_dataset(dataset, ())


def is_own_file(dataset: h5py.Dataset) -> bool:
    """Whether the file of an open dataset is open for reading only, and is still the file of its name."""
    file = dataset.file
    try:
        there = Path(file.filename).stat()
        return bool(file.mode == "r") and os.path.samestat(os.fstat(file.id.get_vfd_handle()), there)
    except (OSError, ValueError, TypeError, NotImplementedError, RuntimeError):  # in memory, or removed
        return False


def files_of_dataset(dataset: h5py.Dataset) -> StoredFiles:
    """All files that samples of a dataset lie in."""
    places = _Places()
    places.add(dataset, 0)
    is_moved = any(os.environ.get(name) for name in PREFIXES)
    return StoredFiles(places.files, is_complete=places.is_complete and not is_moved)


class _Nesting:
    """The sources of virtual datasets, and their own sources if these are virtual too."""

    def __init__(self, path: object) -> None:
        self._path = path
        #: File and place in it of a virtual dataset -> datasets that HDF5 opens for it, and how deep they are nested.
        self._found: dict[tuple[str, int], tuple[int, int]] = {}

    def of_dataset(self, dataset: h5py.Dataset, around: tuple[tuple[str, int], ...]) -> tuple[int, int]:
        """Number of datasets that HDF5 opens to read a source of the datasets `around`, and their depth."""
        import h5py

        if not dataset.is_virtual:
            self._check_chunk(dataset)
            return 1, 0
        own = os.path.realpath(dataset.file.filename), h5py.h5o.get_info(dataset.id).addr
        if own in around:
            raise FileError(
                f"the virtual dataset {dataset.name!r} is made of itself, through its sources; write it again, of "
                f"datasets that hold samples: {self._path}"
            )
        if own not in self._found and len(around) < MAX_NESTED:
            sources = Counter((one.file_name, one.dset_name) for one in dataset.virtual_sources())
            each = [(n, *self._of_source(dataset, name, (*around, own))) for name, n in sources.items()]
            depth = 1 + max((depth for _, _, depth in each), default=0)
            self._found[own] = sum(n * n_opened for n, n_opened, _ in each), depth
        n_opened, depth = self._found.get(own, (0, MAX_NESTED))
        if n_opened > MAX_SOURCES or len(around) + depth > MAX_NESTED:
            raise FileError(
                f"the virtual dataset {dataset.name!r} is made of virtual datasets that are nested too deep (at most "
                f"{MAX_NESTED} in each other, and {MAX_SOURCES} sources); write its samples into one: {self._path}"
            )
        return n_opened, depth

    def _of_source(
        self, dataset: h5py.Dataset, source: tuple[str, str], around: tuple[tuple[str, int], ...]
    ) -> tuple[int, int]:
        import h5py

        file_name, inner = source
        if file_name == ".":
            other = dataset.file.get(inner)
            return self.of_dataset(other, around) if isinstance(other, h5py.Dataset) else (1, 0)
        n_opened, depth = 1, 0
        for place in {folder / file_name for folder in (Path(dataset.file.filename).absolute().parent, Path.cwd())}:
            try:
                file = h5py.File(place, "r")
            except OSError:
                continue  # reads as fill values
            with file:
                if isinstance(other := file.get(inner), h5py.Dataset):
                    more, deep = self.of_dataset(other, around)
                    n_opened, depth = n_opened + more, max(depth, deep)
        return n_opened, depth

    def _check_chunk(self, dataset: h5py.Dataset) -> None:
        if not dataset.chunks:
            return
        # A packed chunk is unpacked as a whole, and the room for it grows by doubling.
        needed = prod(map(int, dataset.chunks)) * dataset.dtype.itemsize * (1 if dataset.compression is None else 2)
        shape = " x ".join(map(str, dataset.chunks))
        check_room(needed, f"chunks of {shape} samples", f"store {dataset.name!r} in smaller ones: {self._path}")


class _Places:
    """Files that may hold samples of a dataset, found by following virtual datasets, and whether these are all."""

    def __init__(self) -> None:
        self.files: dict[Path, None] = {}
        self.is_complete = True
        self._followed: set[tuple[Path, str]] = set()

    def add(self, dataset: h5py.Dataset, depth: int) -> None:
        """Add the files of a dataset's samples."""
        own = Path(dataset.file.filename).absolute()
        self.files[own] = None
        folders = {own.parent, Path.cwd()}
        for name, _, _ in dataset.external or ():
            self.files.update((folder / os.fsdecode(name), None) for folder in folders)
        if not dataset.is_virtual:
            return
        for file_name, inner in {(source.file_name, source.dset_name) for source in dataset.virtual_sources()}:
            if "%" in file_name or "%" in inner or depth == MAX_DEPTH:  # a name for each block
                self.is_complete = False
                continue
            for place in [own] if file_name == "." else [folder / file_name for folder in folders]:
                self.files[place] = None
                if (place, inner) in self._followed or not place.is_file():
                    continue
                self._followed.add((place, inner))
                if file_name == ".":
                    self._follow(dataset.file, inner, depth)
                    continue
                # A source that is no HDF5 file reads as fill values until it is one, which its state shows.
                with suppress(OSError), read_hdf5(place) as file:
                    self._follow(file, inner, depth)

    def _follow(self, file: h5py.File, inner: str, depth: int) -> None:
        import h5py

        other = file.get(inner)
        if isinstance(other, h5py.Dataset):
            self.add(other, depth + 1)
