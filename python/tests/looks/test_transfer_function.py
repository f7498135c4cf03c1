import json
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

unit = st.floats(0, 1)
values = st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=8).map(sorted)
TF = ws.TransferFunction([(0, 0), (10, 1)], [(0, 1, 0, 0), (10, 0, 0, 1)], opacity_unit=2)


@given(values, st.data(), st.none() | st.floats(1e-3, 1e3))
def test_json_reads_back_exactly(xs, data, opacity_unit):
    opacity = [(x, data.draw(unit)) for x in xs]
    color = [(x, data.draw(unit), data.draw(unit), data.draw(unit)) for x in xs]
    tf = ws.TransferFunction(opacity, color, opacity_unit)
    assert ws.TransferFunction.from_json(tf.to_json()) == tf


def test_files_read_back_exactly(tmp_path):
    path = tmp_path / "tf.json"
    TF.save(path)
    assert ws.TransferFunction.load(path) == TF
    assert [entry.name for entry in tmp_path.iterdir()] == ["tf.json"]


def test_evaluates_to_colour_and_opacity():
    np.testing.assert_allclose(TF([-5, 5, 20]), [[1, 0, 0, 0], [0.5, 0, 0.5, 0.5], [0, 0, 1, 1]])


def test_can_be_pickled():
    assert pickle.loads(pickle.dumps(TF)) == TF  # noqa: S301 - our own bytes


@pytest.mark.parametrize(
    ("opacity", "color", "message"),
    [
        ([], [(0, 1, 1, 1)], "opacity curve has no node"),
        ([(0, 1)], [], "color curve has no node"),
        ([(1, 0), (0, 1)], [(0, 1, 1, 1)], "opacity node 1.*sort"),
        ([(0, 1.5)], [(0, 1, 1, 1)], "opacity of node 0.*1.5.*between 0 and 1"),
        ([(0, -0.1)], [(0, 1, 1, 1)], "between 0 and 1"),
        ([(0, 1)], [(0, 255, 0, 0)], "colour of node 0.*divide 8-bit"),
        ([(0, 1, 2)], [(0, 1, 1, 1)], r"opacity node 0 is .*2 numbers \(value, alpha\)"),
        ([(0, 1)], [(0, "red")], r"color node 0 is .*4 numbers"),
        ([(float("nan"), 1)], [(0, 1, 1, 1)], "value of opacity node 0"),
        ([(10**400, 1)], [(0, 1, 1, 1)], "opacity node 0"),
        (5, [(0, 1, 1, 1)], "opacity is 5"),
    ],
)
def test_bad_curves_are_refused(opacity, color, message):
    with pytest.raises(ArgumentError, match=message):
        ws.TransferFunction(opacity, color)


GOOD = {"version": 1, "opacity": [[0, 0], [1, 1]], "color": [[0, 1, 1, 1]]}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"version": 2}, "'version' is 2.*version 1"),
        ({"version": None}, "'version' is None"),
        ({"opacity": "thin"}, "'opacity' is not a list"),
        ({"colour": []}, "unknown field 'colour'.*color"),
        ({"opacity_unit": "mm"}, "'opacity_unit' is 'mm'"),
        ({"opacity_unit": True}, "'opacity_unit' is True"),
        ({"values": "percent"}, "'values' is 'percent'"),
        ({"opacity": [[0, 2]]}, "between 0 and 1"),
        ({"values": "fraction"}, "pass the volume"),
    ],
)
def test_json_errors_name_the_field(change, message):
    with pytest.raises(ArgumentError, match=message):
        ws.TransferFunction.from_json(json.dumps({**GOOD, **change}))


@pytest.mark.parametrize("name", ["version", "opacity", "color"])
def test_missing_fields_are_named(name):
    document = {key: value for key, value in GOOD.items() if key != name}
    with pytest.raises(ArgumentError, match=f"'{name}' is missing"):
        ws.TransferFunction.from_json(json.dumps(document))


@pytest.mark.parametrize("text", ["", "[]", "{", "7", "[" * 100_000])
def test_other_texts_are_refused(text):
    with pytest.raises(ArgumentError, match="not JSON|not an object"):
        ws.TransferFunction.from_json(text)


def test_file_errors_end_with_the_path(tmp_path):
    with pytest.raises(FileError, match="No such file.*nothing.json$"):
        ws.TransferFunction.load(tmp_path / "nothing.json")
    path = tmp_path / "bad.json"
    path.write_text("{}")
    with pytest.raises(ArgumentError, match="'version' is missing.*bad.json$"):
        ws.TransferFunction.load(path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FileError, match="not text.*bad.json$"):
        ws.TransferFunction.load(path)


def test_fitted_presets_follow_the_scale_of_the_values():
    samples = np.random.default_rng(1).gamma(2.0, 10.0, (20, 20, 20))
    small, large = ws.Volume(samples), ws.Volume(samples * 1000 - 500)
    for name in ("mr-head", "auto", "grey"):
        one, two = (ws.Look.preset(name, volume).transfer_function for volume in (small, large))
        np.testing.assert_allclose([v * 1000 - 500 for v, _ in one.opacity], [v for v, _ in two.opacity], rtol=1e-6)


def blob(background, foreground, noise):
    """A ball of one value in a field of another, with noise."""
    rng = np.random.default_rng(3)
    z, y, x = np.mgrid[-1:1:32j, -1:1:32j, -1:1:32j]
    inside = x * x + y * y + z * z < 0.25
    return np.where(inside, foreground, background) + rng.normal(0, noise, inside.shape), inside


@pytest.mark.parametrize("scale", [1, 1e-6, 1e6])
def test_auto_parts_the_object_from_its_background(scale):
    samples, inside = blob(100 * scale, 200 * scale, 8 * scale)

    def opacity(volume):
        return ws.Look.auto(volume).transfer_function(samples.ravel())[:, 3].reshape(samples.shape)

    scan, field = opacity(ws.Volume(samples, anatomical=True)), opacity(ws.Volume(samples))
    assert np.mean(scan[~inside] > 0) < 0.01
    assert np.mean(scan[inside] > 0) > 0.99
    # A field of numbers has no background, but its most frequent values are faint.
    assert field[~inside].mean() < 0.01 * field[inside].mean()


def test_auto_is_not_misled_by_a_hot_pixel():
    samples, inside = blob(100, 200, 8)
    samples[0, 0, 0] = 1e9
    alpha = ws.TransferFunction.auto(ws.Volume(samples))(samples.ravel())[:, 3].reshape(samples.shape)
    assert np.mean(alpha[inside] > 0.005) > 0.9


@pytest.mark.parametrize("composite", ["over", "maximum", "minimum", "mean", "sum"])
def test_auto_takes_volumes_with_holes(composite):
    samples, _ = blob(100.0, 200.0, 8.0)
    samples[:, :, :5] = np.nan
    tf = ws.TransferFunction.auto(ws.Volume(samples), composite)
    assert np.isfinite(tf.opacity).all()


def test_auto_on_two_values_only():
    samples = np.zeros((8, 8, 8), np.uint8)
    samples[2:4] = 1
    tf = ws.TransferFunction.auto(ws.Volume(samples))
    assert tf([0])[0, 3] == 0
    assert tf([1])[0, 3] > 0.01


def test_auto_refuses_a_constant_volume():
    with pytest.raises(ArgumentError, match="'flat': every sample is 7.*pass a transfer function"):
        ws.TransferFunction.auto(ws.Volume(np.full((4, 4, 4), 7), name="flat"))


def test_gradient_opacity_is_kept_and_hides_what_is_homogeneous():
    ball = np.linalg.norm(np.stack(np.meshgrid(*[np.arange(24.0)] * 3, indexing="ij")) - 11.5, axis=0)
    volume = ws.Volume((100 * np.clip(10 - ball, 0, 1)).astype(np.float32), spacing=(0.5, 0.5, 0.5))
    nodes = [
        (0, 0.0),
        (100, 1.0),
    ]  # sample units per world unit: the surface has 100 over a voxel, which is half a unit
    curves = {"opacity": [(10, 0.0), (50, 0.3)], "color": [(0, 1, 1, 1)]}
    tf = ws.TransferFunction(**curves, gradient_opacity=nodes)
    assert tf.gradient_opacity == ((0.0, 0.0), (100.0, 1.0))
    assert ws.TransferFunction.from_json(tf.to_json()) == tf
    assert "gradient_opacity" not in ws.TransferFunction(**curves).to_json()
    draw = {"size": (64, 64), "shading": None, "camera": "anterior"}
    whole = ws.render(volume, ws.TransferFunction(**curves), **draw).rgba[32, 32, 3]
    shell = ws.render(volume, tf, **draw).rgba[32, 32, 3]
    assert whole > 0.99
    assert 0.3 < shell < 0.8, "two surfaces, and nothing in between"


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        ([(0, 2)], "between 0 and 1"),
        ([(5, 0), (1, 1)], "sort the nodes"),
        ([(-1, 1)], "at least 0"),
        ([(1,)], "2 numbers"),
    ],
)
def test_gradient_opacity_that_cannot_work_is_refused(nodes, message):
    with pytest.raises(ws.errors.ArgumentError, match=message):
        ws.TransferFunction([(0, 1)], [(0, 1, 1, 1)], gradient_opacity=nodes)
