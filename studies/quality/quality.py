"""Quality of the fast renderer against the converged picture; `make quality` runs this.

The converged picture is `wavesplat.reference.raycast`: double precision, a step of 0.05 voxels, the same linear
kernel and the same gradient. Soft transfer functions are compared with one ray per pixel, hard steps with 16, since
the edges of a hard step alias with one. Both pictures are taken over black and clipped to 0..1.

PSNR = 10 log10(1 / mean squared error over all pixels and channels), peak 1. A row of the table shows the lowest PSNR
and the largest mean absolute error (in grey levels of 255) of the pictures it stands for. Exit code 1 if any row
misses its goal.

Reference pictures take minutes, so they are kept in `.cache/quality`, each under a hash of all that defines it:
samples, affine, camera, curves, shading, size, step, rays, and a small probe picture, which notices when the reference
itself changes.

`--record` also writes the table, with date, machine and command, to RESULTS.md beside this file, and its short form
into benches/README.md.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import argparse
import datetime as dt
import hashlib
import json
import math
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

sys.path.append(str(Path(__file__).resolve().parents[1]))
import machine
from tables import as_markdown, as_text

ROOT = Path(__file__).resolve().parents[2]
CACHE = ROOT / ".cache" / "quality"
RESULTS = Path(__file__).with_name("RESULTS.md")
README = ROOT / "benches" / "README.md"

STEP_VOXELS = 0.05
QUALITIES = ("normal", "high")

#: Name, azimuth and elevation in degrees: oblique, and each along another axis of the grid for the most part.
VIEWS = (("front", 20.0, 15.0), ("side", -65.0, -20.0), ("top", 35.0, 60.0))

#: Vertical view angle in degrees; None is orthographic.
PROJECTIONS = {"orthographic": None, "perspective": 30.0}

VOLUMES: dict[str, Callable[[], ws.Volume]] = {
    "ct": ws.examples.ct_pelvis,
    "mri": ws.examples.mri_head,
    "ripples": partial(ws.examples.ripples, 32),
}

#: Opacity (value, opacity per voxel) and colour (value, red, green, blue). A hard step goes from 0 to 1 within one
#: grey level: the skin of the head, the bone of the pelvis, the middle of the ripples.
CURVES: dict[tuple[str, str], tuple[list[tuple[float, float]], list[tuple[float, float, float, float]]]] = {
    ("ct", "soft"): (
        [(-75, 0), (255, 0.05), (1000, 0.2)],
        [(-75, 0.8, 0.4, 0.25), (255, 1, 0.8, 0.6), (1000, 1, 1, 0.95)],
    ),
    ("ct", "hard"): ([(199, 0), (200, 1)], [(200, 1, 0.9, 0.75)]),
    ("mri", "soft"): (
        [(24, 0), (60, 0.05), (95, 0.2)],
        [(24, 0.8, 0.5, 0.4), (60, 1, 0.8, 0.65), (95, 1, 1, 1)],
    ),
    ("mri", "hard"): ([(24, 0), (25, 1)], [(25, 1, 0.85, 0.7)]),
    ("ripples", "soft"): (
        [(60, 0), (128, 0.05), (255, 0.2)],
        [(60, 0.3, 0.5, 0.9), (128, 0.9, 0.9, 0.9), (255, 0.9, 0.4, 0.2)],
    ),
    ("ripples", "hard"): ([(127, 0), (128, 1)], [(128, 0.85, 0.75, 0.6)]),
}

Picture = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """A picture of the study: volume, curve, shading, projection and view."""

    volume: str
    curve: str
    shaded: bool
    projection: str
    view: str

    @property
    def label(self) -> str:
        """Name of the case, which `--only` matches."""
        shading = "shaded" if self.shaded else "unshaded"
        return f"{self.volume}-{self.curve}-{shading}-{self.projection}-{self.view}"

    @property
    def rays_per_pixel(self) -> int:
        """Rays per pixel of the reference."""
        return 16 if self.curve == "hard" else 1

    def goal_db(self, quality: str) -> float | None:
        """Least PSNR that is asked for, dB; None where there is no goal."""
        if self.curve == "hard":
            return None if quality == "normal" else 34.0 if self.volume == "ripples" else 38.0
        least = {"normal": 40.0, "high": 45.0}[quality]
        return least if self.shaded else least + 5.0

    def arguments(self) -> tuple[ws.Volume, ws.TransferFunction, ws.Camera, ws.Shading | None]:
        """Arguments that both renderers take: volume, transfer function, camera, shading."""
        volume = loaded(self.volume)
        opacity, color = CURVES[self.volume, self.curve]
        azimuth, elevation = next((a, e) for name, a, e in VIEWS if name == self.view)
        camera = ws.Camera.orbit(volume, azimuth, elevation, view_angle=PROJECTIONS[self.projection], fit="view")
        return volume, ws.TransferFunction(opacity, color), camera, ws.Shading.headlight() if self.shaded else None


def all_cases() -> Iterator[Case]:
    """Every picture of the study, in the order of the table."""
    for volume in VOLUMES:
        for curve in ("soft", "hard"):
            for shaded in (True, False):
                for projection in PROJECTIONS:
                    for view, _, _ in VIEWS:
                        yield Case(volume, curve, shaded, projection, view)


@cache
def loaded(name: str) -> ws.Volume:
    """The volume, read once."""
    return VOLUMES[name]()


def over_black(picture: ws.Picture) -> Picture:
    """The colour over black, 0..1: associated colour over black is the colour itself."""
    return np.clip(picture.rgba[..., :3].astype(np.float64), 0.0, 1.0)


def cast(case: Case, size_px: int, rays_per_pixel: int, step: float = STEP_VOXELS) -> ws.Picture:
    """Draw the reference picture."""
    volume, transfer_function, camera, shading = case.arguments()
    return ws.reference.raycast(
        volume,
        transfer_function,
        camera,
        size=(size_px, size_px),
        step=step,
        rays_per_pixel=rays_per_pixel,
        kernel="linear",
        shading=shading,
    )


def reference_key(case: Case, size_px: int) -> str:
    """A hash of all that defines the reference picture."""
    volume, _, camera, shading = case.arguments()
    lights = None if shading is None else [(light.direction, light.color, light.frame) for light in shading.lights]
    definition = {
        "affine": volume.world_from_index.tolist(),
        "camera": [camera.position, camera.focal_point, camera.view_up, camera.parallel_scale, camera.view_angle],
        "curves": CURVES[case.volume, case.curve],
        "shading": shading and [repr(shading), lights],
        "sampling": [size_px, STEP_VOXELS, case.rays_per_pixel],
    }
    # Three digits: enough to notice another picture, too few to notice another order of additions.
    probe = np.round(over_black(cast(case, 24, 1, step=0.2)), 3)
    digest = hashlib.sha256(json.dumps(definition, sort_keys=True).encode())
    digest.update(np.ascontiguousarray(volume.samples).tobytes())
    digest.update((probe + 0.0).tobytes())
    return digest.hexdigest()[:24]


def reference(case: Case, size_px: int) -> Picture:
    """The converged picture, from the cache where it is there."""
    path = CACHE / f"{case.label}-{size_px}-{reference_key(case, size_px)}.npy"
    if not path.exists():
        picture = cast(case, size_px, case.rays_per_pixel)
        CACHE.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        with part.open("wb") as file:
            np.save(file, picture.rgba)
        part.replace(path)
    return over_black(ws.Picture(np.load(path)))


def fast(case: Case, size_px: int, quality: Any) -> Picture:
    """Draw the picture under test."""
    volume, transfer_function, camera, shading = case.arguments()
    size = (size_px, size_px)
    return over_black(ws.render(volume, transfer_function, camera, size=size, shading=shading, quality=quality))


@dataclass(frozen=True)
class Score:
    """Distance of a picture from its reference."""

    psnr_db: float
    mean_abs_levels: float

    @classmethod
    def of(cls, picture: Picture, wanted: Picture) -> Score:
        """Score of a picture."""
        difference = picture - wanted
        mean_square = float(np.mean(difference**2))
        psnr_db = 10 * math.log10(1 / mean_square) if mean_square > 0 else math.inf
        return cls(psnr_db, 255 * float(np.mean(np.abs(difference))))

    @classmethod
    def worst(cls, scores: Sequence[Score]) -> Score:
        """Score of the lowest PSNR and the largest error."""
        return cls(min(score.psnr_db for score in scores), max(score.mean_abs_levels for score in scores))


ROW_FIELDS = {
    "volume": ("volume", "curve", "shaded"),
    "projection": ("volume", "curve", "shaded", "projection"),
    "view": ("volume", "curve", "shaded", "projection", "view"),
}
HEADINGS = {"volume": "volume", "curve": "opacity", "shaded": "shading", "projection": "projection", "view": "view"}


def table(scores: dict[Case, dict[str, Score]], rows: str) -> tuple[list[list[str]], bool]:
    """Heading and rows of the table, and whether all goals are met."""
    fields = ROW_FIELDS[rows]
    groups: dict[tuple[Any, ...], list[Case]] = {}
    for case in scores:
        groups.setdefault(tuple(getattr(case, name) for name in fields), []).append(case)
    lines = [[HEADINGS[name] for name in fields]]
    for quality in QUALITIES:
        lines[0] += [f"{quality}, dB", "goal", "levels"]
    met = True
    for group, cases in groups.items():
        line = [{True: "yes", False: "no"}.get(value, value) for value in group]
        for quality in QUALITIES:
            score = Score.worst([scores[case][quality] for case in cases])
            goal = cases[0].goal_db(quality)
            missed = goal is not None and score.psnr_db < goal
            met = met and not missed
            line += [
                f"{score.psnr_db:.1f}" + (" MISSED" if missed else ""),
                "" if goal is None else f"{goal:.0f}",
                f"{score.mean_abs_levels:.3f}",
            ]
        lines.append(line)
    return lines, met


def record(scores: dict[Case, dict[str, Score]], size_px: int) -> None:
    """Keep the tables in the repository."""
    lines, _ = table(scores, "projection")
    RESULTS.write_text(
        f"""# Fast renderer against converged pictures

{dt.datetime.now(dt.UTC):%Y-%m-%d}, {machine.describe()}, {size_px} x {size_px} pixels.
Command: `make quality QUALITY="{" ".join(sys.argv[1:])}"`.
What is compared, and how, stands at the head of `quality.py`.
A row shows the lowest PSNR and the largest mean absolute error, in grey levels of 255, of three oblique views.

{as_markdown(lines)}
""",
        encoding="utf-8",
    )
    lines, _ = table(scores, "volume")
    readme = README.read_text(encoding="utf-8")
    block = f"<!-- quality -->\n\n{as_markdown(lines)}\n\n<!-- /quality -->"
    # A function, so that nothing in the table is taken for a reference to a group.
    readme = re.sub(r"<!-- quality -->.*<!-- /quality -->", lambda _: block, readme, flags=re.DOTALL)
    README.write_text(readme, encoding="utf-8")


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description="Compare the fast renderer with the converged picture.")
    parser.add_argument("--size", type=int, default=512, metavar="PX", help="side of the pictures; 512 if not given")
    parser.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="TEXT",
        help="only pictures whose label holds this text, such as ct-hard; may be given several times",
    )
    parser.add_argument("--rows", choices=ROW_FIELDS, default="projection", help="what a row of the table stands for")
    parser.add_argument("--markdown", action="store_true", help="print a Markdown table")
    parser.add_argument(
        "--record", action="store_true", help="write RESULTS.md and the table of benches/README.md; all pictures"
    )
    return parser.parse_args()


def main() -> int:
    """Print the table; 1 if a goal is missed."""
    options = arguments()
    if options.record and options.only:
        print("--record needs all pictures; leave out --only", file=sys.stderr)
        return 2
    cases = [case for case in all_cases() if not options.only or any(text in case.label for text in options.only)]
    if not cases:
        print(f"no picture matches; the labels look like {next(all_cases()).label}", file=sys.stderr)
        return 2
    scores: dict[Case, dict[str, Score]] = {}
    started = time.monotonic()
    for number, case in enumerate(cases, 1):
        wanted = reference(case, options.size)
        scores[case] = {quality: Score.of(fast(case, options.size, quality), wanted) for quality in QUALITIES}
        found = ", ".join(f"{quality} {score.psnr_db:.1f} dB" for quality, score in scores[case].items())
        seconds = time.monotonic() - started
        print(f"[{number}/{len(cases)}, {seconds:.0f} s] {case.label}: {found}", file=sys.stderr, flush=True)
    if options.record:
        record(scores, options.size)
    lines, met = table(scores, options.rows)
    print(as_markdown(lines) if options.markdown else as_text(lines))
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
