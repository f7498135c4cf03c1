"""States of ParaView: views and colour maps of a `.pvsm` or `.pvcc` file, or of a Python file that ParaView saved.

A `.pvsm` lists proxies: `<Proxy type="RenderView" id="7">` with `<Property name="CameraPosition">` of `<Element>`, and
their names in `<ProxyCollection>`. A Python state sets the same properties, those that differ from ParaView's defaults:
`renderView1.CameraPosition = [...]` or, from version 5.13 on, `renderView1.Set(CameraPosition=[...])`. It is read and
never run: only values that are written out count, and colours that are named by `GenerateRGBPoints`.

Source: ParaView's vtkSMStateLoader and smstate.py, and its definitions of views and of rendering, versions 5 and 6.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from math import inf
from typing import TYPE_CHECKING, Any

from wavesplat import _native
from wavesplat._storage import reading as xml_text
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element


WHAT = "state of ParaView"
#: Roots of its XML files: states, alone or within another element, and cameras.
ROOTS = ("ParaView", "ServerManagerState", "PVCameraConfiguration")
#: Mark of its Python files.
MODULE = "paraview.simple"
#: Properties of views, with ParaView's defaults.
VIEW = {
    "CameraPosition": (0.0, 0.0, 1.0),
    "CameraFocalPoint": (0.0, 0.0, 0.0),
    "CameraViewUp": (0.0, 1.0, 0.0),
    "CameraViewAngle": 30.0,
    "CameraParallelScale": 1.0,
    "CameraParallelProjection": 0.0,
}
#: Properties of maps of colours, with ParaView's defaults.
COLORS = {"UseLogScale": 0.0, "HSVWrap": 0.0, "IndexedLookup": 0.0}
#: The version from which on another map is the default, and name and colour space of the default, before and since.
NEW_COLORS, DEFAULT_COLORS = 6, (("Cool to Warm", "Diverging"), ("Fast", "Lab"))
#: Where a Python file says the version that it is for.
VERSION = re.compile(r"paraview(?:\.compatibility\.major\s*=\s*| version )(\d+)")
#: The function of Python states that makes colour points of a name and a range.
NAMED = "GenerateRGBPoints"
#: Colour spaces by their numbers, where a file has no names of them.
SPACES = ("RGB", "HSV", "Lab", "Diverging", "Lab/CIEDE2000", "Step")
VIEWS, TABLES, OPACITIES = ("RenderView",), ("PVLookupTable",), ("PiecewiseFunction",)
#: Functions of Python states that make, or get, a view, a map of colours and one of opacities.
MAKERS = {
    "CreateView": "RenderView",
    "CreateRenderView": "RenderView",
    "GetActiveViewOrCreate": "RenderView",
    "GetActiveView": "RenderView",
    "GetRenderView": "RenderView",
    "FindViewOrCreate": "RenderView",
    "GetColorTransferFunction": "PVLookupTable",
    "GetOpacityTransferFunction": "PiecewiseFunction",
}
#: Methods of maps whose effect is not written out.
NOT_WRITTEN = ("ApplyPreset", "RescaleTransferFunction", "RescaleTransferFunctionToDataRange")


@dataclass(frozen=True)
class View:
    """A render view's name, its camera in world coordinates, and its lens: one of both is None.

    parallel_scale : half the height of the view, world units. view_angle : of the height, degrees.
    """

    name: str
    position: tuple[float, ...]
    focal_point: tuple[float, ...]
    view_up: tuple[float, ...]
    parallel_scale: float | None
    view_angle: float | None


@dataclass(frozen=True)
class NamedPoints:
    """Colour points of a map that a state names, over a range of values."""

    preset: str
    low: float = 0.0
    high: float = 1.0


@dataclass
class _Proxy:
    """A thing in a state: its kind, its name, the properties that are set, and calls that change it unseen."""

    kind: str
    name: str
    properties: dict[str, Any] = field(default_factory=dict)
    calls: list[str] = field(default_factory=list)


def is_state(text: str) -> bool:
    """Whether a text is a state of ParaView, by the root of its XML, or as Python that imports ParaView's module."""
    head = text.lstrip("\ufeff \t\r\n")
    if head.startswith("<"):
        return any(f"<{root}" in head[:4096] for root in ROOTS)
    return not head.startswith(("{", "[")) and MODULE in text


def views(text: str) -> list[View]:
    """The render views of a state."""
    return [_view(proxy) for proxy in _proxies(text) if proxy.kind in VIEWS]


def view_named(text: str, name: str | None) -> View:
    """The render view of a name, or the only one."""
    found = views(text)
    if not found:
        raise ArgumentError(f"{WHAT}: it has no render view")
    named = [view for view in found if view.name.lower() == (name or "").lower()]
    if name is None and len(found) == 1:
        return found[0]
    names = ", ".join(view.name for view in found)
    if name is None:
        raise ArgumentError(f"{WHAT}: it has {len(found)} render views; name one of: {names}")
    if not named:
        raise ArgumentError(f"{WHAT}: it has no render view {name!r}; it has {names}")
    return named[0]


def color_maps(text: str) -> list[dict[str, Any]]:
    """The maps of colours of a state, at least one, with their opacities, as `.json` files of ParaView have them.

    Beside these fields: `OpacityUnit`, the length of the opacities, world units, where a volume is drawn with the map,
    and `Absolute`: values are samples, and not places in a range.
    """
    proxies = _proxies(text)
    version = VERSION.search(text)
    preset, space = DEFAULT_COLORS[version is not None and int(version[1]) >= NEW_COLORS]
    defaults = {"ColorSpace": space, "RGBPoints": NamedPoints(preset), **COLORS}
    found = []
    for table in (proxy for proxy in proxies if proxy.kind in TABLES):
        opacity = table.properties.get("ScalarOpacityFunction")
        opacity = opacity if isinstance(opacity, _Proxy) else _same_name(proxies, table.name)
        for one in (table, opacity):
            if one is not None and one.calls:
                raise ArgumentError(
                    f"{WHAT}: {table.name!r} is changed by {one.calls[0]}, whose result the file does not have; save "
                    "the state in ParaView (File > Save State), and give that file"
                )
        made = {"Name": table.name, **{key: table.properties.get(key, default) for key, default in defaults.items()}}
        if isinstance(made["RGBPoints"], NamedPoints):
            made["RGBPoints"] = replace(made["RGBPoints"], preset=made["RGBPoints"].preset or preset)
        if isinstance(made["ColorSpace"], float):
            made["ColorSpace"] = SPACES[int(made["ColorSpace"])] if made["ColorSpace"] in range(len(SPACES)) else "?"
        if opacity is not None and "Points" in opacity.properties:
            made["Points"] = opacity.properties["Points"]
        for one in proxies:
            unit = one.properties.get("ScalarOpacityUnitDistance")
            if one.properties.get("LookupTable") is table and isinstance(unit, int | float) and 0 < unit < inf:
                made["OpacityUnit"] = unit
        found.append(made | {"Absolute": True})
    if not found:
        raise ArgumentError(f"{WHAT}: it has no map of colours")
    return found


def _same_name(proxies: Iterable[_Proxy], name: str) -> _Proxy | None:
    return next((proxy for proxy in proxies if proxy.kind in OPACITIES and proxy.name == name), None)


def _view(proxy: _Proxy) -> View:
    if "CameraPosition" not in proxy.properties:
        raise ArgumentError(
            f"{WHAT}: it does not say where the camera of {proxy.name!r} is; save the state in ParaView (File > Save "
            "State) once the view is as you want it, and give that file"
        )
    given = {key: proxy.properties.get(key, default) for key, default in VIEW.items()}
    for key, default in VIEW.items():
        value = given[key]
        is_right = _native.is_point(value) if isinstance(default, tuple) else _native.is_number(value)
        if not is_right:
            wanted = "three numbers" if isinstance(default, tuple) else "a number"
            raise ArgumentError(f"{WHAT}: {key} of {proxy.name!r} is {value!r}; it must be {wanted}")
    is_parallel = bool(given["CameraParallelProjection"])
    return View(
        proxy.name,
        given["CameraPosition"],
        given["CameraFocalPoint"],
        given["CameraViewUp"],
        given["CameraParallelScale"] if is_parallel else None,
        None if is_parallel else given["CameraViewAngle"],
    )


def _proxies(text: str) -> list[_Proxy]:
    is_xml = text.lstrip("\ufeff \t\r\n").startswith("<")
    return _of_xml(xml_text.parsed(text, WHAT)) if is_xml else _of_python(text)


# XML


def _of_xml(root: Element) -> list[_Proxy]:
    names = {
        item.get("id", ""): _plain(item.get("name", ""))
        for collection in root.iter("ProxyCollection")
        for item in collection.iter("Item")
    }
    elements = [one for one in root.iter("Proxy") if one.find("Property") is not None]
    made = {
        one.get("id", ""): _Proxy(one.get("type", ""), names.get(one.get("id", ""), one.get("type", "")))
        for one in elements
    }
    for element in elements:
        proxy = made[element.get("id", "")]
        for prop in element.findall("Property"):
            proxy.properties[prop.get("name", "")] = _value(prop, made)
    return list(made.values())


def _plain(name: str) -> str:
    """The name of an array in the name of its map: "1.density.PVLookupTable" or "density"."""
    for suffix in (*TABLES, *OPACITIES):
        if name.endswith(f".{suffix}"):
            name = name.removesuffix(f".{suffix}")
            first, dot, rest = name.partition(".")
            return rest if dot and first.isdigit() else name
    return name


def _value(prop: Element, proxies: dict[str, _Proxy]) -> Any:
    """The value of a property: a proxy, the text of a choice, a number, a text, or several of them."""
    linked = prop.find("Proxy")
    if linked is not None:
        return proxies.get(linked.get("value", ""))
    texts = [element.get("value", "") for element in prop.findall("Element")]
    choices = {entry.get("value"): entry.get("text") for entry in prop.iter("Entry")}
    values = [choices.get(text) or _number(text) for text in texts]
    return values[0] if len(values) == 1 else tuple(values)


def _number(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text


# Python


def _of_python(text: str) -> list[_Proxy]:
    try:
        lines = ast.parse(text).body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ArgumentError(f"{WHAT}: not Python that can be read: {error}") from None
    made: dict[str, _Proxy] = {}
    for line in lines:
        if isinstance(line, ast.Assign) and len(line.targets) == 1:
            _assign(line.targets[0], line.value, made)
        elif isinstance(line, ast.Expr) and isinstance(line.value, ast.Call):
            _note_call(line.value, made)
    return list(made.values())


def _note_call(call: ast.Call, made: dict[str, _Proxy]) -> None:
    """Note `name.Set(Property=value)`, and calls that change a map unseen."""
    if not isinstance(call.func, ast.Attribute) or not isinstance(call.func.value, ast.Name):
        return
    proxy = made.setdefault(call.func.value.id, _Proxy("", call.func.value.id))
    if call.func.attr == "Set":
        proxy.properties |= {one.arg: _written(one.value, made) for one in call.keywords if one.arg is not None}
    elif call.func.attr in NOT_WRITTEN:
        proxy.calls.append(call.func.attr)


def _assign(target: ast.expr, value: ast.expr, made: dict[str, _Proxy]) -> None:
    """Note `name = Maker("array")` and `name.Property = value`."""
    if isinstance(target, ast.Name) and isinstance(value, ast.Call) and isinstance(value.func, ast.Name):
        first = _literal(value.args[0]) if value.args else None
        kind = MAKERS.get(value.func.id, "")
        named = first if isinstance(first, str) and kind != "RenderView" else target.id
        made[target.id] = _Proxy(kind, named)
    elif isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name):
        proxy = made.setdefault(target.value.id, _Proxy("", target.value.id))
        proxy.properties[target.attr] = _written(value, made)


def _written(value: ast.expr, made: dict[str, _Proxy]) -> Any:
    """The value of a property: a proxy by its variable, named colours, or what is written out."""
    if isinstance(value, ast.Name) and value.id in made:
        return made[value.id]
    if not (isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id == NAMED):
        return _literal(value)
    given = dict(zip(("preset_name", "range_min", "range_max"), map(_literal, value.args), strict=False))
    given |= {one.arg: _literal(one.value) for one in value.keywords if one.arg is not None}
    preset, low, high = given.get("preset_name"), given.get("range_min", 0.0), given.get("range_max", 1.0)
    if not (_native.is_number(low) and _native.is_number(high) and (preset is None or isinstance(preset, str))):
        return None
    return NamedPoints(preset or "", low, high)


def _literal(value: ast.expr) -> Any:
    """The value of an expression that is written out, lists as tuples; None for any other."""
    try:
        found = ast.literal_eval(value)
    except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
        return None
    return tuple(found) if isinstance(found, list) else found
