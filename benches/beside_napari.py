"""napari's first picture, napari with limits at 1 and 99.8 %, and ours by itself, of six stacks, side by side.

    make looks-beside-napari            downloads napari (400 MB); needs Xvfb, an OpenGL such as Mesa's, and BENCH_DATA

Each stack is opened by us and handed to napari as an array with its distances, a layer per channel; napari shows it in
three dimensions after `reset_view`, in a window of the same size. The page tells the mean luminance (Rec. 709 weights
on encoded values) of the pixels that are not black.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any

import napari
import numpy as np
from numpy.typing import NDArray
from PIL import Image
from sheets import Sheet, mean_luminance

import wavesplat as ws

DATA = Path(os.environ.get("BENCH_DATA", "../shared/data"))
#: File, and options of opening it.
CASES: list[tuple[str, dict[str, Any]]] = [
    ("micro_chromosomes_zstack.tif", {}),
    ("micro_nuclei_noisy.h5", {"dataset": "raw"}),
    ("micro_mouse_brain_u16.nrrd", {}),
    ("omezarr_v2_mouse_brain.ome.zarr", {}),
    ("omezarr_v2_spim_czyx.ome.zarr", {}),
    ("tiff_stack_em", {"unit": "nm", "spacing": (5, 5, 50)}),
]
SIDE = 400
#: Percentiles of the limits that somebody sets by hand.
LIMITS = (1.0, 99.8)


def main() -> None:
    """Draw, measure, write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("out/looks"))
    arguments = parser.parse_args()
    sheet = Sheet(3, len(CASES), SIDE)
    print(f"{'':34s} {'napari':>8s} {'1..99.8 %':>10s} {'ours':>6s}   mean luminance")
    for row, (name, options) in enumerate(CASES):
        scene = ws.open_scene(DATA / name, **options)
        pictures = [_by_napari(scene, by_hand=False), _by_napari(scene, by_hand=True), _ours(scene)]
        means = [mean_luminance(picture) for picture in pictures]
        print(f"{name:34s} {means[0]:8.0f} {means[1]:10.0f} {means[2]:6.0f}", flush=True)
        for column, (by, picture, mean) in enumerate(
            zip(("napari", "napari, limits set", "ours"), pictures, means, strict=True)
        ):
            sheet.put(column, row, picture, f"{by}: mean {mean:.0f}")
    sheet.save(arguments.out / "beside_napari.png")


def _ours(scene: ws.Scene) -> NDArray[np.uint8]:
    rgb = scene.with_(background="black").render(size=(SIDE, SIDE)).rgba[..., :3]
    return np.round(255 * np.clip(rgb, 0, 1)).astype(np.uint8)


def _by_napari(scene: ws.Scene, *, by_hand: bool) -> NDArray[np.uint8]:
    viewer = napari.Viewer(show=True, ndisplay=3)
    maps = ("gray",) if len(scene.layers) == 1 else ("green", "magenta", "cyan", "yellow")
    for number, layer in enumerate(scene.layers):
        volume: Any = layer.drawn
        how: dict[str, Any] = {"scale": volume.spacing[::-1], "colormap": maps[number % len(maps)]}
        if len(scene.layers) > 1:
            how["blending"] = "additive"
        if by_hand:
            how["contrast_limits"] = tuple(np.percentile(volume.samples, LIMITS))
        viewer.add_image(np.asarray(volume.samples), **how)
    viewer.window.resize(2 * SIDE, 2 * SIDE)
    for _ in range(5):  # windows get their sizes between events
        napari.qt.get_qapp().processEvents()
    viewer.reset_view()
    picture = Image.fromarray(viewer.screenshot(canvas_only=True, flash=False)[..., :3])
    viewer.close()
    picture.thumbnail((SIDE, SIDE))
    square = Image.new("RGB", (SIDE, SIDE))
    square.paste(picture, ((SIDE - picture.width) // 2, (SIDE - picture.height) // 2))
    return np.asarray(square)


if __name__ == "__main__":
    main()
