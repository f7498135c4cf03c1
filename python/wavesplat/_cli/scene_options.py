"""Options of a scene, and the scene that they make with the options of layers, cuts and light."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from wavesplat._cli import parsers
from wavesplat._cli.color_field_options import color_layer
from wavesplat._cli.crop_options import CutOptions, chosen_clip
from wavesplat._cli.geometry_options import GeometryOptions, opened_geometry
from wavesplat._cli.label_options import LabelsFile, LabelTable, Segments, opened_labels
from wavesplat._cli.layer_options import LayerOptions, further_layers
from wavesplat._cli.light_options import LightOptions, chosen_shading, exposure_of
from wavesplat._cli.opened_layers import Channels, changed_channels, opened_in_uptake, refuse_for_channels
from wavesplat._cli.option_groups import with_options_of
from wavesplat._cli.printing import message
from wavesplat._cli.processing_options import ProcessingOptions
from wavesplat._cli.reader_options import ReaderOptions
from wavesplat._cli.shared_options import Background, Family, Threshold
from wavesplat._cli.transfer_function_options import ColorOptions, LookOptions
from wavesplat._cli.uptake import check_uptake
from wavesplat._model.options import BY_VIEW, Composite
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._model.composites import Operator
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume
    from wavesplat._scene.scene import Scene

__all__ = ["ChosenScene", "SceneOptions", "check_scene_options", "chosen_scene", "takes_scene_options", "unit_of"]


@dataclass(frozen=True)
class SceneOptions(GeometryOptions, LookOptions):
    """The look of a volume, its labels, operator, wavelets, background and geometry."""

    labels: LabelsFile = None
    label_table: LabelTable = None
    segment: Segments = None
    iso_value: Annotated[float | None, typer.Option(metavar="VALUE", help="Surface that first-hit shows.")] = None
    local_threshold: Annotated[
        float | None, typer.Option(metavar="VALUE", help="Least maximum that local-maximum stops at.")
    ] = None
    depth_shading: Annotated[
        float | None, typer.Option(metavar="0..1", help="How much depth-shaded-maximum dims the farthest; 0.6.")
    ] = None
    depth_color: Annotated[
        str | None,
        typer.Option(
            metavar="MAP[:x|y|z]",
            help="Draw the maximum in the colours of its depth, such as turbo, or of its place along an axis: turbo:z.",
        ),
    ] = None
    attenuate: Annotated[
        float | None,
        typer.Option(
            metavar="PER_VOXEL",
            help="Of attenuated-maximum: how much a voxel of the brightest matter dims what is behind it; 0.05.",
        ),
    ] = None
    attenuation: Annotated[
        Any,
        typer.Option(
            metavar="CLEAR,PER_UNIT",
            parser=parsers.numbers(2, "-1000,2.06e-5"),
            help="Of x-ray: a value that absorbs nothing, and absorption per world unit and unit above it.",
        ),
    ] = None
    threshold: Threshold = None
    wavelet_level: Annotated[
        int | None,
        typer.Option(
            metavar="N", help="Leave out the wavelets' N finest levels, and draw at the resolution of the next."
        ),
    ] = None
    bands: Annotated[
        Any,
        typer.Option(
            metavar="W,W,...",
            parser=parsers.weights,
            help="A weight for each level of wavelets, the finest first, and for the coarsest samples.",
        ),
    ] = None
    family: Family = "cdf97"
    background: Background = None
    keep_table: Annotated[
        bool,
        typer.Option(
            "--keep-table",
            help="Draw the table below a patient in a CT, which is else left out where it can be told from the body.",
            show_default=False,
        ),
    ] = False

    @property
    def operator(self) -> Composite | None:
        """Name of the operator, which some options imply; None leaves it to the look."""
        named = super().operator
        implied = next((owner for option, owner in IMPLYING.items() if getattr(self, option) is not None), None)
        return implied if implied is not None and named in (None, "maximum") else named


def takes_scene_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command these options on the command line, in the place of its parameter `showing`."""
    return with_options_of(SceneOptions, "showing", command)


class ChosenScene(NamedTuple):
    """A scene, the look of its first layer, and the operator that it is drawn with."""

    scene: Scene
    look: Look
    operator: Operator
    #: Number of the layers, of all of the scene's, that are of INPUT.
    n_own: int = 1

    @property
    def looks(self) -> tuple[Look, ...]:
        """Looks of the layers of INPUT."""
        looks: Any = tuple(layer.look for layer in self.scene.layers[: self.n_own])
        return looks  # type: ignore[no-any-return]

    @property
    def unit(self) -> str | None:
        """Unit of the world's lengths, where a file names one."""
        return unit_of(self.scene)


def unit_of(scene: Scene) -> str | None:
    """Unit of the lengths of a scene's world, where a file names one."""
    units = (layer.drawn.facts.unit for layer in scene.layers)
    return next((unit for unit in units if unit is not None), None)


def check_scene_options(showing: SceneOptions, colors: ColorOptions, cuts: CutOptions) -> None:
    """Refuse options that cannot work, before anything is read."""
    showing.check(colors)
    parsers.refuse_pairs(crop=cuts.crop, crop_index=cuts.crop_index)
    if showing.operator is not None:
        _operator(showing.operator, showing)


def chosen_scene(
    input: str,
    showing: SceneOptions,
    *,
    colors: ColorOptions,
    layering: LayerOptions,
    cuts: CutOptions,
    lighting: LightOptions,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    quiet: bool,
    all_times: bool = False,
    looks: Sequence[Look] | None = None,
) -> ChosenScene:
    """The scene of the options, its volumes opened.

    all_times : keep all times of a file if no time is given. looks : of the layers of INPUT, instead of their own.
    """
    from wavesplat._looks.over_time import brightest
    from wavesplat._model.series import Series
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.scene import Scene

    if showing.keep_table and processing.remove_table:
        raise ArgumentError("--keep-table draws the table, and --remove-table takes it out; give one of them")
    composite = showing.operator
    opened = opened_in_uptake(
        input,
        reader,
        layering,
        processing,
        composite=composite,
        quiet=quiet,
        all_times=all_times,
        is_alone=not layering.layer,
    )
    if isinstance(opened, Channels):
        refuse_for_channels(showing, colors, len(opened.layers))
        layers, look = changed_channels(opened, colors, exposure_of(lighting, None))
        if looks is not None:
            _check_looks(looks, len(layers), input)
            layers = [replace(layer, look=given) for layer, given in zip(layers, looks, strict=True)]
            look = looks[0]
        shading: Any = chosen_shading(lighting, None) or ("look" if lighting.shading else None)
    else:
        volume = opened if isinstance(opened, Series) else _levels(opened, showing)
        brief = brightest(volume) if isinstance(volume, Series) else volume
        if looks is not None:
            _check_looks(looks, 1, input)
        # Labels lie on the volume that their look was made for.
        is_given = looks is not None and looks[0].labels is None
        look = looks[0] if looks and is_given else showing.look(brief, input, colors, quiet=quiet)
        exposure = 1.0 if is_given else exposure_of(lighting, look.shading)
        look = look.changed(exposure=exposure)
        shading = chosen_shading(lighting, look.shading)
        if layering.layer:  # which have light of their own
            look, shading = look if is_given else replace(look, shading=shading), "look"
        # Greys that depend on the view are left to the renderer.
        is_chosen_here = look.name == "auto" and not (is_given or layering.layer or layering.times)
        is_plain = not colors.are_given() and exposure == 1
        by_view = is_chosen_here and is_plain and look.composite in BY_VIEW
        layers = [Layer(volume, None if by_view else look)]
    if layering.color_by is not None:
        if len(layers) > 1:
            raise ArgumentError("--color-by gives one volume its colours, and channels have their own; choose one")
        has_times = isinstance(layers[0].volume, Series)
        color = color_layer(layering.color_by, input, reader, has_times=has_times, quiet=quiet)
        layers = [replace(layers[0], color_from=color)]
    scene = Scene(
        [
            *layers,
            *further_layers(layering.layer, layers[0].drawn, time=reader.time or 0, quiet=quiet, suv=reader.suv),
        ],
        labels=opened_labels(showing.labels, showing.label_table, showing.segment, layers[0].drawn, quiet=quiet),
        shading=shading,
        clip=chosen_clip(cuts, layers[0].drawn),
        background=showing.background or look.background or "black",
        keep_table=showing.keep_table,
        geometry=opened_geometry(showing, layers[0].drawn.facts.unit, quiet=quiet),
    )
    check_uptake(scene, suv=reader.suv)
    if not quiet:
        _note_guesses(scene, look, composite)
        if layering.times is not None:
            _note_one_look(scene)
    return ChosenScene(scene, look, _operator(composite or look.composite, showing), len(layers))


def _check_looks(looks: Sequence[Look], n: int, input: str) -> None:
    if len(looks) != n:
        raise ArgumentError(
            f"--same-look gives the looks of {len(looks)} channels, and this file has {n}; draw files of as many "
            f"channels together, or name them with --channel: {input}"
        )


#: Options of a number -> the operator that takes it.
NUMBERS = {
    "iso_value": "first-hit",
    "local_threshold": "local-maximum",
    "depth_shading": "depth-shaded-maximum",
    "depth_color": "depth-colored-maximum",
    "attenuate": "attenuated-maximum",
    "attenuation": "x-ray",
}


#: Options that say which operator they are for, where none or a plain maximum is named.
IMPLYING: dict[str, Composite] = {"depth_color": "depth-colored-maximum", "attenuate": "attenuated-maximum"}


def _operator(composite: Composite, showing: SceneOptions) -> Operator:
    """The operator with its number; an `ArgumentError` where the number is for another operator."""
    from wavesplat._model.composites import (
        AttenuatedMaximum,
        DepthColoredMaximum,
        DepthShadedMaximum,
        FirstHit,
        LocalMaximum,
        XRay,
    )

    for name, owner in NUMBERS.items():
        if getattr(showing, name) is not None and composite != owner:
            option = f"--{name.replace('_', '-')}"
            raise ArgumentError(
                f"{option} is for --composite {owner}, not for {composite}; give that, or leave out {option}"
            )
    if composite == "first-hit":
        if showing.iso_value is None:
            raise ArgumentError("--composite first-hit needs the value of the surface; give it as --iso-value")
        return FirstHit(showing.iso_value)
    if composite == "local-maximum":
        return LocalMaximum(showing.local_threshold)
    if composite == "depth-shaded-maximum":
        return DepthShadedMaximum() if showing.depth_shading is None else DepthShadedMaximum(showing.depth_shading)
    if composite == "depth-colored-maximum":
        return DepthColoredMaximum() if showing.depth_color is None else _in_depth_colors(showing.depth_color)
    if composite == "attenuated-maximum":
        return AttenuatedMaximum() if showing.attenuate is None else AttenuatedMaximum(showing.attenuate)
    if composite == "x-ray":
        return XRay(*(showing.attenuation or ()))
    return composite


def _in_depth_colors(text: str) -> Operator:
    """The operator of --depth-color."""
    from wavesplat._looks.colormaps import colors_of
    from wavesplat._model.composites import AXES, DepthColoredMaximum

    name, _, axis = text.rpartition(":")
    # Names of maps can have colons too, as "cmocean:thermal".
    if axis in AXES and name:
        colors_of(name)
        chosen: Any = axis
        return DepthColoredMaximum(name, chosen)
    try:
        colors_of(text)
    except ArgumentError:
        if name and _is_colormap(name):
            raise ArgumentError(
                f"--depth-color {text}: after the colon comes the axis, x, y or z, not {axis!r}; without a colon the "
                "colours show the distance from the eye"
            ) from None
        raise
    return DepthColoredMaximum(text)


def _is_colormap(name: str) -> bool:
    from wavesplat._looks.colormaps import colors_of

    try:
        colors_of(name)
    except ArgumentError:
        return False
    return True


def _levels(volume: Volume | WaveletVolume, showing: SceneOptions) -> Volume | WaveletVolume:
    """The volume to draw: wavelets if any of these options asks for them, without the levels and bands left out."""
    from wavesplat._model.wavelet_volume import WaveletVolume

    threshold, level, bands = showing.threshold, showing.wavelet_level, showing.bands
    if isinstance(volume, WaveletVolume):
        if threshold is not None:
            raise ArgumentError(
                "--threshold is for samples; the coefficients of this file were dropped when it was made"
            )
    elif threshold is None and level is None and bands is None:
        return volume
    else:
        volume = WaveletVolume.from_volume(volume, showing.family, threshold=threshold)
    if level is not None and not 0 <= level <= volume.n_levels:
        raise ArgumentError(
            f"--wavelet-level is {level}; {volume.name!r} has {volume.n_levels}, so give 0 to {volume.n_levels}"
        )
    weighted = volume if bands is None else volume.bands(bands)
    return weighted if level is None else weighted.level(level)


def _note_one_look(scene: Scene) -> None:
    """Say which time points the look of all of them is chosen by, where their values choose it."""
    from wavesplat._looks.look import Look
    from wavesplat._looks.over_time import sampled_numbers
    from wavesplat._model.series import Series

    for layer in scene.layers:
        look, series = layer.look, layer.volume
        is_chosen = isinstance(look, Look) and (look.name == "auto" or look.reason.endswith("by the values"))
        if isinstance(series, Series) and len(series) > 1 and is_chosen:
            *numbers, last = sampled_numbers(series)
            listed = f"{', '.join(map(str, numbers))} and {last}"
            message(f"note: one look for all times, chosen by the brightest of time points {listed}")
            return


def _note_guesses(scene: Scene, look: Look, composite: str | None) -> None:
    # Only the guess that changes what a pixel means is printed; all are in the report.
    if look.name == "auto" and composite is None and look.composite != "over" and look.reason.endswith("values"):
        message(f"note: taken for {look.reason}; another look is one of `wavesplat presets`")
    n_nonfinite = sum(layer.drawn.n_nonfinite for layer in scene.layers)
    if n_nonfinite:
        message(f"note: {n_nonfinite} samples are NaN or infinite: they are missing, and matter around them is fainter")
