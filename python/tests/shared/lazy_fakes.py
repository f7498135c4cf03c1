"""Lazy arrays for tests: views of an array in memory that count reads, or are slow, or broken."""

from __future__ import annotations

import threading
import time
from collections import Counter

import numpy as np

from wavesplat.errors import FileError


class Chunked:
    """A lazy array that counts the reads of its chunks, whose sizes do not divide the array's."""

    is_in_memory, n_readers, reads_together, token, files = False, 4, False, None, None

    def __init__(self, samples, chunks=(17, 23, 29), name="chunked"):
        self.samples = samples
        self.shape, self.dtype = samples.shape, samples.dtype
        self.chunks = tuple(min(c, n) for c, n in zip(chunks, samples.shape, strict=True))
        self.name = name
        self.counts = Counter()
        self._lock = threading.Lock()

    def __getstate__(self):
        return {**vars(self), "_lock": None}

    def __setstate__(self, state):
        vars(self).update(state, _lock=threading.Lock())

    def read(self, lo, hi):
        ranges = [range(a // c, (b - 1) // c + 1) for a, b, c in zip(lo, hi, self.chunks, strict=True)]
        with self._lock:
            self.counts.update((z, y, x) for z in ranges[0] for y in ranges[1] for x in ranges[2])
        return np.ascontiguousarray(self.samples[tuple(slice(a, b) for a, b in zip(lo, hi, strict=True))])

    def read_many(self, boxes):
        return [self.read(*box) for box in boxes]


class Slow(Chunked):
    """A lazy array whose reads all take a while."""

    seconds = 0.02

    def read(self, lo, hi):
        time.sleep(self.seconds)
        return super().read(lo, hi)


class Broken(Chunked):
    """A lazy array of which one chunk cannot be read, the first `times` times."""

    def __init__(self, samples, chunk, times=10**9, **options):
        super().__init__(samples, **options)
        self.chunk, self.times = chunk, times

    def read(self, lo, hi):
        ranges = [range(a // c, (b - 1) // c + 1) for a, b, c in zip(lo, hi, self.chunks, strict=True)]
        if all(k in r for k, r in zip(self.chunk, ranges, strict=True)) and self.times > 0:
            self.times -= 1
            raise FileError(f"{self.name!r}: cannot read chunk {self.chunk}: it is broken")
        return super().read(lo, hi)


class FailsOnce(Chunked):
    """A lazy array whose first read in a process fails."""

    failed = False

    def read(self, lo, hi):
        if not FailsOnce.failed:
            FailsOnce.failed = True
            raise FileError("the network is away for a moment")
        return super().read(lo, hi)


class WearsOut:
    """An array of which a process reads some boxes, and then none any more."""

    n_reads = 0

    def __init__(self, samples, most):
        self.samples, self.most = samples, most
        self.shape, self.dtype, self.chunks = samples.shape, samples.dtype, (16, 16, 16)

    def __getitem__(self, key):
        WearsOut.n_reads += 1
        if WearsOut.n_reads > self.most:
            raise OSError(5, "Input/output error")
        return self.samples[key]


class WrongShape(Chunked):
    """A lazy array whose reads return one slice too few."""

    def read(self, lo, hi):
        return super().read(lo, hi)[:-1]


def shells(n=96, dtype=np.uint8):
    """Two shells in air, not concentric."""
    z, y, x = np.ogrid[-1 : 1 : n * 1j, -1 : 1 : n * 1j, -1 : 1 : n * 1j]
    first = 220 * np.exp(-(((np.sqrt(x**2 + y**2 + z**2) - 0.45) / 0.05) ** 2))
    second = 160 * np.exp(-(((np.sqrt((x - 0.3) ** 2 + (y + 0.2) ** 2 + z**2) - 0.25) / 0.06) ** 2))
    return np.maximum(first, second).astype(dtype)
