"""An array of samples that are read on demand: what readers, streams and surveys ask of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume.stack import Box
from wavesplat._storage.file_states import SourceFiles

Shape = tuple[int, int, int]


class LazyArray(Protocol):
    """An array of samples [z, y, x] that are read on demand."""

    @property
    def shape(self) -> Shape:
        """Samples along z, y, x."""

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the samples that `read` returns, one that the renderer takes."""

    @property
    def chunks(self) -> Shape:
        """Samples of a chunk along z, y, x: those that are read at once."""

    @property
    def is_in_memory(self) -> bool:
        """Whether the samples are in memory, so that reading costs nothing."""

    @property
    def n_readers(self) -> int:
        """Threads that may read at once."""

    @property
    def reads_together(self) -> bool:
        """Whether several boxes are read faster together, by `read_many`."""

    @property
    def name(self) -> str:
        """Name in messages."""

    @property
    def token(self) -> str | None:
        """Name that identifies these samples within the same files or, without files, among all; None if none.

        A name does not identify content: surveys of arrays that have nothing but a name (of Dask, of an address) are
        only kept in a folder that the user has given.
        """

    @property
    def files(self) -> SourceFiles | None:
        """The files that hold all samples; None where samples are, or may be, from elsewhere."""

    def read(self, lo: Shape, hi: Shape) -> NDArray[Any]:
        """Read the samples of the box from `lo` to before `hi`; a `FileError` names the part that cannot be read."""

    def read_many(self, boxes: Sequence[Box]) -> list[NDArray[Any]]:
        """Read the samples of several boxes."""
