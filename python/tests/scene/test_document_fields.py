"""Fields of the parts of a scene's document: the native module, the schema and the classes have the same."""

import json
from dataclasses import fields
from importlib.resources import files

import jsonschema
import pytest
import rust_scenes

from wavesplat import _native
from wavesplat._model.arguments.sampling import Sampling
from wavesplat._model.camera.stereo import Stereo
from wavesplat._picture.annotating import Figure
from wavesplat._scene.documents import geometry_json, named_volumes, scene_json
from wavesplat.errors import ArgumentError

SCHEMA = json.loads((files("wavesplat") / "_scene/documents/scene.schema.json").read_text(encoding="utf-8"))
DEFS = SCHEMA["$defs"]
CLASSES = {"quality": Sampling, "stereo": Stereo, "figure": Figure, **scene_json.OPERATORS, **geometry_json.TYPES}


@pytest.mark.parametrize("part", CLASSES)
def test_the_classes_have_the_fields(part):
    file = {"file"} if part in ("surface", "lines", "points") else set()
    assert set(DEFS[part]["properties"]) == {field.name for field in fields(CLASSES[part]) if field.init} | file


def test_the_kinds_are_those_that_are_made():
    kinds = {
        "clip": SCHEMA["properties"]["clip"],
        "shape": SCHEMA["properties"]["geometry"],
        "step": DEFS["volume"]["properties"]["then"],
        "operator": {"items": DEFS["render"]["properties"]["composite"]["anyOf"][2]},
    }
    names = {name: set(schema["items"]["properties"]) for name, schema in kinds.items()}
    assert names["clip"] == {"keep", "plane", "cut_out"}
    assert names["shape"] == set(geometry_json.TYPES)
    assert names["step"] == set(named_volumes.STEPS)
    assert names["operator"] == set(scene_json.OPERATORS)


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
    for section, form in DEFS["view"]["properties"].items():
        fields_of_it = DEFS[form["$ref"].rpartition("/")[2]] if "$ref" in form else form
        for name, own in fields_of_it.get("properties", {}).items():
            for value in own.get("enum", ()):
                assert _native.checked_view({section: {name: value}}, [0.0, 0.0, 0.0])[section][name] == value
    overlays = DEFS["view"]["properties"]["overlays"]["propertyNames"]["enum"]
    assert set(_native.checked_view({}, [0.0, 0.0, 0.0])["overlays"]) == set(overlays)


@pytest.mark.filterwarnings("ignore:preset 'ct-bone' is for Hounsfield units")
def test_scenes_that_the_crate_draws_are_as_here():
    kept = [json.loads(line) for line in rust_scenes.KEPT.read_text(encoding="utf-8").splitlines()]
    assert list(rust_scenes.lines()) == kept
