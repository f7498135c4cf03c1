"""Options of a scene, and the scene that they make with the options of layers, cuts and light."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from wavesplat._cli.options import parsers
from wavesplat._cli.options.crop import CutOptions, chosen_clip
from wavesplat._cli.options.geometry import GeometryOptions, opened_geometry
from wavesplat._cli.options.groups import background, family, option, part, threshold
from wavesplat._cli.options.layers import color_layer, further_layers
from wavesplat._cli.options.opened_layers import (
    Channels,
    OpeningOptions,
    changed_channels,
    opened_in_uptake,
    refuse_for_channels,
)
from wavesplat._cli.options.reader import check_uptake
from wavesplat._cli.options.slices import LabelOptions, opened_labels
from wavesplat._cli.options.transfer_function import (
    ColorOptions,
    LightOptions,
    LookOptions,
    chosen_shading,
    exposure_of,
)
from wavesplat._cli.options.view import unit_of
from wavesplat._cli.printing import message
from wavesplat._model.arguments.sampling import BY_VIEW, Composite
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._model.arguments.operators import Operator
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.scene import Scene


@dataclass(repr=False)
class OperatorOptions:
    """Numbers of operators."""

    TITLE: ClassVar = "Operators"

    iso_value: float | None = option("VALUE", "Surface that first-hit shows.")
    local_threshold: float | None = option("VALUE", "Least maximum that local-maximum stops at.")
    depth_shading: float | None = option("0..1", "How much depth-shaded-maximum dims the farthest; 0.6.")
    depth_color: str | None = option(
        "MAP[:x|y|z]",
        "Draw the maximum in the colours of its depth, such as turbo, or of its place along an axis: turbo:z.",
    )
    attenuate: float | None = option(
        "PER_VOXEL",
        "Of attenuated-maximum: how much a voxel of the brightest matter dims what is behind it; 0.05.",
    )
    attenuation: Any = option(
        "CLEAR,PER_UNIT",
        "Of x-ray: a value that absorbs nothing, and absorption per world unit and unit above it.",
        parser=parsers.numbers(2, "-1000,2.06e-5"),
    )


@dataclass(repr=False)
class WaveletOptions:
    """Parts of wavelet volumes that are left out."""

    TITLE: ClassVar = "Wavelets"

    threshold: float | None = threshold()
    wavelet_level: int | None = option(
        "N", "Leave out the wavelets' N finest levels, and draw at the resolution of the next."
    )
    bands: Any = option(
        "W,W,...",
        "A weight for each level of wavelets, the finest first, and for the coarsest samples.",
        parser=parsers.weights,
    )
    family: str = family()


@dataclass(repr=False)
class AppearanceOptions(GeometryOptions, LabelOptions, WaveletOptions, OperatorOptions, LookOptions):
    """The look of a volume, its operator, wavelets, labels, geometry and background."""

    TITLE: ClassVar = LookOptions.TITLE

    background: Any = background()
    keep_table: bool = option(
        help="Draw the table below a patient in a CT, which is else left out where it can be recognized.",
        default=False,
    )

    @property
    def operator(self) -> Composite | None:
        """Name of the operator, which some options imply; None leaves it to the look."""
        named = super().operator
        implied = next((owner for option, owner in IMPLYING.items() if getattr(self, option) is not None), None)
        return implied if implied is not None and named in (None, "maximum") else named


@dataclass(repr=False)
class SceneOptions:
    """All that makes a scene of INPUT."""

    opening: OpeningOptions = part(OpeningOptions)
    showing: AppearanceOptions = part(AppearanceOptions)
    colors: ColorOptions = part(ColorOptions)
    cuts: CutOptions = part(CutOptions)
    lighting: LightOptions = part(LightOptions)

    def check(self) -> None:
        """Refuse options that cannot work, before anything is read."""
        self.showing.check(self.colors)
        parsers.refuse_pairs(crop=self.cuts.crop, crop_index=self.cuts.crop_index)
        if self.showing.operator is not None:
            _operator(self.showing.operator, self.showing)


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


def chosen_scene(
    input: str,
    options: SceneOptions,
    *,
    quiet: bool,
    all_times: bool = False,
    looks: Sequence[Look] | None = None,
) -> ChosenScene:
    """The scene of the options, its volumes opened.

    all_times : keep all times of a file if no time is given. looks : of the layers of INPUT, instead of their own.
    """
    from wavesplat._model.volume.series import Series
    from wavesplat._scene.scene import Scene

    showing, layering, reader = options.showing, options.opening.layering, options.opening.reader
    if showing.keep_table and options.opening.processing.remove_table:
        raise ArgumentError("--keep-table draws the table, and --remove-table takes it out; give one of them")
    layers, look, shading = _own_layers(input, options, quiet=quiet, all_times=all_times, looks=looks)
    first = layers[0].drawn
    if layering.color_by is not None:
        if len(layers) > 1:
            raise ArgumentError("--color-by gives one volume its colours, and channels have their own; choose one")
        has_times = isinstance(layers[0].volume, Series)
        color = color_layer(layering.color_by, input, reader, has_times=has_times, quiet=quiet)
        layers = [replace(layers[0], color_from=color)]
    further = further_layers(layering.layer, first, time=reader.time or 0, quiet=quiet, suv=reader.suv)
    scene = Scene(
        [*layers, *further],
        labels=opened_labels(showing, first, quiet=quiet),
        shading=shading,
        clip=chosen_clip(options.cuts, first),
        background=showing.background or look.background or "black",
        keep_table=showing.keep_table,
        geometry=opened_geometry(showing, first.facts.unit, quiet=quiet),
    )
    check_uptake(scene, suv=reader.suv)
    if not quiet:
        _note_guesses(scene, look, showing.operator)
        if layering.times is not None:
            _note_one_look(scene)
    return ChosenScene(scene, look, _operator(showing.operator or look.composite, showing), len(layers))


def _own_layers(
    input: str, options: SceneOptions, *, quiet: bool, all_times: bool, looks: Sequence[Look] | None
) -> tuple[list[Layer], Look, Any]:
    """The layers of INPUT, the look of the first of them, and the scene's shading."""
    from wavesplat._looks.over_time import brightest
    from wavesplat._model.volume.series import Series
    from wavesplat._scene.layer import Layer

    showing, colors, lighting = options.showing, options.colors, options.lighting
    layering = options.opening.layering
    opened = opened_in_uptake(
        input,
        options.opening,
        composite=showing.operator,
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
        return layers, look, chosen_shading(lighting, None) or ("look" if lighting.shading else None)
    volume = opened if isinstance(opened, Series) else _levels(opened, showing)
    brief = brightest(volume) if isinstance(volume, Series) else volume
    if looks is not None:
        _check_looks(looks, 1, input)
    # Labels lie on the volume that their look was made for.
    is_given = looks is not None and looks[0].labels is None
    look = looks[0] if looks and is_given else showing.look(brief, input, colors, quiet=quiet)
    exposure = 1.0 if is_given else exposure_of(lighting, look.shading)
    look = look.changed(exposure=exposure)
    shading: Any = chosen_shading(lighting, look.shading)
    if layering.layer:  # which have light of their own
        look, shading = look if is_given else replace(look, shading=shading), "look"
    # Greys that depend on the view are left to the renderer.
    is_chosen_here = look.name == "auto" and not (is_given or layering.layer or layering.times)
    is_plain = not colors.are_given() and exposure == 1
    by_view = is_chosen_here and is_plain and look.composite in BY_VIEW
    return [Layer(volume, None if by_view else look)], look, shading


def _check_looks(looks: Sequence[Look], n: int, input: str) -> None:
    if len(looks) != n:
        raise ArgumentError(
            f"--same-look gives the looks of {len(looks)} channels, and this file has {n}; draw files of as many "
            f"channels together, or name them with --channel: {input}"
        )


#: Options that say which operator they are for, where none or a plain maximum is named.
IMPLYING: dict[str, Composite] = {"depth_color": "depth-colored-maximum", "attenuate": "attenuated-maximum"}


#: Operators that take a number -> its option, and their class.
NUMBERS = {
    "first-hit": ("iso_value", "FirstHit"),
    "local-maximum": ("local_threshold", "LocalMaximum"),
    "depth-shaded-maximum": ("depth_shading", "DepthShadedMaximum"),
    "depth-colored-maximum": ("depth_color", "DepthColoredMaximum"),
    "attenuated-maximum": ("attenuate", "AttenuatedMaximum"),
    "x-ray": ("attenuation", "XRay"),
}


def _operator(composite: Composite, showing: AppearanceOptions) -> Operator:
    """The operator with its number; an `ArgumentError` where the number is for another operator."""
    from wavesplat._model.arguments import operators

    for owner, (field, _) in NUMBERS.items():
        if getattr(showing, field) is not None and composite != owner:
            name = f"--{field.replace('_', '-')}"
            raise ArgumentError(
                f"{name} is for --composite {owner}, not for {composite}; give that, or leave out {name}"
            )
    if composite not in NUMBERS:
        return composite
    field, kind = NUMBERS[composite]
    number = getattr(showing, field)
    if composite == "first-hit" and number is None:
        raise ArgumentError("--composite first-hit needs the value of the surface; give it as --iso-value")
    if composite == "depth-colored-maximum" and number is not None:
        return _in_depth_colors(number)
    numbers = () if number is None else number if isinstance(number, tuple) else (number,)
    operator: Operator = getattr(operators, kind)(*numbers)
    return operator


def _in_depth_colors(text: str) -> Operator:
    """The operator of --depth-color."""
    from wavesplat._looks.curves.colormaps import colors_of
    from wavesplat._model.arguments.operators import AXES, DepthColoredMaximum

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
    from wavesplat._looks.curves.colormaps import colors_of

    try:
        colors_of(name)
    except ArgumentError:
        return False
    return True


def _levels(volume: Volume | WaveletVolume, showing: AppearanceOptions) -> Volume | WaveletVolume:
    """The volume to draw: wavelets if any of these options asks for them, without the levels and bands left out."""
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

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
    from wavesplat._model.volume.series import Series

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
