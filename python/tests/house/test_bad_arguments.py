"""Arguments of any type and size: an `ArgumentError` of one sentence, or a picture; no other error, and no panic."""

from __future__ import annotations

import inspect
import warnings

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, WavesplatError

VOLUME = ws.examples.ripples(6)
FUNCTION = ws.TransferFunction.auto(VOLUME)
PICTURE = ws.render(VOLUME, size=(4, 4))
SMALL = {"volume": VOLUME, "size": (4, 4)}
SCENE = {"what": VOLUME, "size": (4, 4)}

#: Public functions, and the good arguments of which a test replaces one by a bad one.
CALLS = {
    "render": (ws.render, SCENE),
    "render x-ray": (ws.render, SCENE | {"composite": "x-ray"}),
    "Scene": (ws.Scene, {"layers": VOLUME}),
    "Scene.render": (ws.Scene(VOLUME).render, {"size": (4, 4)}),
    "Layer": (ws.Layer, {"volume": VOLUME}),
    "FirstHit": (ws.FirstHit, {"iso_value": 100}),
    "LocalMaximum": (ws.LocalMaximum, {}),
    "DepthShadedMaximum": (ws.DepthShadedMaximum, {}),
    "DepthColoredMaximum": (ws.DepthColoredMaximum, {}),
    "AttenuatedMaximum": (ws.AttenuatedMaximum, {}),
    "XRay": (ws.XRay, {}),
    "Sampling": (ws.Sampling, {}),
    "ClipPlane": (ws.ClipPlane, {"point": (0, 0, 0), "normal": (0, 0, 1)}),
    "CutOut": (ws.CutOut, {"crop": ws.Crop((0, 0, 0), (3, 3, 3))}),
    "slice": (ws.slice, SCENE),
    "mesh": (ws.mesh, {"volume": VOLUME, "iso_value": 127.5}),
    "Camera": (ws.Camera, {"position": (0, 5, 0), "focal_point": (0, 0, 0), "view_up": (0, 0, 1), "parallel_scale": 3}),
    "orbit": (ws.Camera.orbit, {"volume": VOLUME, "view_angle": 30}),
    "turned": (ws.Camera.view(VOLUME, "left").turned, {}),
    "zoomed": (ws.Camera.view(VOLUME, "left").zoomed, {"factor": 2}),
    "fitted": (ws.Camera.view(VOLUME, "left").fitted, {"volume": VOLUME}),
    "interpolate": (ws.Camera.interpolate, {"cameras": [ws.Camera.view(VOLUME, "left")], "n": 3}),
    "camera from JSON": (ws.Camera.from_json, {"document": ws.Camera.view(VOLUME, "left").as_json()}),
    "from_pyvista": (ws.Camera.from_pyvista, {"source": ws.Camera.view(VOLUME, "left").cpos}),
    "Turn": (ws.Turn, {}),
    "KeyFrame": (ws.KeyFrame, {"time_s": 0}),
    "view": (ws.Camera.view, {"volume": VOLUME, "name": "left"}),
    "Crop": (ws.Crop, {"lower": (0, 0, 0), "upper": (3, 3, 3)}),
    "Volume": (ws.Volume, {"samples": np.zeros((3, 3, 3))}),
    "WaveletVolume": (ws.WaveletVolume.from_volume, {"volume": VOLUME}),
    "TransferFunction": (ws.TransferFunction, {"opacity": [(0, 0), (1, 1)], "color": [(0, 1, 1, 1)]}),
    "auto": (ws.TransferFunction.auto, {"volume": VOLUME}),
    "from_colormap": (ws.TransferFunction.from_colormap, {"name": "gray", "volume": VOLUME}),
    "look": (ws.Look.auto, {"volume": VOLUME}),
    "preset": (ws.Look.preset, {"name": "grey", "volume": VOLUME}),
    "corner": (ws.Crop.corner, {"volume": VOLUME, "name": "+x-y"}),
    "largest_body": (ws.largest_body, {"volume": VOLUME, "threshold": 100.0}),
    "from_json": (ws.TransferFunction.from_json, {"text": "{}"}),
    "values": (FUNCTION, {"values": [0.0]}),
    "Shading": (ws.Shading, {}),
    "Labels": (ws.Labels, {"segmentation": np.zeros((6, 6, 6), np.uint8)}),
    "Region": (ws.Region, {"lines": [[(0, 0, 0), (1, 0, 0), (1, 1, 0)]], "color": "red"}),
    "Isolines": (ws.Isolines, {"volume": VOLUME, "values": [1.0]}),
    "raycast": (ws.reference.raycast, SCENE | {"step": 1}),
    "splat_literal": (ws.reference.splat_literal, SMALL),
    "splat": (ws.study.splat, SMALL),
    "standard": (ws.study.standard, SMALL),
    "over": (PICTURE.over, {"below": PICTURE}),
    "ripples": (ws.examples.ripples, {"n": 4}),
}


class Thing:
    """An object that no function takes."""


BAD = [
    None, "x", "", b"x", 3.5, -1, 0, float("nan"), float("inf"), 1e308, -1e308, 1e-310, 10**400, True, [], [1],
    [1, 2, 3], [[1], [2, 3]], {}, {"a": 1}, Thing(), np.zeros(3), np.zeros((2, 2)), np.array(["a"]), np.float32(1),
    1j, (1, "a"), (None, None), (1e308, -1e308), (10**30, 5), "\ud800",
]  # fmt: skip


def said(function, arguments):
    """Call a function; return the sentence of its error, or None if it has none."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            function(**arguments)
    except WavesplatError as error:
        return str(error)
    except BaseException as error:  # noqa: BLE001 - a panic is no Exception
        return f"not ours: {type(error).__name__}: {error}"
    return None


@pytest.mark.parametrize("name", CALLS)
def test_one_bad_argument_is_one_sentence(name):
    function, arguments = CALLS[name]
    told = [
        (parameter, number, complaint)
        for parameter in inspect.signature(function).parameters
        for number, bad in enumerate(BAD)
        if (complaint := said(function, arguments | {parameter: bad})) is not None
    ]
    assert [case for case in told if "\n" in case[2] or case[2].startswith("not ours: ")] == []


@pytest.mark.parametrize("volume", [None, [[1]], b"a", 3])
def test_what_is_no_volume(volume):
    # These functions draw arrays, so arrays are no error for them.
    of_scenes = () if isinstance(volume, np.ndarray) else (ws.render, ws.Scene, ws.Layer)
    for function in (*of_scenes, ws.slice, ws.Camera.orbit, ws.TransferFunction.auto, ws.study.standard):
        with pytest.raises(
            ArgumentError, match=r"volume is .*; give a wavesplat.Volume, as from wavesplat.open\(path\)"
        ):
            function(volume)


@pytest.mark.parametrize(
    ("argument", "value", "message"),
    [
        ("kernel", None, "kernel is None; give a name"),
        ("composite", 3, "composite is 3; give a name or an object of wavesplat: FirstHit"),
        ("quality", ["high"], "quality is a list; give draft, normal, fine, high, or wavesplat.Sampling"),
        ("shading", "phong", "shading is 'phong'; give a wavesplat.Shading or None"),
        ("clip", None, r"clip is None; give wavesplat.Crop\(lower, upper\) to keep a box, ClipPlane"),
        ("progress", True, "progress is True; give a function"),
        ("threads", 10**20, "threads is 100000000000000000000; give a whole number"),
        ("threads", 10**6, "threads is 1000000; give a whole number from 1 to 4096"),
        ("size", (10**30, 5), "give at most 16384 pixels a side"),
    ],
)
def test_messages(argument, value, message):
    with pytest.raises(ArgumentError, match=message):
        ws.render(VOLUME, **{"size": (4, 4)} | {argument: value})


def test_ragged_and_misaligned_arrays():
    with pytest.raises(ArgumentError, match="rows of different lengths"):
        ws.Volume([[[1, 2], [3]]])
    with pytest.raises(ArgumentError, match="world_from_index is no array of numbers"):
        ws.Volume(np.zeros((2, 2, 2)), world_from_index=[[1], [2, 3]])
    misaligned = np.zeros(8 * 27 + 1, np.uint8)[1:].view(np.float64).reshape(3, 3, 3)
    misaligned[:] = np.arange(27).reshape(3, 3, 3)
    assert ws.Volume(misaligned).value_range == (0, 26)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("composite", ["over", "maximum", "minimum", "mean", "sum", "x-ray"])
def test_samples_near_the_limits_of_their_type(dtype, composite):
    limit = np.finfo(dtype).max
    for samples in (np.linspace(-1, 1, 27) * limit, np.linspace(0.5, 1, 27) * limit, np.linspace(0, 1, 27) * 1e-300):
        volume = ws.Volume(samples.astype(dtype).reshape(3, 3, 3))
        with np.errstate(all="ignore"):
            told = said(ws.render, {"what": volume, "size": (4, 4), "composite": composite})
        assert told is None or not told.startswith("not ours: ")


@pytest.mark.parametrize("zoom", [1e-300, 1e-160, 1e-10, 1e10, 1e300, 5e-324])
def test_zooms_that_show_nothing(zoom):
    for draw in (ws.slice, ws.Camera.orbit):
        with pytest.raises(ArgumentError, match=r"zoom is .*; give a number from 1e-09 to 1e\+09"):
            draw(VOLUME, zoom=zoom)


@pytest.mark.parametrize("scale", [1e-300, 1e-160, 1e-30, 1e30, 1e300])
def test_cameras_too_near_and_too_far(scale):
    axes = (0, 1, 0), (0, 0, 0), (0, 0, 1)
    far = (0, scale, 0), (0, 0, 0), (0, 0, 1)
    for camera in (lambda: ws.Camera(*axes, parallel_scale=scale), lambda: ws.Camera(*far, view_angle=30)):
        with pytest.raises(ArgumentError):
            ws.render(VOLUME, "grey", camera(), size=(4, 4))


@pytest.mark.parametrize(
    "place",
    [
        {"spacing": (1e-300, 1, 1)},
        {"spacing": (1e-160, 1e-160, 1e-160)},
        {"spacing": (1e160, 1e160, 1e160)},
        {"spacing": (1, 1, 1e12)},
        {"world_from_index": [[1, 0, 0, 1e300], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]},
    ],
)
def test_places_that_numbers_cannot_hold(place):
    for draw in (ws.render, ws.slice):
        with pytest.raises(ArgumentError):
            draw(ws.Volume(VOLUME.samples, **place), size=(4, 4))


@pytest.mark.parametrize("thickness", [1e-310, 1e-9, 1e9, 1e308])
def test_slabs_of_any_thickness(thickness):
    assert ws.slice(VOLUME, thickness=thickness).value.shape == (6, 6)


def test_a_picture_without_room_for_a_scale_bar():
    for size in ((1, 1), (2, 1), (7, 300)):
        with pytest.raises(ArgumentError, match="no room for a scale bar"):
            ws.slice(VOLUME, size=size).annotated(scale_bar=True)
    ws.slice(VOLUME, size=(60, 60)).annotated(scale_bar=True)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--zoom", "1e-300"], "zoom is 1e-300; give a number from"),
        (["--zoom", "1e-160"], "zoom is 1e-160; give a number from"),
        (["--size", "99999999999999999999x5"], "give at most 16384 pixels a side"),
        (["--size", f"{'9' * 5000}x5"], "WIDTHxHEIGHT"),
        (["--threads", "99999999999999999999"], "threads is 99999999999999999999; give a whole number"),
        (["--crop", "1e999,0,0,1,1,1"], "crop"),
        (["--wavelet-level", "99999999999999999999"], "--wavelet-level is 99999999999999999999"),
        (["--time", "99999999999999999999"], "time"),
    ],
)
def test_overflowing_numbers_on_the_command_line(wavesplat, ramp_file, tmp_path, options, message):
    done = wavesplat("render", ramp_file, "-o", tmp_path / "a.png", *options)
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith("wavesplat: error: ")
    assert done.stderr.count("\n") == 1
    assert message in done.stderr
    assert not (tmp_path / "a.png").exists()
