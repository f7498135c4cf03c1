"""The visible layers of a scene as they are drawn: volumes, looks, and the operator that all share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

from wavesplat import _native
from wavesplat._geometry.slice_plane import CUTS
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.operators import Operator
from wavesplat._model.arguments.sampling import Composite
from wavesplat._model.lazy.checks import compare
from wavesplat._model.volume.cutting import Boxes, in_samples_of
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._readers.single_planes import is_single_plane
from wavesplat._render.arguments import (
    cut_open,
)
from wavesplat._render.framing import Part
from wavesplat._render.lazy_layers import LazyLayers
from wavesplat._scene.drawing.drawn_color import DrawnColor, check_operator, check_rows, drawn_color, labels_by_field
from wavesplat._scene.drawing.looks_of_layers import (
    is_automatic,
    kept_look,
    looks_beside_each_other,
    operator_name,
    with_own_labels,
)
from wavesplat._scene.drawing.resampling import check_units, is_oblique, on_axes_of
from wavesplat._scene.drawing.volumes_of_layers import identity_of, part_of
from wavesplat._scene.slices.cards import SliceLayer, SliceSource
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.shading import Shading
    from wavesplat._render.lazy_layers import LazyLayers
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.scene import Scene

Curves: TypeAlias = TransferFunction | TransferFunction2D


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
        """A transfer function with opacities multiplied by the layer's opacity."""
        if self.opacity == 1:
            return function
        if isinstance(function, TransferFunction2D):
            rgba = function.rgba.copy()
            rgba[..., 3] *= self.opacity
            return function._with_rgba(rgba)
        nodes = [(value, self.opacity * alpha) for value, alpha in function.opacity]
        return TransferFunction(nodes, function.color, function.opacity_unit, function.gradient_opacity)


def slice_source(scene: Scene) -> SliceSource:
    """The volume, clips and labels that slices in a scene show."""
    first = scene.layers[0].drawn
    has_cuts = any(getattr(shape, "plane", None) == CUTS and shape._is_seen for shape in scene.geometry)
    over, part = (_over_first(scene), _part_of_first(scene)) if has_cuts else ((), first)
    return SliceSource(first, identity_of(first), scene._clipping, scene.labels, over, part, identity_of(part))


def _part_of_first(scene: Scene) -> Volume | WaveletVolume:
    """The first layer's volume as drawn, without the boxes that are cut out of it."""
    first = scene.layers[0]
    look = kept_look(scene, first, None)
    return part_of(scene, first, first.drawn, look, is_tableless=not scene.keep_table)


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
    looks = [kept_look(scene, layer, composite or ("over" if layer.color_from else None)) for layer in layers]
    name = composite or operator_name(looks)
    if len(layers) > 1:
        looks = looks_beside_each_other(scene, layers, name, looks)
    shown = []
    for layer, volume, look in zip(layers, volumes, looks, strict=True):
        look = with_own_labels(scene, layer, volume, look)  # noqa: PLW2901 - the look of this time
        drawn = part_of(scene, layer, volume, look, is_tableless=name != "minimum" and not scene.keep_table)
        placed = on_axes_of(drawn, volumes[0])
        boxes = in_samples_of(placed, scene._clipping.boxes, first)
        look, color = _by_field(scene, layer, volume, look, volumes[0])  # noqa: PLW2901
        check_rows(layer, look)
        check_operator(layer, name)
        seen = cut_open(placed, boxes)
        shown.append(DrawnLayer(layer, volume, seen, look, is_automatic(layer), boxes, color))
    return DrawnLayers(shown, name, first)


def _by_field(
    scene: Scene, layer: Layer, volume: Volume | WaveletVolume, look: Look, first: Volume | WaveletVolume
) -> tuple[Look, DrawnColor | None]:
    """The look of a layer, and the field that colours it, with its own look; labels have the colours of its means."""
    field = layer.color_from
    if field is None:
        return look, None
    if look.labels is None:
        return look, drawn_color(layer, volume, kept_look(scene, field, "over"), first)
    given = None if is_automatic(field) else kept_look(scene, field, "over")
    key = (id(volume), "labels by a field", id(look.labels), id(field.drawn), id(field.look))
    find = partial(labels_by_field, layer, look.labels, given)
    labels, of_field = scene._cache.get_or_compute(key, (identity_of(volume), identity_of(field.drawn)), find)
    return replace(look, labels=labels), drawn_color(layer, volume, of_field, first)


def seen_parts(scene: Scene, look: Look) -> list[Part]:
    """The volumes as drawn, and their looks; the look of the first layer is `look`, whatever its own."""
    layers = drawn_layers(scene, look.composite).layers
    return [(layer.seen, look if number == 0 else layer.look) for number, layer in enumerate(layers)]


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
