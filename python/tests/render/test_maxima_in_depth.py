"""Maxima that tell depth: where they are, colours by depth, and attenuation by what lies in front."""

import re
from dataclasses import fields

import cmap
import numpy as np
import pytest
from typer.testing import CliRunner

import wavesplat as ws
from wavesplat._cli import app
from wavesplat.errors import ArgumentError

GREY = ws.TransferFunction([(0, 0), (1, 1)], [(0, 0, 0, 0), (200, 1, 1, 1)])
#: Samples (x, y, z) that are bright, and their values.
POINTS = {(4, 5, 1): 200, (14, 6, 10): 200, (9, 14, 19): 100}
SHAPE = (21, 20, 20)


def points(**facts):
    samples = np.zeros(SHAPE, np.uint8)
    for (x, y, z), value in POINTS.items():
        samples[z, y, x] = value
    return ws.Volume(samples, spacing=(0.5, 0.5, 2.0), unit="µm", **facts)


def drawn(volume, composite, camera=None, **options):
    camera = camera or ws.Camera.view(volume, "xy")
    return ws.render(volume, GREY, camera, composite=composite, size=(200, 200), **options)


def at_points(volume, picture):
    """Rows and columns of the points in the picture, and their depths."""
    places = np.array(list(POINTS)) @ volume.world_from_index[:3, :3].T + volume.world_from_index[:3, 3]
    pixels, depths = picture.camera.project(places, size=picture.size)
    columns, rows = np.rint(pixels).astype(int).T
    return rows, columns, depths


@pytest.mark.parametrize("eye", ["xy", (30, 20), (200, -40)])
@pytest.mark.parametrize(
    "composite",
    ["maximum", ws.DepthShadedMaximum(0.3), ws.LocalMaximum(50), ws.AttenuatedMaximum(0.05), "depth-colored-maximum"],
)
def test_the_depth_of_a_maximum_is_that_of_its_sample(composite, eye):
    volume = points()
    camera = ws.Camera.view(volume, eye) if isinstance(eye, str) else ws.Camera.orbit(volume, *eye)
    picture = drawn(volume, composite, camera, depth=True, quality=ws.Sampling(4, 2))
    rows, columns, depths = at_points(volume, picture)
    np.testing.assert_allclose(picture.depth[rows, columns], depths, atol=0.6)
    has_depth, has_value = np.isfinite(picture.depth), np.isfinite(picture.value)
    assert not (has_depth & ~has_value).any()
    # Pixels at the rim are covered in part, and their middle may lie beyond it.
    assert (has_value & ~has_depth).sum() < 0.05 * has_value.sum()


def test_the_depth_of_a_minimum_is_that_of_its_sample_and_integrals_have_none():
    volume = points()
    dark = ws.Volume(200 - volume.samples, spacing=volume.spacing)
    picture = drawn(dark, "minimum", ws.Camera.view(dark, "xy"), depth=True)
    rows, columns, depths = at_points(dark, picture)
    np.testing.assert_allclose(picture.depth[rows, columns], depths, atol=0.6)
    for composite in ("mean", "sum", "x-ray"):
        assert np.isnan(drawn(volume, composite, depth=True).depth).all()


@pytest.mark.parametrize("axis", [None, "x", "y", "z"])
@pytest.mark.parametrize("view_angle", [None, 25])
def test_hues_are_those_of_the_places_and_brightness_is_that_of_the_values(axis, view_angle):
    volume = points()
    camera = ws.Camera.view(volume, "xy", view_angle=view_angle)
    picture = drawn(volume, ws.DepthColoredMaximum("viridis", axis), camera, background="black")
    rows, columns, _ = at_points(volume, picture)
    shares = {
        None: [z / (SHAPE[0] - 1) for x, y, z in POINTS],
        "x": [x / (SHAPE[2] - 1) for x, y, z in POINTS],
        "y": [y / (SHAPE[1] - 1) for x, y, z in POINTS],
        "z": [z / (SHAPE[0] - 1) for x, y, z in POINTS],
    }[axis]
    if axis is None and camera.view_angle is None:
        assert camera.position[2] < 0, "the view xy is from the first slice"
    bright = picture.value[rows, columns] / 200
    want = np.array(cmap.Colormap("viridis")(shares))[:, :3] * bright[:, None]
    np.testing.assert_allclose(picture.rgba[rows, columns, :3], want, atol=0.03)
    assert picture.report["depth_colors"]["axis"] == axis
    assert picture.report["composite"] == "depth-colored-maximum"
    assert picture.depth is None


def test_colours_along_an_axis_are_the_same_from_behind():
    volume = points()
    colored = ws.DepthColoredMaximum("turbo", "z")
    cameras = [ws.Camera.orbit(volume, azimuth, elevation) for azimuth, elevation in ((0, 80), (180, -80), (70, 10))]
    seen = []
    for camera in cameras:
        picture = drawn(volume, colored, camera, background="black", quality=ws.Sampling(4, 2))
        rows, columns, _ = at_points(volume, picture)
        seen.append(picture.rgba[rows, columns, :3] / picture.rgba[rows, columns, :3].max(axis=1, keepdims=True))
    np.testing.assert_allclose(seen[1], seen[0], atol=0.06)
    np.testing.assert_allclose(seen[2], seen[0], atol=0.06)


def test_what_is_dark_is_clear_on_any_background():
    volume = points()
    on_black, on_white, clear = (
        drawn(volume, "depth-colored-maximum", background=color) for color in ("black", "white", "transparent")
    )
    np.testing.assert_array_equal(on_white.rgba[0, 0], 1)
    np.testing.assert_array_equal(on_black.rgba[0, 0], (0, 0, 0, 1))
    assert clear.rgba[0, 0, 3] == 0
    np.testing.assert_allclose(on_black.rgba[..., :3], clear.rgba[..., :3], atol=1e-6)
    np.testing.assert_allclose(on_white.rgba, clear.rgba + 1 - clear.rgba[..., 3:], atol=1e-6)


def test_depth_colours_are_the_same_of_levels_threads_and_clusters(tmp_path):
    volume = points()
    volume.save(tmp_path / "points.ome.zarr")
    lazy = ws.open(tmp_path / "points.ome.zarr", memory="10MB", level=0)
    camera = ws.Camera.orbit(volume, 30, 20)
    colored = ws.DepthColoredMaximum("turbo", "z")
    plain = drawn(volume, colored, camera, device="cpu")
    for other in (
        drawn(volume, colored, camera, device="cpu", threads=1),
        drawn(lazy, colored, camera),
        drawn(lazy, colored, camera, client="threads"),
        drawn(lazy, colored, camera, client="threads", segments=4),
    ):
        np.testing.assert_array_equal(other.rgba, plain.rgba)


def test_several_layers_are_added_as_light():
    volume = points()
    layers = [ws.Layer(volume, GREY), ws.Layer(volume, GREY)]
    one, two = (
        ws.render(of, camera=ws.Camera.view(volume, "xy"), composite=ws.DepthColoredMaximum(), size=(60, 60))
        for of in (layers[:1], layers)
    )
    np.testing.assert_allclose(two.rgba[..., :3], np.minimum(2 * one.rgba[..., :3], 1), atol=1e-5)


def test_a_colour_bar_shows_the_depths():
    volume = points()
    for axis, title in ((None, "depth (µm)"), ("z", "z (µm)")):
        picture = drawn(volume, ws.DepthColoredMaximum("turbo", axis), background="black").annotated(colorbar=True)
        texts = [mark.text for mark in picture._canvas.marks if hasattr(mark, "text")]
        assert title in texts
        assert {"0", "40"} <= set(texts), texts


def plates(gap, attenuation):
    """The maximum of a ray through a plate of 100, `gap` voxels thick, and a layer of 180 behind it, attenuated."""
    samples = np.zeros((41, 9, 9), np.float32)
    samples[4 : 4 + gap] = 100
    samples[30] = 180
    volume = ws.Volume(samples, spacing=(1, 1, 1))
    camera = ws.Camera((4, 4, -60), (4, 4, 0), (0, -1, 0), parallel_scale=3)
    picture = ws.render(
        volume,
        ws.TransferFunction([(0, 1)], [(0, 0, 0, 0), (200, 1, 1, 1)]),
        camera,
        composite=ws.AttenuatedMaximum(attenuation),
        size=(9, 9),
        quality=ws.Sampling(1, 1),
    )
    assert picture.report["attenuated"] == (0, 200, attenuation)
    return picture.value[4, 4]


@pytest.mark.parametrize("attenuation", [0, 0.01, 0.2, 3.0])
def test_bright_matter_in_front_dims_by_the_formula(attenuation):
    # The plate's trapezoid of 100 counts as 6 voxels of half of white, the ramp up to the point as half of 0.9 of one.
    absorbed = attenuation * (6 * 0.5 + 0.5 * 0.9)
    in_front = 100 * np.exp(-attenuation * 0.25)
    assert plates(6, attenuation) == pytest.approx(max(180 * np.exp(-absorbed), in_front), rel=1e-5)


def test_attenuation_is_of_voxels_and_not_of_world_units():
    samples = ws.examples.ripples(24).samples
    small, large = (
        ws.render(
            ws.Volume(samples, spacing=spacing),
            camera="top",
            composite=ws.AttenuatedMaximum(0.1),
            size=(80, 80),
            device="cpu",
        )
        for spacing in ((1, 1, 1), (1000, 1000, 1000))
    )
    np.testing.assert_allclose(small.value, large.value, rtol=1e-4)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ws.AttenuatedMaximum(-1), "at least 0"),
        (lambda: ws.AttenuatedMaximum(float("nan")), "finite"),
        (lambda: ws.DepthColoredMaximum(axis="w"), '"x", "y" or "z"'),
        (lambda: ws.DepthColoredMaximum(3), "name of a colour map"),
        (lambda: ws.render(points(), composite=ws.DepthColoredMaximum("no such map")), "no such map"),
    ],
)
def test_numbers_and_names_that_cannot_work_are_refused(make, words):
    with pytest.raises(ArgumentError, match=re.escape(words)):
        make()


def test_the_command_line_draws_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    points().save("a.nrrd")
    run = CliRunner().invoke
    draw = ["render", "a.nrrd", "--size", "40x40", "--quiet"]
    for options, name in (
        (["--depth-color", "turbo"], "depth-colored-maximum"),
        (["--depth-color", "turbo:z", "--composite", "mip", "--colorbar"], "depth-colored-maximum"),
        (["--attenuate", "0.2"], "attenuated-maximum"),
        (["--composite", "attenuated-maximum"], "attenuated-maximum"),
    ):
        result = run(app, [*draw, *options, "-o", "a.png", "--report", "a.json"])
        assert result.exit_code == 0, result.output
        assert f'"composite": "{name}"' in (tmp_path / "a.json").read_text()
    for options, word in (
        (["--depth-color", "nosuchmap"], "unknown colour map 'nosuchmap'"),
        (["--depth-color", "nosuchmap:z"], "unknown colour map 'nosuchmap'"),
        (["--depth-color", "turbo:w"], "the axis, x, y or z, not 'w'"),
        (["--depth-color", "turbo:Z"], "the axis, x, y or z, not 'Z'"),
        (["--depth-color", "cmocean:thermal:xy"], "the axis, x, y or z, not 'xy'"),
        (["--depth-color", "turbo", "--composite", "mean"], "depth-colored-maximum"),
        (["--attenuate", "-1"], "at least 0"),
    ):
        result = run(app, [*draw, *options, "-o", "b.png"])
        assert result.exit_code != 0
        assert word in f"{result.output} {result.exception}"
        assert not (tmp_path / "b.png").exists()


def test_scene_documents_keep_them():
    for operator in (ws.DepthColoredMaximum("viridis", "y"), ws.AttenuatedMaximum(0.3)):
        picture = ws.render(points(), GREY, composite=operator, size=(20, 20), device="cpu")
        assert picture.report["scene"]["render"]["composite"] == {
            operator.name: {field.name: getattr(operator, field.name) for field in fields(operator)}
        }


@pytest.mark.parametrize("scan", [ws.examples.ct_pelvis, ws.examples.mri_head])
def test_defaults_are_as_bright_as_the_maximum_where_nothing_is_in_front(scan):
    plain, colored, attenuated = (
        ws.render(scan(), size=(96, 96), composite=composite)
        for composite in ("maximum", "depth-colored-maximum", "attenuated-maximum")
    )
    np.testing.assert_allclose(colored.rgba[..., 3], plain.rgba[..., 1], atol=1e-3)
    np.testing.assert_allclose(colored.value, plain.value)
    inside = plain.rgba[..., 3] > 0.9
    bright = attenuated.rgba[..., 1][inside] / np.maximum(plain.rgba[..., 1][inside], 1e-3)
    assert bright.max() < 1.03, "brighter by no more than the filter overshoots"
    assert np.percentile(attenuated.rgba[..., 1][inside], 99) > 0.4
    assert 0.3 < np.median(bright[plain.rgba[..., 1][inside] > 0.3]) < 0.95
