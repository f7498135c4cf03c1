"""netCDF-3 and netCDF-4 are read as what they are: unpacked, without missing values, placed by coordinates (F2)."""

import json
import warnings

import h5py
import numpy as np
import pytest
import scipy.io

import wavesplat as ws
from wavesplat import _cli
from wavesplat.errors import ArgumentError, FileError

# VTK, PyVista and xarray take seconds to load: one process does.
pytestmark = pytest.mark.xdist_group("vtk")

#: Sizes of time, lev, lat, lon, and the packing of the values.
SHAPE = (3, 4, 5, 6)
SCALE, OFFSET, FILL = 0.01, 250.0, -32767
TIMES = [0.0, 6.0, 18.0]
LEV, LAT, LON = np.arange(4) * 500.0, np.linspace(90, -90, 5), np.arange(6) * 60.0
ATTRIBUTES = {
    "time": {"units": "hours since 2001-01-01"},
    "lev": {"units": "m", "positive": "up"},
    "lat": {"units": "degrees_north"},
    "lon": {"units": "degrees_east"},
}


@pytest.fixture
def packed():
    values = np.random.default_rng(3).integers(0, 5000, SHAPE).astype(np.int16)
    values[0, 1, 2, :4] = FILL
    return values


def unpacked(packed):
    return np.where(packed == FILL, np.nan, packed * SCALE + OFFSET)


def save_netcdf3(path, variables, coordinates, attributes=ATTRIBUTES, **said):
    """A netCDF-3 file of SciPy: name -> (names of axes, samples), and the coordinates of the axes."""
    with scipy.io.netcdf_file(path, "w") as file:
        for axis, places in coordinates.items():
            file.createDimension(axis, len(places))
            made = file.createVariable(axis, "d", (axis,))
            made[:] = places
            vars(made)["_attributes"].update(attributes.get(axis, {}))
        for name, (axes, samples) in variables.items():
            made = file.createVariable(name, samples.dtype.newbyteorder(">"), axes)
            made[:] = samples
            vars(made)["_attributes"].update(said)
    return path


def save_netcdf4(path, variables, coordinates, attributes=ATTRIBUTES, marked=True, **said):
    """A netCDF-4 file as its library lays it out, written by h5py: dimensions with scales."""
    with h5py.File(path, "w") as file:
        if marked:
            file.attrs["_NCProperties"] = "version=2"
        for axis, places in coordinates.items():
            file[axis] = np.asarray(places, float)
            file[axis].make_scale(axis)
            file[axis].attrs.update(attributes.get(axis, {}))
        for name, (axes, samples) in variables.items():
            file[name] = samples
            file[name].attrs.update(said)
            for number, axis in enumerate(axes):
                file[name].dims[number].attach_scale(file[axis])
    return path


SAVERS = {"a.nc": save_netcdf3, "b.nc": save_netcdf4, "c.h5": save_netcdf4, "no_suffix": save_netcdf3}
PACKING = {"scale_factor": SCALE, "add_offset": OFFSET, "_FillValue": np.int16(FILL), "units": "K"}
ALL = dict(zip(("time", "lev", "lat", "lon"), (TIMES, LEV, LAT, LON), strict=True))


@pytest.fixture(params=SAVERS)
def saved(request, tmp_path, packed):
    return SAVERS[request.param](tmp_path / request.param, {"t": (tuple(ALL), packed)}, ALL, **PACKING)


def test_packing_missing_values_and_place_f2(saved, packed):
    for time in range(3):
        volume = ws.open(saved, time=time)
        np.testing.assert_allclose(volume.samples, unpacked(packed)[time], rtol=1e-6)
    np.testing.assert_allclose(volume.world_from_index, [[60, 0, 0, 0], [0, -45, 0, 90], [0, 0, 500, 0], [0, 0, 0, 1]])
    # Degrees are no metres, so there is no unit of length, and no scale bar of one.
    assert (volume.value_unit, volume.unit) == ("K", None)
    assert any("in degrees: 1 is drawn as 1 m of the others" in guess for guess in volume.guesses)


def test_times(saved):
    series = ws.open_series(saved)
    assert (len(series), series[1].shape) == (3, SHAPE[1:])
    assert (series.times, series.time_unit) == (tuple(TIMES), "hours")


def test_read_in_parts(saved, packed):
    lazy = ws.open(saved, time=0, memory="1 MB")
    whole = ws.open(saved, time=0)
    assert lazy.facts.times == whole.facts.times
    options = {"look": ws.Look.auto(whole), "camera": ws.Camera.view(whole, "front"), "size": (40, 40)}
    np.testing.assert_array_equal(ws.render(lazy, **options).rgba, ws.render(whole, **options).rgba)


def test_dimension_scales_alone_mark_netcdf4(tmp_path, packed):
    path = save_netcdf4(tmp_path / "a.h5", {"t": (("lev", "lat", "lon"), packed[0])}, ALL, marked=False, **PACKING)
    np.testing.assert_allclose(ws.open(path).samples, unpacked(packed)[0], rtol=1e-6)


def test_several_variables(tmp_path, packed, capsys):
    axes = ("lev", "lat", "lon")
    path = save_netcdf3(tmp_path / "a.nc", {"u": (axes, packed[1]), "v": (axes, packed[2])}, ALL)
    with pytest.raises(FileError, match=r"2 variables .* choose one with dataset= .*u \(lev 4, lat 5, lon 6\); v"):
        ws.open(path)
    np.testing.assert_array_equal(ws.open(path, dataset="v").samples, packed[2])
    with pytest.raises(ArgumentError, match="no variable 'w'"):
        ws.open(path, dataset="w")
    with pytest.raises(SystemExit):
        _cli.main(["info", str(path), "--json"])
    assert json.loads(capsys.readouterr().out)["choices"][0]["names"] == ["u", "v"]


def test_axes_by_their_metadata_in_any_order(tmp_path, packed):
    samples = packed[1].transpose(1, 2, 0)
    path = save_netcdf3(tmp_path / "a.nc", {"t": (("lat", "lon", "lev"), samples)}, ALL)
    np.testing.assert_array_equal(ws.open(path).samples, packed[1])
    lazy = ws.open(path, memory="1 MB")
    assert lazy.shape == SHAPE[1:]
    assert lazy.value_range == (packed[1].min(), packed[1].max())


def test_a_further_axis_is_a_channel(tmp_path, packed):
    axes = ("member", "lev", "lat", "lon")
    path = save_netcdf3(tmp_path / "a.nc", {"t": (axes, packed)}, {**ALL, "member": [10, 20, 30]})
    with pytest.raises(FileError, match="3 channels"):
        ws.open(path)
    np.testing.assert_array_equal(ws.open(path, channel=2).samples, packed[2])
    with pytest.raises(ArgumentError, match="time= has no meaning"):
        ws.open(path, channel=2, time=0)


def test_time_in_the_place_of_an_axis_of_space_is_said(tmp_path, packed):
    path = save_netcdf3(tmp_path / "a.nc", {"t": (("time", "lat", "lon"), packed[:, 0])}, {**ALL, "time": [0, 6, 12]})
    assert any("'time' is drawn as one of space" in guess for guess in ws.open(path).guesses)


@pytest.mark.parametrize("save", [save_netcdf3, save_netcdf4])
def test_uneven_levels_are_refused_or_resampled(tmp_path, packed, save):
    uneven = np.array([0.0, 10.0, 100.0, 300.0])
    path = save(tmp_path / "a.nc", {"t": (("lev", "lat", "lon"), packed[1])}, {**ALL, "lev": uneven})
    with pytest.raises(FileError, match=r"'lev' are not evenly spaced .* resample=N .* spacing="):
        ws.open(path)
    assert ws.open(path, spacing=(1, 1, 2)).spacing == (1, 1, 2)
    volume = ws.open(path, resample=31)
    expected = np.stack(
        [[np.interp(np.arange(31) * 10, uneven, packed[1, :, y, x]) for x in range(6)] for y in range(5)]
    )
    np.testing.assert_allclose(volume.samples, expected.transpose(2, 0, 1), rtol=1e-6)
    assert volume.spacing[2] == 10
    assert any("interpolated to 31 even places from 4" in guess for guess in volume.guesses)
    with pytest.raises(ArgumentError, match="leave out memory="):
        ws.open(path, resample=31, memory="1 MB")


def test_samples_without_coordinates_say_so(tmp_path, packed):
    path = tmp_path / "a.nc"
    with h5py.File(path, "w") as file:
        file.attrs["_NCProperties"] = "version=2"
        file["t"] = packed[1]
    volume = ws.open(path)
    np.testing.assert_array_equal(volume.samples, packed[1])
    assert any("no coordinates" in guess for guess in volume.guesses)


def test_groups_have_the_coordinates_around_them(tmp_path, packed):
    path = save_netcdf4(tmp_path / "a.nc", {}, ALL)
    with h5py.File(path, "r+") as file:
        made = file.create_group("run").create_dataset("t", data=packed[1])
        for number, axis in enumerate(("lev", "lat", "lon")):
            made.dims[number].attach_scale(file[axis])
    assert ws.open(path).spacing == (60, 45, 500)
    np.testing.assert_array_equal(ws.open(path, dataset="run/t").samples, packed[1])
    assert ws.open(path, memory="1 MB").spacing == (60, 45, 500)


def test_a_file_does_not_name_others(tmp_path, packed):
    path = save_netcdf4(tmp_path / "a.nc", {}, ALL)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["secret"] = packed[1]
    with h5py.File(path, "r+") as file:
        file["t"] = h5py.ExternalLink("other.h5", "secret")
    with pytest.raises(FileError, match="external_files=True"):
        ws.open(path)


def test_what_is_missing_is_said(tmp_path, packed, monkeypatch):
    import sys

    paths = [save(tmp_path / f"{n}.nc", {"t": (tuple(ALL), packed)}, ALL) for n, save in enumerate(SAVERS.values())]
    for module, path in (("scipy", paths[0]), ("h5netcdf", paths[1])):
        with monkeypatch.context() as without:
            without.setitem(sys.modules, module, None)
            with pytest.raises(ws.errors.LibraryError, match=r"netcdf\]"):
                ws.open(path)
    (tmp_path / "five.nc").write_bytes(b"CDF\5rest")
    with pytest.raises(FileError, match="nccopy"):
        ws.open(tmp_path / "five.nc")


def test_damage_is_said(tmp_path, packed):
    for save in (save_netcdf3, save_netcdf4):
        path = save(tmp_path / "a.nc", {"t": (tuple(ALL), packed)}, ALL)
        content = path.read_bytes()
        for n in (40, 200, len(content) // 2):
            path.write_bytes(content[:n])
            with pytest.raises(FileError):
                ws.open(path, time=2)


def test_depth_grows_downwards_in_pictures_too(tmp_path, packed):
    attributes = {**ATTRIBUTES, "lev": {"units": "m", "positive": "down"}}
    coordinates = {"lev": LEV, "lat": LAT, "lon": LON}
    path = save_netcdf3(tmp_path / "sea.nc", {"t": (("lev", "lat", "lon"), packed[0])}, coordinates, attributes)
    volume = ws.open(path)
    surface = volume.world_from_index @ (0, 0, list(LEV).index(0.0), 1)
    deepest = volume.world_from_index @ (0, 0, len(LEV) - 1, 1)
    assert (surface[2], deepest[2]) == (0, -1500)
    assert any("z is minus lev" in guess for guess in volume.guesses)


def test_pressures_grow_downwards_where_nothing_else_is_said(tmp_path, packed):
    coordinates = {"plev": np.array([1000.0, 800, 600, 400]), "lat": LAT, "lon": LON}
    for said, first, last in (({"units": "hPa"}, -1000, -400), ({"units": "hPa", "positive": "up"}, 1000, 400)):
        attributes = {**ATTRIBUTES, "plev": said}
        path = save_netcdf3(tmp_path / "a.nc", {"t": (("plev", "lat", "lon"), packed[0])}, coordinates, attributes)
        places = ws.open(path).world_from_index @ np.array([[0, 0, 0, 1], [0, 0, 3, 1]]).T
        np.testing.assert_allclose(places[2], [first, last])


@pytest.mark.parametrize("dtype", ["f4", "f8"])
@pytest.mark.parametrize("how", [{}, {"memory": "1 MB"}])
def test_what_was_never_written_is_missing(tmp_path, dtype, how):
    netcdf4 = pytest.importorskip("netCDF4")
    with netcdf4.Dataset(tmp_path / "a.nc", "w") as file:
        for axis, n in zip("zyx", SHAPE[1:], strict=True):
            file.createDimension(axis, n)
        file.createVariable("t", dtype, ("z", "y", "x"))[1:] = 3.5
    with netcdf4.Dataset(tmp_path / "a.nc") as file:
        expected = file["t"][:].filled(np.nan)
    volume = ws.open(tmp_path / "a.nc", **how)
    samples = volume.read().samples if how else volume.samples
    assert np.isnan(expected).mean() == 0.25
    np.testing.assert_array_equal(samples, expected)


def test_borders_of_cells_are_no_fields(tmp_path, packed):
    attributes = {**ATTRIBUTES, "lev": {"units": "m", "bounds": "lev_bnds"}}
    borders = np.zeros((4, 2, 2), np.float32)
    path = save_netcdf4(
        tmp_path / "a.nc",
        {"t": (("lev", "lat", "lon"), packed[1]), "lev_bnds": (("lev", "pair", "two"), borders)},
        {"lev": LEV, "lat": LAT, "lon": LON, "pair": [0, 1], "two": [0, 1]},
        attributes,
    )
    np.testing.assert_array_equal(ws.open(path).samples, packed[1])
    assert ws.open(path, dataset="lev_bnds").shape == (4, 2, 2)


def test_files_without_a_volume_say_what_they_hold(tmp_path, packed):
    flat = save_netcdf3(tmp_path / "a.nc", {"ps": (("lat", "lon"), packed[0, 0])}, {"lat": LAT, "lon": LON}, units="Pa")
    with pytest.raises(FileError, match=r"no variable with three axes .*ps \(lat 5, lon 6\), Pa; such.*\.plot\(\)"):
        ws.open(flat)
    # One layer of uneven latitudes is a plane, whatever its steps.
    coordinates = {"lev": [0.0], "lat": [-80.0, -30, 0, 31, 80], "lon": LON}
    layer = save_netcdf3(tmp_path / "b.nc", {"t": (("lev", "lat", "lon"), packed[0, :1])}, coordinates)
    with pytest.raises(FileError, match=r"a single plane of x 6, y 5, z 1 .*`wavesplat slice` shows it"):
        ws.open(layer)
    twice = save_netcdf4(tmp_path / "c.nc", {"s": (("n", "n", "lon"), packed[0, :, :4])}, {"n": LEV, "lon": LON})
    with pytest.raises(FileError, match="an axis twice"):
        ws.open(twice)
    mesh = {"api_version": np.float32(5), "floating_point_word_size": np.int32(8)}
    with scipy.io.netcdf_file(tmp_path / "d.nc", "w") as file:
        vars(file)["_attributes"].update(mesh)
        file.createDimension("num_nodes", 3)
        file.createVariable("coordx", "d", ("num_nodes",))[:] = 0
    with pytest.raises(FileError, match=r"finite elements \(Exodus\); save pyvista"):
        ws.open(tmp_path / "d.nc")


def test_times_are_told_as_dates(tmp_path, packed):
    saved = save_netcdf3(tmp_path / "a.nc", {"t": (tuple(ALL), packed)}, ALL)
    with pytest.raises(FileError, match=r"0 2001-01-01T00:00, 1 2001-01-01T06:00, 2 2001-01-01T18:00"):
        ws.open(saved)
    of_model = {**ATTRIBUTES, "time": {"units": "days since 2001-01-01", "calendar": "360_day"}}
    hours = 347921 + np.arange(3) / 10
    saved = save_netcdf3(tmp_path / "a.nc", {"t": (tuple(ALL), packed)}, {**ALL, "time": hours}, of_model)
    with pytest.raises(FileError, match=r"0 347921 days since 2001-01-01, 1 347921\.1 days"):
        ws.open(saved)


def test_dates_before_the_reform_of_the_calendar_are_told_quietly(tmp_path, packed):
    of_old = {**ATTRIBUTES, "time": {"units": "days since 0049-09-01 00:00:00"}}
    saved = save_netcdf3(tmp_path / "a.nc", {"t": (tuple(ALL), packed)}, {**ALL, "time": np.arange(3.0)}, of_old)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        with pytest.raises(FileError, match=r"0 0 days since 0049-09-01 00:00:00, 1 1 days"):
            ws.open(saved)
    assert [str(one.message) for one in told] == []


@pytest.mark.parametrize("of_mesh", [True, False])
def test_values_of_meshes_are_refused_and_levels_of_each_place_are_no_coordinate(tmp_path, of_mesh):
    """As FVCOM writes: `siglay` has the axes siglay and node."""
    levels, values = np.linspace(-1, 0, 21).reshape(3, 7), np.arange(42.0).reshape(2, 3, 7)
    with scipy.io.netcdf_file(tmp_path / "a.nc", "w") as file:
        for axis, size in (("time", 2), ("siglay", 3), ("node", 7)):
            file.createDimension(axis, size)
        file.createVariable("siglay", "d", ("siglay", "node"))[:] = levels
        made = file.createVariable("temp", "d", ("time", "siglay", "node"))
        made[:] = values
        vars(made)["_attributes"].update({"mesh": "fvcom", "location": "node"} if of_mesh else {})
    if of_mesh:
        with pytest.raises(FileError, match=r"values of a mesh \(fvcom, nodes\), whose axis 'node'.*griddata"):
            ws.open(tmp_path / "a.nc")
        return
    assert sorted(ws.open(tmp_path / "a.nc").samples.ravel()) == sorted(values.ravel())


@pytest.mark.parametrize("order", [("sigma", "xcoord", "ycoord"), ("x_coord", "sigma", "ycoord")])
def test_coordinates_of_a_grid_are_axes_x_and_y(tmp_path, order):
    sizes = {"xcoord": 4, "x_coord": 4, "ycoord": 5, "sigma": 3}
    values = np.random.default_rng(3).normal(size=[sizes[name] for name in order]).astype(np.float32)
    saved = save_netcdf3(tmp_path / "a.nc", {"u": (order, values)}, {name: np.arange(sizes[name]) for name in order})
    role = [order.index(name) for name in order if name == "sigma"]
    role += [order.index(name) for name in order if name.startswith("y")]
    role += [order.index(name) for name in order if name.startswith("x")]
    np.testing.assert_array_equal(ws.open(saved).samples, values.transpose(role))


def test_steps_of_time_are_times_without_a_unit_too(tmp_path, packed):
    axes = {"timestep": np.arange(3), **{name: ALL[name] for name in ("lev", "lat", "lon")}}
    saved = save_netcdf3(tmp_path / "a.nc", {"t": (tuple(axes), packed)}, axes)
    volume = ws.open(saved, time=1)
    np.testing.assert_array_equal(volume.samples, packed[1])
    assert volume.facts.n_times == 3


def test_a_unit_of_time_is_none_of_lengths(tmp_path, packed):
    coordinates = {"time": [0, 6, 12], "y": np.arange(5) * 2.0, "x": np.arange(6) * 2.0}
    for units, unit in (("m", "m"), (None, None)):
        attributes = {**ATTRIBUTES, **({"y": {"units": units}, "x": {"units": units}} if units else {})}
        path = save_netcdf3(tmp_path / "a.nc", {"t": (("time", "y", "x"), packed[:, 0])}, coordinates, attributes)
        volume = ws.open(path)
        assert (volume.unit, volume.spacing) == (unit, (2, 2, 6))


def test_a_further_axis_is_no_light_of_a_microscope(tmp_path, packed):
    coordinates = {"member": [1, 5, 7], "lev": LEV, "lat": LAT, "lon": LON}
    path = save_netcdf3(tmp_path / "a.nc", {"t": (("member", "lev", "lat", "lon"), packed)}, coordinates)
    for opened in (ws.open, ws.open_scene):
        with pytest.raises(FileError, match=r"\(0 member 1\.?0?, 1 member 5.*channel=0\.\.2"):
            opened(path)
    assert len(ws.open_scene(path, channels=[1]).layers) == 1


def test_degrees_are_no_metres(tmp_path, packed):
    path = save_netcdf3(
        tmp_path / "a.nc", {"t": (("lev", "lat", "lon"), packed[1])}, {"lev": LEV, "lat": LAT, "lon": LON}
    )
    volume = ws.open(path)
    assert (volume.unit, volume.spacing) == (None, (60, 45, 500))
    assert volume.guesses == ("distances along x, y in degrees: 1 is drawn as 1 m of the others",)
    # Of a model on a plane in metres the scale bar is true, whatever its levels are.
    for units, unit in (({"units": "m"}, "m"), ({}, None)):
        attributes = {"lev": {"units": "hPa"}, "y": units, "x": units}
        coordinates = {"lev": LEV, "y": np.arange(5) * 2.0, "x": np.arange(6) * 2.0}
        path = save_netcdf3(tmp_path / "a.nc", {"t": (("lev", "y", "x"), packed[1])}, coordinates, attributes)
        volume = ws.open(path)
        assert volume.unit == unit
        assert (
            f"distances along z in hPa: 1 is drawn as 1 {'m of the others' if unit else 'unit of'}" in volume.guesses[0]
        )


def test_places_of_curved_grids_are_told(tmp_path, packed):
    xarray = pytest.importorskip("xarray")
    rows, columns = np.mgrid[:5, :6].astype(float)
    places = {"lat": (("eta", "xi"), rows + 0.1 * columns), "lon": (("eta", "xi"), columns + 0.1 * rows)}
    xarray.Dataset({"t": (("s", "eta", "xi"), packed[1])}, coords=places).to_netcdf(tmp_path / "a.nc", engine="scipy")
    assert "differ from row to row, and are not used: lat, lon" in ws.open(tmp_path / "a.nc").guesses[0]


def test_north_is_up_in_pictures(tmp_path):
    """The world is thin, and is seen as maps are, whatever the order of its latitudes."""
    lat, lon = np.linspace(85, -85, 18), np.arange(36) * 10.0
    field = np.random.default_rng(6).normal(size=(4, 18, 36)).astype(np.float32)
    for flip in (1, -1):
        coordinates = {"lev": [0, 5, 10, 15], "lat": lat[::flip], "lon": lon}
        path = save_netcdf3(tmp_path / "a.nc", {"t": (("lev", "lat", "lon"), field[:, ::flip])}, coordinates)
        camera = ws.render(ws.open(path), size=(72, 72)).camera
        (west, north, middle), _ = camera.project([(0, 0, 8), (180, 85, 8), (180, 0, 8)], size=(72, 72))
        assert west[0] < middle[0] - 20
        assert abs(north[0] - middle[0]) < 1
        assert north[1] < middle[1] - 10


@pytest.mark.parametrize("flip", [1, -1])
def test_slices_of_maps_have_north_on_top(tmp_path, flip):
    """Rows of images grow downwards, latitudes upwards, in whichever order the file has them."""
    field = np.zeros((4, 18, 36), np.float32)
    field[:, 1:4, 24:30] = 1.0  # far north, and east of the middle
    coordinates = {"lev": LEV, "lat": np.linspace(85, -85, 18)[::flip], "lon": np.arange(36) * 10.0}
    path = save_netcdf3(tmp_path / "a.nc", {"t": (("lev", "lat", "lon"), field[:, ::flip])}, coordinates)
    picture = ws.slice(ws.open(path), size=(72, 36)).rgba[..., :3].sum(axis=-1)
    bright = picture > picture.min() + 0.5 * np.ptp(picture)
    rows, columns = np.nonzero(bright)
    assert rows.max() < 12
    assert columns.min() > 40
    xarray = pytest.importorskip("xarray")
    with xarray.open_dataset(path, engine="scipy") as dataset:
        same = ws.slice(ws.Volume(dataset["t"]), size=(72, 36))
    np.testing.assert_array_equal(same.rgba, ws.slice(ws.open(path), size=(72, 36)).rgba)


def test_records_beside_a_field_are_passed_over(tmp_path, packed):
    path = save_netcdf4(
        tmp_path / "a.nc", {"t": (("lev", "lat", "lon"), packed[1])}, {"lev": LEV, "lat": LAT, "lon": LON}
    )
    with h5py.File(path, "r+") as file:
        record = np.zeros(4, [("place", "f4"), ("count", "i4")])
        file["stations"] = record
        file["stations"].attrs["_FillValue"] = record[:1]
    np.testing.assert_array_equal(ws.open(path).samples, packed[1])
