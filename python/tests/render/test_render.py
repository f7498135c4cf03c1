"""The public API around the renderer; what it draws is tested in Rust."""

import pickle

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._model.camera.views import VIEWS
from wavesplat._render.framing import framed
from wavesplat.errors import ArgumentError, CancelledError, LimitError

VOLUME = ws.examples.ripples(16)
WHITE = ws.TransferFunction([(0, 1)], [(0, 1, 1, 1)])
SMALL = {"size": (24, 16)}


def test_a_picture_of_defaults():
    picture = ws.render(VOLUME, **SMALL)
    assert picture.rgba.shape == (16, 24, 4)
    assert picture.rgba.dtype == np.float32
    assert picture.size == (24, 16)
    assert picture.depth is None
    alpha = picture.rgba[..., 3]
    assert 0 < alpha.max() <= 1


def test_names_stand_for_presets_and_views():
    by_name = ws.render(VOLUME, "mr-head", "left", **SMALL)
    look = ws.Look.preset("mr-head", VOLUME)
    by_object = ws.render(VOLUME, look, framed([(VOLUME, look)], *VIEWS["left"], aspect=24 / 16), **SMALL)
    np.testing.assert_array_equal(by_name.rgba, by_object.rgba)


def test_the_patients_right_is_at_the_left_of_the_anterior_view_and_the_head_is_up():
    samples = np.zeros((20, 20, 20), np.uint8)
    samples[15:, 8:12, 15:] = 255  # superior and, +x being right in RAS, right
    volume, curves = ws.Volume(samples), ws.TransferFunction([(0, 0), (255, 1)], [(0, 1, 1, 1)])
    camera = ws.Camera.view(volume, "anterior", aspect=24 / 16)  # of the whole volume
    rgba = ws.render(volume, curves, camera, **SMALL).rgba
    rows, columns = np.nonzero(rgba[..., 3] > 0.5)
    assert rows.size > 0
    assert rows.max() < 8
    assert columns.max() < 12


@pytest.mark.parametrize("background", [(1, 0, 0), (1, 0, 0, 1), "#ff0000", "#ff0000ff", "1,0,0"])
def test_backgrounds(background):
    rgba = ws.render(VOLUME, ws.TransferFunction([(0, 0)], [(0, 1, 1, 1)]), background=background, **SMALL).rgba
    np.testing.assert_array_equal(rgba, np.broadcast_to([1, 0, 0, 1], rgba.shape))


def test_crop_and_clip_planes_agree():
    crop = ws.Crop((0, 0, 7.5), (15, 15, 15), space="index")
    cropped = ws.render(VOLUME, WHITE, clip=crop, **SMALL)
    in_world = ws.render(VOLUME, WHITE, clip=ws.Crop((-1, -1, 7.5), (20, 20, 20)), **SMALL)
    clipped = ws.render(VOLUME, WHITE, clip=ws.ClipPlane((0, 0, 7.5), (0, 0, 1)), **SMALL)
    np.testing.assert_allclose(in_world.rgba, cropped.rgba, atol=1e-5)
    np.testing.assert_allclose(clipped.rgba, cropped.rgba, atol=1e-5)  # views fit what either of them leaves
    whole_view = ws.render(VOLUME, WHITE, ws.Camera.view(VOLUME, "anterior"), clip=crop, **SMALL)
    assert whole_view.rgba[:7, :, 3].max() > 0
    assert whole_view.rgba[9:, :, 3].max() == 0


def test_projections_give_values():
    picture = ws.render(VOLUME, composite="maximum", **SMALL)
    assert np.nanmax(picture.value) == pytest.approx(VOLUME.value_range[1], rel=0.05)
    assert np.isnan(picture.value[0, 0])


def test_depth_of_a_wall():
    camera = ws.Camera.view(VOLUME, "anterior")
    depth = ws.render(VOLUME, WHITE, camera, depth=True, size=(9, 9)).depth
    assert depth[4, 4] == pytest.approx(camera.position[1] - 15, abs=0.2)


def test_any_number_of_threads_gives_the_same_bytes():
    pictures = [ws.render(VOLUME, threads=threads, size=(64, 64)).rgba.tobytes() for threads in (1, 2, 7)]
    assert len(set(pictures)) == 1


def test_progress_reports_and_cancels():
    seen = []
    ws.render(VOLUME, progress=seen.append, **SMALL)
    assert seen
    assert all(0 <= fraction <= 1 for fraction in seen)
    with pytest.raises(CancelledError):
        ws.render(VOLUME, progress=lambda _: False, **SMALL)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": (0, 5)}, "width is 0"),
        ({"size": (5, 10**6)}, "give at most 16384 pixels a side"),
        ({"size": (5.5, 5)}, "whole numbers of pixels"),
        ({"size": (-1, 5)}, "at least 1"),
        ({"size": 5}, "give .width, height."),
        ({"kernel": "cubic"}, "unknown kernel.*catmull-rom"),
        ({"composite": "add"}, "unknown composite.*maximum"),
        ({"quality": "best"}, "unknown quality.*draft, normal, fine, high"),
        ({"composite": "first-hit"}, "iso_value"),
        ({"threads": -1}, "threads is -1"),
        ({"threads": 0}, "threads is 0"),
        ({"threads": 1.5}, "threads is 1.5"),
        ({"clip": (0, 1)}, "clip 0 is 0; give wavesplat.Crop"),
        ({"clip": ws.Crop((50, 0, 0), (60, 9, 9))}, "crop"),
        ({"clip": [((0, 0, 0), (0, 0, 1))]}, "clip 0 is .*ClipPlane"),
        ({"background": (2, 0, 0)}, "color is"),
        ({"background": "blue-ish"}, "color is"),
        ({"quality": ws.Sampling(sheets_per_slice=0)}, "sheets_per_slice"),
        ({"look": 3}, "look is 3; give a wavesplat.Look, a TransferFunction"),
        ({"camera": 3}, "camera is a int"),
        ({"camera": "sideways"}, "unknown view"),
    ],
)
def test_bad_options_are_refused(options, message):
    with pytest.raises((ArgumentError, LimitError), match=message):
        ws.render(VOLUME, **options)


def test_bad_shading_is_refused():
    with pytest.raises(ArgumentError, match="ambient is -1"):
        ws.Shading(ambient=-1)
    with pytest.raises(ArgumentError, match="light 0"):
        ws.Shading(lights=[ws.Light((0, 0, 0))])
    with pytest.raises(ArgumentError, match="space of the crop is \"?'?voxels"):
        ws.Crop((0, 0, 0), (1, 1, 1), space="voxels")


def test_shadings_are_values():
    shading = ws.Shading(diffuse=0.5, lights=[ws.Light([0, 0, 1], frame="world")])
    assert pickle.loads(pickle.dumps(shading)) == shading  # noqa: S301 - our own bytes
    assert shading != ws.Shading(diffuse=0.5)


def test_a_light_from_the_side_makes_another_picture():
    head_on, aside = (
        ws.render(VOLUME, shading=ws.Shading(lights=lights), **SMALL) for lights in ((), (ws.Light((1, 0, 0)),))
    )
    assert np.abs(head_on.rgba - aside.rgba).max() > 0.05


def test_the_reference_agrees_with_the_renderer():
    # Solid objects have edges, so a pixel is a mean over its area; and a look has its own light.
    shading = ws.Shading()
    cast = ws.reference.raycast(VOLUME, step=0.1, rays_per_pixel=16, shading=shading, **SMALL).rgba
    fast = ws.render(VOLUME, quality="high", shading=shading, **SMALL).rgba
    # 30 dB on a picture this small; the quality study and the tests in Rust hold the real limits.
    assert np.sqrt(np.mean((cast - fast) ** 2)) < 0.03
    assert ws.reference.splat_literal(VOLUME, **SMALL).rgba.shape == fast.shape
