"""Wrong kinds of files, folders and streams: the error is one sentence, without a traceback; nothing is left behind."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._storage.output import write_atomically, write_folder_atomically
from wavesplat.errors import FileError

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="places that POSIX has")

NOT_UTF8 = os.fsdecode(b"\xff\xfe")


def run(*arguments, cwd=None, stdout=subprocess.PIPE, shell_closes="", code=None, **environment):
    start = ["-m", "wavesplat"] if code is None else ["-c", code]
    command = [sys.executable, *start, *map(str, arguments)]
    if shell_closes:
        command = ["sh", "-c", f'exec "$@" {shell_closes}', "sh", *command]
    env = {name: value for name, value in os.environ.items() if not name.startswith(("LC_", "LANG"))}
    # The package may be found by a path that depends on where this process runs.
    env["PYTHONPATH"] = os.pathsep.join(str(Path(path).absolute()) for path in sys.path if path)
    return subprocess.run(
        command, stdout=stdout, stderr=subprocess.PIPE, timeout=60, check=False, cwd=cwd, env=env | environment
    )


def says(done, message, code=1):
    """Check the exit code, and that stderr is one sentence with a message."""
    stderr = done.stderr if isinstance(done.stderr, str) else done.stderr.decode("utf-8", "replace")
    assert done.returncode == code, stderr
    assert stderr.startswith("wavesplat: error: ")
    assert stderr.count("\n") == 1
    assert message in stderr
    assert "mistake of wavesplat" not in stderr


@pytest.fixture
def volume(tmp_path):
    path = tmp_path / "a.npy"
    np.save(path, np.linspace(0, 255, 512).reshape(8, 8, 8).astype(np.uint8))
    return path


@pytest.fixture
def locked(tmp_path):
    """A folder that this process may not read, even if it runs as root."""
    folder = tmp_path / "locked"
    folder.mkdir()
    (folder / "a.npy").touch()
    folder.chmod(0)
    user = os.geteuid()
    if user == 0:
        tmp_path.chmod(0o755)
        for parent in tmp_path.parents[:2]:
            parent.chmod(0o755)
        os.seteuid(65534)
    yield folder
    os.seteuid(user)
    folder.chmod(0o755)


# Pipes ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["a.nii.gz", "a.npy", "a.nrrd", "a.tif", "a.h5", "a.vti", "a.dcm", "a.raw", "a", "a.wavelets"]
)
def test_a_pipe_as_input(wavesplat, tmp_path, name):
    os.mkfifo(tmp_path / name)
    says(
        wavesplat("info", tmp_path / name), "not a file but a device, a pipe or a socket; copy what it gives to a file"
    )
    options = ["--shape", "2,2,2", "--dtype", "uint8"]
    if name == "a.raw":
        says(wavesplat("info", tmp_path / name, *options), "not a file but a device, a pipe")


@pytest.mark.parametrize("name", ["pipe", "pipe.tif", "zarr.json"])
def test_a_folder_with_a_pipe(wavesplat, tmp_path, name):
    (tmp_path / "series").mkdir()
    os.mkfifo(tmp_path / "series" / name)
    says(wavesplat("info", tmp_path / "series"), f"the folder holds '{name}', which is a device, a pipe or a socket")
    (tmp_path / "series" / "a.dcm").write_bytes(bytes(200))
    says(wavesplat("info", tmp_path / "series" / "a.dcm"), f"the folder holds '{name}', which is a device")


@pytest.mark.parametrize("option", ["--tf", "--label-table", "--materials"])
def test_a_pipe_as_a_table(wavesplat, tmp_path, volume, option):
    os.mkfifo(tmp_path / "pipe.json")
    more = ["--labels", volume] if option == "--label-table" else []
    done = wavesplat("render", volume, "-o", tmp_path / "a.png", option, tmp_path / "pipe.json", *more)
    says(done, "not a file but a device, a pipe")


def test_a_device_as_a_table(wavesplat, volume, tmp_path):
    says(wavesplat("render", volume, "-o", tmp_path / "a.png", "--tf", "/dev/zero"), "not a file but a device")


# Names ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "environment", [{}, {"LC_ALL": "C"}, {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}]
)
@pytest.mark.parametrize("stem", [NOT_UTF8, "日本é"])
def test_names_of_any_letters(volume, tmp_path, stem, environment):
    volume = volume.rename(tmp_path / f"{stem}.npy")
    out = tmp_path / f"{stem}.png"
    done = run("render", volume, "-o", out, "--size", "9x9", **environment)
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout == os.fsencode(out) + b"\n"
    assert out.stat().st_size > 0
    assert run("info", volume, "--json", **environment).returncode == 0
    says(run("info", tmp_path / f"{stem}.nii", **environment), "no such file or folder")


@pytest.mark.parametrize("place", ["a.mha", "a.dcm", "series"])
def test_names_that_itk_cannot_take(tmp_path, place):
    place = tmp_path / (NOT_UTF8 + place)
    if place.name.endswith("series"):
        place.mkdir()
        (place / "1").write_bytes(bytes(200))
    else:
        place.write_bytes(bytes(200))
    says(run("info", place), "the name is not UTF-8")


def test_names_in_a_series_that_itk_cannot_take(tmp_path):
    (tmp_path / NOT_UTF8).write_bytes(bytes(200))
    says(run("info", tmp_path), "the name is not UTF-8")


def test_a_volume_may_have_any_name():
    samples = np.arange(8, dtype=np.uint8).reshape(2, 2, 2)
    ws.Volume(samples, name=NOT_UTF8)
    with pytest.raises(ws.errors.ArgumentError, match="volume '��'|volume .*2-D"):
        ws.Volume(samples[0], name=NOT_UTF8)


@pytest.mark.parametrize("name", ["x" * 300 + ".npy", "y" * 5000 + "/a.npy", "~nobody-here/a.npy", "a\n\tb.npy"])
def test_names_that_are_none(wavesplat, tmp_path, name):
    done = wavesplat("info", name, cwd=tmp_path)
    says(done, "")


@pytest.mark.parametrize(
    ("name", "message"), [("x" * 300 + ".png", "File name too long; shorten the name"), ("no/a.png", "does not exist")]
)
def test_names_of_outputs_that_are_none(wavesplat, volume, tmp_path, name, message):
    says(wavesplat("render", volume, "-o", tmp_path / name), message)
    says(wavesplat("render", volume, "-o", tmp_path / "a.png", "--report", tmp_path / name), message)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["a.npy"]


def test_the_longest_names_are_written(volume, tmp_path):
    out = tmp_path / ("x" * 251 + ".png")
    assert run("render", volume, "-o", out, "--size", "9x9").returncode == 0
    assert out.stat().st_size > 0


@pytest.mark.parametrize("path", ["~nobody-here/a.npy", "a\0b.npy", "x" * 300])
def test_names_in_python(path):
    for load in (ws.open, ws.WaveletVolume.load, ws.TransferFunction.load, ws.Labels.open):
        with pytest.raises(FileError, match=r"there is no home folder|embedded null|too long"):
            load(path)


@pytest.mark.parametrize("path", [None, 3, ["a"]])
def test_what_is_no_name_at_all(path):
    for load in (ws.open, ws.WaveletVolume.load):
        with pytest.raises(ws.errors.ArgumentError, match=r"path is .*; give the name of a file"):
            load(path)


# Folders --------------------------------------------------------------------------------------------------------------


def test_a_locked_folder(locked):
    for path in (locked, locked / "a.npy"):
        with pytest.raises(FileError, match="[Pp]ermission"):
            ws.open(path)
    for load in (ws.TransferFunction.load, ws.WaveletVolume.load):
        with pytest.raises(FileError, match="[Pp]ermission"):
            load(locked / "a.json")
    with pytest.raises(FileError, match="cannot write: .*[Pp]ermission"):
        ws.Picture(np.zeros((4, 4, 4), np.float32)).save(locked / "a.png")
    with pytest.raises(FileError, match="cannot write: .*[Pp]ermission"):
        ws.Picture(np.zeros((4, 4, 4), np.float32)).save(locked / "sub" / "a.png")


def test_links_in_a_circle(volume, tmp_path):
    (tmp_path / "loop.png").symlink_to("loop.png")
    (tmp_path / "loop.npy").symlink_to("loop.npy")
    says(run("info", tmp_path / "loop.npy"), "Too many levels of symbolic links")
    done = run("render", volume, "-o", tmp_path / "loop.png", "--size", "9x9")
    if done.returncode:
        says(done, "links lead round in a circle")


DELETED = """
import os, sys
os.mkdir("gone")
os.chdir("gone")
os.rmdir("../gone")
from wavesplat._cli import main
main()
"""


@pytest.mark.parametrize("output", ["a.png", "HERE/a.png"])
def test_a_working_folder_that_was_deleted(volume, tmp_path, output):
    arguments = ["render", volume, "-o", output.replace("HERE", str(tmp_path)), "--size", "9x9"]
    done = run(*arguments, code=DELETED, cwd=tmp_path)
    if output == "a.png":
        says(done, "cannot write: ")
    else:
        assert (done.returncode, done.stderr) == (0, b"")


# Streams --------------------------------------------------------------------------------------------------------------


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a disk that is full")
@pytest.mark.parametrize("json", [pytest.param([], marks=pytest.mark.nightly), ["--json"]])  # by day the longer one
def test_results_to_a_full_disk(volume, tmp_path, json):
    out = tmp_path / "a.png"
    with Path("/dev/full").open("wb") as full:
        says(run("info", volume, *json, stdout=full), "cannot print the result: No space left on device")
        done = run("render", volume, "-o", out, "--size", "9x9", *json, stdout=full)
        says(done, f"cannot print the result: No space left on device; what it is about is written: {out}")
        says(run("slice", volume, "-o", out, *json, stdout=full), f"what it is about is written: {out}")
        says(run("--version", stdout=full), "cannot print the result")
        says(run("render", "--help", stdout=full), "No space left on device")
    assert out.stat().st_size > 0


@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&- <&-"])
def test_closed_streams(volume, tmp_path, closed):
    out = tmp_path / "a.png"
    assert run("render", volume, "-o", out, "--size", "9x9", shell_closes=closed).returncode == 0
    assert out.stat().st_size > 0
    assert run("info", tmp_path / "no.npy", shell_closes=closed).returncode == 1


def test_json_of_what_is_infinite(tmp_path):
    np.save(tmp_path / "a.npy", np.full((4, 4, 4), 7, np.uint8))
    done = run("wavelet", tmp_path / "a.npy", "--threshold", "inf", "--json")
    assert done.returncode == 0
    assert json.loads(done.stdout)["threshold"] is None


def test_no_memory_for_the_compiled_module():
    """As the system's linker says it within `ulimit -v 150000`."""
    from wavesplat._cli import _explained

    said, _ = _explained(ImportError("/a/_native.abi3.so: failed to map segment from shared object"))
    assert "not enough memory" in said
    assert "mistake" not in said


# Signals --------------------------------------------------------------------------------------------------------------

HALF = """
import pathlib, sys, time
from wavesplat._storage.output import write_atomically, write_folder_atomically
def half(part):
    part.write_bytes(b"half")
    print("half", flush=True)
    time.sleep(60)
write_atomically(pathlib.Path(sys.argv[1]), half)
"""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_process_that_is_told_to_end_leaves_no_part_of_a_file(tmp_path, number):
    with subprocess.Popen([sys.executable, "-c", HALF, tmp_path / "a.png"], stdout=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"half\n"
        assert len(list(tmp_path.iterdir())) == 1
        process.send_signal(number)
        assert process.wait(30) == -number
    assert list(tmp_path.iterdir()) == []


KILLED = """
import os, sys
from wavesplat._storage.output import write_folder_atomically
def half(part):
    (part / "0").mkdir()
    (part / "0" / "c").write_bytes(b"half")
    print(part.name, flush=True)
    os.kill(os.getpid(), 9)
write_folder_atomically(sys.argv[1], half)
"""


def test_what_a_killed_process_left_is_removed_by_the_next_output_there(tmp_path):
    command = [sys.executable, "-c", KILLED, tmp_path / "a.ome.zarr"]
    left = subprocess.run(command, check=False, stdout=subprocess.PIPE, text=True).stdout.strip()
    assert [entry.name for entry in tmp_path.iterdir()] == [left]
    pid, number, machine = left.strip(".").removesuffix(".part").split("-")
    # Of this process, which is alive; of other machines; and what was there before an output: all may be needed.
    others = {f".{os.getpid()}-99999-{machine}.part", f".{pid}-{number}-00000000.part", f".{pid}-9-{machine}.old"}
    for name in others:
        (tmp_path / name).mkdir()
    (tmp_path / f".{pid}-7-{machine}.part.png").write_bytes(b"half")
    write_folder_atomically(tmp_path / "b.ome.zarr", lambda part: (part / "zarr.json").write_text("{}"))
    assert {entry.name for entry in tmp_path.iterdir()} == {"b.ome.zarr", *others}


def test_links_stay_and_what_they_lead_to_is_replaced(tmp_path):
    there = tmp_path / "there"
    there.mkdir()
    (tmp_path / "a.txt").symlink_to(there / "a.txt")
    (tmp_path / "b.ome.zarr").symlink_to("there/b.ome.zarr")
    for text in ("old", "new"):
        write_atomically(tmp_path / "a.txt", lambda part, text=text: part.write_text(text))
        ws.Volume(np.full((2, 2, 2), len(text), np.uint8)).save(tmp_path / "b.ome.zarr")
        assert (tmp_path / "a.txt").is_symlink()
        assert (there / "a.txt").read_text() == text
        assert (there / "b.ome.zarr" / "zarr.json").exists()
    with pytest.raises(ZeroDivisionError):
        write_atomically(tmp_path / "a.txt", lambda part: part.write_text("half") / 0)
    assert (there / "a.txt").read_text() == "new"
    assert {entry.name for entry in there.iterdir()} == {"a.txt", "b.ome.zarr"}
    assert {entry.name for entry in tmp_path.iterdir()} == {"there", "a.txt", "b.ome.zarr"}


def test_signals_are_as_they_were(tmp_path):
    before = signal.getsignal(signal.SIGTERM)
    write_atomically(tmp_path / "a.txt", lambda part: part.write_text("a"))
    assert signal.getsignal(signal.SIGTERM) is before


def test_files_that_are_written_at_once_are_whole(tmp_path):
    from concurrent.futures import ThreadPoolExecutor

    def save(letter):
        def write(part):
            for _ in range(20):
                with part.open("a") as file:
                    file.write(letter)
                time.sleep(0.001)

        write_atomically(tmp_path / "a.txt", write)

    with ThreadPoolExecutor(8) as threads:
        list(threads.map(save, "abcdefgh"))
    text = (tmp_path / "a.txt").read_text()
    assert text == text[0] * 20
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.txt"]
