"""NumPy's own files: .npy, and .npz with one or more named arrays; spacing 1, since they have none."""

from __future__ import annotations

import struct
import zipfile
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import size_checks
from wavesplat._files.bounded_file import BoundedFile
from wavesplat._files.npz import check_members, npy_header
from wavesplat._files.reading import reading
from wavesplat._model.facts import Facts, quantity_of
from wavesplat._readers.components import (
    N_COMPONENTS,
    check_vectors,
    component_of,
    has_vectors,
    quantity_of_array,
)
from wavesplat._readers.file_contents import MAX_BYTES, Contents, FileArray, ranges_of
from wavesplat._readers.request import (
    Grid,
    Request,
    index_unnamed_axes,
    n_times_of,
    no_such_name,
    one_volume_of,
    several,
    unwarned,
)
from wavesplat.errors import ArgumentError, FileError

__all__ = ["contents", "read", "stored_member"]

#: A member of a zip file begins with a header of 30 bytes, whose lengths of name and extra field are at byte 26; these
#: follow it (PKWARE's APPNOTE.TXT, 4.3.7).
MEMBER_HEADER_BYTES, NAME_LENGTH_AT = 30, 26


def read(request: Request) -> Grid:
    """The array in a .npy or .npz file."""
    path = request.file
    with reading("a NumPy file", path), unwarned("numpy"):
        name, array = _from_npz(request) if zipfile.is_zipfile(path) else (None, _from_npy(request))
        if has_vectors(array.shape, array.dtype, request):
            samples, guesses = component_of(array, request, name or path.name)
            quantity = quantity_of_array(name or "", N_COMPONENTS, array.dtype, request)
            return Grid(np.array(samples), np.eye(4), Facts(quantity=quantity, guesses=guesses))
        check_vectors(request, name or path.name)
        samples = array[index_unnamed_axes(array.shape, request)]
        samples = np.array(samples) if isinstance(array, np.memmap) else samples
        return Grid(samples, np.eye(4), Facts(quantity=quantity_of(name), n_times=n_times_of(array.shape, request)))


def contents(request: Request) -> Contents | None:
    """All arrays of a .npz file; None for a .npy file, whose only array has no name."""
    if not zipfile.is_zipfile(request.file):
        return None
    with reading("a NumPy file", request.file), unwarned("numpy"), zipfile.ZipFile(request.file) as archive:
        found = []
        for name in _names(archive):
            with archive.open(f"{name}.npy") as member:
                shape, dtype = npy_header(member)
            looked_at = dtype.kind in "biuf" and size_checks.n_bytes(shape, dtype) <= MAX_BYTES
            array = _from_npz(replace(request, dataset=name))[1] if looked_at else None
            are_vectors = has_vectors(shape, dtype, replace(request, channel=None, time=None))
            ranges = () if array is None else ranges_of(array, has_components=are_vectors)
            n = N_COMPONENTS if are_vectors else 1
            own = shape[:-1] if are_vectors else shape
            found.append(FileArray(name, str(dtype.newbyteorder("=")), own, n, None, ranges))
        return Contents(tuple(found))


def _from_npy(request: Request) -> NDArray[Any]:
    path = request.file
    if request.dataset is not None:
        raise ArgumentError(f"dataset= has no meaning for a .npy file, which holds one array; leave it out: {path}")
    with BoundedFile(path) as file:
        shape, dtype = npy_header(file)
        size_checks.check_stored(
            shape, dtype, path.stat().st_size - file.tell(), path, held=one_volume_of(shape, request)
        )
    # Mapped, so that of several time points or channels only the one that is asked for is read.
    array: NDArray[Any] = np.load(path, "r" if len(shape) > 3 else None, allow_pickle=False)
    return array


def _from_npz(request: Request) -> tuple[str, NDArray[Any]]:
    path = request.file
    with zipfile.ZipFile(path) as archive:
        name = _chosen(_names(archive), request)
        check_members(archive, [f"{name}.npy"], path)
    with np.load(path, allow_pickle=False) as arrays:
        array: NDArray[Any] = arrays[name]
    return name, array


def stored_member(request: Request) -> tuple[str, int, int]:
    """Name of an array in a .npz file that is not compressed, where its .npy file begins in it, and its bytes.

    Raises
    ------
    FileError
        If the array is compressed.
    """
    path = request.file
    with zipfile.ZipFile(path) as archive:
        name = _chosen(_names(archive), request)
        member = archive.getinfo(f"{name}.npy")
        if member.compress_type != zipfile.ZIP_STORED:
            raise FileError(
                f"array {name!r} is compressed, so parts of it cannot be read; write it by numpy.savez or numpy.save: "
                f"{path}"
            )
        with archive.open(member):  # raises an error where the member's own header is damaged
            pass
    with path.open("rb") as file:
        file.seek(member.header_offset + NAME_LENGTH_AT)
        n_name, n_extra = struct.unpack("<HH", file.read(4))
    return name, member.header_offset + MEMBER_HEADER_BYTES + n_name + n_extra, member.file_size


def _names(archive: zipfile.ZipFile) -> list[str]:
    return [name.removesuffix(".npy") for name in archive.namelist() if name.endswith(".npy")]


def _chosen(names: list[str], request: Request) -> str:
    if request.dataset is not None:
        if request.dataset not in names:
            raise no_such_name("array", request.dataset, names, request)
        return request.dataset
    if len(names) != 1:
        listed = ", ".join(names) or "none"
        message = f"the file holds {len(names)} arrays ({listed}); choose one with dataset= (--dataset): {request.path}"
        raise several(message, "dataset", names)
    return names[0]
