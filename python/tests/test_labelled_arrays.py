"""Arrays of xarray: names and coordinates of their axes are honoured."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError

xarray = pytest.importorskip("xarray")
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
