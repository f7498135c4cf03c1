"""BigDataViewer's samples in N5: a folder with an array for each setup, time point and level, in blocks.

The array of level L is `setup0/timepoint0/sL`, its axes are x, y, z, and `setup0` names `downsamplingFactors`.
Tensorstore reads the blocks: zarr 3 reads no N5.
Sources: https://github.com/saalfeldlab/n5 (the format); `BdvN5Format` of
https://github.com/bigdataviewer/bigdataviewer-core.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from wavesplat._model.lazy.array import SlicedArray
from wavesplat._readers.hdf5.levels import StoredImage, StoredLevel, numbered
from wavesplat._readers.levels import Levels
from wavesplat._readers.request import Request
from wavesplat._storage.file_states import StoredFiles
from wavesplat._system.libraries import library
from wavesplat.errors import FileError

#: Types of numbers.
TYPES = {f"{kind}{bits}" for kind in ("int", "uint") for bits in (8, 16, 32, 64)} | {"float32", "float64"}
#: Largest file of attributes, bytes.
MAX_ATTRIBUTES = 1 << 20


def holds_setups(names: list[str]) -> bool:
    """Whether the names in a folder are names of BigDataViewer's N5."""
    return "attributes.json" in names and any(name.startswith("setup") for name in names)


class N5Samples:
    """Samples in a folder of N5. Arrays are opened when their samples are read."""

    def __init__(self, folder: Path, request: Request) -> None:
        self.path = folder
        self._request = request

    def setups(self) -> list[int]:
        """Numbers of the setups in the folder."""
        return numbered(_members(self.path), "setup")

    def times(self) -> list[int]:
        """Numbers of the time points of the first setup."""
        return numbered(_members(self.path / f"setup{self.setups()[0]}"), "timepoint")

    def factors(self, setup: int) -> Any:
        """Samples of the finest level, along x, y, z, for one of each level; None where the folder does not say."""
        return self._attributes(f"setup{setup}").get("downsamplingFactors")

    def name(self, view: tuple[int, int], level: int) -> str:
        """The array of a view (time point, setup) at a level."""
        return f"setup{view[1]}/timepoint{view[0]}/s{level}"

    def shape(self, name: str) -> tuple[int, int, int]:
        """Shape (z, y, x) of an array of samples."""
        attributes = self._attributes(name)
        size, kind = attributes.get("dimensions"), str(attributes.get("dataType"))
        is_size = isinstance(size, list) and len(size) == 3 and all(type(n) is int and n > 0 for n in size)
        if not isinstance(size, list) or not is_size or kind not in TYPES:
            raise FileError(
                f"a level has dimensions {size} and type {kind[:20]} ({name}), but its samples are numbers of three "
                f"axes; export it again: {self._request.safe_path}"
            )
        x, y, z = size
        return z, y, x

    def is_unsigned(self, setup: int, name: str) -> bool:  # noqa: ARG002 - as HDF5's samples have it
        """False: N5 has unsigned types."""
        return False

    def levels(self, image: StoredImage) -> Levels:
        """The arrays of all levels of the image."""
        return image.levels_by(self._array)

    def _array(self, level: StoredLevel) -> SlicedArray:
        array = _opened(str(self.path), level.dataset)
        return SlicedArray(
            None,
            name=self._request.name,
            chunks=array.chunk_layout.read_chunk.shape,
            opened=partial(_opened, str(self.path), level.dataset),
            dtype=np.dtype(array.dtype.numpy_dtype),
            shape=level.shape,
            token=f"N5 {self.path} {level.dataset} {level.shape}",
            files=StoredFiles(sorted(_files_below(self.path / level.dataset))),
        )

    def _attributes(self, name: str) -> dict[str, Any]:
        path = self.path / name / "attributes.json"
        try:
            if path.stat().st_size > MAX_ATTRIBUTES:
                raise ValueError("attributes.json is larger than any of N5")
            attributes = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise FileError(
                f"the samples of this channel, time and level are not there ({name}); copy or export it again, "
                f"with all files that belong to it: {self._request.safe_path}"
            ) from None
        if not isinstance(attributes, dict):
            raise ValueError("attributes.json is no object")
        return attributes


def _opened(folder: str, name: str) -> Any:
    """The array [z, y, x] of a name."""
    tensorstore = library("tensorstore", extra="n5")
    kvstore = {"driver": "file", "path": str(Path(folder).absolute() / name)}
    try:
        return tensorstore.open({"driver": "n5", "kvstore": kvstore}, open=True, read=True).result().T
    except ValueError as error:
        raise FileError(f"damaged: {_first_sentence(error)}; copy or export it again: {folder}/{name}") from error


def _first_sentence(error: Exception) -> str:
    """The first sentence of tensorstore's message, without its places in the source."""
    return str(error).partition(" [")[0][:200]


def _members(folder: Path) -> dict[str, None]:
    return dict.fromkeys(path.name for path in folder.iterdir())


def _files_below(folder: Path) -> Iterator[Path]:
    for place, _, names in os.walk(folder):
        for name in names:
            yield Path(place) / name
