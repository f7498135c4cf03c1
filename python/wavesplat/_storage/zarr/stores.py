"""A `ZarrPlace` as a store of zarr, which this imports at once."""

# ruff: noqa: ARG002 - the arguments are zarr's

from __future__ import annotations

from collections.abc import AsyncIterator, Iterable
from pathlib import Path
from typing import Any

from zarr.abc.store import OffsetByteRequest, RangeByteRequest, Store, SuffixByteRequest

from wavesplat._storage.web import Part
from wavesplat._storage.zarr.place import READ_ONLY, ZarrPlace

NO_KEYS: tuple[str, ...] = ()


class PlaceStore(Store):
    """A read-only store of the keys of a place, which are not listed."""

    supports_writes = False
    supports_deletes = False
    supports_partial_writes = False
    supports_listing = False

    def __init__(self, place: ZarrPlace) -> None:
        super().__init__(read_only=True)
        self.place = place

    @property
    def root(self) -> Path | None:
        """The folder; None for an address."""
        return self.place.root

    async def get(self, key: str, prototype: Any = None, byte_range: Any = None) -> Any:
        """The bytes at a key, as a buffer; None if there are none."""
        from zarr.core.buffer import default_buffer_prototype

        content = await self.place.read_async(key, _part(byte_range))
        buffer = (prototype or default_buffer_prototype()).buffer
        return None if content is None else buffer.from_bytes(content)

    async def get_partial_values(self, prototype: Any, key_ranges: Iterable[tuple[str, Any]]) -> list[Any]:
        """Buffers of the wanted parts of several keys."""
        return [await self.get(key, prototype, byte_range) for key, byte_range in key_ranges]

    async def exists(self, key: str) -> bool:
        """Whether something lies at a key."""
        return await self.place.read_async(key) is not None

    async def set(self, key: str, value: Any) -> None:
        """Raise a `PermissionError`: places are only read."""
        raise PermissionError(READ_ONLY)

    async def set_partial_values(self, key_start_values: Any) -> None:
        """Raise a `PermissionError`: places are only read."""
        raise PermissionError(READ_ONLY)

    async def delete(self, key: str) -> None:
        """Raise a `PermissionError`: places are only read."""
        raise PermissionError(READ_ONLY)

    async def list(self) -> AsyncIterator[str]:
        """No keys: places are not listed."""
        for key in NO_KEYS:
            yield key

    async def list_prefix(self, prefix: str) -> AsyncIterator[str]:
        """No keys: places are not listed."""
        for key in NO_KEYS:
            yield key

    async def list_dir(self, prefix: str) -> AsyncIterator[str]:
        """No keys: places are not listed."""
        for key in NO_KEYS:
            yield key

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PlaceStore) and self.place == other.place

    __hash__ = None  # type: ignore[assignment]

    def __str__(self) -> str:
        return str(self.place)


def _part(byte_range: Any) -> Part:
    """The range of bytes that a request of zarr asks for."""
    if isinstance(byte_range, RangeByteRequest):
        return byte_range.start, byte_range.end
    if isinstance(byte_range, OffsetByteRequest):
        return byte_range.offset, None
    if isinstance(byte_range, SuffixByteRequest):
        return -byte_range.suffix, None
    return None
