"""What a Zarr store says of its arrays, looked at before zarr is asked, because some of it is a program.

The filter `pickle` of numcodecs runs whatever the file says: when a chunk is decoded, and in Zarr v2 already when the
array is opened, for the fill value. Releases of numcodecs from 0.16.6 on refuse it; older ones, and other codecs that
unpickle, do not.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from wavesplat._files import payload
from wavesplat.errors import FileError

__all__ = ["check_codecs", "check_numbers", "names"]

#: Documents that name codecs: of an array (v2), of an array or group (v3), and of all arrays below (v2).
DOCUMENTS = (".zarray", "zarr.json", ".zmetadata")
#: Fields that hold codecs, by their `id` (v2) or `name` (v3), some of them inside each other.
CODEC_FIELDS = ("filters", "compressor", "codecs", "storage_transformers")
#: Parts of the names of codecs that make objects by running what the file says.
UNSAFE = ("pickle", "dill")


def check_codecs(location: str, inner: str = "") -> None:
    """A `FileError` if what is stored at `location`, or on the way to `inner` in it, is to be unpickled."""
    import fsspec

    store = fsspec.get_mapper(location)
    parts = [part for part in inner.split("/") if part]
    for n in range(len(parts) + 1):
        for document in DOCUMENTS:
            key = "/".join([*parts[:n], document])
            try:
                text = store[key]
            except KeyError:
                continue
            for codec in _codecs(json.loads(text)):
                if any(word in codec.lower() for word in UNSAFE):
                    raise FileError(
                        f"an array is packed by {codec!r}, which would run what the file says; "
                        f"store it again as plain numbers, without that filter: {location}"
                    )


def check_numbers(array: Any, path: object) -> None:
    """A `FileError` if the samples are no numbers, or do not fit into memory; nothing is decoded for it."""
    if array.dtype.kind not in "biufc":
        raise FileError(f"samples of type {array.dtype} are not numbers; store them as integers or floats: {path}")
    payload.check_memory(payload.n_bytes(sorted(array.shape)[-3:], array.dtype), path)


def names(location: str) -> list[str]:
    """What lies beside the metadata of a group; empty where a store cannot tell."""
    import fsspec

    files, root = fsspec.url_to_fs(location)
    try:
        found = [path.rstrip("/").rpartition("/")[2] for path in files.ls(root, detail=False)]
    except (OSError, NotImplementedError):
        return []
    return sorted(name for name in found if not name.startswith(".") and name != "zarr.json")


def _codecs(document: Any, is_codec: bool = False) -> Iterator[str]:
    """Names of all codecs in a document. `is_codec`: it is what a field of codecs holds."""
    if isinstance(document, list):
        for part in document:
            yield from _codecs(part, is_codec)
    elif isinstance(document, dict):
        for field, part in document.items():
            if is_codec and field in ("id", "name"):
                yield str(part)
            if field != "attributes":
                yield from _codecs(part, is_codec or field in CODEC_FIELDS)
