"""DICOM frames that are pictures: upright, films as times, single images with their windows, colours as stored."""

import json

import numpy as np
import pytest
from dicom_files import base, enhanced, random, save, sequence, slice_at
from PIL import Image

import wavesplat as ws
from wavesplat._readers.request import taking_planes
from wavesplat.errors import ArgumentError, FileError


def opened(path, **options):
    """The volume of a file of pictures, as the commands that show them open it."""
    with taking_planes():
        return ws.open(path, **options)


def colored(pixels, **attributes):
    """A dataset of colours; pixels of shape ([frames,] rows, columns, 3)."""
    dataset = base(pixels[..., 0], SamplesPerPixel=3, PhotometricInterpretation="RGB", PlanarConfiguration=0)
    for name, value in {"Modality": "US", **attributes}.items():
        setattr(dataset, name, value)
    dataset.PixelData = pixels.tobytes() + b"\0" * (pixels.nbytes % 2)
    return dataset


def palette(pixels, red, green, blue, bits=16, **attributes):
    """A dataset of indices into colours."""
    dataset = base(pixels, modality="US", PhotometricInterpretation="PALETTE COLOR", **attributes)
    for name, values in (("Red", red), ("Green", green), ("Blue", blue)):
        setattr(dataset, f"{name}PaletteColorLookupTableDescriptor", [len(values), 0, bits])
        data = values.astype("<u2" if bits == 16 else "u1").tobytes()
        setattr(dataset, f"{name}PaletteColorLookupTableData", data)
    return dataset


def shown(wavesplat, folder, *arguments):
    """The 8-bit colours that `wavesplat slice` draws."""
    done = wavesplat("slice", *map(str, arguments), "-o", str(folder / "shown.png"))
    assert done.returncode == 0, done.stderr
    return np.asarray(Image.open(folder / "shown.png").convert("RGB")).astype(int), done.stderr


FRAMES = np.stack([np.full((40, 60), 10 * number, np.uint8) for number in range(4)])
FRAMES[:, :6] = 200  # a bright bar in the top rows
FRAMES[:, 20:30, :8] = 100  # a grey block at the left


@pytest.mark.parametrize(
    ("said", "times"),
    [
        ({"FrameTime": 40}, (0, 0.04, 0.08, 0.12)),
        ({"FrameTimeVector": [0, 30, 50, 30]}, (0, 0.03, 0.08, 0.11)),
        ({"FrameTimeVector": [30, 30, 50, 30]}, (0, 0.03, 0.08, 0.11)),
        ({"CineRate": 20}, (0, 0.05, 0.1, 0.15)),
        ({"RecommendedDisplayFrameRate": 10}, (0, 0.1, 0.2, 0.3)),
        ({}, (0, 1, 2, 3)),
    ],
)
def test_a_film_is_times_in_seconds(tmp_path, said, times):
    path = save(tmp_path / "us", [base(FRAMES, modality="US", NumberOfFrames=4, **said)]) / "000.dcm"
    series = ws.open_series(path)
    assert (series.times, series.time_unit) == (pytest.approx(times), "s" if said else None)
    with pytest.raises(FileError, match="a film of 4 pictures .*`wavesplat movie` .*`wavesplat slice --time N`"):
        ws.open(path, time=0)


def test_phases_of_nuclear_medicine_are_times(tmp_path):
    phases = [{"NumberOfFramesInPhase": n, "ActualFrameDuration": ms} for n, ms in ((2, 1000), (2, 5000))]
    dataset = base(
        FRAMES,
        modality="NM",
        NumberOfFrames=4,
        ImageType=["ORIGINAL", "PRIMARY", "DYNAMIC", "EMISSION"],
        PhaseInformationSequence=sequence(*phases),
    )
    assert ws.open_series(save(tmp_path / "nm", [dataset]) / "000.dcm").times == (0, 1, 2, 7)


def test_frames_of_one_place_are_times(tmp_path):
    frames = [(0.0, 1.0, 0.0, "1", number + 1) for number in range(4)]
    path = save(tmp_path / "cine", [enhanced(random(4), frames)]) / "000.dcm"
    assert opened(path, time=2).samples[0].tolist() == random(4)[2].tolist()
    files = [slice_at(one, number, z=0.0, TriggerTime=40 * number) for number, one in enumerate(random(3))]
    assert ws.open_series(save(tmp_path / "files", files)).times == (0, 0.04, 0.08)


def test_films_are_not_mixed(tmp_path):
    films = [base(FRAMES, number, modality="US", NumberOfFrames=4, FrameTime=40) for number in range(2)]
    with pytest.raises(FileError, match="2 files with films or pictures.* such as 000.dcm"):
        ws.open(save(tmp_path / "us", films))


def test_a_film_is_upright(tmp_path, wavesplat):
    path = save(tmp_path / "us", [base(FRAMES, modality="US", NumberOfFrames=4, FrameTime=40)]) / "000.dcm"
    picture, told = shown(wavesplat, tmp_path, path, "--time", "2", "--clim", "0,255")
    assert np.abs(picture - FRAMES[2][..., None]).max() <= 1
    assert "x to the right and y down" in told


def test_volumes_of_a_probe_are_upright(tmp_path, wavesplat):
    # The frame of reference is the probe's, not the patient's.
    dataset = base(FRAMES, modality="US", NumberOfFrames=4)
    dataset.SharedFunctionalGroupsSequence = sequence(
        {
            "PlaneOrientationVolumeSequence": {"ImageOrientationVolume": [1, 0, 0, 0, 1, 0]},
            "PixelMeasuresSequence": {"PixelSpacing": [1, 1]},
        }
    )
    places = [{"PlanePositionVolumeSequence": {"ImagePositionVolume": [0, 0, n]}} for n in range(4)]
    dataset.PerFrameFunctionalGroupsSequence = sequence(*places)
    path = save(tmp_path / "us", [dataset]) / "000.dcm"
    picture, _ = shown(wavesplat, tmp_path, path, "--position", "2", "--clim", "0,255")
    assert np.abs(picture - FRAMES[2][..., None]).max() <= 1


def test_pixels_of_tissue_and_of_detectors_have_sizes(tmp_path):
    tissue = {
        "RegionSpatialFormat": 1,
        "PhysicalUnitsXDirection": 3,
        "PhysicalUnitsYDirection": 3,
        "PhysicalDeltaX": 0.05,
        "PhysicalDeltaY": 0.02,
    }
    trace = {**tissue, "RegionSpatialFormat": 3, "PhysicalDeltaX": 1.0}
    dataset = base(FRAMES[0], modality="US", SequenceOfUltrasoundRegions=sequence(tissue, trace))
    us = opened(save(tmp_path / "us", [dataset]) / "000.dcm")
    assert us.spacing[:2] == pytest.approx((0.5, 0.2))
    assert "SequenceOfUltrasoundRegions" in us.guesses[1]
    dataset = base(FRAMES[0], modality="DX", ImagerPixelSpacing=[0.3, 0.4])
    dx = opened(save(tmp_path / "dx", [dataset]) / "000.dcm")
    assert dx.spacing[:2] == (0.4, 0.3)
    assert "at the detector" in dx.guesses[1]
    dataset = base(FRAMES[0], modality="ES", PixelAspectRatio=[3, 2])
    es = opened(save(tmp_path / "es", [dataset]) / "000.dcm")
    assert (es.spacing[:2], es.unit) == ((1.0, 1.5), None)


def test_an_x_ray_has_its_window_and_is_inverted(tmp_path, wavesplat):
    pixels = (np.arange(2400).reshape(40, 60) * 10).astype(np.uint16)
    dataset = base(
        pixels, modality="DX", PhotometricInterpretation="MONOCHROME1", WindowCenter=12000.5, WindowWidth=8001
    )
    beside = base(pixels, 1, modality="DX")  # another view of the study, no second slice
    picture, _ = shown(wavesplat, tmp_path, save(tmp_path / "dx", [dataset, beside]) / "000.dcm")
    expected = 255 - 255 * np.clip((pixels - 8000.0) / 8000, 0, 1)
    assert np.abs(picture - expected[..., None]).max() <= 1


def test_a_window_by_a_table(tmp_path):
    table = np.concatenate([np.zeros(50), np.arange(101) * 600, np.full(100, 60000)]).astype("<u2")
    item = {"LUTDescriptor": [len(table), 1000, 16], "LUTData": table.tobytes()}
    dataset = base(random(1)[0], modality="DX", VOILUTSequence=sequence(item))
    volume = opened(save(tmp_path / "dx", [dataset]) / "000.dcm")
    assert volume.facts.window == (1052, 1149)  # 1 and 99 % of the output


def test_a_single_slice_has_letters_and_its_place(tmp_path, wavesplat):
    path = save(tmp_path / "ct", [slice_at(random(1)[0], 0, WindowCenter=50, WindowWidth=400)]) / "000.dcm"
    done = wavesplat("slice", str(path), "-o", str(tmp_path / "ct.png"), "--json")
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)["report"]
    assert report["window"] == [49.5, 399.0]
    assert report["letters"] == {"left": "R", "right": "L", "top": "A", "bottom": "P"}
    assert report["position"] == 30


def test_a_tilted_slice_is_shown_whole(tmp_path, wavesplat):
    # Turned by 30 degrees about x: no named plane holds it.
    pixels = np.full((40, 60), 1000, np.uint16)
    turned = [1, 0, 0, 0, np.cos(np.pi / 6), np.sin(np.pi / 6)]
    dataset = slice_at(pixels, 0, ImageOrientationPatient=turned, spacing=(1, 1), WindowCenter=500, WindowWidth=1000)
    picture, _ = shown(wavesplat, tmp_path, save(tmp_path / "mr", [dataset]) / "000.dcm", "--size", "60x40")
    assert picture.min() == 255


COLORS = np.zeros((3, 6, 8, 3), np.uint8)
COLORS[:, :3], COLORS[:, 3:, :4], COLORS[:, 3:, 4:] = (200, 30, 30), (40, 90, 200), (1, 1, 1)
COLORS[1, 0] = 255


def test_a_film_in_colours(tmp_path, wavesplat):
    path = save(tmp_path / "us", [colored(COLORS, NumberOfFrames=3, FrameTime=40)]) / "000.dcm"
    picture, _ = shown(wavesplat, tmp_path, path, "--time", "1")
    np.testing.assert_array_equal(picture, COLORS[1])
    done = wavesplat("movie", str(path), "-o", str(tmp_path / "frames"))
    assert done.returncode == 0, done.stderr
    files = sorted((tmp_path / "frames").iterdir())
    frames = [np.asarray(Image.open(file).convert("RGB")) for file in files]
    np.testing.assert_array_equal(frames, COLORS)


def test_a_film_has_its_own_rate_and_a_window_of_all_frames(tmp_path, wavesplat):
    path = save(tmp_path / "us", [base(FRAMES, modality="US", NumberOfFrames=4, FrameTime=50)]) / "000.dcm"
    done = wavesplat("movie", str(path), "--times", "1:3", "-o", str(tmp_path / "us.gif"), "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert (told["frames"], told["fps"], told["size"]) == (2, pytest.approx(20), [60, 40])
    ws.movie(ws.open_series(path), tmp_path / "python")
    darkest = [np.asarray(Image.open(file).convert("L")).min() for file in sorted((tmp_path / "python").iterdir())]
    assert darkest[0] < darkest[1] < darkest[2] < darkest[3]
    with pytest.raises(ArgumentError, match="a film, which is shown as it is, without a camera"):
        ws.movie(ws.open_series(path), tmp_path / "turn", ws.Turn(frames=2))


def test_pictures_fill_no_space(tmp_path, wavesplat):
    path = save(tmp_path / "us", [base(FRAMES, modality="US", NumberOfFrames=4, FrameTime=50)]) / "000.dcm"
    with pytest.raises(ArgumentError, match="a single picture, or a film, and fills no space; `wavesplat slice`"):
        ws.render(ws.open_series(path)[0])
    for arguments in (["--time", "1"], ["--times", "all"]):
        done = wavesplat("render", str(path), *arguments, "-o", str(tmp_path / "o.png"))
        assert done.returncode == 1
        assert "a film of 4 pictures" in done.stderr


def test_info_lists_the_times_of_a_film(tmp_path, wavesplat):
    path = save(tmp_path / "us", [base(FRAMES, modality="US", NumberOfFrames=4, FrameTime=50)]) / "000.dcm"
    told = wavesplat("info", str(path)).stdout
    assert "times        4: 0, 0.05, 0.1, 0.15 s" in told
    assert "samples      60 x 40 x 1" in told


@pytest.mark.parametrize("bits", [8, 16])
def test_palettes_are_looked_up(tmp_path, wavesplat, bits):
    indices = np.arange(48, dtype=np.uint8).reshape(6, 8)
    numbers = np.random.default_rng(3).integers(0, 256, (3, 48)).astype(np.uint16)
    dataset = palette(indices, *(numbers * (257 if bits == 16 else 1)), bits=bits)
    picture, _ = shown(wavesplat, tmp_path, save(tmp_path / "us", [dataset]) / "000.dcm")
    np.testing.assert_array_equal(picture, numbers.T[indices])


def test_entries_of_16_bits_with_values_of_8(tmp_path, wavesplat):
    indices = np.arange(48, dtype=np.uint8).reshape(6, 8)
    numbers = np.random.default_rng(3).integers(0, 256, (3, 48)).astype(np.uint16)
    picture, _ = shown(wavesplat, tmp_path, save(tmp_path / "us", [palette(indices, *numbers)]) / "000.dcm")
    np.testing.assert_array_equal(picture, numbers.T[indices])


def test_colours_of_16_bits_by_rle_and_of_12_stored(tmp_path, wavesplat):
    from pydicom.uid import RLELossless

    deep = COLORS[0].astype(np.uint16) * 257
    dataset = colored(deep)
    dataset["PixelData"].VR = "OW"
    dataset.compress(RLELossless, generate_instance_uid=False)
    picture, _ = shown(wavesplat, tmp_path, save(tmp_path / "rle", [dataset]) / "000.dcm")
    np.testing.assert_array_equal(picture, COLORS[0])
    dataset = colored((COLORS[0] / 255 * 4095).round().astype(np.uint16), BitsStored=12, HighBit=11)
    dataset["PixelData"].VR = "OW"
    picture, _ = shown(wavesplat, tmp_path, save(tmp_path / "twelve", [dataset]) / "000.dcm")
    np.testing.assert_array_equal(picture, COLORS[0])


def test_bytes_in_big_endian_words(tmp_path):
    from pydicom.uid import ExplicitVRBigEndian

    pixels = np.arange(48, dtype=np.uint8).reshape(6, 8)
    dataset = base(pixels, modality="US")
    dataset.file_meta.TransferSyntaxUID = ExplicitVRBigEndian
    dataset.PixelData = pixels.view("u2").byteswap().tobytes()
    dataset["PixelData"].VR = "OW"
    (tmp_path / "us").mkdir()
    dataset.save_as(tmp_path / "us" / "000.dcm", enforce_file_format=True, little_endian=False, implicit_vr=False)
    np.testing.assert_array_equal(opened(tmp_path / "us" / "000.dcm").samples[0], pixels)
