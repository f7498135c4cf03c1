"""A picture over many machines: blocks of its base planes, or segments of blocks, as tasks of Dask.

A block is drawn front to back by one worker, which streams its boxes from the files: nothing is merged, every operator
works, and the bytes are the same as on one machine. With segments, a task is some slices of a block; their states are
folded from the front to the back, by one task for each block, so that the picture does not depend on which worker drew
a segment: one machine with the same segments draws the same picture. Segments are for data in workers' memory, and for
translucent volumes, all of which is seen.

Tasks are plain `dask.delayed`, at most some thousands for any volume; they can be run again, and are run again where a
worker is lost.
"""

from __future__ import annotations

import hashlib
import itertools
import pickle
import threading
import time
from collections import OrderedDict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from wavesplat import _native
from wavesplat._cluster.machines import MAX_TASKS, machines_of
from wavesplat._cluster.waiting import (
    N_RETRIES,
    check_times_lost,
    done,
    held,
    lost_scheduler_named,
    release,
    result_of,
    wait_for_scheduler,
)
from wavesplat._model.lazy.array import ComputedArray
from wavesplat._model.lazy.read_ahead import ReadCounts
from wavesplat._render.lazy_layers import FrameSpec
from wavesplat._render.streaming import Progress, Reading, draw_segment
from wavesplat._system.libraries import library
from wavesplat.errors import ArgumentError, CancelledError

#: Streams that a process keeps; the tasks of one picture share one.
MAX_STREAMS = 2

#: Result of a task: the state of its rays as bytes, bytes and boxes that were read, and holes that could not be.
Drawn = tuple[bytes, int, int, list[str]]


def drawn_on_machines(spec: FrameSpec, client: Any, progress: Progress | None) -> tuple[_native.Stream, ReadCounts]:
    """The stream of a frame with all blocks, and counts of what was read.

    client : a Dask client on whose workers the blocks are drawn; "threads" is Dask's scheduler in this process.
    """
    machines = machines_of(client)
    memory = min(machines.memory, spec.layers.memory)
    arguments = {**spec.arguments, "threads": machines.threads}
    spec = replace(spec, n_blocks=machines.n_blocks, memory=memory, arguments=arguments).with_surveys()
    stream = spec.stream()
    counts = ReadCounts()
    begun = time.perf_counter()
    plan = _Tasks(spec, stream)
    for block, drawn in plan.done(client, progress):
        state, n_bytes, n_boxes, holes = drawn
        stream.put(block, _native.BlockState.from_bytes(state))
        counts.n_bytes += n_bytes
        counts.n_boxes += n_boxes
        counts.holes += holes
    counts.seconds = time.perf_counter() - begun
    return stream, counts


class _Tasks:
    """The tasks of a frame."""

    def __init__(self, spec: FrameSpec, stream: _native.Stream) -> None:
        self._stream = stream
        self._packed = pickle.dumps(spec)
        self._token = hashlib.sha256(self._packed).hexdigest()[:16]
        self._spec = spec
        self._is_cut = spec.segments is not None
        n = sum(len(stream.segments(block)) if self._is_cut else 1 for block in range(stream.n_blocks))
        if n > MAX_TASKS:
            raise ArgumentError(
                f"this picture would take {n} tasks, and {MAX_TASKS} are the most; give longer segments, or workers "
                "more memory"
            )
        for array in spec.arrays:
            if isinstance(array, ComputedArray) and array.is_persisted and not self._is_cut:
                raise ArgumentError(
                    f"the Dask array of {array.name!r} lies in workers' memory, which is drawn in segments; "
                    "give segments=256, say"
                )

    def done(self, client: Any, progress: Progress | None) -> Iterator[tuple[int, Drawn]]:
        """Blocks and their results, as they are done."""
        costs = np.array(self._stream.bytes_to_read(), np.float64) + 1.0
        # The longest first: whatever the costs, that takes at most 4/3 of the shortest possible time (Graham 1969).
        order = [int(block) for block in np.argsort(-costs, kind="stable")]
        done_cost, whole = 0.0, float(costs.sum())
        results = self._by_threads(order) if isinstance(client, str) else self._by_client(client, order)
        for block, drawn in results:
            done_cost += float(costs[block])
            if progress is not None and progress(done_cost / whole) is False:
                results.close()
                raise CancelledError("rendering was cancelled by the progress callback")
            yield block, drawn

    def _by_threads(self, order: Sequence[int]) -> Any:
        dask: Any = library("dask", extra="dask")
        # 16 tasks at once, so that progress is reported between them and not all states are held together.
        for k in range(0, len(order), 16):
            part = order[k : k + 16]
            tasks = [self._task(self._packed, block) for block in part]
            yield from zip(part, dask.compute(*tasks, scheduler="threads"), strict=True)

    def _by_client(self, client: Any, order: Sequence[int]) -> Any:
        with lost_scheduler_named(client):
            yield from self._by_attempts(client, order)

    def _by_attempts(self, client: Any, order: Sequence[int]) -> Iterator[tuple[int, Drawn]]:
        distributed: Any = library("distributed", extra="dask")
        waiting = list(order)
        for attempt in itertools.count():
            wait_for_scheduler(client)
            spec = held(client, self._packed, self._token)
            futures = client.compute([self._task(spec, block) for block in waiting], retries=N_RETRIES)
            of = dict(zip([future.key for future in futures], waiting, strict=True))
            try:
                for future in done(client, futures):
                    yield of[future.key], result_of(client, future)
                    waiting.remove(of[future.key])
                return
            except distributed.CancelledError as error:
                check_times_lost(attempt, error)
            finally:
                release(client, futures)  # blocks drawn again have the same bytes: tasks depend on the spec alone

    def _task(self, spec: Any, block: int) -> Any:
        dask: Any = library("dask", extra="dask")
        delayed, pure = dask.delayed, {"pure": True}
        if not self._is_cut:
            key = f"wavesplat-block-{self._token}-{block}"
            return delayed(_draw, **pure)(spec, self._token, block, None, None, dask_key_name=key)
        parts = []
        for k, steps in enumerate(self._stream.segments(block)):
            key = f"wavesplat-segment-{self._token}-{block}-{k}"
            chunks = self._chunks(block, steps)
            parts.append(delayed(_draw, **pure)(spec, self._token, block, steps, chunks, dask_key_name=key))
        key = f"wavesplat-fold-{self._token}-{block}"
        return delayed(_fold, **pure)(spec, self._token, parts, dask_key_name=key)

    def _chunks(self, block: int, steps: tuple[int, int]) -> list[Any] | None:
        """The chunks of Dask arrays that a segment is drawn from: its task runs where they are."""
        if not any(isinstance(array, ComputedArray) for array in self._spec.arrays):
            return None
        nothing = _native.BlockState()
        needed: list[Any] = []
        for layer, array in enumerate(self._spec.arrays):
            if not isinstance(array, ComputedArray):
                needed.append(None)
                continue
            delayed = array.delayed_chunks()
            own: dict[Any, Any] = {}
            for step in range(*steps):
                for box in self._stream.reads(block, step, step == steps[0], nothing)[layer]:
                    own |= {index: delayed[index] for index in array.chunk_numbers(box)}
            needed.append((list(own), list(own.values())))
        return needed


_STREAMS: OrderedDict[str, tuple[FrameSpec, _native.Stream]] = OrderedDict()
_LOCK = threading.Lock()


def _planned(packed: bytes, token: str) -> tuple[FrameSpec, _native.Stream]:
    """The frame and its stream, planned once in a process."""
    with _LOCK:
        found = _STREAMS.pop(token, None)
        if found is None:
            spec = pickle.loads(packed)  # noqa: S301 - our own, by the way that Dask sends tasks
            found = spec, spec.stream()
        _STREAMS[token] = found
        while len(_STREAMS) > MAX_STREAMS:
            _STREAMS.popitem(last=False)
        return found


def _draw(packed: bytes, token: str, block: int, steps: tuple[int, int] | None, chunks: list[Any] | None) -> Drawn:
    """Task: draw a block, or a segment of it."""
    spec, stream = _planned(packed, token)
    arrays = list(spec.arrays)
    for layer, own in enumerate(chunks or ()):
        array = arrays[layer]
        if own is not None and isinstance(array, ComputedArray):
            numbers, samples = own
            arrays[layer] = array.held(dict(zip(numbers, samples, strict=True)))
    reading = Reading(arrays, spec.least, memory=spec.budget)
    state = draw_segment(stream, block, steps or (0, stream.n_steps(block)), reading)
    counts = reading.counts
    return state.to_bytes(), counts.n_bytes, counts.n_boxes, counts.holes


def _fold(packed: bytes, token: str, parts: Sequence[Drawn]) -> Drawn:
    """Task: fold the segments of a block, front to back, into one state."""
    _, stream = _planned(packed, token)
    state = stream.fold([_native.BlockState.from_bytes(part[0]) for part in parts])
    return state.to_bytes(), sum(p[1] for p in parts), sum(p[2] for p in parts), [h for p in parts for h in p[3]]
