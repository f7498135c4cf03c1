"""The table of pictures that `wavesplat demo` draws of the volumes that come with the package."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wavesplat import examples
from wavesplat._files.output import check_output
from wavesplat._model.camera import Camera
from wavesplat._model.composites import FirstHit
from wavesplat._model.volume import Volume
from wavesplat._scene.rendering import render

__all__ = ["draw"]

SIZE_PX = (512, 512)


@dataclass(frozen=True)
class Scene:
    """A picture to draw: volume, transfer function, view, and options of `render`."""

    name: str
    volume: Callable[[], Volume]
    preset: str
    azimuth: float = 0.0
    elevation: float = 0.0
    view_angle: float | None = None
    zoom: float = 1.0
    options: dict[str, Any] = field(default_factory=dict)


SCENES = (
    Scene("ct_bone", examples.ct_pelvis, "ct-bone", 20, 10, options={"kernel": "bspline3"}),
    Scene("ct_soft_tissue", examples.ct_pelvis, "ct-soft-tissue", 20, 10),
    Scene(
        "ct_perspective",
        examples.ct_pelvis,
        "ct-bone",
        -30,
        35,
        view_angle=60,
        zoom=1.4,
        options={"kernel": "bspline3"},
    ),
    Scene("mri_head", examples.mri_head, "mr-head", 50, 15),
    Scene("mri_maximum", examples.mri_head, "auto", 90, 0, options={"composite": "maximum"}),
    Scene(
        "ripples",
        examples.ripples,
        "auto",
        30,
        30,
        options={"composite": FirstHit(127.5), "kernel": "bspline3"},
    ),
)


def draw(folder: Path) -> Iterator[Path]:
    """Draw each scene to a PNG file in the folder, which must exist, and yield its path."""
    paths = [folder / f"{scene.name}.png" for scene in SCENES]
    for path in paths:
        check_output(path, "pictures")
    for scene, path in zip(SCENES, paths, strict=True):
        volume = scene.volume()
        camera = Camera.orbit(
            volume, scene.azimuth, scene.elevation, view_angle=scene.view_angle, zoom=scene.zoom, fit="view"
        )
        picture = render(
            volume,
            scene.preset,
            camera,
            size=SIZE_PX,
            background="black",
            **scene.options,
        )
        picture.save(path)
        yield path
