"""Rows of the page's list of layers: colours, window, threshold and gamma, read from a look and set in it.

A look is that of a colour map if the map's name, with the window, threshold and gamma that its nodes show, makes the
very same look (`Layer.overlay`, `Look.changed`); of a channel, if it gives light of one colour. Any other one has a
window that its nodes are moved by, and may be replaced by a colour map. Slices show the first layer, unless it is a
channel, over a window of their own, which its row sets too.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from math import log
from typing import Any, Literal, TypeAlias

import numpy as np

from wavesplat import _native
from wavesplat._looks import look_files, presets
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.value_scale import values_of
from wavesplat._looks.kinds import channels, histogram, overlays
from wavesplat._looks.kinds.channel_light import light_of
from wavesplat._looks.look import Look
from wavesplat._render.arguments import chosen_look
from wavesplat._scene.drawing.looks_of_layers import look_over_others
from wavesplat._scene.drawing.volumes_of_layers import identity_of
from wavesplat._system.threads import collected_notes
from wavesplat._system.values import described
from wavesplat._viewer.session.state import ViewerState
from wavesplat._viewer.slices.first_slices import has_channels
from wavesplat._viewer.slices.slice_view import window_of
from wavesplat.errors import ArgumentError, WavesplatError

Kind: TypeAlias = Literal["map", "channel", "look", "table"]
Window: TypeAlias = tuple[float, float]

#: Colour maps that the page offers; any other name may be typed.
OFFERED = (
    *("hot", "gray", "viridis", "magma", "inferno", "plasma", "turbo", "jet"),
    *("winter", "summer", "cool", "Reds", "Greens", "Blues", "coolwarm"),
)
#: Colour maps of slices, which have no other ones.
OF_SLICES = ("gray", "gray_r", "hot", "viridis", "coolwarm")
#: Largest difference of values that count as the same, as a share of their window, and of opacities and colours.
SAME = 1e-9
#: Relative distance of neighbouring values.
EPSILON = float(np.finfo(float).eps)
#: Decimals of a gamma that is set, as of one that is read from nodes.
GAMMA_DECIMALS = 6
#: Least and largest gamma that is set: beyond, nodes come so close to an end of the window that it cannot be read.
GAMMAS = (0.05, 20.0)


@dataclass(frozen=True)
class Row:
    """The settings of a layer's look that its row shows.

    colors : name of the colour map, or the colour #rrggbb of a channel; "" of other looks.
    window : values of the first and the last colour; on slices of the first layer, black and white; None without any.
    is_automatic : whether the window is the one that the data suggest.
    """

    kind: Kind
    colors: str = ""
    window: Window | None = None
    threshold: float | None = None
    gamma: float = 1.0
    is_automatic: bool = False

    def as_json(self) -> dict[str, Any]:
        """The fields of `LayerRow` in `web/src/engine/engine.ts`."""
        return {
            "kind": self.kind,
            "colors": self.colors,
            "window": None if self.window is None else list(self.window),
            "threshold": self.threshold,
            "gamma": self.gamma,
            "is_automatic": self.is_automatic,
        }


def row_of(state: ViewerState, number: int) -> Row:
    """The row of a layer, as its look and the slices are now."""
    layer = state.scene.layers[number]
    row = Row("table")
    if isinstance(layer.look, Look):
        row = _row(layer.look, layer.looked_at)
    if row.kind == "look":
        row = replace(row, is_automatic=_has_window_by_data(state, number, row))
    if not _is_on_window(state, number):
        return row
    level, width = window_of(state)
    is_automatic = "window" not in state.view["slices"] and (row.kind == "table" or row.is_automatic)
    return replace(row, window=(level - width / 2, level + width / 2), is_automatic=is_automatic)


def changes(state: ViewerState, number: int, wanted: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Changes of the state (JSON Patch) that set fields of a layer's row.

    wanted : `colors`, `window` of numbers, percentiles or None, which leaves an end as it is, `threshold` or None,
    `gamma`; or `auto` alone, the window that the data suggest, without threshold and gamma.

    Raises
    ------
    ArgumentError
        If a field cannot be, or the look has none such.
    """
    layer = state.scene.layers[number]
    volume = layer.looked_at
    if not isinstance(layer.look, Look):
        raise ArgumentError(f"layer {layer.name!r} has no look that could be changed")
    wanted = dict(wanted)
    if (window := wanted.get("window")) is not None:
        now = row_of(state, number).window or (None, None)
        ends: Any = [end if given is None else given for given, end in zip(window, now, strict=True)]
        with collected_notes():
            wanted["window"] = values_of(ends, volume)
    look = _look_with(state, number, layer.look, wanted)
    operations = []
    if look is not layer.look:
        fields = json.loads(json.dumps(look_files.fields_of(look)))
        operations.append(_set(f"/layers/{number}/look", fields))
    if _is_on_window(state, number):
        operations += _on_slices(state, wanted)
    return operations


def _is_on_window(state: ViewerState, number: int) -> bool:
    """Whether slices show a layer over their own window."""
    return number == 0 and not has_channels(state.scene)


def _on_slices(state: ViewerState, wanted: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Changes of the window and the colours of slices."""
    operations: list[dict[str, Any]] = []
    if wanted.get("auto"):
        operations += [{"op": "remove", "path": "/view/slices/window"}] if "window" in state.view["slices"] else []
    elif (window := wanted.get("window")) is not None:
        low, high = window
        operations.append(_set("/view/slices/window", [(low + high) / 2, high - low]))
    if wanted.get("colors") in OF_SLICES:
        operations.append(_set("/view/slices/colors", wanted["colors"]))
    return operations


def _set(path: str, value: Any) -> dict[str, Any]:
    return {"op": "add", "path": path, "value": value}


def _row(look: Look, volume: Any) -> Row:
    """The row of a look, without slices."""
    function = look.transfer_function
    if look.labels is not None or not isinstance(function, TransferFunction):
        return Row("table")
    ends = function.color[0][0], function.color[-1][0]
    light = light_of(look)
    if light is not None:
        automatic = channels.channel_window(volume)[:2]
        color = "#" + "".join(f"{round(255 * share):02x}" for share in light.color)
        gamma = _gamma(light.curve, (light.low, light.high))
        is_automatic = all(_is_same(*pair, ends[1] - ends[0]) for pair in zip(ends, automatic, strict=True))
        return Row("channel", color, ends, None, gamma, is_automatic)
    if (found := _map_of(look, volume)) is not None:
        return found
    return Row("look", "", _window_of(look))


def _map_of(look: Look, volume: Any) -> Row | None:
    """The row of a look that a colour map makes; None of other looks."""
    function = look.transfer_function
    assert isinstance(function, TransferFunction)
    # The automatic look of a layer over another one has a colour map too.
    names = (*overlays.OVERLAY_MAPS, overlays.TWO_SIGNS) if look.name == "auto" else (look.name,)
    is_preset = look.name != "auto" and presets.plain(look.name) in {presets.plain(one) for one in presets.names()}
    for name in () if is_preset or not look.name or len(function.color) < 2 else names:
        for window in (None, *_windows_of(function)):
            for threshold in (None, *_thresholds_of(function)):
                try:
                    with collected_notes():
                        made = overlays.overlay(volume, name, window, threshold)
                except WavesplatError:
                    continue
                gamma = _gamma_between(made.transfer_function, function)
                if gamma is not None:
                    shown = window or (function.color[0][0], function.color[-1][0])
                    return Row("map", name, shown, threshold, gamma, window is None and threshold is None)
    return None


def _windows_of(function: TransferFunction) -> list[Window]:
    """The windows that a map with these nodes may have: its ends, or of two signs what is clear and opaque."""
    (low, *_), (high, *_) = function.color[0], function.color[-1]
    clear = max((value for value, alpha in function.opacity if alpha == 0), default=low)
    return [one for one in ((low, high), (clear, high)) if one[0] < one[1]]


def _thresholds_of(function: TransferFunction) -> list[float]:
    """The threshold of steps from clear to opaque; none of other curves."""
    values = [value for value, _ in function.opacity]
    alphas = [alpha for _, alpha in function.opacity]
    is_step = alphas[-2:] == [0.0, 1.0] and len(values) in (2, 4) and values[-1] == values[-2]
    return [values[-1]] if is_step else []


def _gamma_between(plain: Any, function: TransferFunction) -> float | None:
    """The gamma that moves the colours of one function to those of the other; None where none does."""
    if not isinstance(plain, TransferFunction):
        return None
    low, high = plain.color[0][0], plain.color[-1][0]
    if not _are_alike(plain.opacity, function.opacity, high - low):
        return None
    if _are_alike(plain.color, function.color, high - low):
        return 1.0
    if len(plain.color) != len(function.color) or (low, high) != (function.color[0][0], function.color[-1][0]):
        return None
    k = len(plain.color) // 2
    before, after = ((one.color[k][0] - low) / (high - low) for one in (plain, function))
    if not (0 < before < 1 and 0 < after < 1):
        return None
    gamma = round(log(before) / log(after), GAMMA_DECIMALS)
    return gamma if _are_alike(_bent(plain, gamma).color, function.color, high - low) else None


def _bent(function: TransferFunction, gamma: float) -> TransferFunction:
    """The colours of a map moved by a gamma, as `TransferFunction.from_colormap` moves them, in as many nodes."""
    nodes = np.array(function.color)
    low, high = float(nodes[0, 0]), float(nodes[-1, 0])
    color = _native.map_nodes((nodes[:, 0] - low) / (high - low), nodes[:, 1:].copy(), (low, high, False, gamma))
    return TransferFunction(function.opacity, color, function.opacity_unit, function.gradient_opacity)


def _gamma(curve: TransferFunction, ends: Window) -> float:
    """The gamma of the light of a channel, by the node in its middle."""
    inner = [node for node in curve.color if ends[0] < node[0] < ends[1]]
    if not inner or (most := max(max(node[1:]) for node in curve.color)) == 0:
        return 1.0
    node = inner[len(inner) // 2]
    share, place = max(node[1:]) / most, (node[0] - ends[0]) / (ends[1] - ends[0])
    return round(log(share) / log(place), GAMMA_DECIMALS) if 0 < share < 1 else 1.0


def _are_alike(one: Any, other: Any, width: float) -> bool:
    """Whether nodes of two curves, in a window of a width, are the same."""

    def is_same(a: Any, b: Any) -> bool:
        return _is_same(a[0], b[0], width) and all(map(_is_same, a[1:], b[1:]))

    return len(one) == len(other) and all(map(is_same, one, other))


def _is_same(a: float, b: float, width: float = 1.0) -> bool:
    """Whether two values are the same, but for rounding."""
    return abs(a - b) <= max(SAME * width, 4 * EPSILON * max(abs(a), abs(b)))


def _look_with(state: ViewerState, number: int, look: Look, wanted: Mapping[str, Any]) -> Look:
    """The look of a layer with the wanted fields of its row set."""
    volume = state.scene.layers[number].looked_at
    row = _row(look, volume)
    if row.kind == "table" and "colors" not in wanted:
        # Slices have a window, whatever the look.
        if _is_on_window(state, number) and wanted.keys() <= {"auto", "window"}:
            return look
        raise ArgumentError("the look is a table or of labels, which has no such setting; choose a colour map first")
    if wanted.get("auto"):
        return _automatic(state, number, look, row)
    colors, window = wanted.get("colors", row.colors), wanted.get("window")
    gamma = wanted.get("gamma", row.gamma)
    if row.kind != "map" and wanted.get("threshold") is not None and colors == row.colors:
        if row.kind == "channel":
            raise ArgumentError("what is below the window of a channel is hidden; set the window")
        colors = overlays.TWO_SIGNS if volume.value_range[0] < 0 else overlays.OVERLAY_MAPS[0]
        window = window or row.window
    if row.kind != "map" and colors == row.colors:
        if window is not None and row.window is not None:
            look = _without_notes(look, "window").changed(window=window)
        return look if gamma == row.gamma else _unbent(look, row, volume).changed(gamma=gamma)
    # The window of a look that is no map means something else, such as values of bone.
    kept = window or (None if row.is_automatic or row.kind == "look" else row.window)
    with collected_notes():
        made = overlays.overlay(volume, colors, kept, wanted.get("threshold", row.threshold))
    if len(state.scene.layers) == 1 and look.composite in histogram.PROJECTIONS:
        made = replace(made, composite=look.composite, background=look.background)
    return _with_gamma(made, gamma)


def _with_gamma(look: Look, gamma: float) -> Look:
    """A look that was made for a row, with a gamma."""
    function = look.transfer_function
    if gamma == 1 or not isinstance(function, TransferFunction):
        return look
    if light_of(look) is not None:
        return look.changed(gamma=gamma)
    return replace(look, transfer_function=_bent(function, gamma))


def _unbent(look: Look, row: Row, volume: Any) -> Look:
    """The look of a channel without its gamma, since each change of gamma divides the nodes; any other one as it is."""
    return _plain_channel(_without_notes(look, "gamma"), volume) if row.kind == "channel" else look


def _without_notes(look: Look, *settings: str) -> Look:
    """The look without what its reason says of settings that are set anew: a slider sets them many times."""
    kept = (part for part in look.reason.split("; ") if part.partition(" ")[0] not in settings)
    return replace(look, reason="; ".join(kept))


def _plain_channel(look: Look, volume: Any) -> Look:
    """The look of a channel without its gamma."""
    light = light_of(look)
    assert light is not None
    made = channels.channel_look(volume, light.color, (light.low, light.high), look.composite)
    return replace(look, transfer_function=made.transfer_function, name="channel")


def _automatic(state: ViewerState, number: int, look: Look, row: Row) -> Look:
    """The look with the window that the data suggest, without gamma and threshold."""
    volume = state.scene.layers[number].looked_at
    if row.kind == "channel":
        window = channels.channel_window(volume)[:2]
        return _without_notes(_plain_channel(look, volume), "window", "gamma").changed(window=window)
    if row.kind == "map":
        with collected_notes():
            return overlays.overlay(volume, row.colors, None)
    made = _look_by_data(state, number)
    function, ends = made.transfer_function, _window_of(made)
    if ends is None or row.window is None:
        raise ArgumentError("the data suggest no window for this look; choose a colour map or another look")
    moved = _without_notes(look, "window").changed(window=ends)
    nodes, width = moved.transfer_function, ends[1] - ends[0]
    assert isinstance(nodes, TransferFunction)
    assert isinstance(function, TransferFunction)
    is_same = _are_alike(nodes.opacity, function.opacity, width) and _are_alike(nodes.color, function.color, width)
    return replace(look, transfer_function=function, name=made.name, reason=made.reason) if is_same else moved


def _window_of(look: Look) -> Window | None:
    """The values of the first and the last node of a look; None of one without nodes, or with all of them at one."""
    function = look.transfer_function
    return _native.window_of(function.opacity, function.color) if isinstance(function, TransferFunction) else None


def _has_window_by_data(state: ViewerState, number: int, row: Row) -> bool:
    """Whether the look of a layer has the window that the data suggest for it."""
    try:
        ends = _window_of(_look_by_data(state, number))
    except WavesplatError:
        return False
    if ends is None or row.window is None:
        return False
    return all(_is_same(*pair, ends[1] - ends[0]) for pair in zip(ends, row.window, strict=True))


def _look_by_data(state: ViewerState, number: int) -> Look:
    """The preset that the look of a layer is named after, made for its data; the automatic look without such a name."""
    layer, composite = state.scene.layers[number], state.options["composite"]
    assert isinstance(layer.look, Look)
    is_preset = presets.plain(layer.look.name) in {presets.plain(one) for one in presets.names()}
    name = layer.look.name if is_preset else "auto"

    def made() -> Look:
        with collected_notes():
            find = look_over_others if number else chosen_look
            return find(name, layer.looked_at, composite)

    key: Any = id(layer.looked_at), "look by data", name, composite, number == 0
    found: Look = state.scene._cache.get_or_compute(key, identity_of(layer.looked_at), made)
    return found


# Looks of maps by their settings, for links and commands.


def map_fields(layer: Any) -> dict[str, Any] | None:
    """The map, window, threshold and gamma that make the very look of a layer; None of other looks."""
    look, volume = layer.look, layer.looked_at
    is_plain = isinstance(look, Look) and look.name != "auto" and isinstance(look.transfer_function, TransferFunction)
    row = _map_of(look, volume) if is_plain else None
    if row is None or not CHECKS["gamma"](row.gamma):
        return None
    fields: dict[str, Any] = {"map": row.colors}
    fields |= {} if row.is_automatic or row.window is None else {"window": list(row.window)}
    fields |= {} if row.threshold is None else {"threshold": row.threshold}
    fields |= {} if row.gamma == 1 else {"gamma": row.gamma}
    return fields if look_files.fields_of(look_of_map(fields, volume)) == look_files.fields_of(look) else None


def look_of_map(fields: Mapping[str, Any], volume: Any) -> Look:
    """The look of `map_fields`, of which `map` must be there.

    Raises
    ------
    ArgumentError
        If a field cannot be.
    """
    wanted = _checked(fields, "look", OF_MAPS)
    with collected_notes():
        made = overlays.overlay(volume, wanted["map"], wanted.get("window"), wanted.get("threshold"))
    return _with_gamma(made, wanted.get("gamma", 1.0))


# Answers to the page's questions.


def rows(state: ViewerState) -> dict[str, Any]:
    """The rows of all layers, and the colour maps that are offered."""
    return {"rows": [row_of(state, n).as_json() for n in range(len(state.scene.layers))], "maps": list(OFFERED)}


def answer_change(state: ViewerState, number: int, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """The changes for a row, whose fields are checked."""
    given = {name: value for name, value in arguments.items() if name != "layer"}
    wanted = _checked(given, "layer_change", SETTINGS)
    if wanted.get("auto") and len(wanted) > 1:
        raise ArgumentError("layer_change: auto is true; give it alone, since it sets window, threshold and gamma")
    return {"operations": changes(state, number, wanted)}


def _checked(given: Mapping[str, Any], what: str, names: Iterable[str]) -> dict[str, Any]:
    """Fields of a row, each of which can be, and gamma in decimals that are read again.

    Raises
    ------
    ArgumentError
        If one cannot.
    """
    for name, value in given.items():
        if name not in names or not CHECKS[name](value):
            needed = NEEDED[name] if name in names else f"there is no such field, only {', '.join(names)}"
            raise ArgumentError(f"{what}: {name} is {described(value)}; {needed}")
    return {name: round(value, GAMMA_DECIMALS) if name == "gamma" else value for name, value in given.items()}


def _is_name(value: Any) -> bool:
    return isinstance(value, str) and 0 < len(value) <= 100


def _is_end(value: Any) -> bool:
    return value is None or _native.is_number(value) or (isinstance(value, str) and len(value) <= 32)


#: Fields of a row that a page sets, and those of a link's look of a map.
SETTINGS = ("colors", "window", "threshold", "gamma", "auto")
OF_MAPS = ("map", "window", "threshold", "gamma")
CHECKS: dict[str, Callable[[Any], bool]] = {
    "colors": _is_name,
    "map": _is_name,
    "window": lambda value: isinstance(value, list) and len(value) == 2 and all(map(_is_end, value)),
    "threshold": lambda value: value is None or _native.is_number(value),
    "gamma": lambda value: _native.is_number(value) and GAMMAS[0] <= value <= GAMMAS[1],
    "auto": lambda value: isinstance(value, bool),
}
NEEDED = {
    "colors": "give the name of a colour map, or a colour",
    "map": "give the name of a colour map, or a colour",
    "window": 'give two numbers, or percentiles such as "1%"; null leaves an end as it is',
    "threshold": "give a number, or null",
    "gamma": f"give {GAMMAS[0]:g} to {GAMMAS[1]:g}; 1 changes nothing",
    "auto": "give true or false",
}
