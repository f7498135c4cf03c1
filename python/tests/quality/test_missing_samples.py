"""Missing samples (NaN, infinity): the part of a picture that they remove, against closed formulas."""

import math

import numpy as np
import pytest

import wavesplat as ws

KERNELS = ["linear", "catmull-rom", "bspline2", "bspline3", "gaussian"]
#: Size of a view along z, and pixels per sample.
SIZE, PER_SAMPLE = (88, 80), 8
OPACITY = 0.15


def _samples(share=0.05):
    rng = np.random.default_rng(8)
    samples = np.full((9, 11, 12), 3.0, np.float32)
    missing = rng.random(samples.shape) < share
    samples[missing] = rng.choice([np.nan, np.inf, -np.inf], missing.sum())
    return samples


def _camera(samples):
    n_z, n_y, n_x = samples.shape
    middle = ((n_x - 1) / 2, (n_y - 1) / 2, (n_z - 1) / 2)
    # The camera looks along +z, with y down, so that pixel (0, 0) is near sample (0, 0).
    eye = (middle[0], middle[1], -50)
    return ws.Camera(eye, middle, (0, -1, 0), parallel_scale=SIZE[1] / PER_SAMPLE / 2)


def _known_length(samples):
    """Per pixel, the integral along z of the linear kernel's share of known samples."""
    known = np.isfinite(samples).astype(float)
    n_z, n_y, n_x = known.shape
    column = np.tensordot(np.r_[0.5, np.ones(n_z - 2), 0.5], known, 1)
    x = (np.arange(SIZE[0]) + 0.5 - SIZE[0] / 2) / PER_SAMPLE + (n_x - 1) / 2
    y = (np.arange(SIZE[1]) + 0.5 - SIZE[1] / 2) / PER_SAMPLE + (n_y - 1) / 2
    along_x = np.array([np.interp(x, np.arange(n_x), row) for row in column])
    return np.array([np.interp(y, np.arange(n_y), line) for line in along_x.T]).T


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("opacity", [[(0, OPACITY)], [(0, 0), (2.9, 0), (2.95, OPACITY)]], ids=["soft", "hard"])
@pytest.mark.every_pair
def test_extinction_is_multiplied_by_the_share_of_known_samples(kernel, opacity):
    samples = _samples()
    look = ws.TransferFunction(opacity, [(0, 1, 1, 1)], opacity_unit=1.0)
    want = 1 - np.exp(math.log(1 - OPACITY) * _known_length(samples))
    # The outermost pixels are half outside.
    inside = (slice(2, -2), slice(2, -2))
    for quality in ("normal", "high"):
        options = {"size": SIZE, "kernel": kernel, "shading": None}
        got = ws.render(ws.Volume(samples), look, _camera(samples), quality=quality, device="cpu", **options)
        assert np.abs(got.rgba[..., 3] - want)[inside].max() < 0.006
    cast = ws.reference.raycast(ws.Volume(samples), look, _camera(samples), step=0.1, **options)
    assert np.abs(cast.rgba[..., 3] - want)[inside].max() < 0.006


@pytest.mark.parametrize("kernel", KERNELS)
def test_slices_leave_out_points_of_which_half_is_missing(kernel):
    samples = np.full((9, 11, 12), 3.0, np.float32)
    samples[4, 5, 6] = np.nan
    # A pixel is a tenth of a sample, and one lies on the missing sample.
    options = {"size": (41, 41), "zoom": 2.75, "center": (6, 5, 4), "kernel": kernel}
    shown = ws.slice(ws.Volume(samples), "axial", 4.0, **options).value
    y, x = np.argwhere(np.isnan(shown)).T
    # In its slice, a point is missing where the product of both weights is at least a half.
    assert (np.ptp(x), np.ptp(y)) == (10, 10)
    assert np.isnan(shown).sum() / 100 == pytest.approx(2 * (1 - math.log(2)), abs=0.05)


@pytest.mark.parametrize("kernel", ["linear", "catmull-rom", "bspline3"])
def test_beside_a_hole_matter_goes_on_as_it_is(kernel):
    """Known samples are drawn as they are without the hole, and nothing rings into them."""
    rng = np.random.default_rng(3)
    samples = np.full((16, 18, 17), 2.0, np.float32)
    samples[:, :, :9] += rng.random((16, 18, 9), np.float32) / 8
    holed = samples.copy()
    holed[:, :, 9:] = np.nan
    # The values in the hole are far from the known ones.
    samples[:, :, 9:] = samples[:, :, 8:9]
    look = ws.TransferFunction([(0, 0), (2, 0.02), (3, 0.4), (9, 0.9)], [(1, 1, 0, 0), (2.2, 0, 0, 1)])
    options = {"size": (60, 50), "kernel": kernel, "clip": ws.Crop((0, 0, 0), (7.5, 17, 15), space="index")}
    camera = ws.Camera.orbit(ws.Volume(samples), 30, 20)
    whole, cut = (ws.render(ws.Volume(s), look, camera, **options).rgba for s in (samples, holed))
    assert np.abs(whole - cut).max() < 2e-3
