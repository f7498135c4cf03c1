"""Colour bars of what stands in space and has values: name, unit, range and colours of each kind of geometry."""

from __future__ import annotations

import numpy as np
import pytest
from figure_pictures import texts

import wavesplat as ws
from wavesplat._cli import app
from wavesplat._looks.curves import colormaps
from wavesplat._picture.marks import Ramp

LOOK = ws.TransferFunction([(0, 0.0), (1, 0.1)], [(0, 1, 1, 1)])
CORNERS = [(2.0, 2.0, 5.0), (8.0, 2.0, 5.0), (2.0, 8.0, 5.0)]
OF_KINDS = {
    "surface": ws.Surface(
        CORNERS, [(0, 1, 2)], values=[20, 50, 80], cmap="viridis", quantity="pressure", value_unit="Pa"
    ),
    "lines": ws.Lines(np.array(CORNERS), values=[0, 1, 4], cmap="turbo", clim=(0, 2), quantity="age", value_unit="s"),
    "points": ws.Points(CORNERS, values=[-3, 0, 3], cmap="coolwarm", radius=1, quantity="charge", value_unit="e"),
    "slice plane": ws.SlicePlane(plane="xy", clim=(0, 5), cmap="inferno"),
}
#: Kind of geometry -> title of its bar, first and last number, colour map.
EXPECTED = {
    "surface": ("pressure (Pa)", "20", "80", "viridis"),
    "lines": ("age (s)", "0", "2", "turbo"),
    "points": ("charge (e)", "\N{MINUS SIGN}3", "3", "coolwarm"),
    "slice plane": ("slice plane, rho (kg)", "0", "5", "inferno"),
}


def scene(*geometry, **options):
    facts = ws.Facts(quantity="rho", value_unit="kg")
    samples = np.linspace(0, 1, 1000, dtype=np.float32).reshape(10, 10, 10)
    return ws.Scene(ws.Volume(samples, facts=facts), LOOK, geometry=list(geometry), **options)


def bars(picture, **options):
    """Texts and colours of the bars of a figure."""
    figure = picture.annotated(**{"colorbar": True} | options)
    return texts(figure), [mark for mark in figure._canvas.marks if isinstance(mark, Ramp)]


@pytest.mark.parametrize("kind", EXPECTED)
def test_each_kind_has_a_bar_of_its_name_range_and_colours(kind):
    told, ramps = bars(scene(OF_KINDS[kind]).render(size=(200, 200)))
    title, low, high, cmap = EXPECTED[kind]
    assert {"rho (kg)", title, low, high} <= set(told)
    assert len(ramps) == 2
    _, colors = colormaps.colors_of(cmap)
    ends = [stop[1] for stop in (ramps[1].stops[0], ramps[1].stops[-1])]
    assert np.allclose(ends, colors[[0, -1]], atol=1e-5)


def test_all_kinds_have_bars_in_one_figure_and_slices_alike_have_one():
    every = scene(*OF_KINDS.values(), ws.SlicePlane(plane="xz", clim=(0, 5), cmap="inferno"), ws.Frame())
    picture = every.render(size=(400, 300))
    told, ramps = bars(picture)
    assert len(ramps) == 5
    assert {title for title, *_ in EXPECTED.values()} <= set(told)
    assert len(picture.report["geometry_colors"]) == 4
    assert len(bars(picture, colorbar=["lines", "points"])[1]) == 2
    with pytest.raises(ws.errors.ArgumentError, match="no layer is named 'tubes'; there are: .*'lines'"):
        picture.annotated(colorbar="tubes")


def test_hidden_shapes_and_shapes_of_one_colour_have_none():
    hidden = OF_KINDS["points"].with_(visible=False)
    picture = scene(hidden, ws.Points(CORNERS, color="red")).render(size=(60, 60))
    assert len(bars(picture)[1]) == 1
    assert "geometry_colors" not in picture.report


def test_an_isosurface_needs_no_bar_where_its_lines_have_one():
    picture = scene(OF_KINDS["lines"]).render(size=(200, 200), composite=ws.FirstHit(0.5))
    told, ramps = bars(picture)
    assert len(ramps) == 1
    assert "age (s)" in told
    assert "v" in bars(picture, values="v")[0]


def test_values_of_files_are_named_after_them_on_the_command_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene().layers[0].volume.save("box.nrrd")
    (tmp_path / "a.csv").write_text("x,y,z,speed (m/s)\n2,2,5,20\n8,2,5,80\n", encoding="utf-8")
    command = ["render", "box.nrrd", "--points", "a.csv:values=speed:turbo", "--size", "200"]
    app([*command, "--colorbar", "-o", "a.svg"], standalone_mode=False)
    svg = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert all(f">{text}<" in svg for text in ("speed (m/s)", "20", "80"))
    (points,) = ws.Scene([ws.open("box.nrrd"), ws.open_geometry("a.csv", values="speed")]).geometry
    assert (points.quantity, points.value_unit) == ("speed", "m/s")
    assert points.with_(color="red", values=None, cmap=None, clim=None)._mapped is None


def test_values_of_another_file_are_named_by_its_measure_not_by_a_patient(tmp_path):
    nib = pytest.importorskip("nibabel")
    header = {"head": [2, 0, 20], "valid": "1", "filename": "a", "volume": [9, 9, 9], "voxelsize": [1, 1, 1]}
    axes = {"xras": [-1, 0, 0], "yras": [0, 0, -1], "zras": [0, 1, 0], "cras": [0, 0, 0]}
    faces = np.array([(0, 1, 2)])
    nib.freesurfer.write_geometry(str(tmp_path / "lh.pial"), np.array(CORNERS), faces, volume_info=header | axes)
    for name, quantity in (("lh.thickness", "thickness"), ("DOE_JOHN", None)):
        nib.freesurfer.write_morph_data(str(tmp_path / name), np.array([1.0, 2, 3], np.float32))
        surface = ws.open_geometry(tmp_path / "lh.pial", values=str(tmp_path / name))
        assert surface.quantity == quantity
