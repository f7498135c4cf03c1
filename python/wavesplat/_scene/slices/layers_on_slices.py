"""Layers on a slice: values in the colours of a look, segmentations, and channels of fluorescence."""

from __future__ import annotations

from itertools import pairwise, takewhile
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds.channel_light import ChannelLight, light_of
from wavesplat._looks.kinds.kinds import kind_of, unit_of_values
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.look import Look
from wavesplat._model.volume.facts import is_part_of_color
from wavesplat._picture.report_facts import shown_layer
from wavesplat._render.slicing import Planes
from wavesplat._scene.drawing.looks_of_layers import is_automatic, looks_beside_each_other
from wavesplat._scene.drawing.volumes_of_layers import identity_of
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene

# The values of a volume over a slice of another one, in the colours of their look.

Floats: TypeAlias = NDArray[np.float32]

#: Pixels that are mixed at once: their colours, in float64, take little memory.
PIXELS_AT_ONCE = 1 << 18


def values_laid_over(rgba: Floats, values: Floats, curves: TransferFunction, opacity: float) -> tuple[Floats, bool]:
    """The picture with the colours of values laid over it, and whether they show anywhere."""
    most = max(alpha for _, alpha in curves.opacity)
    mixed, is_seen = np.array(rgba), False
    if most == 0:
        return mixed, False
    lowest = clear_below(curves)
    rows = max(1, PIXELS_AT_ONCE // values.shape[1])
    for start in range(0, len(values), rows):
        part, below = values[start : start + rows], mixed[start : start + rows]
        over = curves(part.ravel()).reshape(*part.shape, 4)
        seen = np.isfinite(part) & (part >= lowest) & (over[..., 3] > 0)
        alpha = np.where(seen, opacity * over[..., 3] / most, 0.0)[..., None]
        over[..., 3] = 1.0
        below[:] = np.where(seen[..., None], over * alpha + (1 - alpha) * below, below)
        is_seen = is_seen or bool(seen.any())
    return mixed, is_seen


def clear_below(curves: TransferFunction) -> float:
    """The value below which nothing shows: the low end, unless less is more there, as in maps of two signs."""
    alphas = [alpha for _, alpha in curves.opacity]
    if any(low > high for low, high in pairwise(alphas)):
        return -np.inf
    return min(node[0] for node in (*curves.opacity, *curves.color))


# A segmentation over a slice: every label's colour, faint inside and full along its outline.

#: Opacity of a label's inside, as a share of its outline's: the scan shows through.
FILL = 0.4


def labels_laid_over(rgba: NDArray[np.float32], planes: Planes, labels: Labels) -> tuple[NDArray[np.float32], set[int]]:
    """A slice with the labels of the samples next to its middle plane, and the numbers of these.

    Outlines are as opaque as labels in space.

    labels : on samples in the scan's order of axes, as `Labels.for_slices_of` gives them.
    """
    codes = codes_at(planes, labels)
    shares, colors = colors_of_labels(labels)
    edge = np.zeros(codes.shape, bool)
    for one, other in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        differs = codes[one] != codes[other]
        edge[one] |= differs
        edge[other] |= differs
    alpha = (shares[codes] * np.where(edge, 1.0, FILL))[..., None]
    over = np.concatenate([colors[codes], np.ones((*codes.shape, 1))], axis=2)
    mixed: NDArray[np.float32] = (over * alpha + (1 - alpha) * rgba).astype(np.float32)
    seen = {labels.numbers[code] for code in np.unique(codes).tolist() if code < len(labels.numbers)}
    return mixed, seen


def colored(rgba: NDArray[np.float32], planes: Planes, labels: Labels) -> tuple[NDArray[np.float32], set[int]]:
    """A slice of a segmentation in the colours of its labels, black where there is none, and the numbers of these."""
    codes = codes_at(planes, labels)
    shares, colors = colors_of_labels(labels)
    is_label = (shares[codes] > 0)[..., None]
    black = np.array([0, 0, 0, 1]) * (rgba[..., 3:] > 0)
    opaque = np.concatenate([colors[codes], np.ones((*codes.shape, 1))], axis=2)
    is_inside = (codes < len(labels.numbers))[..., None]
    shown = np.where(is_label, opaque, np.where(is_inside, black, rgba)).astype(np.float32)
    return shown, {labels.numbers[code] for code in np.unique(codes).tolist() if code < len(labels.numbers)}


def colors_of_labels(labels: Labels) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Opacities of outlines, and colours, shape (n, 3), by the codes of `codes_at`; the last is for pixels outside."""
    looks = [labels.labels.get(number) for number in labels.numbers]
    shares = np.array([0.0 if look is None else max(look.opacity, look.tint) for look in looks] + [0.0])
    colors = np.array([(0.0,) * 3 if look is None else look.color for look in looks] + [(0.0,) * 3])
    return shares, colors


def codes_at(planes: Planes, labels: Labels) -> NDArray[np.intp]:
    """Index of the label's number in `Labels.numbers` for every pixel; one more than the last outside their samples."""
    cut, frame = planes.cut, planes.frame
    assert labels.world_from_index is not None
    to_index = np.linalg.inv(labels.world_from_index)
    first = to_index[:3, :3] @ frame.origin + to_index[:3, 3]
    across, down = (to_index[:3, :3] @ (frame.pixel * way) for way in (cut.right, -cut.up))
    width, height = frame.size
    codes = np.full((height, width), len(labels.numbers), np.intp)
    rows_at_once = max(1, PIXELS_AT_ONCE // width)
    for start in range(0, height, rows_at_once):
        rows = np.arange(start, min(start + rows_at_once, height))[:, None]
        columns = np.arange(width)[None, :]
        x, y, z = (np.rint(first[a] + columns * across[a] + rows * down[a]).astype(np.intp) for a in range(3))
        n_z, n_y, n_x = labels.shape
        inside = (x >= 0) & (x < n_x) & (y >= 0) & (y < n_y) & (z >= 0) & (z < n_z)
        codes[rows[:, 0]] = np.where(
            inside, labels._codes[z.clip(0, n_z - 1), y.clip(0, n_y - 1), x.clip(0, n_x - 1)], len(labels.numbers)
        )
    return codes


# Slices of fluorescence channels: each in its colour over its window, all of them added, as light is.

#: Layers that are channels, and their light.
Channels: TypeAlias = "list[tuple[Layer, ChannelLight]]"


def channels_of(scene: Scene) -> Channels:
    """The first layers of a scene as far as they are channels; none where there is one, which is shown in grey.

    A channel has a look of `Look.channel`, or is fluorescence without a look, in the colour that it has in space.
    """
    if len(scene.layers) == 1:
        return []
    found = takewhile(lambda one: one[1] is not None, ((layer, _light(scene, layer)) for layer in scene.layers))
    channels = [(layer, light) for layer, light in found if light is not None]
    return channels if len(channels) > 1 else []


def automatic_fluorescence(scene: Scene, layer: Layer) -> Look | None:
    """The look that a channel without a look has in space, beside the others; None of other layers.

    Channels are fluorescence, and the red, green and blue of colour pictures.
    """
    if not is_automatic(layer):
        return None
    volume = layer.looked_at
    if is_part_of_color(volume.facts):
        key = (id(volume), "part of a colour")
        return scene._cache.get_or_compute(key, identity_of(volume), lambda: Look.channel(volume))
    kind = scene._cache.get_or_compute((id(volume), "kind"), identity_of(volume), lambda: kind_of(volume))
    if kind != "fluorescence":
        return None
    shown = [one for one in scene.layers if one.is_shown or one is layer]
    return looks_beside_each_other(scene, shown, "over")[next(n for n, one in enumerate(shown) if one is layer)]


def added(behind: Floats, planes: Planes, channels: Channels, **options: Any) -> tuple[Floats, list[dict[str, Any]]]:
    """The light of channels added over black, where one of them has values, else `behind`; and the report's entries.

    behind : associated RGBA, shape (height, width, 4).
    options : kernel, slab and threads, as for `wavesplat.slice`.
    """
    light = np.zeros((*behind.shape[:2], 3), np.float32)
    has_values = np.zeros(behind.shape[:2], bool)
    entries = []
    for layer, own in channels:
        if not layer.is_shown:
            continue
        values = planes.values_of(layer.drawn, **options)
        known = np.isfinite(values)
        light[known] += np.float32(layer.opacity) * own.curve(values[known])[:, :3].astype(np.float32)
        has_values |= known
        name = layer.name or layer.drawn.name
        entries.append(shown_layer(name, "over", own.curve, unit_of_values(layer.drawn)))
    rgba = np.array(behind)
    rgba[has_values, :3] = np.minimum(light[has_values], 1.0)
    rgba[has_values, 3] = 1.0
    return rgba, entries


def _light(scene: Scene, layer: Layer) -> ChannelLight | None:
    """The light of a layer that is a channel."""
    look = layer.look if isinstance(layer.look, Look) else automatic_fluorescence(scene, layer)
    return None if look is None else light_of(look)
