"""Labels: segmentations beside a scan."""

import pickle

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError


@pytest.fixture(scope="module")
def scan():
    return ws.examples.ct_pelvis()


def ball(scan, where, radius):
    """Mask of a ball; `where` and `radius` as fractions of the volume's sides."""
    z, y, x = np.indices(scan.shape, sparse=True)
    distance = sum(((i / n - c) ** 2) for i, n, c in zip((z, y, x), scan.shape, where, strict=True))
    return distance < radius**2


def test_pictures_agree_with_direct_evaluation(scan):
    # Bones tinted, a solid ball in the middle, and one side of the body hidden.
    segmentation = np.where(scan.samples > 150, 1, 0)
    segmentation[:, :, : scan.shape[2] // 3] = 7
    segmentation[ball(scan, (0.5, 0.5, 0.5), 0.15)] = 300
    looks = {
        1: ws.Label("#ffc060", opacity=0, tint=0.7),
        7: ws.Label("black", opacity=0, scan=0),
        300: ws.Label((0.8, 0.1, 0.1), 0.4),
    }
    labels = ws.Labels(segmentation, looks)
    camera = ws.Camera.orbit(scan, 30, 20, zoom=6, fit="view")
    light = {"shading": ws.Shading()}
    sampling = {"step": 0.1, "rays_per_pixel": 9, **light}
    want = ws.reference.raycast(scan, "ct-soft-tissue", camera, labels=labels, size=(20, 20), **sampling)
    settings = {"size": (20, 20), "quality": ws.Sampling(12, 3), **light}
    got = ws.render(scan, "ct-soft-tissue", camera, labels=labels, **settings)
    plain = ws.render(scan, "ct-soft-tissue", camera, **settings)
    assert np.abs(got.rgba - want.rgba).mean() < 1e-3
    assert np.abs(plain.rgba - want.rgba).mean() > 3e-2


def test_hiding_a_label_is_removing_its_samples(scan):
    table = np.zeros(scan.shape, np.uint8)
    table[:, : scan.shape[1] // 2] = 1
    labels = ws.Labels(table, {1: ws.Label("grey", opacity=0, scan=0)}, smooth=False)
    view = {"camera": ws.Camera.view(scan, "left"), "size": (40, 40)}
    hidden = ws.render(scan, "ct-soft-tissue", labels=labels, **view).rgba
    whole = ws.render(scan, "ct-soft-tissue", **view).rgba
    half = scan.shape[1] // 2
    lower, upper = (0, half, 0), (scan.shape[2] - 1, scan.shape[1] - 1, scan.shape[0] - 1)
    cut = ws.render(scan, "ct-soft-tissue", clip=ws.Crop(lower, upper, space="index"), **view).rgba
    # The pictures differ only in the last half sample, which fades out.
    assert np.abs(hidden - cut).mean() < 0.1 * np.abs(whole - cut).mean()


def test_label_numbers_are_never_interpolated():
    # Between labels 1 and 3 lies nothing of label 2, whose look is opaque green.
    segmentation = np.ones((16, 16, 16), np.uint8)
    segmentation[:, :, 8:] = 3
    segmentation[0, 0, 0] = 2
    scan = ws.Volume(np.zeros(segmentation.shape, np.float32) + np.arange(16))
    nothing = ws.TransferFunction([(0, 0)], [(0, 1, 1, 1)], opacity_unit=1.0)
    looks = {1: ws.Label((1, 0, 0), 0.9), 2: ws.Label((0, 1, 0), 1.0), 3: ws.Label((0, 0, 1), 0.9)}
    picture = ws.render(
        scan, nothing, "anterior", labels=ws.Labels(segmentation, looks), shading=None, size=(64, 64)
    ).rgba
    assert picture[20:44, :, 3].max() > 0.99
    assert picture[20:44, :, 1].max() < 1e-3


def test_every_number_gets_a_colour_of_its_own():
    segmentation = np.arange(27, dtype=np.int64).reshape(3, 3, 3) * 1000
    labels = ws.Labels(segmentation)
    assert labels.numbers[:3] == (0, 1000, 2000)
    assert 0 not in labels.labels
    assert len({label.color for label in labels.labels.values()}) == 26


def test_labels_of_floats_and_of_volumes(scan):
    numbers = np.where(scan.samples > 200, 2.0, 0.0)
    segmentation = ws.Volume(numbers, world_from_index=scan.world_from_index)
    labels = ws.Labels(segmentation)
    assert labels.numbers == (0, 2)
    copy = pickle.loads(pickle.dumps(labels))  # noqa: S301
    pictures = [ws.render(scan, labels=each, size=(24, 24)).rgba for each in (labels, copy)]
    assert np.array_equal(*pictures)


def test_what_does_not_fit_is_refused(scan):
    ones = np.ones(scan.shape, np.uint8)
    with pytest.raises(ArgumentError, match="no whole numbers"):
        ws.Labels(ones + 0.5)
    with pytest.raises(ArgumentError, match="no sample of the segmentation is 5"):
        ws.Labels(ones, {5: ws.Label("white")})
    with pytest.raises(ArgumentError, match="nothing says where it lies"):
        ws.render(scan, labels=ws.Labels(ones[1:]))
    with pytest.raises(ArgumentError, match=r'say composite="over" \(--composite over\)'):
        ws.render(scan, labels=ws.Labels(ones), composite=ws.FirstHit(200))
    with pytest.raises(ArgumentError, match=r"give a wavesplat\.Labels"):
        ws.render(scan, labels=ones)
    with pytest.raises(ArgumentError, match="tint is 2"):
        ws.Label("white", tint=2)
    with pytest.raises(ArgumentError, match="no mapping"):
        ws.Labels(ones, [ws.Label("white")])


def test_the_command_line_draws_labels_and_light(tmp_path, scan):
    import nibabel
    from typer.testing import CliRunner

    from wavesplat._cli import app

    def written(samples, name):
        image = nibabel.Nifti1Image(np.transpose(samples, (2, 1, 0)), scan.world_from_index)
        nibabel.save(image, tmp_path / name)
        return str(tmp_path / name)

    source = written(scan.samples, "scan.nii")
    labels = written((scan.samples > 200).astype(np.uint8), "labels.nii")
    plain, shown, failed = (tmp_path / name for name in ("plain.png", "shown.png", "failed.png"))

    def run(*arguments):
        return CliRunner().invoke(app, ["render", source, *map(str, arguments), "--size", "40x40"])

    assert run("-o", plain).exit_code == 0
    result = run("-o", shown, "--labels", labels, "--occlusion", 0.8, "--shadow", 0.5)
    assert result.exit_code == 0, result.output
    assert plain.read_bytes() != shown.read_bytes()
    assert run("-o", failed, "--shadow", 0.5, "--no-shading").exit_code != 0
    assert not failed.exists()


@pytest.mark.parametrize("scan_opacity", [0.3, 0.99, 1.0])
@pytest.mark.parametrize("layers", [1, 2])
@pytest.mark.every_pair
def test_scan_and_matter_mix_by_extinction(scan_opacity, layers):
    """In a uniform mixture, the colour is the mean weighted by extinction, however opaque scan and label are."""
    scan = ws.Volume(np.full((12, 12, 12), 5.0, np.float32))
    red = ws.TransferFunction([(0, scan_opacity)], [(0, 1, 0, 0)], opacity_unit=1.0)
    looks = {1: ws.Label((0, 1, 0), 0.9, scan=1.0)}
    labels = ws.Labels(np.ones(scan.shape, np.uint8), looks)
    clear = ws.Layer(scan, ws.TransferFunction([(0, 0)], [(0, 1, 1, 1)]))
    scene = ws.Scene([ws.Layer(scan, red), clear][:layers], labels=labels, shading=None)
    picture = ws.render(scene, camera="anterior", size=(24, 24), device="cpu").rgba[12, 12]
    with np.errstate(divide="ignore"):
        depths = -np.log1p(-np.array([scan_opacity, 0.9]))
    share = 0.0 if scan_opacity == 1 else depths[1] / depths.sum()
    np.testing.assert_allclose(picture, [1 - share, share, 0, 1], atol=2e-3)


@pytest.mark.parametrize("composite", ["maximum", "mean", ws.XRay()])
@pytest.mark.parametrize("n_layers", [1, 2])
def test_labels_lie_over_a_projection_fault_7(scan, composite, n_layers):
    segmentation = np.where(ball(scan, (0.5, 0.5, 0.5), 0.2), 1, 0).astype(np.uint8)
    labels = ws.Labels(segmentation, {1: ws.Label((0, 0, 1), 1.0, name="ball")})
    layers = [ws.Layer(scan), ws.Layer(scan.smoothed(2))][:n_layers]
    view = {"camera": ws.Camera.view(scan, "front"), "size": (40, 40), "composite": composite}
    plain = ws.render(ws.Scene(layers, background="black"), **view)
    picture = ws.render(ws.Scene(layers, labels=labels, background="black"), **view)
    rows, columns = np.indices((40, 40)) - 19.5
    far = np.hypot(rows, columns) > 14
    assert np.array_equal(picture.rgba[far], plain.rgba[far])
    bluer = (picture.rgba - plain.rgba)[..., 2] - (picture.rgba - plain.rgba)[..., 0]
    assert (bluer[16:24, 16:24] > 0.2).all()
    # The projection shows through.
    assert np.corrcoef(picture.rgba[16:24, 16:24, 0].ravel(), plain.rgba[16:24, 16:24, 0].ravel())[0, 1] > 0.7
    assert [one["name"] for one in picture.report["labels"]] == ["ball"]
    assert "labels laid over the projection, which has no depth" in picture.report["notes"]


def test_a_pet_scan_takes_labels_without_an_operator_fault_7(tmp_path, wavesplat):
    rng = np.random.default_rng(3)
    samples = rng.gamma(1.0, 0.2, (30, 28, 26)).astype(np.float32)
    mask = np.zeros(samples.shape, np.uint8)
    mask[10:16, 10:16, 10:16] = 1
    samples[mask > 0] += 40
    facts = ws.Facts(modality="PT")
    pet = ws.Volume(samples, spacing=(4, 4, 4), unit="mm", anatomical=True, facts=facts)
    assert ws.Look.auto(pet).composite == "maximum"
    place = {"world_from_index": pet.world_from_index, "unit": "mm", "anatomical": True}
    picture = ws.render(pet, labels=ws.Labels(ws.Volume(mask, **place), {1: ws.Label("red", name="tumour")}))
    assert (picture.rgba[..., 0] - picture.rgba[..., 1]).max() > 0.2
    pet.save(tmp_path / "pet.nii.gz")
    ws.Volume(mask, **place).save(tmp_path / "mask.nii.gz")
    arguments = ["--labels", tmp_path / "mask.nii.gz", "--size", "40x40", "-o", tmp_path / "x.png"]
    done = wavesplat("render", tmp_path / "pet.nii.gz", "--preset", "pet", *arguments)
    assert done.returncode == 0, done.stderr
    assert "note: labels laid over the projection" in done.stderr
