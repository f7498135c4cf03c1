"""PSNR and time of the named qualities: `make bench-qualities`.

What is drawn are the cases of the group "goals" of `cases.toml`, on one thread of the CPU. PSNR is against 16 sheets a
slice and 4 x 4 texels a pixel, less that of "normal"; time is the median processor time of three pictures over that of
"normal".
"""

from __future__ import annotations

import statistics
from typing import Any, get_args

import psnr
import scenes

import wavesplat as ws
from wavesplat._model.arguments.sampling import Quality

CONVERGED = ws.Sampling(16, 4)
N_PICTURES = 3


def main() -> None:
    """Print the table."""
    names = get_args(Quality)
    print("| case | normal, dB | " + " | ".join(f"{name}, dB | {name}, time" for name in names) + " |")
    print("| --- | ---: |" + " ---: |" * (2 * len(names)))
    for case in scenes.cases():
        if case.group == "goals":
            print(_row(case, names), flush=True)


def _row(case: scenes.Case, names: tuple[str, ...]) -> str:
    scene = scenes.scene(case)

    def draw(quality: Any, n: int) -> tuple[ws.Picture, float]:
        shown = {"size": (case.size, case.size), "threads": 1, "device": "cpu", "quality": quality}
        drawn = [psnr.timed(scene, scenes.camera(case), **shown) for _ in range(n)]
        return drawn[-1][0], statistics.median(seconds for _, seconds in drawn)

    want = draw(CONVERGED, 1)[0].rgba
    drawn = {name: draw(name, N_PICTURES) for name in names}
    reached = {name: psnr.psnr_db(picture, want) for name, (picture, _) in drawn.items()}
    normal_s = drawn["normal"][1]
    numbers = (f"{reached[n] - reached['normal']:+.1f} | {drawn[n][1] / normal_s:.2f}" for n in names)
    return f"| {case.label} | {reached['normal']:.1f} | " + " | ".join(numbers) + " |"


if __name__ == "__main__":
    main()
