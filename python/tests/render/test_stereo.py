"""Pictures for two eyes, and panoramas: where known points land, parallax by the formula, seams, documents, movies."""

import json
from math import asin, atan2, degrees, hypot, pi, radians, tan

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import wavesplat as ws
from wavesplat._cli import app
from wavesplat._model.camera.fit import within
from wavesplat._model.camera.stereo import Eyes
from wavesplat._movie.turn import cameras_of
from wavesplat._native import Face
from wavesplat._render import eyes as eye_pictures

#: A point: opaque where it is brightest, in a volume whose world is its index.
POINT = ws.TransferFunction([(0.2, 0.0), (1.0, 1.0)], [(0.0, 1.0, 1.0, 1.0)])
MIDDLE = 20.0


def point_at(x, y, z, n=41):
    samples = np.zeros((n, n, n), np.float32)
    samples[z, y, x] = 1
    return ws.Volume(samples)


def place_of(rgba):
    """Column and row of the middle of what is bright."""
    alpha = rgba[..., 3].astype(float)
    rows, columns = np.indices(alpha.shape)
    return (alpha * columns).sum() / alpha.sum(), (alpha * rows).sum() / alpha.sum()


def folds(n=49):
    z, y, x = np.mgrid[-1 : 1 : n * 1j, -1 : 1 : n * 1j, -1 : 1 : n * 1j]
    return ws.Volume(((np.sin(5 * x) * np.cos(4 * y) * np.sin(6 * z) + 1) / 2).astype(np.float32))


FOLDS = ws.TransferFunction([(0.5, 0), (0.9, 0.5)], [(0, 0.2, 0.3, 1), (1, 1, 0.6, 0.1)])


@pytest.fixture
def with_faces(monkeypatch):
    """Draws a panorama of other faces, from the middle, whose horizon leans."""
    eye = within(ws.Camera.view(folds(), "isometric", view_angle=30), is_level=False)

    def draw(faces, **options):
        monkeypatch.setattr(eye_pictures, "_faces", lambda _: faces)
        return ws.render(
            folds(), FOLDS, eye, panorama=True, background="white", size=(512, 256), device="cpu", **options
        )

    return draw


# Two eyes


@pytest.mark.parametrize("depth", [14, 20, 29])
def test_parallax_follows_the_formula(depth):
    # The eye 60 above the point's volume looks down z; convergence 60 is the plane z = 20.
    camera = ws.Camera((20, 20, 80), (20, 20, 20), (0, 1, 0), view_angle=30)
    pair = ws.Stereo("side-by-side", eye_distance=8, convergence=60)
    options = {"size": (800, 400), "stereo": pair, "quality": "high", "device": "cpu"}
    picture = ws.render(point_at(20, 20, depth), POINT, camera, shading=None, **options)
    left, right = place_of(picture.rgba[:, :400])[0], place_of(picture.rgba[:, 400:])[0]
    told = picture.report["stereo"]
    per_tangent = 400 / (2 * tan(radians(15)))
    assert told["convergence"] == pytest.approx(60, abs=0.5 * 60 / (per_tangent * 8 / 60))  # half a pixel
    assert left - right == pytest.approx(per_tangent * 8 * (1 / (80 - depth) - 1 / told["convergence"]), abs=0.1)


def test_eyes_look_in_parallel_and_see_the_window_of_one_eye():
    # Off-axis, not toed in: a plane of points at the convergence is seen alike, also in the corners.
    samples = np.zeros((3, 41, 41), np.float32)
    samples[1, 5::10, 5::10] = 1
    volume = ws.Volume(samples)
    camera = ws.Camera((20, 20, 81), (20, 20, 1), (0, 1, 0), view_angle=30)
    options = {"size": (300, 300), "shading": None, "device": "cpu", "quality": "high"}
    per_tangent = 150 / tan(radians(15))
    pair = ws.Stereo("left", eye_distance=24 * 80 / per_tangent, convergence=80)  # a whole number of pixels
    one = ws.render(volume, POINT, camera, **options)
    left = ws.render(volume, POINT, camera, stereo=pair, **options)
    assert left.report["stereo"]["convergence"] == pytest.approx(80)
    points = [(x, y, 1) for x in range(5, 41, 10) for y in range(5, 41, 10)]
    for column, row in np.rint(camera.project(points, size=(300, 300))[0]).astype(int):
        there = np.s_[row - 20 : row + 21, column - 20 : column + 21]
        assert place_of(left.rgba[there]) == pytest.approx(place_of(one.rgba[there]), abs=0.1)


def test_layouts_are_of_the_same_two_pictures():
    volume, size = folds(), (64, 48)
    drawn = {
        layout: ws.render(volume, FOLDS, "front", stereo=layout, size=given, depth=True, device="cpu")
        for layout, given in {
            "left": size,
            "right": size,
            "side-by-side": (128, 48),
            "top-bottom": (64, 96),
            "anaglyph": size,
        }.items()
    }
    left, right = drawn["left"], drawn["right"]
    assert not np.array_equal(left.rgba, right.rgba)
    assert np.array_equal(drawn["side-by-side"].rgba, np.hstack([left.rgba, right.rgba]))
    assert np.array_equal(drawn["side-by-side"].depth, np.hstack([left.depth, right.depth]), equal_nan=True)
    assert np.array_equal(drawn["top-bottom"].rgba, np.vstack([left.rgba, right.rgba]))
    anaglyph = drawn["anaglyph"].rgba
    grey = left.rgba[..., :3] @ np.array([0.299, 0.587, 0.114], np.float32)
    assert np.allclose(anaglyph[..., 0], 0.65 * left.rgba[..., 0] + 0.35 * grey, atol=1e-6)
    assert drawn["anaglyph"].depth is None
    # Associated colours never exceed the opacity.
    assert (anaglyph[..., :3] <= anaglyph[..., 3:] + 1e-6).all()


def test_distances_have_the_defaults_of_vtk_and_views_without_perspective_get_one():
    volume = folds()
    picture = ws.render(volume, FOLDS, "front", stereo="left", size=(64, 64))
    camera = picture.camera
    apart = np.linalg.norm(np.subtract(camera.position, camera.focal_point))
    assert picture.report["stereo"]["eye_distance"] == pytest.approx(2 * apart * tan(radians(1)))
    flat = ws.Camera.view(volume, "front")
    eye = ws.render(volume, FOLDS, flat, stereo="left", size=(64, 64))
    half = np.linalg.norm(np.subtract(eye.camera.position, eye.camera.focal_point)) * tan(radians(15))
    assert half == pytest.approx(flat.parallel_scale)
    assert eye.pixel == pytest.approx(ws.render(volume, FOLDS, flat, size=(64, 64)).pixel)


def test_what_cannot_be_is_refused():
    volume = folds(9)
    with pytest.raises(ws.errors.ArgumentError, match="is 'red'; use one of: side-by-side"):
        ws.Stereo("red")
    with pytest.raises(ws.errors.ArgumentError, match="eye_distance of the stereo is -1; give a positive number"):
        ws.Stereo(eye_distance=-1)
    with pytest.raises(ws.errors.ArgumentError, match=r"size is 33 x 32, .* give an even number"):
        ws.render(volume, FOLDS, stereo="side-by-side", size=(33, 32))
    with pytest.raises(ws.errors.ArgumentError, match="eye_distance is 9 and convergence 2 .* give less"):
        ws.render(volume, FOLDS, stereo=ws.Stereo("left", 9, 2), size=(32, 32))
    with pytest.raises(ws.errors.ArgumentError, match="convergence is of flat pictures"):
        ws.render(volume, FOLDS, panorama=True, stereo=ws.Stereo("left", 1, 2), size=(32, 16))
    with pytest.raises(ws.errors.ArgumentError, match="depth-shaded-maximum shows depths along one line of sight"):
        ws.render(volume, FOLDS, panorama=True, composite="depth-shaded-maximum", size=(32, 16))
    with pytest.raises(ws.errors.ArgumentError, match="stereo is 3; give a wavesplat.Stereo"):
        ws.render(volume, FOLDS, stereo=3, size=(32, 32))
    with pytest.raises(ws.errors.ArgumentError, match="panorama is 'yes'; give True or False"):
        ws.render(volume, FOLDS, panorama="yes", size=(32, 32))


def test_greys_that_a_view_chooses_are_the_same_for_both_eyes():
    volume = folds()
    pair = ws.render(volume, camera="front", composite="mean", stereo=ws.Stereo(eye_distance=1e-6), size=(96, 48))
    assert np.allclose(pair.rgba[:, :48], pair.rgba[:, 48:], atol=1e-4)
    assert pair.rgba[..., 0].max() > 0.5


# All around

DIRECTIONS = [
    (34, 20, 20),
    (32, 30, 20),
    (20, 6, 20),
    (8, 20, 20),
    (26, 26, 34),
    (22, 20, 36),
    (20, 26, 5),
    (30, 10, 28),
]


@pytest.mark.parametrize("at", DIRECTIONS)
@pytest.mark.parametrize("faces", ["cube", "turns"])
def test_a_point_lands_where_its_longitude_and_latitude_say(at, faces, monkeypatch):
    if faces == "turns":
        turns = Face.of_turns(8)
        monkeypatch.setattr(eye_pictures, "_faces", lambda _: turns)
    camera = ws.Camera((MIDDLE, MIDDLE, MIDDLE), (MIDDLE + 5, MIDDLE, MIDDLE), (0, 0, 1), view_angle=90)
    options = {"size": (720, 360), "quality": "high", "device": "cpu", "depth": True}
    picture = ws.render(point_at(*at), POINT, camera, shading=None, panorama=True, **options)
    ahead, left, up = np.subtract(at, MIDDLE)
    longitude, latitude = -degrees(atan2(left, ahead)), degrees(atan2(up, hypot(ahead, left)))
    # Turned so that the point is not cut at the edge.
    alpha = np.roll(picture.rgba, 360 - round((longitude + 180) * 2), axis=1)
    column, row = place_of(alpha)
    found = (column + 0.5 + round((longitude + 180) * 2) - 360) / 2 - 180, 90 - (row + 0.5) / 2
    assert found[1] == pytest.approx(latitude, abs=0.6)
    assert (found[0] - longitude) * np.cos(radians(latitude)) == pytest.approx(0, abs=0.6)
    distance = np.linalg.norm(np.subtract(at, MIDDLE))
    assert np.nanmin(picture.depth) == pytest.approx(distance, abs=1.5)


def test_seams_of_the_cube_do_not_show(with_faces):
    # Against twice as many pictures of half the angle, whose seams are elsewhere.
    cube = with_faces(Face.of_cube(), quality="high")
    narrow = with_faces(Face.of_turns(8), quality="high")
    levels = 255 * np.abs(cube.rgba - narrow.rgba).max(axis=-1)
    longitude, latitude = np.meshgrid((np.arange(512) + 0.5) / 512 * 360 - 180, 90 - (np.arange(256) + 0.5) / 256 * 180)
    away = np.minimum(np.abs(np.abs(longitude) - 45), np.abs(np.abs(longitude) - 135))
    upright = (away < 2) & (np.abs(latitude) < 30)
    assert np.percentile(levels, 99) < 2
    assert np.percentile(levels[upright], 99) < 2
    # Steps from column to column across a seam are those of the picture beside it.
    steps = 255 * np.abs(np.diff(cube.rgba, axis=1)).max(axis=-1)[np.abs(latitude[:, 0]) < 30]
    expected = 255 * np.abs(np.diff(narrow.rgba, axis=1)).max(axis=-1)[np.abs(latitude[:, 0]) < 30]
    seams = [63, 191, 319, 447]
    assert np.abs(steps[:, seams] - expected[:, seams]).max() < 2


def test_a_panorama_goes_on_at_its_left_edge(with_faces):
    rgba = with_faces(Face.of_cube()).rgba
    inside = np.abs(np.diff(rgba, axis=1)).max()
    assert np.abs(rgba[:, 0] - rgba[:, -1]).max() < 2 * inside


def test_light_stays_where_it_is_ahead(with_faces):
    # Of the camera's own light each picture would have another one, and seams would show.
    lit = with_faces(Face.of_cube(), shading=ws.Shading(lights=[ws.Light((1, 1, 1))]))
    narrow = with_faces(Face.of_turns(8), shading=ws.Shading(lights=[ws.Light((1, 1, 1))]))
    assert np.percentile(255 * np.abs(lit.rgba - narrow.rgba).max(axis=-1), 99) < 2.5


def test_eyes_of_a_panorama_are_beside_each_other_in_every_direction():
    camera = ws.Camera((MIDDLE, MIDDLE, MIDDLE), (MIDDLE + 5, MIDDLE, MIDDLE), (0, 0, 1), view_angle=90)
    for at in ((34, 20, 20), (30, 10, 20)):
        columns = []
        for layout in ("left", "right"):
            stereo = ws.Stereo(layout, eye_distance=2)
            options = {"size": (360, 180), "device": "cpu"}
            picture = ws.render(point_at(*at), POINT, camera, shading=None, panorama=True, stereo=stereo, **options)
            columns.append(place_of(picture.rgba)[0])
        distance = np.linalg.norm(np.subtract(at, MIDDLE))
        # The left eye sees it farther to the right, by the angle of half the distance on each side.
        assert columns[0] - columns[1] == pytest.approx(2 * asin(1 / distance) * 360 / (2 * pi), rel=0.05)


def test_a_view_by_name_is_seen_from_the_middle():
    volume = folds()
    picture = ws.render(volume, FOLDS, "front", panorama=True, size=(64, 32))
    assert np.allclose(picture.camera.position, volume.bounds.mean(axis=0), atol=1)
    ahead = np.subtract(picture.camera.focal_point, picture.camera.position)
    front = ws.Camera.view(volume, "front")
    flat = np.subtract(front.focal_point, front.position)
    assert np.allclose(ahead / np.linalg.norm(ahead), flat / np.linalg.norm(flat))
    assert picture.pixel is None
    with pytest.raises(ws.errors.ArgumentError, match="scale bar"):
        picture.annotated(scale_bar=True)


def test_panoramas_of_views_are_level_and_eyes_are_near_each_other():
    """The horizon leaned with a view from above, and eyes were as far apart as for a view of the whole box."""
    volume = folds()
    picture = ws.render(volume, FOLDS, "isometric", panorama=True, stereo="left", size=(64, 32))
    camera, above = picture.camera, ws.Camera.view(volume, "isometric")
    ahead, down = np.subtract(camera.focal_point, camera.position), np.subtract(above.focal_point, above.position)
    assert camera.view_up == (0, 0, 1)
    assert ahead[2] == 0
    assert np.allclose(ahead[:2] / np.hypot(*ahead[:2]), down[:2] / np.hypot(*down[:2]))
    half = max(np.ptp(volume.bounds, axis=0)) / 2
    assert half < np.linalg.norm(ahead) < 3 * half
    assert picture.report["stereo"]["eye_distance"] == pytest.approx(2 * np.linalg.norm(ahead) * tan(radians(1)))
    for view in ("top", "xy"):
        eye = ws.render(volume, FOLDS, view, panorama=True, size=(64, 32)).camera
        assert abs(np.subtract(eye.focal_point, eye.position)[2]) > half
    turn = ws.Turn(2, elevation=30)
    cameras = cameras_of(turn, ws.Scene(volume, FOLDS), None, 2.0, Eyes(panorama=True))
    assert np.subtract(cameras[0].focal_point, cameras[0].position)[2] < -half / 3


def test_a_panorama_that_is_not_twice_as_wide_says_so():
    notes = ws.render(folds(9), FOLDS, panorama=True, size=(64, 64)).report["notes"]
    assert any("64 x 64 pixels, which are not square" in note for note in notes)


# Doors


def test_the_document_draws_the_same_bytes(tmp_path):
    pelvis = ws.examples.ct_pelvis()
    for options in (
        {"stereo": ws.Stereo("anaglyph", eye_distance=20), "size": (48, 32)},
        {"panorama": True, "stereo": "top-bottom", "size": (64, 64)},
        {"stereo": "side-by-side", "psnr": 35, "size": (96, 48)},
    ):
        picture = ws.render(pelvis, "ct-bone", "front", device="cpu", **options)
        picture.save(tmp_path / "a.png")
        done = CliRunner().invoke(
            app, ["render", "--from", str(tmp_path / "a.png"), "-o", str(tmp_path / "b.png"), "--device", "cpu"]
        )
        assert done.exit_code == 0, done.output
        first, again = (np.asarray(Image.open(tmp_path / name)) for name in ("a.png", "b.png"))
        assert np.array_equal(first, again)


def test_the_command_line_draws_what_python_does(tmp_path):
    pelvis = ws.examples.ct_pelvis()
    pelvis.save(tmp_path / "ct.nrrd")
    volume = ws.open(tmp_path / "ct.nrrd")
    run = ["render", str(tmp_path / "ct.nrrd"), "--preset", "ct-bone", "--view", "front", "--device", "cpu", "-q"]
    run += ["--background", "transparent"]
    cases = {
        "pair": (["--stereo", "side-by-side", "--size", "96x48"], {"stereo": "side-by-side", "size": (96, 48)}),
        "apart": (
            ["--stereo", "left", "--eye-distance", "30", "--convergence", "400", "--size", "48"],
            {"stereo": ws.Stereo("left", 30, 400), "size": (48, 48)},
        ),
        "around": (["--panorama", "--size", "96x48"], {"panorama": True, "size": (96, 48)}),
    }
    for name, (arguments, options) in cases.items():
        done = CliRunner().invoke(app, [*run, *arguments, "-o", str(tmp_path / f"{name}.png")])
        assert done.exit_code == 0, done.output
        shown = ws.render(volume, "ct-bone", "front", device="cpu", **options)
        assert np.array_equal(np.asarray(Image.open(tmp_path / f"{name}.png")), np.asarray(shown)), name
    done = CliRunner().invoke(
        app, [*run, "--panorama", "--eye", "1,2,3", "--size", "32x16", "--json", "-o", str(tmp_path / "e.png")]
    )
    assert json.loads(done.output)["report"]["camera"]["position"] == [1, 2, 3]
    for wrong, message in (
        (["--eye-distance", "3"], "--eye-distance is of --stereo"),
        (["--eye", "1,2,3"], "--eye is of --panorama"),
    ):
        done = CliRunner().invoke(app, [*run, *wrong, "-o", str(tmp_path / "no.png")])
        assert message in str(done.exception)


def test_movies_have_two_eyes_and_all_around(tmp_path):
    volume = folds(17)
    ws.movie(volume, tmp_path / "pair/%d.png", ws.Turn(2, view_angle=30), FOLDS, stereo="side-by-side", size=(64, 32))
    cameras = ws.render_frames(ws.Scene(volume, FOLDS), ["front"], stereo="side-by-side", size=(64, 32))
    assert next(iter(cameras)).size == (64, 32)
    first = np.asarray(Image.open(tmp_path / "pair/0.png"))
    assert first.shape[:2] == (32, 64)
    assert not np.array_equal(first[:, :32], first[:, 32:])
    ws.movie(volume, tmp_path / "around/%d.png", ws.Turn(4), FOLDS, panorama=True, size=(64, 32), quality="high")
    frames = [np.asarray(Image.open(tmp_path / f"around/{k}.png")).astype(int) for k in range(4)]
    assert not np.array_equal(frames[0], frames[1])
    keys = [ws.KeyFrame(0, camera="front"), ws.KeyFrame(0.1, camera="left")]
    ws.movie(volume, tmp_path / "keys/%d.png", keys, FOLDS, panorama=True, size=(32, 16), fps=10)
    # Frames that show the same are kept, others are drawn.
    before = (tmp_path / "keys/0.png").stat().st_mtime_ns
    ws.movie(volume, tmp_path / "keys/%d.png", keys, FOLDS, panorama=True, size=(32, 16), fps=10, resume=True)
    assert (tmp_path / "keys/0.png").stat().st_mtime_ns == before
    stereo = {"stereo": "top-bottom", "panorama": True, "size": (32, 16)}
    ws.movie(volume, tmp_path / "keys/%d.png", keys, FOLDS, fps=10, resume=True, **stereo)
    assert (tmp_path / "keys/0.png").stat().st_mtime_ns != before


def test_pictures_that_get_better_end_with_the_pair():
    volume = folds(17)
    *_, last = ws.progressive(volume, "front", stereo="side-by-side", size=(34, 32))
    assert np.array_equal(last.rgba, ws.render(volume, camera="front", stereo="side-by-side", size=(34, 32)).rgba)
