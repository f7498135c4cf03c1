"""BigDataViewer's XML and HDF5 (fault 6.9 of the microscopist's trial: spacing 1 though the XML lies beside it)."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
from microscope_files import bdv_xml, halved, image, save_bdv, save_bdv_samples

import wavesplat as ws
from wavesplat.errors import FileError


@pytest.mark.parametrize("options", [{}, {"memory": "1 MB"}])
@pytest.mark.parametrize("name", ["bdv.xml", "bdv.h5"])
def test_fault_6_9_both_files_are_read_together(tmp_path, name, options):
    samples = image(2)  # up to 60000: more than int16 holds
    save_bdv(tmp_path, samples, times="<first>0</first><last>1</last>")
    volume = ws.open(tmp_path / name, time=1, channel=1, **options)
    assert (volume.unit, volume.guesses) == ("um", ())
    np.testing.assert_allclose(volume.world_from_index, [[0.2, 0, 0, 5], [0, 0.2, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]])
    assert volume.dtype == np.uint16
    np.testing.assert_array_equal(np.asarray(volume), samples[1, 1])
    facts = volume.facts
    assert [channel.name for channel in facts.channels] == ["channel 0", "channel 1"]
    assert (facts.n_times, facts.levels) == (2, ((6, 10, 12), (3, 5, 6)))


@pytest.mark.parametrize("options", [{}, {"memory": "1 MB"}])
def test_a_coarser_level_has_means_of_blocks(tmp_path, options):
    samples = image(1, 1)
    volume = ws.open(save_bdv(tmp_path, samples), level=1, **options)
    np.testing.assert_array_equal(np.asarray(volume), halved(samples[0, 0]))
    assert volume.spacing == pytest.approx((0.4, 0.4, 2))
    assert volume.facts.channel is None  # one setup without a name may be of electrons
    np.testing.assert_allclose(volume.bounds[0], (5.1, 6.1, 7.5))


def test_the_xml_beside_is_found_by_what_it_names(tmp_path):
    xml = save_bdv(tmp_path, image(1, 1))
    xml.rename(tmp_path / "other.xml")
    (tmp_path / "aaa.xml").write_text("<SpimData>damaged")
    assert ws.open(tmp_path / "bdv.h5").unit == "um"
    (tmp_path / "other.xml").unlink()
    volume = ws.open(tmp_path / "bdv.h5")
    assert volume.spacing == (1, 1, 1)
    assert volume.guesses == ("distances of samples 1, 1, 1: BigDataViewer's .xml is not beside the file",)


def test_the_last_transform_is_applied_first(tmp_path):
    moved = ("1 0 0 100  0 1 0 0  0 0 1 0", "0 -1 0 0  1 0 0 0  0 0 1 0", "0.2 0 0 0  0 0.2 0 0  0 0 1 0")
    volume = ws.open(save_bdv(tmp_path, image(1, 1), transforms=moved))
    np.testing.assert_allclose(
        volume.world_from_index[:3], [[0, -0.2, 0, 100], [0.2, 0, 0, 0], [0, 0, 1, 0]], atol=1e-9
    )


def test_registrations_in_voxels_are_told(tmp_path):
    # BigStitcher counts in the smallest distance of samples, here 0.2 um.
    volume = ws.open(save_bdv(tmp_path, image(1, 1), transforms=("1 0 0 10  0 1 0 0  0 0 5 0",)))
    assert volume.spacing == pytest.approx((0.2, 0.2, 1))
    assert volume.world_from_index[0, 3] == pytest.approx(2)
    assert volume.guesses == ("registrations taken for numbers of 0.2 um: so they fit to voxelSize",)
    volume = ws.open(save_bdv(tmp_path, image(1, 1), transforms=("1 0 0 10  0 1 0 0  0 0 1 0",)))
    assert "voxelSize says 0.2 x 0.2 x 1" in volume.guesses[0]


def test_without_registrations_voxel_sizes_count(tmp_path):
    volume = ws.open(save_bdv(tmp_path, image(1, 1), transforms=()))
    assert (volume.spacing, volume.guesses) == ((0.2, 0.2, 1), ())
    volume = ws.open(save_bdv(tmp_path, image(1, 1), transforms=(), voxel=""))
    assert volume.guesses == ("distances of samples 1, 1, 1: the XML has none",)


def test_voxels_of_1_pixel_are_no_distance(tmp_path):
    volume = ws.open(save_bdv(tmp_path, image(1, 1), transforms=(), voxel="1.0 1.0 1.0", unit="pixel"))
    assert volume.guesses == ("distances of samples 1, 1, 1: the XML has none",)
    one = "1 0 0 0  0 1 0 0  0 0 1 0"
    volume = ws.open(save_bdv(tmp_path, image(1, 1), transforms=(one,), voxel="1.0 1.0 1.0", unit="pixel"))
    assert volume.guesses == ("distances of samples by the registration of the view: the XML has no voxelSize",)


def test_setups_that_are_tiles_are_channels_at_their_places(tmp_path):
    def shifted(setup):
        return (f"0.2 0 0 {10 * setup}  0 0.2 0 0  0 0 1 0",)

    xml = save_bdv(
        tmp_path, image(1, 4), transforms=shifted, attributes=lambda s: {"channel": s % 2, "tile": s // 2, "angle": 0}
    )
    scene = ws.open_scene(xml)
    assert [layer.name for layer in scene.layers][1:3] == ["channel 1, tile 0", "channel 0, tile 1"]
    assert [layer.drawn.bounds[0, 0] for layer in scene.layers] == [0, 10, 20, 30]
    told = "4 setups, which differ in tile, are channels, each at its registered place"
    assert scene.layers[0].drawn.guesses == (told,)


def test_names_of_channels(tmp_path):
    named = '<Attributes name="channel"><Channel><id>1</id><name>GFP</name></Channel></Attributes>'
    volume = ws.open(save_bdv(tmp_path, image(), of_channels=named), channel=0)
    assert [channel.name for channel in volume.facts.channels] == ["channel 0", "GFP"]


def test_patterns_of_times_and_missing_views(tmp_path):
    missing = '<MissingViews><MissingView timepoint="2" setup="0"/></MissingViews>'
    samples = image(3, 1)
    xml = save_bdv(tmp_path, samples, times="<integerpattern>0-2:2</integerpattern>", extra=missing)
    assert ws.open(xml, time=0).facts.n_times == 2
    with pytest.raises(FileError, match="the view of time 1 and channel 0 is missing"):
        ws.open(xml, time=1)
    xml.write_text(bdv_xml(n_setups=1, times="<integerpattern>0, 2</integerpattern>"))
    np.testing.assert_array_equal(ws.open(xml, time=1).samples, samples[2, 0])


def test_int16_that_is_said_to_be_signed_stays(tmp_path):
    save_bdv(tmp_path, image(1, 1))
    with h5py.File(tmp_path / "bdv.h5", "a") as file:
        file["s00"].attrs["dataType"] = "int16"
    assert ws.open(tmp_path / "bdv.h5").dtype == np.int16
    samples = image(1, 1, dtype=np.uint8)
    save_bdv(tmp_path, samples)
    np.testing.assert_array_equal(ws.open(tmp_path / "bdv.h5").samples, samples[0, 0])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"format": "bdv.n5", "tag": "n5", "name": "a.n5"}, "are not there .'a.n5'.*folder beside the XML"),
        ({"format": "bdv.n5", "tag": "n5", "name": "../a.n5"}, r"'../a.n5', in another folder.*external_files"),
        ({"format": "bdv.multimg.zarr", "tag": "zarr", "name": "a.zarr"}, r"in OME-Zarr; name one .*\(a.zarr\)"),
        ({"format": "spimreconstruction.filemap2"}, "another form .spimreconstruction.filemap2."),
        ({"name": "../other.h5"}, r"'../other.h5', in another folder.*external_files"),
        ({"name": "none.h5"}, "are not there .'none.h5'.*beside the XML"),
        ({"transforms": ("1 2 3",)}, "an affine of 3 numbers, not 12"),
        ({"transforms": ("0 0 0 0 0 0 0 0 0 0 0 0",)}, "cannot be inverted"),
        ({"times": "<first>1</first><last>0</last>"}, "no time points"),
        ({"extra": "<"}, "damaged: the XML"),
    ],
)
def test_what_cannot_be_read_says_why(tmp_path, options, message):
    with pytest.raises(FileError, match=message):
        ws.open(save_bdv(tmp_path, image(1, 1), **options))


def test_other_xml_is_none_of_big_data_viewer(tmp_path):
    path = tmp_path / "a.xml"
    path.write_text("<OME/>")
    with pytest.raises(FileError, match="none of BigDataViewer"):
        ws.open(path)
    path.write_text("<!DOCTYPE a><SpimData/>")
    with pytest.raises(FileError, match="document type"):
        ws.open(path)


def test_partitions_in_other_files_need_permission(tmp_path):
    save_bdv(tmp_path, image(1, 1))
    (tmp_path / "bdv.h5").rename(tmp_path / "part.h5")
    save_bdv_samples(tmp_path / "bdv.h5", image(1, 1))
    with h5py.File(tmp_path / "bdv.h5", "a") as file:
        del file["t00000/s00"]
        file["t00000/s00"] = h5py.ExternalLink("part.h5", "t00000/s00")
    with pytest.raises(FileError, match=r"'part.h5'.*external_files=True"):
        ws.open(tmp_path / "bdv.xml")
    assert ws.open(tmp_path / "bdv.xml", external_files=True).shape == (6, 10, 12)


def test_an_n5_folder_says_what_it_is(tmp_path):
    (tmp_path / "a.n5").mkdir()
    (tmp_path / "a.n5" / "attributes.json").write_text('{"n5": "2.5.1"}')
    with pytest.raises(FileError, match="N5"):
        ws.open(tmp_path / "a.n5")
