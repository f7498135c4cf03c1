"""Fields of the parts of a scene's document: the native module, the schema and the classes have the same."""

import json
import re
from dataclasses import fields
from importlib.resources import files

import jsonschema
import pytest

from wavesplat import _native
from wavesplat._model.arguments.sampling import Sampling
from wavesplat._model.camera.stereo import Stereo
from wavesplat._picture.annotating import Figure
from wavesplat._scene.documents import geometry_json, named_volumes, scene_json
from wavesplat.errors import ArgumentError

SCHEMA = json.loads((files("wavesplat") / "_scene/documents/scene.schema.json").read_text(encoding="utf-8"))
DEFS = SCHEMA["$defs"]
RENDER = DEFS["render"]["properties"]
IN_SCHEMA = {
    "scene": SCHEMA,
    **{
        name: DEFS[name] for name in ("layer", "color_field", "mapped_look", "labels", "shape_file", "render", "figure")
    },
    "keep": DEFS["box"],
    "cut_out": DEFS["box"],
    "plane": DEFS["clip"]["properties"]["plane"],
    "quality": RENDER["quality"]["anyOf"][1],
    "stereo": RENDER["stereo"]["anyOf"][2],
    **DEFS["shape"]["properties"],
}
CLASSES = {"quality": Sampling, "stereo": Stereo, "figure": Figure, **scene_json.OPERATORS, **geometry_json.TYPES}
#: Shapes of a renderer come from no file, which has a message of its own.
FILELESS = ("slice_plane", "frame")


def fields_of(part):
    """The fields that a message lists, and those that are needed, in order."""
    needed = {}
    while True:
        with pytest.raises(ArgumentError) as caught:
            _native.check_part({**needed, "?": 0}, "here", part)
        if found := re.fullmatch(r"here: field '(\w+)' is missing", str(caught.value)):
            needed[found[1]] = 0
            continue
        known = re.fullmatch(r"here: unknown field '\?'; the fields are (.*)", str(caught.value))
        return set(known[1].split(", ")), list(needed)


@pytest.mark.parametrize("part", IN_SCHEMA)
def test_the_schema_has_the_fields(part):
    known, needed = fields_of(part)
    schema = IN_SCHEMA[part]
    assert known - ({"file"} if part in FILELESS else set()) == set(schema["properties"])
    # A document in a report is found by its field `wavesplat`, before its fields are checked.
    assert set(needed) == set(schema.get("required", ())) - {"wavesplat"}
    assert schema["additionalProperties"] is False


@pytest.mark.parametrize("part", CLASSES)
def test_the_classes_have_the_fields(part):
    file = {"file"} if part in geometry_json.TYPES else set()
    assert fields_of(part)[0] == {field.name for field in fields(CLASSES[part]) if field.init} | file


@pytest.mark.parametrize(
    ("of", "names"),
    [
        ("clip", DEFS["clip"]["properties"]),
        ("shape", geometry_json.TYPES),
        ("operator", scene_json.OPERATORS),
        ("step", named_volumes.STEPS),
    ],
)
def test_kinds_of_one_field(of, names):
    with pytest.raises(ArgumentError, match=r"^here is a dict; it must be .*an object of one field: ") as caught:
        _native.only_field({}, "here", of)
    assert set(str(caught.value).partition(": ")[2].split(", ")) == set(names)
    assert all(_native.only_field({name: 1}, "here", of) == (name, 1) for name in names)


#: Values, one of which is put into each place of a view.
VALUES = [
    None,
    True,
    0,
    -1,
    0.005,
    2000,
    1e31,
    "a",
    "z",
    "mean",
    "angle",
    [],
    [1],
    [1, 2, 3],
    [[0, 0, 0]] * 3,
    {},
    {"z": [0, 0, 1]},
]
VIEW = {
    "layout": {"name": "single", "main": "x"},
    "slices": {
        "crosshair": [0, 0, 0],
        "window": [40, 400],
        "center": [1, 2, 3],
        "colors": "hot",
        "normals": {"z": [0, 0, 1]},
    },
    "measures": [{"kind": "area", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}],
    "overlays": {"legend": False},
    "quality": {"moving": "exact"},
    "interface": {"theme": "dark", "panels": ["light"], "turning": "trackball"},
}


def changed_views(value, steps=()):
    """The view with each place taken out, or set to each value, and the names of all fields added to each object."""
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, part in parts:
        path = "/" + "/".join(map(str, (*steps, name)))
        yield _native.patched(VIEW, [{"op": "remove", "path": path}])
        for new in VALUES:
            yield _native.patched(VIEW, [{"op": "replace", "path": path, "value": new}])
        yield from changed_views(part, (*steps, name))
    for name in ("thickness", "zoom", "slab", "x", "cube", "other") if isinstance(value, dict) else ():
        for new in VALUES:
            yield _native.patched(VIEW, [{"op": "add", "path": "/".join(("", *map(str, steps), name)), "value": new}])


def test_views_that_are_taken_are_valid_by_the_schema():
    valid = jsonschema.Draft202012Validator({"$ref": "#/$defs/view", "$defs": DEFS}).is_valid
    taken = 0
    for view in changed_views(VIEW):
        try:
            complete = _native.checked_view(view, [0.0, 0.0, 0.0])
        except ArgumentError:
            continue
        taken += 1
        assert valid(view), view
        assert valid(complete), view
        assert _native.checked_view(complete, [1.0, 1.0, 1.0]) == complete
    assert taken > 50


def test_views_take_all_names_of_the_schema():
    for section, fields_of_it in DEFS["view"]["properties"].items():
        for name, form in fields_of_it.get("properties", {}).items():
            for value in form.get("enum", ()):
                assert _native.checked_view({section: {name: value}}, [0.0, 0.0, 0.0])[section][name] == value
    overlays = DEFS["view"]["properties"]["overlays"]["propertyNames"]["enum"]
    assert set(_native.checked_view({}, [0.0, 0.0, 0.0])["overlays"]) == set(overlays)
