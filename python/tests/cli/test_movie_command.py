"""`wavesplat movie`, and the camera of the command line."""

import json
import signal
import subprocess
import sys
import time
from importlib.resources import files

import numpy as np
import pytest
from cases_of_the_day import nightly
from test_camera import axes

import wavesplat as ws
from wavesplat._model.arguments.clips import Clipping
from wavesplat._render.arguments import chosen_camera
from wavesplat._render.framing import shown_points

CT = files("wavesplat") / "data" / "ct_pelvis" / "ct_pelvis.nii.gz"
SMALL = ("--preset", "ct-bone", "--size", "32x24", "--quality", "draft")


# By day a video and an animated picture; others differ by a codec.
@pytest.mark.parametrize("name", ["turn.mp4", "turn.gif", *nightly("turn.webm", "turn.webp")])
def test_a_turn_of_a_file_is_that_of_python(wavesplat, tmp_path, name):
    pytest.importorskip("av")
    told = wavesplat("movie", CT, "-o", tmp_path / name, "--turn", 3, "--elevation", 10, *SMALL)
    assert (told.returncode, told.stdout) == (0, f"{tmp_path / name}\n"), told.stderr
    turn = ws.Turn(frames=3, elevation=10, start="front")
    volume = ws.open(CT)
    scene = ws.Scene(volume, ws.Look.preset("ct-bone", volume), background="black")
    ws.movie(scene, tmp_path / f"own{name[4:]}", turn, size=(32, 24), quality="draft", threads=1)
    assert (tmp_path / name).read_bytes() == (tmp_path / f"own{name[4:]}").read_bytes()


def test_frames_of_the_command_line_are_gone_on_with(wavesplat, tmp_path):
    command = ("movie", CT, "-o", tmp_path / "frames", "--turn", 3, "--degrees", -90, "--json", *SMALL)
    facts = json.loads(wavesplat(*command).stdout)
    assert facts["movie"] == str(tmp_path / "frames" / "%04d.png")
    assert (facts["frames"], facts["fps"], facts["size"]) == (3, 30, [32, 24])
    kept = (tmp_path / "frames" / "0000.png").stat().st_mtime_ns
    (tmp_path / "frames" / "0001.png").unlink()
    assert wavesplat(*command, "--resume").returncode == 0
    assert (tmp_path / "frames" / "0000.png").stat().st_mtime_ns == kept
    assert len(list((tmp_path / "frames").iterdir())) == 3


def test_a_movie_of_time_points(wavesplat, tmp_path):
    import nibabel

    images = pytest.importorskip("PIL.Image")
    samples = np.random.default_rng(2).integers(0, 255, (6, 7, 8, 4)).astype(np.uint8)
    samples[..., 2] = 0
    nibabel.save(nibabel.Nifti1Image(samples, np.eye(4)), tmp_path / "beat.nii.gz")
    told = wavesplat(
        "movie", tmp_path / "beat.nii.gz", "-o", tmp_path / "beat.gif", "--times", "all", "--fps", 10, "--size", "24x24"
    )
    assert told.returncode == 0, told.stderr
    with images.open(tmp_path / "beat.gif") as film:
        assert film.n_frames == 4
        brightness = []
        for number in range(4):
            film.seek(number)
            brightness.append(np.asarray(film.convert("RGB")).mean())
    assert brightness[2] < 0.5 * min(brightness[0], brightness[1], brightness[3])


@pytest.mark.parametrize(
    ("options", "code", "message"),
    [
        (("-o", "x.avi"), 1, "cannot write movies as .avi"),
        (("-o", "x.mp4", "--resume"), 2, "resume keeps frames"),
        (("-o", "x.mp4", "--turn", "0"), 2, "frames of the turn is 0"),
        (("-o", "x.mp4", "--cube", "--letters"), 2, "--cube"),
        (("-o", "x.mp4", "--colorbar-label", "HU"), 2, "--colorbar-label names"),
        (("-o", "x.mp4", "--title", "t = {time}", *SMALL), 2, "title has {time}, and this picture is of no time point"),
        (("-o", "x.mp4", "--fps", "0"), 2, "fps is 0"),
        (("-o", "x.mp4", "--camera", "none.json"), 1, "none.json"),
        (("-o", "x.mp4", "--camera", "a.json", "--view", "left"), 2, "--view and --camera"),
        (("-o", "x.mp4", "--camera", "a.json", "--perspective", "30"), 2, "--perspective and --camera"),
    ],
)
def test_mistakes_are_told_before_anything_is_drawn(wavesplat, tmp_path, options, code, message):
    told = wavesplat("movie", CT, *options, cwd=tmp_path)
    assert told.returncode == code
    assert message in told.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
@pytest.mark.parametrize("number", [signal.SIGINT, *nightly(signal.SIGTERM)])  # by day `test_hostile_places.py` has it
def test_a_movie_that_is_interrupted_leaves_nothing(tmp_path, number):
    command = [sys.executable, "-m", "wavesplat", "movie", str(CT), "-o", str(tmp_path / "turn.gif"), "--turn", "3000"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as running:
        deadline = time.monotonic() + 60
        while not list(tmp_path.iterdir()) and time.monotonic() < deadline:
            time.sleep(0.05)  # until it has begun to write
        running.send_signal(number)
        _, told = running.communicate(timeout=60)
    assert running.returncode == (130 if number == signal.SIGINT else -number)
    assert told == ("wavesplat: interrupted; nothing was written\n" if number == signal.SIGINT else "")
    assert list(tmp_path.iterdir()) == []


def test_the_camera_of_a_file(wavesplat, tmp_path):
    volume = ws.open(CT)
    camera = ws.Camera.orbit(volume, 200, 30, view_angle=20)
    camera.save(tmp_path / "camera.json")
    given = ("render", CT, "--preset", "ct-bone", "--size", "32x24", "--camera", tmp_path / "camera.json")
    for more, expected in (((), camera), (("--azimuth", 20, "--zoom", 2), camera.turned(20).zoomed(2))):
        assert wavesplat(*given, *more, "-o", tmp_path / "a.png").returncode == 0
        picture = ws.render(volume, "ct-bone", expected, size=(32, 24), background="black")
        picture.save(tmp_path / "b.png")
        assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


# The view of a name, turned.

CUBE = ws.Volume(np.full((9, 9, 9), 200, np.uint8))
FLAT = ws.Volume(np.full((3, 21, 21), 200, np.uint8))
LOOK = ws.Look(transfer_function=ws.TransferFunction([(0, 0), (100, 0.5)], [(0, 1, 1, 1)]))


def turned(volume, view, *angles, **options):
    return chosen_camera(view, [(volume, LOOK)], Clipping(), 1.0, turned=angles or None, **options)


@pytest.mark.parametrize("view_angle", [None, 30])
@pytest.mark.parametrize("view", ["front", "left", "superior", "isometric"])
def test_a_view_that_is_turned_keeps_its_scale_while_all_of_it_is_in_view(view, view_angle):
    start = turned(CUBE, view, view_angle=view_angle)
    same = turned(CUBE, view, 0, 0, view_angle=view_angle)
    assert same == start
    around = turned(CUBE, view, 90, 0, view_angle=view_angle)
    assert around.parallel_scale == start.parallel_scale
    np.testing.assert_allclose(axes(around), axes(start.turned(90)), atol=1e-12)


@pytest.mark.parametrize("view_angle", [None, 30])
@pytest.mark.parametrize("volume", [CUBE, FLAT])
@pytest.mark.parametrize("zoom", [1, 3])
@pytest.mark.parametrize("angles", [(45, 0), (30, 35), (0, 90), (200, -60)])
def test_nothing_leaves_the_picture_when_a_view_is_turned(volume, view_angle, zoom, angles):
    camera = turned(volume, "front", *angles, view_angle=view_angle, zoom=zoom).zoomed(1 / zoom)
    _, points = shown_points([(volume, LOOK)])
    right, up, back = axes(camera)
    seen = points - camera.position
    depth = -seen @ back
    half = camera.parallel_scale if view_angle is None else depth * np.tan(np.radians(camera.view_angle) / 2)
    filled = np.maximum(np.abs(seen @ up) / half, np.abs(seen @ right) / half).max()
    assert 0.4 < filled <= 1 + 1e-9
