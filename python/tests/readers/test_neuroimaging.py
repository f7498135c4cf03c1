"""FreeSurfer, MINC, AFNI, PAR/REC and ECAT files have the affine and the samples that nibabel has; RGB has colours."""

import gc
import shutil
import warnings
from pathlib import Path

import h5py
import nibabel
import numpy as np
import pytest
import scipy.io

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

#: Files of nibabel's own tests, which its wheel brings.
DATA = Path(nibabel.__file__).parent / "tests" / "data"
#: File -> number of time points, their distance and its unit.
FILES = {
    "minc1_1_scale.mnc": (1, None, None),
    "minc1_4d.mnc": (2, 2.0, "s"),
    "minc1-no-att.mnc": (1, None, None),
    "minc2_1_scale.mnc": (1, None, None),
    "minc2_4d.mnc": (2, 2.0, "s"),
    "minc2-4d-d.mnc": (5, 1.0, "s"),
    "minc2_baddim.mnc": (1, None, None),
    "small.mnc": (1, None, None),
    "example4d+orig.HEAD": (3, 3.0, "s"),
    "example4d+orig.BRIK.gz": (3, 3.0, "s"),
    "scaled+tlrc.BRIK": (1, None, None),
    "phantom_EPI_asc_CLEAR_2_1.PAR": (3, 2.0, "s"),
    "phantom_varscale.REC": (3, 2.0, "s"),
    "tinypet.v": (1, None, None),
    "test.mgz": (2, 2.0, "ms"),
}


def _by_nibabel(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # nibabel leaves files open, and takes "xspace" for a spacing
        image = nibabel.ecat.load(path) if path.suffix == ".v" else nibabel.load(path)
        samples = np.asarray(image.dataobj)
        affine = image.affine
        del image
        gc.collect()
    if samples.ndim == 3:
        samples = samples[..., None]
    elif path.suffix == ".mnc":
        samples = np.moveaxis(samples, 0, -1)
    return affine, samples


@pytest.mark.parametrize("name", FILES)
def test_affine_samples_and_times_are_those_of_nibabel_fault_5(name):
    affine, samples = _by_nibabel(DATA / name)
    n_times, step, unit = FILES[name]
    series = ws.open_series(DATA / name)
    assert len(series) == n_times == samples.shape[-1]
    assert series[0].modality == ("MR" if name.endswith((".PAR", ".REC")) else None)
    for number in range(n_times):
        volume = series[number]
        np.testing.assert_allclose(volume.world_from_index, affine, atol=1e-6)
        # Samples that nibabel scales to float64 are float32 here.
        np.testing.assert_allclose(volume.samples.T, samples[..., number], rtol=1e-6)
        assert (volume.unit, volume.is_anatomical) == ("mm", True)
        assert (volume.facts.n_times, volume.facts.time_step, volume.facts.time_unit) == (n_times, step, unit)


@pytest.mark.parametrize("name", ["a.mgz", "a.mgh"])
def test_freesurfer_lies_where_nibabel_says_fault_4(tmp_path, name):
    affine = np.array([[-1.0, 0, 0, 128], [0, 0, 1, -100], [0, -1, 0, 90], [0, 0, 0, 1]])
    samples = np.arange(960, dtype=np.int16).reshape(8, 10, 12)
    nibabel.save(nibabel.MGHImage(samples, affine), tmp_path / name)
    volume = ws.open(tmp_path / name)
    np.testing.assert_allclose(volume.world_from_index, affine)
    np.testing.assert_array_equal(volume.samples.T, samples)
    assert (volume.orientation, volume.is_anatomical) == ("LIA", True)


def test_the_same_brain_in_mgh_and_nifti_is_the_same_picture_fault_4(tmp_path):
    affine = np.array([[-2.0, 0, 0, 20], [0, 0, 2, -20], [0, -2, 0, 20], [0, 0, 0, 1]])
    x, y, z = np.mgrid[-10:11, -10:11, -10:11]
    brain = (200 * np.exp(-(x**2 + 2 * y**2 + (z - 3) ** 2) / 40)).astype(np.int16)
    nibabel.save(nibabel.MGHImage(brain, affine), tmp_path / "a.mgz")
    nibabel.save(nibabel.Nifti1Image(brain, affine), tmp_path / "a.nii")
    pictures = [ws.render(ws.open(tmp_path / name), size=(48, 48)).rgba for name in ("a.mgz", "a.nii")]
    np.testing.assert_array_equal(*pictures)


def test_what_nibabel_does_not_read_is_refused_in_a_sentence(tmp_path):
    with pytest.raises(FileError, match=r"PAR/REC: Header inconsistency: Found 3 dynamic.*truncated\.PAR"):
        ws.open(DATA / "phantom_truncated.PAR")
    shutil.copy(DATA / "phantom_fake_v4.PAR", tmp_path / "a.PAR")
    with pytest.raises(FileError, match=r"cannot read as PAR/REC: .*it is not there; check the name: .*a\.PAR"):
        ws.open(tmp_path / "a.PAR")
    shutil.copy(DATA / "minc2_1_scale.mnc", tmp_path / "a.h5")
    with pytest.raises(FileError, match=r"a MINC image; give it a name that ends in \.mnc: .*a\.h5"):
        ws.open(tmp_path / "a.h5")
    (tmp_path / "a.mif").write_bytes(b"mrtrix image\n")
    with pytest.raises(FileError, match=r"an image of MRtrix.*mrconvert"):
        ws.open(tmp_path / "a.mif")


def test_vectors_of_minc_have_a_route(tmp_path):
    with scipy.io.netcdf_file(tmp_path / "a.mnc", "w") as file:
        for axis, n in (("zspace", 2), ("yspace", 3), ("xspace", 4), ("vector_dimension", 3)):
            file.createDimension(axis, n)
        for axis in ("zspace", "yspace", "xspace"):
            made = file.createVariable(axis, "i4", ())
            made.step, made.start = 1.0, 0.0
        image = file.createVariable("image", "f4", ("zspace", "yspace", "xspace", "vector_dimension"))
        image[:], image.signtype = 0, "signed__"
    with pytest.raises(FileError, match=r"holds vectors \(vector_dimension\).*isel\(vector_dimension=0\)"):
        ws.open(tmp_path / "a.mnc")


def _vectors_of_minc_2(path, stored, largest, order="vector_dimension,zspace,yspace,xspace"):
    """A file of vectors whose real numbers are 0 to `largest` for bytes of 0 to 255."""
    with h5py.File(path, "w") as file:
        root = file.create_group("minc-2.0")
        for axis in order.split(","):
            made = root.create_dataset(f"dimensions/{axis}", data=0)
            made.attrs.update({"start": 5.0, "step": 2.0} if axis.endswith("space") else {})
        image = root.create_dataset("image/0/image", data=stored)
        image.attrs.update({"dimorder": np.bytes_(order), "valid_range": [0.0, 255.0]})
        for end, value in (("image-min", 0.0), ("image-max", largest)):
            root.create_dataset(f"image/0/{end}", data=value)


def test_vectors_of_minc_2_are_no_times(tmp_path):
    stored = np.random.default_rng(1).integers(0, 256, (3, 4, 5, 6), np.uint8)
    _vectors_of_minc_2(tmp_path / "a.mnc", stored, 51.0)
    drawn, along_y = ws.open(tmp_path / "a.mnc"), ws.open(tmp_path / "a.mnc", component="y")
    vectors = stored / 5.0  # axes z, y, x of the file are those of the volume's index
    np.testing.assert_allclose(drawn.samples.T, np.sqrt((vectors**2).sum(0)), rtol=1e-5)
    np.testing.assert_allclose(along_y.samples.T, vectors[1], rtol=1e-6)
    assert (drawn.facts.n_times, drawn.facts.channels, drawn.orientation) == (1, (), "SAR")


def test_colours_of_minc_2_are_channels_whatever_the_order_of_axes(tmp_path):
    stored = np.random.default_rng(1).integers(0, 256, (4, 5, 6, 3), np.uint8)
    _vectors_of_minc_2(tmp_path / "a.mnc", stored, 255.0, "zspace,yspace,xspace,vector_dimension")
    green = ws.open(tmp_path / "a.mnc", channel=1)
    np.testing.assert_array_equal(green.samples.T, stored[..., 1])
    assert (green.dtype, green.facts.channel.name) == (np.uint8, "green")
    with pytest.raises(FileError, match=r"3 channels; choose one"):
        ws.open(tmp_path / "a.mnc")


def test_afni_without_a_matrix_lies_where_its_directions_say(tmp_path):
    text = (DATA / "example4d+orig.HEAD").read_text()
    parts = text.split("\n\n")
    kept = [part for part in parts if "IJK_TO_DICOM" not in part]
    assert len(kept) < len(parts)
    (tmp_path / "example4d+orig.HEAD").write_text("\n\n".join(kept))
    shutil.copy(DATA / "example4d+orig.BRIK.gz", tmp_path)
    affine, samples = _by_nibabel(DATA / "example4d+orig.HEAD")
    volume = ws.open(tmp_path / "example4d+orig.HEAD", time=1)
    np.testing.assert_allclose(volume.world_from_index, affine, atol=1e-4)
    np.testing.assert_array_equal(volume.samples.T, samples[..., 1])


def test_minc_in_memory_has_its_times_first():
    image = nibabel.load(DATA / "minc2_4d.mnc")
    with pytest.raises(ArgumentError, match=r"4-D, shape \(2, 10, 20, 20\) \(time, \.\.\.\)"):
        ws.Volume(image)
    np.testing.assert_allclose(ws.Volume(nibabel.load(DATA / "minc2_1_scale.mnc")).samples.min(), 0.208284, rtol=1e-5)


@pytest.mark.parametrize("color", [(255, 0, 0), (0, 255, 0), (0, 0, 255), (200, 100, 50)])
@pytest.mark.parametrize("parts", ["RGB", "RGBA"])
def test_nifti_has_its_colours_fault_6(tmp_path, color, parts):
    samples = np.zeros((16, 16, 16), [(part, "u1") for part in parts])
    for part, share in zip("RGB", color, strict=True):
        samples[part][4:12, 4:12, 4:12] = share
    nibabel.save(nibabel.Nifti1Image(samples, np.eye(4)), tmp_path / "a.nii")
    scene = ws.open_scene(tmp_path / "a.nii")
    assert [layer.name for layer in scene.layers] == ["red", "green", "blue", "alpha"][: len(parts)]
    assert [layer.visible for layer in scene.layers[3:]] == [False] * (len(parts) - 3)
    drawn = np.asarray(scene.render(size=(32, 32)))[16, 16, :3].astype(int)
    assert np.argsort(drawn)[::-1][0] == np.argmax(color)
    # The order of the shares is kept, and what is 0 is far below what is largest.
    for one in range(3):
        for other in range(3):
            if color[one] > color[other]:
                assert drawn[one] > drawn[other] + 20


def test_minc_leads_to_no_other_file_unless_allowed(tmp_path):
    import h5py

    shutil.copy(DATA / "minc2_1_scale.mnc", tmp_path / "there.mnc")
    with h5py.File(tmp_path / "a.mnc", "w") as file:
        file["minc-2.0"] = h5py.ExternalLink("there.mnc", "minc-2.0")
    with pytest.raises(FileError, match=r"names 'there\.mnc' as the place of 'minc-2\.0'; if you trust it.*a\.mnc"):
        ws.open(tmp_path / "a.mnc")
    assert ws.open(tmp_path / "a.mnc", external_files=True).shape == (20, 20, 10)
