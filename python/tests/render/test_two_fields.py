"""Layers that a second field colours: `Layer(color_from=)`, functions of two fields, `--color-by` (sim.md, 8.2)."""

from __future__ import annotations

import copy
import json
import pickle
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

import wavesplat as ws
from wavesplat._looks.kinds.field_colors import field_colors
from wavesplat._picture.color_bar import scale_of
from wavesplat._viewer.page_requests.code import python_of
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError

Floats = NDArray[np.float32]

N = 32
CENTRE = (N - 1) / 2


def radius() -> Floats:
    z, y, x = np.indices((N, N, N), dtype=np.float32) - np.float32(CENTRE)
    return np.sqrt(x**2 + y**2 + z**2).astype(np.float32)


def ball(name: str = "density") -> ws.Volume:
    return ws.Volume(np.clip(14 - radius(), 0, None).astype(np.float32), name=name)


def along_x(name: str = "place") -> ws.Volume:
    return ws.Volume(np.indices((N, N, N), dtype=np.float32)[2].copy(), name=name)


#: Red by x, from 0 to all of it at 31.
RED = ws.TransferFunction([(0, 1)], [(0, 0, 0, 0), (N - 1, 1, 0, 0)])
#: Opaque from a radius of 10 inwards.
SOLID = ws.TransferFunction([(3.9, 0), (4.1, 1)], [(0, 1, 1, 1)])


def test_equal_fields_give_the_picture_of_one_to_the_byte() -> None:
    steep = ws.TransferFunction([(2, 0), (2.2, 0.8)], [(0, 1, 0, 0), (8, 0, 0, 1)])
    soft = ws.TransferFunction([(0, 0), (14, 0.3)], [(0, 1, 0.2, 0), (14, 0, 0.4, 1)])
    holed = np.array(ball().samples)
    holed[10:20, 4:14, 12:22] = np.nan
    for samples in (np.array(ball().samples), holed, (17 * np.array(ball().samples)).astype(np.uint8)):
        for look in (None, steep, soft):
            one, two = ws.Volume(samples, name="one"), ws.Volume(samples.copy(), name="two")
            alone = ws.render(ws.Scene(ws.Layer(one, look)), size=(96, 80), psnr=None)
            both = ws.render(ws.Scene(ws.Layer(one, look, color_from=ws.Layer(two, look))), size=(96, 80))
            assert alone.rgba[..., 3].max() > 0.1
            assert np.array_equal(alone.rgba, both.rgba)


@pytest.mark.parametrize("composite", ["over", ws.FirstHit(4)])
def test_a_sphere_coloured_by_x_is_linear_in_x_within_two_levels(composite: Any) -> None:
    scene = ws.Scene(ws.Layer(ball(), SOLID, color_from=ws.Layer(along_x(), RED)), shading=None)
    middle = (CENTRE, CENTRE, CENTRE)
    camera = ws.Camera((CENTRE, -60, CENTRE), middle, (0, 0, 1), parallel_scale=14)
    picture = ws.render(scene, camera=camera, size=(112, 112), composite=composite)
    seen = picture.rgba[..., 3] > 0.999
    # Seen along y with z up, x grows to the right.
    x = CENTRE + (np.arange(112) + 0.5 - 56) * 28 / 112
    off = 255 * (picture.rgba[..., 0] - x / (N - 1))
    assert seen.sum() > 3000
    assert np.abs(off[seen]).max() <= 2


def test_the_renderer_agrees_with_the_ray_caster() -> None:
    waves = ws.Volume(np.sin(np.indices((N, N, N)).sum(0) / 4).astype(np.float32), name="waves")
    colors = ws.TransferFunction.diverging(1)
    rgba = np.zeros((2, 2, 4))
    rgba[..., :3] = [[(1, 0, 0), (1, 0.5, 0)], [(0, 0, 1), (0, 1, 1)]]
    rgba[:, 1, 3] = 0.4, 0.02
    both = ws.TransferFunction2D([0, 12], [-1, 1], rgba, rows="field")
    soft = ws.TransferFunction([(0, 0), (14, 0.3)], [(0, 1, 1, 1)])
    for look in (soft, SOLID, both):
        scene = ws.Scene(ws.Layer(ball(), look, color_from=ws.Layer(waves, colors)), background=None)
        camera = ws.render(scene, size=(48, 48), quality="draft").camera
        drawn = ws.render(scene, camera=camera, size=(48, 48), quality="high")
        wanted = ws.reference.raycast(scene, camera=camera, size=(48, 48), step=0.1, rays_per_pixel=4)
        error = np.sqrt(np.mean((drawn.rgba - wanted.rgba) ** 2))
        assert error < 0.012, (look, error)
        alone = ws.render(ws.Scene(ws.Layer(ball(), soft), background=None), camera=camera, size=(48, 48))
        assert np.sqrt(np.mean((alone.rgba - wanted.rgba) ** 2)) > 3 * error


def test_the_picture_does_not_depend_on_threads() -> None:
    scene = ws.Scene(ws.Layer(ball(), color_from=along_x()))
    one, two = (ws.render(scene, size=(96, 96), threads=n) for n in (1, 2))
    assert np.array_equal(one.rgba, two.rgba)


def test_a_function_of_two_fields_selects_by_both() -> None:
    # Opaque where the density exceeds 4 and x is right of the middle.
    rgba = np.ones((4, 4, 4))
    rgba[..., 3] = 0
    rgba[2:, 2:, 3] = 1
    rgba[2:, 2:, :3] = (0, 1, 0)
    middle = (CENTRE, CENTRE, CENTRE)
    look = ws.TransferFunction2D([0, 3.9, 4.1, 14], [0, CENTRE - 0.1, CENTRE + 0.1, N], rgba, rows="field")
    camera = ws.Camera((CENTRE, -60, CENTRE), middle, (0, 0, 1), parallel_scale=14)
    scene = ws.Scene(ws.Layer(ball(), look, color_from=along_x()), shading=None)
    alpha = ws.render(scene, camera=camera, size=(56, 56)).rgba[..., 3]
    black = ws.render(scene.with_(background=None), camera=camera, size=(56, 56)).rgba
    assert alpha.shape == (56, 56)
    assert black[28, 10:26, 3].max() < 0.05
    assert black[28, 31:44, 3].min() > 0.9
    assert black[28, 31:44, 1].min() > 0.9


def test_a_surface_takes_the_colours_of_a_function_of_two_fields_at_its_value() -> None:
    rgba = [[[1, 0, 0, 1], [0, 0, 1, 1]], [[0, 1, 0, 1], [0, 0, 1, 1]]]
    look = ws.TransferFunction2D([4, 14], [0, N - 1], rgba, rows="field")
    middle = (CENTRE, CENTRE, CENTRE)
    camera = ws.Camera((CENTRE, -60, CENTRE), middle, (0, 0, 1), parallel_scale=14)
    scene = ws.Scene(ws.Layer(ball(), look, color_from=along_x()), shading=None)
    picture = ws.render(scene, camera=camera, size=(56, 56), composite=ws.FirstHit(4))
    row = picture.rgba[28, 10:46]
    assert np.abs(row[:, 0] + row[:, 1] - 1).max() < 0.02
    assert (np.diff(row[:, 1]) > 0).all()
    assert row[:, 2].max() < 0.01


def test_fields_lie_on_samples_of_their_own() -> None:
    fine = ws.Scene(ws.Layer(ball(), SOLID, color_from=ws.Layer(along_x(), RED)), shading=None)
    coarse = np.indices((9, 9, 9), dtype=np.float32)[2] * 4
    # Turned by a quarter: the axes of the array are z, x, y.
    matrix = np.array([[0, 4.0, 0, 0], [4, 0, 0, 0], [0, 0, 4, 0], [0, 0, 0, 1]])
    turned = ws.Volume(np.ascontiguousarray(coarse.transpose(0, 2, 1)), world_from_index=matrix, name="place")
    other = fine.with_(layers=ws.Layer(ball(), SOLID, color_from=ws.Layer(turned, RED)))
    camera = ws.render(fine, size=(64, 64), quality="draft").camera
    one, two = (ws.render(scene, camera=camera, size=(64, 64)) for scene in (fine, other))
    assert np.abs(one.rgba - two.rgba).max() < 2 / 255


def test_missing_values_of_the_colour_field_are_empty() -> None:
    colors = np.array(along_x().samples)
    colors[:, :, :16] = np.nan
    scene = ws.Scene(ws.Layer(ball(), SOLID, color_from=ws.Layer(ws.Volume(colors), RED)), background=None)
    camera = ws.Camera((CENTRE, -60, CENTRE), (CENTRE,) * 3, (0, 0, 1), parallel_scale=14)
    for composite in ("over", ws.FirstHit(4)):
        alpha = ws.render(scene, camera=camera, size=(56, 56), composite=composite).rgba[..., 3]
        assert alpha[28, :24].max() < 0.01
        assert alpha[28, 32:44].min() > 0.99


def test_colour_bars_and_reports_name_the_field_of_the_colours() -> None:
    scene = ws.Scene(ws.Layer(ball(), color_from=ws.Layer(along_x("temperature"), RED)))
    for composite in ("over", ws.FirstHit(4)):
        picture = ws.render(scene, size=(64, 64), composite=composite)
        (shown,) = picture.report["shown"]
        assert shown["name"] == "temperature"
        assert shown["transfer_function"]["color"][-1] == (N - 1, 1, 0, 0)
        assert picture.annotated(colorbar=True).rgba.shape[1] > 64
    of_layer = ws.Layer(ws.Volume(along_x().samples, facts=ws.Facts(value_unit="K")), RED, name="temperature")
    of_file = ws.Volume(along_x().samples, facts=ws.Facts(quantity="temperature", value_unit="K"))
    for field in (of_layer, of_file):
        (shown,) = ws.render(ws.Scene(ws.Layer(ball(), color_from=field)), size=(32, 32)).report["shown"]
        assert (shown["quantity"], shown["values"]) == ("temperature", "K"), "bars say both"
    half = ws.TransferFunction([(N / 2, 0), (N - 1, 1)], RED.color)
    scene = ws.Scene(ws.Layer(ball(), color_from=ws.Layer(along_x(), half)))
    (shown,) = ws.render(scene, size=(32, 32)).report["shown"]
    function = ws.TransferFunction(**shown["transfer_function"])
    bar = scale_of(function, "over", "", (1.0, 1.0, 1.0))
    assert (bar.low, bar.high) == (0, N - 1), "colours of values that the field's own opacity leaves clear"
    function = ws.TransferFunction2D([0, 14], [0, 31], np.ones((2, 2, 4)), rows="field")
    both = ws.render(ws.Scene(ws.Layer(ball(), function, color_from=along_x())), size=(32, 32))
    with pytest.raises(ArgumentError, match="second field"):
        both.annotated(colorbar=True)


def test_diverging_maps_of_a_colour_field_end_where_its_values_or_the_window_do() -> None:
    heat = ws.Volume(300 + 5 * along_x().samples, name="heat")
    for window, ends in ((None, [300, 455]), ((350, 400), [350, 400])):
        color = field_colors(heat, "coolwarm", window).color
        assert [color[0][0], color[-1][0]] == pytest.approx(ends, abs=0 if window else 5)
    wave = ws.Volume(np.sin(radius()) - np.float32(0.2), name="wave")
    values = [value for value, *_ in field_colors(wave, "coolwarm").color]
    assert values[0] == pytest.approx(-values[-1])


def test_scenes_of_two_fields_are_drawn_again_from_their_pictures(tmp_path: Path) -> None:
    np.save(tmp_path / "density.npy", ball().samples)
    np.save(tmp_path / "place.npy", along_x().samples)
    density, place = ws.open(tmp_path / "density.npy"), ws.open(tmp_path / "place.npy")
    function = ws.TransferFunction2D([0, 14], [0, 31], np.random.default_rng(1).random((2, 2, 4)), rows="field")
    for look, color in ((None, place), (None, ws.Layer(place, RED, name="x")), (function, place)):
        scene = ws.Scene(ws.Layer(density, look, color_from=color))
        picture = ws.render(scene, size=(48, 40))
        picture.save(tmp_path / "a.png")
        again = ws.Scene.load(tmp_path / "a.png")
        told = json.loads(json.dumps(picture.report["scene"]))["layers"][0]["color_from"]
        assert told["name"] == ("x" if isinstance(color, ws.Layer) else "place.npy")
        assert again.layers[0].color_from is not None
        assert np.array_equal(ws.render(again, camera=picture.camera, size=(48, 40)).rgba, picture.rgba)
        ws.Scene.from_json(scene.to_json(), folder=tmp_path)


def test_functions_of_two_fields_are_kept_by_json_and_copies() -> None:
    function = ws.TransferFunction2D([0, 14], [-3, 31], np.ones((2, 2, 4)), rows="field")
    assert ws.TransferFunction2D.from_json(function.to_json()) == function
    assert pickle.loads(pickle.dumps(function)) == function == copy.deepcopy(function)  # noqa: S301
    assert function != ws.TransferFunction2D([0, 14], [3, 31], np.ones((2, 2, 4)))
    with pytest.raises(ArgumentError, match="magnitudes"):
        ws.TransferFunction2D([0, 14], [-3, 31], np.ones((2, 2, 4)))
    with pytest.raises(ArgumentError, match="rows is 'values'"):
        ws.TransferFunction2D([0, 14], [-3, 31], np.ones((2, 2, 4)), rows="values")  # type: ignore[arg-type]


def test_series_are_coloured_by_the_field_of_their_time() -> None:
    times = [np.full((8, 8, 8), value, np.float32) for value in (0.0, 31.0)]
    series = ws.Series([ws.Volume(one, name="x") for one in times])
    fog = ws.Volume(np.ones((8, 8, 8), np.float32))
    layer = ws.Layer(fog, ws.TransferFunction([(0, 1)], [(0, 1, 1, 1)]), color_from=ws.Layer(series, RED))
    for time, red in ((0, 0.0), (1, 1.0)):
        scene = ws.Scene(ws.Layer(layer.volume, layer.look, color_from=layer.color_from, time=time), shading=None)
        picture = ws.render(scene, size=(32, 32), composite="over")
        assert picture.rgba[16, 16, 0] == pytest.approx(red, abs=0.01)


@pytest.mark.parametrize("step", [1, 2])  # the field has samples of its own
def test_labels_have_the_colour_of_the_field_s_mean_over_each(step: int) -> None:
    """They kept their own colours, without a word."""
    numbers = np.zeros((24, 24, 24), np.uint8)
    numbers[2:10, 2:10, 2:10], numbers[2:10, 12:20, 2:10], numbers[12:20, 2:10, 12:20] = 1, 2, 7
    measure = np.array([0, 5, 2, 0, 0, 0, 0, 9], np.float32)[numbers]
    measure[4, 4, 4] = np.nan
    cells = ws.Volume(numbers, spacing=(1, 1, 1), unit="um")
    field = ws.Volume(measure[::step, ::step, ::step], spacing=(step,) * 3, unit="um", name="intensity")
    viridis = ws.TransferFunction.from_colormap("viridis", clim=(2, 9))
    by_look = ws.Layer(field, ws.TransferFunction([(0, 1)], [(0, 0, 0, 0), (10, 1, 0, 0)]))
    for color, wanted in ((field, viridis([5, 2, 9])[:, :3]), (by_look, [(0.5, 0, 0), (0.2, 0, 0), (0.9, 0, 0)])):
        picture = ws.Scene(ws.Layer(cells, color_from=color)).render(size=(48, 48))
        assert [one["name"] for one in picture.report["labels"]] == ["1", "2", "7"]
        np.testing.assert_allclose([one["color"] for one in picture.report["labels"]], wanted, atol=1e-6)
        assert picture.report["shown"][0]["name"] == "intensity"
    red = np.asarray(picture)
    assert red[..., 0].max() > 100
    assert red[..., 1].max() < 60


def test_what_cannot_be_coloured_says_what_to_do() -> None:
    small = ws.Volume(np.indices((8, 8, 8), np.float32)[0], name="small")
    gradients = ws.TransferFunction2D([0, 1], [0], np.ones((1, 2, 4)))
    fields = ws.TransferFunction2D([0, 1], [0], np.ones((1, 2, 4)), rows="field")
    labels = ws.Volume((radius() < 9).astype(np.uint8) + (radius() < 5) + 1, name="labels")
    wavelets = ws.WaveletVolume.from_volume(along_x())
    for layer, arguments, wanted in (
        (ws.Layer(ball(), color_from=wavelets), {}, r"to_volume\(\)"),
        (ws.Layer(ball(), color_from=small), {}, r"does not cover it: it lies from \(0, 0, 0\) to \(7, 7, 7\), and"),
        (ws.Layer(ball(), color_from=along_x()), {"composite": "maximum"}, "leave out color_from"),
        (ws.Layer(ball(), gradients, color_from=along_x()), {}, "colours by value and gradient"),
        (ws.Layer(ball(), fields), {}, "function of two fields"),
        (ws.Layer(ball(), color_from=ws.Layer(along_x(), gradients)), {}, "look of two dimensions"),
    ):
        with pytest.raises(ArgumentError, match=wanted):
            ws.render(ws.Scene(layer), size=(24, 24), **arguments)
    assert labels.shape == (N, N, N)
    with pytest.raises(ArgumentError, match="color_from itself"):
        ws.Layer(ball(), color_from=ws.Layer(ball(), color_from=along_x()))


def test_slices_show_the_layer_s_own_values_and_say_so() -> None:
    picture = ws.slice(ws.Scene(ws.Layer(ball(), color_from=along_x())), "xy")
    assert any("own values" in note for note in picture.report["notes"])


@pytest.fixture
def simulation(tmp_path: Path) -> Path:
    path = tmp_path / "sim.h5"
    with h5py.File(path, "w") as file:
        file["density"] = np.array(ball().samples)
        file["gas/temperature"] = np.array(along_x().samples)
    return path


def pixels(path: Path) -> NDArray[np.uint8]:
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


SIZE = ("--dataset", "density", "--size", "48x48")


def test_color_by_a_dataset_of_input_or_of_another_file(wavesplat: Any, simulation: Path, tmp_path: Path) -> None:
    np.save(tmp_path / "place.npy", along_x().samples)
    window = ":viridis:0,31"
    fields = ("gas/temperature", f"{simulation}#gas/temperature", f"{tmp_path}/place.npy")
    made = []
    for number, field in enumerate(fields):
        out = tmp_path / f"{number}.png"
        result = wavesplat("render", simulation, *SIZE, "--color-by", field + window, "-o", out)
        assert result.returncode == 0, result.stderr
        made.append(pixels(out))
    assert made[0].max() > 50
    assert all(np.array_equal(made[0], one) for one in made[1:])
    again = wavesplat("render", "--from", tmp_path / "0.png", "-o", tmp_path / "again.png")
    assert again.returncode == 0, again.stderr
    assert np.array_equal(pixels(tmp_path / "again.png"), made[0])


def test_color_by_follows_the_times_of_input(wavesplat: Any, tmp_path: Path) -> None:
    np.save(tmp_path / "density.npy", np.stack([ball().samples] * 2))
    np.save(tmp_path / "heat.npy", np.stack([np.full((N, N, N), heat, np.float32) for heat in (0, 31)]))
    field = f"{tmp_path}/heat.npy:gray:0,31"
    arguments = ("--times", "all", "--color-by", field, "--size", "48x48", "--no-shading")
    result = wavesplat("render", tmp_path / "density.npy", *arguments, "-o", tmp_path / "t.png")
    assert result.returncode == 0, result.stderr
    dark, light = (pixels(tmp_path / f"t_{time}.png") for time in (0, 1))
    assert dark.max() < 5
    assert light.max() > 50


def test_color_by_a_surface_has_a_colour_bar(wavesplat: Any, simulation: Path, tmp_path: Path) -> None:
    surface = ("--composite", "first-hit", "--iso-value", "4", "--colorbar")
    out = tmp_path / "surface.png"
    result = wavesplat("render", simulation, *SIZE, "--color-by", "gas/temperature:inferno", *surface, "-o", out)
    assert result.returncode == 0, result.stderr
    assert pixels(out).shape[1] > 48


def test_layers_of_datasets(wavesplat: Any, simulation: Path, tmp_path: Path) -> None:
    layer = f"{simulation}#gas/temperature:inferno:10,31"
    result = wavesplat("render", simulation, *SIZE, "--layer", layer, "-o", tmp_path / "a.png", "--json")
    assert result.returncode == 0, result.stderr
    layers = json.loads(result.stdout)["report"]["scene"]["layers"]
    assert [layer["volume"]["dataset"] for layer in layers] == ["density", "gas/temperature"]


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        (("--color-by", "heat"), "no dataset 'heat'"),
        (("--color-by", "gas/temperature:nomap"), "nomap"),
        (("--color-by", "gas/temperature", "--composite", "maximum"), "leave out color_from"),
    ],
)
def test_color_by_what_cannot_be_says_so(wavesplat: Any, simulation: Path, arguments: Any, wanted: str) -> None:
    result = wavesplat("render", simulation, *SIZE, *arguments, "-o", simulation.parent / "x.png")
    assert result.returncode == 2
    assert wanted in result.stderr
    assert not (simulation.parent / "x.png").exists()


def test_the_viewer_keeps_the_field_of_the_colours(tmp_path: Path) -> None:
    np.save(tmp_path / "density.npy", ball().samples)
    np.save(tmp_path / "place.npy", along_x().samples)
    density, place = ws.open(tmp_path / "density.npy"), ws.open(tmp_path / "place.npy")
    scene = ws.Scene(ws.Layer(density, SOLID, color_from=ws.Layer(place, RED, name="x")), background="black")
    state = ViewerState.of(scene)
    # The page knows no such field, and its document must hold.
    assert "color_from" not in state.document["layers"][0]
    state = state.patched([{"op": "replace", "path": "/layers/0/opacity", "value": 0.5}])
    assert state.scene.layers[0].opacity == 0.5
    assert state.scene.layers[0].color_from.look == scene.layers[0].color_from.look
    size = (48, 40)
    picture = state.scene.render(state.camera, size=size, **state.options)
    grey = ws.render(ws.Layer(density, SOLID), camera=state.camera, size=size, background="black")
    assert np.abs(picture.rgba - grey.rgba).max() > 0.1
    assert picture.report["device"]["name"] == "cpu"
    # What it saves draws the same picture: the document, and the program.
    document = ws.Scene.from_json(json.dumps(state.file_document(size)), folder=tmp_path)
    again = document.render(state.camera, size=size, **state.options)
    assert np.array_equal(again.rgba, picture.rgba)
    names: dict[str, object] = {}
    program = python_of(state, size).replace("picture.png", str(tmp_path / "picture.png"))
    exec(program, names)  # noqa: S102 - the program that is shown
    assert np.array_equal(names["picture"].rgba, picture.rgba)  # type: ignore[attr-defined]
