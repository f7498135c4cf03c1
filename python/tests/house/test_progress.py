"""Work in its own thread: its results, and Ctrl-C during it and during a frame."""

import signal
import subprocess
import sys
import threading
import time

import pytest
from interrupts import ANSWER_S, ctrl_c_after

import wavesplat as ws
from wavesplat._cli import progress


@pytest.fixture
def interruptible():
    """Make Ctrl-C raise, as in a shell: a background job, which tests may be, starts with it ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_it_returns_what_the_work_returns():
    assert progress.run(lambda report: report(0.5), "Working", shown=False) is True


def test_it_raises_what_the_work_raises():
    with pytest.raises(ZeroDivisionError):
        progress.run(lambda _: 1 / 0, "Working", shown=False)


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize("shown", [False, True])
def test_ctrl_c_waits_until_the_work_has_stopped(shown):
    stopped = threading.Event()

    def work(report):
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
        while report(0.5):
            time.sleep(0.01)
        time.sleep(0.3)
        stopped.set()

    with pytest.raises(KeyboardInterrupt):
        progress.run(work, "Working", shown=shown)
    assert stopped.is_set()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_a_second_ctrl_c_does_not_wait():
    script = """
import signal, threading, time
from wavesplat._cli import progress

signal.signal(signal.SIGINT, signal.default_int_handler)

def work(report):
    for _ in range(2):
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
        while report(0.5):
            time.sleep(0.01)
    time.sleep(3600)

progress.run(work, "Working", shown=False)
"""
    done = subprocess.run([sys.executable, "-c", script], timeout=600, check=False)
    assert done.returncode == 130


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize("threads", [None, 1, 3])
def test_ctrl_c_stops_a_frame(threads):
    """Without a progress callback the thread that draws checks for signals itself."""
    scan = ws.examples.mri_head()
    with ctrl_c_after(0.5) as seconds_since:
        with pytest.raises(KeyboardInterrupt):
            ws.render(scan, size=(2000, 2000), quality=ws.Sampling(64, 8), threads=threads, device="cpu")
        # The whole frame takes many minutes.
        assert seconds_since() < ANSWER_S
    assert ws.render(scan, size=(8, 8), threads=threads).rgba.any()


#: Slow functions: the rays and the sheets of a picture of this size take minutes.
SLOW = {
    "raycast": lambda scan: ws.reference.raycast(scan, size=(600, 600), rays_per_pixel=16, kernel="bspline3"),
    "splat_literal": lambda scan: ws.reference.splat_literal(scan, size=(1600, 1600), kernel="bspline3"),
    "study.splat": lambda scan: ws.study.splat(scan, size=(1000, 1000), sheets_per_slice=4),
}


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize("what", SLOW)
def test_ctrl_c_stops_the_slow_renderers(what):
    scan = ws.examples.ct_pelvis()
    with ctrl_c_after(1.0) as seconds_since:
        with pytest.raises(KeyboardInterrupt):
            SLOW[what](scan)
        assert seconds_since() < ANSWER_S
