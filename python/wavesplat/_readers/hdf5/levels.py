"""Images of several levels in HDF5 files, by Imaris and BigDataViewer: a dataset [z, y, x] for each level."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.hdf5 import files_of_dataset, open_hdf5
from wavesplat._model.lazy.array import SlicedArray
from wavesplat._model.volume.facts import Facts
from wavesplat._readers.hdf5.hdf5 import check_places, check_stored, check_way
from wavesplat._readers.levels import Levels
from wavesplat._readers.request import Request
from wavesplat.errors import FileError

if TYPE_CHECKING:
    import h5py


@dataclass(frozen=True)
class StoredLevel:
    """A level of detail: its dataset, the shape (z, y, x) of the samples that count, and its affine."""

    dataset: str
    shape: tuple[int, int, int]
    world_from_index: NDArray[np.float64]


@dataclass(frozen=True)
class StoredImage:
    """Levels of one channel at one time, the finest first, and the facts. `is_unsigned`: int16 stands for uint16."""

    file: Path
    levels: Sequence[StoredLevel]
    facts: Facts
    is_unsigned: bool = False

    def levels_by(self, array_of: Callable[[StoredLevel], SlicedArray]) -> Levels:
        """The levels with their arrays."""
        matrices = [level.world_from_index for level in self.levels]
        return Levels([array_of(level) for level in self.levels], matrices, self.facts)


def member_at(file: h5py.File, name: str, request: Request) -> Any:
    """The group or dataset with a name; None if there is none.

    A `FileError` if the way to it, or to its samples, leaves the file.
    """
    import h5py

    if not request.external_files:
        check_way(file, name, request)
    member = file.get(name)
    if isinstance(member, h5py.Dataset):
        check_places(file, member, request)
    return member


def numbered(group: Any, name: str) -> list[int]:
    """Numbers of the members `name 0`, `name 1`, ... of a group, or `name00`, `name01`, ..., in order."""
    keys = [str(key) for key in group] if hasattr(group, "keys") else []
    parts = [key.removeprefix(name).strip() for key in keys if key.startswith(name)]
    return sorted({int(part) for part in parts if part.isascii() and part.isdigit()})


def checked_dataset(file: h5py.File, name: str, request: Request) -> h5py.Dataset:
    """The dataset of a level; a `FileError` if it is not there, has no three axes, or lies in other files."""
    import h5py

    dataset = member_at(file, name, request)
    if not isinstance(dataset, h5py.Dataset):
        raise FileError(
            f"the samples of this channel, time and level are not there ({name}); copy or export it again, "
            f"with all files that belong to it: {request.safe_path}"
        )
    if dataset.ndim != 3 or dataset.dtype.kind not in "iuf":
        raise FileError(
            f"a level has shape {dataset.shape} and type {dataset.dtype} ({name}), but its samples are numbers "
            f"[z, y, x]; export it again: {request.safe_path}"
        )
    _check_filters(dataset, request)
    return dataset


def _check_filters(dataset: h5py.Dataset, request: Request) -> None:
    """Raise a `FileError` if the samples are packed in a way that HDF5 has no plugin for here."""
    import h5py

    layout = dataset.id.get_create_plist()
    filters = [layout.get_filter(number) for number in range(layout.get_nfilters())]
    missing = [(code, name) for code, _, _, name in filters if not h5py.h5z.filter_avail(code)]
    if missing:
        with suppress(ImportError):
            import_module("hdf5plugin")  # registers its filters
        missing = [(code, name) for code, name in missing if not h5py.h5z.filter_avail(code)]
    for code, name in missing:
        raise FileError(
            f"the samples are packed by filter {code} ({name.decode('latin-1')[:40] or 'without a name'}), which HDF5 "
            f"does not have here; run: pip install hdf5plugin: {request.safe_path}"
        )


def levels_of(file: h5py.File, image: StoredImage, request: Request) -> Levels:
    """All levels of an image."""
    return image.levels_by(lambda level: _array(file, image, level, request))


def _array(file: h5py.File, image: StoredImage, level: StoredLevel, request: Request) -> SlicedArray:
    dataset = file[level.dataset]
    check_stored(dataset, level.shape, image.file, request)
    return SlicedArray(
        None,
        name=request.name,
        chunks=dataset.chunks or (1, *dataset.shape[1:]),
        opened=partial(open_hdf5, str(image.file), level.dataset),
        convert=_as_unsigned if image.is_unsigned else None,
        dtype=np.dtype(np.uint16) if image.is_unsigned else dataset.dtype,
        shape=level.shape,
        n_readers=1,
        token=f"HDF5 {image.file} {level.dataset} {level.shape}",
        files=files_of_dataset(dataset),
    )


def _as_unsigned(samples: NDArray[Any]) -> NDArray[np.uint16]:
    """The samples with the bits of int16 taken for uint16."""
    return samples.astype(np.int16, copy=False).view(np.uint16)
