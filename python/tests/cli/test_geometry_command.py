"""Geometry on the command line: `--surface`, `--lines`, `--points`, `--slice-plane`, `--frame`, `--grid`."""

from __future__ import annotations

import json

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._cli import app
from wavesplat._cli.options.geometry import GeometryOptions, opened_geometry


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    samples = np.random.default_rng(0).random((20, 20, 20), np.float32)
    ws.Volume(samples, spacing=(0.5, 0.5, 0.5), unit="um").save("cells.nrrd")
    (tmp_path / "spots.csv").write_text("x_um,y_um,z_um,speed\n2,3,4,0.5\n5,5,5,0.7\n", encoding="utf-8")
    (tmp_path / "tracks.csv").write_text("x,y,z,track_id\n2,3,4,1\n5,5,5,1\n", encoding="utf-8")
    return tmp_path


def shapes(unit="um", **options):
    return opened_geometry(GeometryOptions(**options), unit, quiet=True)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("spots.csv", {}),
        ("spots.csv:yellow:2um", {"color": (1, 1, 0, 1), "radius": 2}),
        ("spots.csv:2000nm:#ff0000:0.5", {"color": (1, 0, 0, 1), "radius": 2, "opacity": 0.5}),
        ("spots.csv:8px:1,0,0", {"color": (1, 0, 0, 1), "size": 8}),
        ("spots.csv:values=speed:hot:0,1", {"cmap": "hot", "clim": (0, 1)}),
        ("spots.csv:values=speed", {"cmap": "viridis", "clim": (0.5, 0.7)}),
        ("spots.csv:values=speed:0%,100%:0.25", {"clim": (0.5, 0.7), "opacity": 0.25}),
    ],
)
def test_words_of_points(here, text, expected):
    (points,) = shapes(points=[text])
    assert points.positions.tolist() == [[2, 3, 4], [5, 5, 5]]
    assert {name: getattr(points, name) for name in expected} == expected


def test_words_of_lines_slices_and_frames(here):
    (lines,) = shapes(lines=["tracks.csv:by-direction:3px"])
    assert (lines.color, lines.width) == ("direction", 3)
    assert shapes(lines=["tracks.csv:0.5um"], unit="mm")[0].radius == 5e-4
    one, two, three = shapes(slice_plane=["axial", "xz:12:hot:0.5", "yz:-35mm:bone"], unit="um")
    assert (one.plane, one.index, one.position) == ("axial", None, None)
    assert (two.plane, two.index, two.cmap, two.opacity) == ("xz", 12, "hot", 0.5)
    assert (three.position, three.window) == (-35000, "bone")
    assert [frame.grid for frame in shapes(frame=True) + shapes(grid=True)] == [False, True]
    assert shapes() == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (
            {"points": ["spots.csv:reddish"]},
            "has 'reddish', which is no colour, colour map, opacity or size; it is FILE",
        ),
        ({"points": ["spots.csv:2"]}, "has '2': an opacity is 0..1, and a size has a unit, as 2px or 2mm"),
        (
            {"points": ["spots.csv:2furlong"]},
            "2 furlong, whose unit is unknown; give um, mm or another length, or give a",
        ),
        ({"points": ["spots.csv:hot"]}, "has a colour map and no values; say which, as values=NAME"),
        ({"points": ["spots.csv:red:blue"]}, "says its color twice, the second time as 'blue'"),
        ({"points": ["spot.csv:red"]}, "begins with no file that is there; it is FILE"),
        ({"surface": ["spots.csv"]}, "the file holds points, and a surface is asked for"),
        ({"slice_plane": ["oblique"]}, "unknown plane 'oblique'"),
        ({"slice_plane": ["axial:red"]}, "has a color; a slice has a colour map"),
    ],
)
def test_what_is_wrong_is_said(here, options, said):
    with pytest.raises((ws.errors.ArgumentError, ws.errors.FileError), match=said):
        shapes(**options)


def test_a_size_needs_the_unit_of_the_volume(here):
    with pytest.raises(ws.errors.ArgumentError, match="the volume's file names no unit; give it with --unit"):
        shapes(points=["spots.csv:2um"], unit=None)


def test_render_draws_what_the_options_say(here, capsys):
    command = ["render", "cells.nrrd", "-o", "a.png", "--size", "120x100", "--view", "xy", "--json"]
    command += ["--points", "spots.csv:red:1um", "--slice-plane", "xy:9:0.5", "--frame"]
    with pytest.raises(SystemExit) as ended:
        app(command)
    assert not ended.value.code
    report = json.loads(capsys.readouterr().out)["report"]
    assert [shape["kind"] for shape in report["geometry"]] == ["points", "slice plane", "frame"]
    scene = ws.Scene.load("a.png")
    assert [type(shape).__name__ for shape in scene.geometry] == ["Points", "SlicePlane", "Frame"]
    # The same from Python, to the byte.
    ws.Scene.load("a.png").render(ws.Camera.from_json(report["camera"]), size=(120, 100)).save("b.png", scene=False)
    from PIL import Image

    assert np.array_equal(np.asarray(Image.open("a.png")), np.asarray(Image.open("b.png")))
