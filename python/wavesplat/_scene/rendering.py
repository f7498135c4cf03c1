"""`wavesplat.render`: a picture of volumes or a scene in one call."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Literal

from wavesplat._cluster.blocks import on_machines
from wavesplat._looks.labels import Labels
from wavesplat._looks.shading import Shading
from wavesplat._model.argument_types import takes_its_types
from wavesplat._model.camera import Camera
from wavesplat._model.clips import Clip
from wavesplat._model.composites import Operator
from wavesplat._model.options import Kernel, Quality
from wavesplat._model.sampling import Sampling
from wavesplat._picture.picture import Picture
from wavesplat._public import public
from wavesplat._render.arguments import checked_count
from wavesplat._scene.drawing import Options, draw
from wavesplat._scene.layer import AnyLook
from wavesplat._scene.scene import as_scene

__all__ = ["render"]


@public
@takes_its_types
def render(
    what: Any,
    look: AnyLook | Sequence[AnyLook] = None,
    camera: Camera | str | None = None,
    *,
    size: tuple[int, int] = (512, 512),
    quality: Quality | Sampling = "normal",
    psnr: float | None = None,
    kernel: Kernel = "linear",
    composite: Operator | None = None,
    labels: Labels | None = None,
    shading: Shading | Literal["look"] | None = "look",
    clip: Clip | Iterable[Clip] = (),
    background: str | Sequence[float] | None = None,
    depth: bool = False,
    threads: int | None = None,
    device: str = "auto",
    progress: Callable[[float], object] | None = None,
    client: Any = None,
    segments: int | None = None,
) -> Picture:
    """A picture of a volume or a scene, by high-resolution splatting.

    Parameters
    ----------
    what : Volume, WaveletVolume, array, Layer, Scene, or up to eight volumes or layers in a list
        What to draw, from `wavesplat.open` or an array, or from wavelet coefficients. For several pictures of the same
        make a `Scene` once.
    look : Look, TransferFunction, TransferFunction2D, Materials or str, optional
        How the values are shown; a text is the name of a preset. None chooses by the kind of data (`Look.auto`); the
        report says which and why. "minimum", "mean", "sum" and "x-ray" then get greys for what this view shows: pass a
        look to frames that are to be compared. For several volumes one for each, in a list; layers and scenes bring
        their own.
    camera : Camera or str, optional
        Or the name of a view, such as "left". None is the look's view or, where it has none, a patient's front, the
        thin side of a stack, or a three-quarter view from above. Names and None frame what is seen of all layers; the
        first one chooses the view.
    size : (width, height), default (512, 512)
        Pixels.
    quality : str or Sampling
        "draft", "normal" or "high", which takes more sheets where the transfer function is steep; or how many sheets
        and texels there are. The report holds what was used.
    psnr : float, optional
        Instead of `quality`: choose the sampling for this PSNR against the converged picture with 16 rays a pixel, in
        dB, 20 to 80; 40 is good, 50 can hardly be told from it. Some tiles of the picture are drawn with several
        samplings to measure its error, then all of it is drawn once, with the cheapest sampling that promises enough.
        The report has that as `sheets_per_slice` and `oversampling`, and an estimate as `expected_psnr_db`, with its
        standard deviation as `expected_psnr_spread_db`: less than what was asked for where nothing reaches that.
        Projections are compared with one ray a pixel. Of a scene only the first picture is measured (`Scene.render`).
    kernel : str
        Reconstruction between samples: "linear", the sharper "catmull-rom", the smooth interpolating "bspline2" and
        "bspline3", or the blurring "gaussian".
    composite : str or object, optional
        None is the look's own. "over": emission and absorption. `FirstHit(iso_value)`: an isosurface. The others
        are projections: one number per ray, `Picture.value`, which is then coloured. "maximum" (MIP), "minimum",
        "mean" and "sum" (the integral) of the values; "depth-shaded-maximum", "local-maximum" and "x-ray", which are
        `DepthShadedMaximum`, `LocalMaximum` and `XRay` with what is usual. On a light background greys that are chosen
        here are inverted: black is much. Of several layers each is projected, and their colours are added as light;
        there is no value then.
    labels : Labels, optional
        A segmentation beside the scan, with a look for every label; for "over".
    shading : Shading, None or "look"
        Phong shading of "over" and `FirstHit`; None draws the colours as given, "look" is the look's own.
    clip : Crop, ClipPlane, CutOut or several of them
        `Crop` keeps a box, `ClipPlane` keeps a side of a plane, `CutOut` takes a box out.
    background : colour, optional
        (r, g, b), (r, g, b, a), "#rrggbb" or a name. None is the look's own or, where it has none, transparent.
    depth : bool
        Also give `Picture.depth`.
    threads : int, optional
        Worker threads; None uses all cores. The picture does not depend on it.
    device : str
        "cpu", "gpu", or part of the name of a GPU of this machine (`wavesplat.gpu.adapters`); another name is an error.
        "auto" is a GPU where one has passed its self-test, from the second picture of a process on. Pictures are the
        same within one grey level of 255; for the same bytes everywhere give "cpu". What a GPU cannot do, the CPU does;
        `report["device"]` says who drew, and why.
    progress : callable, optional
        Called with the part done, 0..1; returning False stops.
    client : dask.distributed.Client or "threads", optional
        Draw blocks of the picture on the workers of a Dask cluster, each of which opens the files itself; the bytes are
        those of this machine. "threads" is Dask's scheduler in this process.
    segments : int, optional
        Composite rays in segments of so many slices, which are folded from front to back: with `client` a task each,
        for data in workers' memory. The picture is the same wherever it is drawn, and differs from that in one go by
        where rays stop, at most 2e-4 of full light. Not with `depth`, and not of a local maximum.

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
    options = Options(
        size=size,
        quality=quality,
        psnr=psnr,
        kernel=kernel,
        composite=composite,
        depth=depth,
        threads=threads,
        device=device,
        progress=progress,
        segments=checked_count(segments, "segments"),
        elsewhere=None if client is None else on_machines(client, progress),
    )
    scene = as_scene(what, look, labels=labels, shading=shading, clip=clip, background=background)
    return draw(scene, camera, options)
