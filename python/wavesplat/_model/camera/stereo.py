"""Pictures for two eyes: their layout, the distance of the eyes, and where they converge."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

from wavesplat import _native
from wavesplat._public import public
from wavesplat._system.values import described, positive
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wavesplat._model.camera.camera import Camera


Layout: TypeAlias = Literal["side-by-side", "top-bottom", "anaglyph", "left", "right"]
Side: TypeAlias = Literal["left", "right"]
LAYOUTS: tuple[str, ...] = get_args(Layout)


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
        from wavesplat._model.camera import fit  # with NumPy, which the command line starts without

        if is_panorama and self.convergence is not None:
            raise ArgumentError(
                "convergence is of flat pictures: eyes of a panorama look in parallel; leave out convergence"
            )
        apart, convergence = _native.eyes_settled(fit.fields_of(camera), self.eye_distance, self.convergence)
        if is_panorama:
            return replace(self, eye_distance=apart)
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
        from wavesplat._model.camera import fit

        if self.panorama:
            return fit.all_around(given)
        return given if self.stereo is None else fit.in_perspective(given)


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
