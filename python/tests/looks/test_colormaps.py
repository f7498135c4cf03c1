"""Transfer functions from colour maps."""

import warnings

import numpy as np
import pytest
from tiff_pixels import tiff_pixels

import wavesplat as ws
from wavesplat.errors import ArgumentError, WavesplatWarning

#: Entries of a colour table of 256 at which the colours below, 0..255, are those of matplotlib 3.11.
ENTRIES = np.array([0, 37, 101, 128, 200, 255])
MATPLOTLIB = {
    "viridis": [(68, 1, 84), (70, 51, 127), (42, 119, 142), (33, 145, 140), (112, 207, 87), (253, 231, 37)],
    "inferno": [(0, 0, 4), (41, 11, 85), (146, 37, 104), (188, 55, 84), (251, 157, 7), (252, 255, 164)],
    "hot": [(11, 0, 0), (108, 0, 0), (255, 21, 0), (255, 92, 0), (255, 255, 38), (255, 255, 255)],
    "jet": [(0, 0, 128), (0, 20, 255), (38, 255, 209), (125, 255, 122), (255, 119, 0), (128, 0, 0)],
    "coolwarm": [(59, 76, 192), (104, 138, 239), (191, 211, 246), (221, 220, 220), (240, 139, 110), (180, 4, 38)],
    "gray": [(0, 0, 0), (37, 37, 37), (101, 101, 101), (128, 128, 128), (200, 200, 200), (255, 255, 255)],
    "RdBu_r": [(5, 48, 97), (48, 122, 182), (207, 228, 239), (247, 246, 246), (219, 107, 85), (103, 0, 31)],
}
COUNTS = ws.Volume(np.concatenate([np.zeros(271), np.geomspace(1, 1000, 729)]).reshape(10, 10, 10))


@pytest.mark.parametrize("name", MATPLOTLIB)
def test_colours_are_within_a_level_of_those_of_matplotlib(name):
    curves = ws.TransferFunction.from_colormap(name, clim=(-100, 300))
    values = -100 + 400 * ENTRIES / 255
    np.testing.assert_allclose(255 * curves(values)[:, :3], MATPLOTLIB[name], atol=1)


@pytest.mark.parametrize("name", ["viridis", "twilight_shifted", "cmocean:ice", "crameri:batlow", "CET_L4", "turbo_r"])
def test_colours_between_nodes_are_those_of_the_map(name):
    import cmap

    places = np.random.default_rng(1).random(500)
    curves = ws.TransferFunction.from_colormap(name, clim=(0, 1))
    apart = np.abs(curves(places)[:, :3] - np.asarray(cmap.Colormap(name)(places, N=4096))[:, :3])
    assert 255 * apart.max() < 1.5


def test_maps_of_categories_are_steps():
    curves = ws.TransferFunction.from_colormap("tab10", clim=(0, 10))
    rgb = curves(np.arange(10) + 0.5)[:, :3]
    np.testing.assert_array_equal(curves(np.arange(10) + 0.01)[:, :3], rgb)
    np.testing.assert_allclose(255 * rgb[0], (31, 119, 180), atol=0.5)
    assert len(np.unique(rgb, axis=0)) == 10


def test_case_and_what_joins_words_do_not_matter_and_nobody_is_warned(caplog):
    for name in ("CoolWarm", "coolwarm", " COOLWARM "):
        curves = ws.TransferFunction.from_colormap(name, clim=(0, 1))
        np.testing.assert_allclose(255 * curves([0.0])[:, :3], [(59, 76, 192)], atol=1)
    assert caplog.text == ""


@pytest.mark.parametrize(
    ("name", "offered"),
    [("virids", "did you mean viridis"), ("infernal", "did you mean inferno"), ("qqqqqq", "names are those of")],
)
def test_unknown_maps_offer_near_ones(name, offered):
    with pytest.raises(ArgumentError, match=f"unknown colour map '{name}'; .*{offered}"):
        ws.TransferFunction.from_colormap(name, clim=(0, 1))


@pytest.mark.parametrize(
    ("opacity", "alphas"),
    [
        ("linear", [0, 0.25, 0.5, 0.75, 1]),
        ("sqrt", [0, 0.5, 0.5**0.5, 0.75**0.5, 1]),
        ("sigmoid", [0, 0.0451, 0.5, 0.9549, 1]),
        (0.3, [0.3] * 5),
        ([0, 0.1, 0.5], [0, 0.05, 0.1, 0.3, 0.5]),
        (np.array([0, 1.0]), [0, 0.25, 0.5, 0.75, 1]),
        ([(2, 0), (6, 0.8)], [0, 0, 0.4, 0.8, 0.8]),
    ],
)
def test_opacities(opacity, alphas):
    curves = ws.TransferFunction.from_colormap("gray", clim=(0, 8), opacity=opacity, opacity_unit=2)
    assert curves.opacity_unit == 2
    np.testing.assert_allclose(curves([0, 2, 4, 6, 8])[:, 3], alphas, atol=2e-3)


def test_gamma_and_log_place_colours_and_opacities():
    values = np.geomspace(1, 1000, 50)
    log = ws.TransferFunction.from_colormap("gray", clim=(1, 1000), log=True)
    np.testing.assert_allclose(log(values), np.linspace(0, 1, 50)[:, None] * np.ones(4), atol=0.5 / 255)
    values = np.linspace(0, 8, 50)
    for gamma in (0.4, 2.5):
        curves = ws.TransferFunction.from_colormap("gray", clim=(0, 8), gamma=gamma)
        np.testing.assert_allclose(curves(values), (values / 8)[:, None] ** gamma * np.ones(4), atol=1 / 255)


def test_the_range_of_a_volume():
    volume = ws.Volume(np.linspace(5, 9, 1000).reshape(10, 10, 10))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        curves = ws.TransferFunction.from_colormap("viridis", volume)
        np.testing.assert_allclose([curves.color[0][0], curves.color[-1][0]], [5, 9], atol=0.01)
        ws.TransferFunction.from_colormap("viridis", volume, log=True)
    with pytest.warns(WavesplatWarning, match="27.1 % of volume .* no logarithm; they are shown as 1.00"):
        curves = ws.TransferFunction.from_colormap("viridis", COUNTS, log=True)
    np.testing.assert_allclose([curves.color[0][0], curves.color[-1][0]], [1, 1000], rtol=0.02)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ({}, "pass clim=.low, high. or the volume"),
        ({"clim": (3, 1)}, "did you mean .1, 3.?"),
        ({"clim": 3}, "clim is 3; give"),
        ({"clim": (0, 1), "log": True}, "0 has no logarithm; give a positive low"),
        ({"clim": (0, 1), "gamma": 0}, "gamma is 0"),
        ({"clim": (0, 1), "opacity": "steep"}, "'steep'; give linear, sigmoid, sqrt"),
        ({"clim": (0, 1), "opacity": []}, "opacity is a list; give linear"),
        ({"clim": (0, 1), "opacity": [(0, 1, 2)]}, "opacity is .*; give linear"),
        ({"clim": (0, 1), "opacity": 7}, "7"),
        ({"volume": ws.Volume(-COUNTS.samples), "log": True}, "no sample is positive"),
    ],
)
def test_mistakes(arguments, complaint):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WavesplatWarning)
        with pytest.raises(ArgumentError, match=complaint):
            ws.TransferFunction.from_colormap("viridis", **arguments)


# The command line


def test_render_takes_a_map(wavesplat, ramp_file, tmp_path):
    import tifffile

    out = tmp_path / "a.tif"
    options = ("--cmap", "inferno", "--clim", "10,200", "--opacity", "0,0.1,0.5", "--gamma", "0.7", "--size", "16x16")
    assert wavesplat("render", ramp_file, "-o", out, *options).returncode == 0
    curves = ws.TransferFunction.from_colormap("inferno", clim=(10, 200), opacity=(0, 0.1, 0.5), gamma=0.7)
    expected = ws.render(ws.open(ramp_file), curves, size=(16, 16), background="black")
    np.testing.assert_array_equal(tifffile.imread(out), tiff_pixels(expected))


def test_projections_are_opaque_over_the_whole_range(wavesplat, ramp_file, tmp_path):
    import tifffile

    out = tmp_path / "a.tif"
    options = ("--composite", "maximum", "--cmap", "viridis", "--clim", "0,255", "--size", "16x16", "--view", "left")
    assert wavesplat("render", ramp_file, "-o", out, *options).returncode == 0
    assert tifffile.imread(out)[8, 8, 2] > 25  # the darkest of viridis is violet


def test_what_a_logarithm_leaves_out_is_a_note(wavesplat, tmp_path):
    np.save(tmp_path / "counts.npy", COUNTS.samples)
    done = wavesplat("render", tmp_path / "counts.npy", "-o", tmp_path / "a.png", "--log", "--size", "8x8")
    assert done.returncode == 0
    assert done.stderr.startswith("wavesplat: note: 27.1 % of volume")
    assert done.stderr.count("\n") == 1


def test_slices_take_maps_ranges_and_windows(wavesplat, ramp_file, tmp_path):
    import json

    import tifffile

    out, volume = tmp_path / "a.tif", ws.open(ramp_file)

    def drawn(*options):
        done = wavesplat("slice", ramp_file, "-o", out, "--json", "--size", "16x16", *options)
        assert done.returncode == 0, done.stderr
        return tifffile.imread(out), json.loads(done.stdout)["report"], done.stderr

    colored, _, _ = drawn("--cmap", "viridis", "--clim", "0,255")
    curves = ws.TransferFunction.from_colormap("viridis", clim=(0, 255), opacity=1.0)
    np.testing.assert_array_equal(colored, tiff_pixels(ws.slice(volume, transfer_function=curves)))
    grey, report, _ = drawn("--clim", "10,200")
    np.testing.assert_array_equal(grey, tiff_pixels(ws.slice(volume, clim=(10, 200))))
    assert report["window"] == [105, 190]
    _, report, stderr = drawn("--window", "brain")
    assert (report["window"], report["clim"]) == ([40, 80], [0, 80])
    of_units, of_picture = stderr.splitlines()
    assert of_units.startswith("wavesplat: note: window 'brain' is for Hounsfield units")
    assert of_picture.startswith("wavesplat: note: the values in the picture")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--cmap", "virids"], "did you mean viridis"),
        (["--cmap", "viridis", "--tf", "a.json"], "without --preset and --tf"),
        (["--log", "--preset", "grey"], "without --preset and --tf"),
        (["--cmap", "viridis", "--materials", "ct"], "--cmap and --materials"),
        (["--cmap", "viridis", "--opacity", "steep"], "'steep'; give linear"),
        (["--cmap", "viridis", "--opacity", "0,x"], "'0,x' is not numbers"),
        (["--clim", "5"], "'5' is not 2 numbers"),
    ],
)
def test_mistakes_of_the_command_line(wavesplat, ramp_file, tmp_path, options, message):
    done = wavesplat("render", ramp_file, "-o", tmp_path / "a.png", *options)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert message in done.stderr
