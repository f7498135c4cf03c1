"""Cameras: position, focal point and view up, with the names that VTK and PyVista use."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import dist, hypot, radians, tan
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat import _native
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.camera import fit as camera_fit
from wavesplat._model.camera.fit import Fit
from wavesplat._model.camera.views import FARTHEST, Vector, vector, view_angles
from wavesplat._public import public
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume.grid import Grid
    from wavesplat._model.volume.volume_like import VolumeLike

#: Range of sample spacings in which shading is right: gradients are differences over the spacing, and float32 must hold
#: their squares, 1e36 for a difference of 1 at the smallest spacing, 1e-38 for one of 1e-5 at the largest.
SMALLEST, LARGEST = 1e-18, 1e14
#: Largest distance from the world's origin, in spacings: float64 still resolves a thousandth of a sample there.
PRECISION = 1e12


@public
@dataclass(frozen=True, init=False)
class Camera:
    """A camera in world space, orthographic or in perspective.

    Parameters
    ----------
    position, focal_point : three numbers (x, y, z)
        The eye and the point in the middle of the picture, world units.
    view_up : three numbers (x, y, z)
        Direction that points up in the picture; need not be perpendicular to the view.
    parallel_scale : float, keyword only
        Half the height of the view, world units: an orthographic camera.
    view_angle : float, keyword only
        Angle of view from bottom to top, degrees: a perspective camera. Give one of the two.

    Raises
    ------
    ArgumentError
        If the position is the focal point, the up direction is parallel to the view, or a number is out of range.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), view_angle=30).view_angle
    30.0
    """

    position: Vector
    focal_point: Vector
    view_up: Vector
    parallel_scale: float | None
    view_angle: float | None
    _core: _native.Camera = field(init=False, repr=False, compare=False)

    @takes_its_types
    def __init__(
        self,
        position: Iterable[float],
        focal_point: Iterable[float],
        view_up: Iterable[float],
        *,
        parallel_scale: float | None = None,
        view_angle: float | None = None,
    ) -> None:
        # Checked at once, so that an error points at the line that made it.
        triple = (
            vector(position, "position of the camera"),
            vector(focal_point, "focal_point of the camera"),
            vector(view_up, "view_up of the camera"),
        )
        lens = tuple(None if number is None else float(number) for number in (parallel_scale, view_angle))
        core = _native.Camera(*triple, *lens)
        names = ("position", "focal_point", "view_up", "parallel_scale", "view_angle", "_core")
        for name, value in zip(names, (*triple, *lens, core), strict=True):
            object.__setattr__(self, name, value)

    @classmethod
    @takes_its_types
    def orbit(
        cls,
        volume: VolumeLike,
        azimuth: float = 0.0,
        elevation: float = 0.0,
        *,
        zoom: float = 1.0,
        view_angle: float | None = None,
        aspect: float = 1.0,
        points: ArrayLike | None = None,
        fit: Fit = "turn",
    ) -> Camera:
        """Camera on a sphere around the volume, at one scale from everywhere, with the whole volume in view.

        Parameters
        ----------
        volume : Volume, WaveletVolume, Scene, array, or what else `Volume` takes
            What to look at; the middle of its box is the focal point.
        azimuth : float, degrees
            0 is the anterior view: the eye on +y of the RAS world, looking towards -y, +z up.
            It grows towards the patient's left: 90 is the left view, 180 the posterior one.
        elevation : float, degrees
            Lifts the eye towards +z: 90 looks down from above, -90 up from below.
            The up direction turns along, so no elevation is degenerate.
        zoom : float, default 1
            Magnification. In perspective it narrows the angle of view; the eye stays.
        view_angle : float, degrees, optional
            Perspective with this vertical angle (at zoom 1); None is orthographic.
        aspect : float, default 1
            Width over height of the picture that the volume must fit.
        points : array, shape (n, 3), optional
            What must be in view instead of the corners of the volume's box, world positions.
        fit : "turn" or "view", default "turn"
            "turn": scale and distance are those at which the volume is in view from every azimuth and elevation, so
            frames of a turn can be compared. "view": as near as this one view allows.

        Raises
        ------
        ArgumentError
            If a number is not finite, or zoom, aspect or view angle is out of range.

        Examples
        --------
        >>> import wavesplat as ws
        >>> volume = ws.examples.ripples(8)
        >>> eye = ws.Camera.orbit(volume, azimuth=90)  # from the patient's left
        >>> eye.position[0] < eye.focal_point[0]
        True
        >>> eye.parallel_scale == ws.Camera.orbit(volume, azimuth=45).parallel_scale
        True
        """
        camera_fit.check_angles(azimuth=azimuth, elevation=elevation)
        axes = camera_fit.orbit_axes(azimuth, elevation)
        lens: Any = {"zoom": zoom, "view_angle": view_angle, "aspect": aspect}
        return cls._placed(axes, volume, points=points, fit=fit, **lens)

    @classmethod
    @takes_its_types
    def view(
        cls,
        volume: VolumeLike,
        name: str,
        *,
        zoom: float = 1.0,
        view_angle: float | None = None,
        aspect: float = 1.0,
    ) -> Camera:
        """Camera of a named view, with the whole volume just in view.

        Parameters
        ----------
        volume : Volume, WaveletVolume, Scene, array, or what else `Volume` takes
            What to look at.
        name : str
            "anterior", "posterior", "left", "right", "superior" or "inferior": where the eye is.
            Anterior and inferior show the patient's right at the left of the picture. "front" and "back", "top" and
            "bottom" are other names for "anterior" and "posterior", "superior" and "inferior". "xy", "xz" and "yz" show
            these axes of the world as an array is shown, the first to the right and the second downwards; of a patient
            they are the inferior, anterior and left view. "isometric" is a three-quarter view from above.
        zoom, view_angle, aspect
            As for `Camera.orbit`.

        Raises
        ------
        ArgumentError
            If there is no view of that name.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.Camera.view(ws.examples.ripples(8), "superior").view_up
        (0.0, 1.0, 0.0)
        """
        azimuth, elevation = view_angles(name, is_anatomical=camera_fit.is_anatomical(volume))
        return cls.orbit(volume, azimuth, elevation, zoom=zoom, view_angle=view_angle, aspect=aspect, fit="view")

    @takes_its_types
    def turned(self, azimuth: float = 0.0, elevation: float = 0.0, roll: float = 0.0) -> Camera:
        """The camera after a turn about its focal point; scale and distance stay.

        Parameters
        ----------
        azimuth : float, degrees
            About the world's +z, as in `Camera.orbit`: from a patient's front towards the left.
        elevation : float, degrees
            Lifts the eye towards the top of the picture; the up direction turns along, past 90 degrees too.
        roll : float, degrees
            Turns the eye clockwise about the line of sight, and so the picture anticlockwise.

        Raises
        ------
        ArgumentError
            If an angle is not a finite number.

        Examples
        --------
        >>> import wavesplat as ws
        >>> volume = ws.examples.ripples(8)
        >>> front = ws.Camera.view(volume, "front")
        >>> front.turned(azimuth=90).view_up, front.turned(azimuth=90).parallel_scale == front.parallel_scale
        ((0.0, 0.0, 1.0), True)
        """
        camera_fit.check_angles(azimuth=azimuth, elevation=elevation, roll=roll)
        if azimuth == elevation == roll == 0:
            return self
        return camera_fit.turned(self, azimuth, elevation, roll)

    @takes_its_types
    def zoomed(self, factor: float) -> Camera:
        """The camera that shows everything `factor` times as large; in perspective by a narrower angle, the eye stays.

        Parameters
        ----------
        factor : float
            Magnification: 2 shows half of the width, twice as large.

        Raises
        ------
        ArgumentError
            If the factor is not a positive number.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), parallel_scale=100).zoomed(4).parallel_scale
        25.0
        """
        return camera_fit.zoomed(self, factor)

    @takes_its_types
    def fitted(
        self, volume: VolumeLike, *, aspect: float = 1.0, zoom: float = 1.0, points: ArrayLike | None = None
    ) -> Camera:
        """A camera with the same direction and kind of lens, placed so that all of a volume is just in view.

        Parameters
        ----------
        volume : Volume, WaveletVolume, Scene, array, or what else `Volume` takes
            What to look at; its middle is the new focal point.
        aspect : float, default 1
            Width over height of the picture that it must fit.
        zoom : float, default 1
            Magnification beyond that.
        points : array, shape (n, 3), optional
            What must be in view instead of the corners of the volume's box, world positions.

        Raises
        ------
        ArgumentError
            If a number is out of range.

        Examples
        --------
        >>> import wavesplat as ws
        >>> volume = ws.examples.ripples(8)
        >>> somewhere = ws.Camera((0, 900, 0), (0, 0, 0), (0, 0, 1), parallel_scale=5)
        >>> somewhere.fitted(volume) == ws.Camera.view(volume, "front")
        True
        """
        axes = camera_fit.axes_of(self)
        lens: Any = {"zoom": zoom, "view_angle": self.view_angle, "aspect": aspect}
        return self._placed(axes, volume, points=points, fit="view", **lens)

    @classmethod
    @takes_its_types
    def interpolate(cls, cameras: Sequence[Camera], n: int, *, closed: bool = False) -> list[Camera]:
        """Cameras on a smooth path through key frames.

        The direction turns without a jerk at the keys; focal point, distance and scale change evenly from key to key
        (the last two by factors) and never overshoot.

        Parameters
        ----------
        cameras : sequence of Camera
            Key frames at equal distances in time; all orthographic or all in perspective.
        n : int
            Number of cameras. The first is the first key, and the last, unless `closed`, the last key.
        closed : bool
            Go on from the last key to the first one: the path repeats after `n` cameras without showing one twice.

        Raises
        ------
        ArgumentError
            If there is no key, or keys are of different kinds.

        Notes
        -----
        Between two keys that look in opposite directions both ways round are equally long: the azimuth grows.

        Examples
        --------
        >>> import wavesplat as ws
        >>> volume = ws.examples.ripples(8)
        >>> keys = [ws.Camera.orbit(volume, 0), ws.Camera.orbit(volume, 90, 20)]
        >>> way = ws.Camera.interpolate(keys, 5)
        >>> len(way), way[0] == keys[0], way[4] == keys[1]
        (5, True, True)
        """
        from wavesplat._model.camera import path as camera_path

        return camera_path.evenly(cameras, n, closed=closed)

    @takes_its_types
    def project(self, points: ArrayLike, *, size: Sequence[int]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Places of world points in a picture of this camera, and their depths.

        Parameters
        ----------
        points : array, shape (n, 3)
            World positions (x, y, z).
        size : two numbers (width, height)
            Pixels of the picture, as for `render`.

        Returns
        -------
        pixels : float64 array, shape (n, 2)
            Column and row, not rounded. (0, 0) is the centre of the first pixel, the upper left one, as in
            `picture.rgba[row, column]` and matplotlib's `imshow`. Points beside the picture lie beyond its pixels;
            those that are not in front of a perspective camera are NaN.
        depths : float64 array, shape (n,)
            World units along the ray of the point, from the eye, or from the plane of an orthographic camera's
            position, as in `Picture.depth`: a point whose depth is larger than the picture's there is hidden.

        Raises
        ------
        ArgumentError
            If the points are not of shape (n, 3), or the size is none.

        Examples
        --------
        >>> import wavesplat as ws
        >>> camera = ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), parallel_scale=100)
        >>> pixels, depths = camera.project([(0, 0, 0), (-50, 100, 50)], size=(200, 200))
        >>> pixels.tolist(), depths.tolist()
        ([[99.5, 99.5], [149.5, 49.5]], [500.0, 400.0])
        """
        return camera_fit.projected(self, points, size)

    @takes_its_types
    def unproject(self, pixels: ArrayLike, depths: ArrayLike, *, size: Sequence[int]) -> NDArray[np.float64]:
        """World points at places in a picture of this camera, at depths along their rays: the inverse of `project`.

        Parameters
        ----------
        pixels : array, shape (n, 2)
            Column and row, as `project` gives them: (0, 0) is the centre of the first pixel.
        depths : array, shape (n,), or one number for all
            World units along the ray, as in `Picture.depth`: `picture.depth[row, column]` is where matter is half
            absorbed, or a surface lies. Where it is NaN, so is the point.
        size : two numbers (width, height)
            Pixels of the picture, as for `render`.

        Returns
        -------
        float64 array, shape (n, 3)
            World positions (x, y, z).

        Raises
        ------
        ArgumentError
            If the shapes do not fit each other, or the size is none.

        Examples
        --------
        >>> import wavesplat as ws
        >>> camera = ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), parallel_scale=100)
        >>> camera.unproject([(99.5, 99.5), (149.5, 49.5)], [500, 400], size=(200, 200)).tolist()
        [[0.0, 0.0, 0.0], [-50.0, 100.0, 50.0]]
        """
        return camera_fit.unprojected(self, pixels, depths, size)

    def as_json(self) -> dict[str, Any]:
        """The camera as an object that `json` can write, which `from_json` reads back exactly.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), view_angle=30).as_json()["view_angle"]
        30.0
        """
        from wavesplat._model.camera import files as camera_json

        return camera_json.fields_of(self)

    @classmethod
    @takes_its_types
    def from_json(cls, document: Mapping[str, Any] | str) -> Camera:
        """The camera that an object, or its JSON text, describes, as `as_json` writes it.

        Parameters
        ----------
        document : dict or str
            With `version` 1, `position`, `focal_point` and `view_up`, and `parallel_scale` or `view_angle`.

        Raises
        ------
        ArgumentError
            If it is no such object; the message names the field.

        Examples
        --------
        >>> import wavesplat as ws
        >>> camera = ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), view_angle=30)
        >>> ws.Camera.from_json(camera.as_json()) == camera
        True
        """
        from wavesplat._model.camera import files as camera_json

        if isinstance(document, str):
            return camera_json.parse(document)
        if not isinstance(document, Mapping):
            raise ArgumentError(f"document is {described(document)}; give the object or the JSON text of a camera")
        return camera_json.build(dict(document))

    @takes_its_types
    def save(self, path: str | PathLike[str]) -> None:
        """Write the camera to a JSON file.

        Raises
        ------
        FileError
            If the file cannot be written; nothing is left behind.

        Examples
        --------
        >>> import wavesplat as ws
        >>> camera = ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), view_angle=30)
        >>> camera.save("camera.json")
        >>> ws.Camera.load("camera.json") == camera
        True
        """
        from wavesplat._model.camera import files as camera_json
        from wavesplat._storage import json_texts

        json_texts.save(path, camera_json.write(self))

    @classmethod
    @takes_its_types
    def load(cls, path: str | PathLike[str], name: str | None = None) -> Camera:
        """The camera in a JSON file, as `save` writes it, or of a view in a file of ParaView.

        Parameters
        ----------
        path : path
            JSON, or ParaView's `.pvsm`, `.pvcc` or Python state, which is read and never run. Its world is VTK's: the
            same as ours where a file keeps its place in both programs, and no patient's.
        name : str, optional
            Which view of a state with several; case does not matter.

        Raises
        ------
        FileError
            If the file cannot be read.
        ArgumentError
            If it does not describe a camera (the message names the field), or several and none is named.
        """
        from wavesplat._model.camera import files as camera_json
        from wavesplat._model.interchange import paraview_state
        from wavesplat._storage import json_texts as json_object

        def build(text: str) -> Camera:
            if not paraview_state.is_state(text):
                if name is not None:
                    raise ArgumentError(f"camera: the file holds one; leave out the name {name!r}")
                return camera_json.parse(text)
            view = paraview_state.view_named(text, name)
            lens = {"parallel_scale": view.parallel_scale, "view_angle": view.view_angle}
            return cls(view.position, view.focal_point, view.view_up, **lens)

        return json_object.load(path, "camera", build)

    @classmethod
    @takes_its_types
    def from_pyvista(
        cls, source: Any, *, view_angle: float | None = None, parallel_scale: float | None = None
    ) -> Camera:
        """The camera of a PyVista or VTK window: the same view, in world coordinates.

        Parameters
        ----------
        source : Plotter, Camera, vtkCamera or camera position
            A plotter or its camera, whose lens is taken too; or (position, focal point, up), three numbers each.
        view_angle : float, degrees, optional
            Perspective with this vertical angle; None is the source's own, or 30 for a bare camera position.
        parallel_scale : float, optional
            Half the height of the view, world units: orthographic, instead of `view_angle`.

        Raises
        ------
        ArgumentError
            If it is none of these.

        Examples
        --------
        >>> import wavesplat as ws
        >>> cpos = [(0, 500, 0), (0, 0, 0), (0, 0, 1)]  # plotter.camera_position
        >>> ws.Camera.from_pyvista(cpos).view_angle
        30.0
        """
        from wavesplat._model.camera import files as camera_vtk

        return camera_vtk.camera_of(source, view_angle, parallel_scale)

    @property
    def cpos(self) -> tuple[Vector, Vector, Vector]:
        """Position, focal point and up: what PyVista's `plotter.camera_position` takes.

        The lens is beside it: `plotter.camera.view_angle`, or `parallel_scale` with `parallel_projection`.
        """
        return self.position, self.focal_point, self.view_up

    @classmethod
    def _placed(cls, axes: camera_fit.Vectors, volume: VolumeLike, **options: Any) -> Camera:
        return camera_fit.camera_at(camera_fit.placed(axes, volume, **options))

    def __reduce__(self) -> tuple[Any, ...]:
        lens = partial(type(self), parallel_scale=self.parallel_scale, view_angle=self.view_angle)
        return lens, (self.position, self.focal_point, self.view_up)


def checked_lens(zoom: float, view_angle: float | None) -> None:
    """Refuse an impossible magnification or angle of view."""
    camera_fit.check_lens(zoom, view_angle, 1.0)


def check_view(camera: Camera, volume: Grid) -> None:
    """Refuse a view whose scale or distance differs from the volume's size by more than the factor `FARTHEST`."""
    columns, middle = check_place(volume)
    across = sum(hypot(*column) for column in columns)
    distance = dist(camera.position, camera.focal_point)
    farthest = max(dist(camera.position, middle), dist(camera.focal_point, middle))
    half = distance * tan(radians(camera.view_angle) / 2) if camera.view_angle else camera.parallel_scale or 0.0
    if not across / FARTHEST <= half <= across * FARTHEST:
        raise ArgumentError(
            f"the camera sees {2 * half:g} world units from bottom to top, the volume {volume.name!r} is {across:g} "
            "across; give a zoom, parallel_scale or view_angle that shows something of it"
        )
    if not (farthest <= across * FARTHEST and distance >= across / FARTHEST):
        raise ArgumentError(
            f"the camera is {farthest:g} world units from the volume {volume.name!r}, which is {across:g} across, and "
            f"{distance:g} from its focal point; move it nearer, or the two apart"
        )


def check_place(volume: Grid) -> tuple[list[Vector], Vector]:
    """Edges and centre of the volume's box; an `ArgumentError` where floats cannot resolve its samples in the world.

    In plain floats: this is done for every frame.
    """
    rows = volume.world_from_index.tolist()
    steps = [hypot(rows[0][axis], rows[1][axis], rows[2][axis]) for axis in range(3)]
    least, most = min(steps), max(steps)
    farthest = max(abs(rows[0][3]), abs(rows[1][3]), abs(rows[2][3]))
    if not (least >= SMALLEST and most <= LARGEST and most <= FARTHEST * least and farthest <= PRECISION * least):
        raise ArgumentError(
            f"volume {volume.name!r} has samples {least:g} to {most:g} apart, {farthest:g} from the world's origin; "
            "give them in other units, or pass spacing="
        )
    edges = [
        (rows[0][axis] * (n - 1), rows[1][axis] * (n - 1), rows[2][axis] * (n - 1))
        for axis, n in enumerate(reversed(volume.shape))
    ]
    x, y, z = (rows[axis][3] + sum(edge[axis] for edge in edges) / 2 for axis in range(3))
    return edges, (x, y, z)
