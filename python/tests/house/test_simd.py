"""`WAVESPLAT_SIMD` names the vector instructions of a process; pictures do not depend on it."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
import sys

import pytest

import wavesplat as ws

ON_X86 = platform.machine().lower() in ("x86_64", "amd64")

DRAW = """
import hashlib, wavesplat as ws
volume = ws.examples.ct_pelvis()
digest = hashlib.sha256()
for options in ({"composite": "over"}, {"composite": "maximum"}, {"composite": "over", "kernel": "bspline3"}):
    camera = ws.Camera.orbit(volume, 25, 15, view_angle=30, fit="view")
    picture = ws.render(volume, "ct-soft-tissue", camera, size=(72, 56), **options)
    digest.update(picture.rgba.tobytes())
print(picture.report["simd"], digest.hexdigest())
"""


def _draw(vectors=None):
    environment = {name: value for name, value in os.environ.items() if name != "WAVESPLAT_SIMD"}
    if vectors is not None:
        environment["WAVESPLAT_SIMD"] = vectors
    return subprocess.run(
        [sys.executable, "-c", DRAW], capture_output=True, encoding="utf-8", timeout=120, check=False, env=environment
    )


def _vectors_and_hash(done):
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_an_unknown_name_fails_and_the_known_ones_are_named():
    done = _draw("nonsense")
    assert done.returncode != 0
    message = done.stderr.strip().splitlines()[-1]
    assert message.startswith("ImportError: WAVESPLAT_SIMD: "), done.stderr
    assert "'nonsense'" in message or '"nonsense"' in message
    for name in (*(["sse2"] if ON_X86 else []), _vectors_and_hash(_draw())[0]):
        assert name in message.partition("it has")[2], message


@pytest.mark.skipif(not ON_X86, reason="vectors of x86")
def test_pictures_are_the_same_to_the_bit_with_other_vectors():
    widest, want = _vectors_and_hash(_draw())
    used, got = _vectors_and_hash(_draw("sse2"))
    assert used == "sse2"
    assert got == want, f"{used} draws other pictures than {widest}"


def test_the_hash_is_that_of_this_process():
    """This shows that the processes above drew the right picture."""
    volume = ws.examples.ct_pelvis()
    digest = hashlib.sha256()
    for options in ({"composite": "over"}, {"composite": "maximum"}, {"composite": "over", "kernel": "bspline3"}):
        camera = ws.Camera.orbit(volume, 25, 15, view_angle=30, fit="view")
        digest.update(ws.render(volume, "ct-soft-tissue", camera, size=(72, 56), **options).rgba.tobytes())
    assert _vectors_and_hash(_draw())[1] == digest.hexdigest()
