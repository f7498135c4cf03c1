"""The visible layers of a scene: their looks, in the operator that all share, and their volumes, cut open.

Layers without a look get one by the kind of their data. Where there are several, channels of fluorescence have colours
that can be told apart: those of the file, or, where it has none or two are the same, `IN_SPACE`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import cycle
from typing import TYPE_CHECKING, Any, TypeAlias

from wavesplat import _native
from wavesplat._geometry.slice_plane import CUTS
from wavesplat._looks.automatic import automatic, tinted
from wavesplat._looks.blocks import is_block
from wavesplat._looks.brain import brain_of
from wavesplat._looks.channel_colors import CHANNEL_COLORS, Rgb, color_of, distinct_colors
from wavesplat._looks.default_colors import label_color
from wavesplat._looks.kinds import kind_of
from wavesplat._looks.labels import Label, Labels
from wavesplat._looks.lazy_tables import without_table_in_parts
from wavesplat._looks.look import Look
from wavesplat._looks.overlays import MAPPED_KINDS, OVERLAY_MAPS, cleared, mapped
from wavesplat._looks.tables import PROCESSING as TABLE_LEFT_OUT
from wavesplat._looks.tables import without_table
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat._model.composites import Operator
from wavesplat._model.cutting import Boxes, in_samples_of
from wavesplat._model.few_slices import is_thin
from wavesplat._model.lazy_changes import compare
from wavesplat._model.lazy_volume import LazyVolume
from wavesplat._model.options import Composite
from wavesplat._model.series import Series
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._readers.single_planes import is_single_plane
from wavesplat._render.arguments import chosen_look, cut_open
from wavesplat._render.framing import Part
from wavesplat._render.opened import can_be_cut_open, cut_open_from, note_on_block
from wavesplat._render.tables import LEFT_OUT, note_on_table
from wavesplat._scene.drawn_color import DrawnColor, check_operator, check_rows, drawn_color, labels_by_field
from wavesplat._scene.layer_notes import note_on_brain
from wavesplat._scene.resampling import check_units, is_oblique, on_axes_of
from wavesplat._scene.slice_cards import SliceLayer, SliceSource
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.shading import Shading
    from wavesplat._render.lazy_layers import LazyLayers
    from wavesplat._scene.layer import AnyLook, Layer
    from wavesplat._scene.scene import Scene

__all__ = [
    "Curves",
    "DrawnLayer",
    "DrawnLayers",
    "colors_of",
    "drawn_layers",
    "drawn_volumes",
    "for_module",
    "identity_of",
    "is_automatic",
    "look_over_others",
    "looks_beside_each_other",
    "notes_on_parts",
    "operator_name",
    "seen_parts",
    "slice_source",
    "sources_of",
]

Curves: TypeAlias = TransferFunction | TransferFunction2D

#: Conventional colours -> lighter ones, for pictures in space.
IN_SPACE: dict[Rgb, Rgb] = dict(
    zip(
        CHANNEL_COLORS,
        (
            (0.35, 1.0, 0.45),
            (1.0, 0.35, 0.95),
            (0.3, 0.9, 1.0),
            (1.0, 0.9, 0.3),
            (1.0, 0.35, 0.3),
            (0.35, 0.5, 1.0),
            (1.0, 1.0, 1.0),
            (1.0, 0.6, 0.25),
        ),
        strict=True,
    )
)

DENSE = (
    "dense matter fills the volume up to its faces, and hides what is inside: --composite maximum shows the brightest "
    "of it, --cut-out +x-y+z opens it, and --slice-plane shows slices in space"
)


@dataclass(frozen=True)
class DrawnLayer:
    """A layer as it is drawn."""

    layer: Layer
    #: The layer's volume, and that volume as drawn: the part of the look, or without a table, on the first one's axes,
    #: with the boxes cut out.
    volume: Volume | WaveletVolume
    seen: Volume | WaveletVolume
    look: Look
    is_automatic: bool
    #: Boxes that are cut out of it.
    boxes: Boxes
    #: The field that colours it.
    color: DrawnColor | None = None

    @property
    def core(self) -> _native.Volume | _native.DecodedVolume:
        """The volume for the compiled module."""
        return self.seen._decoded(self.seen.left_out) if isinstance(self.seen, WaveletVolume) else self.seen._core

    @property
    def name(self) -> str:
        """Name of the layer in messages."""
        return self.layer.name or self.volume.name

    @property
    def opacity(self) -> float:
        """Factor of the layer's opacities; 0 if it is hidden."""
        return self.layer.opacity if self.layer.visible else 0.0

    @property
    def identity(self) -> object:
        """Identity of the layer's samples: another one when they change."""
        return identity_of(self.volume)

    def faded(self, function: TransferFunction | TransferFunction2D) -> TransferFunction | TransferFunction2D:
        """A transfer function with opacities multiplied by that of the layer."""
        if self.opacity == 1:
            return function
        if isinstance(function, TransferFunction2D):
            rgba = function.rgba.copy()
            rgba[..., 3] *= self.opacity
            return function._with_rgba(rgba)
        nodes = [(value, self.opacity * alpha) for value, alpha in function.opacity]
        return TransferFunction(nodes, function.color, function.opacity_unit, function.gradient_opacity)


def identity_of(volume: Volume | WaveletVolume) -> tuple[object, int]:
    """Identity of a volume's samples: another one after a change, since `Volume.changed` makes the core anew."""
    if isinstance(volume, LazyVolume):
        return volume._identity
    return (volume._core if isinstance(volume, Volume) else volume), 0


def slice_source(scene: Scene) -> SliceSource:
    """The volume, clips and labels that slices in a scene show."""
    first = scene.layers[0].drawn
    has_cuts = any(getattr(shape, "plane", None) == CUTS and shape._is_seen for shape in scene.geometry)
    over, part = (_over_first(scene), _part_of_first(scene)) if has_cuts else ((), first)
    return SliceSource(first, identity_of(first), scene._clipping, scene.labels, over, part, identity_of(part))


def _part_of_first(scene: Scene) -> Volume | WaveletVolume:
    """The first layer's volume as drawn, without the boxes that are cut out of it."""
    first = scene.layers[0]
    look = _kept_look(scene, first, None)
    return _part(scene, first, first.drawn, look, is_tableless=not scene.keep_table)


def _over_first(scene: Scene) -> tuple[SliceLayer, ...]:
    """The layers that lie over the first one on slices on cuts; none over channels."""
    if len(scene.layers) == 1:
        return ()
    shown = drawn_layers(scene, "over")
    if not shown.layers or shown.layers[0].look.name == "channel":
        return ()
    return tuple(
        SliceLayer(layer.volume, layer.identity, layer.look.transfer_function, layer.opacity)
        for layer in shown.layers[int(shown.has_first) :]
        if isinstance(layer.look.transfer_function, TransferFunction) and layer.opacity > 0
    )


def drawn_volumes(scene: Scene) -> list[Volume | WaveletVolume]:
    """The volumes of the visible layers, and of the fields that colour them."""
    shown = [layer for layer in scene.layers if layer.is_shown]
    fields = [layer.color_from for layer in shown if layer.color_from is not None]
    return [layer.drawn for layer in (*shown, *fields)]


def operator_name(looks: Sequence[Look]) -> Composite:
    """The operator that looks have in common: "over" if one of them has it."""
    names = list(dict.fromkeys(look.composite for look in looks))
    if "over" in names or not names:
        return "over"
    if len(names) > 1:
        raise ArgumentError(
            f"the looks of the layers are for {' and '.join(map(repr, names))}; say which with composite="
        )
    return names[0]


@dataclass(frozen=True)
class DrawnLayers:
    """Visible layers, the operator that all are drawn with, and the volume whose samples boxes are given in."""

    layers: list[DrawnLayer]
    composite: Composite
    first: Volume | WaveletVolume

    @property
    def resampled(self) -> list[str]:
        """Names of layers that were resampled, since their axes are none of the first one's."""
        return [layer.name for layer in self.layers if is_oblique(layer.volume, self.layers[0].volume)]

    @property
    def has_first(self) -> bool:
        """Whether the scene's first layer is the first of these."""
        return bool(self.layers) and self.layers[0].volume is self.first


def drawn_layers(scene: Scene, composite: Composite | None) -> DrawnLayers:
    """The layers of a scene that are drawn.

    The first layer is among them, with an opacity of 0, where it is not seen and the scene has labels, which lie on it.
    """
    layers = [
        layer
        for number, layer in enumerate(scene.layers)
        if layer.is_shown or (number == 0 and scene.labels is not None)
    ]
    volumes = [layer.drawn for layer in layers]
    fields = [layer.color_from.drawn for layer in layers if layer.color_from is not None]
    # Changed files are found before kept looks are used, which were chosen for the samples as they were.
    compare([*volumes, *fields])
    if flat := next((volume for volume in volumes if is_single_plane(volume)), None):
        raise ArgumentError(
            f"{flat.name!r} is a single picture, or a film, and fills no space; `wavesplat slice` shows it "
            "(wavesplat.slice), and `wavesplat movie` a film (wavesplat.movie)"
        )
    first = volumes[0] if layers and layers[0] is scene.layers[0] else scene.layers[0].drawn
    check_units([*volumes, *fields])
    # Two fields are drawn as matter where nothing else is said.
    looks = [_kept_look(scene, layer, composite or ("over" if layer.color_from else None)) for layer in layers]
    name = composite or operator_name(looks)
    if len(layers) > 1:
        looks = looks_beside_each_other(scene, layers, name, looks)
    shown = []
    for layer, volume, look in zip(layers, volumes, looks, strict=True):
        look = _with_own_labels(scene, layer, volume, look)  # noqa: PLW2901 - the look of this time
        drawn = _part(scene, layer, volume, look, is_tableless=name != "minimum" and not scene.keep_table)
        placed = on_axes_of(drawn, volumes[0])
        boxes = in_samples_of(placed, scene._clipping.boxes, first)
        look, color = _by_field(scene, layer, volume, look, volumes[0])  # noqa: PLW2901
        check_rows(layer, look)
        check_operator(layer, name)
        seen = cut_open(placed, boxes)
        shown.append(DrawnLayer(layer, volume, seen, look, is_automatic(layer), boxes, color))
    return DrawnLayers(shown, name, first)


def looks_beside_each_other(
    scene: Scene, layers: Sequence[Layer], composite: Composite, looks: Sequence[Look] | None = None
) -> list[Look]:
    """The looks of layers that are drawn together with one operator. `looks`: those that each has alone."""
    alone = [_kept_look(scene, layer, composite) for layer in layers] if looks is None else list(looks)
    for k, layer in enumerate(layers):
        has_labels_elsewhere = alone[k].labels is not None and layer.volume is not scene.layers[0].volume
        if alone[k].composite != composite or has_labels_elsewhere:
            alone[k] = _kept_look(scene, layer, composite)
    alone = _with_distinct_colors(scene, layers, alone, composite)
    return _over_others(scene, layers, alone, composite)


def _by_field(
    scene: Scene, layer: Layer, volume: Volume | WaveletVolume, look: Look, first: Volume | WaveletVolume
) -> tuple[Look, DrawnColor | None]:
    """The look of a layer, and the field that colours it, with its own look; labels have the colours of its means."""
    field = layer.color_from
    if field is None:
        return look, None
    if look.labels is None:
        return look, drawn_color(layer, volume, _kept_look(scene, field, "over"), first)
    given = None if is_automatic(field) else _kept_look(scene, field, "over")
    key = (id(volume), "labels by a field", id(look.labels), id(field.drawn), id(field.look))
    find = partial(labels_by_field, layer, look.labels, given)
    labels, of_field = scene._cache.get_or_compute(key, (identity_of(volume), identity_of(field.drawn)), find)
    return replace(look, labels=labels), drawn_color(layer, volume, of_field, first)


def _part(
    scene: Scene, layer: Layer, volume: Volume | WaveletVolume, look: Look, *, is_tableless: bool
) -> Volume | WaveletVolume:
    """The part of the volume that is drawn: that of the look, or all but a CT's table; all where it is not found."""
    if look.part == "brain":
        found = brain_of(volume)
        return volume if isinstance(found, str) else found
    if look.part == "cut open":
        find = partial(cut_open_from, volume, look.view)
        return scene._cache.get_or_compute((id(volume), "cut open", look.view), identity_of(volume), find)
    if not is_tableless:
        return volume
    if isinstance(volume, LazyVolume | WaveletVolume):
        return _part_of_parts(scene, volume, layer.looked_at if isinstance(layer.volume, Series) else volume, look)
    decided_by = layer.looked_at if isinstance(layer.volume, Series) else volume
    return without_table(volume, decided_by if isinstance(decided_by, Volume) else None) or volume


def _part_of_parts(
    scene: Scene, volume: LazyVolume | WaveletVolume, decided_on: Volume | WaveletVolume, look: Look
) -> Volume | WaveletVolume:
    """The same of samples that are read or decoded as they are drawn, of which more are needed to tell a table."""
    if note_on_table(decided_on, look.transfer_function) is None:
        return volume
    key: Any = id(volume), "without table", id(decided_on)
    find = partial(without_table_in_parts, volume, decided_on)
    return scene._cache.get_or_compute(key, identity_of(volume), find) or volume


def seen_parts(scene: Scene, look: Look) -> list[Part]:
    """The volumes as drawn, and their looks; the look of the first layer is `look`, whatever its own."""
    layers = drawn_layers(scene, look.composite).layers
    return [(layer.seen, look if number == 0 else layer.look) for number, layer in enumerate(layers)]


def _with_own_labels(scene: Scene, layer: Layer, volume: Volume | WaveletVolume, look: Look) -> Look:
    """The automatic look of a segmentation, with the labels of its own time, where it was chosen for a series."""
    if look.labels is None or look.name != "auto" or not isinstance(layer.volume, Series):
        return look
    known = look.labels.labels

    def labels_of_time() -> Labels:
        own = Labels(volume)
        # A number has one colour at all times, whichever others are there.
        looks = {n: known.get(n) or Label(label_color(n - 1), name=str(n)) for n in own.labels}
        return Labels(volume, looks)

    key = (id(volume), "labels", id(look.labels))
    return replace(look, labels=scene._cache.get_or_compute(key, identity_of(volume), labels_of_time))


def is_automatic(layer: Layer) -> bool:
    """Whether the look of a layer is chosen by the kind of data."""
    return layer.look is None or (isinstance(layer.look, str) and layer.look.lower() == "auto")


def _kept_look(scene: Scene, layer: Layer, composite: Composite | None) -> Look:
    """The look of a layer; one that is chosen by a volume's values is chosen once."""
    volume = layer.looked_at
    if not (layer.look is None or isinstance(layer.look, str)):
        return chosen_look(layer.look, volume, composite)
    key = id(volume), layer.look, composite
    return scene._cache.get_or_compute(key, identity_of(volume), lambda: chosen_look(layer.look, volume, composite))


def _with_distinct_colors(
    scene: Scene,
    layers: Sequence[Layer],
    looks: Sequence[Look],
    composite: Composite,
) -> list[Look]:
    """The looks with distinct colours for channels of fluorescence and, in projections, for all without a look."""
    is_drawn_in_space = composite in ("over", "first-hit")
    chosen = [
        k
        for k, layer in enumerate(layers)
        if is_automatic(layer) and not (is_drawn_in_space and kind_of(layer.looked_at) != "fluorescence")
    ]
    facts = [layers[k].looked_at.facts for k in chosen]
    own = [color_of(one.channel, one.channels) for one in facts]
    made = list(looks)
    for k, found, its_own in zip(chosen, distinct_colors([None] * len(chosen), own), own, strict=True):
        volume, color = layers[k].looked_at, found if found == its_own else IN_SPACE[found]
        key: Any = id(volume), "color", composite, color
        find = partial(_colored, volume, made[k], composite, color)
        made[k] = scene._cache.get_or_compute(key, identity_of(volume), find)
    return made


def _over_others(scene: Scene, layers: Sequence[Layer], looks: Sequence[Look], composite: Composite) -> list[Look]:
    """The looks, those of further layers clear where their values are least, so that they do not hide the rest."""
    made, maps = list(looks), cycle(OVERLAY_MAPS)
    for k, layer in enumerate(layers):
        if layer is scene.layers[0]:
            continue
        volume = layer.looked_at
        if not is_automatic(layer):
            made[k] = _cleared(scene, layer, composite)
        elif composite == "over" and (kind := kind_of(volume)) in MAPPED_KINDS:
            colormap = next(maps)
            # Bone hides less than all tissue of a CT in a colour map does.
            if kind != "CT":
                key: Any = id(volume), "over others", colormap
                find = partial(_mapped, volume, made[k], colormap)
                made[k] = scene._cache.get_or_compute(key, identity_of(volume), find)
    return made


def _cleared(scene: Scene, layer: Layer, composite: Composite) -> Look:
    """The look that a further layer was given, clear where its values are least; a preset's is found once."""
    volume, given = layer.looked_at, layer.look
    if not isinstance(given, str):
        return look_over_others(given, volume, composite)
    key: Any = id(volume), "cleared", given, composite
    find = partial(look_over_others, given, volume, composite)
    return scene._cache.get_or_compute(key, identity_of(volume), find)


def look_over_others(given: AnyLook, volume: Volume | WaveletVolume, composite: Composite) -> Look:
    """The look that is given to a volume over another one, clear where the values are least; see `overlays.cleared`."""
    look = chosen_look(given, volume, composite)
    # Automatic looks are chosen for the operator.
    if not isinstance(given, Look | str) or (isinstance(given, str) and given.lower() == "auto"):
        return look
    made_for = chosen_look(given, volume, None)
    return replace(look, transfer_function=cleared(made_for, volume, composite).transfer_function)


def _mapped(volume: Volume | WaveletVolume, look: Look, colormap: str) -> Look:
    """The automatic look of a volume over another one: a colour map, without light."""
    return replace(look, transfer_function=mapped(volume, colormap), shading=None, background=None)


def _colored(volume: Volume | WaveletVolume, look: Look, composite: Composite, color: Rgb) -> Look:
    """The automatic look of a volume, in a colour."""
    if composite in ("over", "first-hit"):
        return automatic(volume, composite, color)
    return replace(look, transfer_function=tinted(look.transfer_function, color))


# Notes on layers that are drawn in part.


def notes_on_parts(scene: Scene, layers: Sequence[DrawnLayer]) -> list[str]:
    """Notes on layers that are drawn in part, or whose look asks for a part."""
    asked = [layer for layer in layers if layer.look.part == "brain"]
    notes = [note_on_brain(layer.name, layer.seen, _why_no_brain(layer)) for layer in asked]
    is_left_out = any(TABLE_LEFT_OUT in layer.seen.facts.processing for layer in layers)
    cut = {can_be_cut_open(layer.volume) for layer in layers if layer.look.part == "cut open"}
    is_dense = any(_is_dense(scene, layer) for layer in layers)
    return [
        *notes,
        *([LEFT_OUT] if is_left_out else []),
        *(note_on_block(is_cut=is_cut) for is_cut in sorted(cut)),
        *([DENSE] if is_dense else []),
    ]


def _is_dense(scene: Scene, layer: DrawnLayer) -> bool:
    """Whether an automatic look of microscopy shows only the outer faces of a volume, so that its inside is hidden."""
    volume, look = layer.volume, layer.look
    if not (layer.is_automatic and look.composite == "over" and layer.opacity > 0) or is_thin(volume):
        return False

    def found() -> bool:
        function = look.transfer_function
        if not isinstance(function, TransferFunction) or kind_of(volume) not in ("EM", "fluorescence"):
            return False
        return is_block(volume, function)

    return scene._cache.get_or_compute((id(volume), "dense", look.transfer_function), layer.identity, found)


def _why_no_brain(layer: DrawnLayer) -> str | None:
    """Why no brain was found for a look that draws the brain alone; None if one was found or none is drawn."""
    found = brain_of(layer.volume) if layer.look.part == "brain" else None
    return found if isinstance(found, str) else None


# Sources of samples: the layers, and after them the fields that colour layers, in the order of these.


def sources_of(layers: Sequence[DrawnLayer]) -> list[Volume | WaveletVolume]:
    """The volumes as drawn."""
    return [layer.seen for layer in layers] + [layer.color.seen for layer in layers if layer.color is not None]


def colors_of(
    layers: Sequence[DrawnLayer], functions: Sequence[Curves], operator: Operator
) -> list[TransferFunction | None]:
    """The transfer function of the field that colours each layer; None without one."""
    pairs = zip(layers, functions, strict=True)
    return [None if layer.color is None else layer.color.function_at(function, operator) for layer, function in pairs]


def for_module(
    layers: Sequence[DrawnLayer],
    functions: Sequence[Curves],
    lights: Sequence[Shading | None],
    colors: Sequence[TransferFunction | None],
    lazy: LazyLayers | None,
) -> list[tuple[Any, Any, Any, Any]]:
    """The layers for the compiled module: volume, transfer function, light, and the field that colours it."""
    if lazy is not None:
        return lazy.for_module(functions, lights, colors)
    fields = [
        None if layer.color is None or color is None else (layer.color.seen._core, color._core)
        for layer, color in zip(layers, colors, strict=True)
    ]
    return [
        (layer.core, function._core, None if light is None else light._core, field)
        for layer, function, light, field in zip(layers, functions, lights, fields, strict=True)
    ]
