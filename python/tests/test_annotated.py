"""Figures: bars of the right length, letters of the right side, colours of the right value, in pixels and vectors."""

import io
import re
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from PIL import Image

import wavesplat as ws
from wavesplat._picture import color_bar, lettering, raster
from wavesplat._picture.marks import UPWARDS, Canvas, Polygon, Ramp, Rectangle, Text, disc
from wavesplat._picture.orientation import LETTERS, cube_block, edge_letters
from wavesplat._picture.report_facts import View, shown_layer, view_of
from wavesplat._picture.scale_bar import bar_of, round_length
from wavesplat._picture.style import Style
from wavesplat.errors import ArgumentError, FileError, LibraryError

GREYS = ws.TransferFunction([(0, 1), (1000, 1)], [(0, 0, 0, 0), (1000, 1, 1, 1)])
BONE = ws.TransferFunction([(150, 0), (400, 0.8)], [(150, 0.8, 0.5, 0.3), (400, 1, 1, 0.9)])
CAMERA = ws.Camera((0, 500, 0), (0, 0, 0), (0, 0, 1), parallel_scale=100)
ALPHA = "\N{GREEK SMALL LETTER ALPHA}"
RED, GREEN, WHITE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, 1.0)


def picture(background="white", size=(400, 300), **facts):
    """A disc on a background, with what a report would say."""
    width, height = size
    y, x = np.mgrid[:height, :width]
    rgba = np.zeros((height, width, 4), np.float32)
    if background != "transparent":
        rgba[:] = (1, 1, 1, 1) if background == "white" else (0, 0, 0, 1)
    rgba[np.hypot(y - height / 2, x - width / 2) < height / 3] = (0.4, 0.5, 0.6, 1)
    report = {"pixel": 0.5, "unit": "mm", "anatomical": True, "camera": CAMERA.as_json(), "background": background}
    report["shown"] = [shown_layer("ct.nii.gz", "over", BONE, "HU")]
    return ws.Picture(rgba, report=report | facts)


def without(name):
    made = picture()
    del made.report[name]
    return made


def drawn_in(before, after):
    """Where pixels changed, as a mask of the first picture's size."""
    height, width = before.rgba.shape[:2]
    return (before.rgba != after.rgba[-height:, :width]).any(axis=2)


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


# Colours


@pytest.mark.parametrize(
    ("low", "high", "most", "ticks"),
    [
        (0, 1000, 5, [0, 250, 500, 750, 1000]),
        (150, 400, 6, [150, 200, 250, 300, 350, 400]),
        (-10, 10, 5, [-10, -5, 0, 5, 10]),
        (0.1, 0.13, 4, [0.1, 0.11, 0.12, 0.13]),
        (3, 4, 2, [3, 4]),
    ],
)
def test_ticks_are_round(low, high, most, ticks):
    assert color_bar.round_ticks(low, high, most) == pytest.approx(ticks)


def test_a_bar_has_the_colours_of_the_function():
    scale = color_bar.scale_of(BONE, "over", "HU", WHITE)
    assert (scale.low, scale.high) == (150, 400)
    canvas = Canvas(40, 500, np.zeros((1, 1, 4), np.float32), marks=(Ramp(0, 0, 40, 500, scale.stops),))
    column = raster.drawn(canvas)[:, 20]
    values = 150 + 250 * (1 - (np.arange(500) + 0.5) / 500)
    np.testing.assert_allclose(column[:, :3], BONE(values)[:, :3], atol=1e-6)


def test_steps_stay_sharp():
    function = ws.TransferFunction([(0, 1), (10, 1)], [(0, *RED), (4, *RED), (4, *GREEN), (10, *GREEN)])
    stops = color_bar.scale_of(function, "over", "", WHITE).stops
    assert [(round(place, 6), np.round(color, 6).tolist()) for place, color in stops][1:3] == [
        (0.4, [1, 0, 0]),
        (0.4, [0, 1, 0]),
    ]


def test_bars_of_projections_show_opacity_and_others_do_not():
    faint = ws.TransferFunction([(0, 0), (10, 0.5)], [(0, *RED), (10, *RED)])
    mixed, projected = (color_bar.scale_of(faint, name, "", WHITE).stops for name in ("over", "maximum"))
    np.testing.assert_allclose(mixed[-1][1], RED, atol=1e-6)
    np.testing.assert_allclose(projected[0][1], WHITE, atol=1e-6)
    np.testing.assert_allclose(projected[-1][1], (1, 0.5, 0.5), atol=1e-6)


def test_what_nothing_is_seen_of_is_left_out():
    nodes = [(-1000, 0), (-50, 0), (0, 0.1), (80, 0.1), (90, 0), (3000, 0)]
    function = ws.TransferFunction(nodes, [(-1000, 0, 0, 0), (3000, 1, 1, 1)])
    scale = color_bar.scale_of(function, "over", "", WHITE)
    assert (scale.low, scale.high) == (-50, 90)
    step = ws.TransferFunction([(300, 0), (300, 1)], [(300, 1, 1, 1)])
    scale = color_bar.scale_of(step, "over", "", WHITE)
    assert scale.low < 300 < scale.high


def test_logarithmic_maps_have_logarithmic_bars():
    function = ws.TransferFunction.from_colormap("viridis", clim=(1, 1e6), log=True)
    scale = color_bar.scale_of(function, "over", "density", WHITE)
    assert scale.is_log
    assert scale.place(1000) == pytest.approx(0.5)
    made = picture(shown=[shown_layer("density", "over", function, "")], size=(400, 400)).annotated(colorbar=True)
    assert {"density", "1", "100", "10⁴", "10⁶"} <= set(texts(made))
    linear = ws.TransferFunction.from_colormap("viridis", clim=(1, 1e6))
    assert not color_bar.scale_of(linear, "over", "", WHITE).is_log


def test_large_values_have_a_power_of_ten():
    function = ws.TransferFunction([(0, 0), (3e7, 1)], [(0, 0, 0, 0), (3e7, 1, 1, 1)])
    made = picture(shown=[shown_layer("Bq", "over", function, "")], size=(400, 400)).annotated(colorbar=True)
    assert texts(made)[0] == "Bq  \N{MULTIPLICATION SIGN}10⁷"
    assert set(texts(made)[1:]) <= {"0", "1", "2", "3"}
    signed = ws.TransferFunction.diverging(10)
    made = picture(shown=[shown_layer("", "over", signed, "m/s")], size=(400, 400)).annotated(colorbar=True)
    assert {"m/s", "\N{MINUS SIGN}10", "0", "10"} <= set(texts(made))


def test_several_layers_have_a_bar_each():
    shown = [shown_layer("ct.nii.gz", "over", BONE, "HU"), shown_layer("pet", "over", GREYS, "")]
    made = picture(shown=shown, size=(600, 600))
    assert {"ct (HU)", "pet"} <= set(texts(made.annotated(colorbar=True)))
    assert "pet" not in texts(made.annotated(colorbar="ct.nii.gz"))
    with pytest.raises(ArgumentError, match=r"no layer is named 'mr'; there are: 'ct\.nii\.gz', 'pet'"):
        made.annotated(colorbar="mr")


def test_functions_of_two_dimensions_have_no_bar():
    table = ws.TransferFunction2D([0, 1], [0, 1], np.ones((2, 2, 4)))
    with pytest.raises(ArgumentError, match="depend on the gradient too"):
        picture(shown=[shown_layer("ct", "over", table, "")]).annotated(colorbar=True)


# Legends


def test_legends_name_labels_and_layers():
    labels = [{"name": "liver", "color": [1, 0, 0]}, {"name": "spleen", "color": [0, 1, 0]}]
    made = picture(labels=labels)
    figure = made.annotated(legend=True)
    assert texts(figure) == ["liver", "spleen"]
    for color in (RED, GREEN):
        assert (figure.rgba[:, 400:, :3] == color).all(axis=2).sum() > 50
    assert texts(made.annotated(legend=["spleen"])) == ["spleen"]
    with pytest.raises(ArgumentError, match=r"no \['lung'\]; there are: 'liver', 'spleen'"):
        made.annotated(legend=["lung"])
    channels = [
        shown_layer(name, "over", ws.TransferFunction([(0, 0), (1, 1)], [(0, 0, 0, 0), (1, *color)]), "")
        for name, color in (("DAPI", RED), (ALPHA + "-tubulin", GREEN))
    ]
    figure = picture("black", shown=channels).annotated(legend=True, legend_at="upper left")
    assert texts(figure) == ["DAPI", ALPHA + "-tubulin"]
    assert figure.size == (400, 300)
    with pytest.raises(ArgumentError, match="nothing for a legend"):
        picture().annotated(legend=True)


def test_many_labels_stand_in_columns():
    labels = [{"name": f"label {number}", "color": [0, 0, number / 60]} for number in range(60)]
    figure = picture(labels=labels).annotated(legend=True)
    assert len(texts(figure)) == 60
    assert len({mark.x for mark in figure._canvas.marks if isinstance(mark, Text)}) > 1
    check_inside(figure)


# The whole


def texts(figure):
    """What is written on a figure, in order."""
    return [mark.text for mark in figure._canvas.marks if isinstance(mark, Text)]


def check_inside(figure):
    """All that is written is on the canvas."""
    width, height = figure.size
    for mark in figure._canvas.marks:
        if isinstance(mark, Text) and mark.slant != UPWARDS:
            long = lettering.text_width(mark.text, mark.size)
            left = mark.x - long * {"start": 0, "middle": 0.5, "end": 1}[mark.anchor]
            assert left >= 0
            assert left + long <= width
            assert 0.69 * mark.size <= mark.y <= height
        elif isinstance(mark, Text):
            assert mark.x <= width
        elif isinstance(mark, Rectangle | Ramp):
            assert min(mark.x, mark.y) >= 0
            assert mark.x + mark.width <= width
            assert mark.y + mark.height <= height


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


# Files


@pytest.fixture
def figure():
    made = picture("transparent", labels=[{"name": "bones & joints", "color": [1, 0, 0]}])
    return made.annotated(scale_bar=True, orientation="cube", colorbar=True, legend=True, title=ALPHA + " < β", dpi=200)


def test_svg_holds_vectors_and_the_rendering(figure, tmp_path):
    figure.save(tmp_path / "a.svg")
    root = ET.parse(tmp_path / "a.svg").getroot()  # noqa: S314 - our own
    width, height = figure.size
    assert root.get("viewBox") == f"0 0 {width} {height}"
    assert float(root.get("width").removesuffix("in")) == pytest.approx(width / 200)
    space = "{http://www.w3.org/2000/svg}"
    written = [node.text for node in root.iter(f"{space}text")]
    assert {ALPHA + " < β", "bones & joints", "HU", "50 mm"} <= set(written)
    # The bar as long as it says; the canvas without a background.
    bars = [float(node.get("width")) for node in root.iter(f"{space}rect")]
    assert figure.report["scale_bar"]["pixels"] in bars
    assert not any(node.get("width") == str(width) for node in root.iter(f"{space}rect"))
    (image,) = root.iter(f"{space}image")
    content = re.sub("^data:image/png;base64,", "", image.get("{http://www.w3.org/1999/xlink}href"))
    import base64

    with Image.open(io.BytesIO(base64.b64decode(content))) as embedded:
        np.testing.assert_array_equal(np.asarray(embedded), np.asarray(picture("transparent")))
    stops = list(root.iter(f"{space}stop"))
    assert (stops[0].get("stop-color"), stops[-1].get("stop-color")) == ("#cc804d", "#ffffe6")


def test_pdf_holds_text_and_transparency(figure, tmp_path):
    for name in ("a.pdf", "b.pdf"):
        figure.save(tmp_path / name)
    content = (tmp_path / "a.pdf").read_bytes()
    assert content == (tmp_path / "b.pdf").read_bytes()
    assert b"/SMask" in content
    assert b"LiberationSans" in content
    box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", content)
    assert [float(side) for side in box.groups()] == pytest.approx([side * 72 / 200 for side in figure.size])


def test_plain_pictures_can_be_vectors_too(tmp_path):
    for suffix in ("svg", "pdf"):
        picture().save(tmp_path / f"a.{suffix}", dpi=100)
        assert (tmp_path / f"a.{suffix}").stat().st_size > 500


def test_pixels_per_inch_of_a_figure_are_in_its_files(figure, tmp_path):
    figure.save(tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as read:
        assert read.info["dpi"] == pytest.approx((200, 200), abs=0.1)
    figure.save(tmp_path / "a.png", dpi=72)
    with Image.open(tmp_path / "a.png") as read:
        assert read.info["dpi"] == pytest.approx((72, 72), abs=0.1)


def test_pdf_needs_reportlab(figure, tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "reportlab.pdfgen.canvas", None)
    with pytest.raises(LibraryError, match=r'reportlab is not installed.*pip install "\.\[figure\]"'):
        figure.save(tmp_path / "a.pdf")
    assert list(tmp_path.iterdir()) == []


# Marks


def test_edges_of_polygons_are_smooth_and_in_place():
    square = Polygon(((2, 2), (6, 2), (6, 5.5), (2, 5.5)), RED)
    canvas = Canvas(10, 10, np.zeros((10, 10, 4), np.float32), marks=(square,))
    cover = raster.drawn(canvas)[..., 3]
    want = np.zeros((10, 10))
    want[2:5, 2:6] = 1
    want[5, 2:6] = 0.5
    np.testing.assert_allclose(cover, want, atol=1e-6)
    canvas = Canvas(40, 40, np.zeros((40, 40, 4), np.float32), marks=(disc((20, 20), 12, RED),))
    assert raster.drawn(canvas)[..., 3].sum() == pytest.approx(np.pi * 12**2, rel=0.02)


def test_slanted_text_is_the_upright_one_turned():
    pixels = []
    for slant in ((1.0, 0.0, 0.0, 1.0), UPWARDS):
        mark = Text(30, 30, "RL", 20, RED, "middle", slant=slant)
        pixels.append(raster.drawn(Canvas(60, 60, np.zeros((60, 60, 4), np.float32), marks=(mark,)))[..., 3])
    # About the middle of the canvas, which is the mark's place.
    assert np.abs(pixels[1] - np.rot90(pixels[0])).mean() < 0.02
    assert pixels[1].sum() == pytest.approx(pixels[0].sum(), rel=0.05)


def test_marks_beyond_the_edge_are_cut_off():
    marks = (Rectangle(-5, -5, 8, 8, RED), Text(55, 30, "long text", 20, RED), Rectangle(99, 99, 5, 5, RED))
    pixels = raster.drawn(Canvas(60, 60, np.zeros((60, 60, 4), np.float32), marks=marks))
    assert pixels[:3, :3, 3].min() == 1
    assert pixels[3:10, 3:10, 3].max() == 0


def test_views_are_right_handed():
    view = View(np.array([1.0, 0, 0]), np.array([0, 0, 1.0]), is_perspective=False)
    assert view.back.tolist() == [0, -1, 0]
