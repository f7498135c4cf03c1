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
    """A synthetic array, computed as it is read; it has all that a lazy volume asks of an array."""

    def __init__(self, shape: tuple[int, int, int], chunk: int = CHUNK) -> None:
        self.shape = shape
        self.dtype = np.dtype(np.uint8)
        self.chunks = (chunk, chunk, chunk)
        self.is_in_memory, self.n_readers, self.name = False, 2, "made up"
        self.token: str | None = f"made up {shape}"
        self.files = None

    def read(self, lo: Sequence[int], hi: Sequence[int]) -> NDArray[np.uint8]:
        """Compute the samples of a box, chunk by chunk; chunks that no wall crosses stay 0."""
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
        """Read several boxes."""
        return [self.read(*box) for box in boxes]


class Counting:
    """An array that counts how often each chunk is read."""

    def __init__(self, array: Any) -> None:
        self._array = array
        self.counts: Counter[tuple[int, ...]] = Counter()
        self.seconds = 0.0
        self._lock = threading.Lock()
        for name in ("shape", "dtype", "chunks", "is_in_memory", "n_readers", "name", "token", "files"):
            setattr(self, name, getattr(array, name))

    def read(self, lo: Sequence[int], hi: Sequence[int]) -> NDArray[Any]:
        """Read a box, and count its chunks."""
        samples = np.zeros([b - a for a, b in zip(lo, hi, strict=True)], self._array.dtype)
        self.read_into(lo, hi, samples)
        return samples

    def read_into(self, lo: Sequence[int], hi: Sequence[int], out: NDArray[Any]) -> None:
        """Read a box into an array of zeros, and count its chunks."""
        begun = time.perf_counter()
        self._array.read_into(lo, hi, out)
        ranges = [range(a // c, (b - 1) // c + 1) for a, b, c in zip(lo, hi, self.chunks, strict=True)]  # type: ignore[attr-defined]
        with self._lock:
            self.seconds += time.perf_counter() - begun
            self.counts.update((z, y, x) for z in ranges[0] for y in ranges[1] for x in ranges[2])

    def read_many(self, boxes: Sequence[Any]) -> list[NDArray[Any]]:
        """Read several boxes."""
        return [self.read(*box) for box in boxes]


def zarr_path(side: int = SIDE) -> Path:
    """Path of the Zarr array of `side`^3 samples on disk, which is made if it is missing."""
    import zarr

    path = FOLDER / f"shells-{side}.zarr"
    if not (path / "done").exists():
        FOLDER.mkdir(parents=True, exist_ok=True)
        source = MadeUp((side, side, side))
        array = zarr.create_array(path, shape=source.shape, chunks=source.chunks, dtype="u1", overwrite=True)
        for z in range(0, side, CHUNK):
            array[z : z + CHUNK] = source.read((z, 0, 0), (z + CHUNK, side, side))
        (path / "done").touch()
    return path


def opened(memory: str | None, keep: Any) -> tuple[ws.Volume, Counting | None]:
    """Open the volume on disk, in memory or lazily."""
    import zarr

    from wavesplat._model.lazy.array import lazy_array

    array = zarr.open_array(zarr_path(), mode="r")
    if memory is None:
        return ws.Volume(array), None
    counting = Counting(lazy_array(array).levels[0])
    return ws.Volume.lazy(counting, memory=memory, cache=keep), counting


def camera_of(shape: tuple[int, int, int]) -> ws.Camera:
    """Oblique camera from above, with all of a volume in view."""
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
        left_out = ("levels", "surveys")
        facts |= {key: value for key, value in picture.report.get("lazy", {}).items() if key not in left_out}
    if counting is not None and counting.counts:
        facts["chunks_read"] = len(counting.counts)
        facts["most_reads_of_a_chunk"] = max(counting.counts.values())
        facts["mean_reads_of_a_chunk"] = round(sum(counting.counts.values()) / len(counting.counts), 3)
        facts["reading_s"] = round(counting.seconds, 2)
    return facts


def one(memory: str | None, size: int, keep: str) -> dict[str, Any]:
    """Draw a frame of the volume on disk, and report its cost."""
    begun = time.perf_counter()
    volume, counting = opened(memory, keep)
    picture = ws.render(volume, LOOK, camera_of(volume.shape), size=(size, size))
    return told(begun, picture, counting)


def first_reads(memory: str, look: ws.Look | None) -> dict[str, Any]:
    """Count the reads of the chunks of 768^3 samples by the pass before a first picture, and by the picture."""
    import zarr

    from wavesplat._model.lazy.array import lazy_array

    counting = Counting(lazy_array(zarr.open_array(zarr_path(768), mode="r")).levels[0])
    volume: Any = ws.Volume.lazy(counting, memory=memory, cache=False)
    begun = time.perf_counter()
    volume.survey(0, "linear")
    passed, of_pass = time.perf_counter() - begun, counting.counts.copy()
    reading = counting.seconds
    counting.counts.clear()
    picture = ws.render(volume, look, camera_of(volume.shape), size=(512, 512))
    n = math.prod(-(-n // CHUNK) for n in volume.shape)
    return {
        "chunks": n,
        "reads_by_the_pass": round(sum(of_pass.values()) / n, 3),
        "chunks_of_the_picture": round(len(counting.counts) / n, 3),
        "reads_by_the_picture": round(sum(counting.counts.values()) / n, 3),
        "pass_s": round(passed, 2),
        "pass_reading_s": round(reading, 2),
        "picture_reading_s": round(counting.seconds - reading, 2),
        **told(begun, picture),
    }


def huge(memory: str, size: int, keep: str) -> dict[str, Any]:
    """Draw a frame of 100 GB that are computed as they are read, and report its cost."""
    begun = time.perf_counter()
    counting = Counting(MadeUp(HUGE, 128))
    volume = ws.Volume.lazy(counting, memory=memory, cache=keep)
    picture = ws.render(volume, LOOK, camera_of(HUGE), size=(size, size))
    return told(begun, picture, counting)


def slow(case: str) -> dict[str, Any]:
    """Measure drawing alone, and with reading that takes about as long; `case`: reading time over drawing time."""
    n = 512
    samples = MadeUp((n, n, n)).read((0, 0, 0), (n, n, n))

    class Waiting(Counting):
        seconds_each = 0.0

        def read(self, lo: Sequence[int], hi: Sequence[int]) -> NDArray[Any]:
            time.sleep(self.seconds_each)
            return super().read(lo, hi)

    from wavesplat._model.lazy.array import lazy_array

    array = Waiting(lazy_array(samples).levels[0])
    array.chunks, array.is_in_memory, array.n_readers = (CHUNK, n, n), False, 1  # type: ignore[attr-defined]
    volume = ws.Volume.lazy(array, memory="256 MB", cache=False)
    camera, options = ws.Camera.orbit(volume, 0, 80), {"size": (1400, 1400)}
    ws.render(volume, LOOK, camera, **options)
    begun = time.perf_counter()
    ws.render(volume, LOOK, camera, **options)
    drawing = time.perf_counter() - begun
    array.counts.clear()
    array.seconds_each = drawing / (n / CHUNK) * float(case)
    begun = time.perf_counter()
    ws.render(volume, LOOK, camera, **options)
    both = time.perf_counter() - begun
    reading = array.seconds_each * sum(1 for _ in array.counts)
    longer = max(reading, drawing)
    return {
        "drawing_s": round(drawing, 2),
        "reading_s": round(reading, 2),
        "both_s": round(both, 2),
        "of_the_longer": round(both / longer, 3),
    }


def by_workers(n_workers: int) -> dict[str, Any]:
    """Draw the volume on disk by Dask workers of one thread each; `n_workers` 0: by this process with two threads."""
    volume, _ = opened("512 MB", str(FOLDER / "kept"))
    import zarr

    volume = ws.Volume.lazy(zarr.open_array(zarr_path(), mode="r"), memory="512 MB", cache=str(FOLDER / "kept"))
    camera = camera_of(volume.shape)
    ws.render(volume, LOOK, camera, size=(64, 64))
    if not n_workers:
        begun = time.perf_counter()
        picture = ws.render(volume, LOOK, camera, size=(1024, 1024), threads=2)
        return {"wall_s": round(time.perf_counter() - begun, 2), **_picture_facts(picture)}
    from distributed import Client, LocalCluster

    options: dict[str, Any] = {"memory_limit": "2GiB", "dashboard_address": None, "host": "127.0.0.1"}
    started = time.perf_counter()
    cluster = LocalCluster(n_workers=n_workers, threads_per_worker=1, processes=True, **options)
    with cluster, Client(cluster) as client:
        client.wait_for_workers(n_workers)
        start_s = time.perf_counter() - started
        begun = time.perf_counter()
        picture = ws.render(volume, LOOK, camera, size=(1024, 1024), client=client)
        took = time.perf_counter() - begun
        begun = time.perf_counter()
        again = ws.render(volume, LOOK, camera, size=(1024, 1024), client=client)
        second = time.perf_counter() - begun
        peaks = client.run(lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6)
    return {
        "wall_s": round(took, 2),
        "second_s": round(second, 2),
        "start_s": round(start_s, 2),
        "worker_peak_MB": round(max(peaks.values())),
        **_picture_facts(again),
    }


def _picture_facts(picture: ws.Picture) -> dict[str, Any]:
    blocks = picture.report["lazy"]["blocks"]
    return {"hash": hash(picture.rgba.tobytes()) & 0xFFFFFFFF, "blocks": blocks}


def planned() -> dict[str, Any]:
    """Plan, without drawing, a picture of two terabytes on a hundred workers, at the rates of the study."""

    class Promised(MadeUp):
        def read(self, *_: Any) -> NDArray[np.uint8]:
            raise AssertionError

    rows: dict[str, Any] = {}
    for chunk in (100, 128, 256):
        array = Promised((10_000,) * 3, chunk)
        array.dtype = np.dtype(np.uint16)
        volume = ws.Volume.lazy(array, memory="20 GB", cache=False)
        begun = time.perf_counter()
        cost = ws.plan(volume, size=(4096, 4096), workers=100, cores=8, read_rate="250 MB", draw_ns=4)
        rows[f"chunks of {chunk}^3"] = {
            "plan_s": round(time.perf_counter() - begun, 2),
            "chunks": cost.chunks,
            "tasks": cost.tasks,
            "read_TB": round(cost.bytes_read / 1e12, 2),
            "worker_MB": round(cost.memory / 1e6),
            "whole_s": round(cost.seconds["whole"]),
        }
    return rows


def same_bytes() -> dict[str, Any]:
    """Count the volumes of BENCH_DATA whose pictures are the same, lazily and in memory."""
    from wavesplat._model.lazy.array import lazy_array

    folder, told = Path(os.environ.get("BENCH_DATA", "../shared/data")), {"same": 0, "other": 0}
    names = []
    for path in sorted(folder.rglob("*")):
        if not path.name.lower().endswith((".nii.gz", ".nii", ".nrrd", ".mha", ".npy", ".vti", ".tif")):
            continue
        try:
            volume = ws.open(path)
        except ws.errors.WavesplatError:
            continue  # several times, channels or arrays
        if math.prod(volume.shape) > 4e7 or min(volume.shape) < 2 or isinstance(volume, ws.LazyVolume):
            continue
        names.append(path.name)
        array = Counting(lazy_array(np.array(volume.samples)).levels[0])
        array.chunks, array.is_in_memory = (
            tuple(min(c, n) for c, n in zip((19, 27, 31), volume.shape, strict=True)),
            False,
        )  # type: ignore[attr-defined]
        lazy = ws.Volume.lazy(
            array, world_from_index=volume.world_from_index, facts=volume.facts, memory="128 MB", cache=False
        )
        for composite in ("over", "maximum", "mean"):
            look = ws.Look.auto(volume, composite)  # type: ignore[arg-type]
            for kernel in ("linear", "catmull-rom", "bspline3"):
                # A table that leaves pictures in memory stays in those of lazy volumes, with a note.
                options: dict[str, Any] = {"size": (160, 120), "kernel": kernel, "composite": composite}
                options["keep_table"] = True
                camera = ws.Camera.orbit(volume, 35, 25, view_angle=40 if kernel == "linear" else None)
                pictures = [ws.render(one, look, camera, **options).rgba.tobytes() for one in (volume, lazy)]
                told["same" if pictures[0] == pictures[1] else "other"] += 1
    return {**told, "volumes": len(names)}


def kept_twice(memory: str, size: int) -> dict[str, Any]:
    """Draw a second picture, with the bounds that the first one kept."""
    return one(memory, size, str(FOLDER / "kept"))


def second_frame(memory: str | None) -> dict[str, Any]:
    """Measure the second frame alone, of the volume in memory or lazily."""
    volume, _ = opened(memory, str(FOLDER / "kept"))
    camera = camera_of(volume.shape)
    ws.render(volume, LOOK, camera, size=(512, 512))
    before, begun = time.process_time(), time.perf_counter()
    picture = ws.render(volume, LOOK, camera, size=(512, 512))
    took = {
        "frame_wall_s": round(time.perf_counter() - begun, 2),
        "frame_cpu_s": round(time.process_time() - before, 2),
    }
    return {**took, **told(begun, picture)}


CASES: dict[str, Callable[[], dict[str, Any]]] = {
    "2048^3 in memory": lambda: one(None, 1024, ""),
    "2048^3 lazily, the first picture": lambda: one("512 MB", 1024, str(FOLDER / "first" / str(os.getpid()))),
    "2048^3 lazily, bounds kept": lambda: kept_twice("512 MB", 1024),
    "2048^3 in memory, the second frame": lambda: second_frame(None),
    "2048^3 in 300 MB, the second frame": lambda: second_frame("300 MB"),
    "768^3 in 300 MB, reads of the first picture": lambda: first_reads("300 MB", LOOK),
    "768^3 in 300 MB, reads of the first picture, look by itself": lambda: first_reads("300 MB", None),
    "100 GB made up, the first picture": lambda: huge("1 GB", 1024, str(FOLDER / "first" / str(os.getpid()))),
    "reading as slow as drawing": lambda: slow("1.0"),
    "reading half as slow": lambda: slow("0.5"),
    "2048^3 by one process": lambda: by_workers(0),
    "2048^3 by two workers": lambda: by_workers(2),
    "2 TB planned": planned,
    "shared volumes": same_bytes,
}


def told_by(name: str) -> dict[str, Any]:
    """Results of a case, run in a fresh process."""
    environment = os.environ | {"PYTHONHASHSEED": "0"}
    command = [sys.executable, __file__, "--case", name]
    result = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    if result.returncode:
        return {"failed": result.stderr.strip().splitlines()[-1]}
    facts: dict[str, Any] = json.loads(result.stdout.splitlines()[-1])
    return facts


def table(only: str = "") -> str:
    """Run all cases whose names contain `only`; the results as lines of Markdown."""
    lines = []
    for name in CASES:
        if only in name:
            for side in (768, SIDE):
                if f"{side}^3" in name:
                    zarr_path(side)  # that making it is no part of a case
            if "kept" in name:
                told_by(name)  # keeps the bounds
            facts = told_by(name)
            text = "; ".join(f"{key} {value}" for key, value in facts.items())
            lines.append(f"- **{name}**: {text}")
            print(lines[-1], flush=True)
    return "\n".join(lines)


def main() -> None:
    """Run the cases whose names contain the text of `--only`."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--case", help="run this one in this process, and print what it tells")
    parser.add_argument("--only", default="", help="cases whose names have this")
    arguments = parser.parse_args()
    if arguments.case:
        print(json.dumps(CASES[arguments.case]()))
        return
    table(arguments.only)


if __name__ == "__main__":
    main()
