"""Documents of scenes with the pictures that Python draws of them, which the crate `wavesplat` draws too.

python python/tests/shared/rust_scenes.py       write the kept lines anew
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import wavesplat as ws
from wavesplat._scene.documents import scene_json

KEPT = Path(__file__).parents[3] / "crates/wavesplat/tests/scenes.jsonl"
SIZE = (24, 20)
CAMERA = ws.Camera((30, 70, 20), (5.5, 4.5, 3.5), (0, 0, 1), parallel_scale=9)
NEAR = ws.Camera((20, 25, 9), (5.5, 4.5, 3.5), (0, 0, 1), view_angle=35)
CURVES = ws.TransferFunction([(40, 0), (120, 0.3), (255, 0.9)], [(40, 0.9, 0.2, 0.1), (255, 1, 0.9, 0.4)])


def volumes(folder: Path) -> tuple[ws.Volume, ws.Volume]:
    """Bytes, and whole numbers of 16 bits, by the formulas of `crates/wavesplat/tests/scene_documents.rs`."""
    z, y, x = np.indices((8, 10, 12))
    np.save(folder / "a.npy", ((7 * x * x + 5 * y * y + 3 * z * z + x * y * z) % 256).astype(np.uint8))
    np.save(folder / "c.npy", ((x > 3) & (y > 2)).astype(np.uint8) + ((x > 6) & (y > 5) & (z > 2)))
    np.save(folder / "b.npy", (40 * x + 30 * y * z - 600).astype(np.int16))
    return ws.open(folder / "a.npy"), ws.open(folder / "b.npy", spacing=(1, 1, 1))


def scenes(folder: Path) -> Iterator[tuple[str, ws.Scene, ws.Camera, dict[str, Any]]]:
    """Scenes with camera and options."""
    a, b = volumes(folder)
    light = ws.Shading(
        ambient=0.3, exposure=1.3, lights=[ws.Light((1, 0.5, 2)), ws.Light((0, 0, 1), (0.4, 0.5, 0.6), "world")]
    )
    steep = ws.TransferFunction(CURVES.opacity, CURVES.color, 0.7, [(0, 0.2), (30, 1)])
    table = ws.TransferFunction2D([0, 255], [0, 40], np.linspace(0, 1, 16).reshape(2, 2, 4))
    plane = ws.ClipPlane((5, 4, 3), (1, 0.2, 0))
    keep = ws.Crop((1, 1, 1), (9, 8.5, 6), space="index")
    grey = ws.Look(transfer_function=CURVES, shading=None, composite="maximum", background="white")
    yield "light, a plane", ws.Scene(a, CURVES, clip=plane, background="black", keep_table=True), CAMERA, {}
    options = {"kernel": "bspline3", "quality": "fine"}
    yield "no light, a box", ws.Scene(a, steep, shading=None, clip=keep, background=(0.1, 0.2, 0.3, 0.5)), NEAR, options
    yield "a projection", ws.Scene(a, grey), NEAR, {"quality": "draft"}
    yield "a mean", ws.Scene(b, ws.Look(transfer_function=CURVES)), CAMERA, {"composite": "mean", "depth": False}
    yield "a surface", ws.Scene(a, CURVES, shading=light), CAMERA, {"composite": ws.FirstHit(150), "depth": True}
    hidden = ws.Layer(a, CURVES, visible=False)
    layers = [ws.Layer(a, CURVES, opacity=0.5), hidden, ws.Layer(b, steep, name="second")]
    yield "layers", ws.Scene(layers, background="#204060"), NEAR, {}
    yield "a table", ws.Scene(a, table), CAMERA, {"quality": ws.Sampling(2.5, 1.25)}
    segmentation = ws.open(folder / "c.npy")
    organs = {1: ws.Label("#40a0e0", 0, name="tinted", tint=0.7), 2: ws.Label((0.9, 0.5, 0.2))}
    yield "labels", ws.Scene(a, CURVES, labels=ws.Labels(segmentation, organs)), NEAR, {}
    yield "plain labels", ws.Scene([a, b], [CURVES, CURVES], labels=ws.Labels(segmentation, smooth=False)), CAMERA, {}
    yield "labels, an automatic look", ws.Scene(a, labels=ws.Labels(segmentation, organs)), NEAR, {}
    yield "a preset", ws.Scene(b, "ct-bone", keep_table=True), NEAR, {}
    yield "an automatic look", ws.Scene(a), CAMERA, {}
    yield "an automatic look of numbers", ws.Scene(b, background="white"), NEAR, {}


def lines() -> Iterator[dict[str, Any]]:
    """Each document, as its picture's report has it and as it was given, with a sum of the picture's bytes."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for name, scene, camera, options in scenes(folder):
            picture = scene.render(camera, size=SIZE, **options)
            settled = picture.report["scene"]
            given = scene_json.document_of(scene)
            given |= {"camera": settled["camera"], "render": settled["render"]}
            for kind, document in (("settled", settled), ("given", given)):
                text = json.dumps(document).replace(json.dumps(str(folder))[1:-1] + "/", "")
                read = scene_json.parse(text, folder)
                again = read.scene.render(read.camera, **read.options)
                yield {"name": f"{name}, {kind}", "document": json.loads(text), "sum": sum_of(again.rgba)}


def sum_of(rgba: Any) -> str:
    """FNV-1a of the float32s of a picture, 64 bits."""
    total = 0xCBF29CE484222325
    for byte in np.ascontiguousarray(rgba, "<f4").tobytes():
        total = (total ^ byte) * 0x100000001B3 % 2**64
    return f"{total:016x}"


if __name__ == "__main__":
    KEPT.write_text("".join(json.dumps(line) + "\n" for line in lines()), encoding="utf-8")
