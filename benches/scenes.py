"""The scenes of `cases.toml` as Wavesplat objects, and their converged pictures."""

from __future__ import annotations

import dataclasses
import hashlib
import math
import os
import tomllib
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

ROOT = Path(__file__).resolve().parents[1]
DEFINITIONS: dict[str, Any] = tomllib.loads((ROOT / "benches" / "cases.toml").read_text(encoding="utf-8"))

#: Folder of the volumes' files; volumes that it lacks fall back on bundled ones, or are left out.
DATA = Path(os.environ.get("BENCH_DATA", ROOT / "bench-data"))
CACHE = ROOT / ".cache" / "bench"

#: Half the height of the picture, as a share of the volume's largest side.
FILL = 0.62
VIEW_ANGLE_DEG = 30.0
HEADLIGHT = ws.Shading.headlight()

#: Step of the converged picture, in voxels.
STEP_VOXELS = 0.05


@dataclass(frozen=True)
class Case:
    """A picture that is drawn many times."""

    group: str
    volume: str
    curve: str
    view: str
    projection: str
    size: int
    threads: int
    kernel: str
    composite: str
    settings: tuple[dict[str, Any], ...]
    rival: bool = True
    # Fields of the cases of growth. Not in the name of the converged picture's file, since these cases have none.
    change: str = field(default="", repr=False)
    grid: str = field(default="own", repr=False)
    at_most: float | None = field(default=None, repr=False)
    compared: bool = field(default=True, repr=False)

    @property
    def label(self) -> str:
        """Volume and curve, and the fields that differ from the defaults."""
        if self.change:
            return f"{self.volume} {self.curve}: {self.change}"
        names = ("view", "projection", "size", "threads", "kernel", "composite")
        parts = [str(getattr(self, n)) for n in names if getattr(self, n) != DEFINITIONS["defaults"][n]]
        return " ".join([self.volume, self.curve, *parts])

    @property
    def rays_per_pixel(self) -> int:
        """Rays per pixel of the converged picture; with one, the edges of a hard step alias."""
        return 16 if self.curve == "hard" else 1


def cases() -> list[Case]:
    """All cases, in order."""
    growth = DEFINITIONS["growth"]
    base = {**growth["base"], "volume": growth_volume()}
    grown = [{**base, **case} for case in growth["cases"]]
    return [Case(**{**DEFINITIONS["defaults"], **case}) for case in [*DEFINITIONS["cases"], *grown]]


def growth_volume() -> str:
    """Name of the volume that the cases of growth draw: the first that is available."""
    return next(filter(is_available, DEFINITIONS["growth"]["volumes"]))


def is_available(volume: str) -> bool:
    """Whether a volume can be loaded here."""
    definition = DEFINITIONS["volumes"][volume]
    return "file" not in definition or (DATA / definition["file"]).exists() or "bundled" in definition


@cache
def load(name: str, grid: str = "own") -> ws.Volume:
    """A volume, windowed to 8 bits, its first sample at the origin and its axes along the world's."""
    if grid != "own":
        return GRIDS[grid](load(name))
    definition = DEFINITIONS["volumes"][name]
    if "ripples" in definition:
        source = ws.examples.ripples(definition["ripples"])
        spacing = (1.0, 1.0, 1.0)
    else:
        path = DATA / definition["file"]
        source = ws.open(path) if path.exists() else getattr(ws.examples, definition["bundled"])()
        spacing = source.spacing
    lo, hi = definition["window"]
    levels = np.rint((source.samples.astype(np.float64) - lo) / (hi - lo) * 255)
    return ws.Volume(np.clip(levels, 0, 255).astype(np.uint8), spacing=spacing, name=name)


def twice_the_slices(volume: ws.Volume) -> ws.Volume:
    """A volume of the same densities, up to rounding, with one more slice across z between any two."""
    slices = volume.samples.astype(np.uint16)
    fine = np.empty((2 * len(slices) - 1, *slices.shape[1:]), np.uint8)
    fine[::2] = slices
    fine[1::2] = (slices[:-1] + slices[1:] + 1) // 2
    x, y, z = volume.spacing
    return ws.Volume(fine, spacing=(x, y, z / 2), name=volume.name)


def tiled(volume: ws.Volume, n: int = 1024) -> ws.Volume:
    """The volume repeated to `n` samples along each axis, made without a second large array."""
    samples, along = volume.samples, np.arange(n)
    large = np.empty((n, n, n), np.uint8)
    for z in range(n):
        large[z] = samples[z % len(samples)].take(along, 0, mode="wrap").take(along, 1, mode="wrap")
    return ws.Volume(large, spacing=volume.spacing, name=volume.name)


GRIDS = {"twice the slices": twice_the_slices, "1024": tiled}


def transfer_function(case: Case) -> ws.TransferFunction:
    """Transfer function of a case."""
    definition, curves = DEFINITIONS["volumes"][case.volume], DEFINITIONS["curves"]
    unit = min(load(case.volume).spacing)
    if case.curve == "hard":
        t = definition["threshold"]
        return ws.TransferFunction(
            [(0, 0), (t - 1, 0), (t, 1), (255, 1)], [tuple(c) for c in curves["hard_colors"]], opacity_unit=unit
        )
    if case.curve == "invisible":
        return ws.TransferFunction([(0, 0), (255, 0)], [tuple(c) for c in curves["soft_colors"]], opacity_unit=unit)
    lo, hi = definition["ramp"]
    opacity = [(0, 0), (lo, 0), (hi, 0.05), (255, 0.2)]
    return ws.TransferFunction(opacity, [tuple(c) for c in curves["soft_colors"]], opacity_unit=unit)


def camera(case: Case, turn_deg: float = 0.0) -> ws.Camera:
    """Camera of a case, turned about the vertical."""
    volume = load(case.volume, case.grid)
    extent = (np.array(volume.samples.shape[::-1]) - 1) * volume.spacing
    azimuth, elevation = DEFINITIONS["views"][case.view]
    az, el = math.radians(azimuth + turn_deg), math.radians(elevation)
    to_eye = np.array([math.sin(az) * math.cos(el), -math.cos(az) * math.cos(el), math.sin(el)])
    half_height = FILL * float(extent.max())
    distance = half_height / math.tan(math.radians(VIEW_ANGLE_DEG) / 2)
    eye = extent / 2 + distance * to_eye
    if case.projection == "perspective":
        return ws.Camera(eye, extent / 2, (0, 0, 1), view_angle=VIEW_ANGLE_DEG)
    return ws.Camera(eye, extent / 2, (0, 0, 1), parallel_scale=half_height)


def scene(case: Case, *, shading: ws.Shading | None = HEADLIGHT) -> ws.Scene:
    """Scene of a case."""
    return ws.Scene(load(case.volume, case.grid), transfer_function(case), shading=shading)


def render(
    case: Case,
    turn_deg: float = 0.0,
    *,
    kept: ws.Scene | None = None,
    sheets_per_slice: float | None = None,
    quality: str = "normal",
    **settings: Any,
) -> ws.Picture:
    """Draw a case by the fast renderer, with a scene that is kept or a new one."""
    if "shading" in settings:
        kept = scene(case, shading=settings.pop("shading"))
    return (kept or scene(case)).render(
        camera(case, turn_deg),
        size=(case.size, case.size),
        kernel=case.kernel,
        composite=case.composite,
        threads=case.threads,
        quality=ws.Sampling(sheets_per_slice, quality=quality),
        **settings,
    )


def converged(case: Case) -> NDArray[np.float64]:
    """The converged picture over black, from the cache where it is there."""
    case = dataclasses.replace(case, threads=0, group="", settings=(), rival=True)
    digest = hashlib.sha256(repr((case, transfer_function(case), camera(case), STEP_VOXELS)).encode())
    digest.update(load(case.volume).samples.tobytes())
    path = CACHE / f"{case.volume}-{case.curve}-{digest.hexdigest()[:16]}.npy"
    if not path.exists():
        picture = ws.reference.raycast(
            load(case.volume),
            transfer_function(case),
            camera(case),
            size=(case.size, case.size),
            step=STEP_VOXELS,
            rays_per_pixel=case.rays_per_pixel,
            kernel=case.kernel,
            shading=ws.Shading.headlight(),
        )
        CACHE.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        with part.open("wb") as file:
            np.save(file, picture.rgba)
        part.replace(path)
    return over_black(np.load(path))


def over_black(rgba: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """The colour over black, 0..1: associated colour over black is the colour itself."""
    return np.clip(rgba[..., :3].astype(np.float64), 0.0, 1.0)


def errors(picture: NDArray[np.float64], wanted: NDArray[np.float64]) -> tuple[float, float]:
    """PSNR in dB (peak 1) and mean absolute error in grey levels of 255."""
    difference = picture - wanted
    mean_square = max(float(np.mean(difference**2)), 1e-20)
    return 10 * math.log10(1 / mean_square), 255 * float(np.mean(np.abs(difference)))
