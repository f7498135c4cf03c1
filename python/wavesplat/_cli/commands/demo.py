"""`wavesplat demo`: pictures of the volumes that come with the package."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from wavesplat._cli.options.groups import Json, Quiet
from wavesplat._cli.printing import message, print_lines, print_result
from wavesplat.errors import FileError

SIZE = (512, 512)

#: Name of a picture, example, look, azimuth, elevation, and options of the camera and of `render`; a number as
#: `composite` is the value of an isosurface.
SCENES: tuple[tuple[str, str, str, float, float, dict[str, Any], dict[str, Any]], ...] = (
    ("ct_bone", "ct_pelvis", "ct-bone", 20, 10, {}, {"kernel": "bspline3"}),
    ("ct_soft_tissue", "ct_pelvis", "ct-soft-tissue", 20, 10, {}, {}),
    ("ct_perspective", "ct_pelvis", "ct-bone", -30, 35, {"view_angle": 60, "zoom": 1.4}, {"kernel": "bspline3"}),
    ("mri_head", "mri_head", "mr-head", 50, 15, {}, {}),
    ("mri_maximum", "mri_head", "auto", 90, 0, {}, {"composite": "maximum"}),
    ("ripples", "ripples", "auto", 30, 30, {}, {"kernel": "bspline3", "composite": 127.5}),
)


def demo(
    *,
    folder: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the pictures; made if missing.")
    ] = Path("out"),
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw the volumes that come with the package and print the pictures' paths."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot make the folder: {error.strerror}; choose another with -o: {folder}") from None
    paths = []
    for path in _draw(folder):
        paths.append(str(path))
        if not json:
            print_lines(path, written=path)
    if json:
        print_result({"pictures": paths}, "", as_json=True)
    elif not quiet:
        message(f"drew {len(paths)} pictures in {folder}")


def _draw(folder: Path) -> Iterator[Path]:
    """Draw each scene to a PNG file in the folder, which must exist, and yield its path."""
    from wavesplat import examples
    from wavesplat._model.arguments.operators import FirstHit
    from wavesplat._model.camera.camera import Camera
    from wavesplat._scene.drawing.rendering import render
    from wavesplat._storage.output import check_output

    for name, *_ in SCENES:
        check_output(folder / f"{name}.png", "pictures")
    for name, example, preset, azimuth, elevation, lens, options in SCENES:
        volume = getattr(examples, example)()
        camera = Camera.orbit(volume, azimuth, elevation, fit="view", **lens)
        value = options.get("composite")
        composite = FirstHit(value) if isinstance(value, float) else value
        how = {**options, "composite": composite, "size": SIZE, "background": "black"}
        picture = render(volume, preset, camera, **how)
        picture.save(folder / f"{name}.png")
        yield folder / f"{name}.png"
