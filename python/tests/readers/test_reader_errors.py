"""Errors of readers: one line that says what is wrong, where, and how to mend it; the path comes last."""

from __future__ import annotations

import pickle
import re
import struct
import sys
import tracemalloc
import warnings
from pathlib import Path

import numpy as np
import pytest
from vti_files import save_vti

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError, FileWarning, LimitError

NOISE = np.random.default_rng(5).integers(0, 60000, (20, 30, 40)).astype(np.uint16)


def save(path, samples=NOISE):
    """A file of the kind that the suffix says."""
    name = path.name
    if name.endswith((".nii", ".nii.gz")):
        import nibabel

        nibabel.save(nibabel.Nifti1Image(samples.T, np.eye(4)), path)
    elif name.endswith((".mha", ".nrrd")):
        import SimpleITK

        SimpleITK.WriteImage(SimpleITK.GetImageFromArray(samples), str(path), useCompression=name.startswith("packed"))
    elif name.endswith(".tif"):
        import tifffile

        tifffile.imwrite(
            path, samples, photometric="minisblack", compression="zlib" if name.startswith("packed") else None
        )
    elif name.endswith(".npy"):
        np.save(path, samples)
    elif name.endswith(".npz"):
        np.savez_compressed(path, samples)
    elif name.endswith(".h5"):
        import h5py

        with h5py.File(path, "w") as file:
            file["raw"] = samples
    elif name.endswith(".vti"):
        save_vti(path, {"d": samples}, compressor="vtkZLibDataCompressor" if name.startswith("packed") else None)
    return path


KINDS = [
    "a.nii", "a.nii.gz", "a.mha", "packed.mha", "a.nrrd", "packed.nrrd",
    "a.tif", "packed.tif", "a.npy", "a.npz", "a.h5", "a.vti", "packed.vti",
]  # fmt: skip

N_FILES = 60
#: Most of the damage goes to the first bytes, where the headers are.
N_HEADER_BYTES = 600


def fails(path, message=r"\w", **options):
    """Check that `ws.open` refuses a file in one line that ends with the path, and return the line."""
    with pytest.raises(FileError, match=message) as caught:
        ws.open(path, **options)
    line = str(caught.value)
    assert line.endswith(str(path))
    assert "\n" not in line
    return line


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("part", [pytest.param(0.9, marks=pytest.mark.nightly), 0.5, 0.01])
@pytest.mark.every_pair
def test_truncated(tmp_path, capfd, name, part):
    path = save(tmp_path / name)
    content = path.read_bytes()
    path.write_bytes(content[: int(len(content) * part)])
    assert re.search("truncated|damaged", fails(path))
    assert capfd.readouterr() == ("", "")  # nothing from the C libraries underneath


@pytest.mark.parametrize("name", KINDS)
def test_garbage(tmp_path, capfd, name):
    path = tmp_path / name
    path.write_bytes(np.random.default_rng(1).bytes(5000))
    fails(path, "truncated|damaged|header")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", [*KINDS, "a.raw", "a.dcm", "a.xyz"])
def test_empty(tmp_path, name):
    (tmp_path / name).touch()
    fails(tmp_path / name, "the file is empty; copy or export it again")


@pytest.mark.parametrize("name", ["a.nii.gz", "a", "folder/a.mha"])
def test_missing(tmp_path, name):
    fails(tmp_path / name, "no such file or folder; check the name")


def test_empty_folder(tmp_path):
    fails(tmp_path, "the folder is empty")


def test_folder_of_something_else(tmp_path):
    (tmp_path / "readme.txt").write_text("hello")
    fails(tmp_path, "no DICOM series, no TIFF slices and no Zarr array")


def test_unknown_kind(tmp_path):
    (tmp_path / "a.doc").write_bytes(b"hello world")
    fails(tmp_path / "a.doc", r"unknown kind of file; wavesplat reads NIfTI.*pass shape=\(z, y, x\) and dtype=")


def test_unreadable(tmp_path, monkeypatch):
    path = save(tmp_path / "a.nii")

    def refuse(*_, **__):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    fails(path, "cannot read the file: Permission denied; check its permissions")


@pytest.mark.parametrize("name", ["a.nii", "a.mha", "a.nrrd", "a.tif", "a.npy"])
def test_two_dimensions(tmp_path, name):
    fails(save(tmp_path / name, NOISE[0]), "2-D|single|fewer than 2")


@pytest.mark.parametrize("name", ["a.nii", "a.nrrd", "a.npy"])
def test_one_slice(tmp_path, name):
    fails(save(tmp_path / name, NOISE[:1]), r"a single plane of x \d+, y \d+, z 1 samples.*`wavesplat slice` shows it")


def test_a_message_of_a_library_names_the_file_once(tmp_path):
    path = tmp_path / "bad.nii.gz"
    path.write_bytes(b"no gzip file" * 40)
    with pytest.raises(FileError) as caught:
        ws.open(path)
    assert str(caught.value).count("bad.nii.gz") == 1
    assert str(caught.value).startswith("cannot read as NIfTI: it is not a gzip file; ")


def test_zero_size(tmp_path):
    np.save(tmp_path / "a.npy", NOISE[:0])
    fails(tmp_path / "a.npy", "holds no samples")
    path = save(tmp_path / "a.nii")
    content = bytearray(path.read_bytes())
    content[42:44] = struct.pack("<h", 0)
    path.write_bytes(content)
    fails(path, "holds no samples|cannot read as NIfTI")


def with_nifti_size(path, *size):
    """Change the size in a NIfTI-1 header, which may be compressed."""
    import gzip

    packed = path.name.endswith(".gz")
    content = bytearray(gzip.decompress(path.read_bytes()) if packed else path.read_bytes())
    content[42:48] = struct.pack("<3h", *size)
    path.write_bytes(gzip.compress(bytes(content)) if packed else bytes(content))
    return path


@pytest.mark.parametrize("name", ["a.nii", "a.nii.gz"])
@pytest.mark.parametrize("size", [(32000, 32000, 32000), (41, 30, 20)])
def test_nifti_header_promises_too_much(tmp_path, name, size):
    line = fails(with_nifti_size(save(tmp_path / name), *size), "wrong header.*the file holds 48000")
    assert f"need {2 * size[0] * size[1] * size[2]} bytes" in line


@pytest.mark.parametrize("name", ["a.mha", "packed.mha", "a.nrrd", "packed.nrrd"])
def test_itk_header_promises_too_much(tmp_path, name):
    path = save(tmp_path / name)
    content = path.read_bytes()
    assert b"40 30 20" in content
    path.write_bytes(content.replace(b"40 30 20", b"40000 30000 20000", 1))
    fails(path, "need 48000000000000 bytes")


def test_npy_header_promises_too_much(tmp_path):
    path = save(tmp_path / "a.npy")
    content = path.read_bytes()
    path.write_bytes(content.replace(b"(20, 30, 40), }        ", b"(20000, 30000, 40000), }"[:24], 1)[: len(content)])
    fails(path, "need 48000000000000 bytes|truncated")


def test_more_than_the_machine_holds(tmp_path):
    import h5py

    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("raw", (10**5, 10**5, 10**5), "u1", chunks=(64, 64, 64))
    with pytest.raises(
        LimitError, match=r"need 931322.6 GiB, this machine has .* GiB of memory for them; use a.*a.h5$"
    ):
        ws.open(path)


def test_missing_data_file(tmp_path):
    import SimpleITK

    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(NOISE), str(tmp_path / "a.mhd"))
    (tmp_path / "a.raw").unlink()
    fails(tmp_path / "a.mhd", "names a data file that is not there, 'a.raw'; put it beside the header")


def test_damaged_in_the_middle(tmp_path, capfd):
    path = save(tmp_path / "a.nii.gz")
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)
    fails(path, "damaged|truncated")
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("row", [(0, 0, 0, 0), (float("nan"), 0, 0, 0)])
def test_degenerate_affine_in_a_file(tmp_path, row):
    path = save(tmp_path / "a.nii")
    content = bytearray(path.read_bytes())
    content[280:296] = struct.pack("<4f", *row)  # srow_x
    path.write_bytes(content)
    fails(path, "world_from_index")


@pytest.mark.parametrize("number", ["nan", "inf"])
def test_a_place_that_is_not_finite_in_a_file_read_in_parts(tmp_path, number):
    path = save(tmp_path / "a.nii")
    content = bytearray(path.read_bytes())
    content[280:284] = struct.pack("<f", float(number))
    path.write_bytes(content)
    fails(path, "world_from_index.*not finite", memory="50 MB")


@pytest.mark.parametrize("options", [{}, {"memory": "50 MB"}])
def test_pages_of_tiff_in_a_circle(tmp_path, options):
    path = save(tmp_path / "a.tif")
    content = bytearray(path.read_bytes())
    (first,) = struct.unpack_from("<I", content, 4)
    (n,) = struct.unpack_from("<H", content, first)
    content[first + 2 + 12 * n : first + 6 + 12 * n] = struct.pack("<I", first)
    path.write_bytes(content)
    fails(path, "damaged: its pages lead in a circle", **options)


def test_nothing_finite_in_a_file(tmp_path):
    np.save(tmp_path / "a.npy", np.full((3, 3, 3), np.nan))
    fails(tmp_path / "a.npy", "none of its 27 samples is finite")


def test_objects_are_not_unpickled(tmp_path):
    np.save(tmp_path / "a.npy", np.full((3, 3, 3), None))
    fails(tmp_path / "a.npy", "cannot read as a NumPy file|truncated|samples are object")


@pytest.mark.parametrize(
    ("spacing", "message"), [((0, 1, 1), "spacing is"), ((1, 1), "spacing is"), ((1, 1, float("nan")), "spacing is")]
)
def test_bad_spacing_argument(tmp_path, spacing, message):
    path = save(tmp_path / "a.npy")
    with pytest.raises(ArgumentError, match=message):
        ws.open(path, spacing=spacing)


@pytest.mark.parametrize(
    "options",
    [{"series": "1"}, {"dataset": "x"}, {"level": 1}, {"byte_order": "big"}, {"offset": 4}],
)
def test_options_that_mean_nothing_are_refused(tmp_path, options):
    path = save(tmp_path / "a.nii")
    with pytest.raises(ArgumentError, match=rf"{next(iter(options))}= has no meaning for this kind of file.*a.nii$"):
        ws.open(path, **options)


def test_what_itk_says_is_passed_on_without_its_source(tmp_path):
    path = tmp_path / "a.nrrd"
    path.write_bytes(b"NRRD0004\ntype: short\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n" + bytes(128))
    line = fails(
        path,
        "cannot read as an image: type .short. and encoding .raw. require endian info; the file is damaged, or",
    )
    assert "cxx" not in line


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (
            "Exception thrown in Execute: /tmp/b/IO/src/sitkReader.cxx:97:\nsitk::ERROR: No reader for a.mha",
            "No reader",
        ),
        ("D:\\a\\1\\bld\\ITK\\Modules\\IO\\src\\itkNrrdImageIO.cxx:570: bad header", "bad header"),
        ("/home/u/ITK-bld/Modules/x.hxx:5:\nitk::ERROR: ImageFileReader(0x55aa): no samples", "no samples"),
    ],
)
def test_no_place_in_the_source_of_a_library_is_told(text, line):
    from wavesplat._storage.reading import reading

    with (
        pytest.raises(FileError, match=f"^cannot read as an image: {line}[^:/]*; the file is damaged, or of a form"),
        reading("an image", "a.mha"),
    ):
        raise RuntimeError(text)


def test_itk_does_not_say_that_a_damaged_file_is_not_there(tmp_path):
    path = save(tmp_path / "a.mha")
    path.write_bytes(path.read_bytes().replace(b"MET_USHORT", b"MET_USHERT"))
    line = fails(path, "cannot read as an image: .*; the file is damaged, or of a form that wavesplat does not read")
    assert "Reason" not in line
    assert "No such file" not in line


@pytest.mark.parametrize("name", ["packed.mha", "packed.nrrd"])
def test_a_flipped_byte_of_packed_samples_is_found(tmp_path, name):
    path = save(tmp_path / name)
    whole = path.read_bytes()
    for place in np.linspace(0, len(whole) * 0.9, 40).astype(int):
        # Fields of the header that do not affect the volume may change.
        at = len(whole) - 1 - place
        content = bytearray(whole)
        content[at] ^= 0x10
        path.write_bytes(content)
        fails(path, "damaged: the packed samples do not unpack|truncated")
    path.write_bytes(whole)
    np.testing.assert_array_equal(ws.open(path).samples, NOISE)


def test_packed_samples_beside_their_header_are_checked(tmp_path):
    import SimpleITK

    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(NOISE), str(tmp_path / "a.mhd"), useCompression=True)
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(NOISE), str(tmp_path / "b.nhdr"), useCompression=True)
    for header, samples in (("a.mhd", "a.zraw"), ("b.nhdr", "b.raw.gz")):
        np.testing.assert_array_equal(ws.open(tmp_path / header).samples, NOISE)
        content = bytearray((tmp_path / samples).read_bytes())
        content[len(content) // 2] ^= 1
        (tmp_path / samples).write_bytes(content)
        fails(tmp_path / header, "damaged: the packed samples do not unpack")


def test_streams_that_follow_each_other_are_one(tmp_path):
    import gzip

    path = save(tmp_path / "packed.nrrd")
    header = path.read_bytes().partition(b"\n\n")[0] + b"\n\n"
    samples = NOISE.tobytes()
    path.write_bytes(header + gzip.compress(samples[:7777]) + gzip.compress(samples[7777:]) + b"\0" * 9)
    np.testing.assert_array_equal(ws.open(path).samples, NOISE)


@pytest.mark.parametrize("is_text", [False, True])
def test_a_legacy_vtk_file_that_is_cut_short(tmp_path, is_text):
    path = tmp_path / "a.vtk"
    header = (
        f"# vtk DataFile Version 3.0\na\n{'ASCII' if is_text else 'BINARY'}\nDATASET STRUCTURED_POINTS\n"
        "DIMENSIONS 7 6 5\nSPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA 210\nSCALARS s float 1\nLOOKUP_TABLE default\n"
    )
    samples = np.arange(210, dtype=np.float32).reshape(5, 6, 7) % 9
    content = (
        " ".join(f"{value:g}" for value in samples.ravel()).encode() if is_text else samples.astype(">f4").tobytes()
    )
    path.write_bytes(header.encode() + content)
    np.testing.assert_array_equal(ws.open(path).samples, samples)
    for cut in (1, 2, 5, 20, 100, 400):
        path.write_bytes(header.encode() + content[: -2 * cut if is_text else -cut])
        fails(path, "truncated")


def test_what_a_terminal_would_obey_is_escaped(tmp_path):
    path = tmp_path / "a.vtk"
    path.write_bytes(b"# vtk DataFile Version 3.0\na\nBINARY\nDATASET \x1b[2J\x9b\n")
    line = fails(path, r"VTK's \\x1b\[2J")
    assert line.isprintable()
    warning = FileWarning(f"\x1b[2J: a\u00a0b\u202e: {path}")
    assert str(warning) == f"\\x1b[2J: a\u00a0b\\u202e: {path}"  # blanks of other widths stay


def test_the_middle_of_a_long_message_is_left_out():
    error = FileError(f"the name is {'a' * 100_000}; write it again: a.nii")
    assert len(str(error)) < 4100
    assert str(error).startswith("the name is aaa")
    assert str(error).endswith("aaa; write it again: a.nii")
    assert str(pickle.loads(pickle.dumps(error))) == str(error)  # noqa: S301 - our own


@pytest.mark.parametrize("options", [{}, {"memory": "50 MB"}])
def test_no_more_memory_is_asked_for_than_a_header_can_have(tmp_path, options):
    path = tmp_path / "a.npy"
    path.write_bytes(b"\x93NUMPY\x02\x00" + struct.pack("<I", 1 << 31) + bytes(100))
    fails(path, **options)
    tracemalloc.start()
    fails(path, **options)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10e6


def test_an_extension_longer_than_its_file_takes_no_memory(tmp_path):
    import nibabel

    path = tmp_path / "a.nii"
    image = nibabel.Nifti1Image(np.zeros((4, 4, 4), np.uint8), np.eye(4))
    image.header.extensions.append(nibabel.nifti1.Nifti1Extension(6, b"comment"))
    nibabel.save(image, path)
    content = bytearray(path.read_bytes())
    content[352:356] = (1 << 28).to_bytes(4, "little")
    path.write_bytes(content)
    tracemalloc.start()
    with pytest.raises(FileError, match=f"an extension ends at byte {352 + (1 << 28)}, the file at {len(content)}"):
        ws.open(path)
    assert tracemalloc.get_traced_memory()[1] < 1 << 26
    tracemalloc.stop()


def test_extensions_that_look_wrong_say_nothing(tmp_path):
    import nibabel

    image = nibabel.Nifti1Image(NOISE.T, np.eye(4))
    image.header.extensions.append(nibabel.nifti1.Nifti1Extension(6, b"comment"))
    nibabel.save(image, tmp_path / "a.nii")
    content = bytearray((tmp_path / "a.nii").read_bytes())
    content[352:356] = struct.pack("<i", 15)
    (tmp_path / "a.nii").write_bytes(content)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        np.testing.assert_array_equal(ws.open(tmp_path / "a.nii").samples, NOISE)
        ws.Labels.open(tmp_path / "a.nii")
    assert said == []


@pytest.mark.parametrize("options", [{}, {"memory": "50 MB"}])
@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"sizes: 40 30 20", b"sizes: " + b"1 " * 1000),
        (b"sizes:", b"sizes" + b"x" * 3000 + b":"),
        (b"endian: little", b"endian: " + b"a" * 70_000),
        (b"endian: little", b"#" * 70_000 + b"\nendian: " + b"a" * 3000),
    ],
)
@pytest.mark.every_pair
def test_fields_that_itk_has_no_room_for(tmp_path, old, new, options):
    path = save(tmp_path / "a.nrrd")
    whole = path.read_bytes()
    assert old in whole
    path.write_bytes(whole.replace(old, new, 1))
    fails(path, "a wrong header: its line .* bytes, and fields have 500 at most; mend it", **options)
    # What is no field of the format may be as long as it likes.
    path.write_bytes(
        whole.replace(
            old, b"content: " + b"a" * 9000 + b"\n#" + b"b" * 9000 + b"\nkey:=" + b"c" * 9000 + b"\n" + old, 1
        )
    )
    np.testing.assert_array_equal(ws.open(path).samples, NOISE)


@pytest.mark.skipif(sys.platform != "linux", reason="has no paths as long")
def test_a_path_that_itk_has_no_room_for(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = Path(*["d" * 200] * 14)
    folder.mkdir(parents=True)
    content = save(tmp_path / "a.nrrd").read_bytes().replace(b"encoding: raw", b"encoding: rax")
    (folder / "a.nrrd").write_bytes(content)
    with pytest.raises(FileError, match="the path is longer than 1000 bytes, which ITK cannot hold; move the file"):
        ws.open(folder / "a.nrrd")


@pytest.mark.parametrize("options", [{}, {"memory": "50 MB"}])
@pytest.mark.parametrize("number", ["-1", "11", "100", "4294967296", "1e308", "", "3\nNDims = 100"])
def test_dimensions_that_itk_has_no_room_for(tmp_path, number, options):
    path = save(tmp_path / "a.mha")
    path.write_bytes(path.read_bytes().replace(b"NDims = 3", f"NDims = {number}".encode(), 1))
    fails(path, "a wrong header: its line NDims must be there once, and give 1 to 10 dimensions; mend it", **options)


@pytest.mark.parametrize("name", KINDS)
def test_fuzzed(tmp_path, capfd, name):
    """Either a volume or a `WavesplatError` of one line; nothing else ever comes out."""
    rng = np.random.default_rng(11)
    path = save(tmp_path / name, rng.integers(0, 60000, (4, 5, 6)).astype(np.uint16))
    whole = path.read_bytes()
    refusals = []
    for _ in range(N_FILES):
        path.write_bytes(damaged(whole, rng))
        try:
            ws.open(path)
        except ws.errors.WavesplatError as error:
            refusals.append(str(error))
    assert refusals
    assert not [line for line in refusals if "\n" in line or not line.endswith(str(path))]
    assert capfd.readouterr() == ("", "")


def damaged(whole, rng):
    """A copy with a few bytes changed, lost or added."""
    content = bytearray(whole)
    for _ in range(rng.integers(1, 6)):
        in_header = rng.random() < 0.8
        place = int(rng.integers(min(len(content), N_HEADER_BYTES) if in_header else len(content)))
        length = int(rng.integers(1, 20))
        change = rng.choice(["change", "lose", "add"], p=[0.6, 0.2, 0.2])
        if change == "change":
            content[place] = int(rng.integers(256))
        elif change == "lose":
            del content[place : place + length]
        else:
            content[place:place] = rng.bytes(length)
    return bytes(content)
