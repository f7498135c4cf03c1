"""Figures: scale bars of the right length, letters on the right sides, and room for both."""

import numpy as np
import pytest
from figure_pictures import RED, WHITE, check_inside, drawn_in, picture, texts, without

import wavesplat as ws
from wavesplat._picture import lettering
from wavesplat._picture.marks import Polygon, Rectangle, Style, Text
from wavesplat._picture.orientation import LETTERS, cube_block, edge_letters
from wavesplat._picture.report_facts import view_of
from wavesplat._picture.scale_bar import bar_of, round_length
from wavesplat.errors import ArgumentError, FileError

# Scale bars


@pytest.mark.parametrize(
    ("near", "length"), [(1, 1), (1.4, 1), (1.5, 2), (3, 2), (3.3, 5), (73, 100), (0.04, 0.05), (1000, 1000), (8, 10)]
)
def test_bars_have_round_lengths(near, length):
    assert round_length(near) == pytest.approx(length)


@pytest.mark.parametrize("pixel", [0.5, 0.0137, 3.3, 127.0])
@pytest.mark.parametrize("background", ["white", "black", "transparent"])
def test_bars_are_as_long_as_they_say(pixel, background):
    before = picture(background, pixel=pixel)
    after = before.annotated(scale_bar=True)
    bar = after.report["scale_bar"]
    assert bar["pixels"] == pytest.approx(bar["length"] / pixel)
    assert 0.12 < bar["pixels"] / before.size[0] < 0.32
    ink = 1 if background == "black" else 0
    rows = drawn_in(before, after) & (after.rgba[..., :3] == ink).all(axis=2) & (after.rgba[..., 3] == 1)
    assert abs(rows[-60:].sum(axis=1).max() - bar["pixels"]) <= 0.5


@pytest.mark.parametrize(
    ("wanted", "unit", "text", "length"),
    [
        (True, "mm", "50 mm", 50),
        (30, "mm", "30 mm", 30),
        ("3 cm", "mm", "3 cm", 30),
        ("um", "mm", "50000 µm", 50),
        ("20000um", "mm", "20000 µm", 20),
        (True, "um", "50 µm", 50),
        (True, None, "50 units", 50),
        ("kpc", None, "50 kpc", 50),
        ("20 kpc", None, "20 kpc", 20),
        (True, "kpc", "50 kpc", 50),
        (True, "angstrom", "5 nm", 50),
    ],
)
def test_bars_read_as_they_are_wanted(wanted, unit, text, length):
    bar = bar_of(wanted, 400, 0.5, unit)
    assert (bar.text, bar.length, bar.length_px) == (text, pytest.approx(length), pytest.approx(2 * length))


def test_a_unit_reads_best():
    assert bar_of(True, 400, 25.0, "um").text == "2 mm"
    assert bar_of(True, 400, 0.025, "mm").text == "2 mm"
    assert bar_of(True, 400, 0.0025, "mm").text == "200 µm"


def test_in_perspective_the_bar_says_where_it_holds():
    camera = ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), view_angle=30)
    assert texts(picture(camera=camera.as_json()).annotated(scale_bar=True)) == ["50 mm", "at the focal point"]


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        (0, "the scale bar is 0; give a positive length"),
        (-3.0, "give a positive length"),
        ("1.2.3 mm", "give a positive length"),
        ("3 parsec", "wanted in 'parsec', but the world's unit is 'mm'"),
        (500, "the scale bar is 500, and the picture 200 mm wide"),
        ("1 um", "the scale bar is '1 um', and the picture 200 mm wide"),
    ],
)
def test_bars_that_cannot_be(wanted, message):
    with pytest.raises(ArgumentError, match=message):
        picture().annotated(scale_bar=wanted)


# Directions


@pytest.mark.parametrize(
    ("camera", "letters"),
    [
        (((0, 1, 0), (0, 0, 1)), "R L S I"),
        (((0, -1, 0), (0, 0, 1)), "L R S I"),
        (((0, 0, -1), (0, 1, 0)), "R L A P"),
        (((-1, 0, 0), (0, 0, 1)), "A P S I"),
        (((-1, 1, 0), (0, 0, 1)), "RA LP S I"),
        (((-0.5, 1, 0), (0, 0, 1)), "RA LP S I"),
        (((0, 1, 1), (0, 0, 1)), "R L PS AI"),
    ],
)
def test_letters_follow_the_camera(camera, letters):
    position, up = camera
    view = view_of({"camera": ws.Camera(position, (0, 0, 0), up, parallel_scale=1).as_json()})
    assert " ".join(edge_letters(view.right, view.up).values()) == letters
    made = picture(camera=ws.Camera(position, (0, 0, 0), up, parallel_scale=1).as_json())
    assert sorted(texts(made.annotated(orientation="letters"))) == sorted(letters.split())


def test_letters_stand_at_the_edges():
    before = picture()
    changed = drawn_in(before, before.annotated(orientation="letters"))
    for part in (changed[:, :40], changed[:, -40:], changed[:40], changed[-40:]):
        assert part.any()
    assert not changed[40:-40, 40:-40].any()


@pytest.mark.parametrize("azimuth", [0, 30, 90, 200, 315])
@pytest.mark.parametrize("elevation", [-90, -20, 0, 35, 90])
def test_the_cube_shows_the_faces_that_look_to_the_eye(azimuth, elevation):
    volume = ws.examples.ripples(8)
    camera = ws.Camera.orbit(volume, azimuth, elevation)
    to_eye = np.subtract(camera.position, camera.focal_point)
    to_eye /= np.linalg.norm(to_eye)
    block = cube_block(view_of({"camera": camera.as_json()}), Style(20, WHITE), is_anatomical=True)
    shown = {mark.text: (mark.x, mark.y) for mark in block.marks if isinstance(mark, Text)}
    want = {LETTERS[axis][int(to_eye[axis] > 0)] for axis in range(3) if abs(to_eye[axis]) >= 0.15}
    assert set(shown) == want
    for mark in block.marks:
        if isinstance(mark, Polygon):
            assert np.array(mark.points).min() >= 0
            assert np.array(mark.points).max() <= block.width


def test_letters_of_the_cube_are_not_mirrored():
    for azimuth, elevation in ((20, 15), (200, -40), (100, 60)):
        camera = ws.Camera.orbit(ws.examples.ripples(8), azimuth, elevation)
        for mark in cube_block(view_of({"camera": camera.as_json()}), Style(20, WHITE), is_anatomical=True).marks:
            if isinstance(mark, Text):
                a, b, c, d = mark.slant
                assert a * d - b * c > 0


def test_worlds_without_anatomy_have_axes():
    made = picture(anatomical=False)
    assert texts(made.annotated(orientation="cube")) == ["y"]
    assert sorted(texts(made.annotated(orientation="axes"))) == ["x", "y", "z"]
    assert sorted(texts(picture().annotated(orientation="axes"))) == ["A", "R", "S"]
    with pytest.raises(ArgumentError, match=r'orientation="cube" or "axes".*Volume\(\.\.\., anatomical=True\)'):
        made.annotated(orientation="letters")


def test_slices_tell_their_directions():
    ct = ws.examples.ct_pelvis()
    for plane, letters in (("axial", "RLAP"), ("coronal", "RLSI"), ("sagittal", "APSI")):
        figure = ws.slice(ct, plane, size=(200, 200)).annotated(orientation="letters", scale_bar=True)
        assert sorted("".join(texts(figure))) == sorted(letters + "50 mm") or figure.report["scale_bar"]["text"]
        assert set(letters) <= set("".join(texts(figure)))


# The whole


@pytest.mark.parametrize("size", [(200, 200), (500, 300), (300, 500), (2000, 1600)])
@pytest.mark.parametrize("background", ["white", "black", "transparent"])
def test_everything_together_has_room(size, background):
    labels = [{"name": "left atrial appendage", "color": [1, 0, 0]}, {"name": "aorta", "color": [0, 1, 0]}]
    before = picture(background, size, labels=labels)
    figure = before.annotated(scale_bar=True, orientation="letters", colorbar=True, legend=True, title="A title " * 9)
    check_inside(figure)
    assert (figure.depth, figure.value) == (None, None)
    width, height = figure.size
    assert (width % 2, height % 2) == (0, 0)
    corner = figure.rgba[-1, -1]
    assert corner.tolist() == {"white": [1, 1, 1, 1], "black": [0, 0, 0, 1], "transparent": [0, 0, 0, 0]}[background]


def test_a_flat_picture_grows_for_its_colour_bar():
    figure = picture(size=(300, 40)).annotated(colorbar=True)
    assert figure.size[1] > 40
    check_inside(figure)


def test_what_is_on_the_picture_leaves_its_size():
    before = picture()
    for options in ({"scale_bar": True}, {"orientation": "cube"}, {"colorbar": True, "colorbar_at": "upper right"}):
        assert before.annotated(**options).size == before.size
    assert before.annotated(colorbar=True).size[1] == before.size[1]
    assert before.annotated().rgba.tolist() == before.rgba.tolist()


def test_corners_are_where_they_are_wanted():
    before = picture()
    places = {"lower left": (1, 0), "lower right": (1, 1), "upper left": (0, 0), "upper right": (0, 1)}
    for corner, (down, across) in places.items():
        y, x = np.nonzero(drawn_in(before, before.annotated(scale_bar=True, scale_bar_at=corner)))
        assert (y.mean() > 150, x.mean() > 200) == (down, across)
    figure = before.annotated(scale_bar=True, orientation="cube", orientation_at="lower left")
    bar = next(mark for mark in figure._canvas.marks if isinstance(mark, Rectangle))
    faces = [mark for mark in figure._canvas.marks if isinstance(mark, Polygon)]
    assert max(y for face in faces for _, y in face.points) < bar.y


def test_ink_contrasts_with_the_background():
    for background, ink in (("white", 0.0), ("black", 1.0), ("transparent", 0.0)):
        figure = picture(background).annotated(title="I", font_size=50)
        title = figure.rgba[: figure.size[1] - 300]
        assert title[title[..., 3] == 1][:, 0].tolist().count(ink) > 5
    figure = picture().annotated(title="I", font_size=50, color="#ff0000")
    assert (figure.rgba[..., :3] == RED).all(axis=2).any()


def test_fonts_are_in_points_where_dpi_is_given():
    small, large = (picture().annotated(title="I", font_size=12, dpi=dpi)._canvas.marks[0].size for dpi in (72, 144))
    assert (small, large) == (15, 30)


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("pixel", {"scale_bar": True}, r'does not say how far its pixels are apart.*report={"pixel": 0\.5'),
        ("camera", {"orientation": "letters"}, r"does not say from where it was taken.*camera\.as_json\(\)"),
        ("shown", {"colorbar": True}, "does not say which colours its values have"),
    ],
)
def test_missing_facts_are_named(name, options, message):
    with pytest.raises(ArgumentError, match=message):
        without(name).annotated(**options)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"orientation": "sphere"}, "orientation is 'sphere'; use one of: letters, cube, axes"),
        ({"colorbar": True, "colorbar_at": "left"}, "colorbar_at is 'left'; use one of: beside, lower left"),
        ({"scale_bar": True, "scale_bar_at": "beside"}, "scale_bar_at is 'beside'; use one of: lower left"),
        ({"font_size": 0}, "font_size is 0; give 1 to 1000"),
        ({"dpi": 0.1}, "dpi is 0.1; give pixels per inch"),
        ({"unit": "um", "scale_bar": True}, "unit is 'um', but the file's is 'mm'"),
        ({"title": "脑"}, "the title has signs that the typeface does not: 脑; give font="),
        ({"color": "reddish"}, "color is 'reddish'"),
        ({"scale_bar": True, "font_size": 200}, "has no room for a scale bar"),
        ({"legend": 3}, "legend is 3; give True"),
    ],
)
def test_wishes_that_cannot_be(options, message):
    labels = [{"name": "liver", "color": [1, 0, 0]}]
    with pytest.raises(ArgumentError, match=message):
        picture(labels=labels).annotated(**options)


def test_a_typeface_can_be_given(tmp_path):
    copy = tmp_path / "font.ttf"
    copy.write_bytes(lettering.OURS.read_bytes())
    ours, given = (picture().annotated(title="I", font=font).rgba for font in (None, copy))
    np.testing.assert_array_equal(ours, given)
    (tmp_path / "bad.ttf").write_bytes(b"no font")
    with pytest.raises(FileError, match=r"this is no font.*bad\.ttf$"):
        picture().annotated(title="I", font=tmp_path / "bad.ttf")
    with pytest.raises(FileError, match="there is no font"):
        picture().annotated(title="I", font=tmp_path / "none.ttf")
