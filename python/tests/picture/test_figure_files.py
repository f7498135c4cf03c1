"""Figures of the renderer's pictures, and their files: pixels, SVG, PDF."""

import io
import json
import re
from importlib.resources import files
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from cases_of_the_day import nightly
from figure_pictures import (
    ALPHA,
    GREEN,
    RED,
    picture,
    texts,
)
from PIL import Image

import wavesplat as ws
from wavesplat._cli.printing import check_outputs
from wavesplat._picture import raster
from wavesplat._picture.marks import UPWARDS, Canvas, Polygon, Ramp, Rectangle, Text, disc
from wavesplat._picture.report_facts import View
from wavesplat.errors import ArgumentError, LibraryError

# Pictures of the renderer


def spots(unit="um"):
    """Two points that are 60 units apart along x, at the depth of the middle."""
    samples = np.zeros((41, 41, 81), np.float32)
    samples[20, 20, 10] = samples[20, 20, 70] = 1
    return ws.Volume(samples, unit=unit, name="spots")


def centers(rgba):
    """Columns of the two spots in a picture."""
    light = rgba[..., 1]
    x = np.arange(light.shape[1])
    middle = light.shape[1] // 2
    return [float((light[:, part] * x[part]).sum() / light[:, part].sum()) for part in (np.s_[:middle], np.s_[middle:])]


@pytest.mark.parametrize("view_angle", [None, 40])
@pytest.mark.parametrize("size", [(300, 200), (200, 260)])
def test_the_pixel_is_what_a_bar_measures(view_angle, size):
    volume = spots()
    camera = ws.Camera.orbit(volume, 180, 0, view_angle=view_angle, aspect=size[0] / size[1])
    look = ws.TransferFunction([(0, 0), (1, 1)], [(0, 1, 1, 1), (1, 1, 1, 1)])
    made = ws.render(volume, look, camera, size=size, composite="maximum")
    first, second = centers(made.rgba)
    assert (second - first) * made.pixel == pytest.approx(60, abs=0.3)
    assert made.camera == camera
    bar = made.annotated(scale_bar=True).report["scale_bar"]
    assert bar["text"].endswith("µm")
    assert bar["pixels"] / (second - first) == pytest.approx(bar["length"] / 60, rel=0.01)


def test_reports_have_all_that_figures_need():
    ct = ws.examples.ct_pelvis()
    labels = ws.Labels((ct.samples > 200).astype(np.uint8), {1: ws.Label("#ff0000", name="bone")})
    made = ws.render(ct, "ct-soft-tissue", labels=labels, size=(400, 300), background="white")
    figure = made.annotated(scale_bar=True, orientation="letters", colorbar=True, legend=True)
    assert {"R", "L", "S", "I", "HU", "bone", "100 mm"} <= set(texts(figure))
    assert figure.rgba[0, -1].tolist() == [1, 1, 1, 1]
    json.dumps(made.report)


def test_layers_are_named_with_the_colours_they_are_drawn_in():
    layers = [
        ws.Layer(spots(), ws.TransferFunction([(0, 0), (1, 1)], [(0, 0, 0, 0), (1, *color)]), name=name)
        for name, color in (("DAPI", RED), ("GFP", GREEN))
    ]
    hidden = ws.Layer(spots(), layers[0].look, visible=False, name="hidden")
    made = ws.render([*layers, hidden], composite="maximum", size=(300, 300), background="black")
    assert texts(made.annotated(legend=True)) == ["DAPI", "GFP"]
    assert {"DAPI", "GFP"} <= set(texts(made.annotated(colorbar=True)))
    with pytest.raises(ArgumentError, match="there are: 'DAPI', 'GFP'"):
        made.annotated(colorbar="hidden")


def test_inverted_projections_have_inverted_bars():
    volume = ws.Volume(np.random.default_rng(1).gamma(1, 50, (20, 20, 20)).astype(np.float32), anatomical=True)
    for background, darkest in (("white", -1), ("black", 0)):
        made = ws.render(volume, composite="maximum", background=background, size=(200, 200))
        ramp = next(mark for mark in made.annotated(colorbar=True)._canvas.marks if isinstance(mark, Ramp))
        assert sum(ramp.stops[darkest][1]) < 0.1
        assert sum(ramp.stops[-1 - darkest][1]) > 2.9


# By day one file of pixels and both of vectors.
@pytest.mark.parametrize("suffix", ["png", "svg", "pdf", *nightly("jpg", "webp", "tif")])
def test_figures_from_the_command_line(wavesplat, tmp_path, suffix):
    scan = files("wavesplat") / "data" / "ct_pelvis" / "ct_pelvis.nii.gz"
    out = tmp_path / f"a.{suffix}"
    options = "--preset ct-bone --size 200x200 --background white --cube --scale-bar --colorbar --title Pelvis"
    done = wavesplat("render", scan, "-o", out, *options.split(), "--dpi", "300", "--json", "--keep-table")
    assert (done.returncode, done.stderr) == (0, "")
    facts = json.loads(done.stdout)
    assert facts["report"]["scale_bar"]["text"] == "100 mm"
    made = ws.render(ws.open(scan), "ct-bone", ws.Camera.from_json(facts["report"]["camera"]), size=(200, 200))
    assert facts["size"] > [200, 200]
    assert out.stat().st_size > 1000
    assert made.pixel == facts["report"]["pixel"]


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
    # The bar has the length of its label; the canvas has no background.
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


def test_a_missing_library_is_told_before_all_is_drawn(tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "reportlab.pdfgen.canvas", None)
    with pytest.raises(LibraryError, match=r'reportlab is not installed.*pip install "wavesplat\[figure\]"'):
        check_outputs("scan.nii.gz", tmp_path / "sheet.pdf", "pictures", option="--sheet")


def test_pdf_needs_reportlab(figure, tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "reportlab.pdfgen.canvas", None)
    with pytest.raises(LibraryError, match=r'reportlab is not installed.*pip install "wavesplat\[figure\]"'):
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
    # The letters are turned about the middle of the canvas, where the mark is placed.
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
