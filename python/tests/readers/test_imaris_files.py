"""Imaris files (fault 6.9 of the microscopist's trial: one dataset of eight, spacing 1, no guess told)."""

from __future__ import annotations

import sys

import h5py
import numpy as np
import pytest
from microscope_files import halved, image, save_imaris

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError

CHANNELS = (
    {"Name": "DAPI", "Color": "0.000 0.000 1.000", "ColorRange": "100.000 900.000", "LSMEmissionWavelength": "461"},
    {"Name": "(name not specified)", "Color": "1.000 0.500 0.000", "ColorRange": "0.000 65535.000"},
)
TIMES = ("2026-01-02 10:00:00.000", "2026-01-02 10:00:30.500", "2026-01-02 10:01:01.000")


@pytest.mark.parametrize("options", [{}, {"memory": "1 MB"}])
def test_fault_6_9_an_imaris_file_is_what_it_is(tmp_path, options):
    samples = image(3)
    path = save_imaris(tmp_path / "a.ims", samples, channels=CHANNELS, times=TIMES)
    volume = ws.open(path, time=2, channel=1, **options)
    assert volume.shape == (6, 10, 12)  # not (8, 16, 16), as the chunks have it
    assert volume.spacing == pytest.approx((0.2, 0.2, 1))
    assert (volume.unit, volume.guesses) == ("um", ())
    np.testing.assert_allclose(volume.bounds[0], (10.1, 20.1, -2.5))  # half a voxel inside of the faces
    facts = volume.facts
    assert facts.channels[0] == ws.Channel("DAPI", (0, 0, 1), 461, (100, 900))
    assert facts.channel == facts.channels[1] == ws.Channel("", (1, 0.5, 0), None, (0, 65535))
    assert (facts.n_times, facts.times, facts.time_unit) == (3, (0, 30.5, 61), "s")
    assert facts.levels == ((6, 10, 12), (3, 5, 6))
    assert facts.modality == "fluorescence"
    np.testing.assert_array_equal(np.asarray(volume), samples[2, 1])


@pytest.mark.parametrize("options", [{}, {"memory": "1 MB"}])
def test_a_coarser_level_fills_the_same_box(tmp_path, options):
    samples = image(1, 1)
    path = save_imaris(tmp_path / "a.ims", samples)
    volume = ws.open(path, level=1, **options)
    assert volume.spacing == pytest.approx((0.4, 0.4, 2))
    np.testing.assert_allclose(volume.bounds[0], (10.2, 20.2, -2))
    np.testing.assert_array_equal(np.asarray(volume), halved(samples[0, 0]))
    with pytest.raises(ArgumentError, match=r"level=2, but there are 2 levels"):
        ws.open(path, level=2, **options)


def test_a_lazy_file_has_all_levels(tmp_path):
    volume = ws.open(save_imaris(tmp_path / "a.ims", image(1, 1)), memory="1 MB")
    assert volume.levels == ((6, 10, 12), (3, 5, 6))
    eager = ws.open(tmp_path / "a.ims")
    rendered = [ws.render(one, size=(24, 24)).rgba for one in (volume.at_level(0), eager)]
    np.testing.assert_array_equal(*rendered)


def test_choices_and_scenes(tmp_path):
    path = save_imaris(tmp_path / "a.ims", image(3), channels=CHANNELS, times=TIMES)
    with pytest.raises(FileError, match=r"the file holds 3 time points.*--time N"):
        ws.open(path)
    with pytest.raises(FileError, match=r"the file holds 2 channels \(0 DAPI"):
        ws.open(path, time=0)
    scene = ws.open_scene(path)
    assert [layer.name for layer in scene.layers] == ["DAPI", "channel 1"]
    assert ws.open_series(path, channel=0).times == (0, 30.5, 61)
    assert scene.layers[0].volume[0].facts.channel.window == (100, 900)


@pytest.mark.parametrize(
    "changed", [{"ExtMax0": None}, {"ExtMax0": "nan"}, {"ExtMin0": "x"}, {"ExtMin1": 5, "ExtMax1": 5}]
)
def test_never_a_distance_of_1_without_a_guess(tmp_path, changed):
    volume = ws.open(save_imaris(tmp_path / "a.ims", image(1, 1), image_info=changed))
    assert volume.spacing == (1, 1, 1)
    assert volume.guesses == ("distances of samples 1, 1, 1: ExtMin and ExtMax of the file give none",)
    assert ws.open(tmp_path / "a.ims", spacing=(1, 1, 2)).guesses == ()


def test_mirrored_extents_and_odd_values(tmp_path):
    info = {"ExtMin0": 3, "ExtMax0": 0, "Unit": "mm"}
    path = save_imaris(tmp_path / "a.ims", image(2, 1), image_info=info, times=("", "2026"), channels=[{"Color": "0"}])
    volume = ws.open(path, time=0)
    assert volume.world_from_index[0, 0] == pytest.approx(-0.25)
    assert volume.unit == "mm"
    assert "axes x mirrored" in volume.guesses[0]
    assert (volume.facts.times, volume.facts.channel) == ((), ws.Channel())


def test_a_dataset_by_name_is_plain_hdf5(tmp_path):
    path = save_imaris(tmp_path / "a.ims", image(1, 1))
    volume = ws.open(path, dataset="DataSet/ResolutionLevel 0/TimePoint 0/Channel 0/Data")
    assert volume.shape == (8, 16, 16)
    assert "Imaris keeps them in DataSetInfo" in volume.guesses[0]


@pytest.mark.parametrize("options", [{}, {"memory": "1 MB"}])
def test_what_lies_in_other_files_needs_permission(tmp_path, options):
    save_imaris(tmp_path / "secret.ims", image(1, 1))
    save_imaris(tmp_path / "a.ims", image(1, 1))
    name = "DataSet/ResolutionLevel 1"
    with h5py.File(tmp_path / "a.ims", "a") as file:
        del file[name]
        file[name] = h5py.ExternalLink("secret.ims", name)
    with pytest.raises(FileError, match=r"'secret.ims'.*external_files=True"):
        ws.open(tmp_path / "a.ims", **options)
    assert ws.open(tmp_path / "a.ims", external_files=True, **options).shape == (6, 10, 12)


def test_damaged_files_are_errors_of_files(tmp_path):
    path = save_imaris(tmp_path / "a.ims", image(1, 1))
    with h5py.File(path, "a") as file:
        del file["DataSet/ResolutionLevel 1/TimePoint 0/Channel 0/Data"]
    with pytest.raises(FileError, match="are not there"):
        ws.open(path)
    with h5py.File(path, "a") as file:
        del file["DataSet/ResolutionLevel 0/TimePoint 0"]
    with pytest.raises(FileError, match="no image"):
        ws.open(path)


def test_filters_that_are_missing_are_named(tmp_path, monkeypatch):
    path = save_imaris(tmp_path / "a.ims", image(1, 1))
    monkeypatch.setattr(h5py.h5z, "filter_avail", lambda _: False)
    monkeypatch.setitem(sys.modules, "hdf5plugin", None)
    with pytest.raises(FileError, match="packed by filter 1 .*pip install hdf5plugin"):
        ws.open(path)
