"""Channels on slices: light that follows every change of their looks, in the colours that they have in space."""

import json
from dataclasses import replace

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks import look_files
from wavesplat._looks.kinds.channel_light import light_of
from wavesplat._scene.drawing.drawn_layers import drawn_layers
from wavesplat._viewer.session.state import ViewerState

N = 16
#: The window of all channels here, whose values cover it.
LOW, HIGH = 100.0, 900.0


def ramp_volume(axis, **facts):
    values = np.linspace(0, 1000, N).reshape([N if k == axis else 1 for k in range(3)])
    samples = np.broadcast_to(values, (N, N, N)).astype(np.float32)
    return ws.Volume(samples, facts=ws.Facts(unit="um", modality="fluorescence", **facts))


def looks(composite="over", color="green", **changes):
    """Two channels with one look that is changed, and the plain one."""
    volumes = [ramp_volume(1), ramp_volume(2)]
    plain = [ws.Look.channel(v, c, (LOW, HIGH), composite) for v, c in zip(volumes, (color, "magenta"), strict=True)]
    changed = [plain[0].changed(**changes), plain[1]]
    return [[ws.Layer(*pair) for pair in zip(volumes, one, strict=True)] for one in (plain, changed)]


def light_of_first(layers):
    """The first channel's light in a slice, by value along the axis that its values rise along."""
    dark = ws.Layer(ramp_volume(1), ws.Look.channel(ramp_volume(1), "red", (5000, 6000)))
    picture = ws.slice([layers[0], dark], "xy")
    return picture.value[:, 0], picture.rgba[:, 0, :3]


@pytest.mark.parametrize("composite", ["over", "maximum"])
@pytest.mark.parametrize("color", ["green", "white", "#204080"])
@pytest.mark.parametrize("gamma", [0.4, 0.8, 2.5])
def test_slices_follow_the_gamma_of_a_channel(gamma, color, composite):
    plain, changed = (light_of_first(layers) for layers in looks(composite, color, gamma=gamma))
    share = np.clip((plain[0] - LOW) / (HIGH - LOW), 0, 1)
    full = plain[1].max(axis=0)
    np.testing.assert_allclose(plain[1], share[:, None] * full, atol=1e-6)
    np.testing.assert_allclose(changed[1], share[:, None] ** gamma * full, atol=0.05)  # curves have eight parts
    assert np.abs(changed[1] - plain[1]).max() > 0.03


@pytest.mark.parametrize("composite", ["over", "maximum"])
@pytest.mark.parametrize("exposure", [0.5, 1.7, 3.0])
def test_slices_follow_the_exposure_of_a_channel(exposure, composite):
    plain, changed = (light_of_first(layers) for layers in looks(composite, exposure=exposure))
    green = 1
    wanted = np.minimum(exposure * plain[1][:, green], 1)
    np.testing.assert_allclose(changed[1][:, green], wanted, atol=0.05)


def test_gamma_exposure_and_window_together():
    how = {"window": (LOW, 700), "gamma": 0.5, "exposure": 1.5}
    for composite in ("over", "maximum"):
        _, changed = looks(composite, **how)
        values, light = light_of_first(changed)
        wanted = np.minimum(1.5 * np.clip((values - LOW) / 600, 0, 1) ** 0.5, 1)
        np.testing.assert_allclose(light[:, 1], wanted, atol=0.05)


def test_a_saved_look_has_the_same_light():
    _, changed = looks(gamma=0.5, exposure=1.3)
    again = ws.Look.from_json(changed[0].look.to_json())
    np.testing.assert_array_equal(light_of_first([replace(changed[0], look=again)])[1], light_of_first(changed)[1])


def test_other_looks_are_no_channels():
    volume = ramp_volume(0)
    own = ws.TransferFunction([(0, 0), (9, 1)], [(0, 0, 0.2, 0), (6, 0, 1, 0), (9, 1, 1, 1)])
    for look in (ws.Look(transfer_function=own, shading=None), ws.Look.preset("ct-bone"), ws.Look.auto(volume, "mean")):
        assert light_of(look) is None


def fluorescence(seed, **channel):
    samples = np.random.default_rng(seed).exponential(5, (N, 24, 24)).astype(np.uint16)
    facts = ws.Facts(unit="um", modality="fluorescence", channel=ws.Channel(**channel) if channel else None)
    return ws.Volume(samples, facts=facts, name=f"channel {seed}")


@pytest.mark.parametrize("n_layers", [2, 3])
def test_fluorescence_without_looks_has_the_colours_of_space_on_slices(n_layers):
    """The first one was grey, and the others all green."""
    layers = [fluorescence(1), fluorescence(2, color=(1, 0, 0)), fluorescence(3)][:n_layers]
    in_space = [light_of(one.look).color for one in drawn_layers(ws.Scene(layers), None).layers]
    on_slices = [one["transfer_function"]["color"][-1][1:] for one in ws.slice(layers).report["shown"]]
    np.testing.assert_allclose(on_slices, in_space)
    assert len({tuple(color) for color in on_slices}) == n_layers
    only = [ws.Layer(layers[0]), *(ws.Layer(one, visible=False) for one in layers[1:])]
    rgb = ws.slice(only).rgba[..., :3]
    brightest = rgb.reshape(-1, 3)[rgb.sum(axis=2).argmax()]
    np.testing.assert_allclose(brightest / brightest.max(), np.array(in_space[0]) / max(in_space[0]), atol=0.02)


def test_fluorescence_over_a_scan_has_its_colour_of_space():
    scan = ws.Volume(np.random.default_rng(0).normal(100, 20, (N, 24, 24)).astype(np.float32), unit="um")
    layers = [scan, fluorescence(1, color=(0, 0, 1)), fluorescence(2)]
    in_space = [one.look.transfer_function.color for one in drawn_layers(ws.Scene(layers), None).layers[1:]]
    on_slices = [one["transfer_function"]["color"] for one in ws.slice(layers).report["shown"][1:]]
    np.testing.assert_allclose(np.array(on_slices), np.array(in_space))


def test_the_viewer_shows_slices_of_the_same_colours():
    layers = [fluorescence(1), fluorescence(2)]
    wanted = ws.slice(layers, size=(24, 24)).rgba
    state = ViewerState.of(ws.Scene(layers))
    np.testing.assert_allclose(ws.slice(state.scene, size=(24, 24)).rgba, wanted, atol=1e-6)


def test_automatic_fluorescence_stays_a_channel_when_it_is_changed():
    look = ws.Look.auto(fluorescence(1)).changed(gamma=0.5)
    assert look.name == "channel"
    assert light_of(look_files.parse(json.dumps({"version": 1, **look_files.fields_of(look)}), None)) is not None


def test_changed_looks_are_saved_with_their_colours(tmp_path):
    """The last node was written, which is whitened: red was (1, 0.35, 0.35) after a gamma."""
    volumes = [fluorescence(1, color=(0, 0, 1)), fluorescence(2)]
    for number, changes in enumerate(({"gamma": 0.6}, {"exposure": 2.0}, {"window": (2, 30), "gamma": 2})):
        made = [ws.Look.channel(volumes[0]), ws.Look.channel(volumes[1], "red", (5, 20))]
        layers = [ws.Layer(v, look.changed(**changes)) for v, look in zip(volumes, made, strict=True)]
        path = tmp_path / f"{number}.ome.tif"
        ws.Scene(layers).save_volumes(path)
        colors = [one.color for one in ws.open(path, channel=1).facts.channels]
        np.testing.assert_allclose(colors, [(0, 0, 1), (1, 0, 0)], atol=0.02)
