"""`wavesplat.render_part`: one process's part of a picture whose samples lie in several."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from wavesplat._cluster.parts import PartDrawing, PartialPicture
from wavesplat._looks.shading import Shading
from wavesplat._model.argument_types import described, takes_its_types
from wavesplat._model.camera import Camera
from wavesplat._model.clips import Clip
from wavesplat._model.lazy_volume import LazyVolume
from wavesplat._model.option_lists import takes_options
from wavesplat._public import public
from wavesplat._render.options import DrawOptions, RenderOptions
from wavesplat._scene.drawing import draw
from wavesplat._scene.layer import AnyLook
from wavesplat._scene.scene import as_scene
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from typing import Unpack


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
        As for `wavesplat.render`, and the same in all processes. Looks and cameras that are left out are those of the
        whole: they are made from the overviews. Projections whose brightness depends on the view ("minimum", "mean",
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
