"""Options of looks and light: what `--preset`, `--tf`, `--cmap`, `--materials` name, and its shading."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, get_args

from wavesplat._cli.options import parsers
from wavesplat._cli.options.groups import given, option
from wavesplat._cli.printing import warnings_as_notes
from wavesplat._model.arguments.sampling import COMPOSITE_SYNONYMS, Composite
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from wavesplat._looks.curves.transfer_function import TransferFunction
    from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
    from wavesplat._looks.look import Look
    from wavesplat._looks.shading import Shading
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume


def _light(text: str) -> Any:
    """The name of a light, or its direction."""
    if text in ("key", "headlight"):
        return text
    return parsers.numbers(3, "-1,1,1.5, key or headlight")(text)


@dataclass(repr=False)
class LightOptions:
    """Options of light; those that are not given leave the look's own settings."""

    TITLE: ClassVar = "Light"

    shading: bool = option(help="Light the surfaces, or draw colours as they are.", default=True)
    light: Any = option(
        "key|headlight|X,Y,Z",
        "key: from the upper left, with a fill light. headlight: as VTK and Slicer have it. Or the direction to it: x "
        "right, y up, z to the eye.",
        parser=_light,
    )
    ambient: float | None = option("SHARE", "Light that comes from everywhere.")
    diffuse: float | None = option("SHARE", "Light on surfaces that face it.")
    specular: float | None = option("SHARE", "Highlights.")
    specular_power: float | None = option("POWER", "Higher is a smaller, sharper highlight.")
    exposure: float | None = option("FACTOR", "Factor of all light; 1 changes nothing.")
    occlusion: float | None = option("0..1", "How much hollows darken.")
    shadow: float | None = option("0..1", "How dark the first light's shadow is.")
    gradient_smoothing: float | None = option(
        "VOXELS", "Smooth normals by 0.5 to 1.25 voxels; 0: differences, as VTK has them."
    )


@dataclass(repr=False)
class ColorOptions:
    """Options of a colour map over a range of values; without a map, changes of the look that is drawn."""

    TITLE: ClassVar = "Look"

    cmap: str | None = option(
        "NAME",
        "Colour map of matplotlib or others: viridis, inferno, coolwarm_r, cmocean:ice. Alone, of fields, it colours "
        "what is seen without it.",
    )
    clim: Any = option(
        "LOW,HIGH",
        "Values of the first and the last colour, or percentiles (1%,99.8%); the look's own if not given.",
        parser=parsers.ends("0,500"),
    )
    window: Any = option(
        "NAME|LEVEL,WIDTH",
        "Instead, as radiologists say it: bone, lung, brain, abdomen, mediastinum, liver, ..., or level and width; or "
        "percentiles.",
        parser=parsers.window,
    )
    log: bool = option(help="Map colours to the logarithm of the values.", default=False)
    opacity: Any = option(
        "NAME|A,A,...",
        "Over the range: linear, sigmoid, sqrt, a number, or numbers, 0..1.",
        parser=parsers.opacity,
    )
    gamma: float = option("G", "Less than 1 brightens mid-tones.", default=1.0)

    def are_given(self) -> bool:
        """Whether any of these options is set."""
        return self != ColorOptions()

    @property
    def name_a_map(self) -> bool:
        """Whether they make a look of a colour map, and do not change another."""
        return self.cmap is not None or self.log

    @property
    def name_a_map_alone(self) -> bool:
        """Whether they name a map, and neither values nor opacities, which the automatic look of a field has."""
        return self == ColorOptions(cmap=self.cmap) and self.cmap is not None

    def look(self, volume: Volume | WaveletVolume, opacity: str | float) -> Look:
        """The look of the map, grey if none is named. `opacity`: the default."""
        from wavesplat._looks.curves.transfer_function import TransferFunction
        from wavesplat._looks.look import Look

        name = self.cmap or "gray"
        function = TransferFunction.from_colormap(
            name,
            volume,
            clim=self._limits(volume),
            opacity=opacity if self.opacity is None else self.opacity,
            log=self.log,
            gamma=self.gamma,
        )
        return Look(transfer_function=function, name=name)

    def changed(self, look: Look, volume: Volume | WaveletVolume) -> Look:
        """A look with the window, gamma and opacity of these options."""
        return look.changed(window=self._limits(volume), gamma=self.gamma, opacity=self.opacity)

    def _limits(self, volume: Volume | WaveletVolume) -> tuple[float, float] | None:
        from wavesplat._render.windows import limits

        return None if self.window is None and self.clim is None else limits(volume, self.window, self.clim)


@dataclass(repr=False)
class NamedLookOptions:
    """Options of a look by name or from a file."""

    TITLE: ClassVar = ColorOptions.TITLE

    preset: str | None = option("NAME", "Look by name, see `wavesplat presets`; in 3D auto if nothing is given.")
    tf: Path | None = option(
        "FILE[#NAME]",
        "Look from a file: ours (.json), 3D Slicer's (.vp, .vp.json, .xml), ParaView's (.json, .xml, .pvsm, .py).",
    )


@dataclass(repr=False)
class LookOptions(NamedLookOptions):
    """Options of a look: by name, from a file, or of materials."""

    materials: str | None = option("FILE.json|ct|fit", "Materials: a file, a preset, or from the histogram.")
    surfaces: float | None = option("0..1", "Share of the materials' opacity that lies at their boundaries.")
    composite: Any = option(choices=(*get_args(Composite), *COMPOSITE_SYNONYMS))

    @property
    def operator(self) -> Composite | None:
        """Name of the operator; None leaves it to the look."""
        name: Composite | None = COMPOSITE_SYNONYMS.get(self.composite, self.composite)
        return name

    def check(self, colors: ColorOptions) -> None:
        """Raise if two looks are named, or one beside options of colours."""
        parsers.refuse_pairs(preset=self.preset, tf=self.tf)
        parsers.refuse_pairs(preset=self.preset, materials=self.materials)
        parsers.refuse_pairs(tf=self.tf, materials=self.materials)
        parsers.refuse_pairs(cmap=colors.cmap, materials=self.materials)
        if self.surfaces is not None and self.materials is None:
            raise ArgumentError("--surfaces are those between materials; give it with --materials")

    def look(self, volume: Volume | WaveletVolume, path: str, colors: ColorOptions, *, quiet: bool) -> Look:
        """The look that is named, or the one that suits the data. `path`: where the volume came from, for messages."""
        from wavesplat._looks.kinds.automatic import are_colored
        from wavesplat._looks.look import Look
        from wavesplat._render.arguments import chosen_look

        if self.materials is not None:
            function = _function_of_materials(volume, self.materials, self.surfaces)
            return Look(transfer_function=function, composite=self.operator or "over")
        if self._is_automatic and colors.name_a_map_alone and are_colored(volume, self.operator):
            return Look.auto(volume, self.operator, colormap=colors.cmap)
        is_projection = self.operator not in (None, "over", "first-hit")
        if colors.name_a_map or (is_projection and self._is_automatic and (colors.clim or colors.window)):
            # Greys of projections over a window are even from end to end, so that they can be read off.
            named = named_look(
                volume,
                preset=self.preset,
                tf=self.tf,
                colors=colors,
                opacity=1.0 if is_projection else "linear",
                quiet=quiet,
            )
            return chosen_look(named, volume, self.operator)
        named = named_look(volume, preset=self.preset, tf=self.tf, quiet=quiet)
        if named is not None:
            return colors.changed(chosen_look(named, volume, self.operator), volume)
        try:
            look = Look.auto(volume, self.operator)
        except ArgumentError as error:
            # Nothing on the command line is wrong: it is the data that give the histogram nothing to work with.
            raise FileError(f"{error}: {path}") from None
        return colors.changed(look, volume)

    @property
    def _is_automatic(self) -> bool:
        return self.preset in (None, "auto") and self.tf is None


def named_look(
    volume: Volume | WaveletVolume,
    *,
    preset: str | None,
    tf: Path | None,
    colors: ColorOptions | None = None,
    opacity: str | float = "linear",
    quiet: bool = False,
) -> Look | None:
    """The look of a preset, a file or a colour map; None if none is named, or `auto` is.

    Its warnings become notes. `opacity`: default of a colour map.
    """
    from wavesplat._looks.look import Look

    if colors is not None and colors.are_given() and (preset is not None or tf is not None):
        raise ArgumentError("--cmap and --log name a colour map, without --preset and --tf; give one look")
    with warnings_as_notes(quiet=quiet):
        if tf is not None:
            path, name = parsers.file_and_name(tf)
            return Look.load(path, volume, name)
        if colors is not None and colors.are_given():
            return colors.look(volume, opacity)
        return None if preset in (None, "auto") else Look.preset(preset, volume)


def function_of_histogram(volume: Volume | WaveletVolume, path: str) -> TransferFunction:
    """A transfer function for a first look, from the histogram. `path`: where the volume came from, for messages."""
    from wavesplat._looks.curves.transfer_function import TransferFunction

    try:
        return TransferFunction.auto(volume)
    except ArgumentError as error:
        # Nothing on the command line is wrong: it is the data that give the histogram nothing to work with.
        raise FileError(f"{error}: {path}") from None


def _function_of_materials(
    volume: Volume | WaveletVolume, given: str, surfaces: float | None
) -> TransferFunction | TransferFunction2D:
    """The mixture of materials from a file, by name, or from the histogram; with their surfaces if a share is given."""
    from wavesplat._looks.curves.materials import Materials

    if given == "fit":
        materials = Materials.fit(volume)
    else:
        materials = Materials.load(given) if given.endswith(".json") else Materials.preset(given)
    return materials.transfer_function() if surfaces is None else materials.surfaces(surfaces)


def exposure_of(options: LightOptions, own: Shading | None) -> float:
    """The factor of the light that an unlit look gives off, which `--exposure` is unless other options light it."""
    exposure = options.exposure
    return exposure if own is None and exposure is not None and given(options) == ["--exposure"] else 1.0


def chosen_shading(options: LightOptions, own: Shading | None) -> Shading | None:
    """A look's own shading, changed by the options; None without shading."""
    from wavesplat._looks.shading import Light, Shading

    asked = given(options)
    if not options.shading:
        if len(asked) > 1:
            others = ", ".join(name for name in asked if name != "--shading")
            raise ArgumentError(f"{others} are light; leave out --no-shading")
        return None
    if not asked or (own is None and asked == ["--exposure"]):
        return own
    if options.light == "headlight":
        base = Shading.headlight()
    elif own is None or options.light == "key":
        base = Shading()
    else:
        base = own
    terms = ("ambient", "diffuse", "specular", "specular_power", "exposure", "shadow", "gradient_smoothing")
    changes: dict[str, Any] = {name: getattr(options, name) for name in terms if getattr(options, name) is not None}
    if options.exposure is not None:
        changes["exposure"] = base.exposure * options.exposure
    if options.occlusion is not None:
        changes["ambient_occlusion"] = options.occlusion
    if isinstance(options.light, tuple):
        changes["lights"] = [Light(options.light)]
    return base.changed(**changes)
