"""The standard error stream, which readers mute, is restored, whichever threads read at the same time."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._system.libraries import muted_stderr
from wavesplat.errors import FileError


@pytest.fixture
def image(tmp_path):
    import SimpleITK

    path = tmp_path / "a.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(np.zeros((4, 5, 6), np.int16)), str(path))
    return path


def places():
    return [str(Path(f"/proc/self/fd/{number}").readlink()) for number in (1, 2)]


@pytest.mark.skipif(sys.platform != "linux", reason="asks /proc where the streams lead")
def test_streams_are_restored_after_reading_in_threads(image):
    before = places()
    with ThreadPoolExecutor(8) as threads:
        list(threads.map(lambda _: ws.open(image), range(64)))
    assert places() == before


@pytest.mark.skipif(sys.platform != "linux", reason="asks /proc where the streams lead")
def test_those_who_overlap_restore_the_stream_together():
    before = places()
    first, second = muted_stderr(), muted_stderr()
    first.__enter__()
    second.__enter__()
    first.__exit__(None, None, None)
    assert places() == [before[0], os.devnull]
    second.__exit__(None, None, None)
    assert places() == before


@pytest.mark.skipif(sys.platform != "linux", reason="asks /proc where the streams lead")
@pytest.mark.filterwarnings("ignore:.*use of fork:DeprecationWarning")
def test_a_forked_child_has_its_streams():
    before = places()
    with muted_stderr():
        child = os.fork()
        if child == 0:
            os._exit(0 if places() == before else 1)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_results_on_stdout_are_never_hidden(capfd):
    inside, printed = threading.Event(), threading.Event()

    def read():
        with muted_stderr():
            inside.set()
            printed.wait()

    reader = threading.Thread(target=read)
    reader.start()
    inside.wait()
    os.write(1, b"a result\n")
    printed.set()
    reader.join()
    assert capfd.readouterr().out == "a result\n"


@pytest.mark.skipif(sys.platform == "win32", reason="a shell that closes streams")
@pytest.mark.parametrize("closed", ["2>&-", "<&- 2>&-"])
def test_a_process_without_a_stream_reads(image, closed):
    code = f"import wavesplat as ws; print(ws.open({str(image)!r}).shape)"
    command = f'"{sys.executable}" -c "{code}" {closed}'
    done = subprocess.run(command, shell=True, stdout=subprocess.PIPE, check=True, timeout=60)  # noqa: S602
    assert done.stdout == b"(4, 5, 6)\n"


def test_damage_is_told_in_the_error_alone(image, capfd):
    image.write_bytes(image.read_bytes()[:-20])
    with pytest.raises(FileError):
        ws.open(image)
    assert capfd.readouterr() == ("", "")
