"""Reading boxes of samples by a few threads, ahead of what is drawn from them.

Samples are read in parts along the chunks of their file, of a few megabytes, so that the memory of a part, beside its
place in the box, is small. A chunk that cannot be read ends the picture with an error that names it; where holes are
allowed, it is drawn as the smallest sample value, and reported.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_EXCEPTION, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.lazy.lazy_array import LazyArray
from wavesplat._model.lazy.memory_budget import UNPACKED_TIMES, unpacked_bytes
from wavesplat._model.volume.stack import Box
from wavesplat._storage.file_states import FileChangedError
from wavesplat.errors import FileError

#: Size of a part, in bytes, at most, except that a part has at least one chunk.
PART_BYTES = 8 << 20


@dataclass
class ReadCounts:
    """Counts and times of the reads for a picture."""

    n_bytes: int = 0
    n_boxes: int = 0
    #: Time from the first box to the last, and the part of it that drawing waited for samples; both in seconds.
    seconds: float = 0.0
    waited: float = 0.0
    #: Errors of the boxes that could not be read, where holes are allowed.
    holes: list[str] = field(default_factory=list)


class SampleBuffers:
    """Memory for the samples of each array, two pieces that are used in turns.

    A step of drawing has its samples in one piece while the next step's samples are read into the other. New memory for
    each step would be cleared and mapped by the system page by page, which costs more than reading it does.
    """

    def __init__(self) -> None:
        self._pieces: dict[tuple[int, int], NDArray[np.uint8]] = {}
        self._turns: dict[int, int] = {}

    def zeros(self, which: int, shape: Sequence[int], dtype: np.dtype[Any]) -> NDArray[Any]:
        """An array of zeros in the piece that was used least recently for the array of this number.

        Its samples are two steps old, and the step that drew from them is over.
        """
        turn = self._turns[which] = 1 - self._turns.get(which, 0)
        n_bytes = math.prod(shape) * dtype.itemsize
        piece = self._pieces.get((which, turn))
        if piece is None or piece.nbytes < n_bytes:
            self._pieces.pop((which, turn), None)  # before there is another one
            piece = self._pieces[which, turn] = np.zeros(n_bytes, np.uint8)
        else:
            piece[:n_bytes] = 0
        return piece[:n_bytes].view(dtype).reshape(shape)


class BoxReader:
    """A pool of threads that fill boxes.

    arrays : the arrays to read; as many threads as the largest of their `n_readers`, or as `memory` allows.
    holes : for each array the value of samples that cannot be read; None raises their error.
    memory : bytes for what all threads unpack at once; None does not bound it. A single chunk is always read.
    """

    def __init__(
        self, arrays: Sequence[LazyArray], *, holes: Sequence[float] | None = None, memory: int | None = None
    ) -> None:
        self._arrays = arrays
        self._holes = holes
        n_threads, self._part_bytes = max(array.n_readers for array in arrays), PART_BYTES
        if memory is not None:
            n_threads = min(n_threads, max(1, memory // max(1, *map(unpacked_bytes, arrays))))
            self._part_bytes = min(PART_BYTES, memory // (UNPACKED_TIMES * n_threads))
        self._pool = ThreadPoolExecutor(n_threads, "wavesplat-read")
        self._lock = threading.Lock()
        self._stopped = False
        self.counts = ReadCounts()

    def begin(self, which: int, held: Box, boxes: Sequence[Box], buffers: SampleBuffers | None = None) -> Pending:
        """Begin to read some boxes into the samples of the box `held` of array `which`, which are 0 elsewhere.

        buffers : memory for the samples; None takes new memory.
        """
        array = self._arrays[which]
        low, high = held
        shape = [b - a for a, b in zip(low, high, strict=True)]
        samples = np.zeros(shape, array.dtype) if buffers is None else buffers.zeros(which, shape, array.dtype)
        pending = Pending(samples)
        if hasattr(array, "read_many") and getattr(array, "reads_together", False):
            pending.parts.append(self._pool.submit(self._read_together, which, samples, low, list(boxes)))
            return pending
        for box in boxes:
            for part in cells(box, array.chunks, max(self._part_bytes // array.dtype.itemsize, 1)):
                pending.parts.append(self._pool.submit(self._read, which, samples, low, part))
        return pending

    def _read(self, which: int, samples: NDArray[Any], low: Sequence[int], box: Box) -> None:
        if self._stopped:
            return
        array = self._arrays[which]
        self._put(which, samples, low, box, partial(fill_box, array, box))

    def _read_together(self, which: int, samples: NDArray[Any], low: Sequence[int], boxes: list[Box]) -> None:
        if self._stopped or not boxes:
            return
        array = self._arrays[which]
        try:
            parts = array.read_many(boxes)
        except FileChangedError:
            raise
        except FileError:
            if self._holes is None:
                raise
            for box in boxes:
                self._put(which, samples, low, box, partial(fill_box, array, box))
            return
        for box, part in zip(boxes, parts, strict=True):
            self._put(which, samples, low, box, partial(_copy, array, box, part))

    def _put(
        self,
        which: int,
        samples: NDArray[Any],
        low: Sequence[int],
        box: Box,
        fill: Callable[[NDArray[Any]], None],
    ) -> None:
        """Fill the samples of a box by a function, or by the value of holes."""
        place = tuple(slice(a - first, b - first) for a, b, first in zip(*box, low, strict=True))
        try:
            fill(samples[place])
        except FileChangedError:
            raise  # no hole: nothing that is known of the samples holds any more
        except FileError as error:
            if self._holes is None:
                raise
            array = self._arrays[which]
            chunks = cells(box, array.chunks, 1)
            if len(chunks) > 1:
                # All but the chunks that cannot be read are drawn.
                for chunk in chunks:
                    self._put(which, samples, low, chunk, partial(fill_box, array, chunk))
                return
            samples[place] = self._holes[which]
            with self._lock:
                self.counts.holes.append(str(error))
        with self._lock:
            self.counts.n_boxes += 1
            self.counts.n_bytes += samples[place].nbytes

    def stop(self) -> None:
        """Cancel the reads that have not begun, and wait for the others."""
        self._stopped = True
        self._pool.shutdown(wait=True, cancel_futures=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


def fill_box(array: LazyArray, box: Box, out: NDArray[Any]) -> None:
    """Read the samples of a box into an array of zeros, chunk by chunk where its source can."""
    if hasattr(array, "read_into"):
        array.read_into(*box, out)
    else:
        _copy(array, box, array.read(*box), out)


def _copy(array: LazyArray, box: Box, part: NDArray[Any], out: NDArray[Any]) -> None:
    """Copy the samples of a box that were read; a `FileError` if they have another shape."""
    if part.shape != out.shape:
        raise FileError(
            f"{array.name!r}: samples {box[0]} to {box[1]} (z, y, x) came with shape {part.shape}, not {out.shape}; "
            "mend what gives them"
        )
    out[...] = part


@dataclass
class Pending:
    """Samples that are being read."""

    _samples: NDArray[Any]
    parts: list[Future[None]] = field(default_factory=list)

    def result(self) -> NDArray[Any]:
        """Wait for all parts, and return the samples."""
        for part in self.parts:
            part.result()
        return self._samples

    def is_there(self, timeout: float) -> bool:
        """Wait `timeout` seconds at most; return whether all parts are read, or one has failed."""
        return not wait(self.parts, timeout, FIRST_EXCEPTION).not_done or any(
            part.done() and part.exception() is not None for part in self.parts
        )

    @property
    def samples(self) -> NDArray[Any]:
        """The samples, whether they are complete or not."""
        return self._samples


def cells(box: Box, chunks: Sequence[int], most: int) -> list[Box]:
    """Cut a box along the borders of chunks into boxes of at most `most` samples, but at least one chunk.

    No part ends within a chunk, so none is unpacked twice for one box.
    """
    low, high = box
    size = list(chunks)
    # Chunks put together, first along x, then along y, then along z.
    for axis in (2, 1, 0):
        others = 1
        for other in range(3):
            if other != axis:
                others *= min(size[other], high[other] - low[other])
        n = max(1, most // max(1, others * chunks[axis]))
        size[axis] = chunks[axis] * n
    ranges = []
    for axis in range(3):
        first, end, step = low[axis], high[axis], size[axis]
        places = [first, *range((first // step + 1) * step, end, step), end]
        ranges.append([(a, b) for a, b in pairwise(places) if a < b])
    return [((z[0], y[0], x[0]), (z[1], y[1], x[1])) for z in ranges[0] for y in ranges[1] for x in ranges[2]]


def n_in(box: Box) -> int:
    """Number of samples in a box."""
    return math.prod(b - a for a, b in zip(*box, strict=True))


def copy_overlap(before: NDArray[Any], of: Box, samples: NDArray[Any], held: Box) -> None:
    """Copy the intersection of two boxes from `before`, the samples of the box `of`, to `samples` of the box `held`."""
    low = [max(a, b) for a, b in zip(of[0], held[0], strict=True)]
    high = [min(a, b) for a, b in zip(of[1], held[1], strict=True)]
    if any(a >= b for a, b in zip(low, high, strict=True)):
        return
    there, here = (
        tuple(slice(a - first, b - first) for a, b, first in zip(low, high, box[0], strict=True)) for box in (of, held)
    )
    samples[here] = before[there]
