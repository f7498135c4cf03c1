"""Colour pictures of all formats are shown in the colours that are stored; channels of microscopes are not."""

import colorsys

import nibabel
import numpy as np
import pytest
import SimpleITK
import tifffile
from PIL import Image

import wavesplat as ws
from wavesplat._viewer.session.state import ViewerState
from wavesplat._viewer.slices.slice_values import slice_values

COLORS = [(200, 30, 30), (40, 90, 200), (255, 255, 255), (0, 0, 0), (1, 1, 1), (120, 60, 20)]


def boxes(shape=(5, 8, 24)):
    """Samples [z, y, x, colour]: a bar of each colour."""
    samples = np.zeros((*shape, 3), np.uint8)
    for number, color in enumerate(COLORS):
        samples[:, :, 4 * number : 4 * number + 4] = color
    return samples


def write_nifti(path, samples):
    parts = np.dtype([("R", "u1"), ("G", "u1"), ("B", "u1")])
    stored = np.ascontiguousarray(samples.transpose(2, 1, 0, 3)).view(parts)[..., 0]
    nibabel.Nifti1Image(stored, np.diag([-1.0, -1, 1, 1])).to_filename(path)


def write_folder(path, samples):
    path.mkdir()
    for number, one in enumerate(samples):
        tifffile.imwrite(path / f"{number}.tif", one, photometric="rgb")


def write_itk(path, samples):
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(samples, isVector=True), str(path))


WAYS = {
    "a.nii.gz": write_nifti,
    "a.tif": lambda path, samples: tifffile.imwrite(path, samples, photometric="rgb"),
    "sixteen.tif": lambda path, samples: tifffile.imwrite(path, samples.astype(np.uint16) * 257, photometric="rgb"),
    "float.tif": lambda path, samples: tifffile.imwrite(path, (samples / 255).astype(np.float32), photometric="rgb"),
    "a.ome.tif": lambda path, samples: tifffile.imwrite(path, samples, photometric="rgb", metadata={"axes": "ZYXS"}),
    "folder": write_folder,
    "a.nrrd": write_itk,
    "a.mha": write_itk,
}


@pytest.mark.parametrize("name", WAYS)
def test_slices_have_the_colours_that_are_stored(tmp_path, name):
    samples = boxes()
    WAYS[name](tmp_path / name, samples)
    scene = ws.open_scene(tmp_path / name)
    shown = ws.slice(scene, "xy", size=(24, 8)).rgba[..., :3] * 255
    assert np.abs(shown - samples[2]).max() <= 0.5
    # Layers without looks have the colours of their files, too.
    alone = ws.slice([layer.volume for layer in scene.layers], "xy", size=(24, 8)).rgba[..., :3] * 255
    np.testing.assert_array_equal(alone, shown)


def test_the_command_and_the_viewer_show_the_same_colours(tmp_path, wavesplat):
    write_nifti(tmp_path / "a.nii.gz", boxes())
    done = wavesplat("slice", str(tmp_path / "a.nii.gz"), "--size", "24x8", "-o", str(tmp_path / "a.png"))
    assert done.returncode == 0, done.stderr
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / "a.png").convert("RGB")), boxes()[2])
    state = ViewerState.of(ws.open_scene(tmp_path / "a.nii.gz"))
    layers = slice_values(state, "z", (24, 8)).header["layers"]
    assert [layer["kind"] for layer in layers] == ["light"] * 3
    assert [layer["color"] for layer in layers] == [
        [[0.0, 0.0, 0.0, 0.0], [255.0, *(float(n == number) for n in range(3))]] for number in range(3)
    ]


@pytest.mark.parametrize("color", [(200, 30, 30), (40, 90, 200), (120, 60, 20), (60, 20, 60)])
def test_in_space_hues_are_those_that_are_stored(tmp_path, color):
    samples = np.zeros((16, 16, 16, 3), np.uint8)
    samples[3:13, 3:13, 3:13] = color
    write_nifti(tmp_path / "a.nii.gz", samples)
    drawn = ws.open_scene(tmp_path / "a.nii.gz").render("front", size=(32, 32)).rgba[16, 16, :3]
    hue, saturation, _ = colorsys.rgb_to_hsv(*(drawn / drawn.max()).tolist())
    stored = colorsys.rgb_to_hsv(*(part / 255 for part in color))
    assert abs((hue - stored[0] + 0.5) % 1 - 0.5) < 0.01
    # The rays' first steps have little of the weakest colour, which counts as noise of black.
    assert saturation == pytest.approx(stored[1], abs=0.1)


def test_channels_of_a_microscope_keep_windows_of_their_own():
    channels = tuple(
        ws.Channel(name, color) for name, color in (("red", (1, 0, 0)), ("green", (0, 1, 0)), ("blue", (0, 0, 1)))
    )
    samples = np.random.default_rng(1).poisson(9, (8, 8, 8)).astype(np.uint8)
    of_dye = ws.Facts(channels=channels, channel=channels[0], modality="fluorescence")
    assert "by the values" in ws.Look.channel(ws.Volume(samples, facts=of_dye)).reason
    of_picture = ws.Facts(channels=channels, channel=channels[0])
    assert "from 0 to 255" in ws.Look.channel(ws.Volume(samples, facts=of_picture)).reason
