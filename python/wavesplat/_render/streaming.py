"""Drawing a lazy volume: boxes are read ahead while those before are drawn, within a memory budget.

The compiled module plans (`_native.Stream`): blocks of the base plane, and for each the steps in the order of the sheets with
the boxes that they need. Here the boxes are read by a few threads, one step ahead.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._files.byte_sizes import byte_size
from wavesplat._model.lazy_array import LazyArray
from wavesplat._model.read_ahead import Box, BoxReader, Pending, ReadCounts, joined
from wavesplat.errors import CancelledError, LimitError

__all__ = ["Streaming", "draw_block", "draw_segment", "streamed"]

#: Share of a budget that is for the samples of two steps; the rest is for bounds and for what is being unpacked.
FOR_SAMPLES = 0.5

Progress = Callable[[float], object]


@dataclass
class Streaming:
    """How a picture is streamed."""

    #: Bytes for samples and bounds.
    memory: int
    #: At least so many blocks of each base plane.
    n_blocks: int = 1
    #: Slices of a segment of the rays, where they are cut into segments.
    segment_slices: int | None = None
    counts: ReadCounts = field(default_factory=ReadCounts)

    def planned(self, layers: Sequence[Any], camera: Any, frame: _native.FrameArguments) -> _native.Stream:
        """The stream of a frame; a `LimitError` says how much memory would do."""
        budget = int(self.memory * FOR_SAMPLES)
        try:
            return _native.Stream(layers, camera, frame, budget, self.n_blocks, self.segment_slices)
        except LimitError:
            pass
        needed = self._smallest(layers, camera, frame, budget)
        raise LimitError(
            f"memory is {byte_size(self.memory)}, and the smallest step of this picture needs {byte_size(needed)}; "
            f'give memory="{-(-needed // 10**6)} MB" or more, store the samples in smaller chunks, '
            "or draw a coarser level"
        )

    def _smallest(self, layers: Sequence[Any], camera: Any, frame: _native.FrameArguments, budget: int) -> int:
        """The smallest memory that works, to a few percent."""

        def works(budget: int) -> bool:
            try:
                _native.Stream(layers, camera, frame, budget, self.n_blocks, self.segment_slices)
            except LimitError:
                return False
            return True

        too_small, enough = budget, 2 * budget
        while not works(enough):
            too_small, enough = enough, 2 * enough
        for _ in range(5):
            middle = (too_small + enough) // 2
            too_small, enough = (too_small, middle) if works(middle) else (middle, enough)
        return int(enough / FOR_SAMPLES)


def streamed(
    stream: _native.Stream,
    arrays: Sequence[LazyArray],
    least: Sequence[float] | None,
    progress: Progress | None,
    *,
    after_block: Callable[[_native.Stream, int], object] | None = None,
    counts: ReadCounts | None = None,
) -> ReadCounts:
    """Draws all blocks of a stream. `arrays`: of each layer; `least`: what is put where samples cannot be read."""
    told = counts if counts is not None else ReadCounts()
    weights = [stream.n_texels(block) for block in range(stream.n_blocks)]
    whole, done = max(sum(weights), 1), 0
    for block, weight in enumerate(weights):
        before, share = done / whole, weight / whole
        state = draw_block(stream, block, arrays, least, _part_of(progress, before, share), told)
        stream.put(block, state)
        done += weight
        if after_block is not None:
            after_block(stream, block)
    return told


def _part_of(progress: Progress | None, before: float, share: float) -> Progress | None:
    return None if progress is None else lambda done: progress(before + share * done)


def draw_block(
    stream: _native.Stream,
    block: int,
    arrays: Sequence[LazyArray],
    least: Sequence[float] | None,
    progress: Progress | None = None,
    counts: ReadCounts | None = None,
) -> _native.BlockState:
    """Draws a block through all its segments, and gives the state of its rays."""
    segments = stream.segments(block)
    n_steps = stream.n_steps(block)
    states = []
    for first, end in segments:
        part = _part_of(progress, first / n_steps, (end - first) / n_steps)
        states.append(draw_segment(stream, block, (first, end), arrays, least, part, counts))
    return states[0] if len(states) == 1 else stream.fold(states)


def draw_segment(
    stream: _native.Stream,
    block: int,
    steps: tuple[int, int],
    arrays: Sequence[LazyArray],
    least: Sequence[float] | None,
    progress: Progress | None = None,
    counts: ReadCounts | None = None,
) -> _native.BlockState:
    """Draws some consecutive steps of a block from nothing, the boxes of the next step being read meanwhile."""
    first, end = steps
    state = _native.BlockState()
    started = time.perf_counter()
    waited = 0.0
    with BoxReader(arrays, holes=least) as reader:
        ahead = _asked(stream, block, first, is_first=True, state=state, reader=reader)
        for step in range(first, end):
            held, boxes = stream.held(block, step), ahead
            before_waiting = time.perf_counter()
            samples = _all(boxes, progress, (step - first) / (end - first))
            waited += time.perf_counter() - before_waiting
            if step + 1 < end:
                # Asked for by what is known before this step is drawn.
                ahead = _asked(stream, block, step + 1, is_first=False, state=state, reader=reader)
                for k, box in enumerate(stream.held(block, step + 1)):
                    joined(samples[k], held[k], ahead[k].samples, box)
            part = _part_of(progress, (step - first) / (end - first), 1 / (end - first))
            state = stream.draw(block, step, samples, state, part)
            if state.is_done:
                break
        reader.stop()
        own = reader.counts
    if counts is not None:
        counts.n_bytes += own.n_bytes
        counts.n_boxes += own.n_boxes
        counts.holes += own.holes
        counts.seconds += time.perf_counter() - started
        counts.waited += waited
    return state


def _asked(
    stream: _native.Stream, block: int, step: int, *, is_first: bool, state: _native.BlockState, reader: BoxReader
) -> list[Pending]:
    held = stream.held(block, step)
    reads: Iterable[list[Box]] = stream.reads(block, step, is_first, state)
    return [reader.filled(k, box, boxes) for k, (box, boxes) in enumerate(zip(held, reads, strict=True))]


#: Seconds after which a wait looks whether the picture is still wanted.
LOOK_EVERY = 0.05


def _all(pending: Sequence[Pending], progress: Progress | None, done: float) -> list[NDArray[Any]]:
    """The samples, once they are there; asks meanwhile whether to go on."""
    for one in pending:
        while progress is not None and not one.is_there(LOOK_EVERY):
            if progress(done) is False:
                raise CancelledError("rendering was cancelled by the progress callback")
    return [np.ascontiguousarray(one.result()) for one in pending]
