"""Options of drawing: names, types, defaults and meaning, once for all functions that draw."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypedDict

from wavesplat._model.arguments.operators import Operator
from wavesplat._model.arguments.sampling import Kernel, Quality, Sampling
from wavesplat._model.camera.stereo import Eyes, Stereo, checked_eyes
from wavesplat._public import public


class FrameOptions(TypedDict, total=False):
    """Options of every function that draws pictures of a volume; `RenderOptions` documents them."""

    size: tuple[int, int]
    quality: Quality | Sampling | None
    psnr: float | None
    kernel: Kernel
    composite: Operator | None
    stereo: Stereo | str | None
    panorama: bool
    threads: int | None
    device: str
    progress: Callable[[float], object] | None


@public
class RenderOptions(FrameOptions, total=False):
    """Options of a picture, as `render` and `Scene.render` take them.

    Parameters
    ----------
    size : (width, height), default (512, 512)
        Pixels.
    quality : str or Sampling
        "draft", "normal", "fine" or "high", which take more sheets where the transfer function is steep; or how many
        sheets and texels there are. None is the function's usual one. The report holds what was used. "fine" has 8 dB
        more than "normal" in 2 to 3 times its time, "high" 10 to 13 dB in 3 to 7 times (`make bench-qualities`);
        translucent looks, such as the automatic look of a CT, take 6 and 20 times as long.
    psnr : float, optional
        Instead of `quality`: choose the sampling for this PSNR against the converged picture with 16 rays a pixel, in
        dB, 20 to 80; 40 is good, 50 can hardly be distinguished from it. Some tiles of the picture are drawn with some
        samplings of a fixed list to measure its error, then all of it with the cheapest one that promises enough.
        The report has that as `sheets_per_slice` and `oversampling`, and an estimate as `expected_psnr_db`, with its
        standard deviation as `expected_psnr_spread_db`: less than what was asked for where nothing reaches that.
        Projections are compared with one ray a pixel. Of a scene only the first picture is measured (`Scene.render`).
    kernel : str
        Reconstruction between samples: "linear", the sharper "catmull-rom", the smooth interpolating "bspline2" and
        "bspline3", or the blurring "gaussian".
    composite : str or object, optional
        None is the look's own. "over": emission and absorption. `FirstHit(iso_value)`: an isosurface. The others
        are projections: one number per ray, `Picture.value`, which is then coloured. "maximum" (MIP), "minimum",
        "mean" and "sum" (the integral) of the values; "depth-shaded-maximum", "depth-colored-maximum",
        "attenuated-maximum", "local-maximum" and "x-ray", which are `DepthShadedMaximum`, `DepthColoredMaximum`,
        `AttenuatedMaximum`, `LocalMaximum` and `XRay` with what is usual. On a light background greys that are chosen
        here are inverted: black is much. Of several layers each is projected, and their colours are added as light;
        there is no value then.
    stereo : Stereo or str, optional
        Pictures for two eyes: a `Stereo`, or its layout, "side-by-side", "top-bottom", "anaglyph", "left" or "right".
        An orthographic camera is drawn in perspective of 30 degrees then, at the same scale in the focal plane.
    panorama : bool, default False
        All that is around the camera's position, 360 degrees in width and 180 in height (equirectangular): the focal
        point in the middle, the camera's up at the upper edge. For names of views and None the eye is in the middle of
        what is shown. Give twice as many pixels in width as in height, for each eye. Its light stays where it is in the
        view ahead.
    threads : int, optional
        Worker threads; None uses all cores. The picture does not depend on it.
    device : str
        "cpu", "gpu", or part of the name of a GPU of this machine (`wavesplat.gpu.adapters`); another name is an error.
        "auto" is a GPU where one has passed its self-test, from the second picture of a process on. Pictures are the
        same within one grey level of 255; for the same bytes everywhere give "cpu". What a GPU cannot do, the CPU does;
        `report["device"]` says who drew, and why.
    progress : callable, optional
        Called with the part done, 0..1; returning False stops.
    depth : bool
        Also give `Picture.depth`: of opacities and surfaces, and of maxima and minima.
    client : dask.distributed.Client or "threads", optional
        Draw blocks of the picture on the workers of a Dask cluster, each of which opens the files itself; the bytes are
        the same as on this machine. "threads" is Dask's scheduler in this process.
    segments : int, optional
        Slices of a segment of the rays: segments are folded from front to back, and with `client` each is a task, for
        data in workers' memory. The picture is the same wherever it is drawn, and differs from the picture without
        segments by where rays stop, at most 2e-4 of full light. Not with `depth`, and not of a local maximum.

    Examples
    --------
    >>> import wavesplat as ws
    >>> scene = ws.Scene(ws.examples.ripples(16))
    >>> small: ws.RenderOptions = {"size": (48, 32), "quality": "draft"}
    >>> [scene.render(view, **small).size for view in ("front", "left")]
    [(48, 32), (48, 32)]
    """

    depth: bool
    client: Any
    segments: int | None


@dataclass(frozen=True, kw_only=True)
class DrawOptions:
    """The values of `RenderOptions`, and of what `wavesplat.study` and pictures in progress need besides."""

    size: tuple[int, int] = (512, 512)
    quality: Quality | Sampling | None = "normal"
    psnr: float | None = None
    kernel: Kernel = "linear"
    composite: Operator | None = None
    stereo: Stereo | str | None = None
    panorama: bool = False
    threads: int | None = None
    device: str = "auto"
    progress: Callable[[float], object] | None = None
    depth: bool = False
    client: Any = None
    segments: int | None = None
    #: Of `wavesplat.study.render`.
    pre_integration: bool = True
    early_ray_termination: bool = True
    #: Called with the specification of a streamed frame before it is planned; an error ends the picture.
    before_plan: Callable[[Any], object] | None = None
    #: Called with a stream and the number of a block of it that was drawn, for pictures that are shown before they are
    #: done.
    after_block: Callable[[Any, int], object] | None = None
    #: Draws a streamed frame from its specification, instead of this process block by block: gives the stream, with
    #: all that is drawn put into it, and counts of what was read.
    draw_frame: Callable[[Any], tuple[Any, Any]] | None = None

    @property
    def eyes(self) -> Eyes:
        """The eyes that see the picture; an `ArgumentError` where there are no such."""
        return checked_eyes(self.stereo, self.panorama)
