"""Volumes as OME-TIFF and OME-Zarr: what other programs, and we, read of them (micro.md, section 9, item 15)."""

from __future__ import annotations

import json

import numpy as np
import pytest
import tifffile

import wavesplat as ws
from wavesplat._model.interchange import ome_files
from wavesplat._model.interchange import ome_files as ome_zarr_file
from wavesplat.errors import ArgumentError, FileError, WavesplatWarning

SPACING = (0.2, 0.2, 0.7)
CHANNELS = (
    ws.Channel("DAPI", color=(0, 0, 1), emission_nm=461, window=(100, 900)),
    ws.Channel("GFP µ", color=(0, 1, 0), window=(20, 400.5)),
)
SHAPE = (5, 150, 33)
SUFFIXES = [".ome.tif", ".ome.zarr"]


def volume_of(channel, seed=0, *, shape=SHAPE, dtype=np.uint16, **more):
    samples = np.random.default_rng(seed).integers(0, 1000, shape).astype(dtype)
    facts = ws.Facts(unit="um", channel=CHANNELS[channel])
    return ws.Volume(samples, **{"spacing": SPACING, "facts": facts, **more})


def names_in(folder):
    return [path.name for path in folder.iterdir()]


def scene_over_time(n_times=3):
    """Two channels at several times, and their samples [t, c, z, y, x]."""
    volumes = [[volume_of(channel, 10 * channel + time) for time in range(n_times)] for channel in (0, 1)]
    series = [ws.Series(of_times, times=[0.5 * n for n in range(n_times)], time_unit="s") for of_times in volumes]
    layers = [ws.Layer(one, name=channel.name) for one, channel in zip(series, CHANNELS, strict=True)]
    return ws.Scene(layers), np.array([[one.samples for one in at_time] for at_time in zip(*volumes, strict=True)])


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"])
@pytest.mark.every_pair
def test_a_volume_comes_back(tmp_path, suffix, dtype):
    volume = volume_of(0, dtype=dtype)
    volume.save(tmp_path / f"a{suffix}")
    again = ws.open(tmp_path / f"a{suffix}")
    assert again.dtype == volume.dtype
    np.testing.assert_array_equal(again.samples, volume.samples)
    np.testing.assert_allclose(again.world_from_index, volume.world_from_index, rtol=1e-12)
    assert (again.unit, again.guesses) == ("um", ())
    known = again.facts.channel
    assert (known.name, known.color, known.emission_nm) == ("DAPI", (0, 0, 1), 461)
    assert known.window == ((100, 900) if suffix == ".ome.zarr" else None)
    assert again.modality == "fluorescence"  # since there is an emission


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("unit", [None, "mm", "nm", "angstrom", "m", "cm"])
@pytest.mark.every_pair
def test_units_come_back(tmp_path, suffix, unit):
    volume_of(0, unit=unit, facts=None).save(tmp_path / f"a{suffix}")
    again = ws.open(tmp_path / f"a{suffix}")
    assert again.unit == unit
    np.testing.assert_allclose(again.spacing, SPACING)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_channels_and_times_come_back(tmp_path, suffix):
    scene, samples = scene_over_time()
    scene.save_volumes(tmp_path / f"a{suffix}")
    again = ws.open_scene(tmp_path / f"a{suffix}")
    assert [layer.name for layer in again.layers] == ["DAPI", "GFP µ"]
    for number, layer in enumerate(again.layers):
        assert (layer.volume.times, layer.volume.time_unit) == ((0, 0.5, 1.0), "s")
        for time in range(3):
            np.testing.assert_array_equal(layer.volume[time].samples, samples[time, number])
        channel = layer.drawn.facts.channel
        assert channel.color == CHANNELS[number].color
        assert channel.window == (CHANNELS[number].window if suffix == ".ome.zarr" else None)


def test_tifffile_reads_it(tmp_path):
    scene, samples = scene_over_time()
    scene.save_volumes(tmp_path / "a.ome.tif")
    with tifffile.TiffFile(tmp_path / "a.ome.tif") as tiff:
        assert tiff.is_ome
        assert tiff.series[0].axes == "TCZYX"
        np.testing.assert_array_equal(tiff.asarray(), samples)
        text = tiff.ome_metadata
    pixels = tifffile.xml2dict(text)["OME"]["Image"]["Pixels"]
    assert [pixels[f"PhysicalSize{axis}"] for axis in "XYZ"] == list(SPACING)
    assert {pixels[f"PhysicalSize{axis}Unit"] for axis in "XYZ"} == {"µm"}
    assert (pixels["TimeIncrement"], pixels["TimeIncrementUnit"]) == (0.5, "s")
    assert [channel["Name"] for channel in pixels["Channel"]] == ["DAPI", "GFP µ"]
    assert [channel["Color"] & 0xFFFFFFFF for channel in pixels["Channel"]] == [0x0000FFFF, 0x00FF00FF]
    assert pixels["Channel"][0]["EmissionWavelength"] == 461


def test_zarr_reads_it(tmp_path):
    import zarr

    scene, samples = scene_over_time()
    scene.save_volumes(tmp_path / "a.ome.zarr")
    group = zarr.open_group(tmp_path / "a.ome.zarr", mode="r")
    told = group.attrs["ome"]
    (image,) = told["multiscales"]
    assert told["version"] == "0.5"
    assert [axis["name"] for axis in image["axes"]] == ["t", "c", "z", "y", "x"]
    assert [axis.get("unit") for axis in image["axes"]] == ["second", None, *["micrometer"] * 3]
    np.testing.assert_array_equal(group["0"][:], samples)
    assert group["0"].metadata.dimension_names == ("t", "c", "z", "y", "x")
    scale, translation = image["datasets"][1]["coordinateTransformations"]
    assert (scale["type"], translation["type"]) == ("scale", "translation")
    np.testing.assert_allclose(scale["scale"], [0.5, 1, 0.7, 0.4, 0.4])
    np.testing.assert_allclose(translation["translation"], [0, 0, 0, 0.1, 0.1])
    assert [(one["label"], one["color"], one["active"]) for one in told["omero"]["channels"]] == [
        ("DAPI", "0000FF", True),
        ("GFP µ", "00FF00", True),
    ]
    windows = [one["window"] for one in told["omero"]["channels"]]
    assert [(window["start"], window["end"]) for window in windows] == [(100, 900), (20, 400.5)]
    assert all(window["min"] <= window["start"] and window["end"] <= window["max"] for window in windows)


@pytest.mark.filterwarnings("default")  # those of its own libraries
def test_bioio_reads_it(tmp_path):
    bioio = pytest.importorskip("bioio")
    pytest.importorskip("bioio_ome_zarr")
    pytest.importorskip("bioio_ome_tiff")
    scene, samples = scene_over_time()
    for name in ("a.ome.zarr", "a.ome.tif"):
        scene.save_volumes(tmp_path / name)
        image = bioio.BioImage(tmp_path / name)
        np.testing.assert_array_equal(image.data, samples)
        assert tuple(image.physical_pixel_sizes) == SPACING[::-1]
        assert list(image.channel_names) == ["DAPI", "GFP µ"]


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_lazy_volume_is_written_part_by_part(tmp_path, monkeypatch, suffix):
    volume = volume_of(0, shape=(40, 150, 133))
    volume.save(tmp_path / "a.ome.tif")
    lazy = ws.open(tmp_path / "a.ome.tif", memory="64 MB")
    monkeypatch.setattr(ome_files, "MAX_TIFF_BYTES", 3 * 150 * 133 * 2)
    monkeypatch.setattr(ome_zarr_file, "MAX_ZARR_BYTES", 1)  # a chunk at a time
    monkeypatch.setattr(ome_zarr_file, "CHUNK", 32)
    lazy.save(tmp_path / f"b{suffix}")
    again = ws.open(tmp_path / f"b{suffix}")
    np.testing.assert_array_equal(again.samples, volume.samples)
    if suffix == ".ome.zarr":
        levels = again.facts.levels
        assert levels == ((40, 150, 133), (40, 75, 67), (20, 38, 34), (10, 19, 17))
        coarse = ws.open(tmp_path / "b.ome.zarr", level=1).samples
        padded = np.pad(volume.samples.astype(float), ((0, 0), (0, 0), (0, 1)), mode="edge")
        means = padded.reshape(40, 75, 2, 67, 2).mean(axis=(2, 4))
        assert np.abs(coarse - means).max() <= 0.5


def test_levels_lie_where_they_are(tmp_path, monkeypatch):
    """A ramp along each axis has the value of its world position at all levels."""
    monkeypatch.setattr(ome_zarr_file, "CHUNK", 8)
    z, y, x = np.mgrid[:32, :48, :16].astype(np.float32)
    matrix = np.diag([0.5, -0.5, 0.5, 1.0])
    matrix[:3, 3] = (3, 40, -7)
    for axis, index in enumerate((x, y, z)):
        world = matrix[axis, axis] * index + matrix[axis, 3]
        ws.Volume(world, world_from_index=matrix, unit="um").save(tmp_path / "a.ome.zarr")
        for level in range(3):
            read = ws.open(tmp_path / "a.ome.zarr", level=level)
            own = read.world_from_index
            place = own[axis, axis] * np.arange(read.shape[2 - axis]) + own[axis, 3]
            along = np.moveaxis(read.samples, 2 - axis, 0)[:, 0, 0]
            np.testing.assert_allclose(along, place, atol=1e-5)


def test_coarser_levels_of_labels_have_labels(tmp_path, monkeypatch):
    monkeypatch.setattr(ome_zarr_file, "CHUNK", 8)
    labels = np.random.default_rng(1).choice([0, 7, 900], (16, 16, 17)).astype(np.uint16)
    ws.Volume(labels, unit="um").save(tmp_path / "a.ome.zarr", downsampling="nearest")
    coarse = ws.open(tmp_path / "a.ome.zarr", level=1)
    np.testing.assert_array_equal(coarse.samples, labels[::2, ::2, ::2])
    np.testing.assert_array_equal(coarse.world_from_index, np.diag([2, 2, 2, 1]))


def test_means_round_and_leave_out_what_is_missing():
    samples = np.array([[[0, 1, 2, 65535, 65535]]], np.uint16)
    assert ome_zarr_file.reduced(samples, (1, 1, 2), "mean").tolist() == [[[0, 32768, 65535]]]
    holes = np.array([[[1, np.nan, np.nan, np.nan, np.inf]]], np.float32)
    np.testing.assert_array_equal(ome_zarr_file.reduced(holes, (1, 1, 2), "mean"), [[[1, np.nan, np.nan]]])


def test_times_that_are_not_even(tmp_path):
    series = ws.Series([volume_of(0, n) for n in range(3)], times=[0, 1, 5], time_unit="min")
    series.save(tmp_path / "a.ome.tif")
    again = ws.open_series(tmp_path / "a.ome.tif")
    assert (again.times, again.time_unit) == ((0, 1, 5), "min")


def test_times_that_ome_zarr_cannot_hold_are_told(tmp_path):
    series = ws.Series([volume_of(0, n) for n in range(3)], times=[0, 1, 5], time_unit="min")
    with pytest.warns(WavesplatWarning, match="OME-Zarr has no place for .*its times, which are not evenly spaced"):
        series.save(tmp_path / "a.ome.zarr")
    assert ws.open_series(tmp_path / "a.ome.zarr").time_unit is None


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_a_format_cannot_hold_is_told(tmp_path, suffix):
    scan = ws.examples.ct_pelvis()
    with pytest.warns(WavesplatWarning, match=r"axes are a patient's, the modality \(CT\).*; \.nrrd keeps") as told:
        scan.save(tmp_path / f"a{suffix}")
    assert ("its place" in str(told[0].message)) == (suffix == ".ome.tif")
    again = ws.open(tmp_path / f"a{suffix}")
    np.testing.assert_array_equal(again.samples, scan.samples)
    if suffix == ".ome.zarr":
        np.testing.assert_allclose(again.world_from_index, scan.world_from_index)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_an_old_file_is_replaced_whole_or_not_at_all(tmp_path, monkeypatch, suffix):
    path = tmp_path / f"a{suffix}"
    volume_of(0, 1).save(path)
    before = ws.open(path).samples
    volume_of(0, 2).save(path)
    assert (ws.open(path).samples != before).any()
    before = ws.open(path).samples

    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(ws.Volume, "_stored_box", fail)
    with pytest.raises(FileError, match="No space left on device"):
        volume_of(0, 3).save(path)
    np.testing.assert_array_equal(ws.open(path).samples, before)
    assert names_in(tmp_path) == [path.name]


def test_a_folder_of_other_files_is_not_replaced(tmp_path):
    folder = tmp_path / "a.ome.zarr"
    folder.mkdir()
    volume_of(0).save(folder)  # an empty one is
    other = tmp_path / "b.ome.zarr"
    other.mkdir()
    (other / "thesis.txt").write_text("x")
    with pytest.raises(FileError, match=r"holds 'thesis\.txt', which would be lost; .*b\.ome\.zarr"):
        volume_of(0).save(other)
    assert (other / "thesis.txt").exists()


def test_labels_beside_an_image_are_not_lost(tmp_path):
    import zarr

    volume_of(0).save(tmp_path / "a.ome.zarr")
    zarr.open_group(tmp_path / "a.ome.zarr").create_group("labels")
    with pytest.raises(FileError, match=r"the folder holds 'labels', which would be lost"):
        volume_of(0).save(tmp_path / "a.ome.zarr")
    assert (tmp_path / "a.ome.zarr" / "labels").is_dir()


def test_names_that_xml_cannot_hold(tmp_path):
    facts = ws.Facts(unit="um", channel=ws.Channel('a\x01<b> & "c"'))
    volume_of(0, facts=facts).save(tmp_path / "a.ome.tif")
    assert ws.open(tmp_path / "a.ome.tif").facts.channel.name == 'a<b> & "c"'


def test_what_cannot_be_saved_together(tmp_path):
    a, b = volume_of(0), volume_of(1, shape=(5, 150, 34))
    with pytest.raises(ArgumentError, match=r"shape \(5, 150, 34\).*another grid than.*save them one by one"):
        ws.Scene([a, b]).save_volumes(tmp_path / "a.ome.tif")
    with pytest.raises(ArgumentError, match=r"\.nrrd holds one volume, not 2 channels; write \.ome\.tif"):
        ws.Scene([a, volume_of(1)]).save_volumes(tmp_path / "a.nrrd")
    with pytest.raises(ArgumentError, match=r"\.nii holds one volume, not 2 times"):
        ws.Series([a, a]).save(tmp_path / "a.nii")
    with pytest.raises(ArgumentError, match="holds wavelet coefficients"):
        ws.Scene([ws.WaveletVolume.from_volume(a)]).save_volumes(tmp_path / "a.ome.tif")
    with pytest.raises(ArgumentError, match=r"downsampling is for \.ome\.zarr"):
        a.save(tmp_path / "a.nrrd", downsampling="mean")
    with pytest.raises(ArgumentError, match='downsampling is \'median\'; it is "mean" or "nearest"'):
        a.save(tmp_path / "a.ome.zarr", downsampling="median")
    with pytest.raises(ArgumentError, match=r"at time 1 has samples of float32, the first one uint16"):
        ws.Series([a, volume_of(0, dtype=np.float32)]).save(tmp_path / "a.ome.tif")
    with pytest.raises(FileError, match=r"use one of: \.nii\.gz, \.nii, \.nrrd, \.ome\.tif, \.ome\.tiff, \.ome\.zarr"):
        a.save(tmp_path / "a.tif")
    assert names_in(tmp_path) == []


def test_types_of_channels_are_joined_without_loss(tmp_path):
    a, b = volume_of(0, dtype=np.uint8), volume_of(1, dtype=np.int16)
    ws.Scene([a, b]).save_volumes(tmp_path / "a.ome.tif")
    read = [ws.open(tmp_path / "a.ome.tif", channel=n) for n in (0, 1)]
    assert [one.dtype for one in read] == [np.int16] * 2
    np.testing.assert_array_equal(read[0].samples, a.samples)


@pytest.mark.parametrize("suffix", [".ome.tif", ".ome.zarr"])
@pytest.mark.parametrize(
    ("largest", "dtype"), [((5, 2**20, 300), np.uint32), ((5, 2**33), np.float64), ((7, -9), np.int16)]
)
@pytest.mark.every_pair
def test_labels_of_64_bits_that_outgrow_the_first_time_are_saved(tmp_path, largest, dtype, suffix):
    samples = [np.full(SHAPE, n, np.int64) for n in largest]
    for n, one in enumerate(samples):
        np.save(tmp_path / f"t{n}.npy", one)
    ws.open_series(tmp_path / "t*.npy").save(tmp_path / f"all{suffix}")
    read = ws.open_series(tmp_path / f"all{suffix}")
    assert {volume.dtype for volume in read} == {np.dtype(dtype)}
    assert all(np.array_equal(volume.samples, one) for volume, one in zip(read, samples, strict=True))
    assert not [name for name in names_in(tmp_path) if "part" in name]


def test_colours_and_windows_of_looks_are_written(tmp_path):
    volumes = [volume_of(0), volume_of(1)]
    looks = [ws.Look.channel(volumes[0]), ws.Look.channel(volumes[1], "red", (5, 700))]
    layers = [ws.Layer(*pair, name=name) for *pair, name in zip(volumes, looks, "ab", strict=True)]
    ws.Scene(layers).save_volumes(tmp_path / "a.ome.tif")
    read = ws.open(tmp_path / "a.ome.tif", channel=1).facts.channels
    assert [(one.name, one.color) for one in read] == [("a", (0, 0, 1)), ("b", (1, 0, 0))]


def test_the_command_converts_all_channels_and_times(tmp_path, wavesplat):
    scene, samples = scene_over_time()
    scene.save_volumes(tmp_path / "a.ome.tif")
    made = wavesplat("convert", "a.ome.tif", "-o", "b.ome.tif", "--json", cwd=tmp_path)
    assert made.returncode == 0, made.stderr
    told = json.loads(made.stdout)
    assert (told["n_channels"], told["n_times"], told["dtype"]) == (2, 3, "uint16")
    np.testing.assert_array_equal(tifffile.imread(tmp_path / "b.ome.tif"), samples)
    one = wavesplat("convert", "a.ome.tif", "-o", "c.nrrd", "--channel", "1", "--time", "2", cwd=tmp_path)
    assert one.returncode == 0, one.stderr
    np.testing.assert_array_equal(ws.open(tmp_path / "c.nrrd").samples, samples[2, 1])
    several = wavesplat("convert", "a.ome.tif", "-o", "d.nrrd", cwd=tmp_path)
    assert several.returncode == 1
    assert "holds 3 time points" in several.stderr or "holds 2 channels" in several.stderr
    third = wavesplat("convert", "a.ome.tif", "-o", "e.ome.tif", "--time", "2", cwd=tmp_path)
    assert third.returncode == 0, third.stderr
    np.testing.assert_array_equal(tifffile.imread(tmp_path / "e.ome.tif"), samples[2])


def test_the_command_knows_labels(tmp_path, wavesplat):
    numbers = np.arange(1, 65, dtype=np.uint16).reshape(4, 4, 4)
    labels = np.kron(numbers, np.ones((5, 40, 40), np.uint16))
    ws.Volume(labels, unit="um").save(tmp_path / "a.nrrd")
    made = wavesplat("convert", "a.nrrd", "-o", "b.ome.zarr", cwd=tmp_path)
    assert made.returncode == 0, made.stderr
    assert "taken for labels" in made.stderr
    assert set(np.unique(ws.open(tmp_path / "b.ome.zarr", level=1).samples)) <= set(np.unique(labels))


def test_an_image_that_is_there_is_no_folder_for_results(wavesplat, tmp_path):
    """The second result was written inside the first one, with success."""
    rng = np.random.default_rng(0)
    for name in "ab":
        np.save(tmp_path / f"{name}.npy", rng.integers(0, 200, (8, 9, 10)).astype(np.uint8))
    for name in "ab":
        assert wavesplat("convert", f"{name}.npy", "-o", "out.ome.zarr", cwd=tmp_path).returncode == 0
    np.testing.assert_array_equal(ws.open(tmp_path / "out.ome.zarr").samples, np.load(tmp_path / "b.npy"))
    assert not list((tmp_path / "out.ome.zarr").glob("*.zarr"))


def test_times_without_a_unit_are_told_to_be_lost(tmp_path):
    volumes = [ws.Volume(np.full((4, 5, 6), k, np.uint8) + np.arange(6, dtype=np.uint8)) for k in range(3)]
    for name in ("a.ome.zarr", "a.ome.tif"):
        with pytest.warns(ws.errors.WavesplatWarning, match="its times, which have no unit"):
            ws.Series(volumes, times=(0, 1, 5)).save(tmp_path / name)


def test_lazy_labels_are_not_averaged(wavesplat, tmp_path):
    """Coarser levels of a large segmentation had numbers that no cell has."""
    z, y, x = np.indices((8, 300, 300)) // 8
    labels = (1 + 100 * ((z + y + x) % 3)).astype(np.uint16)
    labels[0] = 0
    ws.Volume(labels, unit="um").save(tmp_path / "a.ome.zarr", downsampling="nearest")
    options = ("--memory", "1MB", "-o", "b.ome.zarr")
    done = wavesplat("convert", "a.ome.zarr", *options, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "taken for labels" in done.stderr
    assert set(np.unique(ws.open(tmp_path / "b.ome.zarr", level=1).samples)) <= set(np.unique(labels))
