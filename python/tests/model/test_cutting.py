"""Boxes cut out of volumes and labels, corners by name, and views that fit the remaining part."""

import pickle

import numpy as np
import pytest
from tiff_pixels import tiff_pixels

import wavesplat as ws
from wavesplat._model.arguments.clips import combined_clips
from wavesplat._model.volume.cutting import taken_out
from wavesplat._render.framing import framed
from wavesplat.errors import ArgumentError

SOLID = ws.TransferFunction([(0, 0), (50, 0), (60, 1)], [(0, 1, 1, 1)])
CLEAR = ws.TransferFunction([(0, 0)], [(0, 1, 1, 1)])


def block(*, shape=(12, 14, 16), value=100, **place):
    return ws.Volume(np.full(shape, value, np.uint8), **place)


def index_box(lower, upper):
    return ws.Crop(lower, upper, space="index")


# Masks of the samples that are cut out


def test_a_box_in_samples_keeps_its_faces():
    out = taken_out(block(), [index_box((3, 4, 5), (9, 8, 7.5))])
    assert {tuple(p) for p in np.argwhere(out)} == {(z, y, x) for z in (6, 7) for y in (5, 6, 7) for x in range(4, 9)}


def test_corners_may_come_in_any_order_and_world_boxes_are_boxes_of_samples():
    volume = block(world_from_index=[[0, 0, 2, 5], [-1, 0, 0, 3], [0, 0.5, 0, 1], [0, 0, 0, 1]])
    index = np.array([[3, 4, 5], [9, 8, 7]])
    ends = index @ volume.world_from_index[:3, :3].T + volume.world_from_index[:3, 3]
    want = taken_out(volume, [index_box(*index)])
    assert want.sum() == 5 * 3 * 1
    np.testing.assert_array_equal(taken_out(volume, [ws.Crop(ends[0], ends[1])]), want)
    np.testing.assert_array_equal(taken_out(volume, [ws.Crop(ends[1], ends[0])]), want)


def test_world_boxes_cut_oblique_grids_by_the_centres_of_samples(oblique):
    volume = ws.Volume(np.resize(oblique.samples, (40, 41, 42)), world_from_index=oblique.world_from_index)
    lower, upper = volume.bounds
    lower, upper = lower + 0.3 * (upper - lower), lower + 0.6 * (upper - lower)
    z, y, x = np.indices(volume.shape)
    world = np.stack([x, y, z], axis=-1) @ volume.world_from_index[:3, :3].T + volume.world_from_index[:3, 3]
    want = np.all((world > lower) & (world < upper), axis=-1)
    got = taken_out(volume, [ws.Crop(lower, upper)])
    assert want.sum() > 1000
    assert not (want & ~got).any()
    assert (got & ~want).sum() < 0.01 * want.sum()  # stairs at the cut whose tops have no neighbour


@pytest.mark.parametrize(
    "boxes",
    [
        [index_box((0, 0, 0), (8, 13, 11))],  # ends on the volume's faces
        [index_box((-3, -3, -3), (4, 20, 20)), index_box((4, -3, -3), (8, 20, 20))],  # with a face in common
    ],
)
def test_no_sheet_stays_where_boxes_end(boxes):
    out = taken_out(block(), boxes)
    assert out[..., :8].all()
    assert not out[..., 8:].any()


# Pictures


@pytest.mark.parametrize("composite", ["over", "maximum", "mean", "x-ray"])
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint32, np.float64])
def test_taking_out_is_the_complement_of_keeping(composite, dtype):
    samples = np.random.default_rng(3).integers(0, 100, (12, 14, 16)).astype(dtype)
    volume = ws.Volume(samples)
    view = {
        "look": ws.TransferFunction([(0, 0), (100, 0.5)], [(0, 1, 1, 1)]),
        "camera": ws.Camera.orbit(volume, 30, 20, fit="view"),
        "composite": composite,
        "shading": None,
        "size": (40, 40),
    }
    whole = ws.render(volume, **view)
    # Half way between the last sample that is taken out and the first that stays.
    kept = ws.render(volume, clip=index_box((7.5, 0, 0), (15, 13, 11)), **view)
    cut = ws.render(volume, clip=ws.CutOut(index_box((-1, -1, -1), (8, 20, 20))), **view)
    # Removed samples against a cut by a plane: edges differ by a part of a pixel, here and there by a sheet.
    if composite == "over":
        assert np.abs(cut.rgba - kept.rgba).mean() < 0.05 * np.abs(whole.rgba - kept.rgba).mean()
        return
    assert (np.isfinite(cut.value) ^ np.isfinite(kept.value)).mean() < 0.02
    assert (np.isfinite(whole.value) ^ np.isfinite(kept.value)).mean() > 0.1
    both = np.isfinite(cut.value) & np.isfinite(kept.value)
    apart = np.abs(cut.value - kept.value)[both]
    assert np.median(apart) < 1e-4


def test_colours_are_those_of_the_whole():
    samples = np.zeros((12, 14, 16), np.float32)
    samples[..., 4:8], samples[..., 10:] = 1000, 10
    volume = ws.Volume(samples)
    box = ws.CutOut(index_box((-1, -1, -1), (9, 20, 20)))
    camera = ws.Camera.orbit(volume, 0, 0, fit="view")
    got = ws.render(volume, None, camera, composite="maximum", clip=box, size=(20, 20))
    want = ws.render(volume, ws.Look.auto(volume, "maximum"), camera, clip=box, size=(20, 20))
    np.testing.assert_array_equal(got.rgba, want.rgba)


def test_frames_of_a_turn_share_one_copy():
    volume = ws.Volume(np.arange(2 * 3 * 4, dtype=np.int16).reshape(2, 3, 4))
    box = index_box((-1, -1, -1), (2, 5, 5))
    draw = {"size": (8, 8), "clip": [ws.CutOut(box)]}
    ws.render(volume, "grey", **draw)
    first = volume._cut[1]
    assert first.samples.dtype == np.float32
    ws.render(volume, "grey", "left", **draw)
    assert volume._cut[1] is first
    ws.render(volume, "grey", size=(8, 8))
    assert volume._cut[1] is first
    ws.render(volume, "grey", size=(8, 8), clip=ws.CutOut(index_box((-1, -1, -1), (1, 5, 5))))
    assert volume._cut[1] is not first
    assert pickle.loads(pickle.dumps(volume))._cut is None  # noqa: S301 - our own bytes


def test_a_changed_array_is_cut_anew():
    samples = np.full((12, 14, 16), 100, np.float32)
    volume = ws.Volume(samples)
    draw = {
        "camera": ws.Camera.orbit(volume, 0, 0, fit="view"),
        "size": (10, 10),
        "clip": ws.CutOut(index_box((-1, -1, -1), (8, 20, 20))),
    }
    assert ws.render(volume, SOLID, **draw).rgba.max() > 0
    samples[:] = 0
    volume.changed()
    assert ws.render(volume, SOLID, **draw).rgba.max() == 0


# Labels


def cut_labels(segmentation, looks, box, *, scan_value=0):
    scan = block(shape=segmentation.shape, value=scan_value)
    camera = ws.Camera.orbit(scan, 30, 30, fit="view")
    labels = ws.Labels(segmentation, looks)
    return labels, ws.render(
        scan, CLEAR, camera, labels=labels, clip=ws.CutOut(box), size=(60, 60), background="black"
    ).rgba


@pytest.mark.parametrize("other", [0, 7])  # a segmentation without "none" as well
def test_cut_faces_of_labels_are_lit(other):
    segmentation = np.full((21, 21, 21), 1, np.uint8)
    segmentation[0] = other
    looks = {1: ws.Label("white", opacity=1)}
    box = index_box((-1, -1, 10), (30, 30, 30))
    labels, cut = cut_labels(segmentation, looks, box)
    by_hand = segmentation.copy()
    by_hand[11:] = other
    _, want = cut_labels(by_hand, looks, box)
    np.testing.assert_array_equal(cut, want)
    # The view from above shows the cut face; unlit faces, such as those at the volume's ends, have ambient light only.
    assert cut[..., :3].max() > 0.6
    assert labels.numbers == (1,) + (7,) * (other == 7) if other else (0, 1)


def test_labels_keep_their_cut_for_the_next_frame():
    labels, _ = cut_labels(np.full((9, 9, 9), 1, np.uint8), None, index_box((-1, -1, -1), (4, 9, 9)))
    scan = block(shape=(9, 9, 9))
    boxes = (index_box((-1, -1, -1), (4, 9, 9)),)
    assert labels.without(boxes, scan) is labels.without(boxes, scan)
    assert labels.without((), scan) is labels
    with pytest.raises(ArgumentError, match="the scan \\(9, 9, 8\\)"):
        labels.without(boxes, block(shape=(9, 9, 8)))


# Corners


@pytest.mark.parametrize(
    ("name", "sides"),
    [
        ("right anterior superior", (1, 1, 1)),
        ("Left-Posterior-Inferior", (-1, -1, -1)),
        ("superior, left", (-1, 0, 1)),
        ("anterior", (0, 1, 0)),
        ("+x-y+z", (1, -1, 1)),
        ("-z", (0, 0, -1)),
        ("-X+z", (-1, 0, 1)),
    ],
)
def test_corners_have_names(name, sides):
    volume = ws.Volume(np.zeros((4, 5, 6), np.uint8), spacing=(1, 2, 3), anatomical=True)
    crop = ws.Crop.corner(volume, name)
    assert crop.space == "world"
    middle = (2.5, 4, 4.5)
    for axis, side in enumerate(sides):
        low, high = crop.lower[axis], crop.upper[axis]
        assert (low == middle[axis]) if side > 0 else (low < 0)
        assert (high == middle[axis]) if side < 0 else (high > volume.bounds[1][axis])
    assert ws.Crop.corner(volume, "+x", at=(1, 2, 3)).lower[0] == 1


def test_corners_are_of_the_patient_however_the_samples_lie():
    flipped = np.diag([-1.0, 1, 1, 1])
    volume = ws.Volume(np.zeros((4, 5, 6), np.uint8), world_from_index=flipped, anatomical=True)
    out = taken_out(volume, [ws.Crop.corner(volume, "right")])
    assert out[..., :3].all()
    assert not out[..., 3:].any()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("front", "corner 'front' is unknown; name one to three sides"),
        ("", "is unknown"),
        ("+x+x", "two sides along x"),
        ("left right", "two sides along x"),
        ("x", "is unknown"),
    ],
)
def test_wrong_corners_are_refused(name, message):
    with pytest.raises(ArgumentError, match=message.replace("+", "\\+")):
        ws.Crop.corner(block(anatomical=True), name)


def test_corners_of_a_patient_need_one():
    with pytest.raises(
        ArgumentError, match=r'nothing says how volume .* name the axes of the world, such as "\+x-y\+z"'
    ):
        ws.Crop.corner(block(), "left")


# Views


def test_views_fit_what_is_left():
    volume = block(shape=(20, 20, 40))
    look = ws.Look(transfer_function=SOLID)
    whole = framed([(volume, look)], 0, 0).parallel_scale
    middle = (19.5, 9.5, 9.5)
    clipping = combined_clips([ws.ClipPlane((29, 0, 0), (1, 0, 0)), ws.ClipPlane(middle, (0, 0, 1))])
    clipped = framed([(volume, look)], 0, 0, clipping=clipping)
    assert clipped.parallel_scale < 0.6 * whole
    assert clipped.focal_point[0] == pytest.approx(34, abs=1)
    assert clipped.focal_point[2] == pytest.approx(14.5, abs=1)
    # Boxes give the same views, also where a transparent scan has labels, or a projection shows other values.
    boxes = [ws.CutOut(ws.Crop.corner(volume, name, at=at)) for name, at in (("-x", (29, 0, 0)), ("-z", None))]
    labels = ws.Labels(np.ones(volume.shape, np.uint8))
    for options in ({"look": SOLID}, {"look": CLEAR, "labels": labels}):
        picture = ws.render(volume, camera="anterior", clip=boxes, size=(40, 40), **options)
        assert (picture.rgba[..., 3] > 0).mean() > 0.6
    assert (ws.render(volume, SOLID, "anterior", size=(40, 40)).rgba[..., 3] > 0).mean() < 0.6


def test_planes_that_leave_nothing_still_have_a_view():
    picture = ws.render(block(), SOLID, "anterior", clip=ws.ClipPlane((99, 0, 0), (1, 0, 0)), size=(8, 8))
    assert picture.rgba.max() == 0


# Refused arguments


@pytest.mark.parametrize(
    ("clip", "message"),
    [
        ([3], r"clip 0 is 3; give wavesplat.Crop\(lower, upper\) to keep a box"),
        ([ws.Crop((0, 0, 0), (1, 1, 1)), "left"], "clip 1 is 'left'; give"),
        ("left", "clip is 'left'; give"),
        ([ws.Crop((0, 0, 0), (1, 1, 1)), ws.Crop((2, 2, 2), (3, 3, 3))], "the 2 boxes of clip have nothing in common"),
        (
            ws.CutOut(ws.Crop((-1, -1, -1), (99, 99, 99))),
            r"leaves nothing of volume 'volume'; its bounds are \(0, 0, 0\) to \(15",
        ),
    ],
)
def test_clips_that_cannot_be_are_refused(clip, message):
    with pytest.raises(ArgumentError, match=message):
        ws.render(block(), SOLID, clip=clip, size=(8, 8))


def test_what_is_cut_out_is_a_finite_box():
    with pytest.raises(ArgumentError, match="CutOut takes out a str; give a wavesplat.Crop"):
        ws.CutOut("left")
    with pytest.raises(ArgumentError, match="give finite numbers"):
        ws.CutOut(ws.Crop((0, 0, 0), (1, 1, np.inf)))
    with pytest.raises(ArgumentError, match="clip plane has .*a normal that is not zero"):
        ws.ClipPlane((0, 0, 0), (0, 0, 0))


def test_several_boxes_keep_what_they_have_in_common():
    volume = block(spacing=(1, 2, 1))
    draw = {"camera": ws.Camera.orbit(volume, 30, 20), "size": (40, 30)}
    want = ws.render(volume, SOLID, clip=index_box((3, 2, 1), (9, 8, 7)), **draw).rgba
    boxes = [index_box((3, -5, -5), (40, 8, 40)), index_box((-5, 2, 7), (9, 40, 1))]
    np.testing.assert_array_equal(ws.render(volume, SOLID, clip=boxes, **draw).rgba, want)
    mixed = [boxes[0], ws.Crop((-5, 4, 1), (9, 40, 7))]
    np.testing.assert_allclose(ws.render(volume, SOLID, clip=mixed, **draw).rgba, want, atol=2e-2)
    assert want.max() > 0.5


def test_wavelets_say_what_to_do():
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(16))
    with pytest.raises(ArgumentError, match="has wavelet coefficients; draw its to_volume()"):
        ws.render(wavelets, clip=ws.CutOut(ws.Crop((0, 0, 0), (1, 1, 1))), size=(8, 8))


# The command line


def test_the_command_line_cuts_as_the_api_does(wavesplat, tmp_path):
    import nibabel

    samples = np.random.default_rng(5).integers(0, 255, (16, 16, 16)).astype(np.uint8)
    path, out = tmp_path / "noise.nii.gz", tmp_path / "a.tif"
    nibabel.save(nibabel.Nifti1Image(samples.T, np.eye(4)), path)
    options = "--preset grey --size 40x30 --view left --cut-out right-anterior-superior --cut-out -2,-2,-2,5,5,5"
    more = "--cut-out-index 9,9,9,11.5,12,13 --clip 0,0,2,0,0,1 --clip=0,0,14,0,0,-1 --background black"
    done = wavesplat("render", path, "-o", out, *options.split(), *more.split())
    assert (done.returncode, done.stderr) == (0, "")
    import tifffile

    volume = ws.open(path)
    boxes = [
        ws.Crop.corner(volume, "right anterior superior"),
        ws.Crop((-2, -2, -2), (5, 5, 5)),
        index_box((9, 9, 9), (11.5, 12, 13)),
    ]
    planes = [ws.ClipPlane((0, 0, 2), (0, 0, 1)), ws.ClipPlane((0, 0, 14), (0, 0, -1))]
    clip = [*planes, *map(ws.CutOut, boxes)]
    want = ws.render(volume, "grey", "left", size=(40, 30), clip=clip, background="black")
    np.testing.assert_array_equal(tifffile.imread(out), tiff_pixels(want))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--cut-out", "1,2,3"], "'1,2,3' is not 6 numbers"),
        (["--cut-out", "front"], "corner 'front' is unknown"),
        (["--cut-out", "left", "--wavelet-level", "1"], "draw its to_volume()"),
        (["--clip", "1,2,3"], "'1,2,3' is not 6 numbers"),
        (["--clip", "1,2,3,0,0,0"], "normal"),
    ],
)
def test_wrong_cuts_are_wrong_arguments(wavesplat, ramp_file, tmp_path, options, message):
    done = wavesplat("render", ramp_file, "-o", tmp_path / "a.png", "--size", "8x8", *options)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stderr.count("\n") == 1
