"""First pictures of twelve fields by PyVista's defaults, by yt's, and by ourselves, side by side.

    make looks-beside-pyvista           downloads PyVista and yt (400 MB) into .cache; needs BENCH_DATA

PyVista draws `Plotter.add_volume(grid)`, yt `create_scene(data, field)`; both get the array and its distances, and
nothing else. Ours is `render(volume)` with the view that it chooses. The page tells the share of the pixels that are
not the background, and the mean luminance of these (Rec. 709 weights on encoded values).
"""

from __future__ import annotations

import argparse
import os
import tempfile
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyvista
import yt
from numpy.typing import NDArray
from PIL import Image
from sheets import Sheet, mean_luminance

import wavesplat as ws

DATA = Path(os.environ.get("BENCH_DATA", "../shared/data"))
NYX = "sim_cosmology_nyx_f32.h5"
#: File, and options of opening it.
FILES: list[tuple[str, dict[str, Any]]] = [
    ("sim_turbulence_f32.nhdr", {}),
    *((NYX, {"dataset": f"native_fields/{name}"}) for name in ("baryon_density", "temperature", "velocity_y")),
    ("sim_fuel_u8.nii.gz", {}),
    ("sim_heptane_jet_u8.nii.gz", {}),
    ("neghip.nrrd", {}),
    ("carotid_pcmra.vtk", {}),
]
SIDE, N_MADE = 300, 64
#: Largest difference of a channel from the background's that is not seen.
NOTHING = 6


def main() -> None:
    """Draw, measure, write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("out/looks"))
    arguments = parser.parse_args()
    yt.set_log_level(50)
    fields = list(_fields())
    drawn_by: dict[str, Callable[[ws.Volume], NDArray[np.uint8]]] = {
        "PyVista": _by_pyvista,
        "yt": _by_yt,
        "ours": _ours,
    }
    sheet = Sheet(len(drawn_by), len(fields), SIDE)
    print(f"{'':22s}" + "".join(f"{by:>22s}" for by in drawn_by) + "   share of the pixels, mean luminance")
    for row, (name, volume) in enumerate(fields):
        line = f"{name:22s}"
        for column, (by, draw) in enumerate(drawn_by.items()):
            picture = draw(volume)
            share, mean = _seen(picture)
            line += f"{share:16.0f} %{mean:5.0f}"
            sheet.put(column, row, picture, f"{by}: {name}, {share:.0f} % seen")
        print(line, flush=True)
    sheet.save(arguments.out / "beside_pyvista.png")


def _fields() -> Iterator[tuple[str, ws.Volume]]:
    for file, options in FILES:
        name = options.get("dataset", file.partition(".")[0]).rpartition("/")[2]
        yield name, ws.open(DATA / file, **options)
    z, y, x = np.meshgrid(*[np.linspace(-1, 1, N_MADE)] * 3, indexing="ij")
    distance = np.sqrt(x * x + y * y + z * z)
    waves = sum(np.sin(3 * k * x + k) * np.cos(2.5 * k * y - k) * np.sin(2 * k * z + 0.3 * k) for k in (1, 2, 3))
    made = {
        "orbital": x * y * np.exp(-7 * distance),
        "heavy tails": np.sinh(4 * waves),
        "pressure": 101_325 + 300 * np.exp(-6 * distance**2) * np.tanh(9 * x),
        "vortex": 1000 - 40 * np.exp(-((x - 0.2 * np.sin(4 * z)) ** 2 + y * y) / 0.02),
    }
    for name, samples in made.items():
        yield name, ws.Volume(samples.astype(np.float32))


def _ours(volume: ws.Volume) -> NDArray[np.uint8]:
    rgb = ws.render(volume, size=(SIDE, SIDE), background="black").rgba[..., :3]
    return np.asarray(np.round(255 * np.clip(rgb, 0, 1)), dtype=np.uint8)


def _by_pyvista(volume: ws.Volume) -> NDArray[np.uint8]:
    grid = pyvista.ImageData(dimensions=volume.shape[::-1], spacing=volume.spacing)
    grid.point_data["values"] = np.asarray(volume.samples).ravel()
    plotter = pyvista.Plotter(off_screen=True, window_size=(SIDE, SIDE))
    plotter.add_volume(grid)
    picture = plotter.screenshot(return_img=True)
    plotter.close()
    return np.asarray(picture)[..., :3]


def _by_yt(volume: ws.Volume) -> NDArray[np.uint8]:
    samples = np.asarray(volume.samples, np.float64).transpose()  # yt's axes are x, y, z
    ends = np.array([[0.0, n * step] for n, step in zip(samples.shape, volume.spacing, strict=True)])
    with warnings.catch_warnings(), tempfile.TemporaryDirectory() as folder:
        warnings.simplefilter("ignore")
        data = yt.load_uniform_grid({"values": samples}, samples.shape, bbox=ends)
        scene = yt.create_scene(data, ("stream", "values"))
        scene.camera.resolution = (SIDE, SIDE)
        scene.save(f"{folder}/yt.png")
        with Image.open(f"{folder}/yt.png") as picture:
            return np.asarray(picture.convert("RGB"))


def _seen(picture: NDArray[np.uint8]) -> tuple[float, float]:
    """Share of the pixels that differ from the corner, per cent, and their mean luminance."""
    is_seen = (np.abs(picture.astype(int) - picture[0, 0]) > NOTHING).any(axis=2)
    return 100 * float(is_seen.mean()), mean_luminance(np.where(is_seen[..., None], picture, 0))


if __name__ == "__main__":
    main()
