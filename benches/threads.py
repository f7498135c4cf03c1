"""Times of frames by number of threads: `make bench-threads`.

What is drawn are the cases of the group "goals" of `cases.toml` at quality "normal", on the CPU: median wall time of
turned frames after two. The speedup is against one thread in the same run.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import statistics
import time

import scenes

#: Frames that are timed, and how far the view turns from one to the next, degrees.
N_FRAMES, TURN = 10, 0.3


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    n_all = os.cpu_count() or 1
    usual = sorted({n for n in (1, 2, 4, 8, 16, n_all) if n <= n_all})
    parser.add_argument("--threads", type=int, nargs="+", default=usual, help="numbers of threads")
    asked = parser.parse_args()
    print("| case | " + " | ".join(f"{n} threads, ms" for n in asked.threads) + " | speedup |")
    print("| --- |" + " ---: |" * (len(asked.threads) + 1))
    for case in scenes.cases():
        if case.group == "goals":
            times = [_milliseconds(dataclasses.replace(case, threads=n)) for n in asked.threads]
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


if __name__ == "__main__":
    main()
