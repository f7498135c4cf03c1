"""Drawing a lazy volume: boxes are read ahead while those before are drawn, within a memory budget.

The compiled module plans (`_native.Stream`): blocks of the base plane, and for each the steps in the order of the
sheets with the boxes that they need. Here the boxes are read by a few threads, one step ahead.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.lazy.lazy_array import LazyArray
from wavesplat._model.lazy.memory_budget import FOR_SAMPLES, FOR_UNPACKING
from wavesplat._model.lazy.read_ahead import BoxReader, Pending, ReadCounts, SampleBuffers, copy_overlap
from wavesplat._model.volume.stack import Box
from wavesplat._system.memory import byte_size, trim_heap
from wavesplat.errors import CancelledError, LimitError

Progress = Callable[[float], object]
#: Lower and upper corner (x, y, z) of a box in index space; infinite where it has no face.
Corners = tuple[Sequence[float], Sequence[float]]


@dataclass
class Streaming:
    """Memory and division into blocks and segments of a streamed picture."""

    #: Bytes for samples and bounds.
    memory: int
    #: Least number of blocks of each base plane.
    n_blocks: int = 1
    #: Slices of a segment of the rays, where they are cut into segments.
    segment_slices: int | None = None
    #: The part of space that is drawn, where other processes draw the rest.
    part: Corners | None = None

    def planned(self, layers: Sequence[Any], camera: Any, frame: _native.FrameArguments) -> _native.Stream:
        """The stream of a frame; a `LimitError` names the memory that suffices."""
        budget = int(self.memory * FOR_SAMPLES)
        try:
            return _native.Stream(layers, camera, frame, budget, self.n_blocks, self.segment_slices, self.part)
        except LimitError:
            pass
        least = _native.smallest_budget(layers, camera, frame, self.segment_slices)
        needed = int(least / FOR_SAMPLES * 1.01)
        raise LimitError(
            f"memory is {byte_size(self.memory)}, and the smallest step of this picture needs {byte_size(needed)}; "
            f'give memory="{-(-needed // 10**6)} MB" or more, store the samples in smaller chunks, '
            "or draw a coarser level"
        )


@dataclass
class Reading:
    """Arrays of the layers' samples, and the callback and counts of reading."""

    arrays: Sequence[LazyArray]
    #: Value in place of each layer's samples that cannot be read; None ends the picture.
    least: Sequence[float] | None
    progress: Progress | None = None
    #: Budget, bytes; None reads without one.
    memory: int | None = None
    counts: ReadCounts = field(default_factory=ReadCounts)
    buffers: SampleBuffers = field(default_factory=SampleBuffers)

    def part(self, before: float, share: float) -> Reading:
        """The reading with progress as a part of the work, from `before` on and `share` long."""
        progress = self.progress
        report = None if progress is None else lambda done: progress(before + share * done)
        return replace(self, progress=report)


def streamed(
    stream: _native.Stream,
    reading: Reading,
    after_block: Callable[[_native.Stream, int], object] | None = None,
) -> ReadCounts:
    """Draws all blocks of a stream."""
    weights = [stream.n_texels(block) for block in range(stream.n_blocks)]
    whole, done = max(sum(weights), 1), 0
    for block, weight in enumerate(weights):
        stream.put(block, draw_block(stream, block, reading.part(done / whole, weight / whole)))
        done += weight
        if after_block is not None:
            after_block(stream, block)
    return reading.counts


def draw_block(stream: _native.Stream, block: int, reading: Reading) -> _native.BlockState:
    """Draws a block through all its segments, and returns the state of its rays."""
    n_steps = stream.n_steps(block)
    states = [
        draw_segment(stream, block, steps, reading.part(steps[0] / n_steps, (steps[1] - steps[0]) / n_steps))
        for steps in stream.segments(block)
    ]
    return states[0] if len(states) == 1 else stream.fold(states)


def draw_segment(stream: _native.Stream, block: int, steps: tuple[int, int], reading: Reading) -> _native.BlockState:
    """Draws some consecutive steps of a block from nothing, the boxes of the next step being read meanwhile."""
    first, end = steps
    state = _native.BlockState()
    started = time.perf_counter()
    waited = 0.0
    for_unpacking = None if reading.memory is None else int(reading.memory * FOR_UNPACKING)
    with BoxReader(reading.arrays, holes=reading.least, memory=for_unpacking) as reader:
        ahead = _asked(stream, block, first, is_first=True, state=state, reader=reader, buffers=reading.buffers)
        for step in range(first, end):
            held, boxes = stream.held(block, step), ahead
            own = reading.part((step - first) / (end - first), 1 / (end - first))
            before_waiting = time.perf_counter()
            samples = _all(boxes, own.progress)
            waited += time.perf_counter() - before_waiting
            if step + 1 < end:
                # The next reads are chosen by the rays' state before this step, so that they run while it is drawn.
                ahead = _asked(
                    stream, block, step + 1, is_first=False, state=state, reader=reader, buffers=reading.buffers
                )
                for k, box in enumerate(stream.held(block, step + 1)):
                    copy_overlap(samples[k], held[k], ahead[k].samples, box)
            state = stream.draw(block, step, samples, state, own.progress)
            del samples
            if stream.is_done(block, state):
                break
        reader.stop()
        counts = reading.counts
        counts.n_bytes += reader.counts.n_bytes
        counts.n_boxes += reader.counts.n_boxes
        counts.holes += reader.counts.holes
    trim_heap()
    counts.seconds += time.perf_counter() - started
    counts.waited += waited
    return state


def _asked(
    stream: _native.Stream,
    block: int,
    step: int,
    *,
    is_first: bool,
    state: _native.BlockState,
    reader: BoxReader,
    buffers: SampleBuffers,
) -> list[Pending]:
    held = stream.held(block, step)
    reads: Iterable[list[Box]] = stream.reads(block, step, is_first, state)
    return [reader.begin(k, box, boxes, buffers) for k, (box, boxes) in enumerate(zip(held, reads, strict=True))]


#: Seconds between checks, in a wait, whether the picture is still wanted.
LOOK_EVERY = 0.05


def _all(pending: Sequence[Pending], progress: Progress | None) -> list[NDArray[Any]]:
    """Wait for the samples; meanwhile, the callback is asked whether to go on."""
    for one in pending:
        while progress is not None and not one.is_there(LOOK_EVERY):
            if progress(0.0) is False:
                raise CancelledError("rendering was cancelled by the progress callback")
    return [np.ascontiguousarray(one.result()) for one in pending]
