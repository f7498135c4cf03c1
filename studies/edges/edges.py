"""How well the outermost rows and columns of a volume are drawn, beside the rest of it; `make edges` runs this.

Views along the axes of scans and made volumes, with a soft function over their range, so that there is matter at the
walls. The converged picture is `wavesplat.reference.raycast` with 16 rays a pixel. Outermost are the pixels of the
volume's silhouette, and of the picture, that are not covered as a whole or have such a neighbour. The error is the root
of the mean square difference of colour and opacity. Exit code 1 if the outermost pixels of a view are further off than
the rest by more than a factor of 2.

Volumes that BENCH_DATA lacks are left out; the bundled ones are always there.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

sys.path.append(str(Path(__file__).resolve().parents[1]))
from subjects import DATA
from tables import as_text

#: Files of different kinds: CT, MR, PET, ultrasound, angiography, microscopy, simulations.
FILES = (
    "aneurism.vti",
    "carotid_pcmra.vtk",
    "ct_abdomen_pelvis_3mm.nii.gz",
    "ct_torso_u8.mha",
    "embryo.nrrd",
    "engine.nrrd",
    "micro_mouse_brain_u16.nrrd",
    "neghip.nrrd",
    "pet_body_f32.nii.gz",
    "sim_fuel_u8.nii.gz",
    "us_spine_phantom.mha",
)
BUNDLED: dict[str, Callable[[], ws.Volume]] = {
    "ct": ws.examples.ct_pelvis,
    "mri": ws.examples.mri_head,
    "ripples": partial(ws.examples.ripples, 32),
}
#: Azimuth and elevation, degrees.
VIEWS = {"front": (0.0, 0.0), "side": (90.0, 0.0), "top": (0.0, 90.0)}
FACTOR = 2.0

#: Errors below a sixteenth of a grey level are as good as none.
MIN_ERROR = 1 / 255 / 16


def volumes(wanted: list[str]) -> Iterator[tuple[str, ws.Volume]]:
    """Volumes that are available, with their names; `wanted` selects some, an empty list all."""
    for name, make in BUNDLED.items():
        if not wanted or name in wanted:
            yield name, make()
    for file in FILES:
        if (DATA / file).exists() and (not wanted or file in wanted):
            yield file, ws.open(DATA / file)


def soft_function(volume: ws.Volume) -> ws.TransferFunction:
    """A transfer function that is faint but visible nearly everywhere, and lets one see into the volume."""
    lo, middle, hi = np.percentile(np.asarray(volume.samples, dtype=np.float64), (1, 60, 99.8))
    hi = max(hi, lo + 1e-6 * abs(lo) + 1e-12)
    middle = min(max(middle, lo + 0.2 * (hi - lo)), lo + 0.8 * (hi - lo))
    return ws.TransferFunction(
        [(lo, 0.002), (middle, 0.02), (hi, 0.15)], [(lo, 0.2, 0.3, 0.8), (middle, 0.9, 0.6, 0.4), (hi, 1, 1, 1)]
    )


def outermost(share: NDArray[Any]) -> NDArray[np.bool_]:
    """Mask of pixels that show something, where they or a neighbour are not wholly covered."""
    whole = np.pad(share >= 1.0, 1)
    around = whole[1:-1, :-2] & whole[1:-1, 2:] & whole[:-2, 1:-1] & whole[2:, 1:-1]
    result: NDArray[np.bool_] = (share > 0) & ~(whole[1:-1, 1:-1] & around)
    return result


def errors(volume: ws.Volume, camera: ws.Camera, size_px: int, quality: Any) -> tuple[float, float]:
    """Root mean square errors of the outermost pixels, and of the rest."""
    function = soft_function(volume)
    size = (size_px, size_px)
    cast = partial(ws.reference.raycast, camera=camera, size=size, rays_per_pixel=16, kernel="linear", shading=None)
    wanted = cast(volume, function, step=0.1).rgba.astype(np.float64)
    opaque = ws.TransferFunction([(0.0, 1.0)], [(0.0, 1, 1, 1)])
    share = cast(volume, opaque, step=1.0).rgba[..., 3]
    got = ws.render(volume, function, camera, size=size, shading=None, quality=quality).rgba.astype(np.float64)
    outer = outermost(share)
    square = ((got - wanted) ** 2).mean(axis=-1)
    rest = (share > 0) & ~outer
    if not (outer.any() and rest.any()):
        raise SystemExit(
            f"{volume.name}: {outer.sum()} pixels are outermost and {rest.sum()} are not; draw larger ones"
        )
    return float(np.sqrt(square[outer].mean())), float(np.sqrt(square[rest].mean()))


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--size", type=int, default=128, help="pixels per side")
    parser.add_argument("--quality", default="high")
    parser.add_argument("--only", nargs="*", default=[], help="names of volumes")
    parser.add_argument("--view", choices=VIEWS, nargs="*", default=list(VIEWS))
    parser.add_argument("--projection", choices=("orthographic", "perspective"), nargs="*")
    arguments = parser.parse_args()
    lines = [["volume", "view", "projection", "outermost", "rest", "factor"]]
    n_missed = 0
    for name, volume in volumes(arguments.only):
        for view in arguments.view:
            for projection in arguments.projection or ("orthographic", "perspective"):
                azimuth, elevation = VIEWS[view]
                angle = 30.0 if projection == "perspective" else None
                camera = ws.Camera.orbit(volume, azimuth, elevation, view_angle=angle)
                outer, rest = errors(volume, camera, arguments.size, arguments.quality)
                is_missed = not outer <= FACTOR * max(rest, MIN_ERROR)
                n_missed += is_missed
                factor = f"{outer / max(rest, MIN_ERROR):.2f}" + (" MISSED" if is_missed else "")
                lines.append([name, view, projection, f"{255 * outer:.3f}", f"{255 * rest:.3f}", factor])
                print("  ".join(lines[-1]), file=sys.stderr, flush=True)
    print("Root of the mean square error, in grey levels of 255.")
    print(as_text(lines))
    return int(n_missed > 0)


if __name__ == "__main__":
    sys.exit(main())
