"""Files of microscopes' vendors, read by bioio: a real one (.dv), and what other readers give, by a stand-in."""

from __future__ import annotations

import logging
import sys
from datetime import timedelta
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._readers.microscopes.bioio_files import SUFFIXES
from wavesplat.errors import ArgumentError, FileError

SAMPLES = np.random.default_rng(8).integers(0, 999, (3, 2, 5, 8, 9)).astype(np.uint16)  # t, c, z, y, x


@pytest.fixture
def save_dv(tmp_path):
    pytest.importorskip("bioio_dv")
    mrc = pytest.importorskip("mrc")

    def save(samples, name="a.dv"):
        mrc.imsave(str(tmp_path / name), samples.astype(np.int16), resolution=(0.1, 0.2, 0.3))
        return tmp_path / name

    return save


@pytest.mark.parametrize("options", [{}, {"memory": "1 MB"}])
def test_a_delta_vision_file(save_dv, options):
    path = save_dv(SAMPLES[0])
    with pytest.raises(FileError, match=r"holds 2 channels; choose one"):
        ws.open(path, **options)
    volume = ws.open(path, channel=1, **options)
    np.testing.assert_array_equal(np.asarray(volume), SAMPLES[0, 1])
    assert (volume.spacing, volume.unit, volume.guesses) == ((0.1, 0.2, 0.3), "um", ())
    assert [layer.name for layer in ws.open_scene(path).layers] == ["channel 0", "channel 1"]
    with pytest.raises(ArgumentError, match=r"level= has no meaning"):
        ws.open(path, level=1)


def test_a_damaged_file_is_none_of_a_reader(save_dv):
    path = save_dv(SAMPLES[0])
    path.write_bytes(path.read_bytes()[:300])
    with pytest.raises(FileError, match=r"a\.dv$"):
        ws.open(path, channel=0)
    path.write_bytes(b"1234" * 400)
    with pytest.raises(FileError, match=r"of another form than they read.*OME-TIFF"):
        ws.open(path)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("a.czi", r"Zeiss.*pip install \"wavesplat\[bio\]\" bioio-czi \(whose licence is the GPL\)"),
        ("a.LIF", r"Leica's microscopes \(LIF\).*pip install \"wavesplat\[bio\]\"; or export"),
        ("a.nd2", r"Nikon's microscopes \(ND2\).*pip install \"wavesplat\[bio\]\"; or export"),
        ("a.oib", r"Olympus' microscopes.*bioio-bioformats \(which needs Java\)"),
        ("a.ics", r"a microscope,.*bioio-bioformats.*; or export it as OME-TIFF, as with Fiji"),
    ],
)
@pytest.mark.parametrize("is_installed", [False, True])
def test_without_a_reader_the_vendor_and_the_way_are_named(tmp_path, monkeypatch, name, words, is_installed):
    use(monkeypatch, Image(), suffixes=[]) if is_installed else monkeypatch.setitem(sys.modules, "bioio", None)
    (tmp_path / name).write_bytes(b"\x70\0\0\0")
    for options in ({}, {"memory": "1 MB"}):
        with pytest.raises(FileError, match=words):
            ws.open(tmp_path / name, **options)


class Image:
    """A stand-in for bioio's image."""

    def __init__(
        self, samples=SAMPLES, sizes=(0.3, 0.2, 0.2), names=("DAPI", "GFP"), order="TCZYX", scenes=("Image:0",), **more
    ):
        self.samples, self.scenes, self.channel_names = samples, scenes, [np.str_(name) for name in names]
        self.dims = SimpleNamespace(order=order, **dict(zip(order, samples.shape, strict=True)))
        self.physical_pixel_sizes = SimpleNamespace(**dict(zip("ZYX", sizes, strict=True)))
        self.time_interval = timedelta(seconds=30)
        self.dimension_properties = None
        self.current_scene_index = 0
        vars(self).update(more)

    @property
    def ome_metadata(self):
        raise NotImplementedError

    def set_scene(self, number):
        self.current_scene_index = number

    def get_image_dask_data(self, order, **picked):
        array = pytest.importorskip("dask.array").from_array(self.samples, chunks=(1, 1, 2, 4, *self.samples.shape[4:]))
        assert order == "ZYX"
        return array[tuple(picked.get(name, slice(None)) for name in self.dims.order)]


class DescribedImage(Image):
    """One whose reader gives OME metadata."""

    @property
    def ome_metadata(self):
        nm = SimpleNamespace(value="nm")
        blue = SimpleNamespace(as_rgb_tuple=lambda **_: (0, 0, 255))
        channels = [
            SimpleNamespace(color=blue, emission_wavelength=461, emission_wavelength_unit=nm),
            SimpleNamespace(color=None, emission_wavelength=None, emission_wavelength_unit=nm),
        ]
        return SimpleNamespace(images=[SimpleNamespace(pixels=SimpleNamespace(channels=channels))] * 2)


def use(monkeypatch, image, suffixes=SUFFIXES):
    """Put a stand-in for bioio in the place of the library."""
    bioio, plugins = ModuleType("bioio"), ModuleType("bioio.plugins")
    bioio.BioImage = lambda _: image
    plugins.get_plugins = lambda **_: dict.fromkeys(suffixes)
    monkeypatch.setitem(sys.modules, "bioio", bioio)
    monkeypatch.setitem(sys.modules, "bioio.plugins", plugins)
    return image


class UnscaledImage(Image):
    """One whose reader has no scale, and says so by an error, as of CZI without Scaling."""

    physical_pixel_sizes = dimension_properties = property(lambda _: 1 / 0, lambda *_: None)


class XZImage(Image):
    """A scan of x and z, whose reader has no slices (LIF)."""

    def get_image_dask_data(self, *_, **__):
        raise ValueError("cannot select frame dimension 'Z'; frame dimensions ('X', 'Z') are fixed")


def test_a_form_that_a_reader_does_not_take_is_not_called_damaged(monkeypatch, path):
    use(monkeypatch, XZImage())
    with pytest.raises(FileError, match=r"does not take this form, such as a scan of x and z.*OME-TIFF") as caught:
        ws.open(path, channel=0, time=0)
    assert "damaged" not in str(caught.value)


def test_a_file_without_a_scale_is_opened(monkeypatch, path):
    use(monkeypatch, UnscaledImage())
    volume = ws.open(path, channel=0, time=0)
    assert (volume.spacing, volume.unit) == ((1, 1, 1), None)
    assert volume.guesses == ("distances of samples 1, 1, 1: the file has none",)


@pytest.fixture
def path(tmp_path):
    (tmp_path / "a.czi").write_bytes(b"ZISRAWFILE" + bytes(9000))
    return tmp_path / "a.czi"


@pytest.mark.parametrize("options", [{}, {"memory": "1 MB"}])
def test_place_channels_and_times(monkeypatch, path, options):
    use(monkeypatch, DescribedImage())
    volume = ws.open(path, time=2, channel=0, **options)
    np.testing.assert_array_equal(np.asarray(volume), SAMPLES[2, 0])
    assert (volume.spacing, volume.unit, volume.guesses) == ((0.2, 0.2, 0.3), "um", ())
    facts = volume.facts
    assert facts.channels == (ws.Channel("DAPI", (0, 0, 1), 461), ws.Channel("GFP"))
    assert (facts.n_times, facts.time_step, facts.time_unit, facts.modality) == (3, 30, "s", "fluorescence")
    assert len(ws.open_series(path, channel=1)) == 3
    assert [layer.name for layer in ws.open_scene(path).layers] == ["DAPI", "GFP"]


def test_units_that_a_reader_names(monkeypatch, path):
    own = SimpleNamespace(**{axis: SimpleNamespace(unit="nanometer") for axis in "XYZ"})
    use(monkeypatch, Image(SAMPLES[:1, :1], names=["Channel:0:0"], dimension_properties=own))
    volume = ws.open(path)
    assert (volume.unit, volume.spacing, volume.facts.channels) == ("nm", (0.2, 0.2, 0.3), ())


def test_distances_that_are_missing_are_guesses(monkeypatch, path):
    use(monkeypatch, Image(SAMPLES[:1, :1], sizes=(None, 0.2, 0.2), names=["0"]))
    assert ws.open(path).guesses == ("distance of slices 0.2: the file has none, taken from x",)
    use(monkeypatch, Image(SAMPLES[:1, :1], sizes=(None, None, None), names=["0"]))
    volume = ws.open(path)
    assert (volume.unit, volume.guesses) == (None, ("distances of samples 1, 1, 1: the file has none",))


def test_several_images_of_a_file(monkeypatch, path):
    image = use(monkeypatch, Image(SAMPLES[:1, :1], names=["0"], scenes=("left", "right")))
    with pytest.raises(FileError, match=r"holds 2 images; choose one with series= \(--series\): 0 left, 1 right"):
        ws.open(path)
    for which, number in (("right", 1), (0, 0), ("1", 1)):
        ws.open(path, series=which)
        assert image.current_scene_index == number
    for wrong in ("middle", 2, "-1"):
        with pytest.raises(ArgumentError, match="give 0..1 or a name of left, right"):
            ws.open(path, series=wrong)


def test_pixels_of_colours_are_channels(monkeypatch, path):
    samples = np.stack([SAMPLES[:1, :1]] * 3, axis=-1)
    use(monkeypatch, Image(samples, order="TCZYXS", names=["0"]))
    volume = ws.open(path, channel=2)
    assert volume.facts.channel.name == "blue"
    assert volume.shape == (5, 8, 9)
    use(monkeypatch, Image(np.concatenate([samples, samples], axis=1), order="TCZYXS", names=["0", "1"]))
    with pytest.raises(FileError, match="channels are colours themselves"):
        ws.open(path, channel=0)


class LoggingImage(Image):
    """One whose reader logs what a file does not have."""

    @property
    def time_interval(self):
        logging.getLogger("bioio_czi.aicspylibczi_reader.reader").error("Failed to extract Total Time Duration")

    @time_interval.setter
    def time_interval(self, _):
        pass


def test_what_readers_log_is_not_shown(monkeypatch, path, caplog):
    use(monkeypatch, LoggingImage())
    assert ws.open(path, channel=0, time=0).facts.time_step is None
    assert caplog.records == []
    logging.getLogger("bioio_czi.aicspylibczi_reader.reader").error("else it is")
    assert len(caplog.records) == 1
