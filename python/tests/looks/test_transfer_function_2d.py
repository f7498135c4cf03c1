"""Transfer functions of value and gradient magnitude, and occlusion and shadows."""

import pickle

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError

TABLE = [[[1, 0, 0, 0.0], [1, 0, 0, 0.2]], [[0, 0, 1, 0.4], [0, 0, 1, 0.8]]]


def test_the_table_is_bilinear():
    tf = ws.TransferFunction2D([0, 10], [0, 4], TABLE)
    np.testing.assert_allclose(tf([5, 0, 99], [2, 4, 0]), [[0.5, 0, 0.5, 0.35], [0, 0, 1, 0.4], [1, 0, 0, 0.2]])
    assert tf([[0, 5], [10, 10]], 0).shape == (4, 4)


def test_round_trips(tmp_path):
    tf = ws.TransferFunction2D([0, 10], [0, 4], TABLE, opacity_unit=2.0)
    tf.save(tmp_path / "tf.json")
    assert ws.TransferFunction2D.load(tmp_path / "tf.json") == tf
    copy = pickle.loads(pickle.dumps(tf))  # noqa: S301
    assert copy == tf
    assert hash(copy) == hash(tf)


@pytest.mark.nightly
def test_pictures_agree_with_direct_evaluation():
    volume = ws.examples.ct_pelvis()
    tf = ws.TransferFunction2D.boundaries(
        [(-100, 6.0, 20, "#e0a080", 0.1), (250, 6.0, 40, "#fff2d9", 0.3)], opacity_unit=3.0
    )
    camera = ws.Camera.orbit(volume, 30, 20, zoom=5, fit="view")
    want = ws.reference.raycast(volume, tf, camera, size=(32, 32), step=0.1, rays_per_pixel=9)
    got = ws.render(volume, tf, camera, size=(32, 32), quality=ws.Sampling(12, 3))
    assert want.rgba[..., 3].max() > 0.5
    assert np.abs(got.rgba - want.rgba).mean() < 1e-3


def test_a_boundary_is_as_thick_whatever_its_gradient():
    tf = ws.TransferFunction2D.boundaries([(100, 2.0, 5, "white", 0.6)])
    for magnitude in (10.0, 20.0):
        offsets = np.array([0.0, 1.0, 1.9, 2.1]) * magnitude
        np.testing.assert_allclose(tf(100 + offsets, magnitude)[:, 3], [0.6, 0.3, 0.03, 0.0], atol=0.04)
    assert tf([100], [4])[0, 3] == 0


def test_bad_tables_are_refused():
    for values, magnitudes, rgba, problem in (
        ([0], [0], TABLE, "shape"),
        ([1, 0], [0, 1], TABLE, "node before it"),
        ([0, 1], [-1, 0], TABLE, "at least 0"),
        ([0, 1], [0, 1], np.array(TABLE) * 2, "0..1"),
        ([0, 1], [0, 1], "text", "no array"),
    ):
        with pytest.raises(ArgumentError, match=problem):
            ws.TransferFunction2D(values, magnitudes, rgba)
    with pytest.raises(ArgumentError, match="boundary 0"):
        ws.TransferFunction2D.boundaries([(1, 2, 3)])
    with pytest.raises(ArgumentError, match="missing"):
        ws.TransferFunction2D.from_json('{"version": 1, "values": []}')


def test_occlusion_and_shadow_only_take_light_away():
    volume = ws.examples.ct_pelvis()
    view = {"camera": ws.Camera.orbit(volume, 30, 20, fit="view"), "size": (96, 96)}
    lights = [ws.Light((-1, 1, 1))]
    bright = ws.render(volume, "ct-bone", shading=ws.Shading(lights=lights), **view).rgba
    for held_off in ({"ambient_occlusion": 0.8}, {"shadow": 0.8}, {"ambient_occlusion": 0.8, "shadow": 0.8}):
        dark = ws.render(volume, "ct-bone", shading=ws.Shading(lights=lights, **held_off), **view).rgba
        # In opaque regions rays stop in groups, which are larger without occlusion and shadows.
        np.testing.assert_allclose(dark[..., 3], bright[..., 3], atol=5e-4)
        # The tolerance is for the warp, which sharpens a little where a neighbouring texel gets darker.
        assert (dark[..., :3] <= bright[..., :3] + 0.02).all()
        seen = bright[..., 3] > 0.5
        assert dark[seen][:, :3].mean() < 0.95 * bright[seen][:, :3].mean()
    none = ws.render(volume, "ct-bone", shading=ws.Shading(lights=lights, ambient_occlusion=0, shadow=0), **view)
    assert np.array_equal(none.rgba, bright)


def test_strengths_are_checked():
    for wrong in ({"ambient_occlusion": 2}, {"shadow": -1}, {"occlusion_radius": 0}):
        with pytest.raises(ArgumentError):
            ws.Shading(**wrong)
    with pytest.raises(ArgumentError, match="the reference"):
        ws.reference.raycast(ws.examples.ripples(8), shading=ws.Shading(shadow=1), size=(4, 4))


def test_the_reference_says_what_it_draws():
    volume = ws.WaveletVolume.from_volume(ws.examples.ripples(16))
    for draw in (ws.reference.raycast, ws.reference.splat_literal):
        with pytest.raises(ArgumentError, match="to_volume"):
            draw(volume, size=(4, 4))


def test_the_command_line_reads_files_of_both_kinds(tmp_path, ramp_file, wavesplat):
    one, two = tmp_path / "one.json", tmp_path / "two.json"
    ws.TransferFunction([(0, 0), (255, 0.5)], [(0, 1, 1, 1)]).save(one)
    ws.TransferFunction2D.boundaries([(120, 10, 5, "#ff8040", 0.8)]).save(two)
    pictures = []
    for tf in (one, two):
        picture = tmp_path / f"{tf.stem}.png"
        done = wavesplat("render", ramp_file, "-o", picture, "--tf", tf, "--size", "32x32")
        assert done.returncode == 0, done.stderr
        pictures.append(picture.read_bytes())
    assert pictures[0] != pictures[1]
