"""Time of pictures of several volumes over that of pictures of one; `make bench-layers` runs this.

Frames of one layer and of n are drawn in turn, so that a slow moment of the machine meets both; printed is the median
of the ratios. The layers are the bundled CT several times, and the same with a coarser grid over it, as of PET.
"""

from __future__ import annotations

import statistics
import time

import numpy as np

import wavesplat as ws

SIZE = (512, 512)
N_PAIRS = 9


def uptake(scan: ws.Volume) -> ws.Volume:
    """Values on a grid of 6 mm in the place of a scan."""
    lower, upper = scan.bounds
    n = ((upper - lower) // 6).astype(int)
    affine = np.diag([6.0, 6.0, 6.0, 1.0])
    affine[:3, 3] = lower
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, count) for count in n[::-1]), indexing="ij")
    values = 9 * np.exp(-20 * ((x - 0.2) ** 2 + y**2 + z**2)) + 6 * np.exp(
        -40 * ((x + 0.4) ** 2 + y**2 + (z - 0.3) ** 2)
    )
    return ws.Volume(values.astype(np.float32), world_from_index=affine, unit="mm", anatomical=True)


def seconds(scene: ws.Scene, camera: ws.Camera) -> float:
    """Wall time of a frame."""
    start = time.perf_counter()
    scene.render(camera, size=SIZE)
    return time.perf_counter() - start


def ratio(scene: ws.Scene, other: ws.Scene, camera: ws.Camera) -> float:
    """Median, over pairs of frames, of the first scene's time divided by the second's."""
    seconds(scene, camera), seconds(other, camera)  # prepares what both scenes keep
    return statistics.median(seconds(scene, camera) / seconds(other, camera) for _ in range(N_PAIRS))


def main() -> None:
    """Print the ratios."""
    pelvis = ws.examples.ct_pelvis()
    camera = ws.Camera.view(pelvis, "front")
    for look in ("ct-bone", "ct-muscle", "ct-skin"):
        one = ws.Scene(pelvis, look)
        ratios = [ratio(ws.Scene([ws.Layer(pelvis, look, opacity=0.9)] * n), one, camera) for n in (2, 4, 8)]
        print(f"{look}: 2, 4, 8 layers take {', '.join(f'{value:.2f}' for value in ratios)} times one")
    hot = ws.TransferFunction.from_colormap("hot", clim=(2, 8), opacity="linear")
    pet = ws.Layer(uptake(pelvis), ws.Look(transfer_function=hot, shading=None))
    both = ws.Scene([ws.Layer(pelvis, "ct-bone"), pet])
    print(f"PET over CT: {ratio(both, ws.Scene(pelvis, 'ct-bone'), camera):.2f} times the CT")


if __name__ == "__main__":
    main()
