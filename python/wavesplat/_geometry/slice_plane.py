"""Slices that stand in space."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from wavesplat._geometry.shape import Shape
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._model.camera.views import named_plane, point_and_normal
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume_like import as_volume
from wavesplat._public import public
from wavesplat._system.values import described, whole
from wavesplat.errors import ArgumentError

#: Name of the plane that stands for all faces that the clips of a scene cut.
CUTS = "cuts"


@public
@dataclass(frozen=True, eq=False, repr=False)
class SlicePlane(Shape):
    """A slice through a volume that stands in space, shown as `wavesplat.slice` shows it.

    Parameters
    ----------
    volume : Volume or what else `Volume` takes, optional
        What is cut; None is the volume of the scene's first layer.
    plane : str or (point, normal), default "axial"
        As for `wavesplat.slice`: "axial", "coronal" or "sagittal"; "xy", "xz" or "yz"; or any plane, world units.
        "cuts" are the faces that the scene's crops, clip planes and cut-out boxes cut, as far as these are seen: they
        show the samples, further layers and labels as a slice does, and the air around a patient's body is clear.
    position : float, optional
        Where the plane crosses its axis, world units; None is the middle of the volume. Of (point, normal): how far
        to move from the point along the normal.
    index : int, optional
        Instead of `position`: the number of the slice of samples along the axis, from 0; -1 is the last.
    window, clim : optional
        As for `wavesplat.slice`: which values are black and white, or the ends of the colour map.
    cmap : str, optional
        Colour map of the values; None is grey.
    opacity : float, 0..1, default 1
        Of the slice; outside of the volume it is clear.
    clipped : bool, default False
        The scene's crops and clip planes cut it, too; cut-out boxes do not.
    visible : bool, default True
        Whether it is drawn; a hidden one stays in the scene.
    name : str, optional
        What messages and the viewer call it.

    Raises
    ------
    ArgumentError
        If an argument cannot work. Whether the plane meets the volume is checked when it is drawn.

    Examples
    --------
    >>> import wavesplat as ws
    >>> scene = ws.Scene(ws.examples.ct_pelvis(), "ct-bone", geometry=[ws.SlicePlane(window="soft-tissue")])
    >>> scene.render(size=(32, 32)).report["geometry"]
    [{'kind': 'slice plane', 'name': None, 'count': 1}]
    """

    KIND: ClassVar[str] = "slice plane"

    volume: Any = None
    plane: Any = "axial"
    _: KW_ONLY
    position: float | None = None
    index: int | None = None
    window: Any = None
    clim: Any = None
    cmap: str | None = None
    opacity: float = 1.0
    clipped: bool = False
    visible: bool = True
    name: str | None = None

    def __post_init__(self) -> None:
        self._check_style()
        if self.volume is not None and not isinstance(self.volume, Series):
            self._set(volume=as_volume(self.volume))
        if self.plane == CUTS:
            self._check_no_place()
        elif isinstance(self.plane, str):
            try:
                named_plane(self.plane, is_anatomical=True)
            except ArgumentError as error:
                raise ArgumentError(f"{error}, or {CUTS!r}, the faces of all clips") from None
        else:
            self._set(plane=_point_and_normal(self.plane))
        if self.position is not None and self.index is not None:
            raise ArgumentError(f"position and index of {self._title} both say where it lies; give one of them")
        if self.index is not None:
            self._set(index=whole(self.index, f"index of {self._title}", "a whole number, from 0"))
            if not isinstance(self.plane, str):
                raise ArgumentError(
                    f"index of {self._title} counts slices, and an oblique plane has none; give position"
                )
        if self.cmap is not None:
            TransferFunction.from_colormap(self.cmap, clim=(0, 1))  # or an error

    def _check_no_place(self) -> None:
        given = [word for word in ("position", "index") if getattr(self, word) is not None]
        if given or self.clipped:
            raise ArgumentError(
                f"{(given or ['clipped'])[0]} of {self._title} says which part is seen, and cuts are where the scene's "
                "clips cut; leave it out"
            )

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"<SlicePlane{name}: {self.plane if isinstance(self.plane, str) else 'oblique'}>"


def _point_and_normal(plane: Any) -> Any:
    form = "the name of a plane, or (point, normal), three numbers each"
    try:
        point, normal = plane
    except (TypeError, ValueError):
        raise ArgumentError(f"plane is {described(plane)}; give {form}") from None
    return point_and_normal(point, normal, "plane")
