"""DICOM segmentations as label maps: every frame at its place, with names and colours of the segments."""

from __future__ import annotations

import json

import numpy as np
import pytest
from dicom_files import save, segmentation, slice_at

import wavesplat as ws
from wavesplat.errors import ArgumentError, FileError, FileWarning

#: Slices, rows and columns; a number of pixels that is no multiple of eight, so that frames begin inside bytes.
SHAPE = (6, 5, 7)
#: 3D Slicer's green and orange (128, 174, 128), (216, 101, 79), as dcmqi writes them.
GREEN, ORANGE = [43803, 26565, 37722], [37064, 44082, 41620]
SEGMENTS = {1: ("liver", GREEN), 2: ("spleen", ORANGE), 5: ("vein", None)}
WORLD_FROM_INDEX = [[-0.7, 0, 0, -10], [0, -0.8, 0, -20], [0, 0, 1.5, 30], [0, 0, 0, 1]]


def box(z, y, x):
    mask = np.zeros(SHAPE, bool)
    mask[z, y, x] = True
    return mask


#: Masks by number: two overlap, in 2 x 1 x 3 voxels.
MASKS = {
    1: box(slice(1, 4), slice(1, 4), slice(0, 4)),
    2: box(slice(2, 4), slice(3, 5), slice(1, 6)),
    5: box(slice(5, 6), slice(0, 2), slice(5, 7)),
}


def frames(seed=0):
    """The masks of all segments, slices without any left out, in a random order."""
    listed = [(number, z, mask[z]) for number, mask in MASKS.items() for z in range(SHAPE[0]) if mask[z].any()]
    return [listed[n] for n in np.random.default_rng(seed).permutation(len(listed))]


def label_map():
    numbers = np.zeros(SHAPE, np.uint8)
    for number, mask in MASKS.items():
        numbers[mask] = number
    return numbers


def saved(tmp_path, dataset, name="seg"):
    return save(tmp_path / name, [dataset]) / "000.dcm"


@pytest.mark.parametrize("seed", range(4))
def test_frames_in_any_order_with_empty_slices_left_out_fault_9(tmp_path, seed):
    file = saved(tmp_path, segmentation(frames(seed), segments=SEGMENTS))
    with pytest.warns(FileWarning, match="overlap"):
        volume = ws.open(file)
    assert (volume.modality, volume.unit, volume.is_anatomical) == ("SEG", "mm", True)
    np.testing.assert_array_equal(volume.samples, label_map()[1:])
    moved = np.array(WORLD_FROM_INDEX)
    moved[2, 3] += 1.5  # the first slice has no frame
    np.testing.assert_allclose(volume.world_from_index, moved, atol=1e-9)


def test_overlapping_segments_show_the_last_and_count_the_hidden(tmp_path, wavesplat):
    file = saved(tmp_path, segmentation(frames(), segments=SEGMENTS))
    told = "the last of the file is shown in 6 voxels: hidden are 6 of 36 voxels of 'liver'"
    assert told in wavesplat("info", file).stdout
    with pytest.warns(FileWarning, match=told):
        labels = ws.Labels.open(file)
    assert [(number, look.name) for number, look in labels.labels.items()] == [(1, "liver"), (2, "spleen"), (5, "vein")]
    # Of the segments that are asked for none is hidden by others; documents name the file only if it is the same.
    alone = ws.Labels.open(file, segments=["liver"])
    assert (list(alone.labels), alone._source) == ([1], None)
    assert (np.array(alone.numbers)[alone._codes] == 1).sum() == 36
    free = ws.Labels.open(file, segments=["v*", 2])
    assert list(free.labels) == [5, 2]
    assert free._source is not None


def test_names_and_colours_of_segments(tmp_path, wavesplat):
    dataset = segmentation(frames(), segments={**SEGMENTS, 5: ("Gefäß", None), 9: ("not there", None)})
    dataset.SpecificCharacterSet = "ISO_IR 192"
    file = saved(tmp_path, dataset)
    with pytest.warns(FileWarning, match="overlap"):
        labels = ws.Labels.open(file).labels
    assert [round(255 * share) for share in labels[1].color] == [128, 174, 128]
    assert [round(255 * share) for share in labels[2].color] == [216, 101, 79]
    assert labels[5].name == "Gefäß"
    listed = wavesplat("info", file).stdout
    assert "label 1      liver, #80ae80, 30 voxels, 0.0252 ml" in listed
    assert "label 2      spleen, #d8654f, 20 voxels" in listed
    assert "label 9      not there, 0 voxels" in listed


def test_drawn_alone_segments_have_their_names_fault_5(tmp_path, wavesplat):
    file = saved(tmp_path, segmentation(frames(), segments=SEGMENTS))
    told = wavesplat("render", file, "-o", tmp_path / "x.png", "--size", 32, "--json").stdout
    labels = json.loads(told)["report"]["labels"]
    assert [one["name"] for one in labels] == ["liver", "spleen", "vein"]
    assert [round(255 * share) for share in labels[0]["color"]] == [128, 174, 128]


def test_shares_of_voxels_are_labels_from_a_half_on(tmp_path):
    shares = np.random.default_rng(3).integers(0, 201, (2, *SHAPE[1:]))
    masks = [(1, 0, shares[0]), (1, 1, shares[1])]
    file = saved(tmp_path, segmentation(masks, segments={1: ("lesion", None)}, kind="FRACTIONAL", whole=200))
    with pytest.warns(FileWarning, match="shares of voxels"):
        volume = ws.open(file)
    np.testing.assert_array_equal(volume.samples, shares >= 100)
    alone = ws.open(file, channel=0)
    np.testing.assert_allclose(alone.samples, shares / 200, atol=1e-6)
    assert alone.facts.channel == ws.Channel("lesion")
    with pytest.raises(ArgumentError, match="0 lesion"):
        ws.open(file, channel=1)


def test_label_maps_have_all_segments_in_one_frame(tmp_path):
    numbers = np.random.default_rng(4).choice([0, 1, 5, 7], (3, *SHAPE[1:]))
    segments = {0: ("background", None), 1: ("liver", GREEN), 5: ("vein", None)}
    dataset = segmentation([(0, z, numbers[z]) for z in (2, 0, 1)], segments=segments, kind="LABELMAP")
    dataset.PixelPaddingValue = 7  # as background, in all that no segment has
    volume = ws.open(saved(tmp_path, dataset))
    np.testing.assert_array_equal(volume.samples, np.where(numbers == 7, 0, numbers))


def test_segments_that_are_not_described_are_there(tmp_path):
    bare = segmentation(frames(), segments={})
    with pytest.warns(FileWarning, match="hidden are 6 of 36 voxels of 'segment 1'"):
        assert ws.Labels.open(saved(tmp_path, bare)).labels[5].name == "5"
    unnamed = segmentation([(None, 1, MASKS[1][1]), (None, 2, MASKS[1][2])], segments={4: ("liver", None)})
    volume = ws.open(saved(tmp_path, unnamed, "unnamed"))
    np.testing.assert_array_equal(volume.samples, 4 * MASKS[1][1:3])
    numbers = np.random.default_rng(5).choice([0, 1, 300], (2, *SHAPE[1:])).astype(np.uint16)
    wide = segmentation([(0, 0, numbers[0]), (0, 1, numbers[1])], segments={1: ("liver", None)}, kind="LABELMAP")
    wide.PixelData, wide.BitsAllocated, wide.BitsStored, wide.HighBit = numbers.tobytes(), 16, 16, 15
    np.testing.assert_array_equal(ws.open(saved(tmp_path, wide, "wide")).samples, numbers)


def test_segments_by_themselves_keep_what_others_hide(tmp_path):
    file = saved(tmp_path, segmentation(frames(), segments=SEGMENTS))
    for channel, (number, mask) in enumerate(MASKS.items()):
        alone = ws.open(file, channel=channel)
        np.testing.assert_array_equal(alone.samples, mask[1:])
        assert alone.facts.channel.name == SEGMENTS[number][0]


@pytest.mark.parametrize("between", [None, 1.4999, 3.0])
def test_the_distance_of_slices(tmp_path, between):
    """Without a distance, or with one that fits no frame, the smallest distance of frames counts, and is told."""
    listed = [(number, 2 * z, mask) for number, z, mask in frames() if number == 1]
    file = saved(tmp_path, segmentation([*listed, (1, 10, MASKS[1][1])], segments=SEGMENTS, between=between))
    volume = ws.open(file)
    step = 1.5 if between == 1.4999 else 3.0
    np.testing.assert_allclose(volume.spacing, (0.7, 0.8, step), rtol=1e-6)
    assert volume.shape[0] == round(8 * 1.5 / step) + 1
    assert [z for z in range(volume.shape[0]) if volume.samples[z].any()] == [
        round(n * 1.5 / step) for n in (0, 2, 4, 8)
    ]
    assert any("smallest distance" in guess for guess in volume.guesses) == (between is None)


def test_a_single_slice_keeps_its_place_and_thickness(tmp_path):
    file = saved(tmp_path, segmentation([(1, 4, MASKS[1][1])], segments=SEGMENTS, between=None))
    volume = ws.open(file)
    assert volume.shape[0] == 3
    np.testing.assert_array_equal(volume.samples[1], MASKS[1][1])
    assert not volume.samples[[0, 2]].any()
    np.testing.assert_allclose(volume.world_from_index[:3, 2], (0, 0, 1.5))
    np.testing.assert_allclose((volume.world_from_index @ [0, 0, 1, 1])[:3], (-10, -20, 36))


def test_what_no_volume_can_be_made_of_is_refused(tmp_path):
    tiled = segmentation(frames(), segments=SEGMENTS, TotalPixelMatrixColumns=70)
    with pytest.raises(FileError, match="viewer of slides"):
        ws.open(saved(tmp_path, tiled, "tiled"))
    odd = segmentation(frames(), segments=SEGMENTS, SegmentationType="PROBABILITY")
    with pytest.raises(FileError, match="kind of the segmentation is 'PROBABILITY'.* one of BINARY, FRACTIONAL"):
        ws.open(saved(tmp_path, odd, "odd"))
    flat = segmentation(frames(), segments=SEGMENTS)
    for group in flat.PerFrameFunctionalGroupsSequence:
        del group.PlanePositionSequence
    with pytest.raises(FileError, match="flat picture"):
        ws.open(saved(tmp_path, flat, "flat"))
    uneven = [(1, 0, MASKS[1][1]), (1, 0.02, MASKS[1][2]), (1, 4000, MASKS[1][3])]
    with pytest.raises(FileError, match="uneven distances"):  # and not 200 000 empty slices between them
        ws.open(saved(tmp_path, segmentation(uneven, segments=SEGMENTS), "uneven"))


def test_several_files_of_a_folder_are_not_mixed(tmp_path):
    folder = save(tmp_path / "seg", [segmentation(frames(), segments=SEGMENTS, InstanceNumber=n) for n in (1, 2)])
    with pytest.raises(FileError, match="holds 2 segmentations; name one of the files"):
        ws.open(folder)
    with pytest.warns(FileWarning, match="overlap"):
        assert ws.open(folder / "001.dcm").shape == (5, 5, 7)


def test_labels_over_their_scan_fault_5(tmp_path, wavesplat):
    """A segmentation with a frame for every slice lies on its scan, in space and on slices, with a legend."""
    scan = save(tmp_path / "ct", [slice_at(np.full(SHAPE[1:], 40 * n, np.int16), n) for n in range(SHAPE[0])])
    listed = [(number, z, mask[z]) for number, mask in MASKS.items() for z in range(SHAPE[0])]
    labels = saved(tmp_path, segmentation(listed, segments=SEGMENTS))
    for command in ("render", "slice"):
        picture = tmp_path / f"{command}.png"
        done = wavesplat(command, scan, "--labels", labels, "--legend", "--size", "200x200", "-o", picture)
        assert done.returncode == 0, done.stderr
        assert "note: segments overlap" in done.stderr
    with pytest.warns(FileWarning, match="overlap"):
        shown = ws.slice(ws.Scene(ws.open(scan), labels=ws.Labels.open(labels)))
    assert [label["name"] for label in shown.report["labels"]] == ["liver", "spleen"]  # of those in the slice
    shown = ("--labels", labels, "--segment", "VEIN", "--json", "--size", "60x60", "-o", tmp_path / "a.png")
    one = wavesplat("render", scan, *shown)
    assert '"vein"' in one.stdout
    assert '"liver"' not in one.stdout
    assert "overlap" not in one.stderr
    none = wavesplat("slice", scan, "--labels", labels, "--segment", "brain", "-o", tmp_path / "a.png")
    assert "no segment 'brain'; there are: 1 'liver', 2 'spleen', 5 'vein'" in none.stderr
    alone = wavesplat("slice", scan, "--segment", "brain", "-o", tmp_path / "a.png")
    assert "give it with --labels" in alone.stderr


def test_contours_show_overlapping_segments_whole(tmp_path, wavesplat):
    scan = save(tmp_path / "ct", [slice_at(np.full(SHAPE[1:], 40 * n, np.int16), n) for n in range(SHAPE[0])])
    inner = [(1, z, MASKS[1][1]) for z in range(6)]
    outer = [(2, z, np.ones(SHAPE[1:], bool)) for z in range(6)]
    segments = {1: ("liver", GREEN), 2: ("body", ORANGE), 3: ("nothing", None)}
    labels = saved(tmp_path, segmentation([*inner, *outer], segments=segments))
    # As labels, the whole liver lies below the body.
    with pytest.warns(FileWarning, match="hidden are 72 of 72 voxels of 'liver'"):
        assert list(ws.Labels.open(labels).labels) == [2]
    done = wavesplat("slice", scan, "--contours", labels, "--json", "--size", "99x99", "-o", tmp_path / "a.png")
    assert '"liver"' in done.stdout, done.stderr
    assert '"body"' in done.stdout
    assert "hidden" not in done.stderr
    assert "overlap" not in done.stderr
    # The same of some, which do not overlap, and names of a table.
    table = tmp_path / "names.tsv"
    table.write_text("index\tname\tcolor\n1\tHepar\t#00ffff\n2\tCorpus\t#ff00ff\n")
    options = ("--contours", labels, "--label-table", table, "--json", "--size", "99x99", "-o", tmp_path / "b.png")
    named = wavesplat("slice", scan, *options)
    assert '"Hepar"' in named.stdout, named.stderr
    assert '"Corpus"' in named.stdout
    one = wavesplat("slice", scan, *options, "--segment", "liver")
    assert '"Corpus"' not in one.stdout


def test_a_table_names_contours_that_do_not_overlap(tmp_path, wavesplat):
    """`--label-table` needed `--labels`, which draws the labels themselves."""
    scan = save(tmp_path / "ct", [slice_at(np.full(SHAPE[1:], 40 * n, np.int16), n) for n in range(SHAPE[0])])
    apart = [(1, z, MASKS[1][1]) for z in range(6)]
    labels = saved(tmp_path, segmentation(apart, segments={1: ("liver", GREEN)}))
    table = tmp_path / "names.tsv"
    table.write_text("index\tname\tcolor\n1\tHepar\t#00ffff\n")
    options = ("--label-table", table, "--json", "--size", "99x99", "-o", tmp_path / "b.png")
    named = wavesplat("slice", scan, "--contours", labels, *options)
    assert '"Hepar"' in named.stdout, named.stderr
    assert '"liver"' not in named.stdout
    # Of both, the table is that of the labels.
    both = wavesplat("slice", scan, "--contours", labels, "--labels", labels, *options)
    assert '"Hepar"' in both.stdout, both.stderr
    assert '"liver"' in both.stdout
    alone = wavesplat("slice", scan, *options)
    assert "--label-table names the labels of a segmentation; give it with --labels" in alone.stderr
