"""Volumes that do not fit into memory: refused in one sentence, before the system or an allocator ends the process."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from cases_of_the_day import nightly

import wavesplat as ws
from wavesplat._storage.reading import reading
from wavesplat._system import memory
from wavesplat.errors import FileError, LimitError

LIMIT_BYTES = 4 << 30

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits the address space")


def limited(*arguments):
    """Run the command line in a process that may take 4 GiB."""

    def limit():
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (LIMIT_BYTES, LIMIT_BYTES))

    command = [sys.executable, "-m", "wavesplat", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, preexec_fn=limit)


def refused(done, message):
    assert done.returncode == 1, done.stderr
    assert done.stderr.startswith("wavesplat: error: ")
    assert done.stderr.count("\n") == 1
    assert message in done.stderr
    assert "this machine has" in done.stderr


@pytest.mark.parametrize(
    "options",
    [
        ["render", "--size", "16384x16384", "--composite", "maximum"],
        # By day one picture of one command: the limit is one function.
        *nightly(["render", "--size", "8192x8192", "--oversampling", "3"], ["slice", "--size", "16384x16384"]),
    ],
)
def test_pictures_that_do_not_fit(ramp_file, tmp_path, options):
    done = limited(options[0], ramp_file, "-o", tmp_path / "a.png", *options[1:])
    refused(done, f"the pixels of a picture of {options[2].replace('x', ' x ')} need ")
    assert not (tmp_path / "a.png").exists()


def test_pictures_that_fit_are_drawn(ramp_file, tmp_path):
    assert limited("render", ramp_file, "-o", tmp_path / "a.png", "--size", "64x64", "-q").returncode == 0


@pytest.mark.parametrize("name", ["a.nii", "a.npy", "a.mha", "a.raw"])
def test_samples_that_do_not_fit_are_left_in_their_file(tmp_path, name):
    """The file has 20 GB of samples, but is sparse, so that it takes no room on the disk."""
    path, size, options = tmp_path / name, (2000, 2500, 4000), []
    if name == "a.nii":
        import nibabel

        header = nibabel.Nifti1Header()
        header.set_data_dtype(np.uint8)
        header.set_data_shape(size)
        path.write_bytes(header.binaryblock + bytes(4))
    elif name == "a.npy":
        with path.open("wb") as file:
            np.lib.format.write_array_header_1_0(file, {"descr": "|u1", "fortran_order": False, "shape": size})
    elif name == "a.mha":
        text = "ObjectType = Image\nNDims = 3\nDimSize = 2000 2500 4000\nElementType = MET_UCHAR\n"
        path.write_text(text + "ElementDataFile = LOCAL\n")
    else:
        path.touch()
        options = ["--shape", "2000,2500,4000", "--dtype", "uint8"]
    os.truncate(path, path.stat().st_size + 2000 * 2500 * 4000)
    done = limited("info", path, *options)
    assert done.returncode == 0, done.stderr
    assert "values       not looked through yet" in done.stdout


def test_an_hdf5_file_that_promises_much_and_holds_nothing(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("raw", (2000, 2500, 4000), "u1", chunks=(64, 64, 64))
        file.create_dataset("zeros", (32, 32, 32), "f4", chunks=(8, 8, 8))
    assert (tmp_path / "a.h5").stat().st_size < 5000
    with pytest.raises((FileError, LimitError), match=r"need 20000000000 bytes, the file holds|need 18\.6 GiB"):
        ws.open(tmp_path / "a.h5", dataset="raw")
    assert ws.open(tmp_path / "a.h5", dataset="zeros").value_range == (0, 0)


@pytest.mark.parametrize("name", ["a.npz", "a.wavelets"])
def test_archives_that_promise_much_and_hold_little(tmp_path, name):
    header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2000, 2500, 4000), }".ljust(117) + "\n"
    with zipfile.ZipFile(tmp_path / name, "w") as archive:
        archive.writestr("values.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", 118) + header.encode() + bytes(100))
    load = ws.WaveletVolume.load if name == "a.wavelets" else ws.open
    with pytest.raises(FileError, match=r"need 80000000000 bytes, the file holds"):
        load(tmp_path / name)


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        RuntimeError("sitk::ERROR: Failed to allocate memory for image."),
        RuntimeError("std::bad_alloc"),
    ],
)
def test_memory_that_runs_out_is_not_called_damage(error):
    with (
        pytest.raises(LimitError, match=r"reading NIfTI takes more memory than there is, of which .* GiB; .*: a\.nii$"),
        reading("NIfTI", "a.nii"),
    ):
        raise error


def test_a_container_has_what_it_is_given(tmp_path, monkeypatch):
    """The page cache of files that were read does not count as used memory."""
    for name, text in (
        ("memory.max", "1000"),
        ("memory.current", "600"),
        ("memory.stat", "anon 300\ninactive_file 250"),
    ):
        (tmp_path / name).write_text(text)

    monkeypatch.setattr(memory, "Path", lambda place: tmp_path if place == "/sys/fs/cgroup" else tmp_path / "no")
    assert memory.free_bytes() == 650
    (tmp_path / "memory.max").write_text("max\n")
    assert memory.free_bytes() == os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
