"""Pictures that are composed of several: two eyes, and panoramas."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from wavesplat._looks.shading import FILL_LIGHT, KEY_LIGHT, Light, Shading
from wavesplat._model import camera_fit
from wavesplat._model.camera import Camera
from wavesplat._model.stereo import Eyes
from wavesplat._picture.picture import Picture
from wavesplat._render import off_axis, panorama
from wavesplat._render.off_axis import Draw


def n_pictures(eyes: Eyes) -> int:
    """Number of perspective pictures that make the one of these eyes."""
    sides = 1 if eyes.stereo is None else len(eyes.stereo.sides)
    return sides * (len(_faces(eyes)) if eyes.panorama else 1)


def put_together(eyes: Eyes, camera: Camera, size: tuple[int, int], draw: Draw) -> Picture:
    """The picture of the eyes, of those that `draw` makes from a camera in a size. `eyes` has its distances."""
    own = eyes.size_of(size)
    if eyes.stereo is None:
        return panorama.all_around(camera, own, _faces(eyes), draw) if eyes.panorama else draw(camera, own)
    stereo = eyes.stereo
    if eyes.panorama:
        around: Any = {"draw": draw, "eye_distance": stereo.eye_distance or 0.0}
        seen = [panorama.all_around(camera, own, _faces(eyes), side=side, **around) for side in stereo.sides]
    else:
        seen = [off_axis.seen_by(side, stereo, camera, own, draw) for side in stereo.sides]
    return off_axis.joined(stereo, seen)


def _faces(eyes: Eyes) -> list[panorama.Face]:
    return panorama.faces_of_cube() if eyes.stereo is None else panorama.faces_of_turns()


def facts_of_eyes(eyes: Eyes, camera: Camera, size: tuple[int, int]) -> dict[str, Any]:
    """The report's fields of the eyes, and those of a picture of one eye that differ."""
    facts: dict[str, Any] = {} if eyes.are_plain else {"size": list(size)}
    if eyes.panorama:
        # Pixels are angles there.
        facts |= {"panorama": True, "pixel": None}
    if eyes.stereo is not None and eyes.panorama:
        named = {"layout": eyes.stereo.layout, "eye_distance": eyes.stereo.eye_distance}
        facts["stereo"] = {**named, "convergence": None}
    elif eyes.stereo is not None:
        facts["stereo"] = off_axis.facts_of_pair(eyes.stereo, camera, eyes.size_of(size)[1])
    return facts


def notes_on_eyes(eyes: Eyes, size: tuple[int, int]) -> list[str]:
    """A note on panoramas that are not twice as wide as high."""
    width, height = eyes.size_of(size)
    if not eyes.panorama or width == 2 * height:
        return []
    return [f"the panorama of an eye has {width} x {height} pixels, which are not square; give twice as many in width"]


def in_world(shading: Shading | None, camera: Camera) -> Shading | None:
    """The light of a camera, where it stays in the world: the lights of pictures in other directions.

    Matter that the eye is within begins at the eye. As a cut it would be lit evenly for some slices, which lie in other
    directions in other pictures.
    """
    if shading is None:
        return None
    axes = camera_fit.axes_of(camera)
    lights = [
        light if light.frame == "world" else Light(tuple((light.direction @ axes).tolist()), light.color, "world")
        for light in shading.lights or (KEY_LIGHT, FILL_LIGHT)
    ]
    return replace(shading, lights=tuple(lights), even_cuts=0.0)
