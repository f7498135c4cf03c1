"""Changes of a look that keep it: window, gamma, opacity, exposure; and windows of percentiles."""

import colorsys
from dataclasses import replace

import numpy as np
import pytest
import tifffile
from PIL import Image

import wavesplat as ws
from wavesplat.errors import ArgumentError

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def stack(n=10, seed=2):
    """Dim rings over a background of noise, counts of photons."""
    rng = np.random.default_rng(seed)
    z, y, x = np.mgrid[:n, :64, :64].astype(np.float32)
    light = np.full((n, 64, 64), 100, np.float32)
    for cz, cy, cx in rng.uniform((2, 12, 12), (n - 2, 52, 52), (4, 3)):
        ring = np.hypot(np.hypot(y - cy, x - cx), z - cz) - rng.uniform(5, 9)
        light += 150 * rng.lognormal(0, 1) * np.exp(-(ring**2))
    return rng.poisson(light).astype(np.uint16)


@pytest.fixture(scope="module")
def cells():
    return ws.Volume(stack(), spacing=(0.1, 0.1, 0.2), unit="um")


@pytest.fixture(scope="module")
def channels():
    volumes = [ws.Volume(stack(seed=seed), spacing=(0.1, 0.1, 0.2), unit="um") for seed in (2, 3)]
    return [ws.Layer(v, ws.Look.channel(v, color)) for v, color in zip(volumes, ("green", "magenta"), strict=True)]


def mean_and_hue(picture):
    rgb = picture.rgba[..., :3]
    color = rgb[(rgb > 6 / 255).any(axis=2)].mean(axis=0)
    return (rgb @ LUMINANCE).mean(), 360 * colorsys.rgb_to_hsv(*color)[0]


def drawn(volume, look):
    return ws.render(volume, look, size=(96, 96), background="black")


def test_exposure_is_a_gain_of_what_gives_light_fault_4a(cells):
    look = ws.Look.auto(cells)
    assert look.shading is None
    assert look.changed(exposure=1.0) is look
    (mean, hue), (doubled, same_hue), (halved, _) = (
        mean_and_hue(drawn(cells, look.changed(exposure=exposure))) for exposure in (1, 2, 0.5)
    )
    assert doubled > 1.6 * mean
    assert abs(same_hue - hue) < 5
    assert halved == pytest.approx(0.5 * mean, rel=0.02)


@pytest.mark.parametrize("preset", ["fluorescence-green", "fluorescence-magenta"])
def test_exposure_keeps_the_colours_of_presets_fault_4b(cells, preset):
    look = ws.Look.preset(preset, cells)
    (mean, hue), (brighter, same_hue) = (mean_and_hue(drawn(cells, look.changed(exposure=e))) for e in (1, 3))
    assert brighter > 1.6 * mean
    assert abs(same_hue - hue) < 5


def test_exposure_of_channels_keeps_their_mixture(channels):
    scenes = [
        ws.Scene([replace(one, look=one.look.changed(exposure=e)) for one in channels], background="black")
        for e in (1, 2)
    ]
    (mean, hue), (brighter, same_hue) = (mean_and_hue(scene.render(size=(96, 96))) for scene in scenes)
    assert brighter > 1.3 * mean
    assert abs(same_hue - hue) < 5


def test_exposure_of_a_lit_look_is_its_light(cells):
    look = ws.Look.preset("ct-bone")
    assert look.changed(exposure=2).shading.exposure == 2 * look.shading.exposure
    assert look.changed(exposure=2).transfer_function == look.transfer_function
    greys = ws.Look.auto(cells, "maximum")
    plain, bright = (drawn(cells, look).rgba[..., :3] for look in (greys, greys.changed(exposure=1.5)))
    room = plain.max(axis=2) < 0.6
    assert np.allclose(bright[room], 1.5 * plain[room], atol=0.01)


def test_gamma_brightens_the_same_look_fault_4c(cells):
    look = ws.Look.auto(cells)
    brighter = look.changed(gamma=0.5)
    assert brighter.shading is None
    assert brighter.transfer_function.opacity == look.transfer_function.opacity
    (mean, hue), (bright, same_hue) = (mean_and_hue(drawn(cells, one)) for one in (look, brighter))
    assert bright > 1.15 * mean
    assert abs(same_hue - hue) < 5
    low, high = look.transfer_function.color[0][0], look.transfer_function.color[-1][0]
    at = low + (high - low) * np.array([0.04, 0.25, 0.49])
    of = low + (high - low) * np.array([0.2, 0.5, 0.7])
    assert np.allclose(brighter.transfer_function(at)[:, :3], look.transfer_function(of)[:, :3], atol=0.03)


def test_a_window_moves_the_look_fault_4d(cells):
    look = ws.Look.auto(cells)
    moved = look.changed(window=(10, 180)).transfer_function
    low, high = look.transfer_function.color[0][0], look.transfer_function.color[-1][0]
    assert (moved.color[0][0], moved.color[-1][0]) == (10, 180)
    shares = np.linspace(0, 1, 30)
    assert np.allclose(moved(10 + 170 * shares), look.transfer_function(low + (high - low) * shares))
    lit = ws.Look.preset("ct-bone").changed(window=(0, 1000))
    assert lit.shading == ws.Look.preset("ct-bone").shading


def test_opacity_alone_changes(cells):
    look = ws.Look.auto(cells)
    changed = look.changed(opacity="linear").transfer_function
    assert changed.color == look.transfer_function.color
    assert changed([changed.color[0][0], changed.color[-1][0]])[:, 3].tolist() == [0, 1]


def test_percentiles_are_those_of_the_samples(cells):
    low, high = np.percentile(cells.samples, (1, 99.8))
    ends = ("1%", "99.8%")
    look = ws.Look.channel(cells, "green", ends)
    assert (look.transfer_function.opacity[0][0], look.transfer_function.opacity[-1][0]) == (low, high)
    curve = ws.TransferFunction.from_colormap("gray", cells, clim=ends)
    assert (curve.color[0][0], curve.color[-1][0]) == (low, high)
    changed = ws.Look.auto(cells).changed(window=(50, "99.8%"), volume=cells).transfer_function
    assert (changed.color[0][0], changed.color[-1][0]) == (50, high)
    assert ws.slice(cells, "axial", clim=ends).report["clim"] == (low, high)
    layer = ws.Layer.overlay(cells, "hot", ends)
    assert layer.look.transfer_function.color[0][0] == low


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"window": ("1%", "120%")}, "'120%' is no percentile"),
        ({"window": ("99%", "1%")}, "do not grow"),
        ({"window": (5, 5)}, "low must be less than high"),
        ({"window": ("a", "b")}, "two numbers or percentiles"),
        ({"gamma": 0}, "gamma is 0"),
        ({"exposure": -1}, "exposure is -1"),
        ({"opacity": "steep"}, "'steep'"),
    ],
)
def test_changes_that_cannot_be_are_refused(cells, change, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Look.auto(cells).changed(**change, volume=cells)


def test_looks_without_a_window_say_so(cells):
    mask = ws.Look.auto(ws.Volume((cells.samples > 300).astype(np.uint8)))
    with pytest.raises(ArgumentError, match="no window to change"):
        mask.changed(window=(0, 2))
    with pytest.raises(ArgumentError, match="pass the volume too"):
        ws.Look.auto(cells).changed(window=("1%", "99%"))


# The command line -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stacks")
    one, two = folder / "one.ome.tif", folder / "two.ome.tif"
    size = {f"PhysicalSize{axis}": step for axis, step in (("X", 0.1), ("Y", 0.1), ("Z", 0.2))}
    tifffile.imwrite(one, stack(), metadata={"axes": "ZYX", **size})
    tifffile.imwrite(two, np.stack([stack(), stack(seed=3)]), metadata={"axes": "CZYX", **size})
    return one, two


def pixels(wavesplat, tmp_path, file, *options):
    out = tmp_path / "a.png"
    done = wavesplat("render", file, "-o", out, "--size", "64", "-q", *options)
    assert done.returncode == 0, done.stderr
    return out.read_bytes(), np.asarray(Image.open(out).convert("RGB")).astype(float)


def test_options_change_the_look_that_is_drawn_fault_4(wavesplat, tmp_path, files):
    one, two = files
    for file in (one, two):
        plain, before = pixels(wavesplat, tmp_path, file)
        assert pixels(wavesplat, tmp_path, file, "--exposure", "1")[0] == plain
        for options in (["--exposure", "2"], ["--gamma", "0.5"], ["--clim", "90%,99%"]):
            _, after = pixels(wavesplat, tmp_path, file, *options)
            assert after.mean() > 1.1 * before.mean(), options
            if file is one:
                red, green, blue = after.reshape(-1, 3).mean(axis=0)
                assert green > 1.2 * max(red, blue)  # as before, and not grey
    _, by_name = pixels(wavesplat, tmp_path, two, "--channel", "0:green:1%,99%", "--channel", "1:magenta")
    assert by_name.mean() > 5


def test_a_preset_can_be_exposed_and_windowed(wavesplat, tmp_path, files):
    options = ("--preset", "fluorescence-green")
    _, before = pixels(wavesplat, tmp_path, files[0], *options)
    _, after = pixels(wavesplat, tmp_path, files[0], *options, "--exposure", "3")
    assert after.mean() > 1.6 * before.mean()
    red, green, blue = after.reshape(-1, 3).mean(axis=0)
    assert green > 1.2 * max(red, blue)
