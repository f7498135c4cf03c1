"""`wavesplat.render` and `wavesplat.render_part`: a picture, or one process's part of it, in one call."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from wavesplat._cluster.parts import PartDrawing, PartialPicture
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.clips import Clip
from wavesplat._model.arguments.types import takes_its_types, takes_options
from wavesplat._model.camera.camera import Camera
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._picture.picture import Picture
from wavesplat._public import public
from wavesplat._render.options import DrawOptions, RenderOptions
from wavesplat._scene.drawing.drawing import draw
from wavesplat._scene.layer import AnyLook
from wavesplat._scene.scene import as_scene
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from typing import Unpack


@public
@takes_its_types
@takes_options(RenderOptions, DrawOptions, in_full=True)
def render(
    what: Any,
    look: AnyLook | Sequence[AnyLook] = None,
    camera: Camera | str | None = None,
    *,
    labels: Labels | None = None,
    shading: Shading | Literal["look"] | None = "look",
    clip: Clip | Iterable[Clip] = (),
    background: str | Sequence[float] | None = None,
    keep_table: bool = False,
    geometry: Any = (),
    **options: Unpack[RenderOptions],
) -> Picture:
    """A picture of a volume or a scene, by high-resolution splatting.

    Parameters
    ----------
    what : Volume, WaveletVolume, array, Layer, Scene, or up to eight volumes or layers in a list
        What to draw, from `wavesplat.open` or an array, or from wavelet coefficients; in a list `geometry` may stand
        among it. For several pictures of the same make a `Scene` once.
    look : Look, TransferFunction, TransferFunction2D, Materials or str, optional
        How the values are shown; a text is the name of a preset. None chooses by the kind of data (`Look.auto`); the
        report says which and why. "minimum", "mean", "sum" and "x-ray" then get greys for what this view shows: pass a
        look to frames that are to be compared. For several volumes one for each, in a list; layers and scenes bring
        their own.
    camera : Camera or str, optional
        Or the name of a view, such as "left". None is the look's view or, where it has none, a patient's front, the
        thin side of a stack, or a three-quarter view from above. Names and None frame what is seen of all layers; the
        first one chooses the view.
    labels : Labels, optional
        A segmentation beside the scan, with a look for every label. Over projections it is laid, translucent.
    shading : Shading, None or "look"
        Phong shading of "over" and `FirstHit`; None draws the colours as given, "look" is the look's own.
    clip : Crop, ClipPlane, CutOut or several of them
        `Crop` keeps a box, `ClipPlane` keeps a side of a plane, `CutOut` takes a box out.
    background : colour, optional
        (r, g, b), (r, g, b, a), "#rrggbb" or a name. None is the look's own or, where it has none, transparent.
    keep_table : bool, default False
        Draw the table below a patient in a CT, which is otherwise left out where it can be recognized (`Scene`).
    geometry : Surface, Lines, Points, SlicePlane, Frame, or several of them in a list
        What stands in space with the volumes, as for `Scene`; to a scene it is added.
    **options : RenderOptions
        Pixels, quality, operator, and how and where it is drawn.

    Returns
    -------
    Picture
        With `rgba`, float32, shape (height, width, 4), associated. `report["look"]` has the look's name and reason,
        `report["processing"]` what was done to the samples (`Facts.processing`).

    Raises
    ------
    ArgumentError
        If an argument cannot work; the message says which, and how to mend it.
    LimitError
        If the picture needs more memory than there may be.
    CancelledError
        If `progress` returned False.

    Examples
    --------
    >>> import wavesplat as ws
    >>> volume = ws.examples.ripples(16)
    >>> picture = ws.render(volume, camera=ws.Camera.orbit(volume, 30, 20), size=(64, 48))
    >>> picture.rgba.shape
    (48, 64, 4)

    Notes
    -----
    ARCHITECTURE.md describes the method; Mueller, Moeller and Crawfis (1999) its idea.
    """
    given = {"labels": labels, "shading": shading, "clip": clip, "background": background}
    scene = as_scene(what, look, **given, keep_table=keep_table, geometry=geometry)
    return draw(scene, camera, DrawOptions(**options))


# `wavesplat.render_part`: one process's part of a picture whose samples lie in several.


@public
@takes_its_types
@takes_options(RenderOptions, DrawOptions)
def render_part(
    volume: Any,
    look: AnyLook = None,
    camera: Camera | str | None = None,
    *,
    shading: Shading | Literal["look"] | None = "look",
    clip: Clip | Iterable[Clip] = (),
    background: str | Sequence[float] | None = None,
    **options: Unpack[RenderOptions],
) -> PartialPicture:
    """One process's part of a picture of a volume that lies in several, for `merge`.

    Parameters
    ----------
    volume : LazyVolume
        From `VolumePart.whole`.
    look, camera, shading, clip, background
        As for `wavesplat.render`, and the same in all processes. Looks and cameras that are left out are made from the
        overviews, as for the whole volume. Projections whose brightness depends on the view ("minimum", "mean",
        "sum", "x-ray") need a look.
    **options : RenderOptions
        As for `wavesplat.render`; not `client`, `segments`, `psnr`, `stereo` and `panorama`. `depth` is for maxima and
        minima. Drawn by the CPU.

    Returns
    -------
    PartialPicture
        Send it to the process that merges, by `gather` of MPI, say: it can be pickled.

    Raises
    ------
    ArgumentError
        If an argument cannot work.

    Examples
    --------
    `VolumePart` has one of two parts.

    >>> import wavesplat as ws
    >>> field = ws.examples.ripples(16).samples
    >>> part = ws.VolumePart(field, (0, 0, 0), ((0, 16), (0, 16), (0, 16)), field.shape)  # one that has all
    >>> whole = part.whole([part.overview()])
    >>> ws.render_part(whole, size=(24, 16)).picture.size
    (24, 16)
    """
    if not isinstance(volume, LazyVolume):
        raise ArgumentError(f"volume is {described(volume)}; give what VolumePart.whole returns")
    scene = as_scene(volume, look, labels=None, shading=shading, clip=clip, background=background)
    drawing = PartDrawing()
    own = DrawOptions(**options)
    for name in ("client", "segments", "psnr"):
        if getattr(own, name) is not None:
            raise ArgumentError(f"{name} is for whole volumes; leave it out where parts are drawn")
    if not own.eyes.are_plain:
        raise ArgumentError("stereo pictures and panoramas are several pictures; draw and merge each with its camera")
    return drawing.partial(draw(scene, camera, replace(own, draw_frame=drawing)))
