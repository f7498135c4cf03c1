"""Random transfer functions against arithmetic; `make random-functions` runs this.

Values grow evenly along every ray, so that the opacity of a pixel is 1 - exp(-integral of -ln(1 - a)), which has a
closed form between the nodes of a curve a, and its colour is a sum over values. The functions have peaks, steps, combs,
shells, plateaus and gaps, faint, strong and of opacity 1, down to a thousandth of the range of values wide. Each is
drawn at every quality, with a random number of slices, from a random angle, with opacities per random length. `--balls`
draws so many more functions on a ball, against `wavesplat.reference.raycast` with many rays.

The table has mean and largest errors in grey levels of 255. Exit code 1 if an error is larger than its quality allows,
or a better quality is worse. The same `--seed` gives the same functions.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

sys.path.append(str(Path(__file__).resolve().parents[1]))
from tables import as_text

QUALITIES: tuple[Any, ...] = ("draft", "normal", "fine", "high")

#: Largest errors of opacity and of colour on ramps, grey levels.
LIMITS: dict[str, tuple[float, float]] = {
    "draft": (4.0, 16.0),
    "normal": (3.0, 8.0),
    "fine": (2.0, 5.0),
    "high": (2.0, 5.0),
}

#: Margin by which a better quality may be worse: error in grey levels, and PSNR on balls in dB.
MARGIN = 1.0
MARGIN_DB = 0.5

#: Least PSNR of a picture of a ball at quality normal: a black picture, where a shell should be seen, has less.
MIN_BALL_DB = 25.0

#: Largest value of the volumes; the smallest is 0.
RANGE = 100.0

#: Steps between two nodes that the wanted colours are summed in.
STEPS = 200

Curve = list[tuple[float, float]]
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """A transfer function, and how it is drawn."""

    kind: str
    opacity: Curve
    color: list[tuple[float, float, float, float]]
    unit: float | None
    n_slices: int
    tilt_deg: float
    #: Number of sample levels per unit of value, in whole numbers of 16 bits; 0: the samples are floats.
    per_value: int

    @property
    def scale(self) -> int:
        """Sample units per unit of the curves."""
        return self.per_value or 1

    def transfer_function(self) -> ws.TransferFunction:
        """Transfer function in sample units."""
        color = [(value * self.scale, *rgb) for value, *rgb in self.color]
        return ws.TransferFunction([(v * self.scale, a) for v, a in self.opacity], color, opacity_unit=self.unit)

    def ramp(self) -> ws.Volume:
        """Volume whose values go from 0 to RANGE along z."""
        values = np.linspace(0, RANGE * self.scale, self.n_slices)[:, None, None]
        dtype = np.uint16 if self.per_value else np.float32
        return ws.Volume(np.broadcast_to(values, (self.n_slices, 64, 64)).astype(dtype))

    def camera(self) -> ws.Camera:
        """Camera that looks along -z, turned about y."""
        focus = np.array([31.5, 31.5, (self.n_slices - 1) / 2])
        tilt = math.radians(self.tilt_deg)
        to_eye = np.array([math.sin(tilt), 0.0, math.cos(tilt)])
        return ws.Camera(tuple(focus + 200 * to_eye), tuple(focus), (0, 1, 0), parallel_scale=2.0)

    def draw(self, quality: str) -> Floats:
        """Draw the case; colour and opacity of a ray."""
        options: dict[str, Any] = {"size": (8, 8), "shading": None, "quality": quality, "device": "cpu"}
        picture = ws.render(self.ramp(), self.transfer_function(), self.camera(), **options)
        rgba: Floats = picture.rgba[4, 4].astype(float)
        return rgba

    def wanted(self) -> Floats:
        """Colour and opacity of a ray by arithmetic."""
        length = (self.n_slices - 1) / math.cos(math.radians(self.tilt_deg)) / (self.unit or 1.0)
        nodes = sorted({0.0, RANGE, *(v for v, *_ in self.opacity), *(v for v, *_ in self.color)})
        inside = [node for node in nodes if 0 <= node <= RANGE]
        edges = np.unique(np.concatenate([np.linspace(a, b, STEPS + 1) for a, b in pairwise(inside)]))
        sums = np.array([depth_up_to(self.opacity, value) for value in edges])
        # The eye is on the side of the largest value.
        depths = (np.diff(sums) * length / RANGE)[::-1]
        colors = np.array([color_at(self.color, value) for value in (edges[1:] + edges[:-1]) / 2])[::-1]
        passed = np.exp(-np.concatenate([[0.0], np.cumsum(depths)]))
        weights = passed[:-1] - passed[1:]
        return np.array([*(weights @ colors), 1 - passed[-1]])


def depth_up_to(curve: Curve, value: float) -> float:
    """Integral of -ln(1 - a) from value 0 on, in units of value; very large in a plateau of opacity 1."""
    nodes = [(-1e3, curve[0][1]), *curve, (1e4, curve[-1][1])]
    return sum(
        part(*between((v0, a0), (v1, a1), max(v0, 0.0), min(v1, value)))
        for (v0, a0), (v1, a1) in pairwise(nodes)
        if max(v0, 0.0) < min(v1, value)
    )


def between(
    node: tuple[float, float], following: tuple[float, float], begin: float, end: float
) -> tuple[float, float, float]:
    """Width, and the opacities at both ends, of a part between two nodes."""
    (v0, a0), (v1, a1) = node, following
    at = [a0 + (a1 - a0) * (v - v0) / (v1 - v0) for v in (begin, end)]
    return end - begin, at[0], at[1]


def part(width: float, a: float, b: float) -> float:
    """Width times the mean of -ln(1 - opacity), where the opacity goes linearly from a to b.

    With u = 1 - a and v = 1 - b the mean is that of -ln from v to u, whose antiderivative is x - x ln x.
    """
    u, v = 1 - a, 1 - b
    if max(u, v) <= 0:
        return 1e9 * width
    if abs(u - v) < 1e-6 * min(u, v):
        return -width * math.log((u + v) / 2)
    return width * ((u - x_log_x(u)) - (v - x_log_x(v))) / (u - v)


def x_log_x(x: float) -> float:
    """Return x ln x, and its limit at 0."""
    return x * math.log(x) if x > 0 else 0.0


def color_at(nodes: Sequence[tuple[float, float, float, float]], value: float) -> list[float]:
    """Red, green, blue of a curve of colours."""
    values = [node[0] for node in nodes]
    return [float(np.interp(value, values, [node[c] for node in nodes])) for c in (1, 2, 3)]


def peak(rng: np.random.Generator, top: float, center: float | None = None, width: float | None = None) -> Curve:
    """A tent-shaped peak."""
    center = float(rng.uniform(3, 97)) if center is None else center
    width = log_uniform(rng, 0.05, 20) if width is None else width
    return [(center - width, 0.0), (center, top), (center + width, 0.0)]


def log_uniform(rng: np.random.Generator, lo: float, hi: float) -> float:
    """A random number whose logarithm is uniform, so that small numbers are as frequent as large ones."""
    return float(np.exp(rng.uniform(math.log(lo), math.log(hi))))


def box(rng: np.random.Generator, top: float) -> Curve:
    """A plateau with upright walls."""
    center, half = float(rng.uniform(3, 97)), log_uniform(rng, 0.05, 20)
    return [(center - half, 0.0), (center - half, top), (center + half, top), (center + half, 0.0)]


def comb(rng: np.random.Generator, top: float) -> Curve:
    """Peaks side by side, each of its own height."""
    n = int(rng.integers(3, 10))
    pitch = RANGE / n
    width = log_uniform(rng, 0.05, 0.45 * pitch)
    tops = [top * float(rng.uniform(0.3, 1)) if top < 1 else 1.0 for _ in range(n)]
    return [node for k in range(n) for node in peak(rng, tops[k], (k + 0.5) * pitch, width)]


def step(rng: np.random.Generator, top: float) -> Curve:
    """A step up or down, upright or over a few values."""
    center, half = float(rng.uniform(5, 95)), float(rng.choice([0.0, log_uniform(rng, 0.02, 5)]))
    ends = (0.0, top) if rng.random() < 0.5 else (top, 0.0)
    return [(center - half, ends[0]), (center + half, ends[1])]


def gap(rng: np.random.Generator, top: float) -> Curve:
    """A plateau with a slit."""
    return [(value, top - opacity) for value, opacity in peak(rng, top)]


def mixture(rng: np.random.Generator, top: float) -> Curve:
    """A curve with nodes anywhere."""
    n = int(rng.integers(3, 10))
    values = np.sort(rng.uniform(0, RANGE, n))
    return [(float(value), float(rng.choice([0.0, top, top * rng.uniform()]))) for value in values]


KINDS: dict[str, Callable[[np.random.Generator, float], Curve]] = {
    "peak": peak,
    "comb": comb,
    "shell": box,
    "step": step,
    "gap": gap,
    "mixture": mixture,
}


def cases(seed: int, n: int) -> Iterator[Case]:
    """Random functions, each kind as often as the others; a third is faint, a third strong, a third has opacity 1."""
    rng = np.random.default_rng(seed)
    for k in range(n):
        kind = list(KINDS)[k % len(KINDS)]
        strength = ("faint", "strong", "opaque")[k // len(KINDS) % 3]
        top = {"faint": log_uniform(rng, 0.01, 0.3), "strong": float(rng.uniform(0.3, 0.999)), "opaque": 1.0}[strength]
        n_colors = int(rng.integers(1, 5))
        values = np.sort(rng.uniform(0, RANGE, n_colors))
        color = [
            (float(v), float(r), float(g), float(b))
            for v, (r, g, b) in zip(values, rng.uniform(0, 1, (n_colors, 3)), strict=True)
        ]
        yield Case(
            kind=f"{kind}, {strength}",
            opacity=KINDS[kind](rng, top),
            color=color,
            unit=None if rng.random() < 0.5 else log_uniform(rng, 0.3, 5),
            n_slices=int(rng.choice([9, 16, 33])),
            tilt_deg=float(rng.choice([0, 25, 40])),
            per_value=int(rng.choice([0, 600])),
        )


@dataclass
class Errors:
    """Errors of a case by quality, grey levels."""

    case: Case
    opacity: dict[str, float]
    color: dict[str, float]

    def faults(self) -> Iterator[str]:
        """Sentences on the errors that are too large."""
        for quality, (of_opacity, of_color) in LIMITS.items():
            if self.opacity[quality] > of_opacity:
                yield f"quality {quality}: the opacity is off by {self.opacity[quality]:.1f} grey levels"
            if self.color[quality] > of_color:
                yield f"quality {quality}: the colour is off by {self.color[quality]:.1f} grey levels"
        for worse, better in pairwise(QUALITIES):
            if self.opacity[better] > self.opacity[worse] + MARGIN:
                levels = f"{self.opacity[better]:.1f} at {better}, {self.opacity[worse]:.1f} at {worse}"
                yield f"the opacity is off by {levels}"


def measured(case: Case) -> Errors:
    """Draw a case at every quality, and measure its errors."""
    want = case.wanted()
    off = {quality: 255 * np.abs(case.draw(quality) - want) for quality in QUALITIES}
    return Errors(case, {q: float(e[3]) for q, e in off.items()}, {q: float(e[:3].max()) for q, e in off.items()})


def table(errors: Sequence[Errors]) -> str:
    """Table of mean and largest errors by kind."""
    lines = [["function", "n", *(f"{what}, {quality}" for what in ("opacity", "colour") for quality in QUALITIES)]]
    kinds = sorted({e.case.kind for e in errors})
    for kind in [*kinds, "all"]:
        own = [e for e in errors if kind in (e.case.kind, "all")]
        columns = [[getattr(e, what)[q] for e in own] for what in ("opacity", "color") for q in QUALITIES]
        lines.append([kind, str(len(own)), *(f"{np.mean(column):.2f} ({max(column):.2f})" for column in columns)])
    return as_text(lines)


def ball() -> ws.Volume:
    """A ball, whose value falls evenly from RANGE in the middle to 0 at its surface."""
    z, y, x = np.mgrid[:32, :32, :32] - 15.5
    return ws.Volume(np.clip(RANGE * (1 - np.sqrt(x * x + y * y + z * z) / 15), 0, RANGE).astype(np.float32))


def ball_psnr_db(case: Case) -> dict[str, float]:
    """PSNR of opacity and colour by quality, against many rays in small steps."""
    volume, look = ball(), ws.TransferFunction(case.opacity, case.color, opacity_unit=case.unit)
    camera = ws.Camera.orbit(volume, 30, 20, fit="view")
    size = (48, 48)
    want = ws.reference.raycast(volume, look, camera, size=size, step=0.01, rays_per_pixel=25, shading=None).rgba
    psnr_db = {}
    for quality in QUALITIES:
        got = ws.render(volume, look, camera, size=size, shading=None, quality=quality, device="cpu").rgba
        psnr_db[quality] = float(-10 * np.log10(np.mean((got - want) ** 2) + 1e-10))
    return psnr_db


def main() -> int:
    """Print the tables; 1 if an error is too large."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="of the functions")
    parser.add_argument("--n", type=int, default=400, help="functions on ramps")
    parser.add_argument("--balls", type=int, default=0, help="functions on a ball, seconds each")
    parser.add_argument("--show", action="store_true", help="print the functions that are wrong")
    arguments = parser.parse_args()
    errors = [measured(case) for case in cases(arguments.seed, arguments.n)]
    n_wrong = 0
    for e in errors:
        faults = list(e.faults())
        n_wrong += bool(faults)
        for fault in faults:
            print(f"{e.case.kind}: {fault}" + (f": {e.case}" if arguments.show else ""))
    if errors:
        print(table(errors))
    for case in cases(arguments.seed + 1_000_000, arguments.balls):
        psnr_db = ball_psnr_db(case)
        text = ", ".join(f"{quality} {value:.1f} dB" for quality, value in psnr_db.items())
        falls = any(psnr_db[b] < psnr_db[a] - MARGIN_DB for a, b in pairwise(QUALITIES))
        is_far = psnr_db["normal"] < MIN_BALL_DB
        is_wrong = falls or is_far
        n_wrong += is_wrong
        print(
            f"ball, {case.kind}: {text}{', better is worse' if falls else ''}{', too far off' if is_far else ''}"
            + (f": {case}" if is_wrong and arguments.show else "")
        )
    print(f"{n_wrong} of {len(errors) + arguments.balls} functions are wrong (seed {arguments.seed})")
    return 1 if n_wrong else 0


if __name__ == "__main__":
    sys.exit(main())
