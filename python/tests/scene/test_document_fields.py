"""Fields of the parts of a scene's document: the native module, the schema and the classes have the same."""

import json
import re
from dataclasses import fields
from importlib.resources import files

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
