"""How well a cut face shows the tissue: `make study-cuts`.

A scan is cut by a plane through its middle and seen at right angles, by its automatic look. Told is the rank
correlation (Spearman) of the picture's luminance with the samples on the cut, over the pixels of tissue: with cut faces
lit by their gradients (`even_cuts` 0), evenly (1, the default), and without light, which is the most that a look gives;
and with slices on the cuts (`SlicePlane(plane="cuts")`), which show the samples themselves.
docs/design/021-cut-faces.md has the results; other depths of even light are tried by its constants in
`crates/splat/src/ray/cut_faces.rs`.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

#: Pixels of a picture along each side.
N = 300
#: Files of BENCH_DATA, and the least sample that counts as tissue; None: see `tissue_of`.
FILES: dict[str, float | None] = {
    "mri_head_t1.nii.gz": None,
    "nrrd_rotated_gzip_flair.nrrd": None,
    "ct_abdomen_pelvis_3mm.nii.gz": 150.0,
}

Clip = ws.ClipPlane | ws.Crop | ws.CutOut


def rank_correlation(a: NDArray[Any], b: NDArray[Any]) -> float:
    """Correlation of the ranks of two arrays of numbers."""
    first, second = (np.argsort(np.argsort(each)).astype(float) for each in (a, b))
    return float(np.corrcoef(first, second)[0, 1])


def middle_of(scan: ws.Volume) -> float:
    """World y of the cut: the middle of the box."""
    return float(scan.bounds.mean(axis=0)[1])


def luminance(
    scan: ws.Volume, shading: ws.Shading | None, clip: Clip, n: int = N, geometry: ws.SlicePlane | None = None
) -> NDArray[Any]:
    """Luminance of the automatic look in a light, seen along -y, with the middle of the box in focus."""
    low, high = (np.array(end) for end in scan.bounds)
    middle, half = (low + high) / 2, max(high - low) / 2
    eye = middle + np.array([0, 4 * half, 0])
    camera = ws.Camera(position=eye, focal_point=middle, view_up=(0, 0, 1), parallel_scale=half)
    scene = ws.Scene(scan, geometry=geometry or []).with_(shading=shading, clip=clip, background="black")
    pixels = np.asarray(scene.render(camera, size=(n, n)))[..., :3].astype(float)
    luminance: NDArray[Any] = pixels @ np.array([0.2126, 0.7152, 0.0722])
    return luminance


def samples_on_cut(scan: ws.Volume, n: int = N) -> NDArray[Any]:
    """Trilinear samples on the cut, by pixel; NaN outside of the box."""
    low, high = (np.array(end) for end in scan.bounds)
    middle, half = (low + high) / 2, max(high - low) / 2
    steps = half * (1 - 2 * (np.arange(n) + 0.5) / n)
    x, z = np.broadcast_arrays(middle[0] + steps[None, :], middle[2] + steps[:, None])
    world = np.stack([x, np.full(x.shape, middle[1]), z, np.ones(x.shape)], axis=-1)
    index = (world @ np.linalg.inv(scan.world_from_index).T)[..., 2::-1]
    samples, last = np.asarray(scan.samples, float), np.array(scan.shape) - 1
    first = np.clip(np.floor(index), 0, last - 1).astype(int)
    share = index - first
    values = np.zeros(index.shape[:-1])
    for corner in np.ndindex(2, 2, 2):
        weights = np.where(corner, share, 1 - share).prod(axis=-1)
        values += weights * samples[tuple(np.moveaxis(first + corner, -1, 0))]
    values[((index < 0) | (index > last)).any(axis=-1)] = np.nan
    return values


def tissue_of(values: NDArray[Any], least: float | None = None) -> NDArray[np.bool_]:
    """Pixels of tissue: samples above `least`, or 15 % of those that only 0.5 % exceed."""
    tissue: NDArray[np.bool_] = values > (0.15 * np.nanpercentile(values, 99.5) if least is None else least)
    return tissue


def main() -> None:
    """Print the table."""
    data = Path(os.environ.get("BENCH_DATA", ""))
    scans: list[tuple[ws.Volume, float | None]] = [(ws.examples.mri_head(), None)]
    scans += [(ws.open(data / name), least) for name, least in FILES.items() if (data / name).exists()]
    print("| volume | by gradients | evenly | without light | as a slice |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for scan, least in scans:
        light = ws.Look.auto(scan).shading
        assert light is not None
        values = samples_on_cut(scan)
        tissue = tissue_of(values, least)
        plane = ws.ClipPlane((0, middle_of(scan), 0), (0, -1, 0))
        lights = (light.changed(even_cuts=0), light, None)
        seen = [luminance(scan, one, plane) for one in lights]
        seen.append(luminance(scan, light, plane, geometry=ws.SlicePlane(plane="cuts")))
        found = [rank_correlation(one[tissue], values[tissue]) for one in seen]
        print(f"| `{scan.name}` | " + " | ".join(f"{one:.2f}" for one in found) + " |", flush=True)


if __name__ == "__main__":
    main()
