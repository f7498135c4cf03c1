"""Scenes of several layers: their looks and operator, independence of their order, and grids of any kind."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._scene.drawing.drawn_layers import drawn_layers
from wavesplat._scene.drawing.resampling import on_axes_of
from wavesplat.errors import ArgumentError

SIZE = (48, 40)
CT = ws.examples.ct_pelvis()
SOFT = ws.TransferFunction([(-50, 0), (150, 0.05), (400, 0.5)], [(-50, 0.8, 0.4, 0.3), (400, 1, 1, 0.9)])
BLUE = ws.TransferFunction([(200, 0), (300, 0.4)], [(200, 0.2, 0.4, 1)])
SKIN = ws.TransferFunction([(-700, 0), (-600, 0.02), (-300, 0)], [(-700, 0.2, 1, 0.4)])
CLEAR = ws.TransferFunction([(0, 0)], [(0, 1, 1, 1)])
EYE = ws.Camera.orbit(CT, 30, 20)


def blob(*, spacing=(3.0, 3.0, 3.0), turn=0.0, shape=(40, 40, 40), name="blob", **options):
    """A ball in the middle of the CT, on a grid turned about z."""
    matrix = np.eye(4)
    cos, sin = np.cos(turn), np.sin(turn)
    matrix[:3, :3] = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]]) @ np.diag(spacing)
    middle = (np.array(shape[::-1]) - 1) / 2
    matrix[:3, 3] = np.mean(CT.bounds, axis=0) - matrix[:3, :3] @ middle
    z, y, x = np.indices(shape)
    world = np.stack([x, y, z], axis=-1) @ matrix[:3, :3].T + matrix[:3, 3] - np.mean(CT.bounds, axis=0)
    samples = 200 * np.exp(-((world / 30) ** 2).sum(axis=-1))
    return ws.Volume(samples.astype(np.float32), world_from_index=matrix, name=name, **options)


HOT = ws.TransferFunction([(20, 0), (200, 0.3)], [(20, 1, 0, 0), (200, 1, 1, 0.2)])


def draw(layers, **options):
    return ws.Scene(layers).render(options.pop("camera", EYE), **{"size": SIZE} | options)


# Order, and what costs nothing


@pytest.mark.parametrize("composite", ["over", "maximum", "mean"])
def test_the_order_of_layers_changes_nothing(composite):
    layers = [ws.Layer(CT, SOFT), ws.Layer(CT, BLUE, opacity=0.7), ws.Layer(CT, SKIN)]
    pictures = [draw(list(order), composite=composite).rgba for order in itertools.permutations(layers)]
    assert pictures[0][..., :3].max() > 0.3
    for picture in pictures[1:]:
        np.testing.assert_array_equal(picture, pictures[0])


@pytest.mark.parametrize("composite", ["over", "maximum"])
@pytest.mark.parametrize("hidden", [{"opacity": 0}, {"visible": False}])
def test_layers_that_are_not_seen_cost_nothing(hidden, composite):
    alone = draw(ws.Layer(CT, SOFT), composite=composite)
    for layers in (
        [ws.Layer(CT, SOFT), ws.Layer(blob(), HOT, **hidden)],
        [ws.Layer(blob(), **hidden), ws.Layer(CT, SOFT)],
    ):
        both = draw(layers, composite=composite)
        np.testing.assert_array_equal(both.rgba, alone.rgba)
        assert both.report["n_texels"] == alone.report["n_texels"]


def test_a_scene_of_hidden_layers_is_its_background():
    picture = draw(ws.Layer(CT, SOFT, visible=False))
    assert picture.rgba.max() == 0
    assert picture.report["notes"] == ["no layer of the scene is visible"]
    picture = ws.Scene(ws.Layer(CT, SOFT, opacity=0), background="#ff0000").render(size=SIZE)
    np.testing.assert_array_equal(picture.rgba, np.broadcast_to([1, 0, 0, 1], picture.rgba.shape))


def test_equal_layers_with_half_the_extinction_are_one():
    values = np.linspace(-50, 400, 400)
    # Opacities are so faint that neither the function nor its half is pre-integrated, so both are drawn the same way.
    opacity = 0.1 * SOFT(values)[:, 3]
    whole = ws.TransferFunction(list(zip(values, opacity, strict=True)), SOFT.color)
    half = ws.TransferFunction(list(zip(values, 1 - np.sqrt(1 - opacity), strict=True)), SOFT.color)
    # Of cut faces each layer asks for its own optical depth: haze of half the extinction has less even light.
    light = ws.Shading(even_cuts=0)
    # Of several layers none is drawn without the table.
    scenes = (
        ws.Scene(layers, shading=light, keep_table=True) for layers in (ws.Layer(CT, whole), [ws.Layer(CT, half)] * 2)
    )
    one, two = (scene.render(EYE, size=SIZE) for scene in scenes)
    np.testing.assert_allclose(two.rgba, one.rgba, atol=1e-5)


def test_opacity_multiplies_opacities_and_of_projections_the_light():
    faded = ws.TransferFunction([(value, 0.4 * alpha) for value, alpha in SOFT.opacity], SOFT.color)
    np.testing.assert_array_equal(draw(ws.Layer(CT, SOFT, opacity=0.4)).rgba, draw(ws.Layer(CT, faded)).rgba)
    table = ws.TransferFunction2D([0, 400], [0, 100], np.full((2, 2, 4), 0.5))
    half = ws.TransferFunction2D([0, 400], [0, 100], np.full((2, 2, 4), [0.5, 0.5, 0.5, 0.25]))
    np.testing.assert_array_equal(draw(ws.Layer(CT, table, opacity=0.5)).rgba, draw(ws.Layer(CT, half)).rgba)
    bright, dim = (draw(ws.Layer(CT, SOFT, opacity=opacity), composite="maximum") for opacity in (1, 0.25))
    np.testing.assert_allclose(dim.rgba, 0.25 * bright.rgba, rtol=1e-6)
    np.testing.assert_array_equal(dim.value, bright.value)


# Projections


def test_projections_are_added_as_light():
    one, two = (draw(ws.Layer(CT, look), composite="maximum").rgba.astype(float) for look in (BLUE, SOFT))
    both = draw([ws.Layer(CT, BLUE), ws.Layer(CT, SOFT)], composite="maximum")
    np.testing.assert_allclose(both.rgba[..., :3], (one + two)[..., :3].clip(0, 1), atol=1e-6)
    np.testing.assert_allclose(both.rgba[..., 3], 1 - (1 - one[..., 3]) * (1 - two[..., 3]), atol=1e-6)
    assert both.value is None
    told = []
    draw([ws.Layer(CT, BLUE), ws.Layer(CT, SOFT)], composite="mean", progress=told.append)
    assert (min(told) >= 0, told[-1]) == (True, 1)
    assert told == sorted(told)


def test_surfaces_are_of_one_layer():
    with pytest.raises(ArgumentError, match="FirstHit shows the surface of one layer, and 2 are visible; hide the"):
        draw([CT, CT], composite=ws.FirstHit(200))
    hidden = [ws.Layer(CT, SOFT), ws.Layer(CT, SOFT, visible=False)]
    assert draw(hidden, composite=ws.FirstHit(200)).rgba.max() > 0


# Looks


def test_the_operator_is_over_if_one_look_says_so():
    maximum = ws.Look(transfer_function=HOT, composite="maximum", shading=None)
    over, mean = ws.Look(transfer_function=SOFT), ws.Look(transfer_function=HOT, composite="mean")
    for looks, name in (((maximum, maximum), "maximum"), ((maximum, over), "over"), ((over, mean), "over")):
        assert drawn_layers(ws.Scene([CT, CT], list(looks)), None).composite == name
    with pytest.raises(ArgumentError, match="for 'maximum' and 'mean'; say which with composite="):
        draw([ws.Layer(CT, maximum), ws.Layer(CT, mean)])
    shown = drawn_layers(ws.Scene([CT, CT], [maximum, mean]), "sum")
    assert {layer.look.composite for layer in shown.layers} == {"sum"}


def channel(color=None, name=""):
    samples = np.random.default_rng(5).exponential(5, (16, 24, 24)).astype(np.uint16)
    facts = ws.Facts(unit="um", modality="fluorescence", channel=ws.Channel(name, color=color))
    return ws.Volume(samples, facts=facts)


@pytest.mark.parametrize("composite", [None, "maximum"])
def test_channels_of_fluorescence_have_colours_of_their_own(composite):
    layers = [channel(), channel(), channel((1, 0, 0)), channel((1, 0, 0)), channel()]
    shown = drawn_layers(ws.Scene(layers), composite).layers
    colors = [layer.look.transfer_function.color[-1 if composite else 1][1:] for layer in shown]
    assert len(set(colors)) == len(colors)
    assert colors[2] == (1, 0, 0)
    assert colors[0][1] == max(colors[0]), "the first is green"
    alone = drawn_layers(ws.Scene(channel((1, 0, 0))), composite).layers[0]
    assert composite or alone.look.transfer_function.color[1][1:] == (1, 0, 0)


def test_looks_are_given_one_for_each_or_one_for_all():
    assert [layer.look for layer in ws.Scene([CT, CT], [SOFT, BLUE]).layers] == [SOFT, BLUE]
    assert [layer.look for layer in ws.Scene([CT, CT], SOFT).layers] == [SOFT, SOFT]
    assert [layer.look for layer in ws.Scene([CT, ws.Layer(CT, BLUE)], [SOFT, None]).layers] == [SOFT, BLUE]
    for what, look, message in (
        ([CT, CT], [SOFT], "there are 1 looks for 2 volumes"),
        (ws.Layer(CT, BLUE), SOFT, "layer 'CT' has a look, and another one is given"),
        ([], None, "a scene has 1 to 8 layers, not 0"),
        ([CT] * 9, None, "not 9"),
        (ws.Scene(CT), None, "this is a scene already"),
    ):
        with pytest.raises(ArgumentError, match=message):
            ws.Scene(what, look)
    with pytest.raises(ArgumentError, match="a scene brings its looks"):
        ws.render(ws.Scene(CT), SOFT)
    with pytest.raises(ArgumentError, match="a scene has no 'camera' to change"):
        ws.Scene(CT).with_(camera=EYE)


def test_the_one_liner_changes_a_scene():
    scene = ws.Scene(CT, SOFT)
    changed = {"shading": None, "clip": ws.ClipPlane((0, 0, 0), (0, 1, 0)), "background": "white"}
    want = ws.Scene(CT, SOFT, **changed).render(EYE, size=SIZE).rgba
    np.testing.assert_array_equal(ws.render(scene, None, EYE, size=SIZE, **changed).rgba, want)
    np.testing.assert_array_equal(scene.with_(**changed).render(EYE, size=SIZE).rgba, want)
    assert (scene.clip, scene.background) == ((), None)


# Grids


def test_all_layers_are_in_view():
    beside = blob(spacing=(3, 3, 3))
    matrix = np.array(beside.world_from_index)
    matrix[0, 3] += 400
    far = ws.Volume(beside.samples, world_from_index=matrix)
    picture = ws.Scene([ws.Layer(CT, SOFT), ws.Layer(far, HOT)]).render("anterior", size=(80, 40))
    columns = np.flatnonzero(picture.rgba[..., 3].max(axis=0) > 0.2)
    assert columns.min() < 10
    assert columns.max() > 70
    bounds = ws.Scene([CT, far]).bounds
    np.testing.assert_array_equal(bounds[0], np.minimum(CT.bounds[0], far.bounds[0]))


@pytest.mark.parametrize("turn", [0.0, 0.3])
@pytest.mark.parametrize("spacing", [(3, 3, 3), (2, 3, 5)])
def test_a_layer_on_a_grid_of_its_own_lies_where_it_lies(spacing, turn):
    volume = blob(spacing=spacing, turn=turn)
    alone = ws.render(volume, HOT, EYE, size=SIZE, quality="high", shading=None).rgba
    layers = [ws.Layer(CT, CLEAR), ws.Layer(volume, HOT)]
    scene = ws.Scene(layers, shading=None)
    picture = scene.render(EYE, size=SIZE, quality="high")
    assert alone.max() > 0.5
    assert np.abs(picture.rgba - alone).max() < 0.03
    assert picture.report.get("resampled", []) == (["blob"] if turn else [])
    first = volume._resampled
    scene.render("left", size=SIZE)
    assert volume._resampled is first


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
@pytest.mark.parametrize("flips", [(1, 1, 1), (-1, 1, -1)])
def test_axes_in_another_order_or_flipped_are_turned_not_resampled(order, flips):
    samples = np.random.default_rng(2).random((8, 9, 10), np.float32)
    volume = ws.Volume(samples, spacing=(1, 2, 3))
    matrix = np.array(volume.world_from_index)
    turned = samples
    for axis in range(3):
        if flips[axis] < 0:
            turned = np.flip(turned, 2 - axis)
            matrix[:, 3] += matrix[:, axis] * (samples.shape[2 - axis] - 1)
            matrix[:, axis] *= -1
    matrix[:, :3] = matrix[:, list(order)]
    other = ws.Volume(turned.transpose([2 - axis for axis in reversed(order)]), world_from_index=matrix)
    placed = on_axes_of(other, volume)
    assert np.count_nonzero(placed.world_from_index[:3, :3] - np.diag(np.diag(placed.world_from_index[:3, :3]))) == 0
    assert np.shares_memory(placed.samples, other.samples) == (order == (0, 1, 2))
    look = ws.TransferFunction([(0, 0), (1, 0.5)], [(0, 0, 0, 1), (1, 1, 1, 0)])
    eye = ws.Camera.orbit(volume, 40, 30)
    scenes = [ws.Scene([ws.Layer(volume, look), ws.Layer(second, look)]) for second in (volume, other)]
    want, got = (scene.render(eye, size=SIZE) for scene in scenes)
    np.testing.assert_allclose(got.rgba, want.rgba, atol=1e-4)
    assert "resampled" not in got.report


def test_beyond_an_oblique_source_there_is_nothing():
    volume = ws.Volume(np.full((10, 12, 14), 7, np.int16), world_from_index=blob(turn=0.4).world_from_index)
    placed = on_axes_of(volume, CT)
    inside = np.isfinite(placed.samples)
    assert 0.3 < inside.mean() < 0.9
    np.testing.assert_allclose(placed.samples[inside], 7)
    assert "resampled onto the axes of another volume" in placed.facts.processing[-1]
    np.testing.assert_allclose(placed.spacing, (3, 3, 3), rtol=1e-6)


def test_wavelets_are_layers_too():
    wavelets = ws.WaveletVolume.from_volume(blob())
    parallel = draw([ws.Layer(CT, SOFT), ws.Layer(wavelets, HOT)])
    samples = draw([ws.Layer(CT, SOFT), ws.Layer(wavelets.to_volume(), HOT)])
    np.testing.assert_allclose(parallel.rgba, samples.rgba, atol=1e-5)
    oblique = ws.WaveletVolume.from_volume(blob(turn=0.3))
    assert draw([ws.Layer(CT, SOFT), ws.Layer(oblique, HOT)]).report["resampled"] == ["blob"]


def test_worlds_of_other_units_are_refused():
    with pytest.raises(ArgumentError, match="the lengths of 'ct_pelvis.nii.gz' are in mm, the lengths of 'blob' in um"):
        draw([CT, ws.Layer(blob(unit="um"), HOT)])
    draw([ws.Layer(CT, SOFT), ws.Layer(blob(unit="mm"), HOT)])


# Clips and labels


def test_boxes_in_samples_are_of_the_first_layer():
    box = ws.Crop((20, 20, 20), (70, 70, 70), space="index")
    corners = np.array([box.lower, box.upper]) @ CT.world_from_index[:3, :3].T + CT.world_from_index[:3, 3]
    in_world = ws.Crop(corners.min(axis=0), corners.max(axis=0))
    layers = [ws.Layer(CT, SOFT), ws.Layer(blob(spacing=(2, 2, 2)), HOT)]
    for clip in (lambda crop: crop, ws.CutOut):
        got, want = (ws.Scene(layers, clip=clip(crop)).render(EYE, size=SIZE).rgba for crop in (box, in_world))
        assert got.max() > 0.3
        np.testing.assert_allclose(got, want, atol=1e-4)
    hidden = ws.Scene([ws.Layer(CT, SOFT, visible=False), ws.Layer(blob(), HOT)], clip=box)
    assert hidden.render(EYE, size=SIZE).rgba.max() > 0.3


def test_labels_stay_where_their_scan_is_hidden():
    segmentation = np.zeros(CT.shape, np.uint8)
    segmentation[40:70, 30:70, 40:80] = 1
    labels = ws.Labels(segmentation, {1: ws.Label("#ff0000", 0.9)})
    scene = ws.Scene([ws.Layer(CT, SOFT, visible=False), ws.Layer(blob(), HOT, visible=False)], labels=labels)
    rgba = scene.render(EYE, size=SIZE).rgba
    assert rgba[..., 0].max() > 0.5
    assert rgba[..., 1].max() < 0.3 * rgba[..., 0].max()
    # Over a projection they are translucent.
    projected = scene.render(EYE, size=SIZE, composite="maximum").rgba
    np.testing.assert_allclose(projected[..., 3], 0.6 * rgba[..., 3], atol=0.01)


def test_a_wanted_psnr_holds_for_layers():
    scene = ws.Scene([ws.Layer(CT, SOFT), ws.Layer(blob(), HOT)])
    first, second = (scene.render(camera, size=SIZE, psnr=40) for camera in (EYE, ws.Camera.orbit(CT, 35, 20)))
    assert first.report["expected_psnr_spread_db"] < second.report["expected_psnr_spread_db"]
    fine = scene.render(EYE, size=SIZE, quality=ws.Sampling(12, 4)).rgba
    assert -10 * np.log10(np.mean((first.rgba - fine)[..., :3] ** 2)) > 38
