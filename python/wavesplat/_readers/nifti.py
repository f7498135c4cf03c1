"""NIfTI-1, NIfTI-2, Analyze and FreeSurfer MGH, by nibabel.

nibabel and not ITK, because ITK refuses or silently straightens a sheared sform, and turns scaled integers into floats.
NIfTI's world is RAS already; the sform wins over the qform.
"""

from __future__ import annotations

import gzip
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import payload
from wavesplat._files.reading import reading
from wavesplat._model.facts import Facts
from wavesplat._readers.request import Grid, Request, choose, quiet
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from nibabel.spatialimages import SpatialImage

__all__ = ["read"]

MM_PER_UNIT = {"meter": 1000.0, "mm": 1.0, "micron": 0.001}
#: nibabel's names of the units of time, and ours; others (hz, ppm) are none of time.
TIME_UNITS = {"sec": "s", "msec": "ms", "usec": "us"}
LARGEST_FLOAT32 = float(np.finfo(np.float32).max)


def read(request: Request) -> Grid:
    """The volume in a NIfTI file, or one of its time points or channels."""
    import nibabel

    with reading("NIfTI", request.path), quiet("nibabel.global"):
        image: Any = nibabel.load(request.file)
        _check_payload(image, request)
        stored = _one_volume(image, request)
        return Grid(_scaled(stored, image).T, _world_from_index(image), _facts(image))


def _check_payload(image: SpatialImage, request: Request) -> None:
    if min(image.shape, default=0) < 1:
        raise FileError(f"the header says shape {image.shape} (x, y, z), which holds no samples: {request.path}")
    proxy: Any = image.dataobj
    file = proxy.file_like
    path = request.file if not isinstance(file, str) else type(request.file)(file)
    one = image.shape[:3]  # of several only the one that is asked for is read
    if path.name.lower().endswith((".gz", ".mgz")):
        payload.check_gzip(image.shape, proxy.dtype, proxy.offset, path, one)
    else:
        payload.check_stored(image.shape, proxy.dtype, path.stat().st_size - proxy.offset, path, held=one)


def _one_volume(image: SpatialImage, request: Request) -> NDArray[Any]:
    """Samples [x, y, z] as stored, without slope and intercept."""
    from nibabel.arrayproxy import ArrayProxy

    proxy: Any = image.dataobj
    # NIfTI's axes are x, y, z, time, vector component; what follows must have size 1.
    sizes = [*image.shape, *[1] * (7 - len(image.shape))]
    if max(sizes[5:]) > 1:
        raise FileError(
            f"the file is {len(image.shape)}-D, shape {image.shape}; export one volume of it: {request.path}"
        )
    time = choose("time", sizes[3], request.time, request.path)
    channel = 0 if _has_colors(proxy) else choose("channel", sizes[4], request.channel, request.path)
    extra = (time, channel, 0, 0)[: max(len(image.shape) - 3, 0)]
    with _stored_bytes(proxy, request.kept) as file:
        unscaled = ArrayProxy(file, (image.shape, proxy.dtype, proxy.offset, 1.0, 0.0), mmap=False)
        samples: NDArray[Any] = np.asarray(unscaled[(..., *extra)] if extra else unscaled)
    if _has_colors(proxy):
        names = proxy.dtype.names
        samples = samples[names[choose("channel", len(names), request.channel, request.path)]]
    return samples


@contextmanager
def _stored_bytes(proxy: Any, kept: dict[str, Any] | None) -> Iterator[Any]:
    """What to read the samples from; a compressed file is read to its end, where its checksum is.

    kept : of a series: the file stays open, so that the next time point is read on from the last one.
    """
    if not str(proxy.file_like).lower().endswith((".gz", ".mgz")):
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
    """Slope and intercept applied; integers stay integers where nothing is lost."""
    proxy: Any = image.dataobj
    slope, intercept = float(proxy.slope), float(proxy.inter)
    if (slope, intercept) == (1.0, 0.0):
        return stored
    if stored.dtype.kind in "iu" and slope.is_integer() and intercept.is_integer():
        ends = [int(end) * int(slope) + int(intercept) for end in (stored.min(), stored.max())]
        for dtype in (np.int16, np.int32):
            if np.iinfo(dtype).min <= min(ends) and max(ends) <= np.iinfo(dtype).max:
                return (stored.astype(np.int64) * int(slope) + int(intercept)).astype(dtype)
    values = stored * np.float64(slope) + intercept
    # Slopes near the limit of float32 make values beyond it.
    may_be_large = max(abs(slope), abs(intercept)) > 1e20 or (stored.dtype.kind == "f" and abs(slope) > 1)
    if stored.dtype.itemsize > 4 or (may_be_large and _largest(values) > LARGEST_FLOAT32):
        return values
    return values.astype(np.float32)


def _largest(values: NDArray[np.float64]) -> float:
    return float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))


def _world_from_index(image: SpatialImage) -> NDArray[np.float64]:
    header: Any = image.header
    if not _has_orientation(image):
        # The standard's method 1: spacing only. (nibabel would centre the volume and mirror x, as SPM did.)
        world_from_index = np.diag([*(abs(float(zoom)) or 1.0 for zoom in header.get_zooms()[:3]), 1.0])
    else:
        world_from_index = np.array(image.affine, dtype=np.float64)
    if _has_units(image):
        world_from_index[:3] *= MM_PER_UNIT.get(header.get_xyzt_units()[0], 1.0)
    return world_from_index


def _has_units(image: SpatialImage) -> bool:
    """Whether it is NIfTI; Analyze and FreeSurfer's format have no field for units."""
    return hasattr(image.header, "get_xyzt_units")


def _has_orientation(image: SpatialImage) -> bool:
    """Whether the file says how the axes lie in the patient; Analyze never does."""
    header: Any = image.header
    if _has_units(image):
        return bool(header["sform_code"] > 0 or header["qform_code"] > 0)
    return hasattr(header, "get_vox2ras")


def _facts(image: SpatialImage) -> Facts:
    header: Any = image.header
    is_anatomical = _has_orientation(image)
    n_times = int(image.shape[3]) if len(image.shape) > 3 else 1
    unit, time_unit = header.get_xyzt_units() if _has_units(image) else ("unknown", "unknown")
    conventions, guesses = [], []
    if not is_anatomical:
        guesses.append(
            "axes without anatomy, sample (0, 0, 0) at the origin: the file has no orientation (its qform and sform "
            "codes are 0, or it is Analyze), only distances"
        )
    ours = "mm" if unit in MM_PER_UNIT else None
    if ours is None and is_anatomical:
        ours = "mm"
        conventions.append("unit mm: the file names none; programs that read NIfTI take millimetres")
    zooms = header.get_zooms()
    step = float(zooms[3]) if n_times > 1 and len(zooms) > 3 and zooms[3] > 0 else None
    return Facts(
        unit=ours,
        is_anatomical=is_anatomical,
        n_times=max(n_times, 1),
        time_step=step,
        time_unit=TIME_UNITS.get(time_unit) if step is not None else None,
        conventions=tuple(conventions),
        guesses=tuple(guesses),
    )
