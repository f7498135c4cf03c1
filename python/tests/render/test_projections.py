"""Projections against NumPy: along an axis, with sheets on the slices and pixels on the samples."""

from __future__ import annotations

from itertools import pairwise
from typing import get_args

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks.kinds.histogram import HOUNSFIELD_ATTENUATION
from wavesplat._model.arguments.sampling import Composite
from wavesplat.errors import ArgumentError

PROJECTIONS = [name for name in get_args(Composite) if name not in ("over", "first-hit")]
GREY = ws.TransferFunction([(0, 1)], [(0, 0, 0, 0), (1, 1, 1, 1)])

#: Projections of which the defaults look otherwise.
OWN_GREYS = ("minimum", "depth-colored-maximum", "attenuated-maximum")

#: Size of a pixel; samples lie 2, 1 and 4 pixels apart along x, y and z, as texel positions are exact for powers of 2.
PIXEL = 0.35
SPACING = (0.7, 0.35, 1.4)

#: Directions to the eye, and up.
VIEWS = [
    ((0, 0, 1), (0, 1, 0)),
    ((0, 0, -1), (1, 0, 0)),
    ((0, 1, 0), (0, 0, -1)),
    ((0, -1, 0), (0, 0, 1)),
    ((1, 0, 0), (0, 0, 1)),
    ((-1, 0, 0), (0, -1, 0)),
]


def noise(dtype, shape=(5, 7, 9)):
    """Samples over much of the type's range, negative ones included."""
    rng = np.random.default_rng(5)
    if dtype is np.float32:
        # Magnitudes from 1e-6 to 1e6: small ones must not drown in rounding.
        return (rng.choice([-1, 1], shape) * 10 ** rng.uniform(-6, 6, shape)).astype(dtype)
    limits = np.iinfo(dtype)
    return rng.integers(limits.min, limits.max, shape, endpoint=True).astype(dtype)


def rays(volume, eye, up):
    """Samples on each pixel's ray, from the eye on [row, column, k]; which pixels lie on samples; camera, size."""
    eye, up = np.array(eye, float), np.array(up, float)
    right = np.cross(up, eye)
    first, last = volume.bounds
    extent = last - first
    width, height = (round(float(extent @ np.abs(axis)) / PIXEL) + 1 for axis in (right, up))
    middle = (first + last) / 2
    camera = ws.Camera(middle + 50 * eye, middle, up, parallel_scale=height * PIXEL / 2)
    rows, columns = np.mgrid[:height, :width]
    across = (columns - (width - 1) / 2)[..., None] * PIXEL * right
    down = (rows - (height - 1) / 2)[..., None] * PIXEL * up
    world = middle + across - down
    index = (world - volume.world_from_index[:3, 3]) @ np.linalg.inv(volume.world_from_index[:3, :3]).T
    axis = int(np.argmax(np.abs(volume.world_from_index[:3, :3].T @ eye)))
    towards_eye = float((volume.world_from_index[:3, :3].T @ eye)[axis])
    others = [a for a in range(3) if a != axis]
    nearest = np.rint(index).astype(int)
    on_sample = np.all(np.abs(index - nearest)[..., others] < 1e-9, axis=-1)
    samples = np.moveaxis(volume.samples.transpose(), axis, -1)
    if towards_eye > 0:
        samples = samples[..., ::-1]
    along = samples[tuple(nearest[..., others].transpose(2, 0, 1))]
    assert on_sample.sum() == samples[..., 0].size
    return along, on_sample, camera, (width, height)


def project(volume, composite, eye, up, **options):
    """Projected values, and the samples of their rays, of the pixels that lie on samples."""
    along, on_sample, camera, size = rays(volume, eye, up)
    picture = ws.render(volume, GREY, camera, size=size, composite=composite, quality=ws.Sampling(1, 1), **options)
    return picture.value[on_sample], along[on_sample]


def volumes(dtype):
    """Volumes along the world's axes, and with axes swapped and turned."""
    turned = np.array([[0, 0, 1.4, 17], [-0.7, 0, 0, -300.1], [0, 0.35, 0, 1234.5], [0, 0, 0, 1]])
    return [
        ws.Volume(noise(dtype), spacing=SPACING),
        ws.Volume(noise(dtype), world_from_index=turned),
        ws.Volume(noise(dtype, (33, 40, 38)), spacing=(PIXEL,) * 3),
    ]


@pytest.mark.parametrize(("eye", "up"), VIEWS)
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint16, np.float32])
@pytest.mark.parametrize(("composite", "reduce"), [("maximum", np.max), ("minimum", np.min)])
def test_extremes_are_those_of_the_samples_exactly(composite, reduce, dtype, eye, up):
    for volume in volumes(dtype):
        got, along = project(volume, composite, eye, up)
        assert np.array_equal(got, reduce(along, axis=-1))


@pytest.mark.parametrize(("eye", "up"), VIEWS)
def test_the_maximum_is_that_of_numpy_for_a_cube_that_fills_the_picture(eye, up):
    """The picture has one pixel a sample, as a user asks for it. High quality has thirds, which are rounded."""
    samples = noise(np.int16, (12, 12, 12))
    volume = ws.Volume(samples, spacing=(0.7, 0.7, 0.7))
    axis = 2 - int(np.argmax(np.abs(eye)))
    camera = ws.Camera(8 * np.array(eye) + 3.85, (3.85,) * 3, up, parallel_scale=12 * 0.7 / 2)
    want = np.sort(samples.max(axis), axis=None)
    for quality, limit in (("normal", 0), ("high", 1e-6 * 2**16)):
        value = ws.render(volume, GREY, camera, size=(12, 12), composite="maximum", quality=quality).value
        np.testing.assert_allclose(np.sort(value, axis=None), want, rtol=0, atol=limit, err_msg=quality)


@pytest.mark.parametrize("offset", [0.0, 1e4, -1e7])
def test_extremes_of_floats_far_from_zero_are_exact_too(offset):
    samples = (offset + np.random.default_rng(2).uniform(-3, 5, (5, 7, 9))).astype(np.float32)
    for composite, reduce in (("maximum", np.max), ("minimum", np.min)):
        got, along = project(ws.Volume(samples, spacing=SPACING), composite, *VIEWS[0])
        assert np.array_equal(got, reduce(along, axis=-1))


def trapezoid(along):
    """Integral of the linear interpolation of samples that lie 1 apart."""
    return along.sum(axis=-1) - (along[..., 0] + along[..., -1]) / 2


@pytest.mark.parametrize(("eye", "up"), VIEWS)
@pytest.mark.parametrize("dtype", [np.uint8, np.int16])
def test_sums_and_means_are_those_of_numpy(dtype, eye, up):
    for volume in volumes(dtype)[:2]:
        step = 50 * np.array(eye) @ np.linalg.inv(volume.world_from_index[:3, :3]).T
        spacing = 50 / np.abs(step).max()
        largest = np.abs(volume.value_range).max()
        got, along = project(volume, "sum", eye, up)
        want = trapezoid(along.astype(float))
        n = along.shape[-1] - 1
        np.testing.assert_allclose(got, want * spacing, rtol=0, atol=1e-6 * n * spacing * largest)
        got, _ = project(volume, "mean", eye, up)
        np.testing.assert_allclose(got, want / n, rtol=0, atol=1e-6 * largest)


@pytest.mark.parametrize("quality", ["normal", "fine", "high"])
@pytest.mark.parametrize("composite", ["sum", "mean"])
def test_named_qualities_keep_sums_and_means_of_numpy(composite, quality):
    """With the automatic look of white noise, by which texels were 1.2 or 1.5 a pixel and sums 10 to 27 % off."""
    samples = np.random.default_rng(6).random((6, 6, 6)).astype("f4")
    volume = ws.Volume(samples, spacing=(1, 1, 1))
    camera = ws.Camera((2.5, 2.5, 100), (2.5, 2.5, 2.5), (0, 1, 0), parallel_scale=3)
    got = ws.render(volume, None, camera, size=(6, 6), composite=composite, quality=quality).value
    want = trapezoid(np.moveaxis(samples.astype(float), 0, -1)) / (1 if composite == "sum" else 5)
    np.testing.assert_allclose(np.sort(got, axis=None), np.sort(want, axis=None), rtol=1e-6)


def first_local_maximum(profile, threshold):
    """The first sample of at least the threshold that the next one is below; the largest where there is none."""
    for here, following in pairwise(profile):
        if here >= threshold and following < here:
            return here
    return profile.max()


@pytest.mark.parametrize(("eye", "up"), VIEWS)
@pytest.mark.parametrize(
    ("dtype", "threshold"), [(np.uint8, 100), (np.int16, 20_000), (np.float32, 0.5), (np.float32, -10.0)]
)
def test_local_maxima_are_the_first_along_the_ray_exactly(dtype, threshold, eye, up):
    for volume in volumes(dtype):
        got, along = project(volume, ws.LocalMaximum(threshold), eye, up)
        want = np.array([first_local_maximum(profile, threshold) for profile in along])
        assert np.array_equal(got, want)
        assert (want != along.max(axis=-1)).any()
        assert (want == along.max(axis=-1)).any()


def test_a_local_maximum_shows_what_is_near_and_dim_before_what_is_far_and_bright():
    """Two balls on one line of sight."""
    z, y, x = np.mgrid[:24, :24, :48]
    near = np.hypot(np.hypot(x - 12, y - 12), z - 12) < 6
    far = np.hypot(np.hypot(x - 36, y - 12), z - 12) < 10
    samples = np.where(near, 120, np.where(far, 250, 10)).astype(np.uint8)
    volume = ws.Volume(samples)
    options = {"size": (47, 47), "look": ws.TransferFunction.auto(volume, "maximum")}

    def middle(composite, side):
        eye = ws.Camera((side * 500 + 23.5, 11.5, 11.5), (23.5, 11.5, 11.5), (0, 0, 1), parallel_scale=12)
        return ws.render(volume, camera=eye, composite=composite, **options).value[23, 23]

    assert [middle("maximum", side) for side in (-1, 1)] == [250, 250]
    assert [middle(ws.LocalMaximum(60), side) for side in (-1, 1)] == [120, 250]
    # With a threshold above the near ball, the far one is the first.
    assert [middle(ws.LocalMaximum(130), side) for side in (-1, 1)] == [250, 250]
    # With a threshold above both, the largest is taken.
    assert [middle(ws.LocalMaximum(251), side) for side in (-1, 1)] == [250, 250]
    # If both are equally bright, depth shading shows which one is near.
    shaded = [middle(ws.DepthShadedMaximum(0.5), side) for side in (-1, 1)]
    assert shaded[0] < shaded[1] < 250


@pytest.mark.parametrize(("eye", "up"), VIEWS)
@pytest.mark.parametrize("strength", [0.0, 0.4, 1.0])
def test_depth_shading_is_a_factor_that_falls_along_the_view(strength, eye, up):
    volume = volumes(np.int16)[0]
    black = -9000.0
    curves = ws.TransferFunction([(0, 1)], [(black, 0, 0, 0), (30_000, 1, 1, 1)])
    along, on_sample, camera, size = rays(volume, eye, up)
    picture = ws.render(
        volume,
        curves,
        camera,
        size=size,
        composite=ws.DepthShadedMaximum(strength),
        quality=ws.Sampling(1, 1),
    )
    values = along[on_sample].astype(float)
    factor = 1 - strength * np.linspace(0, 1, values.shape[-1])
    shaded = np.where(values > black, black + (values - black) * factor, values).max(axis=-1)
    np.testing.assert_allclose(picture.value[on_sample], shaded, rtol=0, atol=0.01)
    assert picture.report["depth_shading"] == (strength, black)


def test_depth_shading_is_by_what_is_drawn():
    """The nearest point of a crop box is not dimmed, and its farthest one by the whole strength."""
    volume = ws.Volume(np.full((20, 20, 20), 100, np.uint8))
    camera = ws.Camera((9.5, 200, 9.5), (9.5, 0, 9.5), (0, 0, 1), parallel_scale=10)
    draw = {"size": (11, 11), "composite": ws.DepthShadedMaximum(0.5)}
    for upper in (19, 8):
        crop = ws.Crop((0, 0, 0), (19, upper, 19), space="index")
        value = ws.render(volume, GREY, camera, clip=crop, **draw).value
        assert value[5, 5] == pytest.approx(100, abs=1e-3)
    # Where the near half of a box is empty, the rest begins at half of the depth.
    samples = np.zeros((21, 21, 21), np.uint8)
    samples[:, :11] = 100
    camera = ws.Camera((10, 200, 10), (10, 0, 10), (0, 0, 1), parallel_scale=10)
    assert ws.render(ws.Volume(samples), GREY, camera, **draw).value[5, 5] == pytest.approx(75, abs=1e-3)


@pytest.mark.parametrize(("eye", "up"), VIEWS)
def test_an_x_ray_is_the_light_that_comes_through(eye, up):
    volume = volumes(np.uint8)[0]
    step = np.abs(np.array(eye) @ np.linalg.inv(volume.world_from_index[:3, :3]).T).max()
    # No sample is below the clear value, so the absorption is a sum.
    got, along = project(volume, ws.XRay(-20.0, 1e-3), eye, up)
    want = np.exp(-1e-3 * trapezoid(along + 20.0) / step)
    np.testing.assert_allclose(got, want, rtol=1e-5)
    # Values below it absorb nothing, also between two samples.
    got, along = project(volume, ws.XRay(150.0, 4e-3), eye, up)
    fine = np.linspace(0, along.shape[-1] - 1, 2000 * (along.shape[-1] - 1) + 1)
    above = [np.maximum(np.interp(fine, np.arange(len(ray)), ray) - 150, 0) for ray in along.astype(float)]
    want = np.exp(-4e-3 * trapezoid(np.array(above)) / 2000 / step)
    np.testing.assert_allclose(got, want, rtol=1e-4)


def test_water_absorbs_as_the_tables_say():
    """10 cm of water absorb 0.2059 per cm at 60 keV, the air around it nothing."""
    samples = np.full((51, 51, 51), -1000, np.int16)
    samples[:, :, :25] = 0
    volume = ws.Volume(samples, spacing=(2, 2, 2))
    camera = ws.Camera((24, 500, 50), (24, 50, 50), (0, 0, 1), parallel_scale=10)
    picture = ws.render(volume, camera=camera, size=(9, 9), composite="x-ray")
    assert picture.report["attenuation"] == HOUNSFIELD_ATTENUATION
    assert picture.value[4, 4] == pytest.approx(np.exp(-0.2059 * 10), rel=1e-4)
    beside = ws.Camera((80, 500, 50), (80, 50, 50), (0, 0, 1), parallel_scale=10)
    assert ws.render(volume, camera=beside, size=(9, 9), composite="x-ray").value[4, 4] == 1


def test_values_without_a_scale_get_one_for_x_rays():
    mri = ws.render(ws.examples.mri_head(), size=(48, 48), composite="x-ray")
    _, per_unit = mri.report["attenuation"]
    assert per_unit != HOUNSFIELD_ATTENUATION[1]
    assert 1e-4 < np.nanmin(mri.value) < 0.05
    assert np.nanmax(mri.value) <= 1


@pytest.mark.parametrize("scan", [ws.examples.ct_pelvis, ws.examples.mri_head])
@pytest.mark.parametrize("composite", [name for name in PROJECTIONS if name not in OWN_GREYS])
def test_the_picture_of_defaults_uses_the_greys_and_leaves_out_what_is_empty(scan, composite):
    """Minima are for crop boxes: rays that leave the patient have the value of the air.

    `test_maxima_in_depth` has the brightness of the other two.
    """
    picture = ws.render(scan(), size=(96, 96), composite=composite)
    drawn = picture.rgba[..., 3] > 0.9
    grey = picture.rgba[..., 1][drawn]
    assert 0.2 < drawn.mean() < 0.95, "the patient, without the box"
    black, middle, white = np.percentile(grey, (1, 50, 99))
    assert black < 0.4
    assert middle < 0.75
    assert white > 0.6


def test_bones_are_bright_on_a_radiograph():
    picture = ws.render(ws.examples.ct_pelvis(), size=(96, 96), composite="x-ray")
    order = np.argsort(picture.value[picture.rgba[..., 3] == 1])
    grey = picture.rgba[..., 0][picture.rgba[..., 3] == 1]
    assert np.all(np.diff(grey[order]) <= 1e-6), "the less comes through, the brighter"
    assert np.nanmax(picture.value) <= 1


def test_the_numbers_of_an_operator_follow_the_colours_and_are_reported():
    volume = ws.examples.ripples(16)
    window = ws.TransferFunction([(0, 1)], [(40, 0, 0, 0), (140, 1, 1, 1)])
    draw = {"look": window, "size": (16, 16)}
    assert ws.render(volume, composite="local-maximum", **draw).report["local_threshold"] == 65
    assert ws.render(volume, composite="depth-shaded-maximum", **draw).report["depth_shading"] == (0.6, 40)
    assert "local_threshold" not in ws.render(volume, composite="maximum", **draw).report


def test_python_and_the_renderer_know_the_same_operators():
    with pytest.raises(ArgumentError) as refused:
        ws.render(ws.examples.ripples(8), composite="add", size=(8, 8))
    assert str(refused.value).endswith("use one of: " + ", ".join(get_args(Composite)))


@pytest.mark.parametrize(
    ("operator", "numbers", "message"),
    [
        (ws.FirstHit, (float("nan"),), "iso_value of FirstHit is nan; give a finite number"),
        (ws.FirstHit, ("high",), "iso_value of FirstHit is 'high'; give a finite number"),
        (ws.LocalMaximum, (float("nan"),), "threshold.*finite"),
        (ws.DepthShadedMaximum, (1.5,), "strength.*between 0 and 1"),
        (ws.XRay, ("a",), "clear of XRay is 'a'; give a finite number"),
        (ws.XRay, (0, -1), "attenuation.*positive number"),
        (ws.XRay, (float("inf"), 1), "clear.*finite"),
    ],
)
def test_numbers_that_cannot_work_are_refused(operator, numbers, message):
    with pytest.raises(ArgumentError, match=message):
        operator(*numbers)


def test_an_operator_is_a_name_or_an_object():
    draw = {"size": (8, 8), "look": GREY}
    volume = ws.examples.ripples(8)
    for name, operator in (("x-ray", ws.XRay()), ("mip", "maximum"), ("local-maximum", ws.LocalMaximum())):
        np.testing.assert_array_equal(
            ws.render(volume, composite=name, **draw).rgba, ws.render(volume, composite=operator, **draw).rgba
        )
    for wrong, message in (
        ("first-hit", "give composite=wavesplat.FirstHit.iso_value."),
        (ws.XRay, "is the class XRay"),
    ):
        with pytest.raises(ArgumentError, match=message):
            ws.render(volume, composite=wrong, **draw)


@pytest.mark.parametrize("composite", PROJECTIONS)
def test_coefficients_project_as_their_samples_do(composite):
    """With a level left out they still do, nearly."""
    volume = ws.examples.ripples(33)
    wavelets = ws.WaveletVolume.from_volume(volume, "cdf53")
    numbers = {"x-ray": ws.XRay(0.0, 1e-3), "local-maximum": ws.LocalMaximum(150.0)}
    draw = {"size": (24, 24), "composite": numbers.get(composite, composite)}
    camera = ws.Camera.orbit(volume, 30, 20, fit="view")
    want = ws.render(volume, GREY, camera, **draw).value
    got = ws.render(wavelets, GREY, camera, **draw).value
    np.testing.assert_allclose(got, want, rtol=1e-4, atol=1e-2)
    picture = ws.render(wavelets.level(1), camera=camera, **draw)
    assert np.isfinite(picture.value).any()
    assert picture.rgba.max() > 0.3


def test_greys_are_those_of_the_view():
    """A plate is thick from its side: a mean is the same from everywhere, a sum and what it is shown with are not."""
    samples = np.zeros((40, 40, 40), np.uint8)
    samples[16:24, 4:36, 4:36] = 100
    volume = ws.Volume(samples)
    for view, length in (("superior", 8), ("left", 32)):
        picture = ws.render(volume, camera=view, size=(60, 60), composite="sum")
        assert picture.value[30, 30] == pytest.approx(100 * length, rel=0.01)
        assert picture.rgba[30, 30] == pytest.approx([1, 1, 1, 1], abs=0.05)


def test_what_is_even_can_be_projected_without_a_transfer_function():
    volume = ws.Volume(np.full((8, 8, 8), 7, np.uint8))
    picture = ws.render(volume, size=(9, 9), composite="mean")
    assert np.nanmax(np.abs(picture.value - 7)) < 1e-5


def test_functions_of_two_dimensions_give_numbers_too():
    rgba = np.ones((2, 2, 4))
    rgba[:, 0, :3] = 0
    curves = ws.TransferFunction2D([40, 140], [0, 10], rgba)
    picture = ws.render(ws.examples.ripples(16), curves, size=(16, 16), composite="local-maximum")
    assert picture.report["local_threshold"] == 65


def test_holes_are_left_out():
    samples = noise(np.float32)
    samples[2, 3, 4] = np.inf
    volume = ws.Volume(samples, spacing=SPACING)
    for composite in PROJECTIONS:
        got, along = project(volume, composite, *VIEWS[0])
        hole = ~np.isfinite(along).all(axis=-1)
        assert hole.sum() == 1
        if composite == "maximum":
            # The two pieces that end at the hole are left out, the samples at their other ends are not.
            assert got[hole] == along[hole][np.isfinite(along[hole])].max()
        assert np.isfinite(got).all(), composite


@pytest.mark.parametrize("offset", [0, 1024])
def test_the_black_of_a_ct_is_soft_tissue(offset):
    scan = ws.examples.ct_pelvis()

    def stored(samples):
        values = np.maximum(samples.astype(np.int32) + offset, 0 if offset else -1024).astype(np.int16)
        return ws.Volume(values, world_from_index=scan.world_from_index, unit="mm", anatomical=True)

    ct = stored(scan.samples)
    look = ws.Look.auto(ct, "maximum")
    (black, *_), (white, *_) = look.transfer_function.color
    assert -100 + offset <= black < 200 + offset
    assert white > black + 500
    body = np.asarray(ws.render(ct, look, size=(64, 64), background="black"))[..., 0] / 255
    assert 0.1 < np.median(body[10:54, 14:20]) < 0.25  # muscle alone; with black at air 0.47
    assert body.max() > 0.9
    # Where there is hardly anything above it, black is that of other scans.
    air = stored(np.where(scan.samples > -300, -950, scan.samples))
    assert ws.Look.auto(air, "maximum").transfer_function.color[0][0] < offset - 500
