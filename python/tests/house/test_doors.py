"""The entry points agree: the same scene, drawn from Python and from the command line, is the same file to the byte.

The door of the Rust crate is held to a picture of its own by `test_rust_door.py`.
"""

from __future__ import annotations

from importlib.resources import files

import pytest

import wavesplat as ws
from wavesplat._model.arguments.clips import combined_clips
from wavesplat._render.arguments import chosen_camera

SIZE = (64, 48)
DATA = files("wavesplat") / "data"
SCANS = {name: DATA / name / f"{name}.nii.gz" for name in ("ct_pelvis", "mri_head")}


def _drawn(volume, look, azimuth, elevation=0, *, crop=None, lens=None, **options):
    """Draw as the command line does: from a side, with all that the look shows in view."""
    clip = () if crop is None else crop
    parts = [(volume, look)]
    lens = {"turned": (azimuth, elevation), **(lens or {})}
    camera = chosen_camera(None, parts, combined_clips(clip), 64 / 48, **lens)
    return ws.render(volume, look, camera, clip=clip, size=SIZE, **options)


def _over(ct):
    return _drawn(ct, ws.Look.preset("ct-bone"), 25, 15, background="black")


def _cropped_in_perspective(ct):
    lens, crop = {"zoom": 1.6, "view_angle": 60}, ws.Crop((10, 10.5, 0), (100, 90, 80.25), space="index")
    look = ws.Look.preset("ct-soft-tissue")
    return _drawn(ct, look, -30, 35, lens=lens, crop=crop, kernel="bspline3", background="#102030")


def _maximum(mri):
    return ws.render(mri, camera="left", composite="maximum", size=SIZE, background="black")


def _surface(mri):
    return _drawn(
        mri, ws.Look.auto(mri, "first-hit"), 50, 15, composite=ws.FirstHit(22), quality="high", background="transparent"
    )


def _wavelets(mri):
    wavelets = ws.WaveletVolume.from_volume(mri, threshold=12)
    look = ws.Look.preset("mr-head", wavelets)
    return _drawn(wavelets.level(1), look, 50, shading=None, background="black")


#: Scan, Python function, bits per channel, and the command line's options for the same picture.
SCENES = {
    "over": ("ct_pelvis", _over, 8, "--preset ct-bone --azimuth 25 --elevation 15"),
    "cropped, in perspective": (
        "ct_pelvis",
        _cropped_in_perspective,
        16,
        (
            "--preset=ct-soft-tissue --azimuth=-30 --elevation=35 --zoom=1.6 --perspective=60 --kernel=bspline3 "
            "--crop-index=10,10.5,0,100,90,80.25 --background=#102030 --bits=16"
        ),
    ),
    "maximum": ("mri_head", _maximum, 8, "--composite maximum --view left"),
    "surface": (
        "mri_head",
        _surface,
        8,
        "--composite first-hit --iso-value 22 --azimuth 50 --elevation 15 --quality high --background transparent",
    ),
    "wavelets": (
        "mri_head",
        _wavelets,
        8,
        "--preset mr-head --azimuth 50 --threshold 12 --wavelet-level 1 --no-shading",
    ),
}


@pytest.mark.parametrize("scene", SCENES)
def test_python_and_the_command_line_draw_the_same_file(wavesplat, tmp_path, scene):
    scan, draw, bits, options = SCENES[scene]
    from_command_line, from_python = tmp_path / "command_line.png", tmp_path / "python.png"
    done = wavesplat("render", SCANS[scan], "-o", from_command_line, "--size", "64x48", *options.split())
    assert done.returncode == 0, done.stderr
    draw(ws.open(SCANS[scan])).save(from_python, bits=bits)
    assert from_command_line.read_bytes() == from_python.read_bytes()


def test_the_bundled_scans_are_their_files(wavesplat, tmp_path):
    """The pictures of two scenes are different files, so the comparison is not an empty one."""
    pictures = []
    # Looks are given by name: the files do not name their scanners, which the examples know.
    for scan, look, volume in (
        ("ct_pelvis", "ct-bone", ws.examples.ct_pelvis()),
        ("mri_head", "mr-head", ws.examples.mri_head()),
    ):
        by_file, by_name = tmp_path / "file.png", tmp_path / "name.png"
        ws.render(ws.open(SCANS[scan]), look, size=(16, 16)).save(by_file, scene=False)
        ws.render(volume, look, size=(16, 16)).save(by_name, scene=False)
        assert by_file.read_bytes() == by_name.read_bytes()
        pictures.append(by_file.read_bytes())
    assert pictures[0] != pictures[1]
