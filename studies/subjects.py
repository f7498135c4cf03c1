"""The volumes of the studies, and how each is drawn: ripples, half a pelvis, a head.

They come from the folder BENCH_DATA or, where that lacks them, are bundled with the package.
"""

# ruff: noqa: INP001 - scripts, not a package
from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import wavesplat as ws

ROOT = Path(__file__).resolve().parents[1]
DATA = Path(os.environ.get("BENCH_DATA", ROOT / "bench-data"))

CT_FILE = "ct_pelvis_right.nii.gz"
#: Crop box without the table under the patient, whose thin shell is near the step and makes half of the error.
CT_CROP = ws.Crop((12, 0, 0), (248, 143, 69), space="index") if (DATA / CT_FILE).exists() else None


def scan(file: str, bundled: Callable[[], ws.Volume]) -> ws.Volume:
    """A scan from the data folder, or the bundled one."""
    path = DATA / file
    return ws.open(path) if path.exists() else bundled()


def ct() -> ws.Volume:
    """Half a pelvis."""
    return scan(CT_FILE, ws.examples.ct_pelvis)


def mri() -> ws.Volume:
    """A head."""
    return scan("mri_head_t1.nii.gz", ws.examples.mri_head)


@dataclass(frozen=True)
class Drawn:
    """A volume and the settings with which it is drawn, in the units of its samples."""

    source: Callable[[], ws.Volume]
    #: Values at which the opacity is 0, 0.05 and 0.2.
    soft: tuple[float, float, float]
    #: Value at which the opacity steps from 0 to 1.
    hard: float
    #: Azimuth and elevation, degrees.
    view: tuple[float, float]
    crop: ws.Crop | None = None


RIPPLES = Drawn(ws.examples.ripples, (60, 128, 255), 128, (35, 60))
CT = Drawn(ct, (-75, 255, 1000), 200, (20, 15), CT_CROP)
MRI = Drawn(mri, (24, 60, 95), 25, (20, 15))


def soft_function(lo: float, middle: float, hi: float) -> ws.TransferFunction:
    """Opacity 0, 0.05 and 0.2 at three values, warm colours."""
    return ws.TransferFunction(
        [(lo, 0), (middle, 0.05), (hi, 0.2)], [(lo, 0.8, 0.4, 0.25), (middle, 1, 0.8, 0.6), (hi, 1, 1, 0.95)]
    )


def hard_function(edge: float) -> ws.TransferFunction:
    """Opacity 0 up to one unit below the edge, 1 from there."""
    return ws.TransferFunction([(edge - 1, 0), (edge, 1)], [(edge, 1, 0.9, 0.75)])
