"""Values and geometry of simulations' files are those that other readers find: PyVista, meshio, netCDF4, ASE, segyio.

The files are written by other libraries too. A reader that is not installed skips its tests (extra `dev`).
"""

from itertools import product

import h5py
import numpy as np
import pytest
import scipy.io

import wavesplat as ws
from wavesplat.errors import FileError

# VTK, PyVista and xarray take seconds to load: one process does.
pytestmark = pytest.mark.xdist_group("vtk")

#: Coordinates along x, y, z of even grids, and of uneven ones.
EVEN = (0.5 + 0.25 * np.arange(6), -1 + 0.5 * np.arange(5), 2.0 + 1.5 * np.arange(4))
UNEVEN = (0.5 + 0.25 * np.arange(6) ** 1.3, EVEN[1], EVEN[2])
SHAPE = (4, 5, 6)


def values(seed=0):
    return np.random.default_rng(seed).normal(size=SHAPE).astype(np.float32)


def places_of(volume):
    """World positions of the samples, [n, 3], x fastest."""
    k, j, i = np.indices(volume.shape).reshape(3, -1)
    index = np.stack([i, j, k, np.ones_like(i)])
    return (volume.world_from_index @ index)[:3].T


# VTK


def grid_of(pyvista, kind, axes):
    x, y, z = axes
    if kind == "image":
        steps = tuple(float(axis[1] - axis[0]) for axis in axes)
        grid = pyvista.ImageData(dimensions=(6, 5, 4), spacing=steps, origin=tuple(float(axis[0]) for axis in axes))
    elif kind == "rectilinear":
        grid = pyvista.RectilinearGrid(x, y, z)
    else:
        grid = pyvista.RectilinearGrid(x, y, z).cast_to_structured_grid()
    grid["v"] = values().ravel()
    if kind == "unstructured":
        return grid.cast_to_unstructured_grid()
    return grid


#: Name of a file, and the kind of grid that it holds.
FILES = {
    "a.vtr": "rectilinear",
    "a.vts": "structured",
    "a.vtu": "unstructured",
    "a.vti": "image",
    "image.vtk": "image",
    "rectilinear.vtk": "rectilinear",
    "structured.vtk": "structured",
    "unstructured.vtk": "unstructured",
}


@pytest.mark.parametrize(("name", "is_binary"), list(product(FILES, [True, False])))
def test_even_vtk_grids_beside_pyvista(tmp_path, name, is_binary):
    pyvista = pytest.importorskip("pyvista")
    grid_of(pyvista, FILES[name], EVEN).save(str(tmp_path / name), binary=is_binary)
    other = pyvista.read(str(tmp_path / name))
    if FILES[name] == "unstructured":
        volume = ws.open(tmp_path / name, resample=6)
        found = pyvista.PolyData(places_of(volume)).sample(other, tolerance=1e-6)
        inside = np.asarray(found["vtkValidPointMask"]) != 0
        assert inside.mean() > 0.4
        np.testing.assert_allclose(np.ravel(volume.samples)[inside], np.asarray(found["v"])[inside], atol=1e-4)
        return
    volume = ws.open(tmp_path / name)
    np.testing.assert_array_equal(np.ravel(volume.samples), other["v"])
    np.testing.assert_allclose(places_of(volume), other.points, atol=1e-6)


@pytest.mark.parametrize("name", ["a.vtr", "a.vts", "a.vtu", "rectilinear.vtk", "structured.vtk", "unstructured.vtk"])
def test_uneven_vtk_grids_beside_pyvista(tmp_path, name):
    pyvista = pytest.importorskip("pyvista")
    grid_of(pyvista, FILES[name], UNEVEN).save(str(tmp_path / name))
    volume = ws.open(tmp_path / name, resample=9)
    found = pyvista.PolyData(places_of(volume)).sample(pyvista.read(str(tmp_path / name)))
    both = (np.asarray(found["vtkValidPointMask"]) != 0) & np.isfinite(np.ravel(volume.samples))
    assert both.mean() > 0.5
    np.testing.assert_allclose(np.ravel(volume.samples)[both], np.asarray(found["v"])[both], atol=1e-4)
    np.testing.assert_allclose(volume.bounds.T.ravel(), pyvista.read(str(tmp_path / name)).bounds, atol=1e-4)


@pytest.mark.parametrize("name", ["a.vtm", "a.pvti", "a.pvtr"])
def test_vtk_files_of_several_parts_beside_pyvista(tmp_path, name):
    pyvista = pytest.importorskip("pyvista")
    path = str(tmp_path / name)
    if name == "a.vtm":
        left, right = (grid_of(pyvista, "rectilinear", (axis + EVEN[0], *EVEN[1:])) for axis in (0, 1.25))
        right["v"] = values(1).ravel()
        pyvista.MultiBlock([left, right]).save(path)
        volume = ws.open(path, resample=11)
        found = pyvista.PolyData(places_of(volume)).sample(pyvista.read(path).combine())
        inside = (np.asarray(found["vtkValidPointMask"]) != 0) & np.isfinite(np.ravel(volume.samples))
        # Where blocks meet, either of them may be taken.
        inside &= np.abs(places_of(volume)[:, 0] - 1.75) > 1e-3
        np.testing.assert_allclose(np.ravel(volume.samples)[inside], np.asarray(found["v"])[inside], atol=1e-4)
        return
    from vtkmodules import vtkIOParallelXML

    kind = "image" if name == "a.pvti" else "rectilinear"
    writer = getattr(vtkIOParallelXML, f"vtkXMLP{'ImageData' if kind == 'image' else 'RectilinearGrid'}Writer")()
    writer.SetFileName(path)
    writer.SetInputData(grid_of(pyvista, kind, EVEN))
    writer.Write()
    other, volume = pyvista.read(path), ws.open(path)
    np.testing.assert_array_equal(np.ravel(volume.samples), other["v"])
    np.testing.assert_allclose(places_of(volume), other.points, atol=1e-6)


@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended"])
@pytest.mark.parametrize("compressor", ["None", "ZLib", "LZ4", "LZMA"])
@pytest.mark.parametrize("order", ["Little", "Big"])
@pytest.mark.parametrize("name", ["a.vti", "a.vtr", "a.vts"])
def test_ways_to_write_vtk_files(tmp_path, mode, compressor, order, name):
    pyvista = pytest.importorskip("pyvista")
    from vtkmodules import vtkIOXML

    for dtype in ("f4", "f8", "i2", "u1"):
        grid = grid_of(pyvista, FILES[name], EVEN)
        grid["v"] = (100 + 40 * values().ravel()).astype(dtype)
        kind = {"a.vti": "ImageData", "a.vtr": "RectilinearGrid", "a.vts": "StructuredGrid"}[name]
        writer = getattr(vtkIOXML, f"vtkXML{kind}Writer")()
        writer.SetFileName(str(tmp_path / name))
        writer.SetInputData(grid)
        getattr(writer, f"SetDataModeTo{mode}")()
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
        getattr(writer, f"SetByteOrderTo{order}Endian")()
        writer.Write()
        volume = ws.open(tmp_path / name)
        assert volume.samples.dtype == dtype
        np.testing.assert_array_equal(np.ravel(volume.samples), grid["v"])


def test_surfaces_are_no_volumes(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    pyvista.Sphere().save(str(tmp_path / "a.vtp"))
    with pytest.raises(FileError, match="no samples inside"):
        ws.open(tmp_path / "a.vtp")


@pytest.mark.parametrize("name", ["a.vtu", "a.vtk"])
def test_cells_of_meshes_beside_meshio(tmp_path, name):
    meshio = pytest.importorskip("meshio")
    x, y, z = UNEVEN
    k, j, i = np.meshgrid(z, y, x, indexing="ij")
    points = np.stack([i.ravel(), j.ravel(), k.ravel()], -1)
    number = np.arange(points.shape[0]).reshape(SHAPE)
    corners = [number[a : 3 + a, b : 4 + b, c : 5 + c] for a, b, c in CORNERS]
    cells = np.stack([part.ravel() for part in corners], -1)
    data = values().ravel()[: len(cells)]
    mesh = meshio.Mesh(points, [("hexahedron", cells)], cell_data={"c": [data]})
    meshio.write(tmp_path / name, mesh)
    read = meshio.read(tmp_path / name)
    volume = ws.open(tmp_path / name, resample=21)
    boxes = read.points[read.cells[0].data]
    low, high = boxes.min(axis=1), boxes.max(axis=1)
    for place, value in list(zip(places_of(volume), np.ravel(volume.samples), strict=True))[::17]:
        within = np.all((place > low + 1e-4) & (place < high - 1e-4), axis=1)
        if within.any():
            assert value == pytest.approx(read.cell_data["c"][0][within][0], abs=1e-6)


#: Corners of a hexahedron in VTK's order, as steps along z, y, x.
CORNERS = [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0), (1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0)]

# netCDF and HDF5


@pytest.mark.parametrize("kind", ["NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF4", "NETCDF4_CLASSIC"])
def test_netcdf_beside_netcdf4(tmp_path, kind):
    netcdf4 = pytest.importorskip("netCDF4")
    with netcdf4.Dataset(tmp_path / "a.nc", "w", format=kind) as file:
        for name, axis in zip(("lev", "lat", "lon"), (EVEN[2], EVEN[1][::-1], EVEN[0]), strict=True):
            file.createDimension(name, len(axis))
            file.createVariable(name, "f8", (name,))[:] = axis
        file["lat"].units, file["lon"].units = "degrees_north", "degrees_east"
        packed = file.createVariable("t", "i2", ("lev", "lat", "lon"), fill_value=-32767)
        packed.scale_factor, packed.add_offset, packed.units = 0.01, 250.0, "K"
        masked = np.ma.masked_greater(250 + values(), 251)
        packed[:] = masked
    with netcdf4.Dataset(tmp_path / "a.nc") as file:
        found = file["t"][:].filled(np.nan)
        longitude, latitude, level = (file[name][:] for name in ("lon", "lat", "lev"))
    volume = ws.open(tmp_path / "a.nc")
    assert np.isnan(found).sum() > 0
    np.testing.assert_allclose(volume.samples, found, rtol=1e-6)
    k, j, i = np.meshgrid(level, latitude, longitude, indexing="ij")
    np.testing.assert_allclose(places_of(volume), np.stack([i.ravel(), j.ravel(), k.ravel()], -1), atol=1e-6)
    assert volume.value_unit == "K"


def test_netcdf3_beside_scipy(tmp_path):
    with scipy.io.netcdf_file(tmp_path / "a.nc", "w") as file:
        for name, axis in zip(("z", "y", "x"), EVEN[::-1], strict=True):
            file.createDimension(name, len(axis))
            file.createVariable(name, "f8", (name,))[:] = axis
        file.createVariable("v", "f4", ("z", "y", "x"))[:] = values()
    with scipy.io.netcdf_file(tmp_path / "a.nc", mmap=False) as file:
        found = file.variables["v"][:]
    volume = ws.open(tmp_path / "a.nc")
    np.testing.assert_array_equal(volume.samples, found)
    np.testing.assert_allclose(volume.bounds, [[axis[0] for axis in EVEN], [axis[-1] for axis in EVEN]])


@pytest.mark.parametrize("order", ["C", "F"])
def test_openpmd_beside_its_own_attributes(tmp_path, order):
    stored = values() if order == "C" else values().T
    with h5py.File(tmp_path / "a.h5", "w") as file:
        mesh = file.create_dataset("data/100/meshes/rho", data=stored)
        labels = "zyx"
        mesh.attrs.update(axisLabels=np.array(list(labels), "S1"), dataOrder=np.bytes_(order), geometry=b"cartesian")
        mesh.attrs.update(gridSpacing=[1.5, 0.5, 0.25], gridGlobalOffset=[2.0, -1, 0.5], gridUnitSI=1e-6)
        mesh.attrs.update(position=[0.0, 0, 0], unitSI=1.0)
    volume = ws.open(tmp_path / "a.h5")
    np.testing.assert_array_equal(volume.samples, values())
    np.testing.assert_allclose(volume.bounds, [[axis[0] for axis in EVEN], [axis[-1] for axis in EVEN]])
    assert volume.unit == "um"
    with h5py.File(tmp_path / "a.h5", "a") as file:
        file["data/100/meshes/rho"].attrs["geometry"] = np.bytes_("thetaMode")
    with pytest.raises(FileError, match="thetaMode"):
        ws.open(tmp_path / "a.h5")


# Molecules, crystals, traces, bricks


def water(ase):
    cell = [[4.0, 0, 0], [1, 5, 0], [0, -1, 6]]
    return ase.Atoms("H2O", positions=[(0.1, 0.2, 0.3), (1, 2, 3), (2, 2, 2)], cell=cell, pbc=True)


def test_cubes_beside_ase(tmp_path):
    ase = pytest.importorskip("ase")
    cube = pytest.importorskip("ase.io.cube")
    with (tmp_path / "a.cube").open("w") as file:
        cube.write_cube(file, water(ase), data=values().T.astype(np.float64), origin=(0.5, -1, 2))
    with (tmp_path / "a.cube").open() as file:
        found = cube.read_cube(file)
    volume = ws.open(tmp_path / "a.cube")
    np.testing.assert_array_equal(volume.samples, found["data"].T)
    cell = np.array(found["atoms"].cell) / np.array(found["data"].shape)[:, None]
    np.testing.assert_allclose(volume.world_from_index[:3, :3], cell.T, rtol=1e-6)
    np.testing.assert_allclose(volume.world_from_index[:3, 3], found["origin"], rtol=1e-6)


def test_charges_of_vasp_beside_ase(tmp_path):
    ase = pytest.importorskip("ase")
    calculators = pytest.importorskip("ase.calculators.vasp")
    charge = calculators.VaspChargeDensity(filename=None)
    charge.atoms, charge.chg = [water(ase)], [values().T.astype(np.float64)]
    charge.write(str(tmp_path / "CHGCAR"), format="chgcar")
    found = calculators.VaspChargeDensity(str(tmp_path / "CHGCAR"))
    volume = ws.open(tmp_path / "CHGCAR")
    np.testing.assert_allclose(volume.samples, found.chg[0].T, rtol=1e-9)
    cell = np.array(found.atoms[0].cell) / np.array(found.chg[0].shape)[:, None]
    np.testing.assert_allclose(volume.world_from_index[:3, :3], cell.T, rtol=1e-9)


def test_traces_beside_segyio(tmp_path):
    segyio = pytest.importorskip("segyio")
    segyio.tools.from_array3D(str(tmp_path / "a.sgy"), values().transpose(2, 1, 0).copy(), dt=4000)
    found = segyio.tools.cube(str(tmp_path / "a.sgy"))  # inline, crossline, sample
    volume = ws.open(tmp_path / "a.sgy")
    np.testing.assert_array_equal(volume.samples, found.transpose(2, 0, 1))
    with segyio.open(str(tmp_path / "a.sgy")) as file:
        assert volume.spacing[2] == pytest.approx(file.samples[1] - file.samples[0])
        assert volume.shape == (len(file.samples), len(file.ilines), len(file.xlines))


@pytest.mark.parametrize("endian", ["big", "little"])
@pytest.mark.parametrize("form", [1, 2, 3, 5, 6, 8, 10, 11, 16])
def test_types_of_traces_beside_segyio(tmp_path, form, endian):
    """IBM's and IEEE's floats and whole numbers, in both byte orders."""
    segyio = pytest.importorskip("segyio")
    spec = segyio.spec()
    spec.sorting, spec.format, spec.endian = 2, form, endian
    spec.ilines, spec.xlines, spec.samples = 1 + np.arange(3), 5 + np.arange(4), 4.0 * np.arange(5)
    numbers = np.abs(np.random.default_rng(form).normal(60, 20, (12, 5)))
    with segyio.create(str(tmp_path / "a.sgy"), spec) as file:
        for number, trace in enumerate(numbers):
            file.header[number] = {segyio.su.iline: 1 + number // 4, segyio.su.xline: 5 + number % 4}
            file.trace[number] = trace.astype(file.dtype)
    with segyio.open(str(tmp_path / "a.sgy"), endian=endian) as file:
        found = segyio.tools.cube(file)
    volume = ws.open(tmp_path / "a.sgy")
    assert volume.samples.dtype == found.dtype
    np.testing.assert_array_equal(volume.samples, found.transpose(2, 0, 1))


def test_bricks_beside_numpy(tmp_path):
    values().astype(">f4").tofile(tmp_path / "a.values")
    (tmp_path / "a.bov").write_text(
        "TIME: 2.5\nDATA_FILE: a.values\nDATA_SIZE: 6 5 4\nDATA_FORMAT: FLOAT\nVARIABLE: rho\nDATA_ENDIAN: BIG\n"
        "CENTERING: nodal\nBRICK_ORIGIN: 0.5 -1 2\nBRICK_SIZE: 1.25 2 4.5\n"
    )
    volume = ws.open(tmp_path / "a.bov")
    np.testing.assert_array_equal(volume.samples, np.fromfile(tmp_path / "a.values", ">f4").reshape(SHAPE))
    np.testing.assert_allclose(volume.bounds, [[axis[0] for axis in EVEN], [axis[-1] for axis in EVEN]])
