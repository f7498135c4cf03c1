"""Ways to draw that the method is judged against: itself without one of its parts, and standard splatting."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from operator import index
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

from wavesplat import _native
from wavesplat._looks.curves import colors
from wavesplat._looks.curves.materials import Materials
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.clips import Clip, combined_clips
from wavesplat._model.arguments.sampling import Buffer, Kernel
from wavesplat._model.arguments.types import takes_its_types, takes_options
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.cutting import without
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.volume_like import VolumeLike, as_volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._picture.picture import Picture
from wavesplat._picture.report import Report
from wavesplat._render import arguments
from wavesplat._render.options import DrawOptions, RenderOptions
from wavesplat._scene.drawing.drawing import draw
from wavesplat._scene.layer import AnyLook
from wavesplat._scene.scene import as_scene
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from typing import Unpack

__all__ = ["Ablation", "StandardSplatting", "render", "splat", "standard"]

GradientScheme: TypeAlias = Literal["footprint", "footprint-forward", "sheet-central", "sheet-forward"]
Footprint: TypeAlias = Literal["exact", "nearest", "nearest-noise"]


@dataclass(frozen=True, kw_only=True)
class Ablation:
    """A part of the method left out or changed, to show what it buys. The default is the method as it is.

    Parameters
    ----------
    view_angle_correction : bool, default True
        A sheet that rays cross at an angle theta to its normal stands for dz / cos(theta) of them. False: for dz, so
        that pictures get fainter as the view tilts.
    kernel_slicing : bool, default True
        A sheet is made of all slices within the kernel's radius, weighted by the kernel there. False: of the samples of
        the nearest slice alone, so that sheets between two slices repeat them.
    gradient : str, default "footprint"
        Where shading takes gradients, axis by axis of the grid; d is `Shading.gradient_offset`, in samples,
        and there must be no smoothing.
        "footprint": [V(x + d) - V(x - d)] / 2d at every texel. "footprint-forward": [V(x + d) - V(x)] / d, towards
        larger indices. "sheet-central", "sheet-forward": the same differences of the texels and sheets that there are,
        as sheet buffers give them: d becomes the nearest whole number of texels (along x and y) or of sheets (along z),
        at least one, and at most 4 samples. A small d gives the neighbours.
    footprint : str, default "exact"
        The weights within a sheet. "exact": the kernel. "nearest": the nearest entry of a table, which turns slopes
        into stairs. "nearest-noise": the same with every sample of each sheet displaced by up to half an entry, which
        turns the stairs into grain. The noise is a hash of the sample's place, so that pictures repeat; weights are
        scaled to sum 1, so that what is flat stays flat.
    footprint_entries : int, 2 to 1024, default 8
        Entries of that table per sample distance.

    Raises
    ------
    ArgumentError
        If a name is unknown or the number of entries out of its range.

    Examples
    --------
    >>> import wavesplat as ws
    >>> plain = ws.study.Ablation(view_angle_correction=False, kernel_slicing=False)
    >>> ws.study.splat(ws.examples.ripples(8), ablation=plain, size=(8, 8)).size
    (8, 8)

    Notes
    -----
    The alternatives are taken from "High Resolution Image Splatting", IJACEN 2(7), 2014.
    """

    view_angle_correction: bool = True
    kernel_slicing: bool = True
    gradient: GradientScheme = "footprint"
    footprint: Footprint = "exact"
    footprint_entries: int = 8
    _core: _native.Ablation = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        # Checked at once, so that an error points at the line that made it.
        try:
            entries = index(self.footprint_entries)
        except TypeError:
            raise ArgumentError(f"footprint_entries is {self.footprint_entries!r}; give a whole number") from None
        if not 2 <= entries <= 1024:
            raise ArgumentError(f"footprint_entries is {entries}; give a whole number between 2 and 1024")
        switches = (bool(self.view_angle_correction), bool(self.kernel_slicing))
        core = _native.Ablation(*switches, str(self.gradient), str(self.footprint), entries)
        object.__setattr__(self, "_core", core)

    def __reduce__(self) -> tuple[Any, ...]:
        settings = {name: getattr(self, name) for name in self.__dataclass_fields__ if name != "_core"}
        return _rebuild, (settings,)


def _rebuild(settings: dict[str, Any]) -> Ablation:
    return Ablation(**settings)


@takes_its_types
@takes_options(RenderOptions, DrawOptions)
def render(
    what: Any,
    look: AnyLook | Sequence[AnyLook] = None,
    camera: Camera | str | None = None,
    *,
    pre_integration: bool = True,
    early_ray_termination: bool = True,
    labels: Labels | None = None,
    shading: Shading | Literal["look"] | None = "look",
    clip: Clip | Iterable[Clip] = (),
    background: str | Sequence[float] | None = None,
    **options: Unpack[RenderOptions],
) -> Picture:
    """The picture of `wavesplat.render`, with what makes it fast or sharp left out.

    Parameters
    ----------
    what, look, camera, labels, shading, clip, background
        As for `wavesplat.render`.
    **options : RenderOptions
        As for `wavesplat.render`.
    pre_integration : bool
        Pre-integrate the space between sheets where the transfer function is steep, so that hard surfaces are found and
        shaded where they are. False: plain sheets, as the method has it.
    early_ray_termination : bool
        Stop rays where no more than 1e-4 of their light comes through. False: where no more than 2e-6 does.

    Returns
    -------
    Picture
        As from `wavesplat.render`.

    Raises
    ------
    ArgumentError
        If an argument cannot work.
    LimitError
        If the picture needs more memory than there may be.
    CancelledError
        If `progress` returned False.

    Examples
    --------
    >>> import wavesplat as ws
    >>> ws.study.render(ws.examples.ripples(8), pre_integration=False, size=(8, 8)).size
    (8, 8)
    """
    scene = as_scene(what, look, labels=labels, shading=shading, clip=clip, background=background)
    how = DrawOptions(pre_integration=pre_integration, early_ray_termination=early_ray_termination, **options)
    return draw(scene, camera, how)


@takes_its_types
def splat(
    volume: VolumeLike,
    transfer_function: TransferFunction | TransferFunction2D | Materials | str | None = None,
    camera: Camera | str | None = None,
    *,
    ablation: Ablation | None = None,
    size: tuple[int, int] = (512, 512),
    kernel: Kernel = "linear",
    shading: Shading | None = arguments.HEADLIGHT,
    sheets_per_slice: float = 2.0,
    oversampling: float = 1.0,
    clip: Clip | Iterable[Clip] = (),
    threads: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> Picture:
    """The picture of high-resolution splatting by its pseudo-code, in double precision, with a part of it left out.

    Sheets are plain: nothing is pre-integrated between them. Without an ablation it is what `render` draws with
    ``pre_integration=False`` and the same sheets and texels, a hundred times as slowly.

    Parameters
    ----------
    volume, transfer_function, camera, size, kernel, shading, clip, threads, progress
        As for `wavesplat.render`, but only a Volume; of a WaveletVolume, give `to_volume()`.
    ablation : Ablation, optional
        The part that is left out or changed; None draws the method as it is.
    sheets_per_slice : float, default 2
        Sheets per slice distance.
    oversampling : float, default 1
        Texels per pixel, along each side.

    Returns
    -------
    Picture
        With `rgba`, float32, shape (height, width, 4), associated, transparent background.

    Raises
    ------
    ArgumentError
        If an argument cannot work.
    CancelledError
        If `progress` returned False.

    Examples
    --------
    >>> import wavesplat as ws
    >>> without = ws.study.Ablation(kernel_slicing=False)
    >>> ws.study.splat(ws.examples.ripples(8), ablation=without, size=(8, 8), sheets_per_slice=3).rgba.shape
    (8, 8, 4)
    """
    volume = as_volume(volume)
    if not isinstance(volume, Volume):
        raise ArgumentError(
            f"the study draws a Volume, not a {type(volume).__name__}; of a WaveletVolume, give its to_volume()"
        )
    if ablation is not None and not isinstance(ablation, Ablation):
        raise ArgumentError(f"ablation is a {type(ablation).__name__}; give a wavesplat.study.Ablation(...)")
    if shading is not None and (shading.ambient_occlusion > 0 or shading.shadow > 0):
        raise ArgumentError("the study knows no ambient_occlusion and no shadow; give a Shading without them")
    width, height = arguments.checked_size(size)
    clipping = combined_clips(clip)
    look = arguments.chosen_look(transfer_function, volume, "over")
    volume = without(volume, clipping.boxes)
    rgba = _native.splat_ablated(
        volume._core,
        look.transfer_function._core,
        arguments.chosen_camera(camera, [(volume, look)], clipping, width / max(height, 1))._core,
        ablation=(ablation or Ablation())._core,
        width=width,
        height=height,
        kernel=kernel,
        shading=None if shading is None else shading._core,
        sheets_per_slice=float(sheets_per_slice),
        oversampling=float(oversampling),
        **arguments.region(clipping),
        threads=arguments.chosen_threads(threads),
        progress=progress,
    )
    return Picture(rgba)


def _samples_of(volume: Volume | WaveletVolume) -> _native.Volume | _native.DecodedVolume:
    """The samples of a volume; coefficients are decoded at full resolution."""
    if not isinstance(volume, WaveletVolume):
        return volume._core
    return volume.bands([0.0] * volume.left_out)._decoded()


@dataclass(frozen=True)
class StandardSplatting:
    """The sheet buffers of standard splatting, and the thickness of slabs that it assumes.

    Parameters
    ----------
    buffer : str
        "axis": sheet buffers parallel to the slices of the axis nearest to the view, one per slice, then mapped to the
        view plane. "view": parallel to the view plane; samples are sorted by depth into slabs as thick as the distance
        from slice to slice along the view.
    view_angle_correction : bool
        True: opacities are for the length that a ray runs from slice to slice. False: they are for the distance of
        slices from everywhere, as if slices were seen head-on; oblique views are then too clear ("axis") or, since
        samples lie closer in the picture, too opaque and too bright ("view").

    Raises
    ------
    ArgumentError
        If there is no such buffer, or the correction is not True or False.
    """

    buffer: Buffer = "axis"
    view_angle_correction: bool = True

    def __post_init__(self) -> None:
        """Check at once, so that an error points at the line that made it."""
        buffers = get_args(Buffer)
        if self.buffer not in buffers:
            raise ArgumentError(f"there is no buffer {self.buffer!r}; the buffers are {', '.join(buffers)}")
        if not isinstance(self.view_angle_correction, bool):
            raise ArgumentError(f"view_angle_correction is {self.view_angle_correction!r}; give True or False")


@takes_its_types
def standard(
    volume: VolumeLike,
    transfer_function: TransferFunction | TransferFunction2D | Materials | str | None = None,
    camera: Camera | str | None = None,
    *,
    standard: StandardSplatting | None = None,
    size: tuple[int, int] = (512, 512),
    kernel: Kernel = "linear",
    shading: Shading | None = arguments.HEADLIGHT,
    oversampling: float = 1.0,
    clip: Clip | Iterable[Clip] = (),
    background: str | Sequence[float] | None = None,
    threads: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> Picture:
    """The picture of standard splatting, the older technique: it splats colours and opacities, not densities.

    Parameters
    ----------
    volume, transfer_function, camera, size, shading, clip, background, threads, progress
        As for `wavesplat.render`. Crop boxes and clip planes keep the samples whose centres are inside.
    standard : StandardSplatting, optional
        Which buffers there are, and whether they correct for the view angle; None is ``StandardSplatting()``.
    kernel : str
        Kernel that colours are splatted with, as for `wavesplat.render`. B-splines smooth here, since there is no
        prefilter for colours.
    oversampling : float, default 1
        Texels per pixel, along each side.

    Returns
    -------
    Picture
        With `rgba`, float32, shape (height, width, 4), associated.

    Raises
    ------
    ArgumentError
        If an argument cannot work.
    LimitError
        If the picture needs more memory than there may be.
    CancelledError
        If `progress` returned False.

    Examples
    --------
    >>> import wavesplat as ws
    >>> view_plane = ws.study.StandardSplatting(buffer="view", view_angle_correction=False)
    >>> ws.study.standard(ws.examples.ripples(16), standard=view_plane, size=(32, 24)).rgba.shape
    (24, 32, 4)

    Notes
    -----
    Westover, *Footprint evaluation for volume rendering* (1990). Every sample is classified and shaded with its own
    value and the differences of its neighbours; its colour and opacity are then splatted. It blurs, and is there to be
    compared with. Overlapping splats can add up to more than there is: sums are clamped, opacity to 1 and colours to
    what that opacity can show.
    """
    if standard is not None and not isinstance(standard, StandardSplatting):
        raise ArgumentError(
            f"standard is a {type(standard).__name__}; give a wavesplat.study.StandardSplatting(buffer=...)"
        )
    chosen = standard or StandardSplatting()
    volume = as_volume(volume)
    width, height = arguments.checked_size(size)
    clipping = combined_clips(clip)
    look = arguments.chosen_look(transfer_function, volume, "over")
    volume = arguments.cut_open(volume, clipping.boxes)
    result = _native.render_standard(
        _samples_of(volume),
        look.transfer_function._core,
        arguments.chosen_camera(camera, [(volume, look)], clipping, width / max(height, 1))._core,
        width=width,
        height=height,
        kernel=kernel,
        shading=None if shading is None else shading._core,
        oversampling=float(oversampling),
        buffer=chosen.buffer,
        view_angle_correction=chosen.view_angle_correction,
        **arguments.region(clipping),
        background=colors.parse(background),
        threads=arguments.chosen_threads(threads),
        progress=progress,
    )
    return Picture(result["rgba"], result["depth"], result["value"], Report(result["report"]))
