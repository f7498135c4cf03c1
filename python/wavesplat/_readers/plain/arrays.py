"""NumPy's own files: .npy, and .npz with one or more named arrays; spacing 1, since they have none."""

from __future__ import annotations

import struct
import zipfile
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.lazy.array import SlicedArray, along_zyx
from wavesplat._model.lazy.checks import DEFAULT_SIDE
from wavesplat._model.volume.facts import quantity_of
from wavesplat._readers.components import N_COMPONENTS, has_vectors
from wavesplat._readers.file_contents import MAX_BYTES, Contents, FileArray, ranges_of
from wavesplat._readers.levels import Levels, one_volume, stored_samples
from wavesplat._readers.request import Request, no_such_name, several, unwarned
from wavesplat._storage import size_checks
from wavesplat._storage.reading import BoundedFile, reading
from wavesplat._storage.stored_arrays import check_members, npy_header
from wavesplat.errors import ArgumentError, FileError

#: A member of a zip file begins with a header of 30 bytes, whose lengths of name and extra field are at byte 26; these
#: follow it (PKWARE's APPNOTE.TXT, 4.3.7).
MEMBER_HEADER_BYTES, NAME_LENGTH_AT = 30, 26


@unwarned("numpy")
def levels(request: Request) -> Levels:
    """The array in a .npy or .npz file; of an archive it is read at once, by which its checksum is compared."""
    path = request.file
    name, array, start, n_bytes = None, None, 0, None
    if not zipfile.is_zipfile(path):
        if request.dataset is not None:
            raise ArgumentError(f"dataset= has no meaning for a .npy file, which holds one array; leave it out: {path}")
    elif request.memory is None:
        name, array = _from_npz(request)
    else:
        name, start, n_bytes = _stored_member(request)
    if array is not None:
        found = one_volume(array.shape, array.dtype, request, name or path.name)
        zyx, sides = along_zyx(array.shape, found.order, 1), [DEFAULT_SIDE] * 3
        how: dict[str, Any] = {"order": found.order, "picked": found.picked, "convert": found.convert}
        held = SlicedArray(array, name=path.name, chunks=sides, shape=zyx, dtype=found.made, **how)
        return Levels([held], [np.eye(4)], found.facts(quantity_of(name)))
    with BoundedFile(path) as file:
        file.seek(start)
        shape, is_fortran, dtype = npy_header(file)
        offset = file.tell()
    if n_bytes is not None:
        size_checks.check_stored(shape, dtype, max(start + n_bytes - offset, 0), path, held=(1,))
    found = one_volume(shape, dtype, request, name or path.name)
    if is_fortran:  # the first axis is the fastest
        shape, found = shape[::-1], found.turned()
    stored = stored_samples(path, offset, shape, found)
    return Levels([stored], [np.eye(4)], found.facts(quantity_of(name)))


def contents(request: Request) -> Contents | None:
    """All arrays of a .npz file; None for a .npy file, whose only array has no name."""
    if not zipfile.is_zipfile(request.file):
        return None
    with reading("a NumPy file", request.file), unwarned("numpy"), zipfile.ZipFile(request.file) as archive:
        found = []
        for name in _names(archive):
            with archive.open(f"{name}.npy") as member:
                shape, _, dtype = npy_header(member)
            looked_at = dtype.kind in "biuf" and size_checks.n_bytes(shape, dtype) <= MAX_BYTES
            array = _from_npz(replace(request, dataset=name))[1] if looked_at else None
            are_vectors = has_vectors(shape, dtype, replace(request, channel=None, time=None))
            ranges = () if array is None else ranges_of(array, has_components=are_vectors)
            n = N_COMPONENTS if are_vectors else 1
            own = shape[:-1] if are_vectors else shape
            found.append(FileArray(name, str(dtype.newbyteorder("=")), own, n, None, ranges))
        return Contents(tuple(found))


def _from_npz(request: Request) -> tuple[str, NDArray[Any]]:
    path = request.file
    with zipfile.ZipFile(path) as archive:
        name = _chosen(_names(archive), request)
        check_members(archive, [f"{name}.npy"], path)
    with np.load(path, allow_pickle=False) as arrays:
        array: NDArray[Any] = arrays[name]
    return name, array


def _stored_member(request: Request) -> tuple[str, int, int]:
    """Name of an array in a .npz file, where its .npy file begins in it, and its bytes; it must not be compressed."""
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
