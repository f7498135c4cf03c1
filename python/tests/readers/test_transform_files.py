"""Transforms of registrations: each format's direction, against nitransforms, SimpleITK and nibabel."""

import warnings
from pathlib import Path

import nibabel as nib
import numpy as np
import pytest
import SimpleITK as sitk  # noqa: N813 - its usual name

import wavesplat as ws
from wavesplat._cli.options import layers
from wavesplat._cli.options.layers import LayerText, further_layers, layer_of
from wavesplat._cli.options.slices import LabelOptions, opened_contours, opened_isolines, opened_labels
from wavesplat.errors import ArgumentError, FileError, WavesplatWarning

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from nitransforms import linear as nt_linear
    from nitransforms.io.lta import FSLinearTransform

#: Fixed and moving scans: oblique, of other shapes, one with its first axis reversed, as FLIRT does otherwise.
FIXED = np.array([[-1.5, 0.1, 0, 40], [0.1, 1.2, 0.2, -30], [0, -0.2, 2, 10], [0, 0, 0, 1]])
MOVING = np.array([[1.1, 0, 0.1, -20], [0, 0.9, 0, 5], [-0.1, 0, 1.3, -8], [0, 0, 0, 1]])
SHAPES = (30, 36, 28), (24, 40, 20)  # x, y, z
#: The answer: from the moving scan's world to the fixed one's, with rotation, scale, shear and shift.
ANSWER = np.array([[0.96, -0.2, 0.1, 7], [0.25, 1.02, 0.05, -11], [-0.08, 0.03, 0.93, 4.5], [0, 0, 0, 1]])
RAS_FROM_LPS = np.diag([-1.0, -1, 1, 1])


@pytest.fixture
def scans(tmp_path):
    images = [
        nib.Nifti1Image(np.zeros(shape, np.uint8), matrix)
        for shape, matrix in zip(SHAPES, (FIXED, MOVING), strict=True)
    ]
    for name, image in zip(("fixed", "moving"), images, strict=True):
        image.header.set_xyzt_units("mm")
        nib.save(image, tmp_path / f"{name}.nii.gz")
    return ws.open(tmp_path / "fixed.nii.gz"), ws.open(tmp_path / "moving.nii.gz")


def itk(answer=ANSWER):
    """An affine of ITK: points of the fixed scan to points of the moving one, LPS, about a centre."""
    matrix = RAS_FROM_LPS @ np.linalg.inv(answer) @ RAS_FROM_LPS
    transform = sitk.AffineTransform(3)
    center = np.array([3.0, -4, 5])
    transform.SetCenter(center.tolist())
    transform.SetMatrix(matrix[:3, :3].ravel().tolist())
    transform.SetTranslation((matrix[:3, 3] + matrix[:3, :3] @ center - center).tolist())
    return transform


@pytest.mark.parametrize("suffix", [".tfm", ".txt", ".h5", ".mat"])
def test_itk(scans, tmp_path, suffix):
    fixed, moving = scans
    path = tmp_path / f"a{suffix}"
    sitk.WriteTransform(itk(), str(path))
    np.testing.assert_allclose(ws.open_transform(path, moving=moving, fixed=fixed), ANSWER, atol=1e-9)
    if suffix == ".tfm":  # nitransforms: from the fixed scan to the moving one, RAS
        other = nt_linear.load(path, fmt="itk").matrix
        np.testing.assert_allclose(np.linalg.inv(np.squeeze(other)), ANSWER, atol=1e-6)


def test_itk_resamples_the_moving_scan_to_where_it_is_moved(tmp_path):
    rng = np.random.default_rng(0)
    nearby = np.array([[0.9, 0.1, 0, 2], [-0.1, 0.95, 0, 1], [0, 0, 1.1, -1], [0, 0, 0, 1]])
    place = np.linalg.inv(ANSWER) @ FIXED @ nearby
    rough = ws.Volume(rng.random((28, 36, 30), np.float32), world_from_index=place, unit="mm", anatomical=True)
    moving = rough.smoothed(2.5)
    fixed = ws.Volume(np.zeros((28, 36, 30), np.float32), world_from_index=FIXED, unit="mm", anatomical=True)
    sitk.WriteTransform(itk(), str(tmp_path / "a.tfm"))
    wanted = sitk.Resample(moving.to_sitk(), fixed.to_sitk(), itk(), sitk.sitkLinear, float("nan"))
    matrix = ws.open_transform(tmp_path / "a.tfm", moving=moving, fixed=fixed)
    moved = moving.moved(matrix)
    found = ws.slice([fixed, moved], "axial", size=(40, 40))  # the moved scan's own samples are between pixels
    of_sitk = ws.slice(ws.Volume(wanted), "axial", size=(40, 40)).value
    of_ours = ws.slice(fixed, "axial", difference=moved, size=(40, 40)).value
    wrong = ws.slice(fixed, "axial", difference=moving.moved(np.linalg.inv(matrix)), size=(40, 40)).value
    off = {}
    for name, ours in (("right", of_ours), ("wrong", wrong)):
        inside = np.isfinite(of_sitk) & np.isfinite(ours)
        assert inside.sum() > 200
        off[name] = np.abs(of_sitk + ours)[inside].mean() / of_sitk[inside].std()
    # SimpleITK's samples are interpolated once more.
    assert off["right"] < 0.1
    assert off["wrong"] > 0.5
    assert found.report["layers"][1]["processing"][-1] == "moved by an affine map"


def lta(numbers, kind, src, dst, invalid=False):
    text = f"type      = {kind} # LINEAR\nnxforms   = 1\nmean      = 0.0 0.0 0.0\nsigma     = 10000.0\n1 4 4\n"
    text += "\n".join(" ".join(f"{number:.15e}" for number in row) for row in numbers) + "\n"
    for name, (shape, matrix) in (("src", src), ("dst", dst)):
        spacing = np.linalg.norm(matrix[:3, :3], axis=0)
        axes = matrix[:3, :3] / spacing
        middle = matrix[:3, 3] + matrix[:3, :3] @ np.array(shape) / 2
        text += f"{name} volume info\nvalid = {int(not invalid)}  # volume info valid\nfilename = /x/{name}.mgz\n"
        text += "volume = {} {} {}\n".format(*shape)
        for key, values in (
            ("voxelsize", spacing),
            ("xras  ", axes[:, 0]),
            ("yras  ", axes[:, 1]),
            ("zras  ", axes[:, 2]),
        ):
            text += f"{key} = " + " ".join(f"{value:.15e}" for value in values) + "\n"
        text += "cras   = " + " ".join(f"{value:.15e}" for value in middle) + "\n"
    return text + "subject fsaverage\nfscale 0.1\n"


GRIDS = (SHAPES[1], MOVING), (SHAPES[0], FIXED)


@pytest.mark.parametrize("kind", [0, 1])
def test_lta(scans, tmp_path, kind):
    fixed, moving = scans
    numbers = ANSWER if kind == 1 else np.linalg.inv(FIXED) @ ANSWER @ MOVING
    text = lta(numbers, kind, *GRIDS)
    (tmp_path / "a.lta").write_text(text)
    found = ws.open_transform(tmp_path / "a.lta", moving=moving, fixed=fixed)
    np.testing.assert_allclose(found, ANSWER, atol=1e-5)
    # nitransforms returns the map from the fixed scan to the moving one; it reads single precision.
    other = FSLinearTransform.from_string(text.partition("subject")[0]).to_ras()
    np.testing.assert_allclose(np.linalg.inv(other), ANSWER, atol=1e-4)


def test_an_lta_of_the_other_direction_is_undone(scans, tmp_path):
    fixed, moving = scans
    (tmp_path / "a.lta").write_text(lta(np.linalg.inv(ANSWER), 1, *GRIDS[::-1]))
    with pytest.warns(WavesplatWarning, match=r"the LTA is undone: 'moving.nii.gz' has the grid of its dst"):
        found = ws.open_transform(tmp_path / "a.lta", moving=moving, fixed=fixed)
    np.testing.assert_allclose(found, ANSWER, atol=1e-5)


def test_an_lta_of_other_grids_is_a_guess(scans, tmp_path):
    fixed, moving = scans
    (tmp_path / "a.lta").write_text(lta(ANSWER, 1, *[((5, 5, 5), np.eye(4))] * 2))
    with pytest.warns(WavesplatWarning, match="guess: 'moving.nii.gz' is taken for the LTA's src, 'src.mgz'"):
        found = ws.open_transform(tmp_path / "a.lta", moving=moving, fixed=fixed)
    np.testing.assert_allclose(found, ANSWER, atol=1e-9)


@pytest.mark.parametrize("flips", [(False, False), (True, False), (False, True), (True, True)])
def test_flirt(tmp_path, flips):
    matrices = [
        matrix @ np.diag([-1.0 if flip else 1, 1, 1, 1]) for matrix, flip in zip((FIXED, MOVING), flips, strict=True)
    ]
    images = [
        nib.Nifti1Image(np.zeros(shape, np.uint8), matrix) for shape, matrix in zip(SHAPES, matrices, strict=True)
    ]
    ours = [ws.Volume(image) for image in images]
    # nitransforms writes the file, of a map from the fixed scan to the moving one.
    written = nt_linear.Affine(np.linalg.inv(ANSWER), reference=images[0])
    written.to_filename(tmp_path / "a.mat", fmt="fsl", moving=images[1])
    with pytest.warns(WavesplatWarning, match="guess: a .mat of 4 x 4 numbers is taken for FLIRT's"):
        found = ws.open_transform(tmp_path / "a.mat", moving=ours[1], fixed=ours[0])
    np.testing.assert_allclose(found, ANSWER, atol=1e-5)  # the file has eight decimals


def test_the_identity_of_flirt_lays_corners_on_corners(tmp_path, scans):
    """By FSL's documentation: voxel (0, 0, 0) on voxel (0, 0, 0) where both are stored from the patient's right."""
    np.savetxt(tmp_path / "a.mat", np.eye(4))
    left = [
        ws.Volume(np.zeros((4, 5, 6)), world_from_index=np.diag([-2.0, 2, 2, 1]) + np.eye(4, k=3) * shift, unit="mm")
        for shift in (0, 50)
    ]
    with pytest.warns(WavesplatWarning, match="guess"):
        found = ws.open_transform(tmp_path / "a.mat", moving=left[1], fixed=left[0])
    np.testing.assert_allclose(found @ left[1].world_from_index, left[0].world_from_index, atol=1e-12)


def test_linear_transforms_in_a_composite_are_one(scans, tmp_path):
    fixed, moving = scans
    rotation = sitk.Euler3DTransform((0, 0, 0), 0.1, 0.2, 0.3, (1, 2, 3))
    both = sitk.CompositeTransform([rotation, itk()])
    sitk.WriteTransform(both, str(tmp_path / "Composite.h5"))
    found = ws.open_transform(tmp_path / "Composite.h5", moving=moving, fixed=fixed)
    for point in ((0.0, 0, 0), (10, -20, 30), (-7, 8, 9)):
        lps = np.array([*both.TransformPoint(point), 1])
        np.testing.assert_allclose(found @ RAS_FROM_LPS @ lps, RAS_FROM_LPS @ [*point, 1], atol=1e-9)


def test_places_of_data_without_a_patient_are_not_turned(tmp_path):
    volume = ws.Volume(np.zeros((4, 5, 6)))
    sitk.WriteTransform(sitk.TranslationTransform(3, (1.0, 2, 3)), str(tmp_path / "a.tfm"))
    found = ws.open_transform(tmp_path / "a.tfm", moving=volume, fixed=volume)
    np.testing.assert_allclose(found[:3, 3], [-1, -2, -3])


def field(path):
    sitk.WriteTransform(sitk.DisplacementFieldTransform(sitk.Image((4, 4, 4), sitk.sitkVectorFloat64)), path)


def spline(path):
    sitk.WriteTransform(sitk.BSplineTransform(3, 3), path)


def of_text(text):
    return lambda path: Path(path).write_text(text)


FOUR = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"


@pytest.mark.parametrize(
    ("name", "write", "refused"),
    [
        ("a.h5", field, (ArgumentError, "not affine: it moves every place by itself.*antsApplyTransforms")),
        ("a.tfm", spline, (ArgumentError, "not affine")),
        ("warp.nii.gz", of_text(""), (ArgumentError, "not affine.*applywarp")),
        ("a.tfm", lambda path: sitk.WriteTransform(sitk.Euler2DTransform(), path), (ArgumentError, "2 dimensions")),
        ("a.xfm", of_text(""), (ArgumentError, "lta_convert --inmni")),
        ("register.dat", of_text(""), (ArgumentError, "lta_convert --inreg")),
        ("a.txt", of_text(FOUR), (ArgumentError, "do not say which way they map.*c3d_affine_tool")),
        ("a.json", of_text("{}"), (ArgumentError, "unknown kind of transform")),
        ("a.tfm", of_text("nothing"), (FileError, "not a transform that ITK reads")),
        ("a.mat", of_text("1 2 3\n"), (FileError, "not a transform that ITK reads")),
        ("a.mat", of_text(FOUR.replace("1", "0")), (ArgumentError, "last row")),
        ("a.lta", of_text("type = 1\n"), (FileError, "not an LTA with a matrix")),
        ("a.lta", of_text(lta(ANSWER, 14, *GRIDS)), (ArgumentError, "of type 14; write one of type 1: lta_convert")),
        ("a.lta", of_text(lta(ANSWER, 0, *GRIDS, invalid=True)), (ArgumentError, "its volumes are not valid")),
        ("a.lta", of_text(lta(0 * ANSWER, 1, *GRIDS)), (ArgumentError, "last row")),
        ("a.lta", lambda _: None, (FileError, "no such file")),
    ],
)
def test_what_is_refused(scans, tmp_path, name, write, refused):
    error, message = refused
    write(str(tmp_path / name))
    with pytest.raises(error, match=message):
        ws.open_transform(tmp_path / name, moving=scans[1], fixed=scans[0])


def test_lengths_in_other_units_are_refused(scans, tmp_path):
    cells = ws.Volume(np.zeros((4, 5, 6)), unit="um")
    with pytest.raises(ArgumentError, match="transforms are in millimetres, and 'volume' is in um"):
        ws.open_transform(tmp_path / "a.tfm", moving=cells, fixed=scans[0])


# What is moved


def test_moved_volumes_keep_their_samples_and_their_source(tmp_path):
    volume = ws.examples.ct_pelvis()
    moved = volume.moved(ANSWER)
    assert moved.samples is volume.samples or np.shares_memory(moved.samples, volume.samples)
    np.testing.assert_allclose(moved.world_from_index, ANSWER @ volume.world_from_index)
    scene = ws.Scene([volume, moved])
    again = ws.Scene.from_json(scene.to_json())
    np.testing.assert_array_equal(again.layers[1].drawn.world_from_index, moved.world_from_index)
    for wrong, message in ((np.zeros((3, 3)), "shape"), (np.diag([1, 1, 0, 1]), "no inverse"), ("a", "give 4 x 4")):
        with pytest.raises(ArgumentError, match=message):
            volume.moved(wrong)


def test_lazy_volumes_series_and_labels_are_moved_too(tmp_path):
    array = np.random.default_rng(0).integers(0, 200, (12, 14, 16)).astype(np.uint8)
    volume, lazy = ws.Volume(array), ws.Volume.lazy(array, cache=False).moved(ANSWER)
    assert isinstance(lazy, ws.LazyVolume)
    np.testing.assert_allclose(lazy.world_from_index, ANSWER)
    options = {"size": (20, 20), "clim": (0, 200)}
    np.testing.assert_array_equal(ws.slice(lazy, **options).rgba, ws.slice(volume.moved(ANSWER), **options).rgba)
    series = ws.Series([volume, volume], times=[0, 3], time_unit="s").moved(ANSWER)
    np.testing.assert_allclose(series[1].world_from_index, ANSWER)
    assert (series.times, series.time_unit) == ((0, 3), "s")
    labels = ws.Labels(ws.Volume((array > 150).astype(np.uint8), spacing=(1, 1, 2)))
    np.testing.assert_allclose(labels.moved(ANSWER).world_from_index, ANSWER @ np.diag([1, 1, 2, 1]))
    with pytest.raises(ArgumentError, match="has no place"):
        ws.Labels((array > 150).astype(np.uint8)).moved(ANSWER)


def test_labels_moved_back_lie_where_they_were(scans):
    samples = np.zeros(SHAPES[0][::-1], np.uint8)
    samples[5:20, 10:30, 8:20] = 1
    scan = ws.Volume(samples * 100, world_from_index=FIXED, unit="mm", anatomical=True)
    labels = ws.Labels(ws.Volume(samples, world_from_index=np.linalg.inv(ANSWER) @ FIXED, unit="mm", anatomical=True))
    plain = ws.slice(
        ws.Scene(scan, labels=ws.Labels(ws.Volume(samples, world_from_index=FIXED, unit="mm"))), size=(50, 50)
    )
    back = ws.slice(ws.Scene(scan, labels=labels.moved(ANSWER)), size=(50, 50))
    assert np.abs(plain.rgba - back.rgba).max() < 0.02
    apart = ws.slice(ws.Scene(scan, labels=labels), size=(50, 50))
    assert np.abs(plain.rgba - apart.rgba).max() > 0.2


# The command line


@pytest.mark.parametrize(
    ("text", "parsed"),
    [
        ("pet.nii:reg=a.lta", LayerText("pet.nii", transform="a.lta")),
        ("pet.nii:hot:2,8:reg=c:/x/a.mat", LayerText("pet.nii", "hot", (2, 8), transform="c:/x/a.mat")),
        ("pet.nii:coolwarm:-9,9:threshold=3.1", LayerText("pet.nii", "coolwarm", (-9, 9), 3.1)),
        ("pet.nii:threshold=3:reg=a.lta", LayerText("pet.nii", None, None, 3, "a.lta")),
        ("x:reg=y.nii", LayerText("x:reg=y.nii")),
        ("x:reg=y.nii:hot:reg=b.tfm", LayerText("x:reg=y.nii", "hot", transform="b.tfm")),
    ],
)
def test_layers_with_a_transform_are_parsed(tmp_path, monkeypatch, text, parsed):
    monkeypatch.chdir(tmp_path)
    for name in ("pet.nii", "x:reg=y.nii"):
        (tmp_path / name).touch()
    assert layer_of(text) == parsed


def test_what_is_no_transform_or_threshold(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pet.nii").touch()
    with pytest.raises(ArgumentError, match="lacks a file"):
        layers.split_transform("pet.nii:reg=", "--layer")
    with pytest.raises(ArgumentError, match="threshold 'three' of .* is no number"):
        layer_of("pet.nii:threshold=three")


def test_layers_labels_contours_and_isolines_take_a_transform(tmp_path):
    samples = np.zeros(SHAPES[0][::-1], np.int16)
    samples[5:20, 10:30, 8:20] = 1
    scan = ws.Volume(samples, world_from_index=FIXED, unit="mm", anatomical=True)
    apart = np.linalg.inv(ANSWER) @ FIXED
    ws.Volume(samples, world_from_index=apart, unit="mm", anatomical=True).save(tmp_path / "seg.nii.gz")
    sitk.WriteTransform(itk(), str(tmp_path / "a.tfm"))
    text = f"{tmp_path}/seg.nii.gz:reg={tmp_path}/a.tfm"
    (layer,) = further_layers([f"{tmp_path}/seg.nii.gz:hot:0,1:reg={tmp_path}/a.tfm"], scan, time=0, quiet=True)
    (lines,) = opened_isolines([f"{tmp_path}/seg.nii.gz:0.5:reg={tmp_path}/a.tfm"], scan, time=0, quiet=True)
    (contours,) = opened_contours(text, None, None, scan, quiet=True)
    labels = opened_labels(LabelOptions(text), scan, quiet=True)
    for found in (layer.drawn, lines.volume, contours, labels):
        np.testing.assert_allclose(found.world_from_index, FIXED, atol=1e-4)


def test_render_and_slice_draw_registered_layers(wavesplat, tmp_path, is_night):
    """One function opens the layers of both commands: by day slices alone are drawn."""
    from PIL import Image

    scan = ws.examples.mri_head()
    scan.save(tmp_path / "head.nii.gz")
    spot = np.zeros(scan.shape, np.float32)
    n_z, n_y, n_x = scan.shape
    spot[n_z // 2 :, n_y // 3 : 2 * n_y // 3, n_x // 3 : 2 * n_x // 3] = 9
    matrix = np.linalg.inv(ANSWER) @ scan.world_from_index
    for name, place in (("spot", scan.world_from_index), ("apart", matrix)):
        ws.Volume(spot, world_from_index=place, unit="mm", anatomical=True).save(tmp_path / f"{name}.nii.gz")
    sitk.WriteTransform(itk(), str(tmp_path / "a.tfm"))
    layers = {
        "there": f"{tmp_path}/spot.nii.gz:hot:1,9",
        "apart": f"{tmp_path}/apart.nii.gz:hot:1,9",
        "moved": f"{tmp_path}/apart.nii.gz:hot:1,9:reg={tmp_path}/a.tfm",
    }
    for command in ("slice", "render")[: 2 if is_night else 1]:
        pictures = {}
        for name, text in layers.items():
            options = ["--size", "60x60", "-q", "-o", tmp_path / "x.png"]
            done = wavesplat(command, tmp_path / "head.nii.gz", "--layer", text, *options)
            assert done.returncode == 0, done.stderr
            with Image.open(tmp_path / "x.png") as image:
                pictures[name] = np.asarray(image)[..., :3].astype(float)
        off = {name: np.abs(pictures[name] - pictures["there"]).mean() for name in ("apart", "moved")}
        assert off["moved"] < 0.05 * off["apart"]
