"""The plugin for napari: layers of files, pictures of viewers, cameras both ways (micro.md, section 9, item 15).

Most tests need no napari; those that do are run by `make test-napari`, without a window.
"""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path

import napari_fakes as fakes
import numpy as np
import pytest

import wavesplat as ws
from wavesplat._napari import reading
from wavesplat._readers.opening import SUFFIXES
from wavesplat.errors import ArgumentError, WavesplatWarning

ROOT = Path(__file__).parents[3]
MANIFEST = ROOT / "python/wavesplat/_napari/napari.yaml"
#: Other programs warn of their own libraries.
of_napari = pytest.mark.filterwarnings("default")


def letter():
    """The letter F, shape (10, 60, 48), as micro.md has it."""
    samples = np.zeros((10, 60, 48), np.uint16)
    samples[:, 8:52, 10:16] = samples[:, 8:14, 10:38] = samples[:, 26:32, 10:30] = 1000
    return samples


# The manifest.


def manifest():
    return pytest.importorskip("yaml").safe_load(MANIFEST.read_text(encoding="utf-8"))


def test_the_manifest_names_functions_that_exist():
    commands = manifest()["contributions"]["commands"]
    assert len(commands) == 2
    for command in commands:
        module, _, function = command["python_name"].partition(":")
        assert callable(getattr(import_module(module), function))
        assert command["id"].startswith("wavesplat.")


def test_the_manifest_has_the_suffixes_that_are_read():
    (reader,) = manifest()["contributions"]["readers"]
    patterns = {pattern.removeprefix("*").lower() for pattern in reader["filename_patterns"]}
    assert {suffix for suffix, family in SUFFIXES.items() if family != "raw"} <= patterns
    assert reader["accepts_directories"] is True


def test_the_package_points_to_the_manifest():
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    (place,) = re.findall(r'\[project\.entry-points\."napari\.manifest"\]\nwavesplat = "(.*)"', text)
    module, _, name = place.partition(":")
    assert ROOT / "python" / module.replace(".", "/") / name == MANIFEST


@of_napari
def test_npe2_takes_the_manifest():
    npe2 = pytest.importorskip("npe2")
    found = npe2.PluginManifest.from_file(MANIFEST)
    found.validate_imports()
    assert [widget.display_name for widget in found.contributions.widgets] == ["Draw with Wavesplat"]


# Layers of files.


def saved(tmp_path):
    """Two channels at three times, and the samples of the second one."""
    z, y, x = np.mgrid[:6, :20, :16]
    stack = np.array([[z + y + x + 100 * channel + time for channel in (0, 1)] for time in range(3)], np.uint16)
    told = {"axes": "TCZYX", "TimeIncrement": 2.0, "TimeIncrementUnit": "s"}
    told |= {"PhysicalSizeX": 0.2, "PhysicalSizeY": 0.2, "PhysicalSizeZ": 0.7}
    told |= {"Channel": {"Name": ["DAPI", "GFP"], "Color": [0x0000FFFF, 0x00FF00FF]}}
    pytest.importorskip("tifffile").imwrite(tmp_path / "a.ome.tif", stack, metadata=told)
    return tmp_path / "a.ome.tif", stack[:, 1]


def test_channels_are_layers(tmp_path):
    path, samples = saved(tmp_path)
    layers = ws.napari.layers_of(path)
    assert [kind for _, _, kind in layers] == ["image", "image"]
    told = layers[1][1]
    assert (told["name"], told["colormap"], told["blending"]) == ("a.ome.tif GFP", "#00ff00", "additive")
    np.testing.assert_allclose(told["scale"], (2, 0.7, 0.2, 0.2))
    assert (told["units"], told["axis_labels"]) == (["s", "um", "um", "um"], ["t", "z", "y", "x"])
    low, high = told["contrast_limits"]
    assert samples[0].min() <= low < high <= samples[0].max()
    np.testing.assert_array_equal(np.asarray(layers[1][0]), samples)
    assert layers[1][0].chunks[0] == (1, 1, 1)  # a time is read when it is shown


def test_windows_and_what_is_shown_are_the_file_s(tmp_path):
    channels = [ws.Channel("a", (1, 0, 0), window=(5, 60)), ws.Channel("b", (0, 1, 0), is_active=False)]
    volumes = [ws.Volume(letter(), facts=ws.Facts(unit="um", channel=one)) for one in channels]
    layers = [ws.Layer(one, visible=one.facts.channel.is_active, name=one.facts.channel.name) for one in volumes]
    ws.Scene(layers).save_volumes(tmp_path / "a.ome.zarr")
    told = [one[1] for one in ws.napari.layers_of(tmp_path / "a.ome.zarr")]
    assert told[0]["contrast_limits"] == (5, 60)
    assert [one["visible"] for one in told] == [True, False]


def test_segmentations_are_labels_and_patients_have_an_affine(tmp_path):
    numbers = np.kron(np.arange(8).reshape(2, 2, 2), np.ones((8, 9, 10))).astype(np.uint16)
    matrix = np.array([[0, 0, 2, 5], [-3, 0, 0, 6], [0, 4, 0, 7], [0, 0, 0, 1.0]])
    ws.Volume(numbers, world_from_index=matrix, unit="mm", anatomical=True).save(tmp_path / "a.nrrd")
    ((samples, told, kind),) = ws.napari.layers_of(tmp_path / "a.nrrd")
    assert kind == "labels"
    np.testing.assert_array_equal(samples, numbers)
    np.save(tmp_path / "a.npy", numbers.astype(np.float32))
    ((samples, _, kind),) = ws.napari.layers_of(tmp_path / "a.npy")
    assert (kind, samples.dtype) == ("labels", np.int64)
    index = np.array([3, 4, 5, 1])  # z, y, x
    world = matrix @ [5, 4, 3, 1]
    np.testing.assert_allclose((told["affine"] @ index)[:3], world[2::-1])


def test_a_lazy_pyramid_has_its_levels(tmp_path):
    samples = np.random.default_rng(1).integers(0, 900, (20, 300, 140), np.uint16)
    ws.Volume(samples, unit="um").save(tmp_path / "a.ome.zarr")
    ((levels, told, _),) = ws.napari.layers_of(tmp_path / "a.ome.zarr", memory="100 MB")
    assert told["multiscale"] is True
    assert [level.shape for level in levels] == [(20, 300, 140), (10, 150, 70), (5, 75, 35)]
    np.testing.assert_array_equal(levels[0][3, 250:, ::7], samples[3, 250:, ::7])


def test_napari_asks_for_a_reader():
    assert reading.get_reader("a.nrrd") is reading.layers_of
    assert reading.get_reader(["a.nrrd", "b.nrrd"]) is None


# Cameras.


@pytest.mark.parametrize("angle", [0, 40])
def test_a_camera_comes_back(angle):
    viewer = fakes.viewer(fakes.Image(letter()), size=(60, 90))
    lens = {"view_angle": angle} if angle else {"parallel_scale": 12}
    camera = ws.Camera((20, -30, 80), (5, 6, 7), (0, 0.2, 1), **lens)
    ws.napari.set_camera(viewer, camera)
    again = ws.napari.camera_of(viewer)
    assert viewer.camera.perspective == angle
    points = [(5, 6, 7), (9, 1, 4), (0, 0, 0)]
    pixels = [one.project(points, size=(90, 60))[0] for one in (camera, again)]
    np.testing.assert_allclose(*pixels, atol=1e-9)
    if angle:
        np.testing.assert_allclose(again.position, camera.position)


def test_zoom_is_pixels_for_each_unit():
    camera = fakes.Camera(center=(1.0, 2.0, 3.0), zoom=5.0, orientation=("away", "down", "right"), view=(1, 0, 0))
    seen = ws.napari.camera_of(fakes.viewer(camera=camera, size=(60, 80)))
    pixels, _ = seen.project([(3, 2, 1), (4, 2, 1), (3, 3, 1)], size=(80, 60))
    np.testing.assert_allclose(pixels, [(39.5, 29.5), (44.5, 29.5), (39.5, 34.5)])  # x to the right, y down


@pytest.mark.parametrize(
    ("orientation", "mirrored"),
    [(("towards", "down", "right"), True), (("away", "down", "right"), False), (("away", "up", "left"), False)],
)
def test_mirrored_worlds_are_known(orientation, mirrored):
    assert ws.napari.is_mirrored(fakes.viewer(camera=fakes.Camera(orientation=orientation))) is mirrored


def test_other_axes_are_refused():
    viewer = fakes.viewer(fakes.Image(letter()))
    viewer.dims.displayed = (2, 1, 0)
    with pytest.raises(ArgumentError, match=r"the viewer shows axes \(2, 1, 0\) of 3; .*roll them back"):
        ws.napari.camera_of(viewer)


# Pictures.


def test_the_letter_is_drawn_as_napari_shows_it():
    """Row 0 at the top and column 0 at the left, from napari's default camera."""
    camera = fakes.Camera(center=(4.5, 29.5, 23.5))
    viewer = fakes.viewer(fakes.Image(letter()), camera=camera, size=(60, 48))
    picture = ws.napari.draw(viewer)
    green = picture.rgba[..., 1]
    assert np.corrcoef(green.ravel(), letter()[0].ravel())[0, 1] > 0.99
    assert picture.rgba[..., 0].max() == 0
    assert any("mirrored" in note for note in picture.report.notes)
    flat = ws.napari.draw(fakes.viewer(fakes.Image(letter()), camera=camera, size=(60, 48), ndisplay=2))
    assert np.corrcoef(flat.rgba[..., 1].ravel(), letter()[0].ravel())[0, 1] > 0.99


def test_contrast_limits_gamma_and_colours_are_those_of_the_layer():
    samples = np.repeat(np.arange(11, dtype=np.float32)[None, None], 8, 0).repeat(8, 1)
    layer = fakes.Image(samples, color=(1, 0.5, 0), contrast_limits=(2, 8), gamma=2.0)
    camera = fakes.Camera(center=(3.5, 3.5, 5.0), orientation=("away", "down", "right"), view=(1, 0, 0))
    picture = ws.napari.draw(fakes.viewer(layer, camera=camera, size=(8, 11)))
    wanted = np.clip((samples[0, 0] - 2) / 6, 0, 1) ** 2
    # Half of the outermost pixels lies outside.
    np.testing.assert_allclose(picture.rgba[4, :-1, 0], wanted[:-1], atol=0.02)
    np.testing.assert_allclose(picture.rgba[4, :-1, 1], wanted[:-1] / 2, atol=0.02)
    assert picture.report.composite == "maximum"


def test_the_time_is_that_of_the_slider():
    samples = np.zeros((3, 8, 8, 8), np.uint16)
    samples[1] = 700
    layer = fakes.Image(samples, scale=(30, 1, 1, 1))
    volumes = [
        ws.napari.scene_of(fakes.viewer(layer, point=(time, 0, 0, 0))).layers[0].drawn for time in (0.0, 30.0, 31.0)
    ]
    assert [one.samples.max() for one in volumes] == [0, 700, 700]


def test_labels_keep_their_colours():
    numbers = np.kron(np.arange(8).reshape(2, 2, 2), np.ones((4, 4, 4))).astype(np.uint8)
    image = fakes.Image(np.ones((8, 8, 8), np.uint16), rendering="translucent")
    scene = ws.napari.scene_of(fakes.viewer(image, fakes.Labels(numbers, "cells")))
    assert scene.labels.labels[3].color == pytest.approx((1, 0.5, 0.3))
    alone = ws.napari.scene_of(fakes.viewer(fakes.Labels(numbers, "cells")))
    assert len(alone.labels.labels) == 7
    assert alone.render("left", size=(16, 16)).rgba[8, 8, 3] == 1


RENDERINGS = ["mip", "attenuated_mip", "minip", "average", "iso", "translucent", "additive"]


@pytest.mark.parametrize("rendering", RENDERINGS)
def test_labels_show_with_every_rendering(rendering):
    """Over napari's usual maximum, and all other projections, they were left out in silence."""
    z, y, x = np.indices((16, 16, 16))
    cell = ((z - 8) ** 2 + (y - 8) ** 2 + (x - 8) ** 2 < 16).astype(np.uint8) * 3
    image = fakes.Image(np.full((16, 16, 16), 200, np.uint16), rendering=rendering, iso_threshold=500.0)
    image.attenuation = 0.05
    camera = fakes.Camera(center=(7.5, 7.5, 7.5))
    drawn = [
        ws.napari.draw(fakes.viewer(image, *labels, camera=camera, size=(16, 16))).rgba
        for labels in ([], [fakes.Labels(cell, "cells")])
    ]
    changed = np.abs(drawn[1] - drawn[0]).max(axis=-1) > 0.02
    # The label's disc, and nothing but it; its edge is smoothed.
    inside, outside = (cell.max(axis=0) > 0), np.hypot(*np.indices((16, 16)) - 8) > 6
    assert not changed[outside].any()
    if rendering not in ("translucent", "additive"):  # where matter lies before it
        assert changed[inside].mean() > 0.9
        assert drawn[1][8, 8, 0] > drawn[0][8, 8, 0] + 0.2  # its colour is (1, 0.5, 0.3)


def test_labels_alone_are_drawn_by_every_operator():
    numbers = np.kron(np.arange(8).reshape(2, 2, 2), np.ones((4, 4, 4))).astype(np.uint8)
    viewer = fakes.viewer(fakes.Labels(numbers, "cells"), camera=fakes.Camera(center=(3.5, 3.5, 3.5)), size=(8, 8))
    for composite in (None, "maximum", "mean"):
        picture = ws.napari.draw(viewer, composite=composite)
        assert len(picture.report["labels"]) == 7
        assert picture.rgba[6, 6, 0] > 0.2


def test_what_cannot_be_drawn_is_told():
    with pytest.warns(WavesplatWarning, match="layers that are left out: arrows, flat"):
        ws.napari.scene_of(fakes.viewer(fakes.Image(letter()), fakes.Vectors(), fakes.Points([(1, 2)], name="flat")))
    with pytest.raises(ArgumentError, match="no visible layer can be drawn"):
        ws.napari.scene_of(fakes.viewer(fakes.Points([(1, 2, 3)])))


# Geometry.


def test_points_are_balls_of_their_size_and_colour():
    camera = fakes.Camera(center=(4.5, 29.5, 23.5))
    dark = fakes.Image(np.zeros((10, 60, 48), np.uint16), rendering="translucent")
    spots = fakes.Points([(2, 20, 10), (2, 40, 30)], size=8.0, face_color=[(1, 0, 0, 1), (0, 0.5, 1, 1)])
    viewer = fakes.viewer(dark, spots, camera=camera, size=(60, 48))
    (shape,) = ws.napari.scene_of(viewer).geometry
    np.testing.assert_allclose(shape.positions, [(10, 20, 2), (30, 40, 2)])
    assert np.unique(shape.radius) == [4]
    rgba = ws.napari.draw(viewer).rgba
    np.testing.assert_allclose(rgba[20, 10], (1, 0, 0, 1), atol=0.13)  # highlights are compressed
    np.testing.assert_allclose(rgba[40, 30], (0, 0.5, 1, 1), atol=0.13)
    # As wide as 8 pixels.
    assert np.sum(rgba[20, :, 0] > 0.5) == pytest.approx(8, abs=1)


def test_points_of_other_times_and_hidden_ones_are_left_out():
    samples = np.zeros((3, 8, 8, 8), np.uint16)
    spots = fakes.Points([(0, 1, 1, 1), (1, 2, 2, 2), (1, 3, 3, 3)], shown=np.array([True, True, False]))
    at = [fakes.viewer(fakes.Image(samples), spots, point=(time, 0, 0, 0)) for time in (1.0, 2.0)]
    (shape,) = ws.napari.scene_of(at[0]).geometry
    np.testing.assert_allclose(shape.positions, [(2, 2, 2)])
    assert ws.napari.scene_of(at[1]).geometry == ()


def test_tracks_have_their_tails():
    rows = [(7, time, 1, 2, time) for time in range(6)] + [(8, 5, 4, 4, 4), (9, 0, 3, 3, 3), (9, 1, 3, 3, 4)]
    tracks = fakes.Tracks(rows, tail_length=2)
    viewer = fakes.viewer(fakes.Image(np.zeros((6, 8, 8, 8), np.uint16)), tracks, point=(4.0, 0, 0, 0))
    (shape,) = ws.napari.scene_of(viewer).geometry
    # Of one track three times; of the others a single position, and none.
    np.testing.assert_allclose(shape.paths.positions, [(2, 2, 1), (3, 2, 1), (4, 2, 1)])
    assert shape.width == 2


def test_shapes_and_surfaces_are_where_they_are():
    image = fakes.Image(np.zeros((8, 8, 8), np.uint16))
    corners = np.array([(1, 1, 1), (1, 5, 1), (1, 5, 6)], float)
    boxes = fakes.Shapes([corners], shape_type="polygon", edge_width=2.0)
    mesh = fakes.Surface((corners, np.array([(0, 1, 2)]), np.array([0.0, 0.5, 1.0])))
    lines, surface = ws.napari.scene_of(fakes.viewer(image, boxes, mesh)).geometry
    np.testing.assert_allclose(lines.paths.positions, [(1, 1, 1), (1, 5, 1), (6, 5, 1), (1, 1, 1)])
    assert lines.radius == 1
    np.testing.assert_allclose(surface.vertices, corners[:, ::-1])
    np.testing.assert_allclose(np.asarray(surface.color)[:, 0], (0, 0.5, 1))


@pytest.mark.parametrize("rendering", ["translucent", "additive", "attenuated_mip", "minip", "average", "iso"])
def test_every_rendering_draws(rendering):
    samples = np.pad(letter(), ((2, 2), (0, 0), (0, 0)))
    layer = fakes.Image(samples, rendering=rendering, iso_threshold=500.0, attenuation=0.05)
    camera = fakes.Camera(center=(4.5, 29.5, 23.5))
    green = ws.napari.draw(fakes.viewer(layer, camera=camera, size=(60, 48))).rgba[..., 1]
    assert (green.max() > 0.3) == (rendering != "minip")


# With napari itself.


@of_napari
def test_napari_adds_our_layers(tmp_path):
    layers = pytest.importorskip("napari.layers")
    components = pytest.importorskip("napari.components")
    path, samples = saved(tmp_path)
    viewer = components.ViewerModel(ndisplay=3)
    for one in ws.napari.layers_of(path):
        viewer.add_layer(layers.Layer.create(*one))
    assert [layer.name for layer in viewer.layers] == ["a.ome.tif DAPI", "a.ome.tif GFP"]
    viewer.dims.set_point(0, 4.0)
    volume = ws.napari.scene_of(viewer).layers[1].drawn
    np.testing.assert_array_equal(volume.samples, samples[2])
    assert (volume.spacing, volume.unit) == (pytest.approx((0.2, 0.2, 0.7)), "um")


@of_napari
@pytest.mark.parametrize("perspective", [0, 30])
@pytest.mark.parametrize(
    "orientation", [("towards", "down", "right"), ("away", "down", "right"), ("away", "up", "left")]
)
@pytest.mark.every_pair
def test_points_are_where_napari_shows_them(orientation, perspective):
    components = pytest.importorskip("napari.components")
    vispy = pytest.importorskip("vispy.scene")
    cameras = pytest.importorskip("napari._vispy.camera")
    viewer = components.ViewerModel(ndisplay=3)
    viewer.add_image(letter())
    camera = viewer.scene.camera if hasattr(viewer, "scene") else viewer.camera
    camera.orientation, camera.perspective = orientation, perspective
    camera.angles, camera.center, camera.zoom = (20, -35, 50), (4, 30, 25), 7
    height, width = viewer.canvas.size
    box = vispy.ViewBox(parent=vispy.Node())
    box.size = (width, height)
    cameras.VispyCamera(box, camera, viewer.dims)._on_ndisplay_change()
    points = np.array([(10, 20, 3), (40, 50, 8), (0, 0, 0)], float)
    shown = box.scene.transform.map(points)
    seen = ws.napari.camera_of(viewer)
    pixels, _ = seen.project(points, size=(width, height))
    if ws.napari.is_mirrored(viewer):
        pixels[:, 0] = width - 1 - pixels[:, 0]
    np.testing.assert_allclose(pixels, shown[:, :2] / shown[:, 3:] - 0.5, atol=1e-3)
    other = components.ViewerModel(ndisplay=3)
    other.add_image(letter())
    (other.scene.camera if hasattr(other, "scene") else other.camera).orientation = orientation
    ws.napari.set_camera(other, seen)
    again, _ = ws.napari.camera_of(other).project(points, size=(width, height))
    np.testing.assert_allclose(again, seen.project(points, size=(width, height))[0], atol=1e-6)


@of_napari
def test_the_widget_draws_to_a_window(monkeypatch):
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    components = pytest.importorskip("napari.components")
    magicgui = pytest.importorskip("magicgui")
    pytest.importorskip("qtpy.QtWidgets").QApplication.instance() or pytest.importorskip("qtpy.QtWidgets").QApplication(
        []
    )
    from wavesplat._napari.widget import draw_view

    viewer = components.ViewerModel(ndisplay=3)
    viewer.add_image(letter(), name="F")
    viewer.canvas.size = (60, 80)
    form = magicgui.magicgui(draw_view)  # as napari makes it
    assert [part.name for part in form][1:5] == ["quality", "operator", "enlarged", "show_in"]
    form.enlarged.value, form.show_in.value = 2, "new layer"
    form(viewer)
    picture = viewer.layers["Wavesplat"]
    assert (picture.rgb, picture.data.shape, picture.data.dtype) == (True, (120, 160, 3), np.uint8)
    assert picture.metadata["report"]["composite"] == "maximum"


def test_numbers_of_later_times_are_kept(tmp_path):
    """64-bit labels are held in the narrowest type of each time: 300 became 44 beside a first time of bytes."""
    labels = np.zeros((2, 12, 14, 16), np.int64)
    labels[0, 2:10, 2:12, 2:14], labels[1, 2:10, 2:12, 2:14] = 200, 300
    labels[:, 4:8, 4:8, 4:8] = 7
    np.save(tmp_path / "cells.npy", labels)
    ((samples, _, kind),) = reading.layers_of(str(tmp_path / "cells.npy"))
    assert kind == "labels"
    np.testing.assert_array_equal(samples.compute(), labels)
    with pytest.raises(ArgumentError, match="time 1 has samples of uint16"):
        reading._samples_at(ws.Series([ws.Volume(one) for one in labels]), 1, np.dtype(np.uint8))


@of_napari
def test_geometry_of_napari_itself():
    components = pytest.importorskip("napari.components")
    viewer = components.ViewerModel(ndisplay=3)
    viewer.add_image(np.zeros((6, 8, 8, 8), np.uint16), scale=(1, 2, 0.5, 0.5))
    scale = (1, 2, 0.5, 0.5)
    viewer.add_points([(4, 1, 2, 3), (5, 0, 0, 0)], size=[4, 2], face_color=["red", "blue"], scale=scale)
    rows = [(7, time, 1, 2, time) for time in range(6)]
    viewer.add_tracks(rows, tail_length=2, head_length=0, scale=scale)
    viewer.add_shapes([[(1, 1, 1), (1, 5, 1), (1, 5, 6)]], shape_type="polygon", edge_width=2, edge_color="lime")
    corners = np.array([(1, 1, 1), (1, 5, 1), (1, 5, 6)], float)
    viewer.add_surface((corners, np.array([(0, 1, 2)]), np.array([0.0, 0.5, 1.0])), colormap="gray")
    viewer.dims.set_point(0, 4.0)
    points, tracks, outline, surface = ws.napari.scene_of(viewer).geometry
    np.testing.assert_allclose(points.positions, [(1.5, 1, 2)])
    assert points.radius == pytest.approx(2 * (2 + 0.5 + 0.5) / 3)
    np.testing.assert_allclose(np.ravel(points.color)[:3], (1, 0, 0))
    np.testing.assert_allclose(tracks.paths.positions, [(1, 1, 2), (1.5, 1, 2), (2, 1, 2)])
    np.testing.assert_allclose(outline.paths.positions, [(1, 1, 1), (1, 5, 1), (6, 5, 1), (1, 1, 1)])
    assert outline.radius == 1
    np.testing.assert_allclose(np.asarray(surface.color)[:, 0], (0, 0.5, 1), atol=0.01)
    assert ws.napari.draw(viewer, size=(60, 60)).rgba.max() > 0
