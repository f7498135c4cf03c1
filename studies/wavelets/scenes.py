"""The volumes of the study, the scenes that they are drawn in, and how far two pictures are apart.

`wavelets.py` says what the scenes are for.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import hashlib
import sys
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import subjects
from numpy.typing import NDArray

import wavesplat as ws

CACHE = Path(__file__).resolve().parents[2] / ".cache" / "study-wavelets"

#: Step of the converged pictures, in voxels.
STEP_VOXELS = 0.05

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Printed:
    """Numbers that the paper prints for its volume."""

    #: Number of the figure with its curves of share and error over the threshold.
    figure: int
    #: The threshold that the paper takes as harmless, and the share kept there, percent.
    threshold: int
    kept: float
    #: Errors by threshold, in grey levels.
    errors: dict[int, float]
    #: Thresholds of the paper's row of pictures.
    row: tuple[int, ...]


@dataclass(frozen=True)
class Subject:
    """A volume of the study, in the units of its file; `window` becomes 0..255."""

    drawn: subjects.Drawn
    window: tuple[float, float]
    printed: Printed


def mri_half() -> ws.Volume:
    """The head averaged over 2 x 2 x 2 samples."""
    whole = subjects.mri()
    nz, ny, nx = (n // 2 for n in whole.shape)
    pairs = whole.samples[: 2 * nz, : 2 * ny, : 2 * nx].reshape(nz, 2, ny, 2, nx, 2)
    wider = np.diag([2.0, 2.0, 2.0, 1.0])
    wider[:3, 3] = 0.5
    return ws.Volume(pairs.mean(axis=(1, 3, 5)), world_from_index=whole.world_from_index @ wider, name=whole.name)


PRINTED_RIPPLES = Printed(11, 12, 19.95, {0: 11.39, 12: 5.63, 14: 16.05}, (0, 2, 4, 12, 14, 64))
PRINTED_CT = Printed(15, 12, 3.55, {0: 5.18, 12: 5.09, 14: 10.96}, (0, 12, 14, 16, 32, 64))
PRINTED_MRI = Printed(17, 16, 1.27, {0: 3.25, 16: 2.72, 32: 8.74}, (0, 16, 32, 64))

#: The head's window ends at 255, since its file holds 8 bits; the averaged head's at its brightest average.
SUBJECTS = {
    "ripples": Subject(subjects.RIPPLES, (0, 255), PRINTED_RIPPLES),
    "ct": Subject(subjects.CT, (-1000, 1310), PRINTED_CT),
    "mri": Subject(subjects.MRI, (0, 255), PRINTED_MRI),
    "mri-half": Subject(replace(subjects.MRI, source=mri_half), (0, 168), PRINTED_MRI),
}


def grey(name: str, value: float) -> float:
    """A value of the file in grey levels."""
    lo, hi = SUBJECTS[name].window
    return 255 * (value - lo) / (hi - lo)


@cache
def loaded(name: str, *, rounded: bool = True) -> ws.Volume:
    """The volume in grey levels, 8 bits, or float32 if not rounded."""
    source = SUBJECTS[name].drawn.source()
    levels = np.clip(grey(name, 0) + source.samples * (grey(name, 1) - grey(name, 0)), 0, 255)
    samples = np.rint(levels).astype(np.uint8) if rounded else levels.astype(np.float32)
    return ws.Volume(samples, world_from_index=source.world_from_index, name=source.name)


@dataclass(frozen=True)
class Scene:
    """Settings with which a volume is drawn, and the pixels that count."""

    label: str
    curve: str
    shaded: bool = True
    along_z: bool = False
    only_covered: bool = False
    rounded: bool = True
    cropped: bool = True
    plain_sheets: bool = False


#: Settings of the method as the paper has it, which override those of quality "high".
PLAIN_SHEETS = {"quality": ws.Sampling(1, 1), "pre_integration": False, "early_ray_termination": False}

FOG = Scene("along z, fog, one sheet per slice: the goals' scene", "fog", False, True, plain_sheets=True)
SOFT = Scene("oblique, soft, shaded", "soft")
HARD = Scene("oblique, hard, shaded", "hard")

#: Scenes of the table of what the error depends on.
SCENES = (
    FOG,
    Scene("the same, samples not rounded to 8 bits", "fog", False, True, rounded=False, plain_sheets=True),
    Scene("the same, quality high, which averages over the pixel", "fog", False, True),
    Scene("oblique, fog", "fog", False),
    Scene("oblique, soft, unshaded", "soft", False),
    SOFT,
    Scene("oblique, hard, unshaded", "hard", False),
    HARD,
    Scene("the same, over the pixels that the object covers", "hard", only_covered=True),
    Scene("the same, with the table under the patient", "hard", cropped=False),
    Scene("oblique, transfer function from the histogram, shaded", "auto"),
)


def transfer_function(name: str, curve: str) -> ws.TransferFunction:
    """Transfer function of a subject, over grey levels."""
    volume, drawn = loaded(name), SUBJECTS[name].drawn
    if curve == "auto":
        return ws.TransferFunction.auto(volume)
    if curve == "fog":
        return ws.TransferFunction(
            [(60, 0), (255, 0.15)], [(0, 0, 0, 0), (255, 1, 1, 1)], opacity_unit=volume.spacing[2]
        )
    if curve == "hard":
        return subjects.hard_function(round(grey(name, drawn.hard)))
    return subjects.soft_function(*(grey(name, value) for value in drawn.soft))


def camera_along_z(volume: ws.Volume) -> ws.Camera:
    """Camera that looks from the first slice at the last; row 0 of the picture is row 0 of the slice."""
    nz, ny, nx = volume.shape
    axes = volume.world_from_index[:3, :3]
    middle = axes @ (np.array([nx, ny, nz]) - 1) / 2 + volume.world_from_index[:3, 3]
    return ws.Camera(middle - nz * axes[:, 2], middle, -axes[:, 1], parallel_scale=ny / 2 * volume.spacing[1])


def drawing(name: str, scene: Scene, size_px: int) -> dict[str, Any]:
    """Arguments that `render` and `raycast` take besides the volume."""
    volume, drawn = loaded(name), SUBJECTS[name].drawn
    camera = camera_along_z(volume) if scene.along_z else ws.Camera.orbit(volume, *drawn.view, fit="view")
    return {
        "transfer_function": transfer_function(name, scene.curve),
        "camera": camera,
        "size": volume.shape[:0:-1] if scene.along_z else (size_px, size_px),
        "shading": ws.Shading.headlight() if scene.shaded else None,
        "clip": drawn.crop if drawn.crop and scene.cropped and not scene.along_z else (),
    }


def rgba_levels(picture: ws.Picture) -> Array:
    """The picture over black and its opacity, in grey levels."""
    return 255 * np.clip(picture.rgba.astype(np.float64), 0, 1)


def draw(volume: ws.Volume, name: str, scene: Scene, size_px: int) -> Array:
    """Draw a volume in place of the subject; RGBA in grey levels."""
    how: Any = {**drawing(name, scene, size_px), "quality": "high", **(PLAIN_SHEETS if scene.plain_sheets else {})}
    return rgba_levels(ws.study.render(volume, how.pop("transfer_function"), **how))


@cache
def wanted(name: str, scene: Scene, size_px: int) -> Array:
    """Picture of the samples with no coefficient dropped."""
    return draw(loaded(name, rounded=scene.rounded), name, scene, size_px)


@cache
def converged(name: str, scene: Scene, size_px: int) -> Array:
    """That picture by the ray caster, with 16 rays a pixel for the hard step; from the cache if it is there."""
    how = {**drawing(name, scene, size_px), "rays_per_pixel": 16 if scene.curve == "hard" else 1}
    digest = hashlib.sha256(repr((STEP_VOXELS, how)).encode() + loaded(name).samples.tobytes()).hexdigest()[:16]
    path = CACHE / f"{name}-{scene.curve}-{size_px}-{digest}.npy"
    if not path.exists():
        print(f"converged picture of {name}, {scene.label} ...", file=sys.stderr, flush=True)
        picture = rgba_levels(ws.reference.raycast(loaded(name), step=STEP_VOXELS, **how))
        CACHE.mkdir(parents=True, exist_ok=True)
        np.save(path, picture)
    found: Array = np.load(path)
    return found


def distance(picture: Array, other: Array, *, only_covered: bool = False) -> float:
    """Mean absolute difference of the colours, in grey levels."""
    difference = np.abs(picture - other)[..., :3]
    if only_covered:
        difference = difference[(picture[..., 3] > 0) | (other[..., 3] > 0)]
    return float(difference.mean())


def picture_error(volume: ws.Volume, name: str, scene: Scene, size_px: int) -> float:
    """Distance of a volume's picture from the picture with no coefficient dropped, in grey levels."""
    picture = draw(volume, name, scene, size_px)
    return distance(picture, wanted(name, scene, size_px), only_covered=scene.only_covered)
