"""Pictures of scenes with geometry, by every way to draw: layers, projections, labels, lazy volumes, clusters."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._geometry import shape_arrays
from wavesplat._scene.drawing import scene_shapes

SIZE = (48, 40)
#: Along y, which front views look along; x and z across.
CAMERA = ws.Camera((10, 60, 10), (10, 10, 10), (0, 0, 1), parallel_scale=12)
CLEAR = ws.TransferFunction([(0, 0.0)], [(0, 1, 1, 1)])
#: Share of an opaque projection that shows through what is opaque over it.
THROUGH = 0.25


def box(value=1.0):
    return ws.Volume(np.full((21, 21, 21), value, np.float32), spacing=(1, 1, 1))


def wall(y, color="red", **options):
    """A square across the view, larger than the picture."""
    corners = [(x, y, z) for x, z in ((-30, -30), (50, -30), (50, 50), (-30, 50))]
    return ws.Surface(corners, [(0, 1, 2), (0, 2, 3)], color=color, lit=False, **options)


def middle(picture):
    return picture.rgba[SIZE[1] // 2, SIZE[0] // 2]


def fog(opacity):
    """Green, of an opacity per unit of length."""
    return ws.TransferFunction([(0, opacity)], [(0, 0, 1, 0)], opacity_unit=1)


def test_matter_before_a_surface_dims_it_and_matter_behind_is_hidden():
    scene = ws.Scene([box(), wall(12)], fog(0.1), shading=None)
    # From y = 20, where the eye's side is, to the wall at 12: 8 units.
    through = 0.9**8
    assert np.allclose(middle(scene.render(CAMERA, size=SIZE)), (through, 1 - through, 0, 1), atol=2e-3)
    half = scene.with_(geometry=wall(12, opacity=0.5)).render(CAMERA, size=SIZE)
    behind = 0.9**12
    expected = (through / 2, 1 - through + through / 2 * (1 - behind), 0, 1 - through / 2 * behind)
    assert np.allclose(middle(half), expected, atol=2e-3)


def test_depth_is_that_of_a_surface():
    scene = ws.Scene([box(), wall(12)], CLEAR, shading=None)
    picture = scene.render(CAMERA, size=SIZE, depth=True)
    assert np.allclose(picture.depth, 48, atol=1e-3)


def test_invisible_geometry_changes_no_byte():
    scene = ws.Scene(box(), fog(0.1))
    plain = scene.render(CAMERA, size=SIZE, device="cpu")
    hidden = scene.with_(geometry=wall(12, opacity=0)).render(CAMERA, size=SIZE, device="cpu")
    assert np.array_equal(plain.rgba, hidden.rgba)
    assert "geometry" not in plain.report


def test_the_order_of_geometry_changes_nothing():
    shapes = [wall(12, opacity=0.5), wall(5, "blue", opacity=0.5), ws.Points([(10, 15, 10)], radius=3, opacity=0.7)]
    scene = ws.Scene(box(), fog(0.05))
    one, other = (scene.with_(geometry=order).render(CAMERA, size=SIZE) for order in (shapes, shapes[::-1]))
    assert np.abs(one.rgba - other.rgba).max() < 1e-6
    assert [shape["count"] for shape in one.report["geometry"]] == [2, 2, 1]


def test_clips_cut_what_is_clipped():
    plane = ws.ClipPlane((10, 0, 0), (1, 0, 0))  # keeps x > 10, which is on the left of this view
    scene = ws.Scene(box(), CLEAR, clip=plane, shading=None)
    whole = scene.with_(geometry=wall(12)).render(CAMERA, size=SIZE).rgba
    half = scene.with_(geometry=wall(12, clipped=True)).render(CAMERA, size=SIZE).rgba
    assert (whole[..., 3] == 1).all()
    assert (half[:, 2:20, 3] == 1).all()
    assert (half[:, -20:-2, 3] == 0).all()


def test_a_projection_ends_at_what_is_opaque_and_shines_through_what_is_not():
    samples = np.zeros((21, 21, 21), np.float32)
    samples[:, :10] = 1  # behind y = 10, as this view sees it
    grey = ws.TransferFunction([(0, 0.0), (1, 1.0)], [(0, 0, 1, 0), (1, 0, 1, 0)])
    scene = ws.Scene(ws.Volume(samples, spacing=(1, 1, 1)), grey)
    options = {"size": SIZE, "composite": "maximum"}
    assert np.allclose(middle(scene.render(CAMERA, **options)), (0, 1, 0, 1))
    covered = scene.with_(geometry=wall(15)).render(CAMERA, **options)
    assert np.allclose(middle(covered), (1, 0, 0, 1), atol=1e-3)
    before = scene.with_(geometry=wall(2)).render(CAMERA, **options)
    assert np.allclose(middle(before), (1 - THROUGH, THROUGH, 0, 1), atol=1e-3)


GREEN = ws.TransferFunction([(0, 0.0), (1, 1.0)], [(0, 0, 0.2, 0), (1, 0, 0.2, 0)])


def over(wall_opacity, light, alpha):
    """A red wall over green light of an opacity, a share of which shows through."""
    share = (1 - THROUGH * alpha) * wall_opacity
    return share, (1 - share) * light, 0, share + (1 - share) * alpha


def test_geometry_is_drawn_once_over_projections_of_several_layers():
    """The light of layers is added; a wall must not be, however many there are."""
    layers = [ws.Layer(box(), GREEN, opacity=opacity) for opacity in (0.5, 0.5, 0.25)]
    options = {"size": SIZE, "composite": "maximum"}
    left = 0.5 * 0.5 * 0.75
    for opacity in (1.0, 0.5):
        behind = ws.Scene([*layers, wall(-5, opacity=opacity)]).render(CAMERA, **options)
        assert np.allclose(middle(behind), over(opacity, 0.25, 1 - left), atol=2e-3)
    # Rays end at what is opaque before anything of the layers is seen.
    before = ws.Scene([*layers, wall(25)], background="white").render(CAMERA, **options)
    assert np.allclose(middle(before), (1, 0, 0, 1), atol=2e-3)
    # Without geometry nothing changes.
    plain = ws.Scene(layers).render(CAMERA, **options)
    assert np.allclose(middle(plain), (0, 0.25, 0, 1 - left), atol=2e-3)


def test_a_faded_layer_does_not_fade_geometry():
    scene = ws.Scene([ws.Layer(box(), GREEN, opacity=0.3), wall(-5, opacity=0.5)])
    rgba = middle(scene.render(CAMERA, size=SIZE, composite="maximum"))
    assert np.allclose(rgba, over(0.5, 0.06, 0.3), atol=2e-3)


def test_a_faded_surface_of_a_value_does_not_fade_geometry():
    samples = np.zeros((21, 21, 21), np.float32)
    samples[:, 8:13] = 1
    scene = ws.Scene(ws.Layer(ws.Volume(samples, spacing=(1, 1, 1)), GREEN, opacity=0.3), shading=None)
    options = {"size": SIZE, "composite": ws.FirstHit(0.5)}
    before = scene.with_(geometry=wall(15)).render(CAMERA, **options)
    assert np.allclose(middle(before), (1, 0, 0, 1), atol=2e-3)
    behind = scene.with_(geometry=wall(4)).render(CAMERA, **options)
    assert np.allclose(middle(behind), (0.7, 0.06, 0, 1), atol=2e-3)


def test_geometry_is_seen_where_no_layer_is():
    scene = ws.Scene([ws.Layer(box(), fog(0.1), visible=False), wall(12)], background="blue", shading=None)
    picture = scene.render(CAMERA, size=SIZE)
    assert np.allclose(middle(picture), (1, 0, 0, 1), atol=1e-3)


def test_labels_over_a_projection_keep_geometry():
    segmentation = np.zeros((21, 21, 21), np.uint8)
    segmentation[:3] = 1
    labels = ws.Labels(segmentation, {1: ws.Label("blue")})
    half = ws.TransferFunction([(0, 0.5)], [(0, 0, 1, 0)])
    scene = ws.Scene([box(), wall(-5)], half, labels=labels)
    picture = scene.render(CAMERA, size=SIZE, composite="maximum")
    assert np.allclose(middle(picture), over(1, 0.5, 0.5), atol=2e-3)


def test_exposed_greys_do_not_depend_on_geometry():
    """Greys of an X-ray are chosen for the volume; a surface must not make them darker."""
    noise = ws.Volume(np.random.default_rng(0).random((21, 21, 21), np.float32), spacing=(1, 1, 1))
    ends = [
        ws.Scene([noise, *shapes]).render(CAMERA, size=SIZE, composite="sum").report["shown"][0]["transfer_function"]
        for shapes in ([], [wall(12)])
    ]
    assert ends[0] == ends[1]


def test_spots_are_seen_in_a_maximum():
    """micro.md: spots over fluorescence; greys that are chosen are opaque, and the spots are seen all the same."""
    noise = ws.Volume(np.random.default_rng(0).random((21, 21, 21), np.float32), spacing=(1, 1, 1))
    spot = ws.Points([(10, 10, 10)], radius=3, color="red", lit=False)
    rgba = middle(ws.Scene([noise, spot], background="black").render(CAMERA, size=SIZE, composite="maximum"))
    assert rgba[0] > rgba[1] + 0.5


def test_lazy_volumes_and_workers_draw_the_same_geometry():
    samples = np.random.default_rng(0).random((24, 24, 24), np.float32)
    shapes = [wall(12, opacity=0.5), ws.Points([(5, 15, 5), (15, 15, 15)], radius=2, color="blue"), ws.Frame(grid=True)]
    lazy = ws.Volume.lazy(samples, memory="64 MB", spacing=(1, 1, 1))
    whole = ws.Scene([ws.Volume(samples, spacing=(1, 1, 1)), *shapes], fog(0.1)).render(CAMERA, size=SIZE, device="cpu")
    streamed = ws.Scene([lazy, *shapes], fog(0.1)).render(CAMERA, size=SIZE)
    assert np.abs(whole.rgba - streamed.rgba).max() < 2e-3
    pytest.importorskip("dask")
    cut = ws.Scene([lazy, *shapes], fog(0.1)).render(CAMERA, size=SIZE, client="threads")
    assert np.array_equal(streamed.rgba, cut.rgba)


def test_large_geometry_is_told_where_it_travels(monkeypatch):
    pytest.importorskip("dask")
    for module in (shape_arrays, scene_shapes):
        monkeypatch.setattr(module, "LARGE_BYTES", 100)
    lazy = ws.Volume.lazy(np.zeros((16, 16, 16), np.float32), memory="64 MB", spacing=(1, 1, 1))
    scene = ws.Scene([lazy, wall(12)], fog(0.1))
    told = scene.render(CAMERA, size=SIZE, client="threads").report["notes"]
    assert any(note.startswith("the geometry has 0 MiB, and all of it is sent to each worker") for note in told)
    assert not any("geometry" in note for note in scene.render(CAMERA, size=SIZE).report.get("notes", []))


def test_stereo_and_panoramas_show_geometry():
    scene = ws.Scene([box(), wall(12)], fog(0.1), shading=None)
    eyes = scene.render(CAMERA, size=SIZE, stereo="side-by-side")
    left, right = eyes.rgba[20, 12], eyes.rgba[20, 36]
    assert left[0] > 0.3
    assert np.allclose(left, right, atol=0.02)
    around = ws.Camera((10, 30, 10), (10, 10, 10), (0, 0, 1), view_angle=30)
    assert scene.render(around, size=(64, 32), panorama=True).rgba[16, 32, 0] > 0.3


def test_pictures_of_wavelets_have_geometry():
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(24))
    lower, upper = wavelets.bounds
    center = tuple(((lower + upper) / 2).tolist())
    scene = ws.Scene([wavelets, ws.Points([center], size=400, color="red", lit=False)], CLEAR, shading=None)
    assert np.allclose(middle(scene.render("front", size=SIZE)), (1, 0, 0, 1), atol=1e-3)


def test_progressive_pictures_and_frames_have_geometry():
    scene = ws.Scene([box(), wall(12)], fog(0.1), shading=None)
    *_, last = ws.progressive(scene, CAMERA, size=SIZE)
    assert np.allclose(middle(last), middle(scene.render(CAMERA, size=SIZE)), atol=1e-6)
    frames = list(ws.render_frames(scene, [CAMERA, CAMERA.turned(10)], size=SIZE))
    assert all(frame.rgba[20, 24, 0] > 0.3 for frame in frames)


def test_the_ray_caster_meets_the_same_geometry():
    fog = ws.Volume(np.full((24, 24, 24), 100.0, np.float32), anatomical=False)
    haze = ws.TransferFunction([(0, 0.02), (200, 0.02)], [(0, 0.9, 0.9, 0.9), (200, 0.9, 0.9, 0.9)])
    middle = np.array(fog.bounds).mean(axis=0)
    geometry = [
        ws.Points([middle + np.array([4, 0, 0])], radius=3, color="red"),
        ws.Lines([middle - 9, middle + 9], radius=1, color="blue", opacity=0.5),
    ]
    scene = ws.Scene(fog, haze, geometry=geometry)
    eye = ws.Camera.orbit(fog, 30, 20)
    ours = scene.render(eye, size=(96, 96), quality="high").rgba
    theirs = ws.reference.raycast(scene, camera=eye, size=(96, 96), step=0.25, rays_per_pixel=9).rgba
    psnr = -10 * np.log10(np.mean((ours - theirs) ** 2))
    assert psnr > 45, psnr
    alone = ws.reference.raycast(fog, haze, eye, size=(96, 96), step=0.25, geometry=geometry).rgba
    assert np.abs(alone - theirs).mean() < 0.01
    with pytest.raises(ws.errors.ArgumentError, match="its own looks, labels, clipping and geometry"):
        ws.reference.raycast(scene, camera=eye, size=(8, 8), geometry=geometry)
