"""Numbers and titles of frames, names of points: where they are written, and in which files."""

from __future__ import annotations

import re

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._geometry.text_marks import marks_in_space
from wavesplat._picture.marks import WHITE, Polygon, Style, Text

SIZE = (400, 300)
CLEAR = ws.TransferFunction([(0, 0.0)], [(0, 1, 1, 1)])
BOUNDS = np.array([(0.0, 0, 0), (100, 50, 80)])
FRONT = ws.Camera((50, 300, 40), (50, 25, 40), (0, 0, 1), parallel_scale=70)


def volume(**options):
    return ws.Volume(np.zeros((9, 6, 11), np.float32), spacing=(10, 10, 10), **options)


def written(shapes, camera=FRONT, size=SIZE, unit="um", is_anatomical=False):
    style = Style(14, WHITE).on_picture()
    return marks_in_space(shapes, camera, size, style, bounds=BOUNDS, unit=unit, is_anatomical=is_anatomical)


def texts(marks):
    return {mark.text: mark for mark in marks if isinstance(mark, Text)}


def test_numbers_stand_at_their_places():
    found = texts(written([ws.Frame()]))
    assert {"0", "20", "40", "60", "80", "100", "x (µm)", "z (µm)"} >= set(found) - {"y (µm)"}
    # Of x below the box, which this view shows with x to the left.
    places = {value: FRONT.project([(value, 25, 0)], size=SIZE)[0][0] for value in (20, 100)}
    marks = [mark for mark in written([ws.Frame()]) if isinstance(mark, Text)]
    for value, (column, row) in places.items():
        near = [mark for mark in marks if mark.text == str(value) and mark.y > row]
        (mark,) = near
        assert abs(mark.x + 10 - column) < 14
    ticks = [mark for mark in written([ws.Frame()]) if isinstance(mark, Polygon)]
    assert len(ticks) == 6 + 5  # y is seen from its end


def test_axes_of_patients_have_letters_and_units_may_be_left_out():
    assert "R (mm)" in texts(written([ws.Frame()], unit="mm", is_anatomical=True))
    assert "x" in texts(written([ws.Frame(units=False)]))
    assert "x" in texts(written([ws.Frame()], unit=None))
    assert written([ws.Frame(ticks=False)]) == ()


@pytest.mark.parametrize("azimuth", range(0, 360, 40))
@pytest.mark.parametrize("elevation", [-60, -20, 0, 35, 80])
@pytest.mark.parametrize("angle", [None, 40])
def test_nothing_is_written_over_something_else_or_beyond_the_picture(azimuth, elevation, angle):
    box = volume()
    camera = ws.Camera.orbit(box, azimuth, elevation, zoom=0.8, view_angle=angle)
    names = ws.Points(np.random.default_rng(azimuth).random((30, 3)) * 100, labels=[f"P{k}" for k in range(30)])
    marks = [mark for mark in written([ws.Frame(), names], camera) if isinstance(mark, Text)]
    from wavesplat._picture.lettering import CAP_HEIGHT, text_width

    boxes = [(m.x, m.y - CAP_HEIGHT * m.size, m.x + text_width(m.text, m.size), m.y) for m in marks]
    assert len(boxes) > 10
    for k, (left, top, right, bottom) in enumerate(boxes):
        assert left >= 0
        assert top >= 0
        assert right <= SIZE[0]
        assert bottom <= SIZE[1]
        assert not any(left < c and a < right and top < d and b < bottom for a, b, c, d in boxes[:k])
    # Each axis that is seen from the side has its title.
    assert sum("µm" in mark.text for mark in marks) >= 2


def test_an_eye_in_the_box_sees_no_numbers():
    inside = ws.Camera((50, 25, 40), (50, 0, 40), (0, 0, 1), view_angle=60)
    assert written([ws.Frame()], inside) == ()


def test_names_stand_beside_their_points_and_give_way_to_nearer_ones():
    points = ws.Points([(50, 20, 40), (50, 30, 40), (20, 25, 40)], labels=["far", "near", "other"], radius=5)
    found = texts(written([points]))
    (at, _, other), _ = FRONT.project(points.positions, size=SIZE)
    radius_px = 5 * SIZE[1] / 140
    assert abs(found["near"].x - (at[0] + 0.5 + radius_px + 0.35 * 14)) < 0.01
    assert found["near"].y == pytest.approx(at[1] + 0.5 + 0.345 * 14, abs=0.1)
    assert found["far"].x < at[0]  # on the other side, since the nearer one has this
    assert abs(found["other"].y - found["near"].y) < 0.01
    assert found["other"].x > other[0]
    behind = ws.Camera((50, 300, 40), (50, 500, 40), (0, 0, 1), view_angle=30)
    assert written([points], behind) == ()


def test_pictures_carry_text_in_their_pixels_and_apart():
    scene = ws.Scene(volume(unit="um", name="cells"), CLEAR, background="black")
    named = scene.with_(geometry=ws.Points([(50, 25, 40)], labels=["A1"], opacity=0.01))
    bare = scene.with_(geometry=ws.Points([(50, 25, 40)], opacity=0.01))
    with_text, without = (one.render(FRONT, size=SIZE) for one in (named, bare))
    changed = (with_text.rgba != without.rgba).any(axis=2)
    rows, columns = np.nonzero(changed)
    assert 20 < changed.sum() < 2000
    assert abs(columns.min() - 200) < 20
    assert abs(rows.mean() - 150) < 5
    assert np.array_equal(with_text._in_space.rgba, without.rgba)


def test_files_of_vectors_have_text(tmp_path):
    scene = ws.Scene([volume(unit="um"), ws.Frame()], CLEAR, background="black")
    picture = scene.render(FRONT, size=SIZE)
    picture.save(tmp_path / "a.svg")
    plain = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert re.search(r">x \(µm\)<", plain)
    figure = picture.annotated(scale_bar=True, title="Box")
    figure.save(tmp_path / "b.svg")
    whole = (tmp_path / "b.svg").read_text(encoding="utf-8")
    assert re.search(r">x \(µm\)<", whole)
    assert re.search(r">Box<", whole)
    # In pixels all is drawn once, whichever way it came there.
    arrows = picture.annotated(orientation="axes").rgba
    assert np.abs(arrows[:150] - picture.rgba[:150]).max() < 1e-6
    assert (arrows[150:] != picture.rgba[150:]).any()


def test_cameras_leave_room_for_numbers():
    scene = ws.Scene([volume(unit="um"), ws.Frame()], CLEAR)
    marks = scene.render("front", size=SIZE)._in_space.marks
    assert {"x (µm)", "z (µm)", "0", "100"} <= set(texts(marks))


def test_two_eyes_have_no_text():
    scene = ws.Scene([volume(unit="um"), ws.Frame()], CLEAR)
    picture = scene.render("front", size=SIZE, stereo="side-by-side")
    assert picture._in_space is None
    (note,) = [note for note in picture.report["notes"] if "numbers" in note]
    assert note.startswith("numbers of frames and names of points are not written in pictures of two eyes")
