"""Several slices on one sheet: each is the slice of its position, at one scale, with its position and letters."""

import numpy as np
import pytest
from PIL import Image

import wavesplat as ws
from wavesplat._cli.options import parsers
from wavesplat._scene.slices import lightbox as lightbox_module
from wavesplat.errors import ArgumentError

FACTS = ws.Facts(unit="mm", is_anatomical=True)
MATRIX = np.diag([2.0, 2, 3, 1])
SAMPLES = np.random.default_rng(0).integers(0, 200, (20, 24, 30)).astype(np.uint8)
SCAN = ws.Volume(SAMPLES, world_from_index=MATRIX, facts=FACTS)


def cut_out(sheet, number):
    panel = sheet.report["panels"][number]
    left, top = panel["left"], panel["top"]
    return sheet.rgba[top : top + panel["height"], left : left + panel["width"]]


def test_each_slice_is_that_of_its_position():
    sheet = ws.lightbox(SCAN, "axial", [3, 12, 30, 57], columns=3, letters=False, size=(58, 46), clim=(0, 200))
    assert sheet.size == (3 * 58 + 2 * 2, 2 * 46 + 2)
    assert [panel["position"] for panel in sheet.report["panels"]] == [3, 12, 30, 57]
    for number, position in enumerate((3, 12, 30, 57)):
        one = ws.slice(SCAN, "axial", position, size=(58, 46), clim=(0, 200))
        np.testing.assert_array_equal(cut_out(sheet, number), one.rgba)
    assert sheet.pixel == pytest.approx(ws.slice(SCAN, size=(58, 46)).pixel)


def test_positions_are_spread_evenly_over_the_volume():
    sheet = ws.lightbox(SCAN, "axial", 6, letters=False, size=(20, 20))
    np.testing.assert_allclose([panel["position"] for panel in sheet.report["panels"]], 57 / 6 * (np.arange(6) + 0.5))
    assert len(ws.lightbox(SCAN, "coronal", letters=False, size=(9, 9)).report["panels"]) == 12
    oblique = ws.lightbox(SCAN, ((0, 0, 9), (0, 0, 2)), 2, letters=False, size=(20, 20))
    np.testing.assert_allclose([panel["position"] for panel in oblique.report["panels"]], [57 / 4 - 9, 3 * 57 / 4 - 9])


@pytest.mark.parametrize("size", [None, (150, 90)])
def test_three_planes_have_one_scale(size):
    ruler = np.zeros((20, 24, 30), np.uint8)
    ruler[5:15, 6:18, 10:20] = 1  # 20 x 24 x 30 mm
    scan = ws.Volume(ruler, world_from_index=MATRIX, facts=FACTS)
    sheet = ws.lightbox(scan, "all", letters=False, reference_lines=False, size=size)
    assert [panel["plane"] for panel in sheet.report["panels"]] == ["axial", "coronal", "sagittal"]
    lengths = [(20, 24), (20, 30), (24, 30)]
    for number, (across, along) in enumerate(lengths):
        bright = cut_out(sheet, number)[..., 0] > 0.5
        shown = np.array([bright.any(axis=0).sum(), bright.any(axis=1).sum()]) * sheet.pixel
        np.testing.assert_allclose(shown, [across, along], atol=2 * sheet.pixel)
    # They meet in a point.
    through = ws.lightbox(SCAN, "all", center=(10, 20, 30), letters=False, size=(60, 60), clim=(0, 200))
    assert [panel["position"] for panel in through.report["panels"]] == [30, 20, 10]


def test_positions_letters_and_a_bar_are_written():
    options = {"size": (160, 130), "clim": (0, 2000)}  # dark
    plain = ws.lightbox(SCAN, "axial", [10, 20, 30], letters=False, columns=2, **options)
    lettered = ws.lightbox(SCAN, "axial", [10, 20, 30], columns=2, **options)
    for number in range(3):
        written = np.abs(cut_out(lettered, number) - cut_out(plain, number))[..., 0] > 0.1
        assert written[:20, :60].any()  # the position
        assert written[55:75, :20].any()  # R
        assert written[:20, 70:90].any()  # A
        assert not written[30:50, 30:130].any()
    barred = ws.lightbox(SCAN, "axial", [10, 20, 30], columns=2, scale_bar=True, **options)
    changed = [np.abs(cut_out(barred, n) - cut_out(lettered, n)).max() > 0.1 for n in range(3)]
    assert changed == [False, False, True]  # in the first slice of the last row
    assert barred.report["scale_bar"]["text"].endswith("mm")
    made_up = ws.Volume(SAMPLES)
    assert ws.lightbox(made_up, positions=2, size=(80, 80)).report["panels"][0]["plane"] == "xy"


def test_layers_labels_and_windows_are_those_of_slices():
    over = ws.Layer(ws.Volume(255 - SAMPLES, world_from_index=MATRIX, facts=FACTS), "grey", opacity=0.5)
    labels = ws.Labels((SAMPLES > 150).astype(np.uint8), {1: ws.Label("red", name="spots")})
    scene = ws.Scene([SCAN, over], labels=labels)
    sheet = ws.lightbox(scene, "sagittal", [10, 40], letters=False, size=(40, 40))
    for number, position in enumerate((10, 40)):
        np.testing.assert_array_equal(cut_out(sheet, number), ws.slice(scene, "sagittal", position, size=(40, 40)).rgba)
    figure = sheet.annotated(legend=True, colorbar=True, scale_bar=True, title="A lightbox")
    assert figure.size[0] > sheet.size[0]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"positions": 0}, "positions is 0; give 1 to 400"),
        ({"positions": []}, "positions has 0 numbers"),
        ({"positions": [10, 99]}, "outside the volume"),
        ({"positions": 3, "plane": "all"}, 'give another plane than "all"'),
        ({"positions": 3, "columns": 0}, "columns is 0"),
        ({"positions": 3, "zoom": 0}, "zoom is 0"),
        ({"positions": 3, "size": (0, 9)}, "at least 1"),
        ({"positions": 3, "plane": "axis"}, "unknown plane 'axis'"),
    ],
)
def test_what_cannot_work_is_said(options, message):
    with pytest.raises(ArgumentError, match=message):
        ws.lightbox(SCAN, **options)


@pytest.mark.parametrize(
    ("text", "positions"),
    [
        ("10:80:10", (10, 20, 30, 40, 50, 60, 70, 80)),
        ("80:10:-35", (80, 45, 10)),
        ("0:1:0.1", tuple(0.1 * n for n in range(11))),
        ("0:25:10", (0, 10, 20)),
        ("12", 12),
        ("10,20.5,-3", (10, 20.5, -3)),
        ("5.5", (5.5,)),
        ("1mm:2mm:0.5mm", (1, 1.5, 2)),
    ],
)
def test_positions_on_the_command_line(text, positions):
    found = parsers.positions(text)
    assert (found if isinstance(found, int) else [one.number for one in found]) == pytest.approx(positions)


@pytest.mark.parametrize("text", ["a", "1:2", "1:2:0", "2:1:1", "", "nan:1:1", "1mm:2:1", "1,2mm"])
def test_what_are_no_positions(text):
    import typer

    with pytest.raises(typer.BadParameter, match="not START:STOP:STEP"):
        parsers.positions(text)


def test_the_command_line_makes_sheets(wavesplat, tmp_path):
    SCAN.save(tmp_path / "a.nrrd")
    done = wavesplat(
        "slice", tmp_path / "a.nrrd", "--positions", "5:55:10", "--size", "60x50", "-o", tmp_path / "a.png"
    )
    assert done.returncode == 0, done.stderr
    with Image.open(tmp_path / "a.png") as image:
        assert image.size == (3 * 60 + 4, 2 * 50 + 2)
    command = ["slice", tmp_path / "a.nrrd", "-o", tmp_path / "b.png", "--plane", "all"]
    done = wavesplat(*command, "--scale-bar", "--letters", "--colorbar", "--columns", "1")
    assert done.returncode == 0, done.stderr
    for options, message in (
        (["--positions", "3"], "say the same thing twice"),
        (["--position", "3"], "say the same thing twice"),
        (["--position", "3", "--positions", "2"], "say the same thing twice"),
    ):
        done = wavesplat(*command, *options)
        assert (done.returncode, message in done.stderr) == (2, True)
    done = wavesplat("slice", tmp_path / "a.nrrd", "-o", tmp_path / "b.png", "--columns", "2")
    assert "--columns is for several slices" in done.stderr


@pytest.mark.parametrize(
    ("plain", "with_units"),
    [
        (["--position", "12", "--thickness", "6"], ["--position", "1.2cm", "--thickness", "6000um"]),
        (["--positions", "5:15:10"], ["--positions", "0.5cm:1.5cm:1cm"]),
    ],
)
def test_lengths_are_in_the_unit_of_the_volume_or_in_their_own(tmp_path, plain, with_units):
    from typer.testing import CliRunner

    from wavesplat._cli import app

    SCAN.save(tmp_path / "a.nrrd")
    pictures = []
    for options in (plain, with_units):
        done = CliRunner().invoke(app, ["slice", f"{tmp_path}/a.nrrd", *options, "-o", f"{tmp_path}/a.png", "-q"])
        assert done.exit_code == 0, done.exception
        pictures.append((tmp_path / "a.png").read_bytes())
    assert pictures[0] == pictures[1]


def test_a_length_needs_a_unit_that_can_be_compared():
    assert parsers.length("0.5 mm").in_world("um", "it") == 500
    assert parsers.length("65mm").in_world("m", "it") == 0.065
    assert parsers.length("2kpc").in_world("kpc", "it") == 2
    with pytest.raises(ArgumentError, match="it is 2 kpc, whose unit is unknown; give um, mm or another length"):
        parsers.length("2kpc").in_world("mm", "it")
    with pytest.raises(ArgumentError, match="it is 2 mm, and the volume's file names no unit; give it with --unit"):
        parsers.length("2mm").in_world(None, "it")


def test_contours_and_isolines_are_those_of_each_slice():
    labels = ws.Labels(ws.Volume((SAMPLES > 150).astype(np.uint8), world_from_index=MATRIX, facts=FACTS))
    lines = {"contours": labels, "isolines": ws.Isolines(SCAN, [100.0])}
    sheet = ws.lightbox(SCAN, "axial", [3, 30], letters=False, size=(58, 46), **lines)
    for number, position in enumerate((3, 30)):
        one = ws.slice(SCAN, "axial", position, size=(58, 46), **lines)
        np.testing.assert_array_equal(cut_out(sheet, number), one.rgba)
    assert [line["name"] for line in sheet.report["lines"]] == [line["name"] for line in one.report["lines"]]


def test_a_plane_may_be_an_array():
    sheet = ws.lightbox(SCAN, np.array([[20, 20, 20], [0, 0, 1.0]]), 2, size=(40, 40))
    assert [panel["plane"] for panel in sheet.report["panels"]] == ["oblique", "oblique"]


def test_letters_of_three_planes_have_one_size_and_figures_one_sign_of_micrometres(monkeypatch):
    """Letters of thin planes were half as high, and "um" stood above a bar of "µm"."""
    drawn = []
    with_caption = lightbox_module.with_caption
    monkeypatch.setattr(
        lightbox_module,
        "with_caption",
        lambda rgba, text, ink, font_px: drawn.append((text, font_px)) or with_caption(rgba, text, ink, font_px),
    )
    volume = ws.Volume(np.zeros((24, 128, 128), np.float32) + np.arange(128), spacing=(0.3, 0.3, 0.3), unit="um")
    ws.lightbox(volume, "ortho", size=(256, 256))
    assert [text for text, _ in drawn] == ["z 3.6 µm", "x 19.2 µm", "y 19.2 µm"]
    assert len({font_px for _, font_px in drawn}) == 1
    # The thinnest plane is 47 pixels high.
    assert 7.5 < drawn[0][1] <= 10
