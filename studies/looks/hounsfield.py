"""Numbers by which values are taken for Hounsfield units, of scans and of made noise.

    python studies/looks/hounsfield.py CT.nii.gz ...

For each file, and for noise of several deviations: the share of samples below -1100 that are no padding, samples above
900 by those below -900, the density of soft tissue (-150 to 150) by that of bone (200 to 500), and the answer for the
bare array.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws
from wavesplat._looks.kinds.histogram import finite_samples
from wavesplat._looks.kinds.hounsfield import looks_like_hounsfield

#: As in `crates/look/src/hounsfield.rs`.
AIR, FAR, SOFT_TISSUE, BONE = -1100.0, 900.0, (-150.0, 150.0), (200.0, 500.0)


def main(paths: list[str]) -> None:
    """Print a line for each file and each noise."""
    print("below -1100 | above 900 : below -900 | soft tissue : bone | Hounsfield units of a bare array")
    for path in paths:
        told(path.rpartition("/")[2], finite_samples(ws.open(path)))
    for deviation in (200, 400, 700, 1500):
        noise = np.random.default_rng(0).normal(0, deviation, 1_000_000)
        told(f"noise of deviation {deviation}", np.round(noise))


def told(name: str, values: NDArray[Any]) -> None:
    """Print the numbers of some values."""
    below = values[values < AIR]
    commonest = np.unique(below, return_counts=True)[1].max(initial=0)
    n_below = 0 if 2 * commonest > below.size else below.size
    soft, bone = (np.mean((values >= low) & (values < high)) for low, high in (SOFT_TISSUE, BONE))
    cube = values[: round(values.size ** (1 / 3) - 0.5) ** 3]
    side = round(cube.size ** (1 / 3))
    is_hounsfield = looks_like_hounsfield(values, ws.Volume(cube.reshape(side, side, side).astype(np.float32)))
    n_above, n_far_below = int(np.sum(values > FAR)), int(np.sum(values < -FAR))
    widths = (BONE[1] - BONE[0]) / (SOFT_TISSUE[1] - SOFT_TISSUE[0])
    print(
        f"{n_below / values.size:11.2%} | {n_above / max(n_far_below, 1):22.3f} | "
        f"{widths * float(soft) / max(float(bone), 1e-9):18.1f} | "
        f"{'yes' if is_hounsfield else 'no':3} | {name}"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
