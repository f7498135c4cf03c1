"""OME-Zarr 0.4 (Zarr v2), 0.5 (Zarr v3) and 0.6 drafts, and plain Zarr arrays, by zarr; also zipped, or under a URL.

Axes may come in any order; time and channel are picked by number.
World units are taken from the file, usually micrometres, one for all axes, and the world's axes are the file's x, y, z.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.lazy.array import SlicedArray, along_zyx
from wavesplat._model.volume.facts import Facts, quantity_of
from wavesplat._readers.components import check_vectors
from wavesplat._readers.levels import Levels, OneVolume, one_volume
from wavesplat._readers.request import PLANES_ARE_TAKEN, Request, choose, level_numbers, requested, several, unwarned
from wavesplat._readers.zarr import layout, metadata
from wavesplat._readers.zarr.layout import Axes, channels_of, facts_of
from wavesplat._readers.zarr.maps import NamedVolume, named_volume
from wavesplat._storage.addresses import is_address
from wavesplat._storage.file_states import SourceFiles, StoredFiles
from wavesplat._storage.zarr.chunk_files import check_chunks, chunk_files, expect_chunks
from wavesplat._storage.zarr.place import METADATA_NAMES, ZarrPlace, place_of
from wavesplat._storage.zarr.reading import read_zarr, zarr_reader
from wavesplat.errors import ArgumentError, FileError, WavesplatError

#: Images and wells that a message lists, at most.
N_LISTED = 12

#: Guess for levels that are moved, as the file does not say where they begin.
GUESS_OF_LEVELS = "coarser levels taken for means of blocks, so half a block in: the file has no translation of them"


@unwarned("zarr")
def levels(request: Request) -> Levels:
    """The levels of an image, the finest first, or only the one that is asked for; or a plain array."""
    node, request, notes = _opened_image(request)
    multiscales = _multiscales(node)
    if multiscales is not None:
        check_vectors(request, request.dataset or "the image")
        datasets = multiscales["datasets"]
        levels = [_level(node, multiscales, datasets[k], request) for k in level_numbers(len(datasets), request)]
        kept = [level for level in levels if level is not None]
        if not kept:
            raise FileError(f"none of the {len(datasets)} levels is there; copy the image again: {request.safe_path}")
        # Guesses about the places of coarser levels belong to the whole volume.
        guesses = dict.fromkeys((*notes, *(guess for level in kept for guess in level.facts.guesses)))
        return _made(kept, replace(kept[0].facts, guesses=tuple(guesses)), request)
    if not hasattr(node, "shape"):
        raise _no_array(request)
    level_numbers(1, request)
    path = request.dataset or ""
    metadata.check_numbers(node, request.safe_path)
    if (named := _named(node, request)) is not None:
        level = _Level(node, path, named.order, named.picked, named.world_from_index, named.facts)
    else:
        found = one_volume(node.shape, node.dtype, request, request.dataset or request.name)
        facts = found.facts(quantity_of(request.dataset))
        level = _Level(node, path, found.order, found.picked, np.eye(4), facts, found)
    _read_later(node)
    return _made([level], level.facts, request)


@dataclass(frozen=True)
class _Level:
    """The array of a level, its axes that are z, y, x, the index along each of the others, and its affine."""

    array: Any
    path: str
    order: tuple[int, ...]
    picked: Sequence[int | slice | None]
    world_from_index: NDArray[np.float64]
    facts: Facts
    #: How samples are made of an array of vectors.
    vectors: OneVolume | None = None


def _made(levels: Sequence[_Level], facts: Facts, request: Request) -> Levels:
    return Levels(
        [_sliced(level, request) for level in levels],
        [level.world_from_index for level in levels],
        facts,
        partial(_refused_chunks, levels[0].array, request),
        partial(_counted, levels[0].array),
    )


def _sliced(level: _Level, request: Request) -> SlicedArray:
    array = level.array
    place = place_of(array)
    picked = [one if isinstance(one, int) else None for one in level.picked]
    is_packed = place is not None and place.archive is not None
    files: SourceFiles | None = StoredFiles([request.file]) if is_packed else chunk_files(array, picked)
    token = None if files is None else f"Zarr {array.store_path}"
    if files is None and not isinstance(request.cache, bool):
        token = _token_of_url(request, level.path)  # only a named folder keeps surveys by a server's marks
    reader = zarr_reader(array)
    return SlicedArray(
        array if reader is None else reader,
        name=f"{request.name}/{level.path}" if level.path else request.name,
        # Inner chunks of shards, which zarr reads by their ranges: a shard is no unit of reading.
        chunks=along_zyx(array.chunks, level.order, 1),
        order=level.order,
        picked=level.picked,
        convert=None if level.vectors is None else level.vectors.convert,
        dtype=np.dtype(array.dtype) if level.vectors is None else level.vectors.made,
        shape=along_zyx(array.shape, level.order, 1),
        n_readers=8 if request.is_url else 4,
        token=token,
        files=files,
        check=partial(_check_part, request.safe_path) if reader is None else None,
    )


def _token_of_url(request: Request, inner: str) -> str | None:
    """Token with a server's version mark of an array's metadata, by which a change is noticed; None without a mark."""
    for name in ("zarr.json", ".zarray") if request.is_url else ():
        key = f"{inner}/{name}".lstrip("/")
        if mark := _location(request).mark(key):
            return f"{request.path} {key} {mark}"
    return None


def _named(array: Any, request: Request) -> NamedVolume | None:
    """The volume of an array whose axes have names, as xarray writes it, with arrays in its group as coordinates."""

    def read(own: Any) -> NDArray[Any]:
        metadata.check_numbers(own, request.safe_path)
        return _samples(own, [slice(None)], request)

    name = (request.dataset or "").strip("/")
    group = _open(replace(request, dataset=name.rpartition("/")[0] or None)) if name else None
    return named_volume(array, group, read, request)


def _check_part(path: object, array: Any, index: Sequence[int | slice]) -> None:
    """Raise a `FileError` if a chunk of a part is cut short."""
    check_chunks(array, index, path)


def _check_kind(array: Any, request: Request) -> None:
    if array.dtype.kind not in "biuf":
        raise FileError(f"samples of type {array.dtype} are no real numbers; store them so: {request.safe_path}")


def _samples(array: Any, index: Sequence[int | slice], request: Request) -> NDArray[Any]:
    """The picked samples; no chunk is read further than it can be long."""
    check_chunks(array, index, request.safe_path)
    expect_chunks(array, place_of(array))
    return read_zarr(array, index)


def _read_later(array: Any) -> None:
    """Bound the chunks of an array that is read as it is drawn; a refused one is reported when it is asked for."""
    expect_chunks(array, place_of(array))
    place = place_of(array)
    if place is not None:
        place.warns = True


@contextmanager
def _counted(array: Any) -> Iterator[None]:
    """Keep zarr from warnings, and count refused chunks for `_refused_chunks` instead of reporting the first."""
    place = place_of(array)
    if place is not None:
        place.warns = False
    try:
        with unwarned("zarr"):
            yield
    finally:
        if place is not None:
            place.warns = True


def _refused_chunks(array: Any, request: Request) -> tuple[str, ...]:
    """A sentence if the server refused chunks; a `FileError` if it refused all.

    Storage services that may not list what they hold answer 403 for what is not there.
    """
    place = place_of(array)
    refused = [] if place is None else [key for key in place.refused if key.rpartition("/")[2] not in METADATA_NAMES]
    if place is None or not refused:
        return ()
    if not place.has_chunks:
        raise FileError(
            f"the server refuses (403 Forbidden) all {len(refused)} chunks that were asked for, the first "
            f"{refused[0]!r}; check that you may read them, or that the address holds the access: {request.safe_path}"
        )
    text = f"the server refuses (403) {len(refused)} chunks, the first {refused[0]!r}"
    return (f"{text}; they count as not there, so their samples have the fill value",)


def _level(group: Any, multiscales: dict[str, Any], dataset: dict[str, Any], request: Request) -> _Level | None:
    """The level of a dataset; None where it is not there, as in a partial copy."""
    metadata.check_codecs(_location(request, group), f"{request.dataset or ''}/{dataset['path']}")
    array = group.get(dataset["path"])
    if not hasattr(array, "shape"):
        return None
    _check_kind(array, request)
    _read_later(array)
    return _placed(group, array, multiscales, dataset, request)


def _no_array(request: Request) -> FileError:
    message = (
        f"a Zarr group without an OME-Zarr image; choose an array with dataset= (--dataset): "
        f"{_listed(request)}: {request.safe_path}"
    )
    return several(message, "dataset", metadata.names(_location(request)))


def _opened_image(request: Request) -> tuple[Any, Request, tuple[str, ...]]:
    """The node of a request, or the only or first image in it; the request that names it; notes on the choice.

    Raises
    ------
    SeveralError
        If it is a plate, or a well, of several images.
    """
    node = _open(request)
    if hasattr(node, "shape") or _multiscales(node) is not None:
        return node, request, ()
    place, path = _location(request, node), (request.dataset or "").strip("/")
    images = _images_of(place, path)
    notes: tuple[str, ...] = ()
    if len(images) > 1:
        if wells := layout.wells_of(place, path):
            raise _several_wells(wells, images, request)
        named = ", ".join(images[:N_LISTED]) + (", ..." if len(images) > N_LISTED else "")
        notes = (f"{images[0]} of {len(images)} images in the file, {named}; choose one with dataset= (--dataset)",)
    if not images:
        return node, request, ()
    request = replace(request, dataset=images[0])
    return _open(request), request, notes


def _several_wells(wells: Sequence[layout.Well], images: list[str], request: Request) -> FileError:
    wells = [well for well in wells if well.fields]
    names = ", ".join(well.name for well in wells[:N_LISTED]) + (", ..." if len(wells) > N_LISTED else "")
    kind = f"a plate of {len(wells)} wells, {names}," if len(wells) > 1 else f"the well {names}"
    own = request.safe_path.rstrip("/")
    message = (
        f"this is {kind} with {len(images)} images; choose one with dataset={images[0]!r} (--dataset {images[0]}), or "
        f"name its folder, {own}/{images[0]}"
    )
    if len(wells) > 1 and not is_address(request.path):
        message += f"; of each well the first: wavesplat render '{own}/*/*/{wells[0].fields[0]}' -o '{{well}}.png'"
    message += f": {request.safe_path}"
    described = [f"{image} ({well.name})" for well in wells for image in well.images]
    return several(message, "dataset", images, described)


@unwarned("zarr")
def labels_of(path: str | PathLike[str], dataset: str | None = None) -> tuple[str, tuple[str, ...]]:
    """The path in the store of the image that is opened by default, and the names of its segmentations."""
    place, inner = _place_in(path, dataset)
    images = _images_of(place, inner)[:1] or [inner]
    return images[0], layout.label_names(place, images[0])


def _images_of(place: ZarrPlace, path: str) -> list[str]:
    """Paths of the images in a series, or in the wells of a plate; empty for other groups."""
    series = [f"{path}/{name}".strip("/") for name in layout.series_of(place, path)]
    return series or [image for well in layout.wells_of(place, path) for image in well.images]


@unwarned("zarr")
def contents(path: str | PathLike[str], dataset: str | None = None) -> dict[str, Any]:
    """The images of a series, the wells of a plate, and the labels of an image, for people to choose from."""
    place, inner = _place_in(path, dataset)
    series = layout.series_of(place, inner)
    names = layout.series_names(place, inner, len(series)) if series else ()
    wells = layout.wells_of(place, inner)
    return {
        "images": [{"path": path, "name": name} for path, name in zip(series, names, strict=True)],
        "wells": [{"name": well.name, "path": well.path, "fields": list(well.fields)} for well in wells],
        "label_images": list(labels_of(path, dataset)[1]),
    }


@unwarned("zarr")
def label_looks(path: str | PathLike[str], dataset: str | None = None) -> dict[int, layout.Look]:
    """Names and colours of the labels of a segmentation, by number."""
    return layout.label_looks(*_place_in(path, dataset))


def _place_in(path: str | PathLike[str], dataset: str | None) -> tuple[ZarrPlace, str]:
    return _location(requested(path)), (dataset or "").strip("/")


def _open(request: Request) -> Any:
    import zarr

    from wavesplat._storage.zarr.stores import PlaceStore

    place = _location(request)
    metadata.check_codecs(place, request.dataset or "")
    try:
        node: Any = zarr.open(PlaceStore(place), mode="r")
    except WavesplatError:
        raise
    except (OSError, KeyError, ValueError) as error:
        raise _not_found(place) or error from None
    if request.dataset is None:
        return node
    try:
        return node[request.dataset]
    except (KeyError, IndexError, TypeError):
        raise ArgumentError(
            f"no array or group {request.dataset!r}; there is: {_listed(request)}: {request.safe_path}"
        ) from None


def _not_found(place: ZarrPlace) -> FileError | None:
    """The error where a server has, or gives, no metadata; None where there are some."""
    if any(place.read(name) is not None for name in METADATA_NAMES):
        return None
    if place.archive is not None:
        return FileError(
            f"the archive holds no Zarr array or group at its top ({', '.join(METADATA_NAMES)}); pack the content of "
            f"the folder, or unpack the archive: {place}"
        )
    if place.root is not None:
        return None
    if place.address.partition("?")[0].lower().endswith((".zip", ".ozx")):
        return FileError(f"zip archives are not read from servers; copy it to this machine: {place}")
    if place.refused:
        return FileError(
            f"the server refuses (403 Forbidden) {', '.join(place.refused)}; check the address, and that you may read "
            f"it, or that it holds the access: {place}"
        )
    return FileError(
        f"there is no Zarr array or group at this address ({', '.join(METADATA_NAMES)}); check it: {place}"
    )


def _location(request: Request, opened: Any = None) -> ZarrPlace:
    """The place of a request; of a node that was opened there, its place, which knows metadata already."""
    known = None if opened is None else place_of(opened)
    return known or ZarrPlace(str(request.path) if request.is_url else Path(request.file), within=request.within)


def _listed(request: Request) -> str:
    return ", ".join(metadata.names(_location(request))) or "none"


def _multiscales(node: Any) -> dict[str, Any] | None:
    attributes = dict(node.attrs)
    images = attributes.get("ome", attributes).get("multiscales")
    return images[0] if images else None


def _placed(group: Any, array: Any, multiscales: dict[str, Any], dataset: dict[str, Any], request: Request) -> _Level:
    described = Axes.of(multiscales)
    axes = list(described.names)
    if len(axes) != array.ndim:
        raise FileError(
            f"the metadata name {len(axes)} axes, the array has {array.ndim}; mend the metadata: {request.safe_path}"
        )
    spatial = _spatial_axes(axes, request)
    attributes = dict(group.attrs)
    channels = channels_of(attributes.get("ome", attributes))
    names = [channel.name for channel in channels]
    picked = [_picked(name, n, spatial, request, names) for name, n in zip(axes, array.shape, strict=True)]
    matrix = _composed(dataset, multiscales, len(axes), request)
    guesses: list[str] = []
    shift = _shift_of_blocks(dataset, multiscales["datasets"][0], len(axes), request)
    if shift is not None:
        matrix = matrix @ shift
        guesses.append(GUESS_OF_LEVELS)
    mirrored = [axes[number] for number in _mirrored(matrix, [axes.index(name) for name in spatial])]
    if mirrored:
        guesses.append(f"axes {', '.join(sorted(mirrored))} mirrored: their scale in the file is negative")
    world_from_index = _spatial_part(matrix, [axes.index(name) for name in reversed(spatial)])
    world_from_index[:3] *= described.in_one_unit()[1][:, None]
    facts = facts_of(
        described,
        channels,
        channel=request.channel or 0,
        shape=array.shape,
        levels=_shapes(group, multiscales["datasets"], request),
        matrix=matrix,
    )
    facts = replace(facts, guesses=(*facts.guesses, *guesses))
    if isinstance(attributes.get("ome", attributes).get("image-label"), dict):
        facts = replace(facts, modality="SEG")
    order = tuple(axes.index(name) for name in spatial)
    return _Level(array, str(dataset["path"]), order, picked, world_from_index, facts)


def _mirrored(matrix: NDArray[np.float64], numbers: list[int]) -> list[int]:
    """Axes whose scale is negative; a rotation has negative numbers too, and mirrors nothing."""
    part = matrix[np.ix_(numbers, numbers)]
    is_turned = np.count_nonzero(part) > len(numbers) and np.linalg.det(part) > 0
    return [] if is_turned else [number for number in numbers if matrix[number, number] < 0]


def _shapes(group: Any, datasets: list[dict[str, Any]], request: Request) -> list[tuple[int, ...]]:
    """Shapes of all levels; those that are not there, as in a partial copy, are left out."""
    for dataset in datasets:
        metadata.check_codecs(_location(request, group), f"{request.dataset or ''}/{dataset['path']}")
    arrays = (group.get(dataset["path"]) for dataset in datasets)
    return [tuple(array.shape) for array in arrays if hasattr(array, "shape")]


def _spatial_axes(axes: list[str], request: Request) -> list[str]:
    """Names of the axes that become z, y, x; y and x of a single plane, where these are taken."""
    if not {"y", "x"} <= set(axes):
        raise FileError(f"the axes are {', '.join(axes)}; an image needs y and x, a volume z too: {request.safe_path}")
    if "z" in axes:
        return ["z", "y", "x"]
    if not PLANES_ARE_TAKEN.get():
        raise FileError(
            f"the axes are {', '.join(axes)}, so the image is 2-D, and a volume needs z, y and x; `wavesplat slice` "
            f"shows it: {request.safe_path}"
        )
    return ["y", "x"]


def _picked(name: str, count: int, spatial: list[str], request: Request, channels: list[str]) -> int | None:
    if name in spatial:
        return None
    option = "time" if name.startswith("t") else "channel"
    described = channels if option == "channel" else ()
    return choose(option, count, getattr(request, option), request.safe_path, described=described)


def _composed(
    dataset: dict[str, Any], multiscales: dict[str, Any], n_axes: int, request: Request
) -> NDArray[np.float64]:
    """World from index in the order of the array's axes: the level's own transforms, then the image's."""
    steps = [*dataset.get("coordinateTransformations", ()), *multiscales.get("coordinateTransformations", ())]
    matrix = np.eye(n_axes + 1)
    for step in steps:
        made = _matrix(step, n_axes, request)
        if not np.isfinite(made).all():
            raise FileError(f"coordinateTransformations has a number that is not finite; mend it: {request.safe_path}")
        matrix = made @ matrix
    return matrix


def _shift_of_blocks(
    dataset: dict[str, Any], finest: dict[str, Any], n_axes: int, request: Request
) -> NDArray[np.float64] | None:
    """A shift of a level by half a block, in its own samples, where it and the finest have a scale and nothing else.

    A sample of a coarser level stands for a block of the finest, n samples along an axis, and lies in its middle:
    (n - 1) / 2 of the finest, (n - 1) / 2n of its own, from its first. The levels fill the same box then, as readers
    that align the edges of levels have it. Levels of every n-th sample are the exception, and the file does not say so.
    """
    steps = [dataset.get("coordinateTransformations", ()), finest.get("coordinateTransformations", ())]
    if [[step.get("type") for step in own] for own in steps] != [["scale"], ["scale"]]:
        return None
    own, first = (_numbers(step[0], "scale", (n_axes,), request) for step in steps)
    if (own == first).all() or not (first != 0).all() or not (own / first >= 1).all():
        return None
    shift = np.eye(n_axes + 1)
    shift[:-1, -1] = (1 - first / own) / 2
    return shift


def _matrix(step: dict[str, Any], n_axes: int, request: Request) -> NDArray[np.float64]:
    kind = step["type"]
    matrix = np.eye(n_axes + 1)
    if kind == "sequence":
        for part in step["transformations"]:
            matrix = _matrix(part, n_axes, request) @ matrix
    elif kind == "scale":
        matrix[:-1, :-1] = np.diag(_numbers(step, kind, (n_axes,), request))
    elif kind == "translation":
        matrix[:-1, -1] = _numbers(step, kind, (n_axes,), request)
    elif kind == "rotation":
        matrix[:-1, :-1] = _numbers(step, kind, (n_axes, n_axes), request)
    elif kind == "affine":
        matrix[:-1] = _numbers(step, kind, (n_axes, n_axes + 1), request)
    elif kind != "identity":
        raise FileError(
            f"coordinate transformation of type {kind!r} is not supported; "
            f"export with a scale or affine: {request.safe_path}"
        )
    return matrix


def _numbers(step: dict[str, Any], kind: str, shape: tuple[int, ...], request: Request) -> NDArray[np.float64]:
    """The numbers of a transformation; a `FileError` for texts, or where there is not one for each axis."""
    found = np.asarray(step.get(kind), object)
    if found.shape != shape or not all(type(number) in (int, float) for number in found.flat):
        wanted = " x ".join(map(str, shape))
        raise FileError(
            f"the {kind} of an image is {step.get(kind)!r}, not {wanted} numbers; mend it: {request.safe_path}"
        )
    return found.astype(np.float64)


def _spatial_part(matrix: NDArray[np.float64], xyz: list[int]) -> NDArray[np.float64]:
    """The affine of x, y, z, rows and columns of one over all axes; of x and y alone, without a step along z."""
    part, n = np.diag([0.0, 0.0, 0.0, 1.0]), len(xyz)
    part[:n, :n] = matrix[np.ix_(xyz, xyz)]
    part[:n, 3] = matrix[xyz, -1]
    return part
