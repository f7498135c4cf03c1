"""Folders of TIFF files of one slice each: channels, times and distances that their names and tags tell."""

import numpy as np
import pytest
import tifffile

import wavesplat as ws
from wavesplat.errors import FileError

SAMPLES = np.random.default_rng(5).integers(0, 255, (2, 2, 3, 12, 10), np.uint8)  # time, channel, z, y, x
RESOLUTION = {"resolution": (4.0, 4.0), "metadata": {"unit": "um"}, "imagej": True}


@pytest.fixture
def folder(tmp_path):
    """A slice in each file, named as Fiji's image sequences are; four pixels in a micrometre."""
    for t, c, z in np.ndindex(2, 2, 3):
        name = f"mouse_T{t}__z{z + 1:03}_c{c + 1:03}.tif"
        tifffile.imwrite(tmp_path / name, SAMPLES[t, c, z], **RESOLUTION)
    return tmp_path


@pytest.mark.parametrize("memory", [None, "1 MB"])
def test_channels_and_times_in_names_are_no_slices(folder, memory):
    volume = ws.open(folder, channel=1, time=0, memory=memory)
    samples = volume.samples if memory is None else volume.read().samples
    np.testing.assert_array_equal(samples, SAMPLES[0, 1])
    assert volume.spacing == (0.25, 0.25, 0.25)
    assert volume.unit == "um"
    assert volume.facts.n_times == 2
    assert [channel.name for channel in volume.facts.channels] == ["c001", "c002"]
    assert volume.guesses == (
        "distance of slices 0.25: the file has none, taken from x",
        "channels c001, c002: by the names of the files",
        "times T0, T1: by the names of the files",
    )


def test_all_channels_of_a_folder_are_drawn(folder):
    scene = ws.open_scene(folder, time=1)
    assert [layer.name for layer in scene.layers] == ["c001", "c002"]
    for number, layer in enumerate(scene.layers):
        np.testing.assert_array_equal(layer.drawn.samples, SAMPLES[1, number])
    with pytest.raises(FileError, match="2 channels \\(0 c001, 1 c002\\)"):
        ws.open(folder)


@pytest.mark.parametrize("name", ["c{:03}", "t{:03}", "slice_{:03}", "b{0}_c{0}"])
def test_numbers_of_slices_are_no_channels(tmp_path, name):
    for z, plane in enumerate(SAMPLES[0, 0]):
        tifffile.imwrite(tmp_path / f"{name.format(z)}.tif", plane)
    volume = ws.open(tmp_path)
    np.testing.assert_array_equal(volume.samples, SAMPLES[0, 0])
    assert volume.guesses == ("distances of samples 1, 1, 1: a folder of slices has none",)


def test_stacks_in_a_folder(tmp_path):
    for time, stack in enumerate(SAMPLES[:, 0]):
        tifffile.imwrite(tmp_path / f"t{time}.tif", stack, photometric="minisblack")
    with pytest.raises(FileError, match="open that file alone, or several of them as times, with wavesplat.Series"):
        ws.open(tmp_path)


def test_a_file_of_a_set_says_so(tmp_path):
    """Planes whose metadata are in a .companion.ome, as Bio-Formats writes sets of files."""
    schema = "http://www.openmicroscopy.org/Schemas/OME/2016-06"
    set_of = '<BinaryOnly MetadataFile="a.companion.ome" UUID="urn:uuid:1"/>'
    kept = {"description": f'<OME xmlns="{schema}">{set_of}</OME>', "metadata": None, "photometric": "minisblack"}
    tifffile.imwrite(tmp_path / "0.ome.tif", SAMPLES[0, 0], **kept)
    volume = ws.open(tmp_path / "0.ome.tif")
    np.testing.assert_array_equal(volume.samples, SAMPLES[0, 0])
    assert any(guess.startswith("one file of several, whose planes") for guess in volume.guesses)
