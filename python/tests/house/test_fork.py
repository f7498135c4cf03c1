"""A forked child draws with threads of its own; it never waits for its parent's, which it lacks."""

from __future__ import annotations

import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(not hasattr(__import__("os"), "fork"), reason="needs fork")

#: A parent that has drawn, and a child that has some seconds for `work`.
SCRIPT = """
import os, sys, threading, time, warnings
warnings.simplefilter("ignore")
import numpy as np
import wavesplat as ws

small = ws.Volume(np.random.default_rng(1).random((24, 24, 24), np.float32))
wavelets = ws.WaveletVolume.from_volume(small)
before = ws.render(small, "grey", size=(64, 64)).rgba

def child(work):
    pid = os.fork()
    if pid == 0:
        try:
            code = 0 if work() else 2
        except BaseException as error:
            print(type(error).__name__, error, flush=True)
            code = 3
        os._exit(code)
    for _ in range(200):
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.05)
    os.kill(pid, 9)
    os.waitpid(pid, 0)
    return "it hangs"

"""

SAME = "(ws.render(small, 'grey', size=(64, 64), threads={}).rgba == before).all()"


def run(code):
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT + code], capture_output=True, text=True, timeout=100, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


#: The work of children, each forked from the one parent.
WORKS = [
    SAME.format(None),
    SAME.format(1),
    SAME.format(2),
    SAME.format(7),
    "ws.render(small, composite='x-ray', size=(9, 9)).size",
    "ws.slice(small).size",
    "ws.reference.raycast(small, 'grey', size=(4, 4)).size",
    "ws.Volume(np.ones((64, 64, 64))).value_range",
    "ws.render(ws.Volume(np.arange(64.0).reshape(4, 4, 4)), 'grey', size=(9, 9), quality='high').size",
    "wavelets.to_volume().value_range",
    "wavelets.value_range",
    "wavelets._every(2).size",
    "ws.WaveletVolume.from_volume(small).n_levels",
    "ws.render(wavelets, 'grey', size=(16, 16)).size",
    "ws.render(small, 'grey', size=(64, 64)).report['n_threads'] == os.cpu_count()",
    "child(lambda: " + SAME.format(None) + ") == 0",
]


def test_children_of_a_process_that_has_drawn():
    code = "".join(f"found[{work!r}] = child(lambda: {work})\n" for work in WORKS)
    assert run(f"found = {{}}\n{code}print({{work: code for work, code in found.items() if code != 0}})") == "{}\n"


def test_a_child_that_is_forked_during_a_frame():
    """The first frame of a large volume prepares the volume; a child must not wait for that work of its parent."""
    code = """
large = ws.Volume(np.random.default_rng(1).random((128, 128, 128), np.float32))
found = []
drawing = threading.Thread(target=lambda: ws.render(large, "grey", size=(500, 500), kernel="bspline3", quality="high"))
drawing.start()
while drawing.is_alive() and len(found) < 5:
    found.append(child(lambda: ws.render(large, "grey", size=(9, 9), kernel="bspline3", quality="draft").size))
    found.append(child(lambda: ws.render(small, "grey", size=(9, 9)).size))
drawing.join()
print(set(found))
"""
    assert run(code) == "{0}\n"


def test_multiprocessing_by_fork():
    code = """
import multiprocessing
def draw(angle):
    return ws.render(small, "grey", ws.Camera.orbit(small, angle, fit="view"), size=(32, 32)).rgba.shape
with multiprocessing.get_context("fork").Pool(2) as pool:
    print(pool.map_async(draw, range(6)).get(60) == [(32, 32, 4)] * 6)
"""
    assert run(code) == "True\n"
