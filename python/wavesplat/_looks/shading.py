"""Phong shading and lights, two-sided: a key light and a fill light, or the headlight of other renderers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal

from wavesplat import _native
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.camera.views import Vector, vector
from wavesplat._model.volume.facts import short_repr
from wavesplat._public import public
from wavesplat.errors import ArgumentError


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


#: The lights that a picture has where none are given: the same as `Light::KEY` and `Light::FILL` of the engine.
KEY_LIGHT = Light((-0.55, 0.65, 1.0))
FILL_LIGHT = Light((0.0, 0.0, 1.0), color=(0.3, 0.3, 0.3))


@public
@dataclass(frozen=True, init=False)
class Shading:
    """How surfaces answer to light: colour * (ambient + diffuse) + specular highlight.

    The default is made for looking at pictures: a key light from the upper left of the camera, a weaker fill light at
    the camera, smoothed gradients, highlights that do not clip. `Shading.headlight` is what VTK and 3D Slicer have, for
    comparisons.

    Parameters
    ----------
    ambient, diffuse, specular : float, 0 or more
        Weights of the Phong terms.
    specular_power : float, 1 to 1000
        Higher is a smaller, sharper highlight.
    gradient_smoothing : float, 0 or 0.5 to 1.25
        Standard deviation, in voxels, of the cubic B-spline that smooths the samples before normals are taken along
        their gradient: surfaces do not show the steps of voxels as rings. Edges and opacities are not smoothed. 0 takes
        differences of what is drawn.
    gradient_offset : float, 0.01 to 4
        Without smoothing: half the width of these differences, in voxels.
    unoriented : float, 0 to 1
        Diffuse light where there is no gradient, as on cut faces of even matter, as a share of the diffuse light of a
        face that is turned to the light: 0.5 is the mean over all normals.
    even_cuts : float, 0 to 1
        How evenly matter is lit where a ray enters it through a cut: a crop, a clip plane, a cut-out, missing samples,
        the end of the data. 1 lights it for some slices like matter without a gradient, so that the face shows its
        values; 0 lights it by its gradient, which draws the noise of the data as relief.
    shoulder : float, 0 to 1
        Colours of the picture that are brighter than this are compressed, so that they approach 1 and keep their form:
        x becomes s + (x - s) / (1 + (x - s) / (1 - s)). 1 leaves them as they are. Pictures without shading are never
        changed.
    exposure : float, 0 or more
        Factor of all three Phong terms.
    lights : sequence of `Light`
        Empty means a key light and a fill light: `Light((-0.55, 0.65, 1))` and `Light((0, 0, 1), color=3 * [0.3])`.
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
    1.0
    >>> explaining = ws.Shading(ambient_occlusion=0.8, shadow=0.5)
    >>> picture = ws.render(ws.examples.ct_pelvis(), "ct-bone", shading=explaining, size=(32, 32))

    Notes
    -----
    Occlusion and shadow are worked out on a coarse copy of the volume, at most 96 cells along its longest side.
    """

    ambient: float
    diffuse: float
    specular: float
    specular_power: float
    gradient_smoothing: float
    gradient_offset: float
    unoriented: float
    even_cuts: float
    shoulder: float
    exposure: float
    lights: tuple[Light, ...]
    ambient_occlusion: float
    occlusion_radius: float | None
    shadow: float
    _core: _native.Shading = field(init=False, repr=False, compare=False)

    @takes_its_types
    def __init__(
        self,
        *,
        ambient: float = 0.22,
        diffuse: float = 1.0,
        specular: float = 0.25,
        specular_power: float = 16.0,
        gradient_smoothing: float = 0.8,
        gradient_offset: float = 1.0,
        unoriented: float = 0.5,
        even_cuts: float = 1.0,
        shoulder: float = 0.75,
        exposure: float = 1.0,
        lights: Iterable[Light] = (),
        ambient_occlusion: float = 0.0,
        occlusion_radius: float | None = None,
        shadow: float = 0.0,
    ) -> None:
        # Checked at once, so that an error points at the line that made it.
        lights = tuple(lights)
        if not 0 <= exposure < float("inf"):
            raise ArgumentError(f"shading: exposure is {exposure}; it must be 0 or more, 1 is neutral")
        # The compiled module looks at it only where gradients are not smoothed.
        if gradient_smoothing and not 0.01 <= gradient_offset <= 4:
            raise ArgumentError(f"shading: gradient_offset is {gradient_offset}; give 0.01 to 4, in voxels")
        for light in lights:
            if not isinstance(light, Light):
                raise ArgumentError(f"lights hold a {type(light).__name__}; give wavesplat.Light(direction) for each")
        native_lights = [(light.frame, light.direction, light.color) for light in lights or (KEY_LIGHT, FILL_LIGHT)]
        exposed = (exposure * ambient, exposure * diffuse, exposure * specular)
        surface = (specular_power, gradient_smoothing, gradient_offset, unoriented, even_cuts, shoulder)
        held_off = (ambient_occlusion, occlusion_radius, shadow)
        core = _native.Shading(*exposed, *surface, native_lights, *held_off)
        given = (ambient, diffuse, specular, *surface, exposure, lights, *held_off, core)
        for name, value in zip(self.__dataclass_fields__, given, strict=True):
            object.__setattr__(self, name, value)

    @classmethod
    def headlight(cls, **settings: Any) -> Shading:
        """The light of VTK's volume mappers and of 3D Slicer: one headlight, gradients by central differences.

        Two-sided as all shading here. Highlights clip, matter without a gradient has the ambient light alone, and cut
        faces are lit by their gradients.

        Parameters
        ----------
        **settings
            Settings that differ, as for `Shading`.

        Examples
        --------
        >>> import wavesplat as ws
        >>> light = ws.Shading.headlight(ambient=0.2)
        >>> light.ambient, light.diffuse, light.shoulder
        (0.2, 0.7, 1.0)
        """
        plain: dict[str, Any] = {
            "ambient": 0.1,
            "diffuse": 0.7,
            "specular": 0.2,
            "specular_power": 10.0,
            "gradient_smoothing": 0.0,
            "unoriented": 0.0,
            "even_cuts": 0.0,
            "shoulder": 1.0,
            "lights": [Light((0, 0, 1))],
        }
        return cls(**(plain | settings))

    def changed(self, **settings: Any) -> Shading:
        """A copy with other settings.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.Shading().changed(ambient=0.4).ambient
        0.4
        """
        own = {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "_core"}
        return type(self)(**(own | settings))

    def __repr__(self) -> str:
        return short_repr(self)

    def __reduce__(self) -> tuple[Any, ...]:
        settings = {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "_core"}
        return partial(type(self), **settings), ()
