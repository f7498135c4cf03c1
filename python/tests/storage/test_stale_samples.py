"""Samples that change after a lazy volume was surveyed: they are drawn, or an error asks to open the volume again."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import zarr

import wavesplat as ws
from wavesplat._cli import describe
from wavesplat._model.lazy import volume as lazy_volume
from wavesplat._model.lazy.survey import surveyed
from wavesplat._render import lazy_layers
from wavesplat._storage.zarr import chunk_files

LOOK = ws.TransferFunction([(0, 0.0), (100, 0.0), (200, 0.9)], [(0, 1.0, 1.0, 1.0)])
BRIGHT = 200


def dim(n=32):
    """Samples that the look does not show."""
    return np.random.default_rng(3).integers(0, 2, (n, n, n)).astype(np.uint8)


def drawn(volume):
    """The brightest pixel, and the largest value, of a picture and its volume."""
    return float(ws.render(volume, LOOK, "isometric", size=(32, 32)).rgba.max()), volume.value_range[1]


def assert_bright(volume):
    pixel, largest = drawn(volume)
    assert pixel > 0.05
    assert largest == BRIGHT


CHUNKED = {
    "v3": {},
    "v3, dots": {"chunk_key_encoding": {"name": "default", "separator": "."}},
    "v3, plain": {"compressors": None},
    "v2": {"zarr_format": 2},
    "v2, nested": {"zarr_format": 2, "chunk_key_encoding": {"name": "v2", "separator": "/"}},
    "shards": {"shards": (16, 16, 16)},
}


def chunked(folder, kind, samples=None):
    return zarr.create_array(
        folder / "a.zarr", data=dim() if samples is None else samples, chunks=(8,) * 3, **CHUNKED[kind]
    )


@pytest.mark.parametrize("kind", CHUNKED)
def test_a_chunk_among_many_that_is_written_anew_is_drawn(kind, tmp_path):
    array = chunked(tmp_path, kind)
    path = tmp_path / "a.zarr"
    same, held = ws.open(path, memory="50 MB"), ws.Volume.lazy(array, memory="50 MB")
    for volume in (same, held, ws.open(path, memory="50 MB")):
        assert drawn(volume) == (0.0, 1.0)
    array[9:15, 9:15, 17:23] = BRIGHT
    assert_bright(ws.open(path, memory="50 MB"))
    assert_bright(ws.Volume.lazy(zarr.open_array(path), memory="50 MB"))
    # Open volumes check for changes at their next picture.
    assert_bright(same)
    assert_bright(held)
    array[9:15, 9:15, 17:23] = 0
    assert drawn(same) == (0.0, 1.0)


OTHER_PROCESS = """
import sys
import wavesplat as ws
print(ws.open(sys.argv[1], memory="50 MB").value_range[1])
"""


def test_another_process_sees_what_was_written(tmp_path):
    array = chunked(tmp_path, "v3")
    assert drawn(ws.open(tmp_path / "a.zarr", memory="50 MB")) == (0.0, 1.0)
    array[1, 2, 3] = BRIGHT
    done = subprocess.run(
        [sys.executable, "-c", OTHER_PROCESS, str(tmp_path / "a.zarr")], capture_output=True, text=True, check=True
    )
    assert float(done.stdout) == BRIGHT


def test_a_chunk_that_is_written_in_place_with_its_old_times_is_seen(tmp_path):
    chunked(tmp_path, "v3, plain")
    volume = ws.open(tmp_path / "a.zarr", memory="50 MB")
    assert drawn(volume) == (0.0, 1.0)
    chunk = tmp_path / "a.zarr" / "c" / "1" / "1" / "2"
    before = chunk.stat()
    with chunk.open("r+b") as file:
        file.write(bytes([BRIGHT]) * 512)
    os.utime(chunk, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert_bright(ws.open(tmp_path / "a.zarr", memory="50 MB"))
    assert_bright(volume)


def test_chunks_that_come_and_go_are_seen(tmp_path):
    samples = dim()
    samples[8:16, 8:16, 16:24] = BRIGHT
    chunked(tmp_path, "v3", samples)
    volume = ws.open(tmp_path / "a.zarr", memory="50 MB")
    assert_bright(volume)
    chunk = tmp_path / "a.zarr" / "c" / "1" / "1" / "2"
    chunk.rename(tmp_path / "away")
    assert drawn(volume) == drawn(ws.open(tmp_path / "a.zarr", memory="50 MB")) == (0.0, 1.0)
    (tmp_path / "away").rename(chunk)
    assert_bright(volume)


def test_a_look_that_is_found_by_values_is_found_again(tmp_path):
    array = chunked(tmp_path, "v3", np.arange(32**3).reshape(32, 32, 32).astype(np.uint16))
    scene = ws.Scene(ws.open(tmp_path / "a.zarr", memory="50 MB"))
    before = scene.render(size=(24, 24)), ws.slice(scene, size=(24, 24))
    array[:] = np.array(array)[::-1] // 100
    whole = ws.Scene(ws.Volume(np.array(array)))
    assert np.array_equal(scene.render(size=(24, 24)).rgba, whole.render(size=(24, 24)).rgba)
    assert np.array_equal(ws.slice(scene, size=(24, 24)).rgba, ws.slice(whole, size=(24, 24)).rgba)
    assert not np.array_equal(before[0].rgba, scene.render(size=(24, 24)).rgba)


@pytest.mark.parametrize("holes", [False, True])
def test_a_chunk_that_changes_while_it_is_drawn_is_an_error_and_no_hole(tmp_path, monkeypatch, holes):
    array = chunked(tmp_path, "v3")
    volume = ws.open(tmp_path / "a.zarr", memory="50 MB", holes=holes)
    shown = ws.TransferFunction([(0, 0.1), (255, 0.1)], [(0, 1.0, 1.0, 1.0)])
    ws.render(volume, shown, size=(32, 32))
    streamed = lazy_layers.streamed

    def written_before_reading(*arguments):
        array[:] = BRIGHT
        return streamed(*arguments)

    monkeypatch.setattr(lazy_layers, "streamed", written_before_reading)
    with pytest.raises(ws.errors.FileError, match="written to while it was drawn; draw again"):
        ws.render(volume, shown, size=(32, 32))
    assert volume.read().samples.max() == BRIGHT
    monkeypatch.undo()
    ws.render(volume, shown, size=(32, 32))
    assert volume.value_range == (BRIGHT, BRIGHT)


def test_a_change_that_another_thread_finds_ends_the_picture(tmp_path, monkeypatch):
    array = chunked(tmp_path, "v3")
    volume = ws.open(tmp_path / "a.zarr", memory="50 MB")
    drawn(volume)
    streamed = lazy_layers.streamed

    def found_by_another(*arguments):
        array[9:15, 9:15, 17:23] = BRIGHT
        with ThreadPoolExecutor(1) as pool:
            assert pool.submit(lambda: volume.value_range).result() == (0, BRIGHT)
        return streamed(*arguments)

    monkeypatch.setattr(lazy_layers, "streamed", found_by_another)
    with pytest.raises(ws.errors.FileError, match="were written to while they were drawn; draw again"):
        drawn(volume)
    monkeypatch.undo()
    assert_bright(volume)


def test_an_array_that_is_made_anew_must_be_opened_again(tmp_path):
    chunked(tmp_path, "v3")
    volume = ws.open(tmp_path / "a.zarr", memory="50 MB")
    drawn(volume)
    zarr.create_array(tmp_path / "a.zarr", data=dim(48), chunks=(16,) * 3, overwrite=True)
    with pytest.raises(ws.errors.FileError, match="written anew since it was opened; open it again"):
        drawn(volume)
    zarr.open_array(tmp_path / "a.zarr", mode="r+").attrs["note"] = "attributes say nothing of samples"
    again = ws.open(tmp_path / "a.zarr", memory="50 MB")
    drawn(again)
    zarr.open_array(tmp_path / "a.zarr", mode="r+").attrs["note"] = "others"
    drawn(again)


# Files.


def _npy(path, samples):
    np.save(path, samples)
    return {}


def _raw(path, samples):
    samples.tofile(path)
    return {"shape": samples.shape, "dtype": samples.dtype}


def _nifti(path, samples):
    ws.Volume(samples).save(path)
    return {}


def _nrrd(path, samples):
    import SimpleITK

    SimpleITK.WriteImage(ws.Volume(samples).to_sitk(), str(path), False)
    return {}


def _hdf5(path, samples):
    import h5py

    with h5py.File(path, "w") as file:
        file.create_dataset("x", data=samples, chunks=(8, 8, 8))
    return {}


def _tiff(path, samples):
    import tifffile

    tifffile.imwrite(path, samples, photometric="minisblack", metadata={"axes": "ZYX"})
    return {}


FILES = {
    "a.npy": _npy,
    "a.raw": _raw,
    "a.nii": _nifti,
    "a.nrrd": _nrrd,
    "a.mha": _nrrd,
    "a.h5": _hdf5,
    "a.ome.tif": _tiff,
}


def _replaced(path, samples, write):
    write(path.with_name(f"new-{path.name}"), samples)
    path.with_name(f"new-{path.name}").replace(path)


def _written_into(path, samples, write):
    """Write into a file in place, and set its time of writing back."""
    before = path.stat()
    other = path.with_name(f"new-{path.name}")
    write(other, samples)
    with path.open("r+b") as file:
        file.write(other.read_bytes())
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


@pytest.mark.parametrize("how", [_replaced, _written_into])
@pytest.mark.parametrize("name", FILES)
@pytest.mark.every_pair
def test_a_file_that_changes_must_be_opened_again(name, how, tmp_path):
    path, write = tmp_path / name, FILES[name]
    options = write(path, dim())
    known, unread = (ws.open(path, memory="50 MB", **options) for _ in range(2))
    assert drawn(known) == (0.0, 1.0)
    bright = dim()
    bright[9:15, 9:15, 17:23] = BRIGHT
    how(path, bright, write)
    for volume in (known, unread):
        with pytest.raises(ws.errors.FileError, match=r"changed or replaced since it was opened; open it again: .*a\."):
            drawn(volume)
        with pytest.raises(ws.errors.FileError, match="open it again"):
            volume.read()
    assert_bright(ws.open(path, memory="50 MB", **options))
    path.unlink()
    with pytest.raises(ws.errors.FileError, match="not there any more|changed or replaced"):
        drawn(known)


def test_samples_beside_a_header_are_watched_too(tmp_path):
    import SimpleITK

    SimpleITK.WriteImage(ws.Volume(dim()).to_sitk(), str(tmp_path / "a.mhd"), False)
    volume = ws.open(tmp_path / "a.mhd", memory="50 MB")
    assert drawn(volume) == (0.0, 1.0)
    np.full((32,) * 3, BRIGHT, np.uint8).tofile(tmp_path / "a.raw")
    with pytest.raises(ws.errors.FileError, match=r"open it again: .*a\.raw"):
        drawn(volume)
    assert ws.open(tmp_path / "a.mhd", memory="50 MB").value_range == (BRIGHT, BRIGHT)


def test_a_slice_of_a_folder_is_watched(tmp_path):
    import tifffile

    for k, one in enumerate(dim()):
        tifffile.imwrite(tmp_path / f"s{k}.tif", one)
    volume = ws.open(tmp_path, memory="50 MB")
    assert drawn(volume) == (0.0, 1.0)
    tifffile.imwrite(tmp_path / "s7.tif", np.full((32, 32), BRIGHT, np.uint8))
    with pytest.raises(ws.errors.FileError, match=r"open it again: .*s7\.tif"):
        drawn(volume)
    assert_bright(ws.open(tmp_path, memory="50 MB"))


def _virtual(h5py, path):
    layout = h5py.VirtualLayout((32, 32, 32), np.uint8)
    layout[:] = h5py.VirtualSource("part.h5", "x", shape=(32, 32, 32))
    with h5py.File(path, "w") as file:
        file.create_virtual_dataset("x", layout)


def _virtual_of_virtual(h5py, path):
    _virtual(h5py, path.with_name("between.h5"))
    layout = h5py.VirtualLayout((32, 32, 32), np.uint8)
    layout[:] = h5py.VirtualSource("between.h5", "x", shape=(32, 32, 32))
    with h5py.File(path, "w") as file:
        file.create_virtual_dataset("x", layout)


@pytest.mark.parametrize("make", [_virtual, _virtual_of_virtual])
def test_parts_of_hdf5_in_other_files_are_watched(make, tmp_path):
    h5py = pytest.importorskip("h5py")
    _hdf5(tmp_path / "part.h5", dim())
    make(h5py, tmp_path / "a.h5")
    volume = ws.open(tmp_path / "a.h5", memory="50 MB", external_files=True)
    assert drawn(volume) == (0.0, 1.0)
    (tmp_path / "part.h5").unlink()
    _hdf5(tmp_path / "part.h5", np.full((32,) * 3, BRIGHT, np.uint8))
    with pytest.raises(ws.errors.FileError, match=r"open it again: .*part\.h5"):
        drawn(volume)
    again = ws.open(tmp_path / "a.h5", memory="50 MB", external_files=True)
    assert again.value_range == (BRIGHT, BRIGHT)


def test_external_storage_of_hdf5_is_watched(tmp_path):
    h5py = pytest.importorskip("h5py")
    data = tmp_path / "data.bin"
    dim().tofile(data)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("x", (32, 32, 32), np.uint8, external=[(str(data), 0, 32**3)])
    volume = ws.open(tmp_path / "a.h5", memory="50 MB", external_files=True)
    assert drawn(volume) == (0.0, 1.0)
    np.full(32**3, BRIGHT, np.uint8).tofile(data)
    with pytest.raises(ws.errors.FileError, match=r"open it again: .*data\.bin"):
        drawn(volume)
    assert ws.open(tmp_path / "a.h5", memory="50 MB", external_files=True).value_range == (BRIGHT, BRIGHT)


# Objects of other libraries.


def test_a_dask_name_says_nothing_of_samples():
    dask = pytest.importorskip("dask.array")
    one, other = (dask.from_array(samples, chunks=16, name="the same") for samples in (dim(), dim() + BRIGHT - 1))
    assert ws.Volume.lazy(one, memory="50 MB").value_range == (0, 1)
    assert ws.Volume.lazy(other, memory="50 MB").value_range == (BRIGHT - 1, BRIGHT)


def test_maps_and_open_files_that_are_written_to_are_not_kept(tmp_path):
    import h5py

    np.save(tmp_path / "a.npy", dim())
    for mode in ("r", "r+", "c"):
        mapped = np.load(tmp_path / "a.npy", mmap_mode=mode)
        if mode != "r":
            mapped[3, 4, 5] = BRIGHT
        assert ws.Volume.lazy(mapped, memory="50 MB").value_range[1] == (1 if mode == "r" else BRIGHT)
        mapped = np.load(tmp_path / "a.npy", mmap_mode="r+")
        mapped[3, 4, 5] = 1
        mapped.flush()
    assert ws.Volume.lazy(np.load(tmp_path / "a.npy", mmap_mode="r"), memory="50 MB").value_range[1] == 1
    _hdf5(tmp_path / "a.h5", dim())
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        for value in (BRIGHT, 1):
            file["x"][3, 4, 5] = value
            assert ws.Volume.lazy(file["x"], memory="50 MB").value_range[1] == value
    with h5py.File(tmp_path / "a.h5") as file:
        assert ws.Volume.lazy(file["x"], memory="50 MB").value_range[1] == 1


# Samples that did not change.


def _passes(monkeypatch):
    """Count passes over chunk files."""
    passes = []
    made = chunk_files._ChunkScan.__init__

    def counted(self, *args):
        passes.append(args)
        made(self, *args)

    monkeypatch.setattr(chunk_files._ChunkScan, "__init__", counted)
    return passes


def test_what_did_not_change_is_drawn_from_what_was_kept_after_one_pass(tmp_path, monkeypatch, wavesplat):
    chunked(tmp_path, "v3")
    path = tmp_path / "a.zarr"
    first = ws.render(ws.open(path, memory="50 MB"), LOOK, size=(32, 32))
    assert first.report["lazy"]["surveys"] == ["computed"]
    passes = _passes(monkeypatch)
    volume = ws.open(path, memory="50 MB")
    assert not passes, "opening costs nothing"
    again = ws.render(volume, LOOK, size=(32, 32))
    assert len(passes) == 1
    assert again.report["lazy"]["surveys"] == ["from the cache"]
    assert again.report["lazy"]["bytes_read"] == 0, "nothing shows"
    ws.render(volume, LOOK, size=(32, 32))
    assert len(passes) == 2, "one for every picture"
    done = wavesplat("render", path, "--memory", "50MB", "--size", "32", "-o", tmp_path / "a.png")
    assert "from the cache" in done.stderr
    done = wavesplat("render", path, "--memory", "50MB", "--cache", "off", "--size", "32", "-o", tmp_path / "a.png")
    assert "from the cache" not in done.stderr
    assert "from the cache" in wavesplat("info", path, "--memory", "50MB").stdout


def test_info_looks_at_the_files_once(tmp_path, monkeypatch):
    monkeypatch.setattr(lazy_volume, "SMALL", 1000)
    chunked(tmp_path, "v3")
    passes = _passes(monkeypatch)
    for is_from_cache in (False, True):
        volume = ws.open(tmp_path / "a.zarr", memory="50 MB")
        if not is_from_cache:
            assert describe.describe(volume)["value_range"] is None, "not looked through yet"
            assert volume.value_range == (0, 1)
        passes.clear()
        facts = describe.describe(volume)
        assert len(passes) == 1
        assert (facts["is_from_cache"], facts["value_range"]) == (is_from_cache, [0, 1])


def test_volumes_of_one_file_find_a_change_once(tmp_path, monkeypatch):
    array = chunked(tmp_path, "v3")
    whole = ws.open(tmp_path / "a.zarr", memory="50 MB")
    finest = whole.at_level(0)
    assert finest.value_range == whole.value_range == (0.0, 1.0)
    surveys = []
    computed = surveyed
    monkeypatch.setattr(lazy_volume, "surveyed", lambda *a, **k: surveys.append(1) or computed(*a, **k))
    array[1, 2, 3] = BRIGHT
    assert finest.value_range == whole.value_range == finest.value_range == (0.0, BRIGHT)
    assert len(surveys) == 1


def test_a_look_is_chosen_again_once_samples_are_said_to_have_changed():
    samples = np.arange(32**3).reshape(32, 32, 32).astype(np.uint16)
    volume = ws.Volume.lazy(samples, memory="50 MB")
    scene = ws.Scene(volume)
    scene.render(size=(24, 24))
    samples[:] = samples[::-1].copy() // 100
    volume.changed()
    whole = ws.Scene(ws.Volume(samples.copy())).render(size=(24, 24), device="cpu")
    assert np.array_equal(scene.render(size=(24, 24)).rgba, whole.rgba)


def test_files_that_did_not_change_are_kept_too(tmp_path):
    for name, write in FILES.items():
        options = write(tmp_path / name, dim())
        for known in ("computed", "from the cache"):
            picture = ws.render(ws.open(tmp_path / name, memory="50 MB", **options), LOOK, size=(32, 32))
            assert picture.report["lazy"]["surveys"] == [known], name


def test_long_passes_are_not_made_for_every_picture_but_folders_are_looked_at(tmp_path, monkeypatch):
    array = chunked(tmp_path, "v3")
    monkeypatch.setattr(chunk_files, "LONG_PASS", 0.0)
    monkeypatch.setattr(chunk_files, "SHARE", 1e6)
    volume = ws.open(tmp_path / "a.zarr", memory="50 MB")
    assert drawn(volume) == (0.0, 1.0)
    passes = _passes(monkeypatch)
    assert drawn(volume) == (0.0, 1.0)
    assert not passes
    array[9:15, 9:15, 17:23] = BRIGHT  # zarr renames chunks into place
    assert_bright(volume)
    assert len(passes) >= 1
