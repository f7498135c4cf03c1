"""Stores for the installed release of zarr that read from a `ZarrPlace`."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from typing import Any

from wavesplat._files.zarr_place import METADATA_NAMES, READ_ONLY, ZarrPlace

__all__ = ["place_of", "store_of"]


class PlaceMapping(MutableMapping[str, bytes]):
    """A place as a mapping from keys to bytes, the store of zarr 2."""

    def __init__(self, place: ZarrPlace) -> None:
        self.place = place

    def __getitem__(self, key: str) -> bytes:
        content = self.place.read(key)
        if content is None:
            raise KeyError(key)
        return content

    def __contains__(self, key: object) -> bool:
        return isinstance(key, str) and self.place.read(key) is not None

    def __setitem__(self, key: str, value: bytes) -> None:
        raise PermissionError(READ_ONLY)

    def __delitem__(self, key: str) -> None:
        raise PermissionError(READ_ONLY)

    def __iter__(self) -> Iterator[str]:
        # Keys of metadata alone: zarr lists nothing else here.
        return (key for key in METADATA_NAMES if key in self)

    def __len__(self) -> int:
        return sum(1 for _ in self)


def store_of(place: ZarrPlace) -> Any:
    """The store for `zarr.open` that reads from a place."""
    import zarr

    if int(zarr.__version__.partition(".")[0]) < 3:
        return PlaceMapping(place)
    from wavesplat._files.zarr3_store import PlaceStore

    return PlaceStore(place)


def place_of(array: Any) -> ZarrPlace | None:
    """The place of an array or group that was opened with `store_of`; None for other stores."""
    store = getattr(getattr(array, "store_path", None), "store", None) or getattr(array, "store", None)
    # zarr 2 wraps mappings.
    found = getattr(store, "place", None) or getattr(getattr(store, "_mutable_mapping", None), "place", None)
    return found if isinstance(found, ZarrPlace) else None
