"""One house, several doors: the same scene, drawn from Python and from the command line, is the same file to the byte.

The door of the Rust crate is held to a picture of its own by `test_rust_door.py`.
"""

from __future__ import annotations

from importlib.resources import files

import pytest

import wavesplat as ws

SIZE = (64, 48)
DATA = files("wavesplat") / "data"
SCANS = {name: DATA / name / f"{name}.nii.gz" for name in ("ct_pelvis", "mri_head")}


def _over(ct):
    return ws.render(ct, "ct-bone", ws.Camera.orbit(ct, 25, 15, aspect=64 / 48), size=SIZE, background="black")


def _cropped_in_perspective(ct):
    camera = ws.Camera.orbit(ct, -30, 35, zoom=1.6, view_angle=60, aspect=64 / 48)
    crop = ws.Crop((10, 10.5, 0), (100, 90, 80.25), space="index")
    return ws.render(ct, "ct-soft-tissue", camera, crop=crop, size=SIZE, kernel="bspline3", background="#102030")


def _maximum(mri):
    return ws.render(mri, camera="left", composite="maximum", size=SIZE, background="black")


def _surface(mri):
    camera = ws.Camera.orbit(mri, 50, 15, aspect=64 / 48)
    return ws.render(mri, camera=camera, composite="first-hit", iso_value=22, quality="high", size=SIZE)


def _wavelets(mri):
    wavelets = ws.WaveletVolume.from_volume(mri, threshold=12)
    camera = ws.Camera.orbit(mri, 50, aspect=64 / 48)
    return ws.render(wavelets, "mr-head", camera, drop_levels=1, shading=None, size=SIZE, background="black")


#: Scan, the Python, bits per channel, and the same as options.
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
    # The head has 8 levels.
    "wavelets": ("mri_head", _wavelets, 8, "--preset mr-head --azimuth 50 --threshold 12 --levels 7 --no-shading"),
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
    """And the pictures of two scenes are not the same file."""
    pictures = []
    for scan, volume in (("ct_pelvis", ws.examples.ct_pelvis()), ("mri_head", ws.examples.mri_head())):
        by_file, by_name = tmp_path / "file.png", tmp_path / "name.png"
        ws.render(ws.open(SCANS[scan]), size=(16, 16)).save(by_file)
        ws.render(volume, size=(16, 16)).save(by_name)
        assert by_file.read_bytes() == by_name.read_bytes()
        pictures.append(by_file.read_bytes())
    assert pictures[0] != pictures[1]
