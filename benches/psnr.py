"""Pictures of a wanted PSNR against converged ones: `make bench-psnr`.

Volumes, functions and views on which nothing was fitted: each volume with a soft function (ramps between the 20th, 60th
and 99.5th percentile of what is not air) and a hard one (a step at the 60th), in the default light, seen obliquely,
along an axis, in perspective from below, and from so near that the picture lies within the volume. Each PSNR is wanted
by a scene of its own, which measures the picture, and then once more by the same scene from the same place ("again").

reached: the picture's PSNR against 16 sheets a slice and 5 x 5 texels a pixel. told: the report's expectation. time:
processor time over that of the cheapest rung of the ladder that reaches the PSNR, one thread. The table of rungs has
medians over all pictures: PSNR less that of quality "normal", and processor time over its time.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import records
import scenes
from numpy.typing import NDArray

import wavesplat as ws

VOLUMES = (
    "sim_fuel_u8.nii.gz",
    "sim_heptane_jet_u8.nii.gz",
    "embryo.nrrd",
    "sim_turbulence_f32.nhdr",
    "carotid_pcmra.vtk",
    "us_spine_phantom.mha",
    "pet_body_f32.nii.gz",
    "nrrd_rotated_gzip_flair.nrrd",
    "ct_pelvis_right.nii.gz",
    "nifti_cases/orient_RAS.nii.gz",
    "tiff_stack_em",
    "nrrd_flipped_y_gzip_mr.nrrd",
)
VIEWS: dict[str, dict[str, Any]] = {
    "oblique": {"azimuth": 30, "elevation": 20},
    "axis": {"azimuth": 0, "elevation": 0},
    "below": {"azimuth": 200, "elevation": -35, "view_angle": 30.0},
    "near": {"azimuth": -60, "elevation": 35, "zoom": 2.5},
}
COLORS = [(0.0, 0.2, 0.3, 0.8), (0.4, 0.9, 0.6, 0.4), (0.6, 1.0, 0.95, 0.85), (1.0, 1.0, 1.0, 1.0)]
WANTED = (30.0, 40.0, 45.0, 50.0)
CONVERGED = ws.Sampling(16, 5)
#: Rungs of the ladder: those of `LADDER` in `crates/core/src/options.rs` that are chosen from.
RUNGS = [(1, 0.5), (2, 0.5), (2, 0.7), (2, 1), (3, 1), (3, 1.2), (4, 1.2), (4, 1.5), (4, 2), (6, 2), (6, 3), (8, 3)]
HEAD = ("picture", "wanted", "drawn", "reached", "told", "best by hindsight", "time", "again", "reached again")


@dataclass
class Row:
    """A picture of a wanted PSNR."""

    label: str
    wanted_db: float
    sampling: str
    reached_db: float
    told_db: float
    spread_db: float
    hindsight: str
    time: float
    again: float
    again_db: float

    @property
    def short_db(self) -> float:
        """Decibels below what was wanted, or told where less was told."""
        return min(self.wanted_db, self.told_db - self.spread_db) - self.reached_db


@dataclass
class Ladder:
    """PSNR and processor time of each rung in a picture."""

    kind: str
    rungs: list[tuple[float, float]]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, nargs="+", default=[128, 256], help="sides of the pictures in pixels")
    parser.add_argument("--only", default="", help="volumes whose names contain this")
    parser.add_argument("--record", action="store_true", help="keep what was printed in benches/records")
    asked = parser.parse_args()
    lines = []
    for size in asked.size:
        rows: list[Row] = []
        ladders: list[Ladder] = []
        for name in VOLUMES:
            if asked.only in name and (scenes.DATA / name).exists():
                rows += _rows(name, size, ladders)
                print(f"{name}, {size} x {size} done", file=sys.stderr, flush=True)
        if rows:
            lines += [f"### {size} x {size}", "", *_table(rows), "", *_summary(rows), "", *_rungs(ladders), ""]
    print("\n".join(lines))
    if asked.record:
        print(records.keep("make bench-psnr", "\n".join(lines)))


def _rows(name: str, size: int, ladders: list[Ladder]) -> Iterator[Row]:
    volume = ws.open(scenes.DATA / name)
    shown = {"size": (size, size), "threads": 1}
    for kind, function in _functions(volume).items():
        for view, place in VIEWS.items():
            camera = ws.Camera.orbit(volume, **place, fit="view")
            want = _converged(volume, function, camera, f"{name}-{kind}-{view}", size)
            scene = ws.Scene(volume, function)
            rungs = [timed(scene, camera, **shown, quality=ws.Sampling(*rung)) for rung in RUNGS]
            reached = [(psnr_db(picture, want), seconds) for picture, seconds in rungs]
            ladders.append(Ladder(kind, reached))
            for wanted_db in WANTED:
                fresh = ws.Scene(volume, function)
                # The tables of the transfer function and the occlusion of light are made once for every scene.
                timed(fresh, camera, **shown, quality="draft")
                first, seconds = timed(fresh, camera, **shown, psnr=wanted_db)
                again, seconds_again = timed(fresh, camera, **shown, psnr=wanted_db)
                report = first.report
                enough = [k for k, (db, _) in enumerate(reached) if db >= wanted_db]
                best = enough[0] if enough else len(RUNGS) - 1
                yield Row(
                    f"{Path(name).name.partition('.')[0]} {kind} {view}",
                    wanted_db,
                    f"{report['sheets_per_slice']:g} x {report['oversampling']:g}",
                    psnr_db(first, want),
                    report["expected_psnr_db"],
                    report["expected_psnr_spread_db"],
                    "{:g} x {:g}".format(*RUNGS[best]),
                    seconds / reached[best][1],
                    seconds_again / reached[best][1],
                    psnr_db(again, want),
                )


def _functions(volume: ws.Volume) -> dict[str, ws.TransferFunction]:
    samples = np.asarray(volume.samples)
    samples = samples[np.isfinite(samples)].astype(float)
    low, high = np.percentile(samples, [1, 99.9])
    inside = samples[samples > low + 0.05 * (high - low)]
    from_, middle, to = np.percentile(inside, [20, 60, 99.5])
    to = max(to, middle + 1e-3 * (high - low))
    colors = [(low + share * (high - low), *color) for share, *color in COLORS]
    return {
        "soft": ws.TransferFunction([(from_, 0), (middle, 0.05), (to, 0.2)], colors),
        "hard": ws.TransferFunction([(middle - (high - low) / 255, 0), (middle, 1)], colors),
    }


def _converged(
    volume: ws.Volume, function: ws.TransferFunction, camera: ws.Camera, name: str, size: int
) -> NDArray[np.float32]:
    path = scenes.CACHE / f"psnr-{name.replace('/', '-')}-{size}.npy"
    if path.exists():
        kept: NDArray[np.float32] = np.load(path)
        return kept
    want = ws.Scene(volume, function).render(camera, size=(size, size), quality=CONVERGED).rgba
    path.parent.mkdir(parents=True, exist_ok=True)
    np.save(path, want)
    return want


def timed(scene: ws.Scene, camera: ws.Camera, **options: Any) -> tuple[ws.Picture, float]:
    """The picture and its processor time."""
    begun = time.process_time()
    picture = scene.render(camera, **options)
    return picture, time.process_time() - begun


def psnr_db(picture: ws.Picture, want: NDArray[np.float32]) -> float:
    """PSNR of a picture's colours over black against a converged picture, dB, peak 1."""
    a, b = (np.clip(rgba[..., :3].astype(float), 0, 1) for rgba in (picture.rgba, want))
    return float(-10 * np.log10(np.mean((a - b) ** 2) + 1e-12))


def _table(rows: list[Row]) -> Iterator[str]:
    yield "| " + " | ".join(HEAD) + " |"
    yield "| --- |" + " ---: |" * (len(HEAD) - 1)
    for row in rows:
        yield (
            f"| {row.label} | {row.wanted_db:.0f} | {row.sampling} | {row.reached_db:.1f} "
            f"| {row.told_db:.1f} +- {row.spread_db:.1f} | {row.hindsight} | {row.time:.2f} | {row.again:.2f} "
            f"| {row.again_db:.1f} |"
        )


def _summary(rows: list[Row]) -> Iterator[str]:
    short = [row.short_db for row in rows]
    off = [abs(row.told_db - row.reached_db) for row in rows if row.told_db < 100]
    steps = [pair for pair in itertools.pairwise(rows) if pair[0].label == pair[1].label]
    yield f"- more than 1 dB short: {sum(db > 1 for db in short)} of {len(rows)}, at most {max(short):.1f} dB"
    yield f"- told within 2 dB of what was reached: {sum(db <= 2 for db in off)} of {len(off)}"
    yield f"- more wanted, less reached: {sum(b.reached_db < a.reached_db - 0.05 for a, b in steps)} of {len(steps)}"
    for name, times in (("first", [row.time for row in rows]), ("again", [row.again for row in rows])):
        mean = float(np.exp(np.mean(np.log(times))))
        yield f"- time, {name}: median {statistics.median(times):.2f}, geometric mean {mean:.2f}, most {max(times):.1f}"


def _rungs(ladders: list[Ladder]) -> Iterator[str]:
    kinds = ("soft", "hard")
    yield "| sheets x texels | " + " | ".join(f"{kind}, dB | {kind}, time" for kind in kinds) + " |"
    yield "| --- |" + " ---: |" * (2 * len(kinds))
    normal = RUNGS.index((2, 1))
    for k, rung in enumerate(RUNGS):
        numbers = []
        for kind in kinds:
            own = [one.rungs for one in ladders if one.kind == kind]
            numbers.append(f"{statistics.median(rungs[k][0] - rungs[normal][0] for rungs in own):+.1f}")
            numbers.append(f"{statistics.median(rungs[k][1] / rungs[normal][1] for rungs in own):.2f}")
        yield "| {:g} x {:g} | ".format(*rung) + " | ".join(numbers) + " |"


if __name__ == "__main__":
    main()
