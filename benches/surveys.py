"""Cost of noticing changes and of keeping surveys: `python benches/surveys.py`.

It asks 10,000 chunk files of a Zarr array for their states, and measures the file that the survey of 256^3 samples is
kept in, of noise (which does not compress) and of shells.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
import zarr

import wavesplat as ws
from wavesplat._storage.zarr.chunk_files import chunk_files

#: Chunks along each axis: 10,000 in all.
GRID = (10, 25, 40)
SIDE = 256


def seconds_of_a_pass(folder: Path) -> tuple[float, float]:
    """Wall and processor seconds of a pass over 10,000 chunk files, the fastest of five."""
    array = zarr.create_array(folder / "many.zarr", data=np.ones(GRID, np.uint8), chunks=(1, 1, 1))
    taken = []
    for _ in range(5):
        files = chunk_files(array, (None, None, None))
        assert files is not None
        before = time.perf_counter(), time.process_time()
        files.begin()
        taken.append((time.perf_counter() - before[0], time.process_time() - before[1]))
    return min(taken)


def bytes_of_a_survey(samples: np.ndarray, folder: Path) -> int:
    """Bytes of the file that a survey is kept in."""
    zarr.create_array(folder / "samples.zarr", data=samples, chunks=(64, 64, 64))
    ws.open(folder / "samples.zarr", memory="1 GB", cache=folder / "cache").survey(0, "linear")
    return sum(file.stat().st_size for file in (folder / "cache").iterdir())


def main() -> None:
    """Print both measurements."""
    with tempfile.TemporaryDirectory() as folder:
        wall, cpu = seconds_of_a_pass(Path(folder))
    print(f"a pass over {np.prod(GRID):,} chunks: {wall:.3f} s, {cpu:.3f} s of processors")
    z, y, x = np.ogrid[-1 : 1 : SIDE * 1j, -1 : 1 : SIDE * 1j, -1 : 1 : SIDE * 1j]
    shells = (200 * np.exp(-(((np.sqrt(x**2 + y**2 + z**2) - 0.6) / 0.1) ** 2))).astype(np.uint8)
    noise = np.random.default_rng(1).integers(0, 256, (SIDE,) * 3).astype(np.uint8)
    for name, samples in (("shells", shells), ("noise", noise)):
        with tempfile.TemporaryDirectory() as folder:
            n_bytes = bytes_of_a_survey(samples, Path(folder))
        print(f"the survey of {SIDE}^3 samples, {name}: {n_bytes / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
