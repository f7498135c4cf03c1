"""Geometry in scene documents: by file, written out where it is small, and read back to the bit."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest

import wavesplat as ws
from wavesplat._scene.documents import scene_json
from wavesplat._viewer.page_requests.code import python_of
from wavesplat._viewer.session.state import ViewerState

SCHEMA = json.loads((Path(scene_json.__file__).parent / "scene.schema.json").read_text(encoding="utf-8"))
RNG = np.random.default_rng(0)
FACES = [(0, 1, 2), (1, 2, 3)]
SMALL = {
    "values": ws.Surface(RNG.random((5, 3)) * 100, FACES, values=[1, 2, np.nan, 3, 4], clim=(0, 5), name="a"),
    "normals": ws.Surface(RNG.random((5, 3)), FACES, normals=RNG.random((5, 3)), color=RNG.random((5, 4))),
    "flat": ws.Surface(RNG.random((5, 3)), FACES, normals="flat", color="red", opacity=0.3, lit=False, clipped=True),
    "lines": ws.Lines([RNG.random((3, 3)), RNG.random((2, 3))], color="direction", radius=0.1),
    "strokes": ws.Lines(RNG.random((4, 3)), values=[1, 2, 3, 4], cmap="hot", width=3),
    "points": ws.Points(RNG.random((3, 3)), radius=[1, 2, 3], labels=["a", "b", ""], color=(0, 1, 0, 0.5)),
    "discs": ws.Points(RNG.random((3, 3)), size=9),
    "slice": ws.SlicePlane(plane="coronal", index=3, window="soft-tissue", opacity=0.5),
    "oblique": ws.SlicePlane(ws.examples.mri_head(), ((0, 1, 2), (1, 1, 0)), position=2.0, cmap="hot", clim=(0, 100)),
    "frame": ws.Frame(((0, 0, 0), (1, 2, 3)), grid=True, units=False, color="red", width=2),
}


def fields(shape):
    """Fields of a shape as plain values, NaN as null; volumes by their names."""
    told = {}
    for name in shape.__dataclass_fields__:
        value = getattr(shape, name)
        value = value.positions if name == "paths" else value
        value = value.name if isinstance(value, ws.Volume) else value
        told[name] = repr(value.tolist()) + str(value.dtype) if isinstance(value, np.ndarray) else value
    return told


def scene(*geometry):
    return ws.Scene(ws.examples.ct_pelvis(), "ct-bone", geometry=geometry)


@pytest.mark.parametrize("kind", SMALL)
def test_small_geometry_is_written_out_and_reads_back_to_the_bit(kind):
    text = scene(SMALL[kind]).to_json()
    jsonschema.validate(json.loads(text), SCHEMA)
    again = ws.Scene.from_json(text)
    (shape,) = again.geometry
    assert type(shape) is type(SMALL[kind])
    assert fields(shape) == fields(SMALL[kind])
    assert again.to_json() == text


def test_only_what_differs_from_the_defaults_is_written():
    (frame,) = json.loads(scene(ws.Frame()).to_json())["geometry"]
    assert frame == {"frame": {}}
    assert "geometry" not in json.loads(scene().to_json())


def test_geometry_of_a_file_is_named_by_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = "".join(f"{k},{k % 7},{k % 5},{k / 3}\n" for k in range(1000))
    (tmp_path / "cells.csv").write_text(f"x,y,z,speed\n{rows}", encoding="utf-8")
    cells = ws.open_geometry("cells.csv", values="speed", cmap="hot", clim=(0, 100), size=4, name="cells")
    made = scene(cells.with_(opacity=0.5))
    made.save("scene.json")
    (told,) = json.loads((tmp_path / "scene.json").read_text(encoding="utf-8"))["geometry"]
    assert told == {
        "points": {
            "file": {"path": "cells.csv", "kind": "points", "values": "speed"},
            "cmap": "hot",
            "clim": [0.0, 100.0],
            "quantity": "speed",
            "size": 4.0,
            "opacity": 0.5,
            "name": "cells",
        }
    }
    jsonschema.validate(json.loads(made.to_json()), SCHEMA)
    (again,) = ws.Scene.load("scene.json").geometry
    assert fields(again) == fields(made.geometry[0])
    # A picture's own document draws it again.
    picture = made.render("front", size=(40, 30))
    picture.save("picture.png", embed_paths=True)
    assert np.array_equal(ws.Scene.load("picture.png").render("front", size=(40, 30)).rgba, picture.rgba)


def test_large_geometry_of_no_file_cannot_be_written_but_is_told_in_reports():
    large = ws.Points(np.zeros((1000, 3)), name="dust")
    with pytest.raises(ws.errors.ArgumentError, match="the points 'dust' has 3001 numbers and comes from no file"):
        scene(large).to_json()
    document = scene(large).render(size=(16, 16)).report["scene"]
    assert document["geometry"] == [{"points": {"file": {"path": None}, "name": "dust"}}]
    with pytest.raises(
        ws.errors.ArgumentError, match=r"geometry\[0\].points.file came from no file when this was written"
    ):
        ws.Scene.from_json(json.dumps(document))


def test_what_is_changed_part_by_part_is_no_longer_that_of_its_file(tmp_path):
    (tmp_path / "cells.csv").write_text("x,y,z\n1,2,3\n4,5,6\n", encoding="utf-8")
    cells = ws.open_geometry(tmp_path / "cells.csv")
    assert cells.with_(color="red")._source is cells._source is not None
    assert cells.with_(radius=[1, 2])._source is None
    assert cells.with_(positions=[(0, 0, 0)])._source is None
    assert ws.open_geometry(tmp_path / "cells.csv", labels=["a", "b"])._source is None


@pytest.mark.parametrize(
    ("geometry", "said"),
    [
        (5, "field 'geometry' is 5; it must be a list"),
        ([5], r"geometry\[0\] is 5; it must be an object of one field: surface, lines, points"),
        ([{"cube": {}}], r"geometry\[0\] is a dict; it must be an object of one field"),
        ([{"frame": {}}, {"points": {"place": 1}}], r"geometry\[1\].points: unknown field 'place'"),
        ([{"points": {}}], r"geometry\[0\].points: field 'positions' is missing"),
        ([{"points": {"positions": [[0, 0]]}}], r"points: field 'positions\[0\]' is \[0, 0\]; it must be three"),
        ([{"frame": {"file": {"path": "a.stl"}}}], r"geometry\[0\].frame: unknown field 'file'|comes from no file"),
        ([{"surface": {"file": {}}}], r"geometry\[0\].surface.file: field 'path' is missing"),
        ([{"surface": {"file": {"path": 5}}}], r"geometry\[0\].surface.file: field 'path' is 5"),
        ([{"surface": {"file": {"path": "a.stl", "cache": 1}}}], r"surface.file: unknown field 'cache'"),
        ([{"slice_plane": {"plane": {"point": [0, 0, 0]}}}], r"slice_plane.plane: field 'normal' is missing"),
        ([{"slice_plane": {"volume": 5}}], r"geometry\[0\].slice_plane.volume is 5"),
    ],
)
def test_what_is_wrong_in_a_document_is_said_with_its_place(geometry, said):
    document = {**json.loads(scene().to_json()), "geometry": geometry}
    with pytest.raises(ws.errors.ArgumentError, match=said):
        ws.Scene.from_json(json.dumps(document))


def test_documents_name_files_in_their_folder_only(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "cells.csv").write_text("x,y,z\n1,2,3\n", encoding="utf-8")
    document = json.loads(scene().to_json())
    document["geometry"] = [{"points": {"file": {"path": "../cells.csv"}}}]
    with pytest.raises(ws.errors.FileError, match="lies outside of the document's folder"):
        ws.Scene.from_json(json.dumps(document), tmp_path / "in")
    (allowed,) = ws.Scene.from_json(json.dumps(document), tmp_path / "in", external_files=True).geometry
    assert len(allowed.positions) == 1
    (tmp_path / "in" / "link.csv").symlink_to(tmp_path / "cells.csv")
    document["geometry"] = [{"points": {"file": {"path": "link.csv"}}}]
    with pytest.raises(ws.errors.FileError, match="outside of the document's folder|link out of the folder"):
        ws.Scene.from_json(json.dumps(document), tmp_path / "in")


def test_names_of_folders_are_not_published(tmp_path):
    (tmp_path / "cells.csv").write_text("x,y,z\n1,2,3\n", encoding="utf-8")
    picture = scene(ws.open_geometry(tmp_path / "cells.csv")).render("front", size=(16, 16))
    picture.save(tmp_path / "a.png")
    assert str(tmp_path).encode() not in (tmp_path / "a.png").read_bytes()
    (again,) = ws.Scene.load(tmp_path / "a.png").geometry
    assert len(again.positions) == 1


def test_the_viewer_keeps_geometry_of_which_its_page_knows_names_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the code saves its picture here
    (tmp_path / "cells.csv").write_text("x,y,z\n1,2,3\n", encoding="utf-8")
    own = scene(
        ws.open_geometry(tmp_path / "cells.csv", color="red"), *(SMALL[kind] for kind in ("values", "oblique", "frame"))
    )
    state = ViewerState.of(own)
    assert {tuple(told) for told in state.document["geometry"]} == {("kind", "name", "count", "visible", "id")}
    assert "cells.csv" not in str(state.document)
    changed = state.patched([{"op": "replace", "path": "/background", "value": "white"}])
    assert changed.scene.geometry == own.geometry
    document = changed.file_document((64, 48))
    assert document["geometry"] == scene_json.document_of(own)["geometry"]
    code = python_of(changed, (64, 48))
    names: dict = {}
    exec(code, names)  # noqa: S102 - it is what we check
    assert [fields(one) for one in names["scene"].geometry] == [fields(one) for one in own.geometry]
