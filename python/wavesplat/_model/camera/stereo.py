"""Pictures for two eyes: their layout, the distance of the eyes, and where they converge."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import dist, radians, tan
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

from wavesplat._public import public
from wavesplat._system.values import described, positive
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wavesplat._model.camera.camera import Camera


Layout: TypeAlias = Literal["side-by-side", "top-bottom", "anaglyph", "left", "right"]
Side: TypeAlias = Literal["left", "right"]
LAYOUTS: tuple[str, ...] = get_args(Layout)

#: Vertical angle of view, degrees, that VTK and ParaView give a camera, for views that are orthographic by themselves.
VIEW_ANGLE = 30.0
#: Least share of a view's up along the world's z of one that has a horizon.
MIN_UPRIGHT = 0.5
#: Angle between the eyes, seen from where they converge, degrees: the default of VTK's and ParaView's cameras.
EYE_ANGLE = 2.0


@public
@dataclass(frozen=True)
class Stereo:
    """Two eyes that see a scene, and the layout of their pictures.

    Both look in parallel, with frusta that are sheared so that they meet in the plane of convergence: what lies there
    has no parallax, what is nearer stands in front of the screen.

    Parameters
    ----------
    layout : str, default "side-by-side"
        "side-by-side" has the left eye on the left, "top-bottom" on top; each takes half of the picture. "anaglyph"
        has the left eye in red and the right one in green and blue. "left" or "right" is one eye's picture.
    eye_distance : float, optional
        World units; None is 2 degrees of what lies in the plane of convergence, 0.035 of its distance.
    convergence : float, optional
        Distance from the eyes to that plane, world units; None is that of the camera's focal point. Eyes of a panorama
        look in parallel, as glasses for virtual reality need it: give None.

    Raises
    ------
    ArgumentError
        If there is no layout of that name, or a distance is not a positive number.

    Examples
    --------
    >>> import wavesplat as ws
    >>> pair = ws.Stereo("side-by-side", eye_distance=20)
    >>> ws.render(ws.examples.ct_pelvis(), "ct-bone", "front", stereo=pair, size=(64, 32)).size
    (64, 32)

    Notes
    -----
    In a picture of h pixels in height with the vertical angle of view v, a point at depth z along the line of sight is
    ``h / (2 tan(v / 2)) * eye_distance * (1 / z - 1 / convergence)`` pixels farther to the right for the left eye.
    """

    layout: Layout = "side-by-side"
    eye_distance: float | None = None
    convergence: float | None = None

    def __post_init__(self) -> None:
        if self.layout not in LAYOUTS:
            raise ArgumentError(f"layout of the stereo is {described(self.layout)}; use one of: {', '.join(LAYOUTS)}")
        for name in ("eye_distance", "convergence"):
            given, form = getattr(self, name), "a positive number of world units"
            if given is not None:
                object.__setattr__(self, name, positive(given, f"{name} of the stereo", form))

    @property
    def sides(self) -> tuple[Side, ...]:
        """Eyes whose pictures are drawn."""
        return (self.layout,) if self.layout in ("left", "right") else ("left", "right")

    def settled(self, camera: Camera, *, is_panorama: bool) -> Stereo:
        """The same with its distances written out, for a camera."""
        middle = dist(camera.position, camera.focal_point)
        if is_panorama:
            if self.convergence is not None:
                raise ArgumentError(
                    "convergence is of flat pictures: eyes of a panorama look in parallel; leave out convergence"
                )
            apart = self.eye_distance or 2 * middle * tan(radians(EYE_ANGLE / 2))
            return replace(self, eye_distance=apart)
        convergence = self.convergence or middle
        apart = self.eye_distance or 2 * convergence * tan(radians(EYE_ANGLE / 2))
        if apart > convergence:
            raise ArgumentError(
                f"eye_distance is {apart:g} and convergence {convergence:g} world units; nobody can look at what is "
                "nearer than the eyes are apart: give less of the first, or more of the second"
            )
        return replace(self, eye_distance=apart, convergence=convergence)


class Eyes(NamedTuple):
    """How a scene is seen from a camera: by one eye or two, ahead or all around."""

    stereo: Stereo | None = None
    panorama: bool = False

    @property
    def are_plain(self) -> bool:
        """Whether one eye looks ahead."""
        return self.stereo is None and not self.panorama

    def size_of(self, size: tuple[int, int]) -> tuple[int, int]:
        """Width and height of each eye's picture in a picture of this size."""
        layout = None if self.stereo is None else self.stereo.layout
        width, height = size
        if (layout == "side-by-side" and width % 2) or (layout == "top-bottom" and height % 2):
            raise ArgumentError(f"size is {width} x {height}, and the two eyes share it {layout}; give an even number")
        if layout == "side-by-side":
            return width // 2, height
        return (width, height // 2) if layout == "top-bottom" else size

    def aspect_of(self, size: Sequence[int]) -> float:
        """Width over height of each eye's picture."""
        width, height = self.size_of((size[0], size[1]))
        return width / max(height, 1)

    def settled(self, camera: Camera) -> Eyes:
        """The same with the distances of the eyes written out."""
        if self.stereo is None:
            return self
        return self._replace(stereo=self.stereo.settled(camera, is_panorama=self.panorama))

    def camera(self, given: Camera) -> Camera:
        """The camera itself, in perspective where two eyes or a panorama need it."""
        if self.panorama:
            return replace(given, parallel_scale=None, view_angle=90.0)
        return given if self.stereo is None else in_perspective(given)


#: One eye that looks ahead.
PLAIN = Eyes()


def checked_eyes(stereo: object, panorama: object) -> Eyes:
    """The eyes of the options `stereo` and `panorama`."""
    if isinstance(stereo, str):
        stereo = Stereo(stereo)  # type: ignore[arg-type]
    if not (stereo is None or isinstance(stereo, Stereo)):
        raise ArgumentError(
            f"stereo is {described(stereo)}; give a wavesplat.Stereo, or the name of a layout: {', '.join(LAYOUTS)}"
        )
    if not isinstance(panorama, bool):
        raise ArgumentError(f"panorama is {described(panorama)}; give True or False")
    return Eyes(stereo, panorama)


def in_perspective(camera: Camera) -> Camera:
    """A perspective camera that shows as much in the focal plane as an orthographic one, from where 30 degrees do."""
    from wavesplat._model.camera import fit  # with NumPy, which the command line starts without

    if camera.view_angle is not None:
        return camera
    back = fit.axes_of(camera)[2]
    distance = (camera.parallel_scale or 0.0) / tan(radians(VIEW_ANGLE / 2))
    place = tuple((camera.focal_point + distance * back).tolist())
    return replace(camera, position=place, parallel_scale=None, view_angle=VIEW_ANGLE)


def within(camera: Camera, *, is_level: bool = True) -> Camera:
    """The camera moved to its focal point: the eye of a panorama from the middle of what the camera shows.

    It looks the same way or, level, along the horizon below or above that, with the world's z upright; views along z
    have none. The focal point is as far ahead as the camera shows to each side, as what is around the eye is.
    """
    import numpy as np

    from wavesplat._model.camera import fit as camera_fit
    from wavesplat._model.camera.camera import Camera

    _, up, back = camera_fit.axes_of(camera)
    far = camera.parallel_scale
    if far is None:
        far = dist(camera.position, camera.focal_point) * tan(radians((camera.view_angle or 0.0) / 2))
    if is_level and abs(up[2]) > MIN_UPRIGHT:
        up, back = np.array([0.0, 0.0, np.sign(up[2])]), back * (1.0, 1.0, 0.0)
    ahead = camera.focal_point - far / np.linalg.norm(back) * back
    return Camera(camera.focal_point, ahead, up, view_angle=90.0)
