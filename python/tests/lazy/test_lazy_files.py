"""Files that are read lazily: samples, place and facts are those of `open`; some files cannot be read in parts."""

from __future__ import annotations

import pickle
import subprocess
import sys

import numpy as np
import pytest

import wavesplat as ws


def _volume():
    rng = np.random.default_rng(3)
    samples = rng.integers(-900, 2900, (13, 18, 21)).astype(np.int16)
    matrix = np.array([[0.7, 0.1, 0, 5], [-0.1, 0.8, 0, -7], [0, 0, 1.5, 11], [0, 0, 0, 1.0]])
    return ws.Volume(samples, world_from_index=matrix, unit="mm", anatomical=True)


def _npz(folder, volume):
    np.savez(folder / "a.npz", other=np.zeros(3), density=np.asfortranarray(volume.samples))
    return folder / "a.npz", {"dataset": "density"}


def _npy(folder, volume):
    np.save(folder / "a.npy", volume.samples)
    return folder / "a.npy", {}


def _npy_of_times(folder, volume):
    np.save(folder / "t.npy", np.stack([volume.samples, 2 * volume.samples]))
    return folder / "t.npy", {"time": 1}


def _raw(folder, volume):
    (folder / "a.raw").write_bytes(b"head" + volume.samples.astype(">i2").tobytes())
    return folder / "a.raw", {"shape": volume.shape, "dtype": "i2", "byte_order": "big", "offset": 4}


def _nifti(folder, volume):
    volume.save(folder / "a.nii")
    return folder / "a.nii", {}


def _scaled_nifti(folder, volume):
    import nibabel

    image = nibabel.Nifti1Image(volume.samples.T.astype(np.float32) * 0.25, volume.world_from_index)
    image.header.set_data_dtype(np.int16)
    image.header.set_slope_inter(0.25, 1.5)
    nibabel.save(image, folder / "s.nii")
    return folder / "s.nii", {}


def _nifti_without_offset(folder, volume):
    path, _ = _nifti(folder, volume)
    header = bytearray(path.read_bytes())
    header[108:112] = bytes(4)
    path.write_bytes(header)
    return path, {}


def _nifti_pair(folder, volume):
    import nibabel

    nibabel.save(nibabel.Nifti1Pair(volume.samples.T, volume.world_from_index), folder / "p.img")
    return folder / "p.hdr", {}


def _itk(suffix, compressed=False):
    def write(folder, volume):
        import SimpleITK

        SimpleITK.WriteImage(volume.to_sitk(), str(folder / f"a{suffix}"), compressed)
        return folder / f"a{suffix}", {}

    return write


def _skipping_nrrd(folder, volume):
    data = b"one\ntwo\nabc" + volume.samples.astype(">i2").tobytes()
    z, y, x = volume.shape
    header = f"NRRD0004\ntype: short\ndimension: 3\nsizes: {x} {y} {z}\nencoding: raw\nendian: big\n"
    (folder / "s.raw").write_bytes(data)
    (folder / "s.nhdr").write_text(header + "line skip: 2\nbyte skip: 3\ndata file: s.raw\n")
    return folder / "s.nhdr", {}


def _nrrd_at_the_end(folder, volume):
    path, _ = _itk(".nrrd")(folder, volume)
    head, _, data = path.read_bytes().partition(b"\n\n")
    path.write_bytes(head + b"\nbyte skip: -1\n\nwhatever\n" + data)
    return path, {}


def _skipping_meta_image(skip):
    def write(folder, volume):
        _itk(".mhd")(folder, volume)
        header, data = folder / "a.mhd", folder / "a.raw"
        header.write_text(header.read_text().replace("ElementDataFile", f"HeaderSize = {skip}\nElementDataFile"))
        data.write_bytes(b"12345" + data.read_bytes())
        return header, {}

    return write


def _hdf5(folder, volume):
    import h5py

    with h5py.File(folder / "a.h5", "w") as file:
        file.create_dataset("deep/x", data=volume.samples, chunks=(5, 6, 7), compression="gzip")
        file["deep/x"].attrs["element_size_um"] = [3.0, 2.0, 1.0]
    return folder / "a.h5", {}


def _zarr(folder, volume):
    import zarr

    zarr.create_array(folder / "a.zarr", data=np.array(volume.samples), chunks=(5, 6, 7))
    return folder / "a.zarr", {}


def ome_zarr(folder, samples, n_levels=3, chunk=8):
    """An OME-Zarr 0.5 image of axes t, c, z, y, x, whose coarser levels are means."""
    import zarr

    group = zarr.open_group(folder, mode="w")
    datasets = []
    for level in range(n_levels):
        array = group.create_array(
            str(level), shape=(1, 2, *samples.shape), chunks=(1, 1, chunk, chunk, chunk), dtype=samples.dtype
        )
        array[0, 0], array[0, 1] = samples, samples // 2
        scale = [1, 1, 2.0 * 2**level, 0.5 * 2**level, 0.5 * 2**level]
        shift = [0, 0, 2.0 * (2**level - 1) / 2, 0.5 * (2**level - 1) / 2, 0.5 * (2**level - 1) / 2]
        transforms = [{"type": "scale", "scale": scale}, {"type": "translation", "translation": shift}]
        datasets.append({"path": str(level), "coordinateTransformations": transforms})
        z, y, x = (n // 2 * 2 for n in samples.shape)
        blocks = samples[:z, :y, :x].astype(np.float32).reshape(z // 2, 2, y // 2, 2, x // 2, 2)
        samples = blocks.mean((1, 3, 5)).astype(samples.dtype)
    axes = [{"name": "t", "type": "time"}, {"name": "c", "type": "channel"}]
    axes += [{"name": name, "type": "space", "unit": "micrometer"} for name in "zyx"]
    group.attrs["ome"] = {"version": "0.5", "multiscales": [{"axes": axes, "datasets": datasets}]}


def _ome_zarr(folder, volume):
    ome_zarr(folder / "o.zarr", np.array(volume.samples))
    return folder / "o.zarr", {"channel": 1}


def _tiff(folder, volume):
    import tifffile

    tifffile.imwrite(
        folder / "a.tif", volume.samples, imagej=True, metadata={"axes": "ZYX", "spacing": 2.0, "unit": "um"}
    )
    return folder / "a.tif", {}


def _tiff_of_one_directory(axes, byte_order="<", **options):
    """Writer of a TIFF with all planes behind one page directory, as ImageJ writes stacks of more than 4 GB."""

    def write(folder, volume):
        import tifffile

        # The volume at time 1, channel 0, among others.
        shape = tuple({"T": 3, "C": 2}.get(axis) or volume.shape["ZYX".index(axis)] for axis in axes)
        samples = np.zeros(shape, volume.dtype)
        samples[tuple({"T": 1, "C": 0}.get(axis, slice(None)) for axis in axes)] = volume.samples
        path = folder / "one.tif"
        tifffile.imwrite(path, samples, byteorder=byte_order, truncate=True, metadata={"axes": axes}, **options)
        with tifffile.TiffFile(path) as file:
            assert len(file.pages) == 1
        return path, {name: k for name, k in {"time": 1, "channel": 0}.items() if name[0].upper() in axes}

    return write


def _packed_tiff(folder, volume):
    import tifffile

    tifffile.imwrite(folder / "p.ome.tif", volume.samples, compression="zlib", metadata={"axes": "ZYX"})
    return folder / "p.ome.tif", {}


def _tiff_folder(folder, volume):
    import tifffile

    (folder / "slices").mkdir()
    for k, one in enumerate(volume.samples):
        tifffile.imwrite(folder / "slices" / f"s{k}.tif", one)
    return folder / "slices", {}


KINDS = {
    "npy": _npy,
    "npz": _npz,
    "npy of times": _npy_of_times,
    "raw": _raw,
    "NIfTI": _nifti,
    "scaled NIfTI": _scaled_nifti,
    "NIfTI whose samples begin at 0": _nifti_without_offset,
    "NIfTI in two files": _nifti_pair,
    "NRRD": _itk(".nrrd"),
    "NRRD in two files": _itk(".nhdr"),
    "NRRD that skips lines and bytes": _skipping_nrrd,
    "NRRD at the end of the file": _nrrd_at_the_end,
    "MetaImage that skips bytes": _skipping_meta_image(5),
    "MetaImage at the end of the file": _skipping_meta_image(-1),
    "MetaImage": _itk(".mha"),
    "MetaImage in two files": _itk(".mhd"),
    "HDF5": _hdf5,
    "Zarr": _zarr,
    "OME-Zarr": _ome_zarr,
    "TIFF": _tiff,
    "TIFF of ImageJ, one directory": _tiff_of_one_directory("ZYX", imagej=True),
    "TIFF of ImageJ, one directory, big endian": _tiff_of_one_directory("ZYX", ">", imagej=True),
    "TIFF of ImageJ, one directory, times and channels": _tiff_of_one_directory("TZCYX", imagej=True),
    "TIFF of tifffile, one directory": _tiff_of_one_directory("ZYX"),
    "TIFF of tifffile, one directory, channels first": _tiff_of_one_directory("CTZYX"),
    "TIFF, packed": _packed_tiff,
    "folder of TIFF": _tiff_folder,
}


def _text_vtk(folder, volume):
    z, y, x = volume.shape
    head = "# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_POINTS\n"
    head += f"DIMENSIONS {x} {y} {z}\nPOINT_DATA {x * y * z}\nSCALARS s short\nLOOKUP_TABLE default\n"
    (folder / "a.vtk").write_text(head + " ".join(map(str, volume.samples.ravel())))
    return folder / "a.vtk"


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_left_in_the_file_is_what_open_reads(kind, tmp_path):
    path, options = KINDS[kind](tmp_path, _volume())
    whole, lazy = ws.open(path, **options), ws.open(path, memory="50 MB", **options)
    assert isinstance(lazy, ws.LazyVolume)
    assert (lazy.shape, lazy.dtype, lazy.facts) == (whole.shape, whole.dtype, whole.facts)
    assert np.array_equal(lazy.world_from_index, whole.world_from_index)
    assert np.array_equal(lazy.read(level=0).samples, whole.samples)
    again = pickle.loads(pickle.dumps(lazy))  # noqa: S301 - its own
    box = (2, 3, 5), (9, 17, 8)
    assert np.array_equal(again.arrays(0).read(*box), whole.samples[2:9, 3:17, 5:8])
    # A small picture takes a coarser level where there is one.
    look = ws.TransferFunction([(0, 0.0), (3000, 0.4)], [(0, 1, 1, 1)])
    pictures = [ws.render(one, look, "isometric", size=(40, 30)) for one in (whole, lazy.at_level(0))]
    assert np.array_equal(*(picture.rgba for picture in pictures))


FORKING = """
import multiprocessing, sys
import numpy as np
import wavesplat as ws

volumes = [ws.open(path, memory="50 MB") for path in sys.argv[1:]]

def seen(number):
    volume = volumes[number]
    rows = [volume.arrays(0).read((z, 0, 0), (z + 1, *volume.shape[1:])) for z in range(volume.shape[0])]
    return np.concatenate(rows), ws.render(volume, size=(40, 30)).rgba

numbers = range(len(volumes))
here = [seen(number) for number in numbers]
with multiprocessing.get_context("fork").Pool(2) as pool:
    # Both at once: they would disturb each other's places in files that they share.
    for number, there in zip(list(numbers) * 4, pool.map_async(seen, list(numbers) * 4).get(timeout=100)):
        assert all(np.array_equal(*pair) for pair in zip(here[number], there)), sys.argv[1 + number]
print("same")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no process is forked there")
def test_forked_processes_read_and_draw_as_their_parent(tmp_path):
    paths = []
    for kind in ("npy", "NIfTI", "HDF5", "Zarr", "TIFF", "TIFF, packed", "folder of TIFF"):
        (tmp_path / kind).mkdir()
        paths.append(str(KINDS[kind](tmp_path / kind, _volume())[0]))
    done = subprocess.run(
        [sys.executable, "-c", FORKING, *paths], capture_output=True, text=True, timeout=200, check=False
    )
    assert (done.returncode, done.stdout.strip()) == (0, "same"), done.stderr[-2000:]


def test_levels_of_ome_zarr_lie_where_they_are_said_to(tmp_path):
    path, options = _ome_zarr(tmp_path, _volume())
    lazy = ws.open(path, memory="50 MB", **options)
    assert len(lazy.levels) == 3
    for level in range(3):
        one = ws.open(path, level=level, **options)
        assert np.allclose(lazy._levels[level].world_from_index, one.world_from_index)
        assert np.array_equal(lazy.read(level=level).samples, one.samples)
    assert len(ws.open(path, memory="50 MB", level=1, **options).levels) == 1


def test_channels_of_a_file_become_lazy_layers(tmp_path):
    path, _ = _ome_zarr(tmp_path, _volume())
    scene = ws.open_scene(path, memory="50 MB")
    assert [type(layer.volume).__name__ for layer in scene.layers] == ["LazyVolume"] * 2
    assert scene.render(size=(20, 20)).rgba[..., 3].max() > 0


def _packed_npz(folder, volume):
    np.savez_compressed(folder / "a.npz", volume.samples)
    return folder / "a.npz"


def _as_text(folder, volume):
    path, _ = _itk(".mha")(folder, volume)
    path.write_bytes(path.read_bytes().replace(b"BinaryData = True", b"BinaryData = False"))
    return path


@pytest.mark.parametrize(
    ("kind", "match"),
    [
        (_as_text, "as text"),
        (lambda folder, v: (v.save(folder / "a.nii.gz"), folder / "a.nii.gz")[1], "one stream.*gunzip"),
        (lambda folder, v: _itk(".nrrd", True)(folder, v)[0], "one stream"),
        (lambda folder, v: _itk(".mha", True)(folder, v)[0], "one stream"),
        (
            lambda folder, v: (np.savez_compressed(folder / "a.npz", v.samples), folder / "a.npz")[1],
            "compressed.*savez",
        ),
        (_text_vtk, "without memory="),
    ],
)
def test_what_cannot_be_read_in_parts_says_what_helps(kind, match, tmp_path):
    with pytest.raises(ws.errors.FileError, match=match):
        ws.open(kind(tmp_path, _volume()), memory="50 MB")


def test_dicom_is_refused_by_name(tmp_path):
    from dicom_files import random, save, slice_at

    save(tmp_path, [slice_at(pixels, number) for number, pixels in enumerate(random(4))])
    with pytest.raises(ws.errors.ArgumentError, match="dicom.*without memory="):
        ws.open(tmp_path, memory="50 MB")


def test_a_chunk_that_was_cut_short_is_named(tmp_path):
    path, _ = _zarr(tmp_path, _volume())
    chunk = path / "c" / "1" / "0" / "2"
    chunk.write_bytes(chunk.read_bytes()[:20])
    with pytest.raises(ws.errors.FileError, match=r"samples z 5..9, y 0..5, x 14..20 \(chunk \(1, 0, 2\)\)"):
        ws.render(ws.open(path, memory="50 MB"), size=(20, 20))


def test_a_file_that_ends_early_is_refused_at_once(tmp_path):
    path, options = _npy(tmp_path, _volume())
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(ws.errors.FileError, match="truncated"):
        ws.open(path, memory="50 MB", **options)


def test_what_is_kept_of_a_file_is_not_that_of_another(tmp_path):
    volume = _volume()
    path, _ = _npy(tmp_path, volume)
    assert ws.open(path, memory="50 MB").value_range == volume.value_range
    np.save(path, np.array(volume.samples) // 2)
    assert ws.open(path, memory="50 MB").value_range[1] == volume.samples.max() // 2
    path, _ = _zarr(tmp_path, volume)
    assert ws.open(path, memory="50 MB").value_range == volume.value_range
    import zarr

    zarr.open_array(path, mode="r+")[:] = np.array(volume.samples) // 2
    assert ws.open(path, memory="50 MB").value_range[1] == volume.samples.max() // 2


def test_large_files_are_left_where_they_are_by_themselves(tmp_path, monkeypatch):
    volume = _volume()
    free = volume.samples.nbytes * 4 - 8
    monkeypatch.setattr("wavesplat._readers.opening.free_bytes", lambda: free)
    for kind in ("npy", "raw", "NIfTI", "HDF5", "Zarr", "TIFF"):
        folder = tmp_path / kind
        folder.mkdir()
        path, options = KINDS[kind](folder, volume)
        assert isinstance(ws.open(path, **options), ws.LazyVolume), kind
    volume.save(tmp_path / "z.nii.gz")
    assert not isinstance(ws.open(tmp_path / "z.nii.gz"), ws.LazyVolume), "one stream"
    monkeypatch.setattr("wavesplat._readers.opening.free_bytes", lambda: 5 * free)
    assert not isinstance(ws.open(*[KINDS["npy"](tmp_path, volume)[0]]), ws.LazyVolume)


def test_scenes_of_lazy_files_are_documents(tmp_path):
    path, _ = _npy(tmp_path, _volume())
    look = ws.TransferFunction([(0, 0.0), (3000, 0.4)], [(0, 1, 1, 1)])
    scene = ws.Scene(ws.open(path, memory="50 MB"), look)
    again = ws.Scene.from_json(scene.to_json(), tmp_path)
    assert isinstance(again.layers[0].volume, ws.LazyVolume)
    assert again.layers[0].volume.memory == 50 * 10**6
