"""Damaged files of volumes: a volume whose samples can be read, or an error of one line; in parts, the same samples."""

from __future__ import annotations

import bz2
import copy
import gzip
import json
import struct
import warnings
import zipfile

import dicom_files
import numpy as np
import pytest
import test_dicom_makers
import test_dicom_mosaic
import test_dicom_suv
from damage import DAMAGE, JSON_DAMAGE, ODD_NUMBERS, ODD_WORDS, PLACES, check, damaged, damaged_json, fuzz
from hypothesis import strategies as st
from microscope_files import image, save_bdv, save_imaris
from vti_files import save_vti
from vtk_series_files import save_pvd, save_series

import wavesplat as ws

SAMPLES = (np.arange(120).reshape(4, 5, 6) % 50).astype(np.int16)
ONE, TWO = {"d": SAMPLES}, {"d": SAMPLES, "e": SAMPLES}
N = 40


# Files, each with the length of its header


def nifti(path, version=1, samples=SAMPLES):
    import nibabel

    kind = nibabel.Nifti1Image if version == 1 else nibabel.Nifti2Image
    nibabel.save(kind(samples.T, np.diag([2.0, 3, 4, 1])), path)


def mgh(path):
    import nibabel

    nibabel.save(nibabel.MGHImage(SAMPLES.T.astype(np.float32), np.eye(4)), path)


def itk(path, **options):
    import SimpleITK

    image = SimpleITK.GetImageFromArray(SAMPLES)
    image.SetSpacing((0.5, 0.6, 0.7))
    SimpleITK.WriteImage(image, str(path), **options)


def nrrd(path, encoding="raw", samples=SAMPLES, more=""):
    """With all that a header may have."""
    pack = {"gzip": gzip.compress, "bzip2": bz2.compress, "raw": bytes}.get(encoding)
    text = " ".join(map(str, samples.ravel().tolist())).encode()
    sizes = " ".join(map(str, samples.shape[::-1]))
    header = (
        f"NRRD0005\n# made up\ntype: short\ndimension: {samples.ndim}\nspace: left-posterior-superior\nsizes: {sizes}\n"
        f"{more or 'space directions: (1,0,0) (0,1,0) (0,0,2)'}\nkinds: {'domain ' * 3}{'list' * (samples.ndim - 3)}\n"
        f'space units: "mm" "mm" "mm"\nendian: little\nencoding: {encoding}\nspace origin: (1,2,3)\nmodality:=CT\n\n'
    )
    path.write_bytes(header.encode() + (pack(samples.tobytes()) if pack else text))


def nhdr(path):
    nrrd(path)
    header, _, samples = path.read_bytes().partition(b"\n\n")
    path.write_bytes(header + b"\nline skip: 0\nbyte skip: 0\ndata file: a.raw\n\n")
    (path.parent / "a.raw").write_bytes(samples)


def legacy_vtk(path, is_text=False):
    header = (
        f"# vtk DataFile Version 3.0\na\n{'ASCII' if is_text else 'BINARY'}\nDATASET STRUCTURED_POINTS\n"
        "DIMENSIONS 6 5 4\nSPACING 1 1 1\nORIGIN 0 0 0\nPOINT_DATA 120\nSCALARS s short 1\nLOOKUP_TABLE default\n"
    )
    field = "\nFIELD f 1\nother 1 120 float\n"
    more = np.linspace(0, 1, 120).astype(">f4")
    text = " ".join(map(str, SAMPLES.ravel())) + field + " ".join(map(str, more))
    content = text.encode() if is_text else SAMPLES.astype(">i2").tobytes() + field.encode() + more.tobytes()
    path.write_bytes(header.encode() + content)


def tiff(path, **options):
    import tifffile

    tifffile.imwrite(path, SAMPLES, photometric="minisblack", **options)


def npy(path, **options):
    np.save(path, SAMPLES, **options)


def hdf5(path, **options):
    import h5py

    with h5py.File(path, "w") as file:
        data = file.create_dataset("raw", data=SAMPLES, **options)
        data.attrs["element_size_um"] = [2.0, 1.0, 0.5]
        data.attrs["DIMENSION_LABELS"] = ["z", "y", "x"]


def imaris(path):
    times = ("2026-01-02 10:00:00.000", "2026-01-02 10:00:30.500")
    channels = ({"Name": "DAPI", "Color": "0 0 1", "ColorRange": "100 900", "LSMEmissionWavelength": "461"},)
    save_imaris(path, image(2, 1, SAMPLES.shape), channels=channels, times=times)


def big_data_viewer(path):
    save_bdv(path.parent, image(2, 1, SAMPLES.shape), times="<first>0</first><last>1</last>")


def pvd(path, names):
    for name in names:
        save_vti(path.with_name(name), ONE)
    save_pvd(path, list(enumerate(names)))


def series(path, names):
    pvd(path, names)
    save_series(path, list(enumerate(names)))


def dicom_zip(path):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for number, dataset in enumerate(slices()):
            file = path.with_name("one.dcm")
            dataset.save_as(file, enforce_file_format=True)
            archive.write(file, f"STUDY/{number}")
            file.unlink()


def dicom_directory(path):
    from pydicom.dataset import Dataset, FileMetaDataset

    directory = Dataset()
    directory.file_meta = FileMetaDataset()
    directory.file_meta.TransferSyntaxUID = dicom_files.EXPLICIT_LITTLE
    directory.file_meta.MediaStorageSOPClassUID = "1.2.840.10008.1.3.10"
    directory.file_meta.MediaStorageSOPInstanceUID = "1.2.3"
    names = [f"IM{number}" for number in range(3)]
    directory.DirectoryRecordSequence = dicom_files.sequence(*({"ReferencedFileID": name} for name in names))
    directory.save_as(path, enforce_file_format=True)
    for name, dataset in zip(names, slices(), strict=True):
        dataset.save_as(path.with_name(name), enforce_file_format=True)


def slices():
    return [dicom_files.slice_at(one, number) for number, one in enumerate(dicom_files.random(3))]


#: File -> how it is made, bytes of its header, and whether it can be read in parts.
KINDS = {
    "a.nii": (nifti, 352, True),
    "b.nii": (lambda path: nifti(path, 2), 544, True),
    "times.nii": (lambda path: nifti(path, samples=np.stack([SAMPLES] * 3)), 352, True),
    "a.nii.gz": (nifti, 352, False),
    "a.mgh": (mgh, 284, True),
    "a.mha": (itk, 340, True),
    "packed.mha": (lambda path: itk(path, useCompression=True), 400, True),
    "a.mhd": (itk, 400, True),
    "a.nrrd": (nrrd, 330, True),
    "times.nrrd": (
        lambda path: nrrd(
            path, samples=np.stack([SAMPLES] * 2), more="space directions: (1,0,0) (0,1,0) (0,0,2) none"
        ),
        330,
        True,
    ),
    "gzip.nrrd": (lambda path: nrrd(path, "gzip"), 330, True),
    "bzip2.nrrd": (lambda path: nrrd(path, "bzip2"), 330, True),
    "text.nrrd": (lambda path: nrrd(path, "ascii"), 330, True),
    "a.nhdr": (nhdr, 400, True),
    "a.vtk": (legacy_vtk, 180, True),
    "text.vtk": (lambda path: legacy_vtk(path, True), 900, True),
    "a.vti": (lambda path: save_vti(path, TWO, scalars='Scalars="d"', n_pieces=2), 1200, False),
    "packed.vti": (lambda path: save_vti(path, ONE, compressor="vtkZLibDataCompressor", block=70), 500, False),
    "text.vti": (lambda path: save_vti(path, ONE, form="ascii"), 800, False),
    "inline.vti": (lambda path: save_vti(path, ONE, form="binary"), 800, False),
    "times.pvd": (lambda path: pvd(path, ("a_0.vti", "a_1.vti")), 300, False),
    "times.vti.series": (lambda path: series(path, ("a_0.vti", "a_1.vti")), 200, False),
    "a.tif": (tiff, 600, True),
    "packed.tif": (lambda path: tiff(path, compression="zlib", tile=(16, 16)), 600, True),
    "imagej.tif": (lambda path: tiff(path, imagej=True, metadata={"spacing": 2.0, "axes": "ZYX"}), 500, True),
    "ome.ome.tif": (lambda path: tiff(path, ome=True, metadata={"axes": "ZYX", "PhysicalSizeX": 0.5}), 1500, True),
    "a.npy": (npy, 128, True),
    "a.h5": (hdf5, None, True),
    "times.ims": (imaris, None, True),
    "bdv.xml": (big_data_viewer, None, True),
    "a.zip": (dicom_zip, None, False),
    "DICOMDIR": (dicom_directory, 600, False),
    "packed.h5": (lambda path: hdf5(path, chunks=(2, 5, 6), compression="gzip", fletcher32=True), None, True),
}  # fmt: skip


def fields_of(name, content):
    """Offset and length of the numbers in a binary header."""
    if name.endswith(".nii"):
        import nibabel

        dtype = (nibabel.Nifti1Header if content[0] == 0x5C else nibabel.Nifti2Header).template_dtype
        found = []
        for field, at in dtype.fields.values():
            length = field.base.itemsize
            found += [(at + k, length) for k in range(0, field.itemsize, max(length, 1))]
        return found
    if name.endswith(".tif"):
        (at,) = struct.unpack_from("<I", content, 4)
        (n,) = struct.unpack_from("<H", content, at)
        parts = ((0, 2), (2, 2), (4, 4), (8, 4))
        return [(at, 2), *((at + 2 + 12 * k + begin, length) for k in range(n) for begin, length in parts)]
    return ()


def samples_in(path, **options):
    """Samples, place and facts of the volume in a file."""
    volume = ws.open(path, **options)
    assert repr(volume)
    whole = volume.read() if isinstance(volume, ws.LazyVolume) else volume
    assert np.isfinite(whole.world_from_index).all()
    json.dumps(volume.facts.as_json(), allow_nan=False)
    return np.array(whole.samples), whole.world_from_index


def check_volume(path, *names, in_parts=False, **options):
    """Check what opening a path gives; where both ways succeed, samples read at once and in parts are the same."""
    names = [path.name, *names]
    at_once = check(lambda: samples_in(path, **options), *names)
    if not in_parts:
        return
    parts = check(lambda: samples_in(path, memory="50 MB", cache=False, **options), *names)
    if at_once is not None and parts is not None:
        for one, other in zip(at_once, parts, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", KINDS)
def test_files(tmp_path, capfd, name):
    make, n_header, is_read_in_parts = KINDS[name]
    path = tmp_path / name
    make(path)
    files = sorted(tmp_path.iterdir(), key=lambda file: file != path)
    whole = {file: file.read_bytes() for file in files}
    fields = fields_of(name, whole[path])
    options = {"time": 1} if name.startswith(("times", "bdv")) else {}
    assert check(lambda: samples_in(path, **options), path.name) is not None

    def damage(changes, which, in_parts):
        # Of several files mostly the header.
        file = files[which % len(files)]
        content = whole[file]
        if name.endswith(".gz"):
            content = gzip.compress(damaged(gzip.decompress(content), changes, n_header, fields), mtime=0)
        else:
            content = damaged(content, changes, n_header if file == path else None, fields if file == path else ())
        file.write_bytes(content)
        try:
            check_volume(path, file.name, in_parts=in_parts and is_read_in_parts, **options)
        finally:
            file.write_bytes(whole[file])

    fuzz(N, damage, DAMAGE, st.sampled_from([0, 0, 0, 1]), st.booleans())
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", ["a.npy", "a.npz", "a.wavelets"])
def test_arrays_whose_headers_have_another_text(tmp_path, name):
    """Headers of any length, in .npy and in archives: the length before them, and the archive's checksum, are right."""
    path = tmp_path / name
    if name == "a.wavelets":
        ws.WaveletVolume.from_volume(ws.Volume(SAMPLES)).save(path)
    else:
        np.savez(path, a=SAMPLES) if name == "a.npz" else np.save(path, SAMPLES)
    members = {"": path.read_bytes()}
    if name != "a.npy":
        with zipfile.ZipFile(path) as archive:
            members = {one: archive.read(one) for one in archive.namelist()}
    load = ws.WaveletVolume.load if name == "a.wavelets" else samples_in
    assert check(lambda: load(path), path.name) is not None

    def damage(which, changes):
        chosen = list(members)[which % len(members)]
        content = members[chosen]
        (length,) = struct.unpack_from("<H", content, 8)
        header, samples = content[10 : 10 + length], content[10 + length :]
        changed = damaged(header, [(change, True) for change, in_header in changes if in_header])
        rest = damaged(samples, [(change, True) for change, in_header in changes if not in_header])
        content = content[:8] + struct.pack("<H", len(changed)) + changed + rest
        if chosen:
            with zipfile.ZipFile(path, "w") as archive:
                for one, whole in members.items():
                    archive.writestr(one, content if one == chosen else whole)
        else:
            path.write_bytes(content)
        check(lambda: load(path), path.name)

    fuzz(2 * N, damage, PLACES, DAMAGE)


#: Types that samples may be declared to have in HDF5.
HDF5_TYPES = ["i1", "<i2", ">u4", "u8", "f2", ">f8", "?", "S3", "S0", "c8", "V4", "O", "i2,f4", "(3,)i2", "enum", "ref"]

HDF5_DISTANCES = [
    [1.0, 1.0, 1.0], 0.0, "a", b"\xff", [], [float("nan")] * 3, [-1, 1, 1], np.zeros((3, 3)), [1e308] * 3
]  # fmt: skip


def test_datasets_of_hdf5(tmp_path):
    import h5py

    def damage(kind, shape, chunks, fill, labels):
        path = tmp_path / "a.h5"
        special = {"O": h5py.string_dtype(), "enum": h5py.enum_dtype({"a": 1, "b": 2}), "ref": h5py.ref_dtype}
        dtype = special.get(kind) or np.dtype(kind)
        is_chunked = bool(shape and chunks and len(chunks) == len(shape))
        options = {"chunks": chunks, "maxshape": (None,) * len(shape)} if is_chunked else {}
        with h5py.File(path, "w") as file:
            try:
                data = file.create_dataset("raw", shape, dtype, fillvalue=fill, **options)
                data.attrs["element_size_um"] = labels
            except (ValueError, TypeError, OSError, OverflowError, AttributeError):
                return
        check_volume(path, in_parts=True)

    sides = st.sampled_from([0, 1, 2, 3, 5])
    fuzz(
        N,
        damage,
        st.sampled_from(HDF5_TYPES),
        st.none() | st.lists(sides, max_size=5).map(tuple) | st.just((10**6,) * 3),
        st.none() | st.lists(st.sampled_from([1, 2, 3, 10**5]), min_size=3, max_size=3).map(tuple),
        st.none() | st.sampled_from([0, 1, -1, float("nan"), 300]),
        st.sampled_from(HDF5_DISTANCES),
    )


# DICOM

LONG = (b"OB", b"OW", b"OF", b"OD", b"OL", b"SQ", b"UT", b"UN", b"UC", b"UR")
PREAMBLE, ITEM = 132, b"\xfe\xff\x00\xe0"


def elements_of(content, at=0):
    """The elements [tag, type, value] of explicit little-endian DICOM; the value of a sequence is a list of items."""
    found = []
    while at < len(content):
        tag, kind = content[at : at + 4], content[at + 4 : at + 6]
        head, form = (12, "<I") if kind in LONG else (8, "<H")
        (length,) = struct.unpack_from(form, content, at + head - struct.calcsize(form))
        value = content[at + head : at + head + length]
        at += head + length
        if kind == b"SQ":
            items, place = [], 0
            while place < len(value):
                (length,) = struct.unpack_from("<I", value, place + 4)
                items.append(elements_of(value[place + 8 : place + 8 + length]))
                place += 8 + length
            value = items
        found.append([tag, kind, value])
    return found


def encoded(elements):
    content = b""
    for tag, kind, value in elements:
        data = value
        if isinstance(value, list):
            items = [encoded(item) for item in value]
            data = b"".join(ITEM + struct.pack("<I", len(item)) + item for item in items)
        data += b" " * (len(data) % 2)
        is_long = kind in LONG
        length = struct.pack("<I", len(data)) if is_long else struct.pack("<H", len(data) & 0xFFFF)
        content += tag + kind + (b"\0\0" if is_long else b"") + length + data
    return content


def all_of(elements):
    """Each element, also those inside sequences, with the list that it is in."""
    for element in elements:
        yield elements, element
        if isinstance(element[2], list):
            for item in element[2]:
                yield from all_of(item)


def sources_of_dicom(folder, kind):
    if kind == "series":
        return dicom_files.save(folder, slices())
    if kind == "enhanced":
        return dicom_files.save(folder, [dicom_files.enhanced(dicom_files.random(3), [(z,) for z in (0.0, 1.5, 3.0)])])
    if kind == "pet":
        return test_dicom_suv.pet(folder)
    if kind == "mosaics":
        return dicom_files.save(folder, [test_dicom_mosaic.mosaic(test_dicom_mosaic.slices_of(t), t) for t in range(2)])
    if kind == "grids":
        return dicom_files.save(folder, [test_dicom_makers.grid(dicom_files.random(5), t) for t in range(2)])
    if kind == "segmentation":
        masks = [(n, z, np.eye(6, 7, z)) for n in (1, 2) for z in range(3)]
        segments = {1: ("liver", [43803, 26565, 37722]), 2: ("spleen", None)}
        return dicom_files.save(folder, [dicom_files.segmentation(masks, segments=segments)])
    if kind == "structures":
        lines = [[(1, 1, z), (4, 1, z), (2, 4, z)] for z in (0, 2, 4)]
        regions = [("liver", (200, 100, 0), "ORGAN", lines), ("body", None, "EXTERNAL", lines[:1])]
        return dicom_files.save(folder, [dicom_files.structure_set(regions)])
    pixels = dicom_files.random(3)
    dataset = dicom_files.slice_at(pixels, 0, modality="RTDOSE", GridFrameOffsetVector=[0, 2, 4], DoseGridScaling=0.5)
    dataset.NumberOfFrames = 3
    return dicom_files.save(folder, [dataset])


VALUES = (
    st.sampled_from(ODD_WORDS) | st.sampled_from(ODD_NUMBERS) | st.sampled_from([b"1\\0\\0\\0\\1\\0", b"1\\1", b"\\\\"])
)
ELEMENT_CHANGES = st.one_of(
    st.tuples(st.just("value"), PLACES, VALUES),
    st.tuples(st.just("part of value"), PLACES, st.tuples(PLACES, VALUES)),
    st.tuples(st.just("type"), PLACES, st.sampled_from([b"US", b"DS", b"IS", b"FD", b"UN", b"SQ", b"LO", b"??"])),
    st.tuples(st.sampled_from(["lose", "twice", "value of", "no items"]), PLACES, PLACES),
)  # fmt: skip


def change_element(elements, kind, place, what):
    found = list(all_of(elements))
    inside, element = found[place % len(found)]
    if kind == "value":
        element[2] = what
    elif kind == "part of value" and isinstance(element[2], bytes):
        parts = element[2].split(b"\\")
        parts[what[0] % len(parts)] = what[1]
        element[2] = b"\\".join(parts)
    elif kind == "type":
        element[1] = what
    elif kind == "lose":
        inside.remove(element)
    elif kind == "twice":
        inside.append(list(element))
    elif kind == "value of":
        element[2] = copy.deepcopy(found[what % len(found)][1][2])  # which may have the element in it
    elif kind == "no items" and isinstance(element[2], list):
        element[2] = [[]]


def labels_in(file):
    """The labels in a file, of a structure set on a scan of its own, and its lines."""
    world_from_index = np.diag([-1.0, -1, 1, 1])
    scan = ws.Volume(np.zeros((5, 6, 7), np.uint8), world_from_index=world_from_index, unit="mm", anatomical=True)
    labels = ws.Labels.open(file, scan=scan)
    return labels, ws.Region.open(file) if "structures" in file.parent.name else None


@pytest.mark.parametrize(
    "kind", ["series", "enhanced", "dose", "pet", "mosaics", "grids", "segmentation", "structures"]
)
def test_dicom(tmp_path, capfd, kind):
    options = {"pet": {"suv": True}, "mosaics": {"time": 1}, "grids": {"time": 1}}.get(kind, {})
    folder = sources_of_dicom(tmp_path / kind, kind)
    files = sorted(folder.iterdir())
    whole = {file: file.read_bytes() for file in files}

    def read(folder):
        if kind in ("segmentation", "structures"):
            return labels_in(folder / "000.dcm")
        return samples_in(folder, **options)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert check(lambda: read(folder), folder.name) is not None

    def damage(which, element_changes, changes):
        file = files[which % len(files)]
        elements = elements_of(whole[file], PREAMBLE)
        for change in element_changes:
            change_element(elements, *change)
        content = whole[file][:PREAMBLE] + encoded(elements)
        file.write_bytes(damaged(content, changes, 900))
        try:
            check(lambda: read(folder), folder.name)
        finally:
            file.write_bytes(whole[file])

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fuzz(2 * N, damage, PLACES, st.lists(ELEMENT_CHANGES, min_size=1, max_size=3), st.just([]) | DAMAGE)
    assert capfd.readouterr() == ("", "")


# Zarr


@pytest.mark.parametrize("version", [2, 3])
def test_zarr(tmp_path, version):
    import zarr

    root = tmp_path / "a.zarr"
    group = zarr.create_group(root, zarr_format=version)
    group.create_array(
        "0",
        data=SAMPLES,
        chunks=(2, 3, 6),
        chunk_key_encoding={"name": "default" if version == 3 else "v2", "separator": "/"},
    )
    axes = [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    scale = [{"type": "scale", "scale": [2.0, 1.0, 0.5]}, {"type": "translation", "translation": [0.0, 1.0, 2.0]}]
    image = {"version": "0.4", "axes": axes, "datasets": [{"path": "0", "coordinateTransformations": scale}]}
    group.attrs.update(
        {"multiscales": [image]} if version == 2 else {"ome": {"version": "0.5", "multiscales": [image]}}
    )
    files = sorted(file for file in root.rglob("*") if file.is_file())
    whole = {file: file.read_bytes() for file in files}
    documents = [file for file in files if file.name.startswith(".z") or file.suffix == ".json"]
    assert check(lambda: samples_in(root), root.name) is not None

    def damage(which, changes, of_bytes):
        if of_bytes is None:
            file = documents[which % len(documents)]
            content = damaged_json(json.loads(whole[file]), changes).encode()
        else:
            file = files[which % len(files)]
            content = damaged(whole[file], of_bytes)
        file.write_bytes(content)
        try:
            check_volume(root, in_parts=True)
        finally:
            file.write_bytes(whole[file])

    fuzz(N, damage, PLACES, JSON_DAMAGE, st.none() | DAMAGE)
