"""A second scan on slices: squares of both in turn, or the difference, also after a registration."""

import numpy as np
import pytest
from PIL import Image

import wavesplat as ws
from wavesplat.errors import ArgumentError

FACTS = ws.Facts(unit="mm", is_anatomical=True)
MATRIX = np.diag([2.0, 2, 3, 1])
RNG = np.random.default_rng(3)
SAMPLES = RNG.integers(-200, 900, (16, 20, 24)).astype(np.int16)


def scan(samples=SAMPLES, matrix=MATRIX, name="a", **facts):
    return ws.Volume(samples, world_from_index=matrix, name=name, facts=ws.Facts(**{**vars(FACTS), **facts}))


A = scan()
B = scan(np.roll(SAMPLES, 3, axis=2) + np.int16(40), name="b")


@pytest.mark.parametrize("size", [(64, 64), (90, 60), (61, 47)])
def test_squares_are_of_either_scan_in_turn(size):
    options = {"size": size, "clim": (-200, 900)}
    a, b = (ws.slice(volume, "axial", 21, **options) for volume in (A, B))
    both = ws.slice(A, "axial", 21, checkerboard=B, tiles=4, **options)
    side = -(-max(size) // 4)
    for row in range(0, size[1], side):
        for column in range(0, size[0], side):
            part = slice(row, row + side), slice(column, column + side)
            wanted = b if (row // side + column // side) % 2 else a
            np.testing.assert_array_equal(both.rgba[part], wanted.rgba[part])
            np.testing.assert_array_equal(both.value[part], wanted.value[part])
    assert both.report["compared"] == {"checkerboard": "b", "tiles": 4, "clim": (-200.0, 900.0)}


def test_the_difference_is_first_less_second_in_float32():
    first, second = scan(np.full((8, 9, 10), 250, np.uint8)), scan(np.full((8, 9, 10), 255, np.uint8), name="b")
    found = ws.slice(first, difference=second)
    assert found.value.dtype == np.float32
    np.testing.assert_array_equal(found.value, -5.0)  # unsigned integers would wrap round
    shown = ws.slice(A, "coronal", 15.5, difference=B, size=(70, 50))
    a, b = (ws.slice(volume, "coronal", 15.5, size=(70, 50)).value for volume in (A, B))
    np.testing.assert_allclose(shown.value, a - b, atol=1e-4)


def test_the_difference_is_red_above_zero_blue_below_and_white_at_zero():
    samples = np.zeros((8, 8, 30), np.float32)
    samples[..., :10], samples[..., 20:] = 50, -50
    scans = scan(samples), scan(np.zeros_like(samples), name="b")
    picture = ws.slice(scans[0], difference=scans[1], clim=(-100, 100), size=(30, 8))
    row = picture.rgba[4, ::-1] if picture.report["right"][0] < 0 else picture.rgba[4]
    assert row[4, 0] > row[4, 2] + 0.2
    assert row[25, 2] > row[25, 0] + 0.2
    assert np.ptp(row[15, :3]) < 0.02
    assert picture.report["clim"] == (-100.0, 100.0)
    (shown,) = picture.report["shown"]
    assert (shown["name"], shown["transfer_function"]["color"][0][0]) == ("a - b", -100.0)
    assert picture.annotated(colorbar=True).size[0] > 30


def test_ends_are_the_same_in_all_slices_and_about_zero():
    sheet = ws.lightbox(A, "axial", [6, 21, 39], difference=B, letters=False)
    single = [ws.slice(A, plane, difference=B).report["clim"] for plane in ("axial", "coronal", "sagittal")]
    assert len({sheet.report["clim"], *single}) == 1
    low, high = single[0]
    assert low == -high
    of_samples = np.abs(A.samples.astype(float) - B.samples)
    assert 0.5 * of_samples.max() < high <= of_samples.max()
    assert ws.slice(A, difference=A).report["clim"] == (-1.0, 1.0)


def test_a_scan_on_another_grid_is_read_at_the_same_places():
    ramp = scan(np.broadcast_to(np.arange(24, dtype=np.float32) * 2, (16, 20, 24)).copy())  # the value is x in mm
    turned = np.array([[0, 0, 1.5, 4], [1.1, 0, 0, 5], [0, 2.5, 0, 6], [0, 0, 0, 1]])
    k = np.arange(20, dtype=np.float32)
    other = scan(np.broadcast_to((1.5 * k + 4)[:, None, None], (20, 14, 30)).copy(), turned, name="b")
    found = ws.slice(ramp, "axial", 21, difference=other, size=(93, 77)).value
    inside = np.isfinite(found)
    assert 0.3 < inside.mean() < 1
    assert np.abs(found[inside]).max() < 1e-3


def test_a_second_scan_that_lies_elsewhere_is_said():
    far = MATRIX.copy()
    far[0, 3] = 500
    for name in ("checkerboard", "difference"):
        picture = ws.slice(A, **{name: scan(matrix=far, name="far")}, clim=(-9, 9))
        assert "no part of 'far' lies in the slice" in picture.report["notes"]


def test_windows_of_the_second_scan():
    ct, other = scan(modality="CT"), scan(SAMPLES + np.int16(100), modality="CT", name="b")
    assert ws.slice(ct, checkerboard=other).report["compared"]["clim"] == ws.slice(ct).report["clim"]
    mr = scan((np.clip(SAMPLES, 0, None) * 3).astype(np.int16), modality="MR", name="mr")
    apart = ws.slice(ct, checkerboard=mr, clim=(-100, 300))
    assert apart.report["clim"] == (-100, 300)
    assert apart.report["compared"]["clim"] == ws.slice(mr).report["clim"]
    assert "no scale in common" in apart.report["notes"][0]
    assert [one["name"] for one in apart.report["shown"]] == ["a", "mr"]
    alike = ws.slice(ct, checkerboard=other, clim=(-100, 300))
    assert alike.report["compared"]["clim"] == (-100, 300)
    assert "notes" not in alike.report


def test_layers_and_lines_lie_over_both():
    over = ws.Layer(scan(np.full_like(SAMPLES, 5), name="c"), ws.TransferFunction([(5, 1)], [(5, 1, 0, 0)]))
    np.testing.assert_array_equal(
        ws.slice([A, over], difference=B).rgba[..., :3], np.broadcast_to((1, 0, 0), (20, 24, 3))
    )
    lines = ws.slice(A, checkerboard=B, isolines=ws.Isolines(A, [300.0]), size=(50, 50))
    assert lines.report["lines"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"checkerboard": B, "difference": B}, "both show a second scan"),
        ({"checkerboard": B, "tiles": 1}, "tiles is 1; give 2 to 1000"),
        ({"checkerboard": B, "tiles": 2.5}, "tiles"),
        ({"checkerboard": "b.nii.gz"}, "name of a file"),
        ({"difference": B, "window": "bone"}, "for Hounsfield units, not for differences"),
        ({"difference": B, "clim": (3, 1)}, "low must be less"),
        ({"difference": scan(value_unit="SUV", name="s"), "what": scan(value_unit="Bq/ml")}, "in Bq/ml, values of 's'"),
        ({"difference": ws.Volume(SAMPLES, unit="um")}, "in um"),
    ],
)
def test_what_cannot_work_is_said(options, message):
    with pytest.raises(ArgumentError, match=message):
        ws.slice(options.pop("what", A), **options)


def test_channels_are_not_compared():
    channels = [ws.Layer(A, ws.Look.channel(A, color)) for color in ("red", "green")]
    with pytest.raises(ArgumentError, match="the scene has 2 channels"):
        ws.slice(ws.Scene(channels), checkerboard=B)


def test_the_command_line_compares_scans_and_registered_ones(wavesplat, tmp_path):
    smooth = scan(ws.examples.ripples(24).samples * 100).smoothed(1)
    shift = np.eye(4)
    shift[:3, 3] = 4, -2, 3
    smooth.save(tmp_path / "a.nii.gz")
    smooth.moved(shift).save(tmp_path / "b.nii.gz")
    # ITK: from the fixed scan to the moving one, LPS.
    (tmp_path / "b_to_a.tfm").write_text(
        "#Insight Transform File V1.0\nTransform: AffineTransform_double_3_3\n"
        "Parameters: 1 0 0 0 1 0 0 0 1 -4 2 3\nFixedParameters: 0 0 0\n"
    )
    spread = {}
    command = ["slice", tmp_path / "a.nii.gz", "--size", "60x60", "--clim", "-50,50", "-q", "-o", tmp_path / "x.png"]
    for name, text in (("apart", tmp_path / "b.nii.gz"), ("moved", f"{tmp_path}/b.nii.gz:reg={tmp_path}/b_to_a.tfm")):
        done = wavesplat(*command, "--difference", text)
        assert done.returncode == 0, done.stderr
        with Image.open(tmp_path / "x.png") as image:
            spread[name] = np.ptp(np.asarray(image)[5:-5, 5:-5, :3].astype(int), axis=(0, 1)).max()
    assert spread["apart"] > 60
    assert spread["moved"] <= 2
    done = wavesplat(*command, "--checkerboard", tmp_path / "b.nii.gz", "--tiles", "4", "--plane", "all")
    assert done.returncode == 0, done.stderr
    for options, message in (
        (["--tiles", "4"], "give them with --checkerboard"),
        (["--checkerboard", tmp_path / "b.nii.gz", "--difference", tmp_path / "b.nii.gz"], "say the same thing twice"),
        (["--difference", tmp_path / "b.nii.gz", "--cmap", "hot"], "--difference has its own colours"),
        (["--difference", tmp_path / "c.nii.gz"], "begins with no file that is there"),
        (["--difference", f"{tmp_path}/b.nii.gz:reg="], "lacks a file"),
    ):
        done = wavesplat(*command, *options)
        assert (done.returncode, message in done.stderr) == (2, True), done.stderr


def test_differences_have_no_percentiles_and_one_zero():
    with pytest.raises(ArgumentError, match="percentiles of a difference are not known"):
        ws.slice(A, difference=B, clim=("1%", "99%"))
    ct = ws.examples.ct_pelvis()
    facts = ws.Facts(unit="mm", is_anatomical=True, modality="CT")
    stored = ws.Volume((ct.samples + 1024).astype(np.uint16), world_from_index=ct.world_from_index, facts=facts)
    with pytest.raises(ArgumentError, match="with 1024, so their difference says nothing"):
        ws.slice(ct, difference=stored)
    both = ws.slice(ct, checkerboard=stored, size=(60, 60), clim=None)
    alone = ws.slice(ct, size=(60, 60))
    np.testing.assert_allclose(both.rgba, alone.rgba, atol=0.02)
