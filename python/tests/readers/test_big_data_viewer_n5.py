"""BigDataViewer's XML and N5: the same volumes as in HDF5."""

from __future__ import annotations

import json

import numpy as np
import pytest
from microscope_files import halved, image, save_bdv, save_bdv_n5
from typer.testing import CliRunner

import wavesplat as ws
from wavesplat._cli import app
from wavesplat.errors import FileError, LibraryError

pytest.importorskip("tensorstore")


@pytest.mark.parametrize("options", [{}, {"memory": "1 MB"}])
@pytest.mark.parametrize("name", ["bdv.xml", "bdv.n5"])
@pytest.mark.parametrize("compression", ["gzip", "raw", "bzip2", "xz", "blosc"])
def test_samples_and_facts_are_those_of_hdf5(tmp_path, name, options, compression):
    samples = image(2)  # up to 60000: more than int16 holds
    times = "<first>0</first><last>1</last>"
    for folder in ("h5", "n5"):
        (tmp_path / folder).mkdir()
    blosc = {"compression": compression} if compression != "blosc" else {}
    save_bdv(tmp_path / "h5", samples, times=times)
    save_bdv_n5(tmp_path / "n5", samples, times=times, **blosc)
    volume, other = (
        ws.open(tmp_path / folder / file, time=1, channel=1, **options)
        for folder, file in (("n5", name), ("h5", "bdv.xml"))
    )
    assert (volume.unit, volume.guesses, volume.dtype) == ("um", (), np.uint16)
    np.testing.assert_array_equal(volume.world_from_index, other.world_from_index)
    np.testing.assert_array_equal(np.asarray(volume), samples[1, 1])
    assert (volume.facts.channels, volume.facts.n_times) == (other.facts.channels, 2)
    assert volume.facts.levels == ((6, 10, 12), (3, 5, 6))


@pytest.mark.parametrize("options", [{}, {"memory": "1 MB"}])
def test_a_coarser_level_has_means_of_blocks(tmp_path, options):
    samples = image(1, 1)
    volume = ws.open(save_bdv_n5(tmp_path, samples), level=1, **options)
    np.testing.assert_array_equal(np.asarray(volume), halved(samples[0, 0]))
    assert volume.spacing == pytest.approx((0.4, 0.4, 2))


def test_without_its_xml_the_folder_is_read_and_distances_are_a_guess(tmp_path):
    save_bdv_n5(tmp_path, image(2, 1)).unlink()
    volume = ws.open(tmp_path / "bdv.n5", time=1)
    np.testing.assert_array_equal(volume.samples, image(2, 1)[1, 0])
    assert volume.guesses == ("distances of samples 1, 1, 1: BigDataViewer's .xml is not beside the file",)


def test_pictures_of_a_budget_are_those_in_memory(tmp_path):
    xml = save_bdv_n5(tmp_path, image(1, 1))
    camera = ws.Camera.orbit(ws.open(xml), 30, 20)
    look = ws.TransferFunction([(0, 0), (60000, 0.5)], [(0, 0, 0, 0), (60000, 1, 1, 1)])
    here, there = (
        ws.render(ws.open(xml, level=0, **options), look, camera, size=(40, 30), device="cpu").rgba
        for options in ({}, {"memory": "1 MB"})
    )
    np.testing.assert_array_equal(here, there)


def test_blocks_that_are_not_there_are_0(tmp_path):
    xml = save_bdv_n5(tmp_path, image(1, 1))
    (tmp_path / "bdv.n5/setup0/timepoint0/s0/0/0/0").unlink()
    want = image(1, 1)[0, 0].copy()
    want[:2, :3, :4] = 0
    np.testing.assert_array_equal(ws.open(xml).samples, want)


def test_a_change_while_it_is_open_is_told(tmp_path):
    xml = save_bdv_n5(tmp_path, image(1, 1))
    volume = ws.open(xml, memory="1 MB")
    block = tmp_path / "bdv.n5/setup0/timepoint0/s0/0/0/0"
    block.write_bytes(block.read_bytes() + b"0")
    with pytest.raises(FileError, match="changed"):
        np.asarray(volume)


def broken(name, **changes):
    def change(folder):
        path = folder / "bdv.n5" / name / "attributes.json"
        path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (broken("setup0", downsamplingFactors=None), "nothing is said of the levels of setup 0"),
        (broken("setup0", downsamplingFactors=[[1, 1, "x"]]), "nothing is said of the levels"),
        (broken("setup0", downsamplingFactors=[[1, 1, 1]] * 3), "are not there .setup0/timepoint0/s2."),
        (broken("setup0/timepoint0/s0", dimensions=[12, 10]), "dimensions .12, 10. and type uint16"),
        (broken("setup0/timepoint0/s0", dataType="object"), "type object"),
        (broken("setup0/timepoint0/s0", compression={"type": "secret"}), "damaged|secret"),
        (lambda folder: (folder / "bdv.n5/setup0/attributes.json").write_text("{"), "damaged"),
        (lambda folder: (folder / "bdv.n5/setup0/timepoint0/s0/0/0/0").write_bytes(b"12345678"), "damaged"),
    ],
)
def test_damage_is_told(tmp_path, change, message):
    xml = save_bdv_n5(tmp_path, image(1, 1))
    change(tmp_path)
    with pytest.raises(FileError, match=message):
        ws.open(xml)


def test_without_tensorstore_the_package_is_named(tmp_path, monkeypatch):
    xml = save_bdv_n5(tmp_path, image(1, 1))
    monkeypatch.setitem(__import__("sys").modules, "tensorstore", None)
    with pytest.raises(LibraryError, match=r"tensorstore is not installed.*\[n5\]"):
        ws.open(xml)


def test_the_command_line_draws_it(tmp_path):
    save_bdv_n5(tmp_path, image(1))
    result = CliRunner().invoke(
        app, ["render", str(tmp_path / "bdv.xml"), "-o", str(tmp_path / "a.png"), "--size", "30x30"]
    )
    assert result.exit_code == 0, result.output
    assert (tmp_path / "a.png").exists()
