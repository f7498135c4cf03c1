"""Data of people who follow a page of the documentation: other ones than the page shows, under other names."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np

import wavesplat as ws

#: The body: millimetres from the middle of its lowest slice, off the world's origin, wider than deep.
ORIGIN_MM = (-110.0, -130.0, -120.0)
SPACING_MM = (5.0, 5.0, 6.0)
SHAPE = (40, 42, 46)
#: Radius of the ball that is the surgeon's first part.
PART_MM = 30.0


def world(shape=SHAPE, spacing=SPACING_MM, origin=ORIGIN_MM):
    """The places of samples, as three arrays [z, y, x], and the matrix from indices (x, y, z)."""
    matrix = np.diag([*spacing, 1.0])
    matrix[:3, 3] = origin
    z, y, x = np.indices(shape, dtype=np.float32)
    return [place * step + start for place, step, start in zip((x, y, z), spacing, origin, strict=True)], matrix


def body(samples, matrix, **more):
    """A volume of a patient."""
    return ws.Volume(samples, world_from_index=matrix, unit="mm", anatomical=True, **more)


def chest():
    """Hounsfield units of a trunk: air, soft tissue, two lungs, a spine and ribs."""
    (x, y, z), matrix = world()
    trunk = (x / 95) ** 2 + ((y + 30) / 75) ** 2 < 1
    hounsfield = np.where(trunk, 40.0, -1000.0)
    for side in (-45, 45):
        hounsfield[((x - side) / 28) ** 2 + ((y + 20) / 45) ** 2 + (z / 80) ** 2 < 1] = -800
    rim = np.abs(np.sqrt((x / 80) ** 2 + ((y + 30) / 62) ** 2) - 1) < 0.06
    hounsfield[rim & (np.mod(z, 36) < 14)] = 700
    hounsfield[np.hypot(x, y + 85) < 17] = 600
    return body(hounsfield.astype(np.int16), matrix, name="chest")


def ball(at, radius, most, **grid):
    """A soft ball, float32, and its matrix."""
    (x, y, z), matrix = world(**grid)
    distance2 = (x - at[0]) ** 2 + (y - at[1]) ** 2 + (z - at[2]) ** 2
    return (most * np.exp(-distance2 / (2 * radius**2))).astype(np.float32), matrix


def scans_of_a_patient(folder: Path):
    """A chest, a PET and a dose on grids of their own, a follow-up 6 mm to the left with its registration."""
    import SimpleITK

    scan = chest()
    scan.save(folder / "thorax.nrrd")
    uptake = body(*ball((30, -10, 20), 14, 8, shape=(22, 24, 26), spacing=(9, 9, 11)))
    SimpleITK.WriteImage(uptake.to_sitk(), str(folder / "fdg.mha"))
    body(*ball((-20, -40, 0), 40, 60, shape=(30, 30, 30), spacing=(8, 8, 8))).save(folder / "plan_dose.nrrd")
    moved = scan.world_from_index.copy()
    moved[0, 3] -= 6
    body(np.asarray(scan.samples), moved).save(folder / "follow_up.nrrd")
    transform = "Transform: TranslationTransform_double_3_3\nParameters: 6 0 0\nFixedParameters:\n"
    (folder / "registration.tfm").write_text("#Insight Transform File V1.0\n" + transform)
    (folder / "cohort").mkdir()
    for name in ("a", "b"):
        shutil.copy(folder / "thorax.nrrd", folder / "cohort" / f"{name}.nrrd")


def parts_of_a_patient(folder: Path):
    """A scan, a segmentation with two parts on its grid, and their names."""
    scan = chest()
    scan.save(folder / "thorax.nrrd")
    (x, y, z), matrix = world()
    parts = np.zeros(SHAPE, np.uint8)
    parts[(x - 20) ** 2 + (y + 30) ** 2 + z**2 < PART_MM**2] = 1
    parts[np.hypot(x, y + 85) < 17] = 2
    body(parts, matrix).save(folder / "plan.nrrd")
    (folder / "parts.tsv").write_text("index\tname\tcolor\n1\ttumour\t#d05040\n2\tspine\t#e8e0c0\n")


def scans_of_a_head(folder: Path):
    """A head in layers, of values up to 400, and a map of t values on it."""
    (x, y, z), matrix = world(shape=(44, 52, 44), spacing=(4, 4, 4), origin=(-86, -102, -80))
    distance = np.sqrt((x / 70) ** 2 + (y / 85) ** 2 + (z / 72) ** 2)
    brain = np.where(distance < 0.8, 180 + 60 * np.sin(x / 6) * np.sin(y / 7) * np.sin(z / 6), 0)
    skin = np.where(np.abs(distance - 0.95) < 0.05, 400, 0)
    noise = np.random.default_rng(3).rayleigh(4, brain.shape)
    body((brain + skin + noise).astype(np.int16), matrix).save(folder / "t1.nii")
    peaks = ball((30, 20, 10), 10, 11, shape=(44, 52, 44), spacing=(4, 4, 4), origin=(-86, -102, -80))[0]
    body(peaks - peaks[:, :, ::-1], matrix).save(folder / "tmap.nii")


def recording_of_cells(folder: Path):
    """Two channels as OME-TIFF, and a stack of bytes that says nothing of its pixels."""
    import tifffile

    rng = np.random.default_rng(11)
    z, y, x = np.mgrid[:20, :64, :72].astype(np.float32)
    stain = np.full((2, *z.shape), 50, np.float32)
    for a, b, c in rng.uniform((4, 8, 8), (16, 56, 64), (9, 3)):
        distance = np.sqrt(6 * (z - a) ** 2 + (y - b) ** 2 + (x - c) ** 2)
        stain[0] += 400 / (1 + np.exp(distance - 5))
        stain[1] += 250 * np.exp(-((distance - 9) ** 2) / 3)
    channels = {"Name": ["Hoechst", "actin"], "Color": [0x0000FFFF, -16776961]}
    size = {"PhysicalSizeX": 0.1, "PhysicalSizeY": 0.1, "PhysicalSizeZ": 0.3}
    metadata = {"axes": "CZYX", "Channel": channels, **size}
    tifffile.imwrite(folder / "slide.ome.tif", rng.poisson(stain).astype(np.uint16), metadata=metadata)
    tifffile.imwrite(folder / "confocal.tif", np.clip(stain[1] / 2, 0, 255).astype(np.uint8))


def ocean(folder: Path):
    """Temperature by depth, latitude and longitude, uneven in depth, and two fields as arrays."""
    import xarray as xr

    depth, lat, lon = np.array([0.0, 20, 80, 200, 500, 900]), np.linspace(-30, 30, 25), np.linspace(120, 200, 30)
    z, y, x = np.meshgrid(depth, np.radians(lat), np.radians(lon), indexing="ij")
    warm = 4 + 24 * np.exp(-z / 300) * np.cos(2 * y) + np.sin(6 * x)
    places = {"depth": depth, "lat": lat, "lon": lon}
    field = xr.DataArray(warm, dims=("depth", "lat", "lon"), coords=places, attrs={"units": "degC"})
    field.to_dataset(name="thetao").to_netcdf(folder / "ocean.nc", engine="scipy")
    z, y, x = np.mgrid[-1:1:36j, -1:1:40j, -1:1:44j]
    np.save(folder / "salt.npy", np.exp(-3 * (x**2 + y**2 + 2 * z**2)).astype(np.float32))
    np.save(folder / "current.npy", (np.sin(4 * x) * np.exp(-(y**2))).astype(np.float32))


def flow_in_a_duct(folder: Path):
    """A VTK grid with uneven steps, a density over decades and a field with a sign."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkRectilinearGrid
    from vtkmodules.vtkIOXML import vtkXMLRectilinearGridWriter

    x, y, z = 0.2 * 1.1 ** np.arange(20), np.linspace(-1, 1, 18), np.linspace(-1, 1, 16)
    grid = vtkRectilinearGrid()
    grid.SetDimensions(len(x), len(y), len(z))
    for place, axis in zip((x, y, z), ("X", "Y", "Z"), strict=True):
        getattr(grid, f"Set{axis}Coordinates")(numpy_to_vtk(place, deep=True))
    k, j, i = np.meshgrid(z, y, x, indexing="ij")
    speed = numpy_to_vtk(((1 - j**2) * (1 - k**2) / i).ravel(), deep=True)
    speed.SetName("speed")
    grid.GetPointData().AddArray(speed)
    writer = vtkXMLRectilinearGridWriter()
    writer.SetFileName(str(folder / "duct.vtr"))
    writer.SetInputData(grid)
    writer.Write()
    z, y, x = np.mgrid[-1:1:40j, -1:1:32j, -1:1:36j]
    np.save(folder / "rho.npy", (10 ** (3 - 4 * np.sqrt(x**2 + y**2 + z**2))).astype(np.float32))
    np.save(folder / "omega.npy", (np.sin(4 * z) * np.cos(3 * x) * np.exp(-(y**2))).astype(np.float32))


def lesson(folder: Path):
    """A bone to turn, a head to fly around, and a ring that widens in six steps."""
    import nibabel

    chest().save(folder / "thorax.nrrd")
    scans_of_a_head(folder)
    z, y, x = np.mgrid[-1:1:24j, -1:1:32j, -1:1:32j]
    rings = [100 * np.exp(-((np.hypot(x, y) - 0.3 - 0.08 * t) ** 2 + z**2) * 30) for t in range(6)]
    nibabel.save(nibabel.Nifti1Image(np.stack(rings, -1).astype(np.float32), np.eye(4)), folder / "ring.nii.gz")


def arrays_of_a_programmer(folder: Path):
    """A head as NIfTI, two arrays, and a folder of scans."""
    scans_of_a_head(folder)
    flow_in_a_duct(folder)
    scans_of_a_patient(folder)
