"""The field `view` of a viewer's state: what no picture from Python has. `web/src/state/parse.ts` is the twin.

    {"layout": {"name": "one-and-three", "main": "3d"},
     "slices": {"crosshair": [0, 0, 0], "window": [40, 400], "thickness": 0, "slab": "maximum", "zoom": 1,
                "center": [0, 0, 0], "colors": "gray", "normals": {"z": [0, 0.1, 0.995]}},
     "measures": [{"kind": "distance", "points": [[0, 0, 0], [10, 0, 0]]}],
     "overlays": {"scale_bar": true, "letters": true, "cube": true, "color_bar": false, "crosshair": true,
                  "crop_box": false, "legend": true},
     "quality": {"moving": "smooth"},
     "interface": {"theme": "system", "panels": ["presets"], "turning": "turntable"}}

Whatever is left out is as `defaults` has it. World units; `window` is (level, width), and `colors` a colour map, both
left out where they are those of the kind of data;
`center` is the place in the middle of all panes, left out where it is the middle of the volume's box.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, get_args

from wavesplat import _native
from wavesplat._model.arguments.sampling import Slab
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

PANES = ("z", "y", "x")
VIEWS = ("3d", *PANES)
LAYOUTS = ("3d", "one-and-three", "two-by-two", "single")
OVERLAYS = {
    "scale_bar": True,
    "letters": True,
    "cube": True,
    "color_bar": False,
    "crosshair": True,
    "crop_box": False,
    "legend": True,
}
MOVING = ("smooth", "balanced", "exact")
THEMES = ("system", "dark", "light")
#: Turning by a drag: about an upright axis, or freely.
TURNINGS = ("turntable", "trackball")
#: Colour maps of slices.
COLORS = ("gray", "gray_r", "hot", "viridis", "coolwarm")
#: Least and largest number of points.
MEASURES = {"distance": (2, 2), "angle": (3, 3), "area": (3, 200)}
#: Fields of slices without a default.
MAY_LACK = ("center", "window", "colors", "normals")
#: Largest numbers of measures and panels, so that a state stays small.
MAX_MEASURES, MAX_PANELS = 1000, 100
WHAT = "scene: view"


def defaults(crosshair: Iterable[float]) -> dict[str, Any]:
    """The field as it is at first."""
    return {
        "layout": {"name": "3d", "main": "3d"},
        "slices": {"crosshair": list(crosshair), "thickness": 0.0, "slab": "maximum", "zoom": 1.0},
        "measures": [],
        "overlays": dict(OVERLAYS),
        "quality": {"moving": "smooth"},
        "interface": {"theme": "system", "panels": ["presets"], "turning": "turntable"},
    }


def checked(view: Any, crosshair: Iterable[float]) -> dict[str, Any]:
    """The field, checked, with the defaults of all that it leaves out.

    Raises
    ------
    ArgumentError
        If something in it cannot be; the message names the field.
    """
    known = defaults(crosshair)
    given = _object(view, WHAT, known)
    found = {
        name: _object(given.get(name, {}), f"{WHAT}.{name}", known[name])
        for name in ("layout", "overlays", "quality", "interface")
    }
    slices = _object(given.get("slices", {}), f"{WHAT}.slices", dict.fromkeys((*known["slices"], *MAY_LACK)))
    merged: dict[str, Any] = {name: {**known[name], **fields} for name, fields in found.items()}
    merged["slices"] = {**known["slices"], **slices}
    _one_of(merged["layout"]["name"], LAYOUTS, "layout.name")
    _one_of(merged["layout"]["main"], VIEWS, "layout.main")
    _check_slices(merged["slices"])
    for name, shown in merged["overlays"].items():
        if not isinstance(shown, bool):
            raise ArgumentError(f"{WHAT}.overlays.{name} is {described(shown)}; it must be true or false")
    _one_of(merged["quality"]["moving"], MOVING, "quality.moving")
    _one_of(merged["interface"]["theme"], THEMES, "interface.theme")
    _one_of(merged["interface"]["turning"], TURNINGS, "interface.turning")
    panels = _list(merged["interface"]["panels"], "interface.panels", MAX_PANELS)
    for number, panel in enumerate(panels):
        if not isinstance(panel, str):
            raise ArgumentError(f"{WHAT}.interface.panels[{number}] is {described(panel)}; it must be a name")
    measures = _list(given.get("measures", []), "measures", MAX_MEASURES)
    merged["measures"] = [_measure(one, number) for number, one in enumerate(measures)]
    return {name: merged[name] for name in known}


def _check_slices(slices: dict[str, Any]) -> None:
    _point(slices["crosshair"], "slices.crosshair")
    _one_of(slices["slab"], get_args(Slab), "slices.slab")
    if not (_native.is_number(slices["thickness"]) and slices["thickness"] >= 0):
        raise ArgumentError(f"{WHAT}.slices.thickness is {described(slices['thickness'])}; it must be 0 or a length")
    if not (_native.is_number(slices["zoom"]) and 0.01 <= slices["zoom"] <= 1000):
        raise ArgumentError(f"{WHAT}.slices.zoom is {described(slices['zoom'])}; it must be a number, 0.01 to 1000")
    if "center" in slices:
        _point(slices["center"], "slices.center")
    if "colors" in slices:
        _one_of(slices["colors"], COLORS, "slices.colors")
    if "window" in slices:
        window = slices["window"]
        if not (
            isinstance(window, list) and len(window) == 2 and all(map(_native.is_number, window)) and window[1] > 0
        ):
            raise ArgumentError(f"{WHAT}.slices.window is {described(window)}; it must be [level, width]")
    if "normals" in slices:
        normals = _object(slices["normals"], f"{WHAT}.slices.normals", dict.fromkeys(PANES))
        for name, normal in normals.items():
            _point(normal, f"slices.normals.{name}")
            if not any(normal):
                raise ArgumentError(f"{WHAT}.slices.normals.{name} is zero; a normal has a direction")


def _measure(measure: Any, number: int) -> dict[str, Any]:
    what = f"measures[{number}]"
    fields = _object(measure, f"{WHAT}.{what}", {"kind": 0, "points": 0})
    _one_of(fields.get("kind"), tuple(MEASURES), f"{what}.kind")
    points, (least, most) = fields.get("points"), MEASURES[fields["kind"]]
    if not (isinstance(points, list) and least <= len(points) <= most):
        n = f"{least}" if least == most else f"{least} to {most}"
        raise ArgumentError(f"{WHAT}.{what}.points is {described(points)}; it must be a list of {n} points")
    for place, point in enumerate(points):
        _point(point, f"{what}.points[{place}]")
    return fields


def _object(thing: Any, what: str, known: Mapping[str, Any]) -> dict[str, Any]:
    if not isinstance(thing, Mapping):
        raise ArgumentError(f"{what} is {described(thing)}; it must be an object")
    unknown = sorted(set(thing) - set(known))
    if unknown:
        raise ArgumentError(f"{what}: unknown field {unknown[0]!r}; the fields are {', '.join(sorted(known))}")
    return dict(thing)


def _list(thing: Any, name: str, most: int) -> list[Any]:
    if not isinstance(thing, list) or len(thing) > most:
        raise ArgumentError(f"{WHAT}.{name} is {described(thing)}; it must be a list of at most {most}")
    return thing


def _one_of(value: Any, known: Iterable[str], name: str) -> None:
    if not isinstance(value, str) or value not in tuple(known):
        raise ArgumentError(f"{WHAT}.{name} is {described(value)}; use one of: {', '.join(known)}")


def _point(point: Any, name: str) -> None:
    if not _native.is_point(point):
        raise ArgumentError(f"{WHAT}.{name} is {described(point)}; it must be three numbers, [x, y, z]")
