"""TIFF stacks read in parts: by offset in the file where the samples lie in one piece of it, else page by page.

A page is read, and unpacked, when it is asked for.
"""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.file_states import StoredFiles
from wavesplat._model.facts import Facts
from wavesplat._model.lazy_array import SlicedArray
from wavesplat._readers import tiff, tiff_slices
from wavesplat._readers.request import Request, level_numbers, quiet
from wavesplat._readers.stored_samples import stored_samples
from wavesplat._readers.tiff_pages import check_pages
from wavesplat.errors import FileError

__all__ = ["stacks_of"]


def stacks_of(request: Request) -> tuple[list[SlicedArray], list[NDArray[np.float64]], Facts]:
    """The slices of the levels of a TIFF file, the finest first, or of a folder of slices, with places and facts."""
    with quiet("tifffile"):
        if request.file.is_dir():
            array, slices = _of_folder(request)
            return [array], [slices.world_from_index], slices.facts
        levels = tiff.described(request.file, request)
        return [_of_level(one, request) for one in levels], [one.world_from_index for one in levels], levels[0].facts


def _of_level(described: tiff.Described, request: Request) -> SlicedArray:
    path = request.file
    if described.offset is not None:
        return _in_one_piece(path, described, described.offset)
    series_shape, keyframe = described.shape, described.page_shape
    n_of_pages = len(series_shape) - len(keyframe)
    if series_shape[n_of_pages:] != keyframe or n_of_pages == 0:
        raise FileError(f"the slices are no pages of their own; open the file without memory=: {path}")
    pages = np.arange(int(np.prod(series_shape[:n_of_pages]))).reshape(series_shape[:n_of_pages])
    wanted = pages[described.picked[:n_of_pages]]
    inside = described.picked[n_of_pages:]
    if wanted.ndim != 1 or sum(isinstance(part, slice) for part in inside) != 2:
        raise FileError(f"the slices are no pages along z; open the file without memory=: {path}")
    turned = described.order != [0, 1, 2]
    return _stack(
        partial(_FilePages, str(path), described.level, [int(k) for k in wanted.ravel()], inside, turned),
        request,
        (wanted.size, *(n for n, part in zip(keyframe, inside, strict=True) if isinstance(part, slice))),
        described.dtype.newbyteorder("="),
        token=f"TIFF {path} {described.level} {described.picked}",
        files=StoredFiles([path, *described.others]),
        turned=turned,
    )


def _in_one_piece(path: Path, described: tiff.Described, offset: int) -> SlicedArray:
    picked = [None if isinstance(part, slice) else int(part) for part in described.picked]
    kept = [axis for axis, number in enumerate(picked) if number is None]
    z, y, x = (kept[place] for place in described.order)
    return stored_samples(path, described.dtype, offset, described.shape, order=(z, y, x), picked=picked)


def _of_folder(request: Request) -> tuple[SlicedArray, tiff_slices.Slices]:
    level_numbers(1, request)

    slices = tiff_slices.slices_in(request.file, request)
    files, first = slices.files, slices.first
    array = _stack(
        partial(_FolderPages, [str(file) for file in files], request, first.shape, first.dtype),
        request,
        (len(files), *first.shape),
        first.dtype,
        token=f"TIFF folder {request.file} {request.time} {request.channel}",
        files=StoredFiles(files, axis=0),
    )
    return array, slices


def _stack(
    opened: Any,
    request: Request,
    shape: Sequence[int],
    dtype: Any,
    *,
    token: str,
    files: StoredFiles,
    turned: bool = False,
) -> SlicedArray:
    z, y, x = (int(shape[0]), int(shape[2]), int(shape[1])) if turned else (int(n) for n in shape)
    return SlicedArray(
        None,
        name=request.name,
        chunks=(1, y, x),
        opened=opened,
        dtype=np.dtype(dtype),
        shape=(z, y, x),
        n_readers=2,
        token=token,
        files=files,
    )


class _Pages:
    """A stack that is sliced by reading its slices one after the other."""

    def page(self, number: int) -> NDArray[Any]:
        """Read a slice."""
        raise NotImplementedError

    def __getitem__(self, index: tuple[slice, slice, slice]) -> NDArray[Any]:
        zs, ys, xs = index
        return np.stack([self.page(z)[ys, xs] for z in range(zs.start, zs.stop)])


class _FilePages(_Pages):
    """Pages of a file. `inside`: index into a page; `turned`: its axes are x, y."""

    def __init__(self, path: str, level: int, numbers: list[int], inside: Sequence[Any], turned: bool) -> None:
        import tifffile

        self._file = tifffile.TiffFile(path)
        # Closed with these pages, rather than by the garbage collector's warning.
        weakref.finalize(self, self._file.close)
        self._pages = tiff.levels_in(self._file)[level].pages
        self._numbers, self._inside, self._turned = numbers, tuple(inside), turned
        self._lock = Lock()

    def page(self, number: int) -> NDArray[Any]:
        """Read a slice."""
        with self._lock, quiet("tifffile"):
            page: Any = self._pages[self._numbers[number]]
            if page is None:
                raise ValueError(f"page {self._numbers[number]} is not there")
            samples: NDArray[Any] = page.asarray()[self._inside]
        return samples.T if self._turned else samples


class _FolderPages(_Pages):
    """Slices in a file each."""

    def __init__(self, files: list[str], request: Request, shape: tuple[int, ...], dtype: Any) -> None:
        self._files, self._request, self._shape, self._dtype = files, request, shape, dtype

    def page(self, number: int) -> NDArray[Any]:
        """Read a slice."""
        import tifffile

        file = Path(self._files[number])
        check_pages(file)
        with quiet("tifffile"):
            one = tiff_slices.slice_of(tifffile.imread(file), file, self._request)
        if (one.shape, one.dtype) != (self._shape, self._dtype):
            raise ValueError(
                f"slices differ: the first is {self._shape} of {self._dtype}, {file.name} is {one.shape} of {one.dtype}"
            )
        return one
