"""HDF5, by h5py: a dataset with three or more axes. Its place comes from attributes (`hdf5_place`), if there are."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._model.interchange.hdf5 import Place, check_nesting, files_of_dataset, open_hdf5, place_of, read_hdf5
from wavesplat._model.lazy.array import SlicedArray, along_zyx
from wavesplat._model.volume.facts import Facts, quantity_of, value_unit_of
from wavesplat._readers.components import AXES, has_vectors
from wavesplat._readers.file_contents import Contents, FileArray, are_small, ranges_of
from wavesplat._readers.hdf5 import openpmd, vectors
from wavesplat._readers.hdf5 import openpmd as theta_modes
from wavesplat._readers.levels import Levels, one_volume
from wavesplat._readers.request import Grid, Request, listed, no_such_name, several
from wavesplat._readers.unsupported_formats import BY_YT, foreign_groups
from wavesplat._readers.vtk.arrays import other_grid
from wavesplat._storage import size_checks
from wavesplat._storage.paths import refused
from wavesplat._storage.reading import reading
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    import h5py


#: Groups and links on the path to a dataset, at most.
MAX_STEPS = 100
#: Datasets without three axes that a message names, at most.
MAX_LISTED = 6
#: Groups at the root of Imaris' files.
IMARIS = {"DataSetInfo", "DataSet"}
#: Names of the grids of Enzo's adaptive meshes.
ENZO = re.compile(r"Grid\d{8}/")
#: Names of groups at the root of BigDataViewer's files: a setup, a time point.
SETUP, TIME_POINT = re.compile(r"s\d{2,}"), re.compile(r"t\d{5,}")


def levels(request: Request) -> Levels | Grid:
    """A dataset in an HDF5 file, or a record of openPMD with several."""
    with read_hdf5(request.file) as file:
        request = openpmd.with_record(file, request)
        if request.resample is not None:
            if request.memory is not None:
                raise ArgumentError(f"resample= reads all samples; leave out memory=: {request.path}")
            return theta_modes.read(file, request, lambda own: _modes_dataset(file, own))
        components = vectors.components_of_record(file, request)
    if not components:
        return _level(request)
    if request.component in components:
        return _level(vectors.component_of_record(components, request))
    if request.memory is not None:
        raise ArgumentError(
            f'{request.dataset!r} holds vectors; with memory= choose one component, as component="x" '
            f"(--component x), or leave out memory=: {request.path}"
        )
    return vectors.length_of_record(components, request, lambda own: _level(own).whole(own))


def _level(request: Request) -> Levels:
    with read_hdf5(request.file) as file:
        dataset = _chosen_dataset(file, request)
        shape, dtype = dataset.shape, dataset.dtype
        found = one_volume(shape, dtype, request, dataset.name.lstrip("/"))
        check_stored(dataset, [shape[axis] for axis in found.order], request.file, request)
        place = place_of(dataset)
        zyx = tuple(found.order[k] for k in place.zyx) if len(found.order) == 3 else found.order
        chunks = dataset.chunks or [1] * (len(shape) - 2) + list(shape[-2:])
        # A link that leads to another file gives the dataset's name there.
        name = str(dataset.name if dataset.file.filename == file.filename else request.dataset)
        array = SlicedArray(
            None,
            name=request.name,
            chunks=along_zyx(chunks, zyx, 1),
            order=zyx,
            picked=found.picked,
            opened=partial(open_hdf5, str(request.file), name),
            convert=found.convert,
            dtype=found.made,
            shape=along_zyx(shape, zyx, 1),
            n_readers=1,
            token=f"HDF5 {request.file} {name}",
            files=files_of_dataset(dataset),
            reads_parts=dataset.chunks is None,
        )
        facts = _facts_of(file, place)
        facts = replace(facts, n_times=found.n_times, guesses=(*facts.guesses, *found.guesses))
        return Levels([array], [place.world_from_index], replace(facts, **_named(dataset, found.component)))


def check_stored(dataset: h5py.Dataset, shape: Sequence[int], file: Path, request: Request) -> None:
    """Raise an error if samples of this shape cannot be in the file of a dataset, or must be in memory and cannot.

    Chunks that were never written are not stored, and read as zeros; the loose ratio allows for a few.
    """
    if dataset.external or dataset.is_virtual:
        return
    stored, ratio = max(dataset.id.get_storage_size(), file.stat().st_size), size_checks.ANY_RATIO
    n_bytes = size_checks.n_bytes(shape, dataset.dtype)
    if request.memory is None and n_bytes > stored * ratio:
        size_checks.check_memory(n_bytes, request.path)
    size_checks.check_stored(shape, dataset.dtype, stored, request.path, ratio=ratio, held=(1,))


def contents(request: Request) -> Contents:
    """All datasets of numbers with three axes or more; components of a mesh of openPMD as one."""
    with reading("HDF5", request.path), read_hdf5(request.file) as file:
        _check_kind(file, request)
        records = openpmd.records_of(file) if "data" in file else {}
        found: dict[str, list[tuple[str, h5py.Dataset]]] = {}
        for name in openpmd.names_of_volumes(file):
            record, _, part = name.rpartition("/")
            found.setdefault(record if record in records else name, []).append((part, file[name]))
        looks = are_small(dataset for parts in found.values() for _, dataset in parts)
        return Contents(tuple(_described_array(file, name, parts, request, looks) for name, parts in found.items()))


def _described_array(
    file: h5py.File, name: str, parts: list[tuple[str, h5py.Dataset]], request: Request, looks: bool
) -> FileArray:
    """A dataset, or the components of a mesh of openPMD; without ranges where samples may lie in other files."""
    first = parts[0][1]
    is_vector = len(parts) == 1 and has_vectors(first.shape, first.dtype, replace(request, channel=None, time=None))
    ranges: list[tuple[Any, ...]] = []
    with suppress(FileError):
        for _, dataset in parts:
            check_places(file, dataset, request)
            ranges.append(ranges_of(dataset, has_components=is_vector) if looks else ())
    shape, n = (first.shape[:-1], first.shape[-1]) if is_vector else (first.shape, len(parts))
    is_whole = len(ranges) == len(parts) and all(ranges)
    own = tuple(one for of_part in ranges for one in of_part) if is_whole else ()
    return FileArray(name, str(first.dtype.newbyteorder("=")), shape, n, None, own)


def _named(dataset: h5py.Dataset, component: str | None = None) -> dict[str, Any]:
    """The name of a dataset's values, and their unit, where an attribute says it, as facts.

    component : what is drawn of vectors. A component of a record of openPMD, such as "data/1/meshes/B/x", is named
    after the record too.
    """
    quantity = quantity_of(dataset.name)
    record = quantity_of(dataset.name.rpartition("/")[0])
    if record is not None and quantity is not None and quantity in AXES:
        quantity = f"{record} {quantity}"
    if quantity is not None and component is not None:
        quantity = f"{quantity} {component}"
    unit = dataset.attrs.get("units")
    unit = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else unit
    return {"quantity": quantity, "value_unit": value_unit_of(unit)}


def _facts_of(file: h5py.File, place: Place) -> Facts:
    """Facts of a dataset, with a guess where the file's format keeps distances in another place."""
    has_distances = place.facts.unit is not None or not np.array_equal(place.world_from_index, np.eye(4))
    where = None
    if (own := _own_names(file)) >= IMARIS:
        where = "Imaris keeps them in DataSetInfo, which is not read with dataset="
    elif any(map(SETUP.fullmatch, own)) and any(map(TIME_POINT.fullmatch, own)):
        where = "BigDataViewer keeps them in the .xml beside the file, which is not read with dataset="
    if where is None or has_distances:
        return place.facts
    return replace(place.facts, guesses=(*place.facts.guesses, f"distances of samples 1, 1, 1: {where}"))


def kind_of(path: Path) -> str:
    """The module that reads an HDF5 file: "imaris" or "bdv" by its groups, else "hdf5"."""
    try:
        with read_hdf5(path) as file:
            own = _own_names(file)
            if own >= IMARIS and file["DataSet"].get("ResolutionLevel 0", getlink=True) is not None:
                return "imaris"
            setups = [name for name in own if SETUP.fullmatch(name) and file[name].get("resolutions", getlink=True)]
            return "bdv" if setups and any(map(TIME_POINT.fullmatch, own)) else "hdf5"
    except (OSError, RuntimeError, KeyError, ValueError, TypeError):
        return "hdf5"  # whatever is wrong is said where it is read


def _chosen_dataset(file: h5py.File, request: Request) -> h5py.Dataset:
    """The dataset that is asked for, or the only one; a `FileError` if its samples lie in other files."""
    _check_kind(file, request)
    dataset = _dataset(file, request)
    for node in (dataset, dataset.parent):
        vectors.check_geometry(node, request)
    check_places(file, dataset, request)
    return dataset


def _modes_dataset(file: h5py.File, request: Request) -> h5py.Dataset:
    """The dataset that is asked for, or the only one, of a mesh in cylindrical modes."""
    _check_kind(file, request)
    dataset = _dataset(file, request)
    if theta_modes.NAME not in (theta_modes.geometry_of(node) for node in (dataset, dataset.parent)):
        raise ArgumentError(
            f"resample= is for grids that are not even; {dataset.name!r} is read as it is: {request.path}"
        )
    check_places(file, dataset, request)
    return dataset


def _own_names(file: h5py.File) -> set[str]:
    """Names in the root group that are no links to other names or files, so that their objects are in the file."""
    import h5py

    return {name for name in file if isinstance(file.get(name, getlink=True), h5py.HardLink)}


def _check_kind(file: h5py.File, request: Request) -> None:
    """Raise a `FileError` for formats on top of HDF5 that say what their numbers mean, which would be lost here."""
    own = _own_names(file)
    if "minc-2.0" in own:
        raise FileError(f"the file holds a MINC image; give it a name that ends in .mnc: {request.path}")
    if "VTKHDF" in own:
        kind = file["VTKHDF"].attrs.get("Type", b"")
        raise other_grid(kind.decode("latin-1") if isinstance(kind, bytes) else str(kind), request.path)


def _dataset(file: h5py.File, request: Request) -> h5py.Dataset:
    import h5py

    found = {name: file[name] for name in openpmd.names_of_volumes(file)}
    if request.dataset is not None:
        check_way(file, request.dataset, request)
        node = file.get(request.dataset)
        # The last part of a name will do where one dataset alone has it.
        ends = [name for name in found if name.rpartition("/")[2] == request.dataset]
        if not isinstance(node, h5py.Dataset) and len(ends) == 1:
            return found[ends[0]]
        if not isinstance(node, h5py.Dataset):
            raise no_such_name("dataset", request.dataset, list(found), request)
        return node
    if not found:
        raise _none_found(file, request)
    if len(found) != 1:
        described = _described(file, found)
        message = (
            f"the file holds {len(described)} datasets with three or more axes; choose one with dataset= (--dataset): "
            f"{listed(list(described.values()))}: {request.path}"
        )
        of_enzo = any(ENZO.match(name) for name in found)
        how = f"; they are grids of an adaptive mesh of Enzo: to put them together, {BY_YT}" if of_enzo else ""
        raise several(f"{message}{how}", "dataset", list(described), list(described.values()))
    return next(iter(found.values()))


def _described(file: h5py.File, found: dict[str, h5py.Dataset]) -> dict[str, str]:
    """Name -> description of each dataset, and of each mesh of openPMD in place of its components."""
    records = openpmd.records_of(file)
    described = {}
    for name, dataset in found.items():
        record = name.rpartition("/")[0]
        if record in records:
            described[record] = f"{record} {dataset.shape} of {', '.join(records[record])}"
        else:
            described[name] = f"{name} {dataset.shape}"
    return described


def _none_found(file: h5py.File, request: Request) -> FileError:
    """The error for a file without a dataset of three axes, with those that it has instead."""
    import h5py

    if (known := foreign_groups(list(file), request.file)) is not None:
        return known
    flat: list[str] = []

    def visit(name: str, node: Any) -> None:
        if isinstance(node, h5py.Dataset):
            flat.append(f"{name} {node.shape}")

    file.visititems(visit)
    more = f", and {len(flat) - MAX_LISTED} more" if len(flat) > MAX_LISTED else ""
    held = ", ".join(flat[:MAX_LISTED]) or "groups alone"
    return FileError(
        f"the file holds no dataset with three axes of numbers, so no volume, but {held}{more}; if one is "
        f"a flattened volume, give wavesplat.Volume(h5py.File(path)[name][...].reshape(nz, ny, nx)): {request.path}"
    )


def check_places(file: h5py.File, dataset: h5py.Dataset, request: Request) -> None:
    """Raise a `FileError` if samples lie in other files, where these are not allowed, or HDF5 cannot read them."""
    if not request.external_files:
        _check_own(file, dataset, request)
    check_nesting(dataset, request.path)


def _check_own(file: h5py.File, dataset: h5py.Dataset, request: Request) -> None:
    """Raise a `FileError` if samples lie in other files, also through other datasets of this file."""
    import h5py

    seen, left = {dataset.name}, [dataset]
    while left:
        one = left.pop()
        others = [name for name, _, _ in one.external or ()]
        sources = {(source.file_name, source.dset_name) for source in one.virtual_sources()} if one.is_virtual else ()
        # "%" in a name stands for the number of a block: each block has a dataset of its own.
        others += [name if name != "." else inner for name, inner in sorted(sources) if name != "." or "%" in inner]
        if others:
            raise refused(f"{others[0]!r} as the place of its samples", request.path)
        for inner in sorted({inner for _, inner in sources} - seen):
            seen.add(inner)
            check_way(file, inner, request)
            if isinstance(source := file.get(inner), h5py.Dataset):
                left.append(source)


def check_way(file: h5py.File, name: str, request: Request) -> None:
    """Raise a `FileError` if the path to a dataset leaves the file without permission, or goes round in a circle."""
    import h5py

    place, parts = "/", name.split("/")
    for _ in range(MAX_STEPS):
        if not parts:
            return
        part = parts.pop(0)
        if part in ("", "."):
            continue
        here = file.get(place)
        link = here.get(part, getlink=True) if isinstance(here, h5py.Group) else None
        if isinstance(link, h5py.ExternalLink):
            if request.external_files:
                return
            raise refused(f"{link.filename!r} as the place of {name!r}", request.path)
        if isinstance(link, h5py.SoftLink):
            parts = link.path.split("/") + parts
            place = "/" if link.path.startswith("/") else place
        else:
            place = f"{place.rstrip('/')}/{part}"
    raise FileError(f"the links to {name!r} go round in a circle; choose another with dataset=: {request.path}")
