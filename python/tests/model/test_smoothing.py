"""Smoothing by a Gaussian, against SciPy's, in voxels and in lengths, on the command line too."""

import json

import numpy as np
import pytest
from tiff_pixels import tiff_pixels

import wavesplat as ws
from wavesplat.errors import ArgumentError


def noise(shape, dtype=np.int16):
    return np.random.default_rng(11).normal(0, 500, shape).astype(dtype)


@pytest.mark.parametrize("dtype", [np.int16, np.float32, np.float64])
@pytest.mark.parametrize("shape", [(20, 31, 42), (2, 3, 2), (90, 4, 70)])
@pytest.mark.parametrize("deviation", [0.2, 0.7, 1.9])
def test_agrees_with_scipy(dtype, shape, deviation):
    ndimage = pytest.importorskip("scipy.ndimage")
    samples = noise(shape, dtype)
    got = ws.Volume(samples).smoothed(deviation)
    assert got.dtype == (np.float64 if dtype == np.float64 else np.float32)
    want = ndimage.gaussian_filter(samples.astype(np.float64), deviation, mode="nearest", truncate=3)
    assert np.abs(got.samples - want).max() < 1e-5 * np.ptp(samples.astype(np.float64))


def test_world_units_follow_the_spacing():
    ndimage = pytest.importorskip("scipy.ndimage")
    samples = noise((20, 31, 42))
    got = ws.Volume(samples, spacing=(0.5, 1, 2), unit="mm").smoothed(1.5, unit="world")
    want = ndimage.gaussian_filter(samples.astype(np.float64), (0.75, 1.5, 3), mode="nearest", truncate=3)
    assert np.abs(got.samples - want).max() < 1e-5 * np.ptp(samples)
    assert got.facts.processing == ("smoothed by a Gaussian, deviation 1.5 mm",)


def test_samples_that_are_not_finite_take_no_part():
    samples = np.full((12, 13, 14), 7, np.float32)
    samples[5:8, 4:9, 3:10] = np.nan
    samples[0, 0, 0] = np.inf
    got = ws.Volume(samples).smoothed(1.2).samples
    np.testing.assert_array_equal(np.isfinite(got), np.isfinite(samples))
    np.testing.assert_allclose(got[np.isfinite(got)], 7, rtol=1e-6)


def test_all_else_stays():
    facts = ws.Facts(unit="um", modality="fluorescence", guesses=["z is a guess"])
    volume = ws.Volume(noise((4, 5, 6)), spacing=(1, 2, 3), name="cells", facts=facts)
    got = volume.smoothed(0.7).smoothed(1, unit="world")
    assert (got.name, got.unit, got.modality, got.guesses) == ("cells", "um", "fluorescence", ("z is a guess",))
    np.testing.assert_array_equal(got.world_from_index, volume.world_from_index)
    smoothings = ["smoothed by a Gaussian, deviation 0.7 voxels", "smoothed by a Gaussian, deviation 1 um"]
    assert list(got.facts.processing) == smoothings
    assert ws.Facts.from_json(json.loads(json.dumps(got.facts.as_json()))) == got.facts
    assert ws.render(got, size=(8, 8)).report["processing"] == smoothings
    assert ws.slice(got, position=1).report["processing"] == smoothings
    assert ws.render(volume, size=(8, 8)).report["processing"] == []
    assert volume.samples.dtype == np.int16


def test_a_deviation_within_a_sample_is_none():
    volume = ws.Volume(noise((4, 5, 6)))
    assert volume.smoothed(0) is volume
    assert volume.smoothed(0.1) is volume


def test_noise_goes_and_edges_stay():
    z, y, x = np.indices((40, 40, 40)) - 19.5
    ball = np.clip(12.0 - np.sqrt(x**2 + y**2 + z**2), -0.5, 0.5) * 1000
    noisy = ball + np.random.default_rng(1).normal(0, 60, ball.shape)
    got = ws.Volume(noisy.astype(np.float32)).smoothed(0.7).samples
    assert got[19:21, 19:21, 10:30].std() < 60 / 2.5
    # The surface is where the value passes 0 along a line through the middle.
    line = got[19, 19, 20:]
    k = int(np.argmax(line < 0))
    radius = k - 1 + 0.5 + line[k - 1] / (line[k - 1] - line[k])
    assert radius == pytest.approx(np.sqrt(12**2 - 0.5), abs=0.3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"deviation": -1}, "deviation is -1 voxels; give 0 or more"),
        ({"deviation": np.nan}, "deviation is nan voxels"),
        ({"deviation": np.inf}, "deviation is inf voxels"),
        ({"deviation": 7}, r"no more than the volume is wide: \(4, 5, 6\) samples"),
        ({"deviation": "a"}, "deviation is 'a'; give a number"),
        ({"deviation": 100, "unit": "world"}, "deviation is 100 world units"),
        ({"deviation": 1, "unit": "mm"}, "unit of the deviation is 'mm'"),
    ],
)
def test_wrong_deviations_are_refused(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Volume(noise((4, 5, 6))).smoothed(**arguments)


# The command line


@pytest.mark.parametrize(
    ("deviation", "meant"),
    [("0.7", (0.7, "voxels")), ("2voxels", (2, "voxels")), ("0.2cm", (2, "mm")), ("1500 µm", (1.5, "mm"))],
)
def test_lengths_have_units_on_the_command_line(wavesplat, ramp_file, tmp_path, deviation, meant):
    out, report = tmp_path / "a.tif", tmp_path / "a.json"
    options = ["--smooth", deviation, "--size", "20x20", "--preset", "grey", "--report", report]
    done = wavesplat("render", ramp_file, "-o", out, *options)
    assert (done.returncode, done.stderr) == (0, "")
    told = json.loads(report.read_text())["report"]["processing"]
    assert told == ["smoothed by a Gaussian, deviation {:g} {}".format(*meant)]
    import tifffile

    smoothed = ws.open(ramp_file).smoothed(meant[0], unit="world" if meant[1] == "mm" else "voxels")
    want = ws.render(smoothed, "grey", size=(20, 20), background="black")
    np.testing.assert_array_equal(tifffile.imread(out), tiff_pixels(want))


@pytest.mark.parametrize(
    "command",
    [
        ["slice", "IN", "-o", "a.png"],
        ["mesh", "IN", "-o", "a.ply", "--iso-value", "100"],
        ["wavelet", "IN", "-o", "a.wavelets"],
    ],
)
def test_other_commands_smooth_too(wavesplat, ramp_file, tmp_path, command):
    arguments = [str(ramp_file) if argument == "IN" else argument for argument in command]
    done = wavesplat(*arguments, "--smooth", "0.7", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "smoothed by a Gaussian, deviation 0.7 voxels" in done.stdout
    if command[0] == "wavelet":
        loaded = ws.WaveletVolume.load(tmp_path / "a.wavelets")
        assert loaded.facts.processing == ("smoothed by a Gaussian, deviation 0.7 voxels",)
        done = wavesplat("render", tmp_path / "a.wavelets", "-o", "b.png", "--smooth", "1", cwd=tmp_path)
        assert done.returncode == 2
        assert "--smooth change samples, and this is a file of wavelet coefficients" in done.stderr


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--smooth", "thick"], "'thick' is not a number or a length"),
        (["--smooth", "1.2.3mm"], "'1.2.3mm' is not a number or a length"),
        (
            ["--smooth", "1kpc"],
            "--smooth is 1 kpc, whose unit is unknown; give um, mm or another length, or give it in voxels",
        ),
        (["--smooth", "99"], "deviation is 99 voxels"),
    ],
)
def test_wrong_lengths_are_wrong_arguments(wavesplat, ramp_file, tmp_path, options, message):
    done = wavesplat("render", ramp_file, "-o", tmp_path / "a.png", "--size", "8x8", *options)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert message in done.stderr


def test_lengths_need_a_unit_of_the_file(wavesplat, tmp_path):
    np.save(tmp_path / "a.npy", noise((8, 8, 8)))
    arguments = ["slice", "a.npy", "-o", "a.png", "--smooth", "1mm"]
    done = wavesplat(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert "file names no unit; give it with --unit" in done.stderr
    assert wavesplat(*arguments, "--unit", "mm", cwd=tmp_path).returncode == 0
