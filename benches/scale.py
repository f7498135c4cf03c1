"""Volumes larger than memory, and several processes; `make bench BENCH="--only scale"` runs this.

The volume is made up: shells of different sizes with noise in their walls, air between them, uint8. 2048^3 of it lie
in a Zarr array on disk, in chunks of 64^3; 4096 x 4096 x 6144, 100 GB, are made up as they are read. Each case runs in
a fresh process, which tells its wall time, the time of its processors, its largest memory, and what it read.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "target" / "scale"
SIDE, CHUNK = 2048, 64
HUGE = (6144, 4096, 4096)
#: Shells: centre as shares of the sides, radius and thickness as shares of the shortest side, value.
SHELLS = (
    ((0.50, 0.50, 0.50), 0.40, 0.006, 150),
    ((0.45, 0.55, 0.50), 0.22, 0.010, 220),
    ((0.60, 0.40, 0.45), 0.10, 0.012, 250),
    ((0.30, 0.35, 0.62), 0.07, 0.010, 200),
)
LOOK = ws.Look(
    transfer_function=ws.TransferFunction(
        [(90, 0.0), (140, 0.02), (210, 0.1), (255, 0.5)], [(90, 0.5, 0.4, 0.3), (170, 0.9, 0.6, 0.4), (255, 1, 1, 0.9)]
    )
)


class MadeUp:
    """Samples that are made up when they are asked for: an array by all that a lazy volume asks of one."""

    def __init__(self, shape: tuple[int, int, int], chunk: int = CHUNK) -> None:
        self.shape = shape
        self.dtype = np.dtype(np.uint8)
        self.chunks = (chunk, chunk, chunk)
        self.is_in_memory, self.n_readers, self.name = False, 2, "made up"
        self.token: str | None = f"made up {shape}"

    def read(self, lo: Sequence[int], hi: Sequence[int]) -> NDArray[np.uint8]:
        """A box, cell by cell of its chunks: those that no wall crosses are empty."""
        out = np.zeros([b - a for a, b in zip(lo, hi, strict=True)], np.uint8)
        side = self.chunks[0]
        for z in range(lo[0] // side * side, hi[0], side):
            for y in range(lo[1] // side * side, hi[1], side):
                for x in range(lo[2] // side * side, hi[2], side):
                    first = [max(a, b) for a, b in zip((z, y, x), lo, strict=True)]
                    end = [min(a + side, b) for a, b in zip((z, y, x), hi, strict=True)]
                    cell = self._cell(first, end)
                    if cell is not None:
                        out[tuple(slice(a - o, b - o) for a, b, o in zip(first, end, lo, strict=True))] = cell
        return out

    def _cell(self, first: Sequence[int], end: Sequence[int]) -> NDArray[np.uint8] | None:
        cell = None
        shortest = min(self.shape)
        for centre, radius, thickness, value in SHELLS:
            middle = [share * n for share, n in zip(centre, self.shape, strict=True)]
            nearest = math.dist([min(max(m, a), b - 1) for m, a, b in zip(middle, first, end, strict=True)], middle)
            farthest = math.dist(
                [max(abs(a - m), abs(b - 1 - m)) for m, a, b in zip(middle, first, end, strict=True)], [0] * 3
            )
            wall = thickness * shortest
            if nearest > radius * shortest + wall or farthest < radius * shortest - wall:
                continue
            axes = [
                np.arange(a, b, dtype=np.float32) - np.float32(m) for a, b, m in zip(first, end, middle, strict=True)
            ]
            squares = axes[0][:, None, None] ** 2 + axes[1][None, :, None] ** 2 + axes[2][None, None, :] ** 2
            off = np.abs(np.sqrt(squares) - np.float32(radius * shortest)) / np.float32(wall)
            shell = value * np.clip(1.4 - 1.4 * off, 0, 1)
            places = [np.arange(a, b, dtype=np.uint32) for a, b in zip(first, end, strict=True)]
            hashed = (
                places[0][:, None, None] * np.uint32(73856093)
                ^ places[1][None, :, None] * np.uint32(19349663)
                ^ places[2][None, None, :] * np.uint32(83492791)
            )
            shell *= 0.85 + 0.15 * ((hashed >> np.uint32(13)) & np.uint32(255)).astype(np.float32) / 255
            own = shell.astype(np.uint8)
            cell = own if cell is None else np.maximum(cell, own)
        return cell

    def read_many(self, boxes: Sequence[tuple[Sequence[int], Sequence[int]]]) -> list[NDArray[np.uint8]]:
        """Several boxes."""
        return [self.read(*box) for box in boxes]


class Counting:
    """An array that counts how often each chunk is read."""

    def __init__(self, array: Any) -> None:
        self._array = array
        self.counts: Counter[tuple[int, ...]] = Counter()
        self.seconds = 0.0
        self._lock = threading.Lock()
        for name in ("shape", "dtype", "chunks", "is_in_memory", "n_readers", "name", "token"):
            setattr(self, name, getattr(array, name))

    def read(self, lo: Sequence[int], hi: Sequence[int]) -> NDArray[Any]:
        """A box."""
        begun = time.perf_counter()
        samples: NDArray[Any] = self._array.read(lo, hi)
        ranges = [range(a // c, (b - 1) // c + 1) for a, b, c in zip(lo, hi, self.chunks, strict=True)]  # type: ignore[attr-defined]
        with self._lock:
            self.seconds += time.perf_counter() - begun
            self.counts.update((z, y, x) for z in ranges[0] for y in ranges[1] for x in ranges[2])
        return samples

    def read_many(self, boxes: Sequence[Any]) -> list[NDArray[Any]]:
        """Several boxes."""
        return [self.read(*box) for box in boxes]


def zarr_path() -> Path:
    """The Zarr array on disk, made where it is not there yet."""
    import zarr

    path = FOLDER / f"shells-{SIDE}.zarr"
    if not (path / "done").exists():
        FOLDER.mkdir(parents=True, exist_ok=True)
        source = MadeUp((SIDE, SIDE, SIDE))
        array = zarr.create_array(path, shape=source.shape, chunks=source.chunks, dtype="u1", overwrite=True)
        for z in range(0, SIDE, CHUNK):
            array[z : z + CHUNK] = source.read((z, 0, 0), (z + CHUNK, SIDE, SIDE))
        (path / "done").touch()
    return path


def opened(memory: str | None, keep: Any) -> tuple[ws.Volume, Counting | None]:
    """The volume on disk, in memory or lazily."""
    import zarr

    from wavesplat._model.lazy_array import lazy_array

    array = zarr.open_array(zarr_path(), mode="r")
    if memory is None:
        return ws.Volume(array), None
    counting = Counting(lazy_array(array).levels[0])
    return ws.Volume.lazy(counting, memory=memory, cache=keep), counting


def camera_of(shape: tuple[int, int, int]) -> ws.Camera:
    """Aslant from above, all of it in view."""
    around = ws.Volume.lazy(MadeUp(shape), memory="1 GB", cache=False)
    return ws.Camera.orbit(around, 30, 20)


def told(begun: float, picture: ws.Picture | None = None, counting: Counting | None = None) -> dict[str, Any]:
    """Times, memory and reads of this process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    facts: dict[str, Any] = {
        "wall_s": round(time.perf_counter() - begun, 2),
        "cpu_s": round(used.ru_utime + used.ru_stime, 2),
        "peak_MB": round(used.ru_maxrss * 1024 / 1e6),
    }
    if picture is not None:
        facts["hash"] = hash(picture.rgba.tobytes()) & 0xFFFFFFFF
        facts["covered"] = round(float((picture.rgba[..., 3] > 0.01).mean()), 3)
        facts |= {key: value for key, value in picture.report.get("lazy", {}).items() if key != "levels"}
    if counting is not None and counting.counts:
        facts["chunks_read"] = len(counting.counts)
        facts["most_reads_of_a_chunk"] = max(counting.counts.values())
        facts["mean_reads_of_a_chunk"] = round(sum(counting.counts.values()) / len(counting.counts), 3)
        facts["reading_s"] = round(counting.seconds, 2)
    return facts


def one(memory: str | None, size: int, keep: str) -> dict[str, Any]:
    """A frame of the volume on disk."""
    begun = time.perf_counter()
    volume, counting = opened(memory, keep)
    picture = ws.render(volume, LOOK, camera_of(volume.shape), size=(size, size))
    return told(begun, picture, counting)


def huge(memory: str, size: int, keep: str) -> dict[str, Any]:
    """A frame of 100 GB that are made up on the fly."""
    begun = time.perf_counter()
    counting = Counting(MadeUp(HUGE, 128))
    volume = ws.Volume.lazy(counting, memory=memory, cache=keep)
    picture = ws.render(volume, LOOK, camera_of(HUGE), size=(size, size))
    return told(begun, picture, counting)


CASES: dict[str, Callable[[], dict[str, Any]]] = {
    "2048^3 in memory": lambda: one(None, 1024, ""),
    "2048^3 lazily, the first picture": lambda: one("512 MB", 1024, str(FOLDER / "first" / str(os.getpid()))),
    "2048^3 lazily, bounds kept": lambda: one("512 MB", 1024, str(FOLDER / "kept")),
    "100 GB made up, the first picture": lambda: huge("1 GB", 1024, str(FOLDER / "first" / str(os.getpid()))),
}


def main() -> None:
    """Runs the cases whose names have a text."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--case", help="run this one in this process, and print what it tells")
    parser.add_argument("--only", default="", help="cases whose names have this")
    arguments = parser.parse_args()
    if arguments.case:
        print(json.dumps(CASES[arguments.case]()))
        return
    zarr_path()
    for name in CASES:
        if arguments.only in name:
            environment = os.environ | {"PYTHONHASHSEED": "0"}
            command = [sys.executable, __file__, "--case", name]
            result = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
            print(f"{name}: {result.stdout.strip() or result.stderr[-1500:]}", flush=True)


if __name__ == "__main__":
    main()
