"""Metadata of Zarr stores, checked before zarr reads them: some codecs run code that the file contains.

The filter `pickle` of numcodecs runs whatever the file says: when a chunk is decoded, and in Zarr v2 already when the
array is opened, for the fill value. Releases of numcodecs from 0.16.6 on refuse it; older ones, and other codecs that
unpickle, do not.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from wavesplat._storage import size_checks
from wavesplat._storage.zarr.place import ZarrPlace
from wavesplat.errors import FileError

#: Documents that name codecs: of an array (v2), of an array or group (v3), and of all arrays below (v2).
DOCUMENTS = (".zarray", "zarr.json", ".zmetadata")
#: Fields that hold codecs, by their `id` (v2) or `name` (v3), some of them inside each other.
CODEC_FIELDS = ("filters", "compressor", "codecs", "storage_transformers")
#: Parts of the names of codecs that make objects by running what the file says.
UNSAFE = ("pickle", "dill")


def check_codecs(place: ZarrPlace, inner: str = "") -> None:
    """Raise a `FileError` if an array at `place`, or on the path to `inner` in it, would be unpickled."""
    parts = [part for part in inner.split("/") if part]
    for n in range(len(parts) + 1):
        for document in DOCUMENTS:
            key = "/".join([*parts[:n], document])
            text = place.read(key)
            if text is None:
                continue
            for codec in _codecs(json.loads(text)):
                if any(word in codec.lower() for word in UNSAFE):
                    raise FileError(
                        f"an array is packed by {codec!r}, which would run what the file says; "
                        f"store it again as plain numbers, without that filter: {place}"
                    )


def check_numbers(array: Any, path: object) -> None:
    """Raise a `FileError` if the samples are no numbers, or do not fit into memory; nothing is decoded for it."""
    if array.dtype.kind not in "biufc":
        raise FileError(f"samples of type {array.dtype} are not numbers; store them as integers or floats: {path}")
    size_checks.check_memory(size_checks.n_bytes(sorted(array.shape)[-3:], array.dtype), path)


def names(place: ZarrPlace) -> list[str]:
    """Names beside the metadata of a group; empty where a store cannot list them."""
    found = place.names()
    if found:
        return found
    # Metadata of a whole store in one document: of Zarr v2, and of v3.
    for document, kind in ((".zmetadata", "metadata"), ("zarr.json", "consolidated_metadata")):
        text = place.read(document)
        whole = {} if text is None else json.loads(text).get(kind) or {}
        keys = whole.get("metadata", whole) if isinstance(whole, dict) else {}
        listed = {key.partition("/")[0] for key in keys}
        if listed:
            return sorted(name for name in listed if not name.startswith("."))
    return []


def _codecs(document: Any, is_codec: bool = False) -> Iterator[str]:
    """Names of all codecs in a document. `is_codec`: the document is the value of a field of codecs."""
    if isinstance(document, list):
        for part in document:
            yield from _codecs(part, is_codec)
    elif isinstance(document, dict):
        for field, part in document.items():
            if is_codec and field in ("id", "name"):
                yield str(part)
            if field != "attributes":
                yield from _codecs(part, is_codec or field in CODEC_FIELDS)
