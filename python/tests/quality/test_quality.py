"""The fast renderer against the converged ray caster, on small pictures at the magnification of large ones.

The full table at 512 x 512 is printed by `make quality`.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

import wavesplat as ws

# A part of the view, 96 pixels wide, at the scale of 512 pixels for the whole volume.
SIZE = (96, 96)
ZOOM = 512 / 96

COLORS = [(0.0, 0.2, 0.3, 0.8), (0.4, 0.9, 0.6, 0.4), (0.6, 1.0, 0.95, 0.85), (1.0, 1.0, 1.0, 1.0)]


def colors(low: float, high: float) -> list[tuple[float, float, float, float]]:
    return [(low + t * (high - low), r, g, b) for t, r, g, b in COLORS]


# With a hard step the converged picture has finer steps than 0.05 voxels: a ray with such steps meets the surface
# 0.025 voxels late on average, and misses grazing ones.
SCENES = {
    "ct": (ws.examples.ct_pelvis, [(-75, 0), (255, 0.05), (1000, 0.2)], [(199, 0), (200, 1)], colors(-1000, 1000), 38),
    "mri": (ws.examples.mri_head, [(28, 0), (69, 0.05), (110, 0.2)], [(49, 0), (50, 1)], colors(0, 110), 38),
    "ripples": (ws.examples.ripples, [(60, 0), (128, 0.05), (255, 0.2)], [(127, 0), (128, 1)], colors(0, 255), 34),
}

# Azimuth, elevation, view angle: oblique, each along another axis of the grid for the most part.
VIEWS = [(20, 15, None), (-65, -20, 30.0), (35, 60, None)]


def psnr_db(got: np.ndarray, want: np.ndarray) -> float:
    return float(-10 * np.log10(np.mean((got[..., :3].astype(float) - want[..., :3]) ** 2)))


def cast(*scene, **options):
    """The converged picture, drawn only where it is not read from its file."""
    return lambda: ws.reference.raycast(*scene, **options).rgba


#: A light whose gradients the ray caster takes twenty times as fast as smoothed ones, which have a test of their own.
HEADLIGHT = ws.Shading.headlight()


@pytest.fixture(scope="module", params=SCENES)
def scene(request: pytest.FixtureRequest):
    make, soft, hard, curve, hard_goal = SCENES[request.param]
    return request.param, make(), ws.TransferFunction(soft, curve), ws.TransferFunction(hard, curve), hard_goal


def camera(volume: ws.Volume, view: tuple[float, float, float | None]) -> ws.Camera:
    azimuth, elevation, view_angle = view
    return ws.Camera.orbit(volume, azimuth, elevation, zoom=ZOOM, view_angle=view_angle, fit="view")


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize(("shading", "goals_db"), [(HEADLIGHT, (40, 45)), (None, (45, 50))])
def test_soft_pictures(scene, view, shading, goals_db, kept_picture):
    scan, volume, soft, _, _ = scene
    name = f"soft {scan} {view} {'lit' if shading else 'unlit'}"
    view = camera(volume, view)
    want = kept_picture(name, cast(volume, soft, view, size=SIZE, step=0.05, shading=shading))
    for quality, goal_db in zip(("normal", "high"), goals_db, strict=True):
        got = ws.render(volume, soft, view, size=SIZE, shading=shading, quality=quality).rgba
        assert psnr_db(got, want) >= goal_db, quality
    assert got[..., 3].mean() > 0.2, "the view shows the volume"


def test_pictures_in_the_usual_light(scene, kept_picture):
    scan, volume, soft, _, _ = scene
    view = ws.Camera.orbit(volume, 30, 20, fit="view")
    want = kept_picture(f"usual light {scan}", cast(volume, soft, view, size=(36, 30), step=0.1, rays_per_pixel=9))
    got = ws.render(volume, soft, view, size=(36, 30), quality=ws.Sampling(4, 2)).rgba
    assert psnr_db(got, want) > 40


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.every_pair
def test_hard_pictures(scene, view, kept_picture):
    scan, volume, _, hard, goal_db = scene
    name = f"hard {scan} {view}"
    view = camera(volume, view)
    want = kept_picture(name, cast(volume, hard, view, size=SIZE, step=0.01, rays_per_pixel=16, shading=HEADLIGHT))
    got = ws.render(volume, hard, view, size=SIZE, quality="high", shading=HEADLIGHT).rgba
    assert psnr_db(got, want) >= goal_db
    assert got[..., 3].mean() > 0.2, "the view shows the volume"


@pytest.mark.parametrize("view_angle", [None, 25.0])
@pytest.mark.every_pair
def test_a_wanted_psnr_is_reached(scene, view_angle, kept_picture):
    scan, volume, soft, _, _ = scene
    view = ws.Camera.orbit(volume, 30, 20, view_angle=view_angle, fit="view")
    size = (96, 80)
    draw = cast(volume, soft, view, size=size, step=0.05, rays_per_pixel=16, shading=HEADLIGHT)
    want = kept_picture(f"wanted psnr {scan} {view_angle}", draw)
    effort = []
    for wanted_db in (38, 44, 50):
        picture = ws.render(volume, soft, view, size=size, psnr=wanted_db, shading=HEADLIGHT)
        report = picture.report
        assert report["expected_psnr_db"] >= wanted_db
        assert psnr_db(picture.rgba, want) > wanted_db - 1
        assert 0 < report["expected_psnr_spread_db"] < 4
        effort.append(report["sheets_per_slice"] * report["oversampling"] ** 2)
    assert effort[0] < effort[1] < effort[2]


# Neither views nor functions of `benches/cases.toml`. Azimuth, elevation, view angle; the first two look along an axis,
# where cut faces lie along the texels.
HELD_OUT_VIEWS = [(0, 0, None), (90, 0, None), (-130, 50, None), (200, -35, 30.0)]
HELD_OUT_CURVES = {
    "ct": ([(-200, 0), (100, 0.02), (700, 0.4)], [(299, 0), (300, 1)]),
    "mri": ([(15, 0), (50, 0.02), (90, 0.3)], [(34, 0), (35, 1)]),
}


@pytest.mark.parametrize("view", HELD_OUT_VIEWS)
@pytest.mark.parametrize("is_hard", [False, True])
@pytest.mark.parametrize("name", HELD_OUT_CURVES)
def test_the_promise_of_a_psnr_holds_to_a_decibel(name, is_hard, view, kept_picture):
    make, _, _, curve, _ = SCENES[name]
    volume = make()
    function = ws.TransferFunction(HELD_OUT_CURVES[name][is_hard], curve)
    azimuth, elevation, view_angle = view
    eye = ws.Camera.orbit(volume, azimuth, elevation, view_angle=view_angle, fit="view")
    shown = {"size": (112, 96), "shading": HEADLIGHT}
    # With sixteen rays a pixel the caster has an error of its own, 40 dB where pixels are four samples wide.
    want = kept_picture(
        f"promise {name} {view} {'hard' if is_hard else 'soft'}",
        lambda: ws.render(volume, function, eye, **shown, quality=ws.Sampling(24, 8)).rgba,
    )
    for wanted_db in (30, 40, 50):
        picture = ws.render(volume, function, eye, psnr=wanted_db, **shown)
        told_db, spread_db = (picture.report[f"expected_psnr_{name}"] for name in ("db", "spread_db"))
        reached_db = psnr_db(picture.rgba, want)
        print(f"{name} {is_hard=} {view} {wanted_db}: reached {reached_db:.1f}, told {told_db:.1f} +- {spread_db:.1f}")
        # Where a PSNR cannot be promised, the report says so.
        assert reached_db > min(wanted_db, told_db - spread_db) - 1, (wanted_db, told_db, spread_db)


def test_frames_like_the_first_are_drawn_by_what_it_measured(scene, kept_picture):
    scan, volume, soft, _, _ = scene
    shown = {"size": (96, 80), "shading": HEADLIGHT}
    scene = ws.Scene(volume, soft, shading=shown.pop("shading"))
    first = scene.render(ws.Camera.orbit(volume, 30, 20, fit="view"), **shown, psnr=38)
    assert json.loads(json.dumps(first.report["measured"])) == first.report["measured"]
    view = ws.Camera.orbit(volume, 40, 10, fit="view")
    converged = {"camera": view, **shown, "quality": ws.Sampling(24, 8)}
    want = kept_picture(f"frame {scan}", lambda: scene.render(**converged).rgba)
    for wanted_db in (38, 44):
        frame = scene.render(view, **shown, psnr=wanted_db)
        assert frame.report["expected_psnr_db"] >= wanted_db
        assert frame.report["expected_psnr_spread_db"] > first.report["expected_psnr_spread_db"]
        fixed = ws.Sampling(frame.report["sheets_per_slice"], frame.report["oversampling"])
        np.testing.assert_array_equal(frame.rgba, scene.render(view, **shown, quality=fixed).rgba)
        assert psnr_db(frame.rgba, want) > wanted_db - frame.report["expected_psnr_spread_db"]
        # Measured errors are passed from frame to frame.
        again = scene.render(view, **shown, psnr=wanted_db)
        np.testing.assert_array_equal(again.rgba, frame.rgba)


def test_what_shows_something_else_is_measured_anew():
    """This holds for another operator, kernel, look or light, and for another scene."""
    signs = ws.TransferFunction.diverging(300)
    scene = ws.Scene(ws.examples.ripples(16), signs)
    draw = {"size": (24, 24), "psnr": 40}

    def spread(of, **options):
        return of.render(**draw, **options).report["expected_psnr_spread_db"]

    first, second = spread(scene), spread(scene)
    assert first == second, "the same picture is as certain as before"
    cut = scene.with_(background="white", clip=ws.Crop((0, 0, 0), (15, 15, 14)))
    assert spread(cut) > first
    for other in ({"composite": "mean"}, {"kernel": "bspline3"}):
        assert spread(scene, **other) == spread(ws.Scene(scene.layers), **other)
    for changes in (
        {"shading": None},
        {"layers": ws.Layer(scene.layers[0].volume, ws.TransferFunction.diverging(200))},
    ):
        fresh = ws.Scene(changes.get("layers", scene.layers), shading=changes.get("shading", "look"))
        assert spread(scene.with_(**changes)) == spread(fresh)
    assert spread(ws.Scene(ws.examples.ripples(16), signs)) == first


def test_a_psnr_costs_nothing_where_nothing_is_seen_and_what_is_out_of_reach_is_said():
    volume = ws.Volume(np.zeros((8, 8, 8), np.float32))
    clear = ws.TransferFunction([(0, 0.0), (1, 0.0)], [(0, 1, 1, 1), (1, 1, 1, 1)])
    report = ws.render(volume, clear, size=(40, 30), psnr=60).report
    assert report["expected_psnr_db"] > 80
    assert report["measured"] is None
    volume = ws.examples.ripples(16)
    hard = ws.TransferFunction([(127, 0.0), (128, 1.0)], [(0, 1, 1, 1)])
    report = ws.render(volume, hard, size=(64, 64), psnr=80).report
    assert report["expected_psnr_db"] < 80


@pytest.mark.parametrize("psnr", [5, 100, float("nan")])
def test_a_psnr_that_makes_no_sense_is_refused(psnr):
    with pytest.raises(ws.errors.ArgumentError, match="between 20 and 80 dB"):
        ws.render(ws.examples.ripples(8), psnr=psnr)
    with pytest.raises(ws.errors.ArgumentError, match="leave out either"):
        ws.render(ws.examples.ripples(8), psnr=40, quality=ws.Sampling(oversampling=2))
