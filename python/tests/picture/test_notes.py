"""A picture of one colour says why, in its report and on the command line."""

from __future__ import annotations

import json

import numpy as np
import pytest

import wavesplat as ws

VOLUME = ws.examples.ripples(12)
FLAT = ws.Volume(np.full((8, 8, 8), 7, np.uint8))
SIZE = {"size": (24, 24), "background": "black"}
#: Options for a camera so near that nothing but the volume is in the picture.
NEAR = {"camera": ws.Camera.orbit(VOLUME, zoom=2, fit="view")}
FOG = ws.TransferFunction([(0, 0), (255, 1)], [(0, 1, 1, 1)])
BEYOND = ws.TransferFunction([(1000, 0), (2000, 1)], [(1000, 0, 0, 0), (2000, 1, 1, 1)])


def notes(picture):
    return " ".join(picture.report.get("notes", []))


@pytest.mark.parametrize(
    ("options", "note"),
    [
        ({"composite": ws.FirstHit(900)}, "no surface at iso value 900: the volume's values are"),
        ({"look": BEYOND}, "transparent over the volume's values"),
        ({"look": BEYOND, "composite": "maximum"}, "the colours do not change over what the rays show"),
        ({"composite": ws.XRay(1000, 1.0)} | NEAR, "lets 100 % of the light through everywhere"),
        ({"composite": ws.XRay(-1e6, 1.0)} | NEAR, "lets 0 % of the light through everywhere"),
        ({"camera": ws.Camera.orbit(VOLUME, zoom=1e-5, fit="view")}, "shows it smaller than a pixel"),
        ({"camera": ws.Camera((500, 900, 0), (500, 0, 0), (0, 0, 1), view_angle=1)}, "the view misses the volume"),
    ],
)
def test_pictures_of_one_colour(options, note):
    options = {"look": FOG} | options if "composite" not in options else options
    assert note in notes(ws.render(VOLUME, **SIZE, **options))


def test_a_map_over_the_range_of_one_value():
    """It said: try --preset auto, which one value has not."""
    note = notes(ws.render(FLAT, ws.TransferFunction.from_colormap("viridis", FLAT), **SIZE))
    assert "every sample of the volume is 7, where the transfer function is transparent; give a range" in note


@pytest.mark.parametrize("composite", ["mean", "sum", "minimum", "maximum", "x-ray"])
def test_volumes_of_one_value(composite):
    curves = ws.TransferFunction([(0, 1)], [(0, 0, 0, 0), (1e9, 0, 0, 0)])
    assert "every sample of the volume is 7" in notes(ws.render(FLAT, curves, composite=composite, **SIZE))


@pytest.mark.parametrize(
    ("options", "note"),
    [
        ({"clim": (1000, 2000)}, "lie beyond the window, 1000 to 2000"),
        ({"transfer_function": BEYOND}, "lie beyond the range of the transfer function"),
        ({"center": (500, 500, 500)}, "no part of the volume lies in the picture"),
    ],
)
def test_slices_of_one_colour(options, note):
    assert note in notes(ws.slice(VOLUME, size=(24, 24), **options))
    assert "every value in the picture is 7" in notes(ws.slice(FLAT, size=(24, 24)))


def test_a_center_that_is_no_place():
    with pytest.raises(ws.errors.ArgumentError, match="center of the slice is .*; give finite numbers"):
        ws.slice(VOLUME, center=(np.nan, 0, 0))


def test_pictures_that_show_something_say_nothing():
    for composite in ("over", "maximum", "mean", "sum", "minimum", "x-ray"):
        assert "notes" not in ws.render(VOLUME, composite=composite, **SIZE).report
    assert "notes" not in ws.render(VOLUME, composite=ws.FirstHit(127), **SIZE).report
    assert "notes" not in ws.slice(VOLUME).report
    assert "notes" not in ws.render(VOLUME, BEYOND, size=(4, 4)).report  # too small to tell


def test_the_command_line_says_it(wavesplat, ramp_file, tmp_path):
    arguments = ["render", ramp_file, "-o", tmp_path / "a.png", "--composite", "first-hit", "--iso-value", "900"]
    done = wavesplat(*arguments)
    assert done.returncode == 0
    assert done.stderr.startswith("wavesplat: note: there is no surface at iso value 900")
    assert done.stderr.count("\n") == 1
    quiet = wavesplat(*arguments, "--quiet", "--json")
    assert quiet.stderr == ""
    assert "no surface" in json.loads(quiet.stdout)["report"]["notes"][0]
    done = wavesplat("slice", ramp_file, "-o", tmp_path / "a.png", "--clim", "1000,2000")
    assert "note: the values in the picture" in done.stderr


def test_steps_between_distant_slices_are_told_with_what_softens_them():
    """The clinic's terraces: 25 slices of a head, 8 times as far apart as their samples."""
    head = np.hypot(*np.meshgrid(np.linspace(-1, 1, 12), np.linspace(-1, 1, 40), indexing="ij"))[..., None]
    samples = np.repeat(np.where(head < 0.8, 500, 5), 40, axis=2).astype(np.int16)

    def told(spacing, **options):
        volume = ws.Volume(samples, spacing=spacing, facts=ws.Facts(unit="mm", is_anatomical=True))
        smooth = options.pop("smooth", 0)
        picture = ws.render(volume.smoothed(smooth) if smooth else volume, size=(24, 24), **options)
        return [note for note in picture.report.get("notes", []) if "steps" in note]

    (note,) = told((0.8, 0.8, 6.4))
    assert "8 times as far apart" in note
    assert "--smooth 1" in note
    assert told((0.8, 0.8, 1.6)) == []
    assert told((0.8, 0.8, 6.4), smooth=1) == []
    assert told((0.8, 0.8, 6.4), composite="maximum") == []
    assert told((0.8, 0.8, 6.4), quality="draft") == []


def test_layers_that_lie_apart_are_told():
    def at(x, name):
        matrix = np.diag([1.0, 1, 1, 1])
        matrix[0, 3] = x
        return ws.Volume(np.arange(1000.0).reshape(10, 10, 10), world_from_index=matrix, unit="mm", name=name)

    def told(x):
        report = ws.render([at(0, "ct"), at(x, "pet")], size=(16, 16)).report
        return [note for note in report.get("notes", []) if "away from" in note]

    (note,) = told(790)
    assert note.startswith("the layer 'pet' lies 781 mm away from 'ct', at x 790 to 799, y 0 to 9, z 0 to 9")
    # Overlapping, and tiles beside each other.
    assert told(5) == told(9.5) == []
