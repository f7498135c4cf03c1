"""NIfTI-1, NIfTI-2, Analyze and FreeSurfer MGH, by nibabel; also vectors in NIfTI.

nibabel and not ITK, because ITK refuses or silently straightens a sheared sform, and turns scaled integers into floats.
NIfTI's world is RAS already; the sform wins over the qform.
"""

from __future__ import annotations

import gzip
import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.nibabel_image import facts_of as facts_of_image
from wavesplat._model.interchange.nibabel_image import in_type, scaled, type_of_scaled, world_from_index
from wavesplat._model.volume.facts import COLORS, LENGTH, Facts
from wavesplat._readers.components import AXES, N_COMPONENTS, component_of
from wavesplat._readers.levels import Levels, OneVolume, one_stream, stored_samples
from wavesplat._readers.request import Grid, Request, choose, quiet, unwarned
from wavesplat._storage import size_checks
from wavesplat._storage.paths import check_within
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from collections.abc import Callable

    from nibabel.spatialimages import SpatialImage

# Vectors in NIfTI: three numbers at each place, along the fifth axis, or, as programs for diffusion write, the fourth.
#
# The fifth axis is the standard's choice: displacements of a registration (intent 1006 or 1007), of which the length is
# drawn. Three float images along the fourth axis, the axis of times, are the directions of fibres (V1 of FSL) where
# their vectors are of length 1 wherever they are not 0; which images of a time series never are. Directions are drawn
# as is usual for them: red, green and blue are the magnitudes of the x, y and z component (Pajevic and Pierpaoli 1999).

#: Largest difference of a direction's length from 1, and least share of the vectors that have it. (FSL's V1: all.)
OFF, MIN_SHARE = 0.02, 0.99
LENGTH_NOTE = (
    "{!r} holds directions, vectors of length 1, by its values: red, green and blue are the magnitudes of x, y and z; "
    'or component="x" (--component x)'
)


def components(
    shape: tuple[int, ...], dtype: np.dtype[Any], request: Request, read: Callable[[tuple[int, int]], NDArray[Any]]
) -> NDArray[Any] | None:
    """The components [x, y, z, component] of a file of vectors; None of other files.

    read : function of (time, channel) that gives one volume, with slope and intercept.
    """
    sizes = [*shape, *[1] * (5 - len(shape))]
    is_float = dtype.kind == "f"
    if sizes[4] > 1:
        if request.component is None and (sizes[4] != N_COMPONENTS or not is_float):
            return None
        time = choose("time", sizes[3], request.time, request.path)
        return np.stack([read((time, number)) for number in range(sizes[4])], axis=-1)
    if sizes[3] != N_COMPONENTS or not (is_float or request.component is not None) or request.time is not None:
        if request.component is not None:
            raise ArgumentError(f"component={request.component!r}, but the file holds no vectors: {request.path}")
        return None
    found = np.stack([read((number, 0)) for number in range(N_COMPONENTS)], axis=-1)
    return found if request.component is not None or _are_directions(found) else None


def drawn(vectors: NDArray[Any], facts: Facts, request: Request) -> tuple[NDArray[Any], Facts]:
    """The samples [x, y, z] that are drawn of vectors [x, y, z, component], and the facts with sentences about them."""
    if request.component is None and _are_directions(vectors):
        number = choose("channel", N_COMPONENTS, request.channel, request.path, described=[c.name for c in COLORS[:3]])
        facts = replace(facts, channels=COLORS[:3], channel=COLORS[number])
        return np.abs(vectors[..., number]), replace(facts, guesses=(*facts.guesses, LENGTH_NOTE.format(request.name)))
    samples, guesses = component_of(vectors, request, request.name)
    done = (LENGTH,) if request.component in (None, "magnitude") and request.channel is None else ()
    return samples, replace(facts, guesses=(*facts.guesses, *guesses), processing=(*facts.processing, *done))


def _are_directions(vectors: NDArray[Any]) -> bool:
    """Whether vectors [..., component] are three numbers of length 1, or 0 outside of the object."""
    if vectors.shape[-1] != len(AXES):
        return False
    squares = np.einsum("...i,...i->...", vectors, vectors, dtype=np.float64)
    found = squares[squares > 0]
    return bool(found.size) and float(np.mean(np.abs(np.sqrt(found) - 1) <= OFF)) >= MIN_SHARE


# NIfTI-1, NIfTI-2, Analyze and FreeSurfer MGH, by nibabel.

#: Bytes of the header of NIfTI-1 and NIfTI-2 -> the first byte that samples may have in the same file.
FIRST_SAMPLES = {348: 352, 540: 544}
#: Suffixes of files that are one stream of gzip.
COMPRESSED = (".gz", ".mgz")
#: Suffixes of images in several files.
PARTS = re.compile(r"\.(hdr|img)(\.\w+)?$", re.IGNORECASE)


def levels(request: Request) -> Levels | Grid:
    """The volume in a NIfTI file, or one of its time points or channels."""
    with quiet("nibabel.global"):
        image = _loaded(request)
        if request.memory is not None:
            return _in_parts(image, request)
        _check_payload(image, request)
        facts = _with_colors(_facts_of(image), image, request)
        vectors = _vectors(image, request)
        if vectors is not None:
            if max(image.shape[4:], default=1) == 1:  # the fourth axis is none of times
                facts = replace(facts, n_times=1, time_step=None, time_unit=None)
            samples, facts = drawn(vectors, facts, request)
        else:
            samples = _scaled(_one_volume(image, request), image)
        return Grid(samples.T, world_from_index(image), facts)


def _in_parts(image: Any, request: Request) -> Levels:
    """The samples of an image that is not compressed, which are read as they are drawn."""
    proxy, path = image.dataobj, _file_of_samples(image, request)
    if path.name.lower().endswith(COMPRESSED):
        raise one_stream(request.path, "gzip")
    if request.component is not None:
        raise ArgumentError(
            "component= is for NIfTI that is read as a whole; choose one of several numbers with time= or channel=, "
            f"or leave out memory=: {request.safe_path}"
        )
    if _has_colors(proxy):
        raise FileError(f"the samples are colours; open the file without memory=: {request.safe_path}")
    # The first axis is the fastest: in the file it is the last one.
    n_axes = len(image.shape)
    picked: list[int | None] = [None, None, None, *_checked_picks(image, request), 0, 0][:n_axes][::-1]
    slope, intercept, made, convert = float(proxy.slope), float(proxy.inter), proxy.dtype, None
    if (slope, intercept) != (1.0, 0.0):
        made = type_of_scaled(proxy.dtype, slope, intercept)
        convert = partial(in_type, slope=slope, intercept=intercept, dtype=made)
    volume = OneVolume((n_axes - 3, n_axes - 2, n_axes - 1), picked, proxy.dtype, made, convert)
    array = stored_samples(path, _first_sample(image), image.shape[::-1], volume)
    return Levels([array], [world_from_index(image)], _facts_of(image))


def _first_sample(image: SpatialImage) -> int:
    """Bytes before the samples in their file.

    Of a header that says 0, in one file with its samples, nibabel gives the header itself as samples: they begin where
    the standard allows them first, behind the header and the four bytes that announce extensions: at 352 in NIfTI-1, at
    544 in NIfTI-2.
    """
    header, proxy = cast("Any", image.header), cast("Any", image.dataobj)
    is_inside = proxy.offset == 0 and getattr(header, "is_single", False)
    return int(header.single_vox_offset) if is_inside else int(proxy.offset)


def _loaded(request: Request) -> Any:
    """The image of nibabel, its samples still in the file.

    Checked first: samples that begin inside the header, which nibabel would report as other faults.
    """
    import nibabel

    path = request.file
    _check_parts(path, request.within)
    _check_first_sample(path)
    with unwarned("nibabel"):
        image: Any = nibabel.load(path)
    if getattr(image, "affine", None) is None:
        raise FileError(
            f"the file holds a {type(image).__name__}, values on surfaces and of single voxels, and no image; "
            f"write its volume, as with wb_command -cifti-separate IN COLUMN -volume-all OUT.nii: {path}"
        )
    return image


def _check_parts(path: Path, within: Path | None) -> None:
    """Raise a `FileError` if another part of the image, as `a.img` of `a.hdr`, or `a.mat`, is a link elsewhere."""
    stem = PARTS.sub("", path.name)
    if within is not None and stem != path.name:
        for file in path.parent.iterdir():
            if file.name.startswith(f"{stem}."):
                check_within(file, within)


def _check_first_sample(path: Path) -> None:
    with (gzip.open if path.name.lower().endswith(".gz") else open)(path, "rb") as file:
        try:
            header = file.read(FIRST_SAMPLES[540])
        except (OSError, EOFError, zlib.error):
            return  # nibabel says what is wrong
    for order in ("<", ">"):
        size = int(np.frombuffer(header[:4].ljust(4), f"{order}i4")[0])
        if size not in FIRST_SAMPLES or b"n+" not in (header[344:346], header[4:6]):
            continue
        least = FIRST_SAMPLES[size]
        place, dtype = (108, "f4") if size == 348 else (168, "i8")
        first = float(np.frombuffer(header, order + dtype, 1, place)[0])
        if first == 0 and any(header[least - 4 : least - 3]):
            raise FileError(
                "the header says that the samples begin at byte 0, and extensions of unknown length lie between it "
                f"and them; write the file's vox_offset: {path}"
            )
        if first != 0 and not first >= least:
            raise FileError(
                f"a wrong header: it says that the samples begin at byte {first:g}, where it is itself; write the "
                f"file's vox_offset, {least} or more: {path}"
            )
        if any(header[least - 4 : least - 3]):
            _check_extensions(path, least, first, order)


def _check_extensions(path: Path, place: int, first_sample: float, order: str) -> None:
    """Raise a `FileError` for an extension that is longer than its file: nibabel would ask for as much memory."""
    if path.name.lower().endswith(COMPRESSED):
        return  # Unpacked bytes are asked for as they come.
    n_bytes = path.stat().st_size
    with path.open("rb") as file:
        while place + 8 <= min(first_sample, n_bytes):
            file.seek(place)
            size = int(np.frombuffer(file.read(4), f"{order}i4")[0])
            if size < 8:
                return  # nibabel says what is wrong
            place += size
        if place > n_bytes:
            raise FileError(
                f"truncated, or a wrong header: an extension ends at byte {place}, the file at {n_bytes}; copy or "
                f"export it again: {path}"
            )


def _facts_of(image: SpatialImage) -> Facts:
    """Facts of the header, with a guess where its first sample is not believed."""
    facts = facts_of_image(image)
    proxy: Any = image.dataobj
    if (first := _first_sample(image)) == proxy.offset:
        return facts
    guess = f"samples from byte {first} on: the file says byte {proxy.offset}, where its header is"
    return replace(facts, guesses=(*facts.guesses, guess))


def _with_colors(facts: Facts, image: SpatialImage, request: Request) -> Facts:
    """The facts with red, green and blue as channels where samples are colours (NIfTI's RGB24 and RGBA32)."""
    names = cast("Any", image.dataobj).dtype.names
    if names is None or names not in (("R", "G", "B"), ("R", "G", "B", "A")):
        return facts
    return replace(facts, channels=COLORS[: len(names)], channel=COLORS[request.channel or 0])


def _file_of_samples(image: Any, request: Request) -> Path:
    file = image.dataobj.file_like
    return Path(file) if isinstance(file, str) else request.file


def _check_payload(image: SpatialImage, request: Request) -> None:
    if min(image.shape, default=0) < 1:
        raise FileError(f"the header says shape {image.shape} (x, y, z), which holds no samples: {request.path}")
    proxy, path = cast("Any", image.dataobj), _file_of_samples(image, request)
    one = image.shape[:3]  # of several only the one that is asked for is read
    if path.name.lower().endswith(COMPRESSED):
        size_checks.check_gzip(image.shape, proxy.dtype, _first_sample(image), path, one)
    else:
        size_checks.check_stored(
            image.shape, proxy.dtype, max(path.stat().st_size - _first_sample(image), 0), path, held=one
        )


def _vectors(image: SpatialImage, request: Request) -> NDArray[Any] | None:
    """Vectors [x, y, z, component] of a file that holds them."""
    proxy: Any = image.dataobj
    if _has_colors(proxy) or max(image.shape[5:], default=1) > 1:
        return None

    def read(place: tuple[int, int]) -> NDArray[Any]:
        one = replace(request, time=place[0], channel=place[1], kept=None)
        return _scaled(_one_volume(image, one), image)

    return components(image.shape, proxy.dtype, request, read)


def _one_volume(image: SpatialImage, request: Request) -> NDArray[Any]:
    """Samples [x, y, z] as stored, without slope and intercept."""
    from nibabel.arrayproxy import ArrayProxy

    proxy: Any = image.dataobj
    time, channel = _checked_picks(image, request)
    extra = (time, channel, 0, 0)[: max(len(image.shape) - 3, 0)]
    # Of a file of one volume nothing is read on.
    kept = None if request.time is None else request.kept
    with _stored_bytes(proxy, kept) as file:
        unscaled = ArrayProxy(file, (image.shape, proxy.dtype, _first_sample(image), 1.0, 0.0), mmap=False)
        samples: NDArray[Any] = np.asarray(unscaled[(..., *extra)] if extra else unscaled)
    if _has_colors(proxy):
        names = proxy.dtype.names
        samples = samples[names[choose("channel", len(names), request.channel, request.path)]]
    return samples


def _checked_picks(image: SpatialImage, request: Request) -> tuple[int, int]:
    """Time point and channel that are asked for."""
    # NIfTI's axes are x, y, z, time, vector component; what follows must have size 1.
    sizes = [*image.shape, *[1] * (7 - len(image.shape))]
    if max(sizes[5:]) > 1:
        raise FileError(
            f"the file is {len(image.shape)}-D, shape {image.shape}; export one volume of it: {request.path}"
        )
    time = choose("time", sizes[3], request.time, request.path)
    has_colors = _has_colors(image.dataobj)
    return time, 0 if has_colors else choose("channel", sizes[4], request.channel, request.path)


@contextmanager
def _stored_bytes(proxy: Any, kept: dict[str, Any] | None) -> Iterator[Any]:
    """The file to read samples from; a compressed one is read to its end, where its checksum is.

    kept : `Request.kept` of a series: the file stays open, so that the next time point is read on from the last one.
    """
    if not str(proxy.file_like).lower().endswith(COMPRESSED):
        yield proxy.file_like
        return
    if kept is not None and "gzip" in kept:
        yield kept["gzip"]
        return
    with gzip.open(proxy.file_like) as file:
        yield file
        while file.read(2**20):
            pass
    if kept is not None:
        kept["gzip"] = gzip.open(proxy.file_like)  # noqa: SIM115 - closed with the series


def _has_colors(proxy: Any) -> bool:
    return proxy.dtype.names is not None


def _scaled(stored: NDArray[Any], image: SpatialImage) -> NDArray[Any]:
    proxy: Any = image.dataobj
    return scaled(stored, float(proxy.slope), float(proxy.inter))
