"""Data of models: north and the sky are up by what is said of their axes, as a file and as an array alike."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._render.framing import is_upright, natural_view
from wavesplat.errors import ArgumentError, FileError

xarray = pytest.importorskip("xarray")

# VTK, PyVista and xarray take seconds to load: one process does.
pytestmark = pytest.mark.xdist_group("vtk")

SHAPE = (5, 6, 8)
#: White noise of two signs, of one sign, and a ball without noise: what a look takes for different kinds of data.
NOISE = np.random.default_rng(1).normal(size=SHAPE).astype(np.float32)
VALUES = [NOISE, np.abs(NOISE), np.exp(-np.sum((np.indices(SHAPE).T - 2.5) ** 2, axis=-1).T / 4).astype(np.float32)]

NORTH, EAST = {"units": "degrees_north"}, {"units": "degrees_east"}
LAT, LON = 60 - 2.5 * np.arange(6), 10 + 2.5 * np.arange(8)
METRES = {"units": "m"}


def maps(z, places, **said):
    """A data set with an axis z over falling latitudes and longitudes."""
    return (z, "lat", "lon"), {z: (z, places, said), "lat": ("lat", LAT, NORTH), "lon": ("lon", LON, EAST)}


def plane(z, places=None, **said):
    """A data set with an axis z over x and y, in metres."""
    coordinates = {"y": ("y", 1000.0 * np.arange(6), METRES), "x": ("x", 1000.0 * np.arange(8), METRES)}
    return (z, "y", "x"), coordinates if places is None else coordinates | {z: (z, places, said)}


STEPS = np.arange(5)
CURVED = {"lat_rho": (("eta_rho", "xi_rho"), np.add.outer(LAT, 0.1 * np.arange(8)), NORTH)}
#: Kind of data set -> names of axes and coordinates, and the world's z at the first and the last of 5 samples.
KINDS = {
    "pressures": (*maps("level", 1000.0 - 100 * STEPS, units="hPa"), (-1000, -600)),
    "pressures of cfgrib": (*maps("isobaricInhPa", 1000.0 - 100 * STEPS, units="hPa", positive="down"), (-1000, -600)),
    "pressures by name": (*maps("plev", 60000.0 + 1e4 * STEPS), (-60000, -100000)),
    "heights": (*maps("height", 10.0 + 20 * STEPS, units="m", positive="up"), (10, 90)),
    "depths": (*maps("depth", 5.0 + 10 * STEPS, standard_name="depth", units="m"), (-5, -45)),
    "depths by name": (*maps("depth", 5.0 + 10 * STEPS), (-5, -45)),
    "depths below zero": (*maps("depth", -5.0 - 10 * STEPS, units="m"), (-5, -45)),
    "an axis that is told": (*plane("k", 2.0 * STEPS, axis="Z", positive="down"), (0, -8)),
    "altitudes over a plane": (*plane("altitude", 50.0 * STEPS, units="m"), (0, 200)),
    "levels without numbers": (*plane("level"), (0, 4)),
    "WRF": (("bottom_top", "south_north", "west_east"), {}, (0, 4)),
    "WRF between grid points": (("bottom_top_stag", "south_north", "west_east_stag"), {}, (0, 4)),
    "ROMS": (
        ("s_rho", "eta_rho", "xi_rho"),
        {
            "s_rho": ("s_rho", -0.9 + 0.2 * STEPS, {"positive": "up", "standard_name": "ocean_s_coordinate_g2"}),
            **CURVED,
        },
        (0, 4),
    ),
    "model levels": (*maps("hybrid", 1.0 + STEPS, units="1", positive="down"), (-1, -5)),
}


def labelled(kind, values=NOISE):
    dims, coordinates, _ = KINDS[kind]
    return xarray.DataArray(values, dims=dims, coords=coordinates, name="t")


@pytest.mark.parametrize("kind", KINDS)
def test_files_and_arrays_have_one_place(tmp_path, kind):
    heights = KINDS[kind][2]
    views = []
    for n, values in enumerate(VALUES):
        array = labelled(kind, values)
        path = tmp_path / f"{n}.nc"
        array.to_netcdf(path, engine="h5netcdf" if n else "scipy")
        with xarray.open_dataset(path, engine="h5netcdf" if n else "scipy") as opened:
            volumes = [ws.open(path), ws.Volume(array), ws.Volume(opened["t"]), ws.Volume.lazy(array)]
            lazy = volumes.pop()
        first = volumes[0]
        for other in (*volumes[1:], lazy):
            np.testing.assert_array_equal(other.world_from_index, first.world_from_index)
            assert (other.guesses, other.unit, other.facts.conventions) == (
                first.guesses,
                first.unit,
                first.facts.conventions,
            )
        ends = first.world_from_index @ np.array([[0, 0, 0, 1], [0, 0, 4, 1]]).T
        np.testing.assert_allclose(ends[2], heights)
        # North is where y grows, and rows of the file that go south go down.
        assert np.sign(first.world_from_index[1, 1]) == (-1 if "lat" in array.dims else 1)
        views += [natural_view(one) for one in volumes[:2]]
    assert len(set(views)) == 1


@pytest.mark.filterwarnings("ignore:Consolidated metadata")
@pytest.mark.parametrize("version", [2, 3])
def test_zarr_of_xarray_has_the_same_place(tmp_path, version):
    times = ("time", [0.0, 6, 18], {"units": "hours since 2001-01-01"})
    dims, coordinates, _ = KINDS["pressures"]
    array = xarray.DataArray(
        np.stack([NOISE, 2 * NOISE, 3 * NOISE]), dims=("time", *dims), coords=coordinates | {"time": times}, name="t"
    ).transpose("time", "lon", "level", "lat")
    array.to_dataset().to_zarr(tmp_path / "a.zarr", zarr_format=version)
    with pytest.raises(FileError, match="3 time points"):
        ws.open(tmp_path / "a.zarr", dataset="t")
    volume = ws.open(tmp_path / "a.zarr", dataset="t", time=1)
    lazy = ws.open(tmp_path / "a.zarr", dataset="t", time=1, memory="1 MB")
    wanted = ws.Volume(array.isel(time=1))
    for one in (volume, lazy):
        np.testing.assert_array_equal(one.world_from_index, wanted.world_from_index)
        assert (one.guesses, one.facts.conventions) == (wanted.guesses, wanted.facts.conventions)
        assert (one.facts.times, one.facts.time_unit) == ((0, 6, 18), "hours")
    np.testing.assert_array_equal(volume.samples, 2 * NOISE)
    np.testing.assert_array_equal(lazy.read().samples, 2 * NOISE)
    uneven = array.assign_coords(level=("level", [1000.0, 925, 850, 700, 500], {"units": "hPa"}))
    uneven.to_dataset().to_zarr(tmp_path / "b.zarr", zarr_format=version)
    with pytest.raises(FileError, match=r"'level' are not evenly spaced.*spacing="):
        ws.open(tmp_path / "b.zarr", dataset="t", time=0)
    turned = ws.open(tmp_path / "b.zarr", dataset="t", time=0, spacing=(1, 2, 3))
    np.testing.assert_array_equal(np.diag(turned.world_from_index), [1, -2, 3, 1])


def test_units_of_maps_are_told_once():
    assert ws.Volume(labelled("pressures")).guesses == (
        "distances along x, y in degrees: 1 is drawn as 1 unit of length",
        "distances along z in hPa: 1 is drawn as 1 unit of length",
        "z is minus level, which grows downwards",
    )


def test_maps_come_back_from_xarray():
    volume = ws.Volume(labelled("depths"))
    again = ws.Volume(volume.to_xarray())
    np.testing.assert_array_equal(again.world_from_index, volume.world_from_index)
    assert again.facts.conventions == volume.facts.conventions != ()


def test_a_map_in_the_order_of_its_file_is_turned():
    array = labelled("pressures").transpose("lon", "level", "lat")
    np.testing.assert_array_equal(ws.Volume(array).samples, NOISE)


@pytest.mark.parametrize("values", VALUES)
def test_maps_are_seen_from_above_with_north_on_top(values):
    flat = values[:2]
    array = xarray.DataArray(flat, dims=("bottom_top", "south_north", "west_east"), name="pvo")
    camera = ws.render(ws.Volume(array), size=(8, 8)).camera
    assert tuple(camera.view_up) == (0, 1, 0)
    assert camera.position[2] > 1


def test_given_distances_keep_the_directions(tmp_path):
    """Levels are uneven as a rule, and the message names spacing=: north and the sky stay where they are."""
    dims, coordinates, _ = KINDS["pressures"]
    uneven = coordinates | {"level": ("level", np.array([1000.0, 925, 850, 700, 500]), {"units": "hPa"})}
    array = xarray.DataArray(NOISE, dims=dims, coords=uneven, name="t")
    array.to_netcdf(tmp_path / "a.nc", engine="scipy")
    with pytest.raises(ArgumentError, match="spacing="):
        ws.Volume(array)
    volumes = [
        ws.open(tmp_path / "a.nc", spacing=(1, 2, 3)),
        ws.Volume(array, spacing=(1, 2, 3)),
        ws.Volume.lazy(array, spacing=(1, 2, 3)),
    ]
    for volume in volumes:
        np.testing.assert_array_equal(volume.world_from_index, np.diag([1, -2, 3, 1]))
        assert volume.guesses == ("z is minus level, which grows downwards",)


def test_a_file_of_a_model_is_upright_without_a_word_on_its_axes(tmp_path):
    for n, values in enumerate(VALUES):
        path = tmp_path / f"{n}.nc"
        xarray.DataArray(values, dims=list("zyx"), name="t").to_netcdf(path, engine="scipy")
        with xarray.open_dataset(path, engine="scipy") as opened:
            volumes = ws.open(path), ws.Volume(opened["t"])
        for volume in volumes:
            np.testing.assert_array_equal(volume.world_from_index, np.eye(4))
            assert is_upright(volume)
            assert volume.guesses == ("distance of samples 1, 1, 1: the array has no coordinates along z, y, x",)


def test_images_have_row_0_on_top():
    """Nothing is said of these axes but names, and distances that no map has."""
    for dims, unit in (
        ("zyx", "um"),
        ("ZYX", None),
        (("depth", "height", "width"), None),
        (("plane", "row", "col"), "mm"),
    ):
        places = {
            dim: (dim, np.arange(n) * 0.5, {"units": unit} if unit else {}) for dim, n in zip(dims, SHAPE, strict=True)
        }
        volume = ws.Volume(xarray.DataArray(NOISE, dims=list(dims), coords=places))
        np.testing.assert_array_equal(volume.world_from_index, np.diag([0.5, 0.5, 0.5, 1]))
        np.testing.assert_array_equal(volume.samples, NOISE)
        assert volume.facts.conventions == ()


def test_a_patient_in_netcdf_stays_one(tmp_path):
    head = ws.Volume(NOISE, anatomical=True, unit="mm")
    head.to_xarray().to_netcdf(tmp_path / "a.nc", engine="scipy")
    again = ws.open(tmp_path / "a.nc")
    assert (again.is_anatomical, again.facts.conventions) == (True, ())


def test_distances_of_wrf_are_those_of_its_attributes(tmp_path):
    array = labelled("WRF")
    dataset = array.to_dataset().assign_attrs(DX=np.float32(9000), DY=np.float32(10000))
    dataset.to_netcdf(tmp_path / "a.nc", engine="scipy")
    for volume in (ws.open(tmp_path / "a.nc"), ws.Volume(dataset)):
        np.testing.assert_array_equal(volume.world_from_index, np.diag([9000, 10000, 9000, 1]))
        told = "distance along bottom_top 9000 m, as along west_east: heights of its levels are not used"
        assert (volume.unit, volume.guesses) == ("m", (told,))


def test_axes_are_even_within_the_rounding_of_their_numbers(tmp_path):
    """Steps of 0.0009 near 359.58 in single precision are 29 or 30 units in the last place."""
    lon = (359.58 + 0.0009 * np.arange(8)).astype(np.float32)
    assert np.ptp(np.diff(lon)) > 0.03 * 0.0009
    dims, coordinates, _ = KINDS["heights"]
    for places in (lon, lon.astype(np.float64)):
        array = xarray.DataArray(NOISE, dims=dims, coords=coordinates | {"lon": ("lon", places, EAST)}, name="t")
        array.to_netcdf(tmp_path / "a.nc", engine="scipy")
        for volume in (ws.open(tmp_path / "a.nc"), ws.Volume(array)):
            assert volume.spacing[0] == pytest.approx(0.0009, rel=0.01)
    shares = {"s_rho": ("s_rho", np.array([-0.9, -0.5, -0.3, -0.1, 0.0]))}  # uneven, and no lengths
    roms = xarray.DataArray(NOISE, dims=KINDS["ROMS"][0], coords=shares)
    np.testing.assert_array_equal(ws.Volume(roms).world_from_index, np.eye(4))
    for places in ((359.58 + 0.0009 * np.arange(8)) + 1e-5 * (np.arange(8) == 3), [0, 1, 2, 3, 4, 5, 6, 7.1]):
        array = xarray.DataArray(NOISE, dims=dims, coords=coordinates | {"lon": ("lon", places, EAST)}, name="t")
        with pytest.raises(ArgumentError, match="not evenly spaced"):
            ws.Volume(array)
