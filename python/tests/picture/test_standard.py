"""Standard splatting through the public API; what it draws is tested in Rust, down to the sample."""

import dataclasses

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError, CancelledError, LimitError
from wavesplat.study import StandardSplatting

VOLUME = ws.examples.ripples(16)
WHITE = ws.TransferFunction([(0, 1)], [(0, 1, 1, 1)])
SMALL = {"size": (24, 16)}
BUFFERS = [StandardSplatting(buffer=b, view_angle_correction=c) for b in ("axis", "view") for c in (True, False)]
VIEW = StandardSplatting(buffer="view")


def draw(volume=VOLUME, transfer_function=None, camera=None, **options):
    return ws.study.standard(volume, transfer_function, camera, **{**SMALL, **options})


def test_a_picture_of_defaults():
    picture = draw()
    assert picture.rgba.shape == (16, 24, 4)
    assert picture.rgba.dtype == np.float32
    assert picture.depth is None
    assert picture.value is None
    assert 0 < picture.rgba[..., 3].max() <= 1
    np.testing.assert_array_equal(draw(standard=StandardSplatting()).rgba, picture.rgba)
    report = picture.report
    assert (report["method"], report["buffer"], report["view_angle_correction"]) == ("standard", "axis", True)
    assert report["n_splats"] > 0
    assert report["n_sheets"] == [16]


@pytest.mark.parametrize("standard", BUFFERS)
@pytest.mark.parametrize("kernel", ["linear", "catmull-rom", "bspline2", "bspline3", "gaussian"])
def test_every_buffer_and_kernel_draws(standard, kernel):
    rgba = draw(standard=standard, kernel=kernel, camera=ws.Camera.orbit(VOLUME, 30, 20, fit="view")).rgba
    assert np.isfinite(rgba).all()
    assert rgba.min() >= 0
    assert 0.1 < rgba[..., 3].max() <= 1


@pytest.mark.parametrize("standard", BUFFERS)
@pytest.mark.parametrize("view_angle", [None, 30])
def test_pictures_lie_as_those_of_high_resolution_splatting_do(standard, view_angle):
    samples = np.zeros((20, 24, 28), np.uint8)
    samples[14:18, 4:9, 3:8] = 255  # off centre along every axis
    samples[3:6, 14:20, 18:26] = 120
    affine = np.array([[0, -1.5, 0, 4], [1.1, 0, 0.2, -9], [0, 0, 2, 1], [0, 0, 0, 1]], float)
    volume = ws.Volume(samples, world_from_index=affine)
    transfer_function = ws.TransferFunction([(0, 0), (255, 1)], [(0, 1, 1, 1)])
    camera = ws.Camera.orbit(volume, 35, 25, fit="view")
    if view_angle is not None:
        camera = ws.Camera(camera.position, camera.focal_point, camera.view_up, view_angle=view_angle)
    options = {"size": (60, 50), "shading": None}
    fine = ws.render(volume, transfer_function, camera, **options).rgba[..., 3]
    coarse = draw(volume, transfer_function, camera, standard=standard, **options).rgba[..., 3]
    assert np.corrcoef(fine.ravel(), coarse.ravel())[0, 1] > 0.99
    assert np.corrcoef(fine[::-1].ravel(), coarse.ravel())[0, 1] < 0.65
    assert np.corrcoef(fine[:, ::-1].ravel(), coarse.ravel())[0, 1] < 0.65


def test_the_view_angle_correction_makes_a_slab_as_opaque_as_it_is_long():
    samples = np.zeros((7, 20, 40), np.uint8)
    samples[3] = 100
    volume = ws.Volume(samples, spacing=(4, 4, 1))
    half = ws.TransferFunction([(99, 0), (100, 0.5)], [(0, 1, 1, 1)], opacity_unit=1.0)
    focal = np.array([78.0, 38, 3])
    towards = np.array([np.sin(np.radians(60)), 0, np.cos(np.radians(60))])
    camera = ws.Camera(focal + 100 * towards, focal, (0, 1, 0), parallel_scale=5)
    for corrected, want in [(True, 1 - 0.5**2), (False, 0.5)]:
        standard = StandardSplatting(view_angle_correction=corrected)
        rgba = draw(volume, half, camera, standard=standard, shading=None).rgba
        np.testing.assert_allclose(rgba[..., 3], want, atol=1e-4)


@pytest.mark.parametrize("standard", BUFFERS)
def test_a_wavelet_volume_is_drawn_by_its_samples(standard):
    wavelets = ws.WaveletVolume.from_volume(VOLUME, levels=2, threshold=5)
    of_samples = draw(wavelets.to_volume(), WHITE, "left", standard=standard)
    np.testing.assert_allclose(draw(wavelets, WHITE, "left", standard=standard).rgba, of_samples.rgba, atol=1e-4)
    details = draw(wavelets.bands([1, 1, 0]), standard=standard)
    assert details.rgba[..., 3].max() > 0


@pytest.mark.parametrize("standard", BUFFERS)
def test_crop_clip_planes_background_and_holes(standard):
    how = {"camera": ws.Camera.view(VOLUME, "anterior", aspect=24 / 16), "standard": standard}  # of the whole volume
    cropped = draw(transfer_function=WHITE, clip=ws.Crop((0, 0, 8), (15, 15, 15), space="index"), **how)
    clipped = draw(transfer_function=WHITE, clip=ws.ClipPlane((0, 0, 7.5), (0, 0, 1)), **how)
    np.testing.assert_allclose(clipped.rgba, cropped.rgba, atol=1e-5)
    assert cropped.rgba[:6, :, 3].max() > 0.9
    assert cropped.rgba[10:, :, 3].max() == 0
    samples = VOLUME.samples.astype(np.float32)
    samples[:8] = np.nan
    holes = draw(ws.Volume(samples), WHITE, **how, shading=None, background="#ff0000")
    np.testing.assert_array_equal(holes.rgba[12, 12], [1, 0, 0, 1])
    assert holes.report["n_nonfinite_samples"] == 8 * 16 * 16


@pytest.mark.parametrize("standard", BUFFERS)
def test_any_number_of_threads_gives_the_same_bytes(standard):
    pictures = [draw(threads=n, size=(80, 70), standard=standard).rgba.tobytes() for n in (1, 2, 7)]
    assert len(set(pictures)) == 1


@pytest.mark.parametrize("standard", BUFFERS)
def test_progress_reports_and_cancels(standard):
    seen = []
    draw(standard=standard, progress=seen.append)
    assert seen
    assert all(0 <= fraction <= 1 for fraction in seen)
    with pytest.raises(CancelledError):
        draw(standard=standard, progress=lambda _: False)


@pytest.mark.parametrize("oversampling", [0.5, 1, 2])
def test_it_has_as_many_texels_as_asked_for(oversampling):
    for standard in (None, VIEW):
        picture = draw(oversampling=oversampling, standard=standard)
        assert picture.report["oversampling"] == oversampling
        assert picture.rgba.shape == (16, 24, 4)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"shading": ws.Shading.headlight(gradient_offset=0.5)}, "gradient of standard splatting"),
        ({"shading": ws.Shading.headlight(shadow=1)}, "light of standard splatting"),
        ({"standard": "axis"}, "standard is a str; give a wavesplat.study.StandardSplatting"),
        ({"kernel": "cubic"}, "unknown kernel"),
        ({"size": (0, 16)}, "width"),
        ({"oversampling": 0}, "oversampling"),
        ({"clip": ws.Crop((90, 90, 90), (99, 99, 99))}, "holds nothing"),
        ({"threads": 0}, "threads"),
    ],
)
def test_what_it_cannot_do_is_an_argument_error(options, message):
    with pytest.raises(ArgumentError, match=message):
        draw(**options)


def test_a_picture_beyond_memory_is_a_limit():
    with pytest.raises(LimitError, match="oversampling"):
        draw(size=(16384, 16384), oversampling=2, standard=VIEW)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"buffer": "front"}, "no buffer 'front'; the buffers are axis, view"),
        ({"view_angle_correction": 1}, "view_angle_correction is 1; give True or False"),
    ],
)
def test_choices_are_checked_where_they_are_made(options, message):
    with pytest.raises(ArgumentError, match=message):
        StandardSplatting(**options)


def test_choices_cannot_be_changed():
    with pytest.raises(dataclasses.FrozenInstanceError):
        VIEW.buffer = "axis"
