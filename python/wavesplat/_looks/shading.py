"""Phong shading and lights, as VTK's volume mappers have them, but two-sided."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal

from wavesplat import _native
from wavesplat._model.argument_types import takes_its_types
from wavesplat._model.vectors import Vector, vector
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["Light", "Shading"]


@public
@dataclass(frozen=True, init=False)
class Light:
    """A directional light.

    Parameters
    ----------
    direction : three numbers
        Points from the volume towards the light. Any length but zero.
    color : three numbers, default white
        Red, green, blue, usually 0..1.
    frame : "camera" or "world", default "camera"
        In the camera frame x is right, y up and z towards the viewer, so (0, 0, 1) is a headlight.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Light((-1, 1, 2), color=(1, 0.95, 0.9)).frame
    'camera'
    """

    direction: Vector
    color: Vector
    frame: Literal["camera", "world"]

    @takes_its_types
    def __init__(
        self,
        direction: Iterable[float],
        color: Iterable[float] = (1.0, 1.0, 1.0),
        frame: Literal["camera", "world"] = "camera",
    ) -> None:
        object.__setattr__(self, "direction", vector(direction, "direction of a light"))
        object.__setattr__(self, "color", vector(color, "color of a light"))
        object.__setattr__(self, "frame", frame)


@public
@dataclass(frozen=True, init=False)
class Shading:
    """How surfaces answer to light: colour * (ambient + diffuse) + specular highlight.

    Parameters
    ----------
    ambient, diffuse, specular : float, 0 or more
        Weights of the Phong terms.
    specular_power : float, 1 to 1000
        Higher is a smaller, sharper highlight.
    gradient_offset : float, 0.01 to 4
        Half the width of the difference that estimates the gradient, in voxels.
    lights : sequence of `Light`
        Empty means one white headlight.
    ambient_occlusion : float, 0 to 1
        How much hollows darken: all light is multiplied by the share of directions that are open near by.
    occlusion_radius : float, optional
        From how far away the volume occludes, world units; None is a tenth of its longest side.
    shadow : float, 0 to 1
        How dark the shadow of the first light is. The shadow of a headlight lies behind what casts it.

    Raises
    ------
    ArgumentError
        If a number is out of its range, or a light has no direction.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Shading(specular=0).diffuse
    0.7
    >>> explaining = ws.Shading(ambient_occlusion=0.8, shadow=0.5, lights=[ws.Light((-1, 1, 1))])
    >>> picture = ws.render(ws.examples.ct_pelvis(), "ct-bone", shading=explaining, size=(32, 32))

    Notes
    -----
    Occlusion and shadow are worked out on a coarse copy of the volume, at most 96 cells along its longest side.
    """

    ambient: float
    diffuse: float
    specular: float
    specular_power: float
    gradient_offset: float
    lights: tuple[Light, ...]
    ambient_occlusion: float
    occlusion_radius: float | None
    shadow: float
    _core: _native.Shading = field(repr=False, compare=False)

    @takes_its_types
    def __init__(
        self,
        *,
        ambient: float = 0.1,
        diffuse: float = 0.7,
        specular: float = 0.2,
        specular_power: float = 10.0,
        gradient_offset: float = 1.0,
        lights: Iterable[Light] = (),
        ambient_occlusion: float = 0.0,
        occlusion_radius: float | None = None,
        shadow: float = 0.0,
    ) -> None:
        # Checked at once, so that an error points at the line that made it.
        lights = tuple(lights)
        for light in lights:
            if not isinstance(light, Light):
                raise ArgumentError(f"lights hold a {type(light).__name__}; give wavesplat.Light(direction) for each")
        native_lights = [(light.frame, light.direction, light.color) for light in lights]
        terms = (ambient, diffuse, specular, specular_power, gradient_offset)
        held_off = (ambient_occlusion, occlusion_radius, shadow)
        core = _native.Shading(*terms, native_lights, *held_off)
        for name, value in zip(self.__dataclass_fields__, (*terms, lights, *held_off, core), strict=True):
            object.__setattr__(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        settings = {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "_core"}
        return partial(type(self), **settings), ()
