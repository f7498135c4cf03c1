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
from wavesplat._model.nibabel_image import facts_of, scaled, world_from_index
from wavesplat._readers.request import Grid, Request, choose, quiet
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from nibabel.spatialimages import SpatialImage

__all__ = ["checked_picks", "facts_of", "read", "world_from_index"]


def read(request: Request) -> Grid:
    """The volume in a NIfTI file, or one of its time points or channels."""
    import nibabel

    with reading("NIfTI", request.path), quiet("nibabel.global"):
        image: Any = nibabel.load(request.file)
        _check_payload(image, request)
        stored = _one_volume(image, request)
        return Grid(_scaled(stored, image).T, world_from_index(image), facts_of(image))


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
    time, channel, _ = checked_picks(image, request)
    extra = (time, channel, 0, 0)[: max(len(image.shape) - 3, 0)]
    with _stored_bytes(proxy, request.kept) as file:
        unscaled = ArrayProxy(file, (image.shape, proxy.dtype, proxy.offset, 1.0, 0.0), mmap=False)
        samples: NDArray[Any] = np.asarray(unscaled[(..., *extra)] if extra else unscaled)
    if _has_colors(proxy):
        names = proxy.dtype.names
        samples = samples[names[choose("channel", len(names), request.channel, request.path)]]
    return samples


def checked_picks(image: SpatialImage, request: Request) -> tuple[int, int, str | None]:
    """Time point and channel that are asked for; and the first name of the samples' parts where they are colours."""
    proxy: Any = image.dataobj
    # NIfTI's axes are x, y, z, time, vector component; what follows must have size 1.
    sizes = [*image.shape, *[1] * (7 - len(image.shape))]
    if max(sizes[5:]) > 1:
        raise FileError(
            f"the file is {len(image.shape)}-D, shape {image.shape}; export one volume of it: {request.path}"
        )
    time = choose("time", sizes[3], request.time, request.path)
    channel = 0 if _has_colors(proxy) else choose("channel", sizes[4], request.channel, request.path)
    return time, channel, proxy.dtype.names[0] if _has_colors(proxy) else None


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
    proxy: Any = image.dataobj
    return scaled(stored, float(proxy.slope), float(proxy.inter))
