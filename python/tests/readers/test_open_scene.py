"""Files with several channels as scenes: colours, windows, names and visibility come from the file."""

from __future__ import annotations

import numpy as np
import pytest
from test_facts_of_files import save_imagej, save_ome_zarr

import wavesplat as ws
from wavesplat._looks.kinds import channels
from wavesplat._readers.levels import Levels
from wavesplat.errors import ArgumentError, WavesplatWarning

N = 12


def cells(n_channels, n_times=1):
    """Samples [t, c, z, y, x]: in each channel a ball at another place, brighter with time, over a dim background."""
    z, y, x = np.mgrid[:N, :N, :N]
    rng = np.random.default_rng(5)
    stack = rng.integers(90, 110, (n_times, n_channels, N, N, N)).astype(np.uint16)
    for t in range(n_times):
        for c in range(n_channels):
            ball = (x - 2 - c) ** 2 + (y - 6) ** 2 + (z - 6) ** 2 < 6
            stack[t, c][ball] += np.uint16(400 * (t + 1))
    return stack


def save(path, n_channels, described=None, n_times=1):
    omero = {} if described is None else {"omero": {"channels": described}}
    samples = cells(n_channels, n_times)
    axes, scale = ("czyx", 4) if n_times == 1 else ("tczyx", 5)
    save_ome_zarr(path, samples[0] if n_times == 1 else samples, axes, scale=(1.0,) * scale, **omero)
    return path


DESCRIBED = [
    {"label": "DAPI", "color": "0000FF", "window": {"start": 150, "end": 450}},
    {"label": "GFP", "color": "00FF00", "window": {"start": 0, "end": 65535}},
    {"label": "mCherry", "color": "FF0000", "active": False},
]


def colors(scene):
    """Colours in the middle of each look, where it is the channel's own."""
    return [tuple(layer.look.transfer_function.color[1][1:]) for layer in scene.layers]


def windows(scene):
    return [tuple(layer.look.transfer_function.opacity[k][0] for k in (0, -1)) for layer in scene.layers]


def test_a_scene_is_as_the_file_says(tmp_path):
    scene = ws.open_scene(save(tmp_path / "a.zarr", 3, DESCRIBED))
    assert [layer.name for layer in scene.layers] == ["DAPI", "GFP", "mCherry"]
    assert [layer.visible for layer in scene.layers] == [True, True, False]
    assert windows(scene)[0] == (150, 450)
    low, high = windows(scene)[1]  # its window is of all values that there are, which is none
    assert 100 < low < 300 < high < 550
    blue, green, red = colors(scene)
    assert green == (0, 1, 0)
    assert red[0] == 1
    assert red[1] == red[2] < 0.1
    # Pure blue is too dark to be seen on black.
    assert blue[2] == 1
    assert 0.1 < blue[0] == blue[1] < 0.2
    assert [layer.look.shading for layer in scene.layers] == [None] * 3
    assert scene.layers[0].look.background == "black"


def test_channels_without_colours_have_those_of_the_convention(tmp_path):
    scene = ws.open_scene(save(tmp_path / "a.zarr", 4))
    assert colors(scene)[:2] == [(0, 1, 0), (1, 0, 1)]
    assert [layer.name for layer in scene.layers] == [f"channel {c}" for c in range(4)]
    # A colour that an earlier channel has is replaced.
    described = [{"color": "FF00FF"}, {"color": "FF00FF"}, {"color": "ffffff"}, {}]
    scene = ws.open_scene(save(tmp_path / "b.zarr", 4, described))
    assert colors(scene) == [(1, 0, 1), (0, 1, 0), (1, 1, 1), (0, 1, 1)]
    described[0]["color"] = "FFFFFF"
    scene = ws.open_scene(save(tmp_path / "c.zarr", 4, described))
    assert colors(scene) == [(1, 1, 1), (1, 0, 1), (0, 1, 0), (0, 1, 1)]


def test_fault_4_of_two_white_channels_beside_a_green_one_only_the_second_changes(tmp_path):
    described = [{"color": "00FF00"}, {"color": "FFFFFF"}, {"color": "FFFFFF"}]
    scene = ws.open_scene(save(tmp_path / "a.zarr", 3, described))
    assert colors(scene) == [(0, 1, 0), (1, 1, 1), (1, 0, 1)]
    # White alone is what writers put where no colour is known.
    scene = ws.open_scene(save(tmp_path / "b.zarr", 3, [{"color": "FFFFFF"}] * 2))
    assert colors(scene) == [(0, 1, 0), (1, 0, 1), (0, 1, 1)]


def test_channels_are_chosen_by_number_and_name(tmp_path):
    path = save(tmp_path / "a.zarr", 3, DESCRIBED)
    scene = ws.open_scene(path, channels=["mCherry", ("dapi", "yellow"), (1, None, (200, 300))])
    assert [layer.name for layer in scene.layers] == ["mCherry", "DAPI", "GFP"]
    assert [layer.visible for layer in scene.layers] == [True] * 3
    assert colors(scene)[1:] == [(1, 1, 0), (0, 1, 0)]
    assert windows(scene)[1:] == [(150, 450), (200, 300)]
    np.testing.assert_array_equal(scene.layers[0].volume.samples, cells(3)[0, 2])


def test_a_single_channel_has_the_look_of_its_kind(tmp_path):
    scene = ws.open_scene(save(tmp_path / "a.zarr", 3, DESCRIBED), channels=[1])
    assert scene.layers[0].look is None
    np.save(tmp_path / "a.npy", cells(1)[0, 0])
    scene = ws.open_scene(tmp_path / "a.npy")
    assert (scene.layers[0].look, scene.layers[0].name) == (None, "a.npy")


def test_each_channel_is_read_once(tmp_path, monkeypatch):
    read = []
    original = Levels.whole
    monkeypatch.setattr(Levels, "whole", lambda self, request: read.append(request.channel) or original(self, request))
    ws.open_scene(save(tmp_path / "a.zarr", 3, DESCRIBED)).bounds  # noqa: B018
    assert read == [0, 1, 2]
    read.clear()
    ws.open_scene(tmp_path / "a.zarr", channels=["GFP", 0])
    assert read == [1, 0]


def test_of_many_channels_the_first_active_ones_are_taken(tmp_path):
    described = [{"label": f"c{n}", "active": n not in (1, 3)} for n in range(11)]
    with pytest.warns(WavesplatWarning, match=r"11 channels, a scene at most 8: 0, 2, 4, 5, 6, 7, 8, 9 are taken"):
        scene = ws.open_scene(save(tmp_path / "a.zarr", 11, described))
    assert [layer.name for layer in scene.layers] == ["c0", "c2", *(f"c{n}" for n in range(4, 10))]
    assert len(set(colors(scene))) == 8


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([3], r"channel 3, but the file holds 3 channels, 0\.\.2: .*a\.zarr$"),
        (["Cy5"], r"no channel 'Cy5'; the file names 'DAPI', 'GFP', 'mCherry': .*a\.zarr$"),
        ([2.5], "a channel is 2.5; give a number from 0, or a name"),
        ([(0, "blue", (1, 2), 3)], "a channel is .*; give a number or a name, or"),
        ([(0, "grean")], "color is 'grean'"),
        ([(0, "green", (2, 1))], r"window is \(2, 1\); low must be less than high"),
        ([], "1 to 8 channels, not 0"),
        ([0] * 9, "1 to 8 channels, not 9"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, given, message):
    with pytest.raises(ArgumentError, match=message):
        ws.open_scene(save(tmp_path / "a.zarr", 3, DESCRIBED), channels=given)


def test_times_of_a_scene_share_looks(tmp_path):
    path = save(tmp_path / "a.zarr", 2, DESCRIBED[1:], n_times=4)
    scene = ws.open_scene(path, time=1)
    np.testing.assert_array_equal(scene.layers[1].drawn.samples, cells(2, 4)[1, 1])
    later = scene.at_time(-1)
    np.testing.assert_array_equal(later.layers[1].drawn.samples, cells(2, 4)[3, 1])
    assert [layer.look for layer in later.layers] == [layer.look for layer in scene.layers]
    # The window is by the brightest time, so that nothing is clipped at any time.
    assert windows(scene)[0][1] > 1000
    for time in (4, -5):
        with pytest.raises(ArgumentError, match=f"time point {time}, but the file .* holds 4"):
            scene.at_time(time)
        with pytest.raises(ArgumentError, match=f"time point {time}, but the file .* holds 4"):
            ws.open_scene(path, time=time)
    with pytest.raises(ArgumentError, match="no layer with several times"):
        ws.open_scene(tmp_path / "a.zarr", time=0).with_(layers=ws.Layer(ws.examples.ripples(8))).at_time(1)


def test_automatic_looks_do_not_flicker(tmp_path):
    """For a series in a layer without a look, one look is chosen for all times."""
    np.save(tmp_path / "a.npy", cells(1, 3)[:, 0])
    scene = ws.open_scene(tmp_path / "a.npy")
    pictures = [scene.at_time(time).render("front", size=(24, 24)) for time in range(3)]
    assert len({repr(picture.report["look"]) for picture in pictures}) == 1
    brightness = [float(picture.rgba[..., :3].sum()) for picture in pictures]
    assert brightness == sorted(brightness)
    assert brightness[2] > 1.2 * brightness[0]


def test_imagej_composites(tmp_path):
    blue, red = np.zeros((2, 3, 256), np.uint8)
    blue[2] = red[0] = np.arange(256)
    stack = np.moveaxis(cells(2)[0], 0, 1)
    path = save_imagej(
        tmp_path / "a.tif", stack, axes="ZCYX", LUTs=[blue, red], Ranges=(120.0, 400.0, 0.0, 65535.0), mode="composite"
    )
    scene = ws.open_scene(path)
    assert windows(scene)[0] == (120, 400)
    assert windows(scene)[1][1] < 600
    assert [max(range(3), key=lambda part, color=color: color[part]) for color in colors(scene)] == [2, 0]


def test_pixels_of_colours_are_in_their_colours(tmp_path):
    import tifffile

    tifffile.imwrite(tmp_path / "a.tif", np.moveaxis(cells(3)[0], 0, -1), photometric="rgb")
    scene = ws.open_scene(tmp_path / "a.tif")
    assert [layer.name for layer in scene.layers] == ["red", "green", "blue"]
    assert [max(range(3), key=lambda part, color=color: color[part]) for color in colors(scene)] == [0, 1, 2]


def test_scenes_of_files_are_documents(tmp_path):
    """Channels, times, patterns and slices of series come back as they were, with their looks."""
    path = save(tmp_path / "a.zarr", 2, DESCRIBED[1:], n_times=4)
    scene = ws.open_scene(path, time=1, composite="maximum")
    scene.save(tmp_path / "scene.json")
    again = ws.Scene.load(tmp_path / "scene.json")
    assert [(layer.name, layer.look, layer.time, layer.visible) for layer in again.layers] == [
        (layer.name, layer.look, layer.time, layer.visible) for layer in scene.layers
    ]
    np.testing.assert_array_equal(again.layers[1].drawn.samples, scene.layers[1].drawn.samples)
    assert '"path": "a.zarr"' in (tmp_path / "scene.json").read_text()
    for number, one in enumerate(cells(1, 3)[:, 0]):
        np.save(tmp_path / f"t{number}.npy", one)
    for given in (tmp_path / "t*.npy", [tmp_path / "t2.npy", tmp_path / "t0.npy"]):
        series = ws.open_series(given, spacing=(1, 2, 3))[::-1]
        ws.Scene(ws.Layer(series, time=1)).save(tmp_path / "scene.json")
        loaded = ws.Scene.load(tmp_path / "scene.json").layers[0]
        np.testing.assert_array_equal(loaded.drawn.samples, series[1].samples)
        assert (loaded.drawn.spacing, len(loaded.volume)) == ((1, 2, 3), len(series))
    with pytest.raises(ArgumentError, match="comes from no file"):
        ws.Scene(ws.Layer(ws.Series([ws.Volume(cells(1)[0, 0])]))).save(tmp_path / "scene.json")


# Looks of channels


def test_what_is_below_the_window_is_clear_and_what_is_bright_is_in_the_colour():
    volume = ws.Volume(cells(1)[0, 0])
    picture = ws.render(volume, ws.Look.channel(volume, "magenta", (150, 480)), size=(48, 48))
    red, green, blue, alpha = np.moveaxis(picture.rgba, -1, 0)
    assert alpha[0, 0] == 1  # black behind it
    seen = red > 0.05
    assert 0.02 < seen.mean() < 0.8
    assert red[seen].max() > 0.5
    np.testing.assert_allclose(red, blue, atol=1e-6)
    assert np.median(green[seen] / red[seen]) < 0.2


def test_windows_of_values_see_spots_and_leave_noise():
    def window(values):
        return channels.channel_window(ws.Volume(values.reshape(10, -1, 100)))[:2]

    rng = np.random.default_rng(2)
    noise = rng.normal(100, 5, 100_000)
    low, high = window(noise)
    assert 104 < low < high
    spots = noise.copy()
    spots[:100] = 1000  # a thousandth of the samples
    assert window(spots) == pytest.approx((105, 1000), abs=1)
    low, high = window(np.full(2000, 3.0))
    assert high > low == 3


def test_a_window_of_all_values_of_a_type_tells_nothing():
    volume = ws.Volume(cells(1)[0, 0])
    for high, nothing in ((65535, True), (4095, True), (4096, False), (255, False), (450, False)):
        assert channels.is_full_range_window((0, high), volume) == nothing
    assert not channels.is_full_range_window((10, 65535), volume)


def test_no_colour_is_refused():
    with pytest.raises(ArgumentError, match="transparent"):
        ws.Look.channel(ws.examples.ripples(8), "transparent")
