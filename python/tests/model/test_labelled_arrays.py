"""Arrays of xarray: names and coordinates of their axes are honoured."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError

xarray = pytest.importorskip("xarray")

# VTK, PyVista and xarray take seconds to load: one process does.
pytestmark = pytest.mark.xdist_group("vtk")
SAMPLES = np.random.default_rng(2).integers(0, 99, (4, 5, 6)).astype(np.uint8)
COORDINATES = {
    "z": ("z", 30 + 1.5 * np.arange(4), {"units": "um"}),
    "y": ("y", 20 - 0.8 * np.arange(5), {"units": "um"}),
    "x": ("x", 10 + 0.7 * np.arange(6), {"units": "um"}),
}
PLACE = np.array([[0.7, 0, 0, 10], [0, -0.8, 0, 20], [0, 0, 1.5, 30], [0, 0, 0, 1]])


def labelled(dims="zyx", coordinates=COORDINATES, **more):
    return xarray.DataArray(SAMPLES, dims=list("zyx"), coords=coordinates, **more).transpose(*dims)


@pytest.mark.parametrize("dims", ["zyx", "xyz", "yzx"])
def test_order_and_place_are_those_of_the_names(dims):
    volume = ws.Volume(labelled(dims, name="density"))
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    np.testing.assert_allclose(volume.world_from_index, PLACE)
    assert (volume.unit, volume.name, volume.is_anatomical, volume.guesses) == ("um", "density", False, ())


def test_what_is_given_goes_before_coordinates():
    volume = ws.Volume(labelled("xyz"), spacing=(1, 2, 3), unit="mm", name="mine")
    np.testing.assert_array_equal(volume.samples, SAMPLES)
    assert (volume.spacing, volume.unit, volume.name) == ((1, 2, 3), "mm", "mine")
    np.testing.assert_allclose(ws.Volume(labelled("xyz"), world_from_index=np.eye(4)).world_from_index, np.eye(4))


def test_units_become_one():
    mixed = COORDINATES | {"z": ("z", 300.0 * np.arange(4), {"units": "nm"})}
    volume = ws.Volume(labelled(coordinates=mixed))
    assert (volume.unit, volume.spacing) == ("um", pytest.approx((0.7, 0.8, 0.3)))


def test_a_dataset_of_one_array_is_that_array():
    volume = ws.Volume(labelled().to_dataset(name="density"))
    assert (volume.name, volume.unit) == ("density", "um")
    np.testing.assert_allclose(volume.world_from_index, PLACE)


def test_other_names_and_single_places():
    array = labelled(coordinates={}).expand_dims(time=1).rename(x="lon", y="lat", z="level")
    np.testing.assert_array_equal(ws.Volume(array.transpose("lon", "time", "level", "lat")).samples, SAMPLES)
    unnamed = xarray.DataArray(SAMPLES)  # dim_0, dim_1, dim_2
    np.testing.assert_array_equal(ws.Volume(unnamed).samples, SAMPLES)
    half = {name: COORDINATES[name] for name in "yx"}
    assert ws.Volume(labelled(coordinates=half)).guesses == ("distance along z 1: the array has no coordinates there",)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: xarray.concat([labelled()] * 2, "time"),
            r"choose one place along 'time', as with array.isel\(time=0\)",
        ),
        (lambda: labelled(coordinates={"z": [0, 1, 2, 9]}), "along 'z' are not evenly spaced.*array.interp"),
        (lambda: labelled(coordinates={"z": [0, 0, 0, 0]}), "along 'z' are not evenly spaced"),
        (lambda: labelled(coordinates={"z": [0, 1, np.nan, 3]}), "along 'z' are not evenly spaced"),
        (lambda: xarray.Dataset({"a": labelled(), "b": labelled()}), r"a Dataset of several arrays \(a, b\)"),
        (lambda: labelled()[0], "2-D|called z, y and x"),
    ],
)
def test_what_is_no_volume_is_refused(make, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Volume(make())


# Channels and times


def cells(n_channels=2, n_times=1, dims="TCZYX", names=("DAPI", "GFP"), **coordinates):
    """An array as bioio gives it: capital names, channels by name, distances as coordinates."""
    rng = np.random.default_rng(5)
    samples = rng.gamma(1.0, 60.0, (n_times, n_channels, 6, 16, 18)).astype(np.uint16)
    samples[:, :, 2:4, 4:9, 5:11] += 900
    places = {
        "C": list(names[:n_channels]),
        "Z": 0.5 * np.arange(6),
        "Y": 0.2 * np.arange(16),
        "X": 0.2 * np.arange(18),
    }
    return xarray.DataArray(samples, dims=list("TCZYX"), coords=places | coordinates).transpose(*dims)


@pytest.mark.parametrize("dims", ["TCZYX", "TZYXC"])
@pytest.mark.parametrize("is_lazy", [False, True])
def test_channels_are_a_scene(dims, is_lazy):
    array = cells(dims=dims)
    scene = ws.Scene(array.chunk(Z=3) if is_lazy else array)
    assert [layer.name for layer in scene.layers] == ["DAPI", "GFP"]
    np.testing.assert_array_equal(scene.layers[1].drawn.samples, array.isel(T=0, C=1).transpose(*"ZYX").values)
    assert scene.layers[0].drawn.spacing == pytest.approx((0.2, 0.2, 0.5))
    assert scene.layers[1].drawn.facts.channel == ws.Channel("GFP")
    rgba = ws.render(array, size=(32, 32)).rgba
    assert rgba[..., 1].max() > 0.2  # green
    assert rgba[..., 0].max() > 0.2  # and magenta
    assert ws.slice(array).report["layers"][1]["name"] == "GFP"


def test_looks_may_be_given_to_channels():
    scene = ws.Scene(cells(), ["grey", "mr-head"])
    assert [layer.look for layer in scene.layers] == ["grey", "mr-head"]


def test_channels_without_names_are_numbered():
    array = cells().drop_vars("C").rename(C="channel")
    assert [layer.name for layer in ws.Scene(array).layers] == ["channel 0", "channel 1"]
    assert [layer.name for layer in ws.Scene(cells(C=("C", [405, 488]))).layers] == ["channel 0", "channel 1"]


def test_times_are_a_series():
    array = cells(n_times=3, T=("T", [0.0, 30.0, 60.0], {"units": "s"}))
    scene = ws.Scene(array)
    series = scene.layers[0].volume
    assert (len(series), series.times, series.time_unit) == (3, (0, 30, 60), "s")
    np.testing.assert_array_equal(scene.at_time(2).layers[1].drawn.samples, array[2, 1].values)
    assert len(ws.Scene(array.isel(C=0)).layers[0].volume) == 3
    assert ws.Scene(cells(n_times=2)).layers[0].volume.times == (0, 1)


def test_times_of_planes_are_slices():
    planes = labelled(coordinates={}).rename(z="time")
    assert ws.Scene(planes).layers[0].drawn.shape == (4, 5, 6)


def test_one_of_several_channels_is_a_volume():
    assert ws.Volume(cells().sel(C="GFP")).facts.channel == ws.Channel("GFP")
    assert len(ws.Scene(cells(1)).layers) == 1
    with pytest.raises(ArgumentError, match=r"along 'C', as .*, or take all of them: wavesplat.Scene\(array\)"):
        ws.Volume(cells())


def test_more_channels_than_colours_are_refused():
    array = cells(9, names=[f"c{n}" for n in range(9)])
    with pytest.raises(ArgumentError, match=r"9 channels along 'C', a scene at most 8; choose some"):
        ws.Scene(array)
    assert len(ws.Scene(array.isel(C=range(8))).layers) == 8


def test_times_as_dates_are_seconds_from_the_first():
    xarray = pytest.importorskip("xarray")
    samples = np.random.default_rng(0).random((3, 4, 5, 6)).astype(np.float32)
    dates = np.array(["2026-01-01T00:00", "2026-01-01T00:01", "2026-01-01T00:05"], "datetime64[ns]")
    for times, wanted in ((dates, (0, 60, 300)), (dates - dates[0], (0, 60, 300))):
        array = xarray.DataArray(samples, dims=("T", "Z", "Y", "X"), coords={"T": times})
        series = ws.Scene(array).layers[0].volume
        assert (series.times, series.time_unit) == (wanted, "s")
    array = xarray.DataArray(samples, dims=("T", "Z", "Y", "X"), coords={"T": [0.0, 1, 3]})
    array.coords["T"].attrs["units"] = "days since 2001-01-01"
    assert ws.Scene(array).layers[0].volume.time_unit == "days"
