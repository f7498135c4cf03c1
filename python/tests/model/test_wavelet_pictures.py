"""Pictures straight from coefficients: bit for bit those of the samples; and of levels, in the same place."""

from __future__ import annotations

import threading
from itertools import pairwise

import numpy as np
import pytest
from cases_of_the_day import nightly

import wavesplat as ws

FAMILIES = ["haar", "cdf53", "cdf97", "spline4", "bspline2", "bspline3", "bspline4"]
#: By day one lifted family without overlap, one with it, and one of splines: the others share their code.
FEW_FAMILIES = [
    "haar",
    "cdf97",
    "bspline3",
    *nightly(*(family for family in FAMILIES if family not in ("haar", "cdf97", "bspline3"))),
]

#: Bytes of two blocks of 32 x 32 x 32 float32, for each of the two levels or bands that are kept.
TINY_CACHE = 2 * 2 * 32**3 * 4


@pytest.fixture(scope="module")
def textured() -> ws.Volume:
    """A volume with more than a block along each axis, odd and even sizes, different spacings, sheared in the world."""
    z, y, x = np.indices((37, 66, 45))
    noise = np.random.default_rng(0).normal(0, 8, z.shape)
    samples = 100 * np.sin(x / 5) * np.cos(y / 7) + 60 * np.sin(z / 4 + x / 9) + noise
    world_from_index = np.diag([1.0, 0.8, 1.3, 1.0])
    world_from_index[:3, 3] = (-7.0, 5.0, 100.0)
    world_from_index[0, 1] = 0.2
    return ws.Volume(samples.astype(np.float32), world_from_index=world_from_index)


@pytest.fixture(scope="module")
def scans() -> dict[str, ws.Volume]:
    return {"ct": ws.examples.ct_pelvis(), "mri": ws.examples.mri_head()}


#: Transfer function of fog, from a thin veil to nearly opaque, without a step.
SOFT = ws.TransferFunction([(-50, 0.0), (0, 0.05), (80, 0.3), (120, 0.9)], [(-50, 0.1, 0.3, 1.0), (120, 1.0, 0.5, 0.0)])


def difference(a: np.ndarray, b: np.ndarray) -> float:
    """Largest difference of two pictures; pixels must be missing in both or in neither."""
    missing = np.isnan(a)
    assert np.array_equal(missing, np.isnan(b))
    return float(np.abs(np.where(missing, 0, a) - np.where(missing, 0, b)).max())


def check_same(wavelets: ws.WaveletVolume, samples: ws.Volume, limit: float = 0.0, **draw) -> None:
    """Check that coefficients and samples show something, and the same."""
    draw = {"look": SOFT, "size": (40, 36), **draw}
    want, got = ws.study.render(samples, **draw), ws.study.render(wavelets, **draw)
    assert want.rgba[..., 3].max() > 0.2
    assert difference(got.rgba, want.rgba) <= limit
    for name in ("depth", "value"):
        if getattr(want, name) is not None:
            assert difference(getattr(got, name), getattr(want, name)) <= limit * 100


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("threshold", [0, 12])
def test_the_picture_is_that_of_the_samples(textured, family, threshold):
    """The same bits, whatever is kept; splines are prefiltered by block, with margins that cut off less than 1e-7."""
    wavelets = ws.WaveletVolume.from_volume(textured, family, threshold=threshold)
    assert (wavelets.kept_fraction < 0.6) == (threshold > 0)
    samples = wavelets.to_volume()
    for cache_bytes in (TINY_CACHE, 1 << 29):
        wavelets.cache_bytes = cache_bytes
        for kernel, limit in [("linear", 0.0), ("catmull-rom", 0.0), ("bspline3", 1e-4)]:
            # Views along z and x: slices as they lie in memory, and transposed.
            for azimuth, elevation in [(10, 80), (75, 10)]:
                camera = ws.Camera.orbit(textured, azimuth, elevation, fit="view")
                check_same(wavelets, samples, limit, camera=camera, kernel=kernel)


@pytest.mark.parametrize("cache_bytes", [0, TINY_CACHE])
@pytest.mark.parametrize(
    "draw",
    [
        {"depth": True},
        {"pre_integration": False, "early_ray_termination": False},
        {"quality": "high"},
        {"quality": "draft"},
        {"quality": ws.Sampling(0.05)},
        {"shading": None},
        {"shading": ws.Shading(gradient_offset=4.0)},
        {"threads": 1},
        {"psnr": 30},
        {"clip": ws.Crop((10.2, 3.5, 4.1), (40.0, 60.5, 30.9), space="index")},
        {"clip": ws.Crop((-2.0, 10.0, 110.0), (30.0, 50.0, 140.5))},
        {"clip": ws.ClipPlane((10, 20, 110), (1, 0.5, -0.3))},
        {"composite": "maximum"},
        {"composite": "minimum"},
        {"composite": "mean"},
        {"composite": "sum"},
        {"composite": ws.FirstHit(20.0), "depth": True},
        {"background": "white"},
    ],
    ids="-".join,
)
def test_every_way_of_drawing_is_that_of_the_samples(textured, draw, cache_bytes):
    wavelets = ws.WaveletVolume.from_volume(textured, "cdf97", threshold=12)
    wavelets.cache_bytes = cache_bytes
    samples = wavelets.to_volume()
    sharp = ws.TransferFunction([(-1e3, 0.0), (-1e3 + 1, 0.9)], [(-100, 0.0, 0.0, 1.0), (100, 1.0, 1.0, 0.0)])
    if draw.get("composite", "over") != "over":
        draw = {**draw, "look": sharp}
    for view_angle in (None, 40):
        check_same(
            wavelets, samples, camera=ws.Camera.orbit(textured, 40, 35, view_angle=view_angle, fit="view"), **draw
        )


@pytest.mark.parametrize("shape", [(2, 2, 2), (2, 3, 40), (33, 2, 5)])
@pytest.mark.parametrize("family", FEW_FAMILIES)
def test_thin_volumes_are_drawn(shape, family):
    """Volumes smaller than a block, and with axes that are fully decomposed before the others."""
    samples = np.random.default_rng(1).uniform(0, 100, shape).astype(np.float32)
    wavelets = ws.WaveletVolume.from_volume(ws.Volume(samples), family)
    camera = ws.Camera.orbit(wavelets, 30, 40, fit="view")
    check_same(wavelets, wavelets.to_volume(), camera=camera, shading=None)
    for left_out in range(wavelets.n_levels + 1):
        # The texels of a coarse level would be larger than the volume. Smoothed noise has hardly any gradients.
        draw = {"size": (20, 20), "quality": ws.Sampling(oversampling=1), "shading": None}
        picture = ws.render(wavelets.level(left_out), SOFT, camera, **draw).rgba
        assert np.isfinite(picture).all()
        assert picture[..., 3].max() > 0.1


@pytest.mark.parametrize("family", FAMILIES)
def test_all_bands_are_the_volume_and_sums_of_bands_are_sums_of_pictures(textured, family):
    """A projection that sums is linear in the samples."""
    wavelets = ws.WaveletVolume.from_volume(textured, family, threshold=5, levels=3)
    camera = ws.Camera.orbit(textured, 20, 30, fit="view")
    draw = {"look": SOFT, "camera": camera, "size": (32, 32)}
    whole = ws.render(wavelets, **draw).rgba
    assert np.array_equal(ws.render(wavelets.bands([1.0] * 4), **draw).rgba, whole)
    assert not np.array_equal(ws.render(wavelets.bands([0.0]), **draw).rgba, whole)

    def projected(weights):
        return ws.render(wavelets.bands(weights), composite="sum", **draw).value

    parts = [projected([float(k == band) for k in range(4)]) for band in range(4)]
    want = projected([])
    largest = np.nanmax(np.abs(want))
    assert largest > 100
    # Where two faces meet and at extremes, the warp clamps values to those of the texels around, which is not linear.
    off = np.abs(sum(parts) - want)[np.isfinite(want)] / largest
    assert np.median(off) < 1e-6
    assert np.mean(off > 1e-4) < 0.25
    assert np.mean(off > 1e-2) < 0.003


@pytest.mark.parametrize("family", FEW_FAMILIES)
@pytest.mark.parametrize("shape", [(32, 48, 40), (33, 47, 41), (21, 38, 64)])
def test_a_level_fills_the_same_box(family, shape):
    """Constant fog: every ray of every level has the length of the whole, so the same opacity."""
    fog = ws.Volume(np.full(shape, 7.0, np.float32), spacing=(1.0, 1.2, 0.7))
    wavelets = ws.WaveletVolume.from_volume(fog, family)
    curve = ws.TransferFunction([(0, 0.03)], [(0, 1.0, 0.5, 0.2)])
    # In perspective the finest pixels have texels that are coarser than they by 1.4.
    for view_angle, oversampling in ((None, 1.0), (50, 1.4)):
        camera = ws.Camera.orbit(fog, 30, 25, view_angle=view_angle, fit="view")
        size = {"size": (48, 48), "quality": ws.Sampling(oversampling=oversampling)}
        draw = {"look": curve, "camera": camera, "shading": None, **size}
        want = ws.render(fog, **draw).rgba
        assert want[..., 3].max() > 0.5
        assert (want[..., 3] == 0).any()
        for left_out in range(wavelets.n_levels + 1):
            got = ws.render(wavelets.level(left_out), **draw).rgba
            # Texels at the outline are covered in part.
            assert np.abs(got - want).max() < 0.08, left_out
            assert np.abs(got - want).mean() < 5e-4, left_out


@pytest.mark.parametrize("family", ["cdf97", *nightly("haar", "cdf53")])
def test_a_crop_of_a_level_is_that_of_the_world(textured, family):
    size = np.array(textured.shape[::-1])
    low, high = 0.21 * size, 0.73 * size
    upright = ws.Volume(textured.samples, spacing=(1.0, 0.8, 1.3))
    wavelets = ws.WaveletVolume.from_volume(upright, family, threshold=2)
    camera = ws.Camera.orbit(upright, 30, 25, fit="view")
    index = ws.Crop(low, high, space="index")
    world = ws.Crop(low * upright.spacing, high * upright.spacing)
    for left_out in range(4):
        draw = {"look": SOFT, "camera": camera, "size": (40, 40)}
        level = wavelets.level(left_out)
        by_index = ws.render(level, clip=index, **draw).rgba
        assert difference(by_index, ws.render(level, clip=world, **draw).rgba) < 1e-5
        assert 0 < (by_index[..., 3] > 0).mean() < 0.7 * (ws.render(level, **draw).rgba[..., 3] > 0).mean()


@pytest.mark.parametrize("family", ["cdf53", "cdf97"])
@pytest.mark.parametrize(
    ("name", "keep"),
    [
        ("ct", 1.0),
        ("mri", 0.0127),
        pytest.param("mri", 1.0, marks=pytest.mark.nightly),  # by day another scan is kept whole
        pytest.param("ct", 0.0355, marks=pytest.mark.nightly),  # by day another scan is kept in part
    ],
)
def test_levels_are_as_bright_as_the_whole(scans, family, name, keep):
    """Levels are as bright to 4 %, or to 6 % in light, since they are matched along few probe rays."""
    ramps = {
        "ct": [(-75, 0.0), (255, 0.05), (1000, 0.2)],
        "mri": [(20, 0.0), (255, 0.1)],
    }
    soft = ws.TransferFunction(ramps[name], [(-75, 0.9, 0.6, 0.4), (1000, 1.0, 1.0, 1.0)])
    wavelets = ws.WaveletVolume.from_volume(scans[name], family, keep=keep)
    for shading, limit in [(None, 0.04), (ws.Shading(), 0.06)]:
        draw = {"look": soft, "size": (96, 96), "shading": shading}
        whole = ws.render(wavelets, **draw).rgba
        for left_out in (1, 2):
            level = ws.render(wavelets.level(left_out), **draw).rgba
            assert level[..., :3].mean() / whole[..., :3].mean() == pytest.approx(1, abs=limit), (left_out, shading)


@pytest.mark.parametrize("family", ["cdf53", "cdf97"])
@pytest.mark.parametrize("name", ["ct", "mri"])
def test_levels_keep_what_is_thin(scans, family, name):
    """Matter is solid from a threshold on; the mean of a wall and its surroundings is below, so low-pass loses it."""
    least = {"ct": 200.0, "mri": 50.0}[name]
    solid = ws.TransferFunction([(least, 0.0), (least + 1, 0.8)], [(0, 1.0, 1.0, 1.0)])
    wavelets = ws.WaveletVolume.from_volume(scans[name], family)
    draw = {"look": solid, "camera": ws.Camera.orbit(scans[name], fit="view"), "size": (96, 96), "shading": None}
    whole = ws.render(wavelets, **draw).rgba[..., 3].mean()
    level = ws.render(wavelets.level(2), **draw).rgba[..., 3].mean()
    blurred = ws.render(wavelets.level(2).to_volume(), **draw).rgba[..., 3].mean()
    assert blurred < 0.92 * whole
    assert abs(level - whole) < 0.5 * abs(blurred - whole)


def test_a_level_that_is_steep_gets_the_sheets_of_one():
    """The walls are thin, so that a smooth function has to become a denser, steep one on coarser levels."""
    x, y, z = np.meshgrid(*[np.arange(64)] * 3)
    walls = np.where((x + y + z) % 16 == 3, 200, 0).astype(np.uint8)
    wavelets = ws.WaveletVolume.from_volume(ws.Volume(walls), "cdf53")
    smooth = ws.TransferFunction([(60, 0), (200, 0.5)], [(0, 1, 1, 1)], 1.0)
    # A second level has 27 texels across; with half of them there would be moire with the walls.
    draw = {
        "look": smooth,
        "camera": ws.Camera.orbit(wavelets, fit="view"),
        "size": (128, 128),
        "shading": ws.Shading.headlight(),
    }
    assert ws.render(wavelets, quality="high", **draw).report["sheets_per_slice"] == 4
    pictures = [ws.render(wavelets.level(k), **draw) for k in range(3)]
    assert [picture.report["sheets_per_slice"] for picture in pictures] == [2, 1, 1]
    whole, *levels = [picture.rgba[..., :3].mean() for picture in pictures]
    assert levels == pytest.approx([whole, whole], rel=0.08)


@pytest.mark.parametrize("family", ["cdf53", *nightly("haar", "cdf97")])
def test_a_level_has_an_eighth_of_the_work(scans, family):
    """The limit is a quarter, as blocks of 16 x 8 texels count in full, and a third level has 23 texels across."""
    wavelets = ws.WaveletVolume.from_volume(scans["ct"], family, keep=0.05)
    n_texels = [ws.render(wavelets.level(k), size=(256, 256)).report["n_texels"] for k in range(4)]
    assert all(finer >= 4 * coarser for finer, coarser in pairwise(n_texels)), n_texels


def test_details_alone_are_blue_and_red(textured):
    details = ws.WaveletVolume.from_volume(textured, "cdf97", levels=3).bands([1, 1, 1, 0])
    curve = ws.TransferFunction.auto(details)
    limit = curve.opacity[-1][0]
    assert curve == ws.TransferFunction.diverging(limit)
    assert 0 < limit <= max(map(abs, details.value_range))
    (blue, nothing, red) = curve([-limit, 0.0, limit])
    assert blue[2] > blue[0]
    assert red[0] > red[2]
    assert (blue[3], nothing[3], red[3]) == (0.5, 0.0, 0.5)
    assert np.array_equal(ws.render(details, size=(24, 24)).rgba, ws.render(details, curve, size=(24, 24)).rgba)
    assert ws.render(details, size=(24, 24)).rgba[..., 3].max() > 0.1
    # A projection gets a ramp of its own.
    assert ws.TransferFunction.auto(details, "maximum") != curve


@pytest.mark.parametrize("limit", [0, -1, float("nan"), float("inf")])
def test_a_diverging_function_needs_a_limit(limit):
    with pytest.raises(ws.errors.ArgumentError, match="limit is"):
        ws.TransferFunction.diverging(limit)


def test_threads_share_coefficients(textured, is_night):
    """Blocks are decoded by whoever comes first, and dropped while others read them."""
    wavelets = ws.WaveletVolume.from_volume(textured, "cdf97", threshold=12)
    wavelets.cache_bytes = TINY_CACHE
    draw = {"look": SOFT, "size": (24, 24)}
    want = [ws.render(wavelets.level(k), **draw).rgba for k in range(4)]
    wrong = []

    def draw_some(first):
        for n in range(first, first + (12 if is_night else 4)):
            got = ws.render(wavelets.level(n % 4), threads=1 + n % 2, **draw).rgba
            if not np.array_equal(got, want[n % 4]):
                wrong.append(n)

    threads = [threading.Thread(target=draw_some, args=(first,)) for first in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_a_picture_can_be_stopped(textured):
    wavelets = ws.WaveletVolume.from_volume(textured, threshold=12)
    with pytest.raises(ws.errors.CancelledError):
        ws.render(wavelets, SOFT, size=(64, 64), progress=lambda _: False)
    check_same(wavelets, wavelets.to_volume())
