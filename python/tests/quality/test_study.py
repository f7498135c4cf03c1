"""Each ablation changes the picture in the way that theory says."""

from __future__ import annotations

import dataclasses
import pickle

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, CancelledError
from wavesplat.study import Ablation, splat

SIZE = (96, 96)
SOFT = ws.TransferFunction(
    [(60, 0), (128, 0.05), (255, 0.2)], [(60, 0.3, 0.5, 0.9), (128, 0.9, 0.9, 0.9), (255, 0.9, 0.4, 0.2)]
)


def psnr_db(got: ws.Picture, want: ws.Picture) -> float:
    difference = got.rgba[..., :3].astype(float) - want.rgba[..., :3]
    return float(-10 * np.log10(np.mean(difference**2)))


def ball(n: int = 32, radius: float = 10.0, center: tuple[float, float, float] | None = None) -> ws.Volume:
    """A ball whose value falls evenly from 255 to 0 across its radius."""
    x0, y0, z0 = center or ((n - 1) / 2,) * 3
    z, y, x = np.mgrid[:n, :n, :n]
    distance = np.sqrt((x - x0) ** 2 + (y - y0) ** 2 + (z - z0) ** 2)
    return ws.Volume(np.clip(255 * ((radius - distance) / 8 + 0.5), 0, 255).astype(np.float32))


@pytest.fixture(scope="module")
def ripples():
    """The volume, a camera that sees its sheets obliquely, and the converged picture."""
    volume = ws.examples.ripples(24)
    camera = ws.Camera.orbit(volume, 35, 30, fit="view")
    return (
        volume,
        camera,
        ws.reference.raycast(volume, SOFT, camera, size=SIZE, step=0.1, shading=ws.Shading.headlight()),
    )


def draw(ripples, **options) -> ws.Picture:
    volume, camera, _ = ripples
    ablation = Ablation(**options.pop("ablation", {}))
    return splat(volume, SOFT, camera, ablation=ablation, **({"size": SIZE} | options))


# The view angle


@pytest.mark.parametrize("degrees", [0, 30, 60])
def test_a_slab_is_as_thick_as_the_way_through_it_or_not(degrees):
    opacity = 0.3
    # Fog ten units thick and very wide; slices are so dense along z that they lie across z at any of these angles.
    fog = ws.Volume(np.ones((11, 40, 40), np.float32), spacing=(4, 4, 1))
    curve = ws.TransferFunction([(0, opacity)], [(0, 1, 1, 1)], opacity_unit=10.0)
    angle = np.radians(degrees)
    center = np.array([78.0, 78.0, 5.0])
    camera = ws.Camera(
        center + 100 * np.array([np.sin(angle), 0, np.cos(angle)]), center, (0, 1, 0), parallel_scale=10.0
    )
    for corrected in (True, False):
        ablation = Ablation(view_angle_correction=corrected)
        rgba = splat(fog, curve, camera, size=(9, 9), shading=None, ablation=ablation).rgba
        want = 1 - (1 - opacity) ** (1 / np.cos(angle)) if corrected else opacity
        np.testing.assert_allclose(rgba[..., 3], want, atol=1e-5)


def test_the_correction_pays(ripples):
    want = ripples[2]
    plain = draw(ripples, ablation={"view_angle_correction": False})
    assert psnr_db(plain, want) < psnr_db(draw(ripples), want) - 6
    assert plain.rgba[..., 3].mean() < want.rgba[..., 3].mean() - 0.01


# Slicing the kernel


def test_without_slicing_sheets_repeat_slices():
    # Only the fourth slice has visible samples; the rays run along z.
    samples = np.zeros((9, 16, 16), np.float32)
    samples[4] = 1
    volume = ws.Volume(samples)
    curve = ws.TransferFunction([(0.99, 0), (1, 0.5)], [(0, 1, 1, 1)])
    camera = ws.Camera.orbit(volume, 0, 90, fit="view")
    opacity = {}
    for sliced in (True, False):
        options = {"sheets_per_slice": 10, "shading": None, "size": (9, 9)}
        picture = splat(volume, curve, camera, ablation=Ablation(kernel_slicing=sliced), **options)
        opacity[sliced] = picture.rgba[4, 4, 3]
    # With kernel slicing one sheet of ten reaches the value, without it all ten that are nearest to the slice.
    assert opacity[True] == pytest.approx(1 - 0.5**0.1, abs=1e-4)
    assert opacity[False] == pytest.approx(0.5, abs=1e-4)


@pytest.mark.parametrize("kernel", ["linear", "catmull-rom", "bspline2", "bspline3"])
def test_on_the_slices_interpolating_kernels_have_nothing_to_slice(ripples, kernel):
    one = {"sheets_per_slice": 1, "kernel": kernel, "shading": None}
    sliced, own = draw(ripples, **one), draw(ripples, ablation={"kernel_slicing": False}, **one)
    np.testing.assert_allclose(own.rgba, sliced.rgba, atol=2e-5)


def test_slicing_the_kernel_pays(ripples):
    want = ripples[2]
    assert psnr_db(draw(ripples, ablation={"kernel_slicing": False}), want) < psnr_db(draw(ripples), want) - 4


# Gradients

DIFFUSE = {"ambient": 0.0, "diffuse": 1.0, "specular": 0.0}


def lit_ball(gradient: str, offset: float, *, light: tuple[float, float, float] = (0, 0, 1)) -> np.ndarray:
    """Brightness of the ball's surface, seen from the front; its right and left are the volume's -x and +x."""
    volume = ball()
    shading = ws.Shading.headlight(gradient_offset=offset, lights=[ws.Light(light)], **DIFFUSE)
    surface = ws.TransferFunction([(100, 0), (101, 1)], [(0, 1, 1, 1)])
    camera = ws.Camera.orbit(volume, 0, 0, zoom=2.5, fit="view")
    options = {"size": (97, 97), "sheets_per_slice": 8, "shading": shading}
    return splat(volume, surface, camera, ablation=Ablation(gradient=gradient), **options).rgba[..., 0]


def asymmetry(lit: np.ndarray) -> float:
    """Mean difference of the left half and the right half mirrored."""
    return float(np.abs(lit - lit[:, ::-1]).mean() / lit.mean())


def test_forward_differences_look_from_one_side():
    central, forward = lit_ball("footprint", 1.0), lit_ball("footprint-forward", 1.0)
    assert asymmetry(central) < 0.005
    assert asymmetry(forward) > 0.01


def test_the_shorter_the_offset_the_less_a_forward_difference_leans():
    leaning = [asymmetry(lit_ball("footprint-forward", offset)) for offset in (0.1, 1.0, 4.0)]
    assert leaning[0] < leaning[1] < leaning[2]


def test_a_short_offset_of_the_linear_kernel_shows_the_cells():
    # The gradient of a trilinear function jumps from cell to cell, so that the light has steps where the ball is round.
    # Differences over half a sample to either side, or more, bridge the jumps.
    def largest_kink(offset: float) -> float:
        return float(np.abs(np.diff(lit_ball("footprint", offset)[30:67, 30:67], n=2)).max())

    assert largest_kink(0.1) > 4 * max(largest_kink(offset) for offset in (0.5, 0.75, 1.0))


def test_sheet_differences_are_footprints_a_whole_number_of_texels_wide():
    volume = ball(20, 6.0)
    camera = ws.Camera.view(volume, "anterior")
    # The rays run along y. Sheets lie a quarter of a slice apart, and so do texels.
    side = 2 * camera.parallel_scale
    n = round(side * 4)
    camera = ws.Camera(camera.position, camera.focal_point, camera.view_up, parallel_scale=n / 8)
    options = {"size": (n, n), "sheets_per_slice": 4}

    def shaded(gradient: str, offset: float) -> np.ndarray:
        shading = ws.Shading.headlight(gradient_offset=offset)
        return splat(volume, SOFT, camera, shading=shading, ablation=Ablation(gradient=gradient), **options).rgba

    for ours, theirs in (("sheet-central", "footprint"), ("sheet-forward", "footprint-forward")):
        # Offsets are rounded to texels: 0.01 takes the neighbouring texel, and 0.6 half a sample.
        for offset, texels in ((0.01, 1), (0.25, 1), (0.5, 2), (0.6, 2), (1.0, 4)):
            np.testing.assert_allclose(shaded(ours, offset), shaded(theirs, texels / 4), atol=1e-3)
    assert np.abs(shaded("sheet-central", 0.01) - shaded("sheet-central", 1.0)).max() > 0.05


# Footprint tables


@pytest.mark.parametrize("footprint", ["nearest", "nearest-noise"])
def test_tables_converge_to_exact_weights(ripples, footprint):
    exact = draw(ripples)
    errors = [
        psnr_db(draw(ripples, ablation={"footprint": footprint, "footprint_entries": entries}), exact)
        for entries in (2, 8, 64, 1024)
    ]
    assert errors == sorted(errors)
    assert errors[0] < 45
    assert errors[-1] > 70


def test_a_coarse_table_is_worse_than_exact_weights(ripples):
    want = ripples[2]
    for footprint in ("nearest", "nearest-noise"):
        coarse = draw(ripples, ablation={"footprint": footprint, "footprint_entries": 2})
        assert psnr_db(coarse, want) < psnr_db(draw(ripples), want) - 1


def ramp_values(footprint: str) -> np.ndarray:
    """The mean value along z of a linear ramp along x, at eight texels a sample, over half of the samples."""
    samples = np.broadcast_to(np.arange(24, dtype=np.float32), (16, 24, 24))
    volume = ws.Volume(np.ascontiguousarray(samples))
    camera = ws.Camera.orbit(volume, 0, 90, fit="view")
    camera = ws.Camera(camera.position, camera.focal_point, camera.view_up, parallel_scale=6.0)
    # Opacity is so low that all sheets count much the same.
    grey = ws.TransferFunction([(0, 0.01)], [(0, 0, 0, 0), (24, 1, 1, 1)])
    ablation = Ablation(footprint=footprint, footprint_entries=2)
    # With half a texel a pixel, every second pixel is one read of one texel.
    size = (192, 192)
    rgba = splat(volume, grey, camera, size=size, shading=None, oversampling=0.5, ablation=ablation).rgba[::2, ::2]
    return 24 * rgba[..., 0] / rgba[..., 3]


def test_tables_make_stairs_of_slopes_and_noise_makes_grain_of_stairs():
    exact, stairs, grain = (ramp_values(footprint) for footprint in ("exact", "nearest", "nearest-noise"))
    # Two entries a sample make stairs: at eight texels a sample most steps are 0, and the others about 1/2.
    steps = np.abs(np.diff(exact[48])), np.abs(np.diff(stairs[48]))
    assert steps[0].max() == pytest.approx(1 / 8, abs=1e-3)
    assert (steps[1] < 1e-3).mean() > 0.5
    assert steps[1].max() > 0.4
    # Rows of stairs are alike; grain differs from row to row.
    assert np.abs(np.diff(stairs, axis=0)).max() < 1e-3
    assert np.abs(np.diff(grain, axis=0)).max() > 0.01

    # The mean over all sheets and rows has lost the stairs.
    def lost(picture: np.ndarray) -> float:
        return float(np.abs((picture - exact).mean(axis=0)).max())

    assert lost(grain) < 0.4 * lost(stairs)


def test_noise_leaves_alone_what_is_flat():
    flat = ws.Volume(np.full((12, 12, 12), 7.0, np.float32))
    curve = ws.TransferFunction([(6, 0), (8, 0.2)], [(6, 0, 0, 0), (8, 1, 1, 1)])
    options = {"size": (24, 24), "shading": None}
    noise = Ablation(footprint="nearest-noise", footprint_entries=2)
    noisy, exact = (splat(flat, curve, "left", ablation=a, **options).rgba for a in (noise, None))
    assert exact[..., 3].max() > 0.3
    np.testing.assert_allclose(noisy, exact, atol=1e-6)


def test_noise_repeats_whatever_the_threads(ripples):
    noise = {"footprint": "nearest-noise", "footprint_entries": 3}
    for view_angle in (None, 40.0):
        volume = ripples[0]
        camera = ws.Camera.orbit(volume, 35, 30, view_angle=view_angle, fit="view")
        pictures = [draw((volume, camera, None), ablation=noise, threads=threads).rgba for threads in (1, 2, 2)]
        assert pictures[0].tobytes() == pictures[1].tobytes() == pictures[2].tobytes()
    assert psnr_db(draw(ripples, ablation=noise), draw(ripples, ablation=noise | {"footprint": "nearest"})) < 60


def test_holes_stay_holes_with_any_weights():
    samples = np.full((12, 12, 12), 100.0, np.float32)
    samples[4:8, 4:8, 4:8] = np.nan
    volume = ws.Volume(samples)
    camera = ws.Camera.orbit(volume, 20, 10, fit="view")
    shown = {}
    for footprint in ("exact", "nearest", "nearest-noise"):
        ablation = Ablation(footprint=footprint, footprint_entries=16)
        picture = splat(volume, SOFT, camera, size=SIZE, shading=None, ablation=ablation)
        assert np.isfinite(picture.rgba).all()
        shown[footprint] = picture.rgba[..., 3]
    assert shown["exact"].min() < shown["exact"].max() - 0.2
    for footprint in ("nearest", "nearest-noise"):
        assert np.abs(shown[footprint] - shown["exact"]).mean() < 0.02


# The whole


@pytest.mark.parametrize("view_angle", [None, 40.0])
def test_without_an_ablation_it_is_the_renderer_with_plain_sheets(ripples, view_angle):
    volume = ripples[0]
    camera = ws.Camera.orbit(volume, 35, 30, view_angle=view_angle, fit="view")
    plain = {"pre_integration": False, "early_ray_termination": False, "quality": ws.Sampling(2, 1)}
    cut = {"clip": [ws.Crop((3, 3, 3), (20.5, 19, 18), space="index"), ws.ClipPlane((11, 11, 11), (1, 2, 1))]}
    for options in ({}, {"kernel": "bspline3"}, {"shading": None}, {"kernel": "catmull-rom"}, cut):
        how = {"size": SIZE, "shading": ws.Shading.headlight()} | options
        fast = ws.study.render(volume, SOFT, camera, **plain, **how).rgba
        literal = splat(volume, SOFT, camera, **how).rgba
        assert fast[..., 3].max() > 0.5
        # The tolerance is for single precision and tables of the transfer function, as for the twins in Rust.
        np.testing.assert_allclose(literal, fast, atol=1e-4)


@pytest.mark.parametrize(
    "change",
    [
        {"view_angle_correction": False},
        {"kernel_slicing": False},
        {"gradient": "footprint-forward"},
        {"gradient": "sheet-central"},
        {"gradient": "sheet-forward"},
        {"footprint": "nearest", "footprint_entries": 3},
        {"footprint": "nearest-noise", "footprint_entries": 3},
        {"kernel_slicing": False, "gradient": "sheet-forward", "footprint": "nearest-noise"},
    ],
)
def test_every_view_draws_every_ablation(change):
    volume = ws.examples.ripples(12)
    # With coarse texels, wide sheets, or the eye inside the volume, offsets in texels are large or vanish.
    for camera, sheets in (
        (ws.Camera.orbit(volume, 35, 30, fit="view"), 0.1),
        (ws.Camera((5, 5.2, 5.1), (11, 9, 8), (0, 0, 1), view_angle=100), 3),
    ):
        options = {"size": (17, 13), "sheets_per_slice": sheets, "oversampling": 0.3, "kernel": "catmull-rom"}
        picture = splat(volume, SOFT, camera, ablation=Ablation(**change), **options)
        assert np.isfinite(picture.rgba).all()
        assert picture.rgba[..., 3].max() > 0.05


def test_it_reports_progress_and_cancels(ripples):
    seen = []
    draw(ripples, progress=seen.append)
    assert seen[-1] == 1
    with pytest.raises(CancelledError):
        draw(ripples, progress=lambda _: False)


def test_it_draws_samples_without_held_off_light():
    volume = ws.examples.ripples(8)
    with pytest.raises(ArgumentError, match="to_volume"):
        splat(ws.WaveletVolume.from_volume(volume), size=(4, 4))
    with pytest.raises(ArgumentError, match="ambient_occlusion"):
        splat(volume, shading=ws.Shading(shadow=1), size=(4, 4))
    with pytest.raises(ArgumentError, match="ablation is a str"):
        splat(volume, ablation="none", size=(4, 4))


def test_ablations_are_values():
    ablation = Ablation(gradient="sheet-central", footprint="nearest", footprint_entries=4)
    assert pickle.loads(pickle.dumps(ablation)) == ablation  # noqa: S301
    assert dataclasses.replace(ablation, footprint_entries=8) != ablation
    assert "sheet-central" in repr(ablation)
    assert "_core" not in repr(ablation)
    with pytest.raises(dataclasses.FrozenInstanceError):
        ablation.kernel_slicing = False


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"gradient": "central"}, 'unknown gradient "central".*sheet-forward'),
        ({"footprint": "linear"}, 'unknown footprint "linear".*exact, nearest, nearest-noise'),
        ({"footprint": "nearest", "footprint_entries": 1}, "footprint_entries is 1.*between 2 and 1024"),
        ({"footprint_entries": -3}, "footprint_entries is -3"),
        ({"footprint": "nearest", "footprint_entries": 2.5}, "footprint_entries is 2.5.*whole number"),
    ],
)
def test_bad_ablations_are_refused_where_they_are_made(options, message):
    with pytest.raises(ArgumentError, match=message):
        Ablation(**options)
