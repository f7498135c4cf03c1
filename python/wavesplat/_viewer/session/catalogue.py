"""The volumes, segmentations and shapes that a viewer has open, by the numbers that its documents name them with.

The page names no files: a layer's document holds `{"path": null, "name": "ct", "id": 3}`, and 3 is looked up here. So a
document from before a layer was added or removed still describes a scene, and undo needs nothing of its own.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume.volume import Volume
from wavesplat._scene.layer import Layer
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

#: Largest number of things that are kept, and of bytes of their samples in memory; the least recently used are dropped
#: first. The scene that is shown holds its own, so that only steps of undo are lost.
MAX_ENTRIES, MAX_BYTES = 32, 4 << 30


@dataclass(frozen=True, eq=False)
class Entry:
    """A volume, segmentation or shape that is open.

    number : by which documents name it.
    thing : `Layer`, of which the volume and the field of its colours count; `Labels`; or a shape.
    fields : what documents say of it: the field `volume` of layers and labels, all fields of a shape.
    source : where it comes from, as in files; None of shapes, which know it themselves.
    color_field : the field that colours a layer, as in files; None without any.
    """

    number: int
    thing: Any
    fields: Mapping[str, Any]
    source: dict[str, Any] | None = None
    color_field: dict[str, Any] | None = None

    def holds(self, thing: object) -> bool:
        """Whether this is the entry of a thing: of a layer, if volume and colours are the same objects."""
        if isinstance(thing, Layer) and isinstance(self.thing, Layer):
            return self.thing.volume is thing.volume and _is_same_field(self.thing.color_from, thing.color_from)
        return self.thing is thing


class Catalogue:
    """Entries by their numbers; used by several threads.

    Attributes
    ----------
    first_views : dict
        The view that a viewer began with, by the number of the first layer that it showed.
    """

    def __init__(self, entries: Iterable[Entry] = (), first: int = 1) -> None:
        self.first_views: dict[int, Any] = {}
        self._entries = {entry.number: entry for entry in entries}
        self._next = first
        self._lock = threading.Lock()

    def add(
        self,
        thing: Any,
        fields: Mapping[str, Any],
        source: dict[str, Any] | None = None,
        color_field: dict[str, Any] | None = None,
    ) -> Entry:
        """The entry of a thing, which is made if there is none."""
        with self._lock:
            for entry in self._entries.values():
                if entry.holds(thing):
                    return entry
            number, self._next = self._next, self._next + 1
            made = self._entries[number] = Entry(number, thing, {**fields, "id": number}, source, color_field)
            self._drop_old()
            return made

    def find(self, number: object, kind: type, what: str) -> Entry:
        """The entry of a number.

        Raises
        ------
        ArgumentError
            If there is none of this kind, or it was dropped.
        """
        with self._lock:
            entry = self._entries.get(number) if isinstance(number, int) and not isinstance(number, bool) else None
            if entry is None or not isinstance(entry.thing, kind):
                raise ArgumentError(
                    f"{what} is {described(number)}, which is not open here, or no more; open its file again"
                )
            # The most recently used is the last one.
            self._entries[entry.number] = self._entries.pop(entry.number)
            return entry

    def reduced_to(self, things: Iterable[object]) -> Catalogue:
        """Another catalogue with the entries of some things; numbers that were used are not used again."""
        kept = list(things)
        with self._lock:
            found = [entry for entry in self._entries.values() if any(entry.holds(thing) for thing in kept)]
            made = Catalogue(found, self._next)
            numbers = {entry.number for entry in found}
            made.first_views = {number: view for number, view in self.first_views.items() if number in numbers}
            return made

    def _drop_old(self) -> None:
        total = sum(_n_bytes(entry.thing) for entry in self._entries.values())
        for number in list(self._entries)[:-1]:
            if len(self._entries) <= MAX_ENTRIES and total <= MAX_BYTES:
                return
            total -= _n_bytes(self._entries.pop(number).thing)
            self.first_views.pop(number, None)


def _is_same_field(one: Any, other: Any) -> bool:
    return one is other or (one is not None and other is not None and one.volume is other.volume)


def _n_bytes(thing: Any) -> int:
    volume = thing.volume if isinstance(thing, Layer) else None
    if not isinstance(volume, Volume) or isinstance(volume, LazyVolume):
        return 0
    return int(volume.samples.nbytes)
