"""The looks of a scene's layers, in the operator that all share.

Layers without a look get one by the kind of their data. Where there are several, channels of fluorescence have colours
that can be distinguished: the colours of the file, or, where it has none or two are the same, `IN_SPACE`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import cycle
from typing import TYPE_CHECKING, Any

from wavesplat import _native
from wavesplat._looks.kinds.automatic import automatic, tinted
from wavesplat._looks.kinds.channel_colors import color_of
from wavesplat._looks.kinds.kinds import kind_of
from wavesplat._looks.kinds.overlays import MAPPED_KINDS, OVERLAY_MAPS, cleared, mapped
from wavesplat._looks.labels.labels import Label, Labels
from wavesplat._looks.look import Look
from wavesplat._model.arguments.sampling import Composite
from wavesplat._model.volume.facts import Rgb
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._render.arguments import (
    chosen_look,
)
from wavesplat._scene.drawing.volumes_of_layers import identity_of
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._scene.layer import AnyLook, Layer
    from wavesplat._scene.scene import Scene

#: Conventional colours -> lighter ones, for pictures in space.
IN_SPACE: dict[Rgb, Rgb] = dict(zip(_native.CHANNEL_COLORS, _native.CHANNEL_COLORS_IN_SPACE, strict=True))


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


def is_automatic(layer: Layer) -> bool:
    """Whether the look of a layer is chosen by the kind of data."""
    return layer.look is None or (isinstance(layer.look, str) and layer.look.lower() == "auto")


def kept_look(scene: Scene, layer: Layer, composite: Composite | None) -> Look:
    """The look of a layer; one that is chosen by a volume's values is chosen once."""
    volume = layer.looked_at
    if not (layer.look is None or isinstance(layer.look, str)):
        return chosen_look(layer.look, volume, composite)
    key = id(volume), layer.look, composite
    return scene._cache.get_or_compute(key, identity_of(volume), lambda: chosen_look(layer.look, volume, composite))


def with_own_labels(scene: Scene, layer: Layer, volume: Volume | WaveletVolume, look: Look) -> Look:
    """The automatic look of a segmentation, with the labels of its own time, where it was chosen for a series."""
    if look.labels is None or look.name != "auto" or not isinstance(layer.volume, Series):
        return look
    known = look.labels.labels

    def labels_of_time() -> Labels:
        own = Labels(volume)
        # A number has one colour at all times, whichever others are there.
        looks = {n: known.get(n) or Label(_native.label_color(n - 1), name=str(n)) for n in own.labels}
        return Labels(volume, looks)

    key = (id(volume), "labels", id(look.labels))
    return replace(look, labels=scene._cache.get_or_compute(key, identity_of(volume), labels_of_time))


def looks_beside_each_other(
    scene: Scene, layers: Sequence[Layer], composite: Composite, looks: Sequence[Look] | None = None
) -> list[Look]:
    """The looks of layers that are drawn together with one operator. `looks`: those that each has alone."""
    alone = [kept_look(scene, layer, composite) for layer in layers] if looks is None else list(looks)
    for k, layer in enumerate(layers):
        has_labels_elsewhere = alone[k].labels is not None and layer.volume is not scene.layers[0].volume
        if alone[k].composite != composite or has_labels_elsewhere:
            alone[k] = kept_look(scene, layer, composite)
    alone = _with_distinct_colors(scene, layers, alone, composite)
    return _over_others(scene, layers, alone, composite)


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
    for k, found, its_own in zip(chosen, _native.distinct_colors([None] * len(chosen), own), own, strict=True):
        volume, color = layers[k].looked_at, found if found == its_own else IN_SPACE[found]
        key: Any = id(volume), "color", composite, color
        find = partial(_colored, volume, made[k], composite, color)
        made[k] = scene._cache.get_or_compute(key, identity_of(volume), find)
    return made


def _over_others(scene: Scene, layers: Sequence[Layer], looks: Sequence[Look], composite: Composite) -> list[Look]:
    """The looks; looks of further layers are clear where values are least, so that they do not hide the rest."""
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
