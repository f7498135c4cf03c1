"""Files whose samples are read while they are drawn: from a request to levels of lazy arrays, their places and facts.

Parts can be read of samples that are stored as they are, or in chunks: .npy, raw, uncompressed NIfTI, NRRD and
MetaImage, binary legacy VTK, HDF5, netCDF, TIFF (in one piece, or page by page), Zarr. Samples that are compressed as
one stream have to be unpacked, or stored in chunks, first.
"""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import size_checks
from wavesplat._files.bounded_file import BoundedFile
from wavesplat._files.file_states import SourceFiles, StoredFiles
from wavesplat._files.mute_stderr import muted_stderr
from wavesplat._files.npz import npy_header
from wavesplat._files.reading import reading
from wavesplat._files.zarr_place import place_of
from wavesplat._files.zarr_reading import zarr_reader
from wavesplat._files.zarr_states import chunk_files
from wavesplat._model.facts import Facts, quantity_of
from wavesplat._model.hdf5_files import files_of_dataset, open_hdf5, read_hdf5
from wavesplat._model.lazy_array import LazyArray, SlicedArray
from wavesplat._readers import (
    arrays,
    bdv,
    bioio_files,
    detached_samples,
    hdf5,
    hdf5_vectors,
    imaris,
    itk,
    lazy_tiff,
    netcdf,
    nifti,
    ome_zarr,
    openpmd_records,
    raw,
    vtk_legacy,
)
from wavesplat._readers.components import as_channel, check_vectors, facts_of_colors, named_component, quantity_of_array
from wavesplat._readers.hdf5_levels import StoredImage, lazy_levels_of
from wavesplat._readers.request import Request, index_unnamed_axes, n_times_of, quiet
from wavesplat._readers.stored_samples import stored_samples
from wavesplat.errors import ArgumentError, FileError

__all__ = ["LazyGrid", "lazy_grid", "n_stored_bytes"]

Matrix = NDArray[np.float64]

INSTEAD = "store the samples in chunks, as a Zarr array"


@dataclass(frozen=True)
class LazyGrid:
    """Levels, the finest first, their affines from index (x, y, z) to the world, and the file's facts."""

    levels: list[LazyArray]
    world_from_index: list[Matrix]
    facts: Facts = field(default_factory=Facts)


def lazy_grid(request: Request, family: str) -> LazyGrid:
    """The levels in a file of a family of formats."""
    read = READERS.get(family)
    if read is None:
        raise ArgumentError(
            f"of this kind of file ({family}) parts cannot be read; open it without memory=, or {INSTEAD}: "
            f"{request.safe_path}"
        )
    # The file that was described must be the one whose state was taken meanwhile.
    before = None if request.is_url or request.file.is_dir() else StoredFiles([request.file])
    with reading(NAMES.get(family, family), request.safe_path):
        grid = read(request)
    if before is not None:
        before.look_again()
    return grid


def _one_stream(path: object, what: str) -> FileError:
    return FileError(
        f"the samples are compressed as one stream ({what}), so parts of them cannot be read; unpack the file "
        f"(gunzip), {INSTEAD}, or open it without memory=: {path}"
    )


def _unnamed(shape: Sequence[int], request: Request) -> tuple[tuple[int, int, int], list[int | None]]:
    """The axes z, y, x of an array whose axes have no names, and the index along each of the others."""
    index = index_unnamed_axes(shape, request)
    at = index.index(...)
    picked: list[int | None] = [*index[:at], *[None] * (len(shape) - len(index) + 1), *index[at + 1 :]]
    z, y, x = (axis for axis, one in enumerate(picked) if one is None)
    return (z, y, x), picked


def _of_npy(request: Request) -> LazyGrid:
    path = request.file
    name, start, n_bytes = arrays.stored_member(request) if zipfile.is_zipfile(path) else (None, 0, None)
    with BoundedFile(path) as file:
        file.seek(start)
        shape, dtype = npy_header(file)
        file.seek(start)
        version = np.lib.format.read_magic(file)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        _, is_fortran, _ = read(file)
        offset = file.tell()
    if n_bytes is not None:
        size_checks.check_stored(shape, dtype, max(start + n_bytes - offset, 0), path, held=(1,))
    quantity = named_component(quantity_of(name), request)
    request = as_channel(shape, dtype, request)
    check_vectors(request, name or path.name)
    order, picked = _unnamed(shape, request)
    if is_fortran:
        # The first axis is the fastest: the same array with its axes the other way round.
        last = len(shape) - 1
        order, picked = (last - order[0], last - order[1], last - order[2]), picked[::-1]
    array = stored_samples(path, dtype, offset, shape[::-1] if is_fortran else shape, order=order, picked=picked)
    return LazyGrid([array], [np.eye(4)], Facts(quantity=quantity, n_times=n_times_of(shape, request)))


def _of_raw(request: Request) -> LazyGrid:
    shape, dtype = raw.checked_shape(request), raw.checked_dtype(request)
    path = request.file
    size_checks.check_readable(path)
    raw.check_size(path, shape, dtype, request.offset, held=(1,))
    order, picked = _unnamed(shape, request)
    array = stored_samples(path, dtype, request.offset, shape, order=order, picked=picked)
    return LazyGrid([array], [np.eye(4)], Facts(n_times=n_times_of(shape, request)))


def _of_nifti(request: Request) -> LazyGrid:
    with quiet("nibabel.global"):
        image = nifti.loaded(request)
    proxy = image.dataobj
    file = proxy.file_like
    path = request.file if not isinstance(file, str) else Path(file)
    if path.name.lower().endswith((".gz", ".mgz")):
        raise _one_stream(request.path, "gzip")
    if request.component is not None:
        raise ArgumentError(
            "component= is for NIfTI that is read as a whole; choose one of several numbers with time= or channel=, "
            f"or leave out memory=: {request.safe_path}"
        )
    time, channel, colour = nifti.checked_picks(image, request)
    if colour is not None:
        raise FileError(f"the samples are colours; open the file without memory=: {request.safe_path}")
    # The first axis is the fastest: in the file it is the last one.
    n_axes = len(image.shape)
    picked: list[int | None] = [None, None, None, time, channel, 0, 0][:n_axes][::-1]
    slope, intercept = float(proxy.slope), float(proxy.inter)
    convert = made = None
    if (slope, intercept) != (1.0, 0.0):
        made = _type_of_scaled(proxy.dtype, slope, intercept)
        convert = partial(_scaled, slope=slope, intercept=intercept, dtype=made)
    array = stored_samples(
        path,
        proxy.dtype,
        nifti.first_sample(image),
        image.shape[::-1],
        order=(n_axes - 3, n_axes - 2, n_axes - 1),
        picked=picked,
        convert=convert,
        made=made,
    )
    return LazyGrid([array], [nifti.world_from_index(image)], nifti.facts_of(image))


def _type_of_scaled(stored: np.dtype[Any], slope: float, intercept: float) -> np.dtype[Any]:
    """The type of scaled samples, by the range of their stored type: their own range is not known."""
    if stored.kind in "iu" and slope.is_integer() and intercept.is_integer():
        limits = np.iinfo(stored)
        ends = [int(end) * int(slope) + int(intercept) for end in (limits.min, limits.max)]
        for dtype in (np.int16, np.int32):
            if np.iinfo(dtype).min <= min(ends) and max(ends) <= np.iinfo(dtype).max:
                return np.dtype(dtype)
    return np.dtype(np.float64 if stored.itemsize > 4 else np.float32)


def _scaled(stored: NDArray[Any], *, slope: float, intercept: float, dtype: np.dtype[Any]) -> NDArray[Any]:
    if dtype.kind == "i":
        return (stored.astype(np.int64) * int(slope) + int(intercept)).astype(dtype)
    return (stored * np.float64(slope) + intercept).astype(dtype)


def _of_itk(request: Request) -> LazyGrid:
    path = request.file
    header = itk.header_of(path)
    fields = header.fields
    packed = fields.get("compresseddata", "").lower().startswith(("t", "1"))
    encoding = fields.get("encoding", "raw").lower()
    if packed or encoding in ("gzip", "gz", "bzip2", "bz2"):
        raise _one_stream(path, "zlib" if packed else encoding)
    if encoding != "raw" or fields.get("binarydata", "true").lower()[:1] not in ("t", "1"):
        raise FileError(f"the samples are written as text; open the file without memory=: {path}")
    places = detached_samples.places_of_samples(path, anywhere=request.external_files, within=request.within)
    if len(places) != 1:
        raise FileError(f"the samples are in {len(places)} files; open the header without memory=: {path}")
    file, offset = places[0]
    sitk = itk.simple_itk()
    with muted_stderr(), itk.for_itk(path, header, places) as seen:
        reader = sitk.ImageFileReader()
        reader.SetFileName(str(seen))
        reader.ReadImageInformation()
        size, n_components = reader.GetSize(), reader.GetNumberOfComponents()
        dtype = np.dtype(itk.dtype_of(sitk, reader.GetPixelID()))
        matrix = itk.world_from_index_of(reader, header)
    if len(size) != 3 or n_components != 1:
        raise FileError(f"the file holds several times or channels; open it without memory=: {path}")
    byte_order = fields.get("binarydatabyteordermsb", fields.get("elementbyteordermsb", "f")).lower()
    is_big = fields.get("endian", "little").lower() == "big" or byte_order[:1] in ("t", "1")
    offset = _first_sample(file, offset, fields, size_checks.n_bytes(size, dtype))
    stored = dtype.newbyteorder(">" if is_big else "<")
    array = stored_samples(file, stored, offset, size[::-1], order=(0, 1, 2), picked=[None] * 3)
    return LazyGrid([array], [matrix], header.facts)


def _first_sample(file: Path, offset: int, fields: dict[str, str], n_bytes: int) -> int:
    """Bytes before the first sample in a file, of which `offset` are a header; what NRRD and MetaImage skip is added.

    NRRD skips lines first, then bytes: https://teem.sourceforge.net/nrrd/format.html#lineskip. -1 stands for as many
    bytes as leave the samples at the end of the file. MetaImage counts from the start of the file.
    """
    meta_skip = int(fields.get("headersize", 0))
    if meta_skip > 0:
        return meta_skip
    skip = int(fields.get("byte skip", fields.get("byteskip", meta_skip)))
    if skip == -1:
        return file.stat().st_size - n_bytes
    with file.open("rb") as stream:
        stream.seek(offset)
        for _ in range(int(fields.get("line skip", fields.get("lineskip", 0)))):
            stream.readline()
        return stream.tell() + skip


def _of_vtk_legacy(request: Request) -> LazyGrid:
    found = vtk_legacy.chosen_array(request)
    stored = found.stored
    if stored.is_text or stored.is_bits:
        written = "text" if stored.is_text else "bits"
        raise FileError(f"the samples are written as {written}; open the file without memory=: {request.safe_path}")
    picked = [None, None, None, found.channel]
    array = stored_samples(request.file, stored.dtype, stored.begin, found.shape, order=(0, 1, 2), picked=picked)
    quantity = quantity_of_array(stored.name, stored.n_components, stored.dtype, request)
    colors = facts_of_colors(stored.n_components, np.dtype(stored.dtype), request)
    facts = Facts(quantity=quantity, guesses=found.guesses, **colors)
    return LazyGrid([array], [found.world_from_index], facts)


def _of_hdf5(request: Request) -> LazyGrid:
    if request.resample is not None:
        raise ArgumentError(f"resample= reads all samples; leave out memory=: {request.path}")
    with read_hdf5(request.file) as file:
        request = openpmd_records.with_record(file, request)
        if parts := hdf5_vectors.components_of_record(file, request):
            name = parts.get(request.component or "")
            if name is None:
                raise ArgumentError(
                    f'{request.dataset!r} holds vectors; with memory= choose one component, as component="x" '
                    f"(--component x), or leave out memory=: {request.path}"
                )
            hdf5_vectors.check_varies(name, request)
            request = replace(request, dataset=str(name), component=None)
        dataset = hdf5.chosen_dataset(file, request)
        if not (dataset.external or dataset.is_virtual):
            stored = max(dataset.id.get_storage_size(), request.file.stat().st_size)
            one = sorted(dataset.shape)[-3:]
            size_checks.check_stored(one, dataset.dtype, stored, request.path, ratio=size_checks.ANY_RATIO, held=(1,))
        place = hdf5.place_of(dataset)
        component = request.component
        request = as_channel(dataset.shape, dataset.dtype, request)
        order, picked = _unnamed(dataset.shape, request)
        zyx = (order[place.zyx[0]], order[place.zyx[1]], order[place.zyx[2]])
        chunks = dataset.chunks or [1] * (len(dataset.shape) - 2) + list(dataset.shape[-2:])
        array = SlicedArray(
            None,
            name=request.name,
            chunks=[chunks[axis] for axis in zyx],
            order=zyx,
            picked=picked,
            opened=partial(open_hdf5, str(request.file), str(dataset.name)),
            dtype=dataset.dtype,
            shape=(dataset.shape[zyx[0]], dataset.shape[zyx[1]], dataset.shape[zyx[2]]),
            n_readers=1,
            token=f"HDF5 {request.file} {dataset.name}",
            files=files_of_dataset(dataset),
            reads_parts=dataset.chunks is None,
        )
        facts = replace(
            hdf5.facts_of(file, place), n_times=n_times_of(dataset.shape, request), **hdf5.named(dataset, component)
        )
        return LazyGrid([array], [place.world_from_index], facts)


def _of_imaris(request: Request) -> LazyGrid:
    with read_hdf5(request.file) as file:
        return _of_levels(file, imaris.described(file, request), request)


def _of_big_data_viewer(request: Request) -> LazyGrid:
    with bdv.opened(request) as (samples, data):
        image = bdv.described(samples, data, request)
        matrices = [level.world_from_index for level in image.levels]
        return LazyGrid([*samples.lazy_levels(image)], matrices, image.facts)


def _of_levels(file: Any, image: StoredImage, request: Request) -> LazyGrid:
    matrices = [level.world_from_index for level in image.levels]
    return LazyGrid([*lazy_levels_of(file, image, request)], matrices, image.facts)


def _of_zarr(request: Request) -> LazyGrid:
    levels = []
    for level in ome_zarr.levels_of(request):
        # Inner chunks of shards, which zarr reads by their ranges: a shard is no unit of reading.
        chunks = level.array.chunks
        place = place_of(level.array)
        is_packed = place is not None and place.archive is not None
        files: SourceFiles | None = StoredFiles([request.file]) if is_packed else chunk_files(level.array, level.picked)
        token = None if files is None else f"Zarr {level.array.store_path}"
        if files is None and not isinstance(request.cache, bool):
            token = _token_of_url(request, level.path)  # only a named folder keeps surveys by a server's marks
        reader = zarr_reader(level.array)
        array = SlicedArray(
            level.array if reader is None else reader,
            name=f"{request.name}/{level.path}" if level.path else request.name,
            chunks=[chunks[axis] for axis in level.order],
            order=level.order,
            picked=level.picked,
            n_readers=8 if request.is_url else 4,
            token=token,
            files=files,
            check=partial(ome_zarr.check_part, request.safe_path) if reader is None else None,
        )
        levels.append((array, level.world_from_index, level.facts))
    # Guesses about the places of coarser levels belong to the whole volume.
    guesses = dict.fromkeys(guess for _, _, facts in levels for guess in facts.guesses)
    facts = replace(levels[0][2], guesses=tuple(guesses))
    return LazyGrid([one[0] for one in levels], [one[1] for one in levels], facts)


def _token_of_url(request: Request, inner: str) -> str | None:
    """Token with a server's version mark of an array's metadata, by which a change is noticed; None without a mark."""
    if not request.is_url:
        return None
    for name in ("zarr.json", ".zarray"):
        key = f"{inner}/{name}".lstrip("/")
        mark = ome_zarr.mark_of(request, key)
        if mark:
            return f"{request.path} {key} {mark}"
    return None


def _of_tiff(request: Request) -> LazyGrid:
    arrays_of_levels, matrices, facts = lazy_tiff.stacks_of(request)
    return LazyGrid([*arrays_of_levels], matrices, facts)


def _of_netcdf(request: Request) -> LazyGrid:
    array, matrix, facts = netcdf.lazy_samples(request)
    return LazyGrid([array], [matrix], facts)


def _of_bioio(request: Request) -> LazyGrid:
    array, matrix, facts = bioio_files.lazy_array_of(request)
    return LazyGrid([array], [matrix], facts)


READERS = {
    "arrays": _of_npy,
    "raw": _of_raw,
    "nifti": _of_nifti,
    "itk": _of_itk,
    "vtk_legacy": _of_vtk_legacy,
    "hdf5": _of_hdf5,
    "netcdf": _of_netcdf,
    "imaris": _of_imaris,
    "bdv": _of_big_data_viewer,
    "ome_zarr": _of_zarr,
    "tiff": _of_tiff,
    "bioio_files": _of_bioio,
}


#: Family of formats -> its name in messages.
NAMES = {
    "arrays": "a NumPy file",
    "raw": "raw samples",
    "nifti": "NIfTI",
    "itk": "an image",
    "vtk_legacy": "a VTK image",
    "hdf5": "HDF5",
    "netcdf": "netCDF",
    "imaris": "an Imaris file",
    "bdv": "BigDataViewer's HDF5 or N5",
    "ome_zarr": "Zarr",
    "tiff": "TIFF",
    "bioio_files": "a microscope's file",
}


def n_stored_bytes(grid: LazyGrid) -> int:
    """Bytes of the samples of the finest level, in memory."""
    finest = grid.levels[0]
    return size_checks.n_bytes(finest.shape, finest.dtype)
