"""Every format, written by its own library and read back: samples, type, and place in the RAS world."""

from __future__ import annotations

import gzip

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError


def check(volume, samples, world_from_index, *, atol=1e-4):
    np.testing.assert_array_equal(volume.samples, samples)
    assert volume.dtype == samples.dtype.newbyteorder("=")
    np.testing.assert_allclose(volume.world_from_index, world_from_index, atol=atol)


# NIfTI ----------------------------------------------------------------------------------------------------------------


def save_nifti(path, samples, affine, *, slope=None, intercept=0.0, big_endian=False, units="mm", version=1):
    import nibabel

    kind = nibabel.Nifti1Image if version == 1 else nibabel.Nifti2Image
    header = kind.header_class(endianness=">" if big_endian else "<")
    header.set_data_dtype(samples.dtype)
    image = kind(samples.transpose(*range(samples.ndim)[::-1]), affine, header)
    image.header.set_xyzt_units(units)
    nibabel.save(image, path)
    if slope is not None:
        # nibabel would divide by the slope on writing, but these are the stored samples. NIfTI-1: bytes 112 to 120.
        content = bytearray(path.read_bytes())
        content[112:120] = np.array([slope, intercept], "<f4").tobytes()
        path.write_bytes(content)
    return path


@pytest.mark.parametrize(("suffix", "version"), [(".nii", 1), (".nii.gz", 1), (".img", 1), (".nii", 2), (".nii.gz", 2)])
def test_nifti(tmp_path, oblique, suffix, version):
    path = save_nifti(tmp_path / f"a{suffix}", oblique.samples, oblique.world_from_index, version=version)
    check(ws.open(path), oblique.samples, oblique.world_from_index)


@pytest.mark.parametrize("dtype", [np.uint8, np.int8, np.uint16, np.int32, np.uint32, np.float32, np.float64])
def test_nifti_keeps_the_type(tmp_path, oblique, dtype):
    samples = (np.abs(oblique.samples) % 100).astype(dtype)
    check(ws.open(save_nifti(tmp_path / "a.nii", samples, oblique.world_from_index)), samples, oblique.world_from_index)


@pytest.mark.parametrize(
    ("code", "scale", "unit", "told"),
    [
        (1 | 16, 1000, "ms", ""),
        (3 | 24, 0.001, "us", ""),
        (2 | 40, 1, None, "its steps are 2 ppm"),
        (5 | 8, 1, "s", "the file's unit has code 5, which NIfTI has not"),
        (2 | 56, 1, None, "its unit has code 56"),
    ],
)
def test_nifti_units_that_are_no_times_or_unknown_are_said(tmp_path, code, scale, unit, told):
    import nibabel

    image = nibabel.Nifti1Image(np.zeros((4, 5, 6, 3), np.int16), np.eye(4))
    image.header.set_zooms((1, 1, 1, 2))
    nibabel.save(image, tmp_path / "a.nii")
    content = bytearray((tmp_path / "a.nii").read_bytes())
    content[123] = code  # xyzt_units
    (tmp_path / "a.nii").write_bytes(content)
    facts = ws.open(tmp_path / "a.nii", time=0).facts
    assert (facts.unit, facts.time_unit, facts.time_step) == ("mm", unit, 2 if unit else None)
    assert ws.open(tmp_path / "a.nii", time=0).spacing == (scale,) * 3
    assert len(facts.guesses) == bool(told)
    assert told in "".join(facts.guesses)


def test_nifti_big_endian(tmp_path, oblique):
    path = save_nifti(tmp_path / "a.nii", oblique.samples, oblique.world_from_index, big_endian=True)
    check(ws.open(path), oblique.samples, oblique.world_from_index)


@pytest.mark.parametrize("suffix", [".nii", ".nii.gz"])
@pytest.mark.parametrize("version", [1, 2])
def test_nifti_samples_that_begin_in_the_header_begin_behind_it(tmp_path, oblique, suffix, version):
    """An offset of 0 is written by programs that leave the field out; nibabel gives the header as samples."""
    at, first = {1: (108, 352), 2: (168, 544)}[version]
    path = save_nifti(tmp_path / "a.nii", oblique.samples, oblique.world_from_index, version=version)
    header = bytearray(path.read_bytes())
    header[at : at + (4 if version == 1 else 8)] = bytes(4 if version == 1 else 8)
    path = tmp_path / f"b{suffix}"
    path.write_bytes(gzip.compress(header) if suffix.endswith("gz") else header)
    volume = ws.open(path)
    check(volume, oblique.samples, oblique.world_from_index)
    assert f"samples from byte {first} on: the file says byte 0, where its header is" in volume.facts.guesses
    # Extensions lie there, and their length is not given.
    header[first - 4] = 1
    header[first:first] = (16).to_bytes(4, "little") + (6).to_bytes(4, "little") + bytes(8)
    path.write_bytes(gzip.compress(header) if suffix.endswith("gz") else header)
    with pytest.raises(FileError, match="extensions of unknown length.*write the file's vox_offset"):
        ws.open(path)
    for wrong in (1, 100, first - 1, -1):
        header[at : at + (4 if version == 1 else 8)] = np.array(wrong, "<f4" if version == 1 else "<i8").tobytes()
        path.write_bytes(gzip.compress(header) if suffix.endswith("gz") else header)
        with pytest.raises(FileError, match=f"begin at byte {wrong}, where it is itself; .* {first} or more"):
            ws.open(path)


def test_nifti_keeps_shear(tmp_path, oblique):
    sheared = oblique.world_from_index @ np.array([[1, 0, 0, 0], [0, 1, 0.4, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    check(ws.open(save_nifti(tmp_path / "a.nii", oblique.samples, sheared)), oblique.samples, sheared)


def test_nifti_without_orientation_is_spacing_only(tmp_path, oblique):
    import nibabel

    image = nibabel.Nifti1Image(oblique.samples.T, None)
    image.header.set_zooms((0.7, 0.8, 1.5))
    nibabel.save(image, tmp_path / "a.nii")
    check(ws.open(tmp_path / "a.nii"), oblique.samples, np.diag([0.7, 0.8, 1.5, 1]))


@pytest.mark.parametrize(("units", "factor"), [("micron", 0.001), ("meter", 1000.0)])
def test_nifti_units_become_millimetres(tmp_path, oblique, units, factor):
    path = save_nifti(tmp_path / "a.nii", oblique.samples, oblique.world_from_index, units=units)
    expected = oblique.world_from_index.copy()
    expected[:3] *= factor
    check(ws.open(path), oblique.samples, expected, atol=1e-3 * factor)


@pytest.mark.parametrize(
    ("slope", "intercept", "dtype"),
    [(1, -1024, np.int16), (100, 7, np.int32), (0.5, 0, np.float32), (1, 0.25, np.float32)],
)
def test_nifti_scaling_keeps_integers_where_nothing_is_lost(tmp_path, oblique, slope, intercept, dtype):
    path = save_nifti(tmp_path / "a.nii", oblique.samples, np.eye(4), slope=slope, intercept=intercept)
    check(ws.open(path), (oblique.samples * np.float64(slope) + intercept).astype(dtype), np.eye(4))


def test_nifti_time_points(tmp_path, oblique):
    stack = np.stack([oblique.samples, oblique.samples + 1, oblique.samples + 2])
    path = save_nifti(tmp_path / "a.nii.gz", stack, oblique.world_from_index)
    check(ws.open(path, time=2), stack[2], oblique.world_from_index)
    with pytest.raises(FileError, match=r"3 time points.*time=0..2.*--time.*a.nii.gz$"):
        ws.open(path)
    with pytest.raises(ArgumentError, match="time=3, but the file holds 3"):
        ws.open(path, time=3)


def test_nifti_single_time_point_is_squeezed(tmp_path, oblique):
    path = save_nifti(tmp_path / "a.nii", oblique.samples[None], oblique.world_from_index)
    check(ws.open(path), oblique.samples, oblique.world_from_index)


def test_nifti_colours_are_channels(tmp_path):
    import nibabel

    rgb = np.zeros((2, 3, 4), [("R", "u1"), ("G", "u1"), ("B", "u1")])
    rgb["G"] = np.arange(24).reshape(2, 3, 4)
    nibabel.save(nibabel.Nifti1Image(rgb.T, np.eye(4)), tmp_path / "a.nii")
    check(ws.open(tmp_path / "a.nii", channel=1), rgb["G"], np.eye(4))
    with pytest.raises(FileError, match="3 channels"):
        ws.open(tmp_path / "a.nii")


# ITK ------------------------------------------------------------------------------------------------------------------


def itk_image(samples, lps_from_index, **options):
    import SimpleITK

    image = SimpleITK.GetImageFromArray(samples, **options)
    steps = lps_from_index[:3, :3]
    spacing = np.linalg.norm(steps, axis=0)
    image.SetSpacing(spacing.tolist())
    image.SetDirection((steps / spacing).ravel().tolist())
    image.SetOrigin(lps_from_index[:3, 3].tolist())
    return image


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("suffix", [".nrrd", ".nhdr", ".mha", ".mhd"])
@pytest.mark.every_pair
def test_itk_formats(tmp_path, oblique, suffix, compressed):
    import SimpleITK

    path = tmp_path / f"a{suffix}"
    SimpleITK.WriteImage(itk_image(oblique.samples, oblique.lps_from_index), str(path), useCompression=compressed)
    check(ws.open(path), oblique.samples, oblique.world_from_index)


def test_the_same_volume_in_two_worlds(tmp_path, oblique):
    """A NIfTI file that ITK wrote (LPS inside ITK, RAS in the file) lies where its NRRD twin lies."""
    import SimpleITK

    image = itk_image(oblique.samples, oblique.lps_from_index)
    for name in ("a.nii.gz", "a.nrrd"):
        SimpleITK.WriteImage(image, str(tmp_path / name))
    nifti, nrrd = ws.open(tmp_path / "a.nii.gz"), ws.open(tmp_path / "a.nrrd")
    np.testing.assert_allclose(nifti.world_from_index, nrrd.world_from_index, atol=1e-4)


def test_nrrd_without_a_space_keeps_its_axes(tmp_path, oblique):
    head = "NRRD0004\ntype: short\ndimension: 3\nsizes: 7 6 5\nspacings: 0.7 0.8 1.5\nendian: little\nencoding: raw\n\n"
    path = tmp_path / "a.nrrd"
    path.write_bytes(head.encode() + oblique.samples.astype("<i2").tobytes())
    check(ws.open(path), oblique.samples, np.diag([0.7, 0.8, 1.5, 1]))


def test_metaimage_channels(tmp_path, oblique):
    import SimpleITK

    pairs = np.stack([oblique.samples, -oblique.samples], axis=-1)
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(pairs, isVector=True), str(tmp_path / "a.mha"))
    np.testing.assert_array_equal(ws.open(tmp_path / "a.mha", channel=1).samples, -oblique.samples)
    with pytest.raises(FileError, match="2 channels"):
        ws.open(tmp_path / "a.mha")


def test_metaimage_time_points(tmp_path, oblique):
    import SimpleITK

    stack = np.stack([oblique.samples, oblique.samples + 1])
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(stack, isVector=False), str(tmp_path / "a.mha"))
    np.testing.assert_array_equal(ws.open(tmp_path / "a.mha", time=1).samples, stack[1])
    with pytest.raises(FileError, match="2 time points"):
        ws.open(tmp_path / "a.mha")


# DICOM ----------------------------------------------------------------------------------------------------------------


def save_dicom(folder, samples, lps_from_index, *, series="1.2.3", first=0, names=None, slope="1"):
    """Write a file per slice, at the positions that the affine gives, shear included."""
    import SimpleITK

    folder.mkdir(exist_ok=True)
    writer = SimpleITK.ImageFileWriter()
    writer.KeepOriginalImageUIDOn()
    x, y = (lps_from_index[:3, axis] / np.linalg.norm(lps_from_index[:3, axis]) for axis in (0, 1))
    for number, pixels in enumerate(samples):
        image = SimpleITK.GetImageFromArray(pixels[None])
        step = np.linalg.norm(lps_from_index[:3, :2], axis=0)
        image.SetSpacing([*step.tolist(), 1.0])
        place = lps_from_index @ [0, 0, number, 1]
        tags = {
            "0008|0060": "CT",
            "0008|0018": f"{series}.{first + number + 1}",
            "0020|000e": series,
            "0020|000d": "1.2.3.9",
            "0020|0013": str(first + number),
            "0028|1052": "0",
            "0028|1053": slope,
            "0020|0032": "\\".join(f"{value:.6f}" for value in place[:3]),
            "0020|0037": "\\".join(f"{value:.8f}" for value in (*x, *y)),
        }
        for tag, value in tags.items():
            image.SetMetaData(tag, value)
        writer.SetFileName(str(folder / (names[number] if names else f"{first + number:03}.dcm")))
        writer.Execute(image)
    return folder


def test_dicom_series_in_any_file_order(tmp_path, oblique):
    names = ["e.dcm", "a.dcm", "d.dcm", "b.dcm", "c.dcm"]
    folder = save_dicom(tmp_path / "ct", oblique.samples, oblique.lps_from_index, names=names)
    check(ws.open(folder), oblique.samples, oblique.world_from_index)
    check(ws.open(folder / "d.dcm"), oblique.samples, oblique.world_from_index)


def test_dicom_gantry_tilt_is_kept(tmp_path, oblique):
    tilted = oblique.lps_from_index @ np.array([[1, 0, 0, 0], [0, 1, 0.5, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    folder = save_dicom(tmp_path / "ct", oblique.samples, tilted)
    check(ws.open(folder), oblique.samples, np.diag([-1, -1, 1, 1]) @ tilted)


def test_dicom_gaps_are_named_where_they_are_refused(tmp_path, oblique):
    folder = save_dicom(tmp_path / "ct", oblique.samples, oblique.lps_from_index)
    (folder / "002.dcm").unlink()
    with pytest.raises(FileError, match=r"1.5 mm \(2x\), 3 mm \(1x\); 3 mm lie between 001.dcm and 003.dcm.*ct$"):
        ws.open(folder, gaps="refuse")
    assert ws.open(folder, spacing=(0.7, 0.8, 1.5)).shape == (4, 6, 7)
    with pytest.raises(ArgumentError, match="gaps is 'leave'"):
        ws.open(folder, gaps="leave")


def test_dicom_several_series(tmp_path, oblique):
    folder = save_dicom(tmp_path / "ct", oblique.samples, oblique.lps_from_index, series="1.2.3")
    save_dicom(folder, oblique.samples + 5, oblique.lps_from_index, series="1.2.4", first=10)
    with pytest.raises(FileError, match=r"2 series.*--series.*1.2.3 \(5 files\), CT 1.2.4 \(5 files\)"):
        ws.open(folder)
    check(ws.open(folder, series="1.2.4"), oblique.samples + np.int16(5), oblique.world_from_index)
    with pytest.raises(ArgumentError, match="no series '1.2.5'"):
        ws.open(folder, series="1.2.5")


def test_dicom_time_points(tmp_path, oblique):
    folder = save_dicom(tmp_path / "ct", oblique.samples, oblique.lps_from_index)
    save_dicom(folder, oblique.samples + 5, oblique.lps_from_index, first=10)
    with pytest.raises(FileError, match="2 time points"):
        ws.open(folder)
    check(ws.open(folder, time=1), oblique.samples + np.int16(5), oblique.world_from_index)


def test_dicom_doubled_slice(tmp_path, oblique):
    folder = save_dicom(tmp_path / "ct", oblique.samples, oblique.lps_from_index)
    save_dicom(folder, oblique.samples[:1], oblique.lps_from_index, first=10)
    with pytest.raises(FileError, match="2 slices at position.*missing or doubled"):
        ws.open(folder)


def test_dicom_single_slice_is_no_volume(tmp_path, oblique):
    folder = save_dicom(tmp_path / "ct", oblique.samples[:1], oblique.lps_from_index)
    with pytest.raises(FileError, match="single plane"):
        ws.open(folder)


def test_dicom_fractional_slope_becomes_float32(tmp_path, oblique):
    folder = save_dicom(tmp_path / "ct", oblique.samples * np.int16(2), oblique.lps_from_index, slope="2")
    tag = b"\x28\x00\x53\x10\x02\x00\x00\x00"  # RescaleSlope, two characters; GDCM refuses to write a fraction
    for file in folder.iterdir():
        content = file.read_bytes()
        assert tag + b"2 " in content
        file.write_bytes(content.replace(tag + b"2 ", tag + b".5"))
    check(ws.open(folder), oblique.samples * np.float32(0.5), oblique.world_from_index)


# TIFF -----------------------------------------------------------------------------------------------------------------


def test_tiff_pages(tmp_path):
    import tifffile

    samples = np.arange(5 * 6 * 7, dtype=np.uint16).reshape(5, 6, 7)
    tifffile.imwrite(tmp_path / "a.tif", samples, photometric="minisblack", compression="zlib")
    check(ws.open(tmp_path / "a.tif"), samples, np.eye(4))


@pytest.mark.parametrize("axes", ["ZYX", "TZYX", "ZCYX", "TZCYX"])
def test_tiff_of_imagej(tmp_path, axes):
    import tifffile

    shape = [{"T": 2, "Z": 5, "C": 3, "Y": 6, "X": 7}[name] for name in axes]
    samples = np.arange(np.prod(shape), dtype=np.uint16).reshape(shape)
    path = tmp_path / "a.tif"
    tifffile.imwrite(
        path,
        samples,
        imagej=True,
        resolution=(1 / 0.25, 1 / 0.5),
        metadata={"axes": axes, "spacing": 2.0, "unit": "um"},
    )
    options = {"time": 1} if "T" in axes else {}
    options |= {"channel": 2} if "C" in axes else {}
    index = tuple({"T": 1, "C": 2}.get(name, slice(None)) for name in axes)
    check(ws.open(path, **options), samples[index], np.diag([0.25, 0.5, 2, 1]))
    if options:
        with pytest.raises(FileError, match="time points|channels"):
            ws.open(path)


def test_tiff_of_ome(tmp_path):
    import tifffile

    samples = np.arange(2 * 5 * 6 * 7, dtype=np.float32).reshape(2, 5, 6, 7)
    metadata = {
        "axes": "CZYX",
        "PhysicalSizeX": 250,
        "PhysicalSizeXUnit": "nm",
        "PhysicalSizeY": 0.5,
        "PhysicalSizeZ": 2,
        "PhysicalSizeZUnit": "µm",
    }
    tifffile.imwrite(tmp_path / "a.ome.tif", samples, metadata=metadata)
    check(ws.open(tmp_path / "a.ome.tif", channel=1), samples[1], np.diag([250, 500, 2000, 1]))


def test_tiff_folder_in_natural_order(tmp_path):
    import tifffile

    samples = np.arange(12 * 3 * 4, dtype=np.uint8).reshape(12, 3, 4)
    for number, pixels in enumerate(samples):
        tifffile.imwrite(tmp_path / f"slice{number}.tif", pixels)
    check(ws.open(tmp_path, spacing=(1, 2, 3)), samples, np.diag([1, 2, 3, 1]))
    tifffile.imwrite(tmp_path / "slice5.tif", np.zeros((3, 5), np.uint8))
    with pytest.raises(FileError, match=r"slices differ.*slice5.tif is \(3, 5\)"):
        ws.open(tmp_path)


# Plain arrays ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("dtype", ["<i2", ">f4", "|u1", "|b1"])
def test_npy(tmp_path, oblique, dtype):
    samples = oblique.samples.astype(dtype)
    np.save(tmp_path / "a.npy", samples)
    np.testing.assert_array_equal(ws.open(tmp_path / "a.npy").samples, samples)
    np.save(tmp_path / "f.npy", np.asfortranarray(samples))
    np.testing.assert_array_equal(ws.open(tmp_path / "f.npy", spacing=(1, 2, 3)).samples, samples)


def test_npy_of_four_axes(tmp_path, oblique):
    stack = np.stack([oblique.samples, oblique.samples + 1])
    np.save(tmp_path / "a.npy", stack)
    check(ws.open(tmp_path / "a.npy", time=1), stack[1], np.eye(4))
    check(ws.open(tmp_path / "a.npy", channel=6), np.ascontiguousarray(stack[..., 6]), np.eye(4))
    with pytest.raises(FileError, match=r"4-D.*time=0..1 \(first axis\) or channel=0..6"):
        ws.open(tmp_path / "a.npy")


def test_npz(tmp_path, oblique):
    np.savez(tmp_path / "one.npz", a=oblique.samples)
    check(ws.open(tmp_path / "one.npz"), oblique.samples, np.eye(4))
    np.savez_compressed(tmp_path / "two.npz", a=oblique.samples, b=oblique.samples + 1)
    check(ws.open(tmp_path / "two.npz", dataset="b"), oblique.samples + np.int16(1), np.eye(4))
    with pytest.raises(FileError, match=r"2 arrays \(a, b\); choose one with dataset="):
        ws.open(tmp_path / "two.npz")
    with pytest.raises(ArgumentError, match="no array 'c'"):
        ws.open(tmp_path / "two.npz", dataset="c")


@pytest.mark.parametrize("byte_order", ["little", "big"])
def test_raw(tmp_path, oblique, byte_order):
    stored = oblique.samples.astype("<i2" if byte_order == "little" else ">i2")
    (tmp_path / "a.raw").write_bytes(b"head" + stored.tobytes())
    options = {"shape": (5, 6, 7), "dtype": "int16", "byte_order": byte_order, "offset": 4, "spacing": (1, 2, 3)}
    check(ws.open(tmp_path / "a.raw", **options), oblique.samples, np.diag([1, 2, 3, 1]))


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({}, ArgumentError, r"need shape=\(z, y, x\) and dtype="),
        ({"shape": (5, 6, 7)}, ArgumentError, "need dtype="),
        ({"shape": (5, 6), "dtype": "int16"}, ArgumentError, "three positive numbers"),
        ({"shape": (5, 6, 0), "dtype": "int16"}, ArgumentError, "three positive numbers"),
        ({"shape": (5, 6, 7), "dtype": "short16"}, ArgumentError, "dtype is 'short16'"),
        ({"shape": (5, 6, 8), "dtype": "int16"}, FileError, "need 480 bytes, the file holds 420"),
        ({"shape": (5, 6, 6), "dtype": "int16"}, FileError, "needs 360 bytes.*offset=60 to skip a header"),
        ({"shape": (5, 6, 7), "dtype": "int16", "byte_order": "middle"}, ArgumentError, "byte_order is 'middle'"),
        ({"shape": (5, 6, 7), "dtype": "int16", "offset": -1}, ArgumentError, "offset=-1"),
        ({"shape": (10**6, 10**6, 10**6), "dtype": "int16"}, FileError, "the file holds 420"),
    ],
)
def test_raw_errors(tmp_path, oblique, options, error, message):
    (tmp_path / "a.raw").write_bytes(oblique.samples.tobytes())
    with pytest.raises(error, match=message):
        ws.open(tmp_path / "a.raw", **options)


# HDF5 and Zarr --------------------------------------------------------------------------------------------------------


def test_hdf5(tmp_path, oblique):
    import h5py

    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["t"] = np.arange(3)
        raw = file.create_dataset("group/raw", data=oblique.samples, chunks=True, compression="gzip")
        raw.attrs["element_size_um"] = (3.0, 2.0, 1.0)
    check(ws.open(path), oblique.samples, np.diag([1, 2, 3, 1]))
    with h5py.File(path, "a") as file:
        file["movie"] = np.stack([oblique.samples, oblique.samples + 1])
    check(ws.open(path, dataset="movie", time=1), oblique.samples + np.int16(1), np.eye(4))
    with pytest.raises(FileError, match=r"2 datasets.*group/raw \(5, 6, 7\), movie"):
        ws.open(path)
    with pytest.raises(ArgumentError, match="no dataset 'ra'.*group/raw"):
        ws.open(path, dataset="ra")


def ome_attributes(version, axes, datasets, **more):
    multiscales = {"axes": [{"name": name} for name in axes], "datasets": datasets, **more}
    return (
        {"multiscales": [multiscales]}
        if version == "0.4"
        else {"ome": {"version": version, "multiscales": [multiscales]}}
    )


@pytest.mark.parametrize("version", ["0.4", "0.5"])
@pytest.mark.parametrize("axes", ["zyx", "czyx", "tczyx", "xyz"])
@pytest.mark.every_pair
def test_ome_zarr(tmp_path, version, axes):
    import zarr

    shape = tuple({"t": 2, "c": 3, "z": 5, "y": 6, "x": 7}[name] for name in axes)
    samples = np.arange(np.prod(shape), dtype=np.uint16).reshape(shape)
    group = zarr.open_group(tmp_path / "a.zarr", mode="w", zarr_format=2 if version == "0.4" else 3)
    group.create_array("0", data=samples, chunks=tuple(min(n, 4) for n in shape))
    group.create_array("1", data=samples[..., ::2, ::2, ::2])
    scale = [{"z": 2.0, "y": 0.5, "x": 0.25}.get(name, 1.0) for name in axes]
    move = [{"z": 3.0, "y": 2.0, "x": 1.0}.get(name, 0.0) for name in axes]
    steps = [{"type": "scale", "scale": scale}, {"type": "translation", "translation": move}]
    coarse = [{"type": "scale", "scale": [2 * s for s in scale]}]
    datasets = [
        {"path": "0", "coordinateTransformations": steps},
        {"path": "1", "coordinateTransformations": coarse},
    ]
    group.attrs.update(ome_attributes(version, axes, datasets))

    options = {name: 1 for name, letter in (("time", "t"), ("channel", "c")) if letter in axes}
    one = samples[tuple(1 if name in "tc" else slice(None) for name in axes)]
    expected = np.diag([0.25, 0.5, 2, 1])
    expected[:3, 3] = 1, 2, 3
    check(ws.open(tmp_path / "a.zarr", **options), np.ascontiguousarray(one.T if axes == "xyz" else one), expected)
    assert ws.open(tmp_path / "a.zarr", level=1, **options).spacing == (0.5, 1, 4)
    with pytest.raises(ArgumentError, match="level=2, but there are 2 levels"):
        ws.open(tmp_path / "a.zarr", level=2, **options)
    if options:
        with pytest.raises(FileError, match="time points|channels"):
            ws.open(tmp_path / "a.zarr")


def test_ome_zarr_rotation(tmp_path):
    import zarr

    samples = np.arange(5 * 6 * 7, dtype=np.uint8).reshape(5, 6, 7)
    group = zarr.open_group(tmp_path / "a.zarr", mode="w")
    group.create_array("0", data=samples)
    steps = [{"type": "sequence", "transformations": [{"type": "scale", "scale": [3, 2, 1]}, {"type": "identity"}]}]
    turn = [{"type": "affine", "affine": [[0, -1, 0, 7], [1, 0, 0, 8], [0, 0, 1, 9]]}]  # rows and columns z, y, x
    datasets = [{"path": "0", "coordinateTransformations": steps}]
    group.attrs.update(ome_attributes("0.6", "zyx", datasets, coordinateTransformations=turn))
    # World z = -2 y + 7, world y = 3 z + 8, world x = x + 9.
    expected = [[1, 0, 0, 9], [0, 0, 3, 8], [0, -2, 0, 7], [0, 0, 0, 1]]
    check(ws.open(tmp_path / "a.zarr"), samples, expected)


def test_plain_zarr(tmp_path, oblique):
    import zarr

    group = zarr.open_group(tmp_path / "a.zarr", mode="w")
    group.create_array("raw", data=oblique.samples)
    check(ws.open(tmp_path / "a.zarr", dataset="raw"), oblique.samples, np.eye(4))
    check(ws.open(tmp_path / "a.zarr" / "raw"), oblique.samples, np.eye(4))
    with pytest.raises(FileError, match=r"choose an array with dataset=.*raw"):
        ws.open(tmp_path / "a.zarr")
    with pytest.raises(ArgumentError, match="no array or group 'row'"):
        ws.open(tmp_path / "a.zarr", dataset="row")


# Any format -----------------------------------------------------------------------------------------------------------


def test_spacing_can_be_replaced(tmp_path, oblique):
    volume = ws.open(save_nifti(tmp_path / "a.nii", oblique.samples, oblique.world_from_index), spacing=(1, 2, 3))
    assert volume.spacing == pytest.approx((1, 2, 3))
    np.testing.assert_allclose(volume.world_from_index[:3, 3], oblique.world_from_index[:3, 3], atol=1e-5)


def test_formats_are_known_by_their_first_bytes(tmp_path, oblique):
    np.save(tmp_path / "a.npy", oblique.samples)
    (tmp_path / "a.npy").rename(tmp_path / "a.dat")
    assert ws.open(tmp_path / "a.dat").name == "a.dat"
    folder = save_dicom(tmp_path / "ct", oblique.samples, oblique.lps_from_index)
    for number, file in enumerate(sorted(folder.iterdir())):
        file.rename(folder / str(number))
    check(ws.open(str(folder / "1")), oblique.samples, oblique.world_from_index)
