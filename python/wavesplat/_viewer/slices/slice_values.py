"""The values of a slice, sent once: the page gives them colours, so that window and level change at display rate.

Values are whole numbers of 16 bits: `low + code * step`, and no value at code 65535. The step is a power of two, the
least one with which the slice's range fits, so whole numbers stay whole, and a window of a 500th of the range is still
shown within a grey level. Each row is stored as differences from left to right, low and high bytes apart, all of it
deflated: a slice of a CT takes about as much as its PNG. `web/src/engine/slice_values.ts` is the twin.

What the page draws of them is `wavesplat.slice`'s picture within a grey level.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import cycle
from math import ceil, floor, log2
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.kinds.overlays import OVERLAY_MAPS
from wavesplat._model.lazy.checks import compare
from wavesplat._render.slicing import Planes, place_of, planes_of
from wavesplat._scene.slices.layers_on_slices import channels_of, clear_below, codes_at, colors_of_labels
from wavesplat._scene.slices.slicing import curves_over
from wavesplat._viewer.session.state import ViewerState
from wavesplat._viewer.slices.slice_view import background_of, colors_of, slice_arguments

Codes: TypeAlias = NDArray[np.uint16]

#: Code of pixels without a value, and the largest code of a value.
NOTHING, MAX_CODE = 0xFFFF, 0xFFFE


@dataclass(frozen=True)
class SliceValues:
    """The values of a slice for the page.

    size : width and height, pixels. report : where the pixels lie, from `wavesplat.slice`.
    header : how values become colours: `SliceValuesHeader` in `web/src/engine/slice_values.ts`.
    payload : planes of 16 bits, in the order of the header's layers, then of the labels.
    """

    size: tuple[int, int]
    report: dict[str, Any]
    header: dict[str, Any]
    payload: bytes


def slice_values(state: ViewerState, pane: str, size: tuple[int, int]) -> SliceValues:
    """The values of a pane at rest."""
    scene, arguments = state.scene, slice_arguments(state, pane)
    first = scene.layers[0].drawn
    compare([layer.drawn for layer in scene.layers])
    planes = planes_of(
        first,
        arguments["plane"],
        arguments.get("position"),
        size=size,
        zoom=arguments["zoom"],
        center=arguments.get("center"),
        thickness=arguments["thickness"],
    )
    layers, coded = [], []
    for fields, values in _layers(state, planes):
        low, step, codes = _coded(values)
        layers.append({**fields, "low": low, "step": step})
        coded.append(codes)
    labels = None
    if scene.labels is not None:
        on_scan = scene.labels.for_slices_of(first)
        coded.append(codes_at(planes, on_scan).astype(np.uint16))
        shares, colors = colors_of_labels(on_scan)
        names = [(look.name if look else "") or str(n) for n in on_scan.numbers for look in [on_scan.labels.get(n)]]
        shown = [number != 0 or number in on_scan.labels for number in on_scan.numbers]
        labels = {
            "colors": [[float(share), *map(float, color)] for share, color in zip(shares, colors, strict=True)],
            "names": [name if is_one else None for name, is_one in zip(names, shown, strict=True)] + [None],
        }
    background = background_of(colors_of(state)) if layers[0]["kind"] == "window" else "black"
    header = {"layers": layers, "labels": labels, "background": [1.0 if background == "white" else 0.0] * 3}
    return SliceValues(size, place_of(planes, first), header, _packed(coded))


def _layers(state: ViewerState, planes: Planes) -> Iterator[tuple[dict[str, Any], NDArray[np.float32]]]:
    """Each layer that shows, and the first one: its number, its colours, and its values on the slice."""
    scene = state.scene
    options: Any = {"kernel": state.options["kernel"], "slab": state.view["slices"]["slab"], "threads": None}
    channels = channels_of(scene)
    automatic = iter(cycle(OVERLAY_MAPS))
    for number, layer in enumerate(scene.layers):
        fields: dict[str, Any]
        if number < len(channels):
            fields = {"kind": "light", "color": _lists(channels[number][1].curve.color)}
        elif number == 0:
            ramp = TransferFunction.from_colormap(colors_of(state), clim=(0, 1), opacity=1)
            fields = {"kind": "window", "color": _lists(ramp.color)}
        elif layer.is_shown:
            curves = curves_over(scene, layer, automatic)
            lowest = clear_below(curves)
            fields = {
                "kind": "over",
                "color": _lists(curves.color),
                "opacity": _lists(curves.opacity),
                "lowest": lowest if np.isfinite(lowest) else None,
            }
        else:
            continue
        yield {"layer": number, **fields}, planes.values_of(layer.drawn, **options)


def _lists(nodes: Any) -> list[list[float]]:
    return [[float(value) for value in node] for node in nodes]


def _coded(values: NDArray[np.float32]) -> tuple[float, float, Codes]:
    """Values as whole numbers: the value of code 0, the step of codes, and the codes."""
    known = np.isfinite(values)
    if not known.any():
        return 0.0, 1.0, np.full(values.shape, NOTHING, np.uint16)
    least, most = float(values[known].min()), float(values[known].max())
    if least == most:
        return least, 1.0, np.where(known, 0, NOTHING).astype(np.uint16)
    step = 2.0 ** ceil(log2((most - least) / (MAX_CODE - 1)))
    low = floor(least / step) * step
    codes = np.full(values.shape, NOTHING, np.uint16)
    codes[known] = np.clip(np.rint((values[known].astype(np.float64) - low) / step), 0, MAX_CODE)
    return low, step, codes


def _packed(planes: list[Codes]) -> bytes:
    """Planes as differences along rows, low bytes before high bytes, deflated."""
    packer = zlib.compressobj(1)
    parts = []
    for codes in planes:
        differences = np.diff(codes, axis=1, prepend=np.uint16(0)).astype("<u2")
        pairs = differences.view(np.uint8).reshape(-1, 2)
        parts += [packer.compress(pairs[:, byte].tobytes()) for byte in (0, 1)]
    return b"".join([*parts, packer.flush()])
