"""Times of frames by number of threads: `make bench-threads`.

What is drawn are the cases of the group "goals" of `cases.toml` at quality "normal", on the CPU: median wall time of
turned frames after two. The speedup is against one thread in the same run.

`--simulate` needs no wide machine: the example `tile_times` measures each tile of a frame on one thread, and list
scheduling (Graham 1966: a thread that is free takes the next tile) gives the time of a frame by `n` threads, a power of
two up to 128. It prints the efficiency, the time of whole tiles on one thread over `n` times the simulated time, with
whole tiles row by row, dearest first by the renderer's own estimate, and dearest first by their measured times; the
bound that the dearest tile sets; and with the parts that the renderer draws on `n` threads, in its order.
Threads are taken to be as fast as one alone, without a limit by memory.
"""

from __future__ import annotations

import argparse
import dataclasses
import heapq
import os
import statistics
import subprocess
import time
from collections.abc import Iterable

import instructions
import scenes

#: Frames that are timed, and how far the view turns from one to the next, degrees.
N_FRAMES, TURN = 10, 0.3


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    n_all = os.cpu_count() or 1
    usual = sorted({n for n in (1, 2, 4, 8, 16, n_all) if n <= n_all})
    parser.add_argument("--threads", type=int, nargs="+", help="numbers of threads")
    parser.add_argument("--simulate", action="store_true", help="by list scheduling of measured tiles")
    asked = parser.parse_args()
    if asked.simulate:
        _simulate(asked.threads or [2, 4, 8, 16, 32, 64])
        return
    threads = asked.threads or usual
    print("| case | " + " | ".join(f"{n} threads, ms" for n in threads) + " | speedup |")
    print("| --- |" + " ---: |" * (len(threads) + 1))
    for case in scenes.cases():
        if case.group == "goals":
            times = [_milliseconds(dataclasses.replace(case, threads=n)) for n in threads]
            row = " | ".join(f"{one:.2f}" for one in times)
            print(f"| {case.label} | {row} | {times[0] / times[-1]:.1f} |", flush=True)


def _milliseconds(case: scenes.Case) -> float:
    """Median wall time of a frame."""
    kept = scenes.scene(case)
    wall = []
    for frame in range(N_FRAMES + 2):
        begun = time.perf_counter()
        scenes.render(case, TURN * frame, kept=kept, quality="normal", device="cpu")
        wall.append(1e3 * (time.perf_counter() - begun))
    return statistics.median(wall[2:])


def _simulate(threads: list[int]) -> None:
    """Print the efficiency of list scheduling for each scan, curve and light."""
    print("| scene | tiles | order | " + " | ".join(f"{n} threads" for n in threads) + " |")
    print("| --- | ---: | --- |" + " ---: |" * len(threads))
    program = instructions.FRAMES.with_name("tile_times")
    for name, curves in instructions.scans().items():
        for curve, light in instructions.SCENES:
            command = [program, curve, light, "5", *curves[curve]]
            told = subprocess.run(command, capture_output=True, check=True, text=True).stdout
            parts: dict[int, list[tuple[float, float]]] = {}
            for line in told.splitlines():
                n, cost, time = line.split()
                parts.setdefault(int(n), []).append((float(cost), float(time)))
            tiles = parts[1]
            whole = sum(time for _, time in tiles)
            orders = {
                "row by row": [time for _, time in tiles],
                "by the estimate": [time for _, time in sorted(tiles, key=lambda tile: -tile[0])],
                "by measured times": sorted((time for _, time in tiles), reverse=True),
            }
            rows = {order: [whole / (n * _makespan(times, n)) for n in threads] for order, times in orders.items()}
            rows["bound by the dearest tile"] = [
                min(1.0, whole / (n * max(time for _, time in tiles))) for n in threads
            ]
            rows["as drawn, in parts"] = [whole / (n * _makespan([t for _, t in parts[n]], n)) for n in threads]
            for order, row in rows.items():
                label = f"{name} {curve}, {light}"
                print(f"| {label} | {len(tiles)} | {order} | " + " | ".join(f"{e:.2f}" for e in row) + " |", flush=True)


def _makespan(times: Iterable[float], n_threads: int) -> float:
    """Time until the last thread is done, if a thread that is free takes the next tile."""
    free_at = [0.0] * n_threads
    for time_of_tile in times:
        heapq.heappush(free_at, heapq.heappop(free_at) + time_of_tile)
    return max(free_at)


if __name__ == "__main__":
    main()
