"""Objects of other libraries as volumes, and back: place, unit and bytes are those that the file's reader gives.

Where a library is not installed, objects of the same shape stand in for its own (`foreign_fakes`).
"""

from __future__ import annotations

import gzip
import inspect
import itertools
import sys

import foreign_fakes as fakes
import nibabel
import numpy as np
import pytest
import SimpleITK
from vti_files import save_vti

import wavesplat as ws
from wavesplat._model.volume.volume_like import as_volume
from wavesplat.errors import ArgumentError, FileError

# VTK, PyVista and xarray take seconds to load: one process does.
pytestmark = pytest.mark.xdist_group("vtk")

SAMPLES = np.random.default_rng(5).integers(-900, 900, (4, 5, 6)).astype(np.int16)
#: Numbers of files in memory.
NUMBERS = itertools.count()


def oblique(spacing=(0.7, 0.9, 2.5), origin=(-11.5, 20.25, 33.0)):
    """World (RAS) from index, turned about an oblique axis, with different spacings."""
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14)
    across = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turned = np.eye(3) + np.sin(0.4) * across + (1 - np.cos(0.4)) * across @ across
    matrix = np.eye(4)
    matrix[:3, :3] = turned * spacing
    matrix[:3, 3] = origin
    return matrix


PLACE = oblique()
STRAIGHT = np.array([[0.7, 0, 0, -11.5], [0, -0.9, 0, 20.25], [0, 0, 2.5, 33], [0, 0, 0, 1.0]])
LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


def same(a, b, *, names=True, tolerance=1e-6):
    """Whether two volumes have the same samples, to type and bytes, place, unit and anatomy."""
    assert a.samples.dtype == b.samples.dtype
    np.testing.assert_array_equal(a.samples, b.samples)
    np.testing.assert_allclose(a.world_from_index, b.world_from_index, atol=tolerance)
    facts = [(v.unit, v.is_anatomical, v.modality, *([v.name] if names else [])) for v in (a, b)]
    assert facts[0] == facts[1]


# Each object against the reader of its file ---------------------------------------------------------------------------


def _nifti(folder):
    path = folder / "scan.nii.gz"
    image = nibabel.Nifti1Image(SAMPLES.T, PLACE)
    image.header.set_xyzt_units("mm")
    nibabel.save(image, path)
    return path, nibabel.load(path)


def _scaled_nifti(folder):
    path = folder / "scan.nii"
    image = nibabel.Nifti1Image(SAMPLES.T, PLACE)
    image.header.set_slope_inter(2, -1000)
    image.header.set_xyzt_units("micron")
    nibabel.save(image, path)
    return path, nibabel.load(path)


def _mgh(folder):
    path = folder / "scan.mgz"
    nibabel.save(nibabel.MGHImage(SAMPLES.T, PLACE), path)
    return path, nibabel.load(path)


def _analyze(folder):
    path = folder / "scan.hdr"
    nibabel.save(nibabel.Spm99AnalyzeImage(SAMPLES.T, np.diag([0.7, 0.9, 2.5, 1])), path)
    return path, nibabel.load(path)


def _simple_itk(name):
    def make(folder):
        path = folder / name
        SimpleITK.WriteImage(fakes.simple_itk_image(SAMPLES, LPS @ PLACE), path)
        return path, SimpleITK.ReadImage(path)

    return make


def _nrrd_without_anatomy(folder):
    path = folder / "scan.nrrd"
    ws.Volume(SAMPLES, world_from_index=PLACE).save(path)
    return path, SimpleITK.ReadImage(path)


def _itk(name):
    def make(folder):
        itk = pytest.importorskip("itk")
        path = folder / name
        SimpleITK.WriteImage(fakes.simple_itk_image(SAMPLES, LPS @ PLACE), path)
        return path, itk.imread(str(path))

    return make


def _vtk_fake(folder):
    path = folder / "image.vti"
    attributes = 'Origin="3 4 5" Spacing="0.7 0.9 2.5"'
    save_vti(path, {"density": SAMPLES.astype(np.float32)}, attributes=attributes, scalars='Scalars="density"')
    return path, fakes.VtkImage(SAMPLES.astype(np.float32), (3, 4, 5), (0.7, 0.9, 2.5), name="density")


def _pyvista(folder):
    pyvista = pytest.importorskip("pyvista")
    path = folder / "image.vti"
    image = pyvista.ImageData(
        dimensions=(6, 5, 4),
        spacing=(0.7, 0.9, 2.5),
        origin=(3, 4, 5),
        direction_matrix=PLACE[:3, :3] / (0.7, 0.9, 2.5),
    )
    image.point_data["density"] = SAMPLES.ravel()
    image.save(path)
    return path, pyvista.read(path)


def _pyvista_cells(folder):
    pyvista = pytest.importorskip("pyvista")
    path = folder / "image.vti"
    image = pyvista.ImageData(dimensions=(7, 6, 5), spacing=(0.7, 0.9, 2.5), origin=(3, 4, 5))
    image.cell_data["density"] = SAMPLES.ravel()
    image.save(path)
    return path, pyvista.read(path)


def _hdf5(folder):
    import h5py

    path = folder / "cells.h5"
    file = h5py.File(path, "w")
    file["cells"] = SAMPLES
    file["cells"].attrs["element_size_um"] = (2.5, 0.9, 0.7)
    file.flush()
    return path, file["cells"]


def _zarr(folder):
    import zarr

    path = folder / "cells.zarr"
    array = zarr.create_array(store=str(path), shape=SAMPLES.shape, dtype=SAMPLES.dtype)
    array[:] = SAMPLES
    return path, array


OBJECTS = {
    "nibabel": _nifti,
    "nibabel, scaled, in um": _scaled_nifti,
    "nibabel, FreeSurfer": _mgh,
    "nibabel, Analyze": _analyze,
    "SimpleITK of NRRD": _simple_itk("scan.nrrd"),
    "SimpleITK of MetaImage": _simple_itk("scan.mha"),
    "SimpleITK of NIfTI": _simple_itk("scan.nii"),
    "SimpleITK of NRRD without anatomy": _nrrd_without_anatomy,
    "ITK of NRRD": _itk("scan.nrrd"),
    "ITK of MetaImage": _itk("scan.mha"),
    "VTK, a stand-in": _vtk_fake,
    "PyVista": _pyvista,
    "PyVista, cells": _pyvista_cells,
    "h5py": _hdf5,
    "Zarr": _zarr,
}


def test_the_place_of_freesurfers_images_is_kept(tmp_path):
    for thing in _mgh(tmp_path):
        volume = ws.Volume(thing) if isinstance(thing, nibabel.MGHImage) else ws.open(thing)
        np.testing.assert_allclose(volume.world_from_index, PLACE, atol=1e-5)
        assert volume.facts.is_anatomical
        assert volume.facts.unit == "mm"
        assert volume.facts.guesses == ()


@pytest.mark.parametrize("kind", OBJECTS)
def test_an_object_is_what_the_reader_makes_of_its_file(tmp_path, kind):
    path, held = OBJECTS[kind](tmp_path)
    same(ws.Volume(held), ws.open(path), names=False, tolerance=2e-6)
    same(as_volume(held), ws.Volume(held))


# Objects without files of their own -----------------------------------------------------------------------------------


def _dask():
    return pytest.importorskip("dask.array").from_array(SAMPLES, chunks=2)


def _torch():
    return pytest.importorskip("torch").from_numpy(SAMPLES.copy()).float().requires_grad_()


def _monai():
    torch = pytest.importorskip("torch")
    data = pytest.importorskip("monai.data")
    return data.MetaTensor(torch.from_numpy(SAMPLES.T.copy())[None], affine=torch.from_numpy(PLACE))


def _napari():
    layers = pytest.importorskip("napari.layers")
    return layers.Image(
        SAMPLES[None], scale=(1, 2.5, 0.9, 0.7), translate=(0, 1, 2, 3), name="nuclei", units=("pixel", *["um"] * 3)
    )


def _vtk():
    vtk = pytest.importorskip("vtk")
    support = pytest.importorskip("vtk.util.numpy_support")
    image = vtk.vtkImageData()
    image.SetExtent(2, 7, 0, 4, 0, 3)
    image.SetSpacing(0.7, 0.9, 2.5)
    array = support.numpy_to_vtk(SAMPLES.ravel(), deep=True)
    array.SetName("density")
    image.GetPointData().SetScalars(array)
    return image


SCALE = np.diag([0.7, 0.9, 2.5, 1.0])


def _moved(x, y, z):
    matrix = SCALE.copy()
    matrix[:3, 3] = x, y, z
    return matrix


#: Functions that make objects, and the volumes that these stand for.
ARRAYS = {
    "nested lists": (SAMPLES.tolist, ws.Volume(SAMPLES.astype(np.int16))),
    "buffer": (lambda: memoryview(SAMPLES), ws.Volume(SAMPLES)),
    "array interface": (lambda: fakes.WithArray(SAMPLES), ws.Volume(SAMPLES)),
    "DLPack alone": (lambda: fakes.WithDlpack(SAMPLES.copy()), ws.Volume(SAMPLES)),
    "a volume": (
        lambda: ws.Volume(SAMPLES, world_from_index=PLACE, unit="um", name="mine"),
        ws.Volume(SAMPLES, world_from_index=PLACE, unit="um", name="mine"),
    ),
    "Dask": (_dask, ws.Volume(SAMPLES)),
    "PyTorch, with a gradient": (_torch, ws.Volume(SAMPLES.astype(np.float32))),
    "PyTorch, a stand-in": (lambda: fakes.Tensor(SAMPLES), ws.Volume(SAMPLES)),
    "MONAI": (_monai, ws.Volume(SAMPLES, world_from_index=PLACE, unit="mm", anatomical=True)),
    "MONAI, a stand-in": (
        lambda: fakes.MetaTensor(SAMPLES.T[None], PLACE),
        ws.Volume(SAMPLES, world_from_index=PLACE, unit="mm", anatomical=True),
    ),
    "napari": (_napari, ws.Volume(SAMPLES, world_from_index=_moved(3, 2, 1), unit="um", name="nuclei")),
    "napari, a stand-in": (
        lambda: fakes.Layer(SAMPLES[None], (1, 2.5, 0.9, 0.7), (0, 1, 2, 3), "nuclei", ("pixel", *["micrometer"] * 3)),
        ws.Volume(SAMPLES, world_from_index=_moved(3, 2, 1), unit="um", name="nuclei"),
    ),
    "VTK, an extent": (_vtk, ws.Volume(SAMPLES, world_from_index=_moved(1.4, 0, 0), name="density")),
    "VTK, an extent, a stand-in": (
        lambda: fakes.VtkImage(SAMPLES, (0, 0, 0), (0.7, 0.9, 2.5), first=(2, 0, 0), name="density"),
        ws.Volume(SAMPLES, world_from_index=_moved(1.4, 0, 0), name="density"),
    ),
    "VTK, cells, a stand-in": (
        lambda: fakes.VtkImage(SAMPLES, (3, 4, 5), (0.7, 0.9, 2.5), of_cells=True, name="density"),
        ws.Volume(SAMPLES, world_from_index=_moved(3.35, 4.45, 6.25), name="density"),
    ),
}


@pytest.mark.parametrize("kind", ARRAYS)
def test_arrays_and_layers(kind):
    make, wanted = ARRAYS[kind]
    same(ws.Volume(make()), wanted)
    same(as_volume(make()), wanted)


def test_a_place_that_is_given_goes_before_that_of_the_object():
    image = fakes.simple_itk_image(SAMPLES, LPS @ PLACE)
    volume = ws.Volume(image, spacing=(1, 2, 3), name="mine")
    assert (volume.spacing, volume.unit, volume.is_anatomical, volume.name) == ((1, 2, 3), None, False, "mine")
    volume = ws.Volume(image, unit="um", anatomical=False)
    np.testing.assert_allclose(volume.world_from_index, PLACE, atol=1e-12)
    assert (volume.unit, volume.is_anatomical) == ("um", False)


def test_modality_of_what_simple_itk_read():
    image = fakes.simple_itk_image(SAMPLES, np.eye(4))
    for key, said in (("0008|0060", "CT "), ("modality", "ct"), ("Modality", "MET_MOD_CT")):
        marked = SimpleITK.Image(image)
        marked.SetMetaData(key, said)
        assert ws.Volume(marked).modality == "CT"
    assert ws.Volume(image).modality is None


def test_functions_take_what_volume_takes():
    image = fakes.simple_itk_image(SAMPLES, LPS @ STRAIGHT)
    volume = ws.Volume(image)
    assert ws.slice(image).rgba.tobytes() == ws.slice(volume).rgba.tobytes()
    pytest.importorskip("skimage")
    np.testing.assert_array_equal(ws.mesh(image, 0).vertices, ws.mesh(volume, 0).vertices)
    assert ws.Look.auto(image) == ws.Look.auto(volume)
    assert ws.TransferFunction.auto(image) == ws.TransferFunction.auto(volume)
    assert ws.Look.preset("grey", image) == ws.Look.preset("grey", volume)
    assert ws.Crop.corner(image, "left") == ws.Crop.corner(volume, "left")
    made = ws.WaveletVolume.from_volume(image)
    np.testing.assert_allclose(made.world_from_index, volume.world_from_index)
    labels = ws.Labels(fakes.simple_itk_image((SAMPLES > 0).astype(np.uint8), LPS @ STRAIGHT))
    assert labels.on_samples_of(volume) is labels
    np.testing.assert_allclose(labels.world_from_index, STRAIGHT, atol=1e-12)


# Objects that are no volumes ------------------------------------------------------------------------------------------


class Thing:
    """An object that is no volume."""


def _file():
    import h5py

    # Of other names, since one of before may still be open, in the traceback of an error.
    return h5py.File(f"x{next(NUMBERS)}.h5", "w", driver="core", backing_store=False)


def _colours():
    image = SimpleITK.GetImageFromArray(np.zeros((2, 2, 2, 3), np.uint8), isVector=True)
    assert image.GetNumberOfComponentsPerPixel() == 3
    return image


WRONG = {
    "a path": (lambda: "scan.nii.gz", r"is 'scan.nii.gz', the name of a file; open it first: wavesplat.open\('scan"),
    "a thing": (Thing, "is a Thing; give a wavesplat.Volume, as from wavesplat.open"),
    "nothing": (lambda: None, "is None; give a wavesplat.Volume"),
    "several": (lambda: [SAMPLES, ws.Volume(SAMPLES)], "is a list of 2; give one of them"),
    "a file of HDF5": (_file, r"is a File; give one of its datasets, as file\['name'\]"),
    "wavelets": (lambda: {"a": 1}, "is a dict; give a wavesplat.Volume"),
    "a picture": (lambda: np.zeros((4, 4)), "the array is 2-D"),
    "times": (lambda: fakes.WithArray(np.zeros((2, 2, 2, 2))), r"the array is 4-D.*as array\[n\] with n = 0..1"),
    "SimpleITK, channels": (_colours, "the image has 3 channels; .*VectorIndexSelectionCast"),
    "SimpleITK, times": (lambda: SimpleITK.Image([2, 2, 2, 2], SimpleITK.sitkUInt8), r"4-D.*image\[:, :, :, 0\]"),
    "SimpleITK, a slice": (lambda: SimpleITK.Image([2, 2], SimpleITK.sitkUInt8), "the image is 2-D"),
    "nibabel, times": (
        lambda: nibabel.Nifti1Image(np.zeros((2, 2, 2, 3), np.uint8), np.eye(4)),
        r"the image is 4-D.*image.slicer\[..., 0\]",
    ),
    "nibabel, colours": (
        lambda: nibabel.Nifti1Image(np.zeros((2, 2, 2), [("R", "u1"), ("G", "u1"), ("B", "u1")]), np.eye(4)),
        "3 channels of colour",
    ),
    "napari, times": (
        lambda: fakes.Layer(np.zeros((3, 2, 2, 2)), np.ones(4), np.zeros(4), "cells", ()),
        r"layer 'cells' has shape \(3, 2, 2, 2\); give one volume of it, as wavesplat.Volume\(layer.data\[0\], spacing",
    ),
    "VTK, components": (
        lambda: fakes.VtkImage(np.zeros((2, 2, 2, 3)), (0, 0, 0), (1, 1, 1), name="velocity"),
        "the array 'velocity' has 3 components",
    ),
    "VTK, no scalars": (lambda: fakes.VtkImage(None, (0, 0, 0), (1, 1, 1)), r"0 arrays \(none\).*set_active_scalars"),
    "VTK, no image": (fakes.VtkMesh, "a VtkMesh is no image of evenly spaced samples; resample it"),
    "CuPy, a stand-in": (fakes.OnGpu, r"a cupy.OnGpu may lie in the memory of a GPU; copy it first, with cupy.asnumpy"),
    "PyTorch, a stand-in": (lambda: fakes.Tensor(None), "could not be read as samples: "),
}


@pytest.mark.parametrize("kind", WRONG)
def test_what_is_no_volume_is_one_sentence(kind):
    make, message = WRONG[kind]
    doors = [("samples", ws.Volume), ("volume", as_volume)]
    # A slice may show several volumes.
    doors += [] if kind == "several" else [("volume", ws.slice)]
    for argument, take in doors:
        with pytest.raises(ArgumentError, match=message) as told:
            take(make())
        assert str(told.value).startswith(argument) or "volume '" in str(told.value)
        assert "\n" not in str(told.value)


def test_no_message_has_a_private_name():
    """This holds for any object, given to any public function that takes a volume."""
    given = [make for make, _ in WRONG.values()] + [lambda: 3, lambda: b"", lambda: [[1]], lambda: ws, lambda: Thing]
    functions = _public_functions()
    assert len(functions) > 12
    told = {}
    for name, function in functions.items():
        for make in given:
            thing = make()
            try:
                function(thing)
            except Exception as error:  # noqa: BLE001 - whatever it is
                told[name, str(error)] = type(error)
    assert [said for said, kind in told.items() if not issubclass(kind, ws.errors.WavesplatError)] == []
    private = ("'_", "._", "_core", "_native", "has no attribute")
    assert [said for said in told if any(part in said[1] for part in private)] == []


def _public_functions():
    """Public functions and methods that take a volume first, and what else they need."""
    more = {"mesh": {"iso_value": 1}, "view": {"name": "left"}, "corner": {"name": "left"}}
    more |= {"raycast": {"step": 1}, "Isolines": {"values": [1]}}
    more |= {"VolumePart": {"start": (0, 0, 0), "own": ((0, 2), (0, 2), (0, 2)), "shape": (2, 2, 2)}}
    places = [(ws, name) for name in ws.__all__] + [
        (holder, name)
        for holder in (ws.reference, ws.study, ws.Look, ws.TransferFunction, ws.Materials, ws.Camera, ws.Crop)
        for name in (getattr(holder, "__all__", None) or vars(holder))
        if not name.startswith("_")
    ]
    places += [(ws.WaveletVolume, "from_volume")]
    found = {}
    for holder, name in places:
        function = getattr(holder, name)
        if not callable(function) or name in ("movie", "render_frames"):  # which draw what Scene takes
            continue
        try:
            first = next(iter(inspect.signature(function).parameters), None)
        except (TypeError, ValueError):
            continue
        if first in ("volume", "segmentation", "samples", "what"):
            kwargs = {"browser": False} if function is ws.view else more.get(name, {})
            found[f"{holder.__name__}.{name}"] = lambda thing, function=function, kwargs=kwargs: function(
                thing, **kwargs
            )
    return found


# Giving ---------------------------------------------------------------------------------------------------------------

VOLUMES = {
    "a patient's": ws.Volume(
        SAMPLES, world_from_index=PLACE, name="scan", facts=ws.Facts(unit="mm", is_anatomical=True, modality="CT")
    ),
    "a patient's, sheared": ws.Volume(
        SAMPLES, world_from_index=PLACE @ np.array([[1, 0.2, 0, 0], [0, 1, 0.1, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
        name="scan", unit="mm", anatomical=True,
    ),
    "a microscope's": ws.Volume(SAMPLES.astype(np.uint16), world_from_index=STRAIGHT, name="cells", unit="um"),
    "unknown": ws.Volume(SAMPLES.astype(np.float64), name="field"),
}  # fmt: skip


@pytest.mark.parametrize("kind", VOLUMES)
def test_xarray_comes_back(kind):
    pytest.importorskip("xarray")
    volume = VOLUMES[kind]
    array = volume.to_xarray()
    same(ws.Volume(array), volume, tolerance=1e-12)
    # A selection keeps its coordinates.
    part = ws.Volume(array.isel(y=slice(1, None, 2), x=slice(None, None, -1)))
    matrix = volume.world_from_index @ np.array([[-1, 0, 0, 5], [0, 2, 0, 1], [0, 0, 1, 0], [0, 0, 0, 1]])
    np.testing.assert_allclose(part.world_from_index, matrix, atol=1e-12)
    assert (part.unit, part.is_anatomical, part.modality) == (volume.unit, volume.is_anatomical, volume.modality)


@pytest.mark.parametrize("kind", VOLUMES)
def test_simple_itk_comes_back(kind, tmp_path):
    volume = VOLUMES[kind]
    image = volume.to_sitk()
    same(ws.Volume(image, name=volume.name), volume, tolerance=1e-12)
    point = image.TransformContinuousIndexToPhysicalPoint((1.0, 2.0, 0.0))
    world = (volume.world_from_index @ (1, 2, 0, 1))[:3]
    np.testing.assert_allclose(point, world * ((-1, -1, 1) if volume.is_anatomical else 1), atol=1e-12)
    # SimpleITK's own file of the image gives the same volume.
    SimpleITK.WriteImage(image, tmp_path / "again.nrrd")
    same(ws.open(tmp_path / "again.nrrd"), volume, names=False)


@pytest.mark.parametrize("kind", VOLUMES)
def test_nibabel_comes_back(kind):
    volume = VOLUMES[kind]
    image = volume.to_nibabel()
    factor = 1e-3 if volume.unit == "um" else 1
    again = ws.Volume(image, name=volume.name)
    np.testing.assert_array_equal(again.samples, volume.samples)
    np.testing.assert_allclose(again.world_from_index[:3], factor * volume.world_from_index[:3], atol=1e-5)
    assert (again.unit, again.is_anatomical) == (volume.unit and "mm", volume.is_anatomical)
    np.testing.assert_allclose(image.affine, again.world_from_index, atol=1e-5)


@pytest.mark.parametrize("kind", VOLUMES)
def test_pyvista_comes_back(kind):
    pytest.importorskip("pyvista")
    volume = VOLUMES[kind]
    again = ws.Volume(volume.to_pyvista())
    same(again, volume, tolerance=1e-12) if volume.modality is None else np.testing.assert_allclose(
        again.world_from_index, volume.world_from_index, atol=1e-12
    )
    np.testing.assert_allclose(volume.to_pyvista().bounds[::2], volume.bounds[0], atol=1e-12)


def test_giving_pyvista_needs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(ws.errors.LibraryError, match=r'pyvista is not installed.*pip install "wavesplat\[pyvista\]"'):
        VOLUMES["unknown"].to_pyvista()


def test_numpy_is_given_the_samples():
    volume = ws.Volume(SAMPLES)
    assert np.shares_memory(np.asarray(volume), SAMPLES)
    assert not np.asarray(volume).flags.writeable
    assert np.array(volume).flags.writeable
    assert np.asarray(volume, np.float32).dtype == np.float32
    if np.lib.NumpyVersion(np.__version__) >= "2.0.0":
        assert np.shares_memory(np.array(volume, copy=False), SAMPLES)
        with pytest.raises(ValueError, match="a copy"):
            np.array(volume, np.float32, copy=False)


@pytest.mark.parametrize("name", ["scan.nrrd", "scan.nii", "scan.nii.gz", "SCAN.NII.GZ"])
@pytest.mark.parametrize("kind", VOLUMES)
@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"])
def test_saved_volumes_are_read_back(tmp_path, name, kind, dtype):
    volume = VOLUMES[kind]
    volume = ws.Volume(volume.samples.astype(dtype), world_from_index=volume.world_from_index, facts=volume.facts)
    volume.save(tmp_path / name)
    again = ws.open(tmp_path / name)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    if name.endswith(".nrrd"):
        same(again, volume, names=False, tolerance=0)
        return
    assert (again.dtype, again.is_anatomical) == (volume.dtype, volume.is_anatomical)
    np.testing.assert_array_equal(again.samples, volume.samples)
    factor = 1e-3 if volume.unit == "um" else 1
    # NIfTI keeps places as float32.
    np.testing.assert_allclose(again.world_from_index[:3], factor * volume.world_from_index[:3], rtol=1e-6, atol=1e-6)


def test_equal_volumes_are_equal_files(tmp_path):
    for name in ("a.nrrd", "a.nii.gz"):
        VOLUMES["a patient's"].save(tmp_path / name)
        first = (tmp_path / name).read_bytes()
        VOLUMES["a patient's"].save(tmp_path / name)
        assert (tmp_path / name).read_bytes() == first
    assert gzip.decompress(first)[:4] == b"\x5c\x01\0\0"  # NIfTI's header has 348 bytes


@pytest.mark.parametrize("name", ["scan", "scan.gz", "scan.mha", ".nrrd", "none/scan.nrrd"])
def test_files_that_are_refused(tmp_path, name):
    with pytest.raises(FileError, match=r"cannot write.*(use one of: \.nii\.gz, \.nii, \.nrrd|folder does not exist)"):
        VOLUMES["unknown"].save(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_open_takes_what_other_libraries_hold() -> None:
    image = nibabel.Nifti1Image(np.arange(24, dtype=np.int16).reshape(2, 3, 4), np.diag([2.0, 3.0, 4.0, 1.0]))
    same(ws.open(image), ws.Volume(image))
    with pytest.raises(ws.errors.ArgumentError, match="level say how files are read, and path is a Nifti1Image"):
        ws.open(image, level=1)
    with pytest.raises(ws.errors.ArgumentError, match="path is 3"):
        ws.open(3)
