"""Checks of lazy volumes' files for changes: once at the start of a picture, so that all of it shows one state.

Outside of pictures they are checked before each answer. A change empties the cache of a lazy volume.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from wavesplat._files.file_states import SourceFiles

if TYPE_CHECKING:
    from wavesplat._model.stack import Box
    from wavesplat._model.survey import Survey

#: `id`s of the files that were checked for the picture that is being made; None outside of pictures.
_LOOKED_AT: ContextVar[set[int] | None] = ContextVar("looked_at", default=None)


@runtime_checkable
class _OfFiles(Protocol):
    def notice_changes(self) -> None:
        """Drop everything computed from samples that have changed."""


@contextmanager
def comparing_once(volumes: Iterable[object]) -> Iterator[None]:
    """Compare some volumes with their files now, and not again while a picture of them is made.

    Raises
    ------
    FileError
        If a file has changed that must be opened again.
    """
    if _LOOKED_AT.get() is not None:
        compare(volumes)
        yield
        return
    token = _LOOKED_AT.set(set())
    try:
        compare(volumes)
        yield
    finally:
        _LOOKED_AT.reset(token)


def compare(volumes: Iterable[object]) -> None:
    """Compare lazy volumes with their files, except for files that were checked for this picture."""
    for volume in volumes:
        if isinstance(volume, _OfFiles):
            volume.notice_changes()


def look_again(files: SourceFiles) -> None:
    """Check files for changes, if that was not done for this picture."""
    looked_at = _LOOKED_AT.get()
    if looked_at is not None:
        if id(files) in looked_at:
            return
        looked_at.add(id(files))
    files.look_again()


class LazyCache:
    """Cache of the lazy volumes that read the same levels with the same budget: surveys, and data made of them.

    n_changes : number of changes found in the files so far.
    """

    def __init__(self, n_changes: int) -> None:
        self.n_changes = n_changes
        #: Number of calls of `forget`, by which scenes see whether their looks still fit the samples.
        self.generation = 0
        #: Surveys by level, kernel and box that was read (None: all), and data made of them, the latest last.
        self.surveys: dict[tuple[int, str, Box | None], Survey] = {}
        self.derived: dict[Any, Any] = {}

    def forget(self) -> None:
        """Drop everything: the samples have changed."""
        self.surveys.clear()
        self.derived.clear()
        self.generation += 1
