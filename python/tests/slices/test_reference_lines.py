"""Reference lines: where the planes of other slices cross a slice, on sheets of three planes and on a scout."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._scene.slices.lightbox import COLORS

FACTS = ws.Facts(unit="mm", is_anatomical=True)
SHAPE = (40, 48, 60)
OF_AXIS = {"axial": "z", "coronal": "y", "sagittal": "x", "xy": "z", "xz": "y", "yz": "x"}
RED, GREEN, BLUE = (COLORS[axis] for axis in "zyx")


def black(anatomical=True):
    """A scan of one value, so that only lines have a colour; sheared, and its corner is not the world's origin."""
    matrix = np.array([[2.0, 0, 0, -60], [0, 2, 0.3, 10], [0, 0, 3, -30], [0, 0, 0, 1]])
    facts = FACTS if anatomical else ws.Facts(unit="um")
    return ws.Volume(np.zeros(SHAPE, np.uint8), world_from_index=matrix, facts=facts)


def panels_of(sheet):
    for panel in sheet.report["panels"]:
        left, top = panel["left"], panel["top"]
        yield panel, sheet.rgba[top : top + panel["height"], left : left + panel["width"], :3]


def hues(rgb, least):
    """Colours as bright as can be; those below `least` stay dark."""
    return rgb / np.maximum(rgb.max(axis=-1, keepdims=True), max(least, 1e-9))


def places(rgb, color):
    """Rows and columns of a panel in which more than half of the pixels have the colour of a line."""
    found = np.abs(hues(rgb, 0.3) - hues(np.array(color), 0)).max(axis=-1) < 0.1
    rows, columns = found.mean(axis=1) > 0.5, found.mean(axis=0) > 0.5
    return np.flatnonzero(rows), np.flatnonzero(columns)


@pytest.mark.parametrize("plane", ["all", "ortho"])
@pytest.mark.parametrize("anatomical", [True, False])
def test_each_of_three_planes_shows_where_the_other_two_lie(plane, anatomical):
    scan, center = black(anatomical), (-21.0, 47.0, 12.0)
    sheet = ws.lightbox(scan, plane, center=center, letters=False, size=(180, 160), clim=(0, 1))
    own = {panel["plane"]: panel for panel in sheet.report["panels"]}
    for panel, rgb in panels_of(sheet):
        for other in set(own) - {panel["plane"]}:
            rows, columns = places(rgb, COLORS[OF_AXIS[other]])
            line = rows if len(rows) else columns
            # The centre is in the middle of each picture, whichever way its axes point.
            middle = ((panel["height"] if len(rows) else panel["width"]) - 1) / 2
            assert len(line) <= 3
            assert line.mean() == pytest.approx(middle, abs=1)
        assert [len(part) for part in places(rgb, COLORS[OF_AXIS[panel["plane"]]])] == [0, 0]


def test_lines_lie_where_samples_of_the_other_plane_are_seen():
    samples = np.zeros(SHAPE, np.uint8)
    samples[28] = 1  # one axial slice alone is bright
    scan = ws.Volume(samples, world_from_index=np.diag([2.0, 2, 3, 1]), facts=FACTS)
    middle = {"center": (40, 40, 3 * 28), "zoom": 0.7}
    options = {"letters": False, "size": (200, 200), "clim": (0, 1), **middle}
    plain = ws.lightbox(scan, "all", reference_lines=False, **options)
    lined = ws.lightbox(scan, "all", **options)
    for (_, before), (_, after) in list(zip(panels_of(plain), panels_of(lined), strict=True))[1:]:
        bright = np.flatnonzero(before[:, 100, 0] > 0.5)
        rows = np.flatnonzero((after[..., 0] > after[..., 1] + 0.3).mean(axis=1) > 0.5)
        assert bright[0] <= rows.mean() <= bright[-1]


def test_one_option_leaves_them_out_and_draws_a_scout_of_positions():
    scan = black()
    plain = ws.lightbox(scan, "all", letters=False, reference_lines=False, clim=(0, 1))
    assert plain.rgba[..., :3].max() == 0
    without = ws.lightbox(scan, "axial", [-9, 30, 60], letters=False, size=(90, 80), clim=(0, 1))
    assert (len(without.report["panels"]), without.rgba[..., :3].max()) == (3, 0)
    options = {"letters": False, "size": (90, 80), "clim": (0, 1), "columns": 4}
    sheet = ws.lightbox(scan, "axial", [-9, 30, 60], reference_lines=True, **options)
    *slices, (panel, scout) = panels_of(sheet)
    assert [panel["plane"] for panel, _ in slices] == ["axial"] * 3
    assert max(rgb.max() for _, rgb in slices) == 0
    assert panel["plane"] == "sagittal"
    of_scout = ws.slice(scan, "sagittal", size=(90, 80), clim=(0, 1))
    rows, columns = places(scout, RED)
    top, down = of_scout.report["origin"][2], of_scout.report["down"][2] * of_scout.pixel
    expected = sorted((z - top) / down for z in (-9, 30, 60))
    assert len(columns) == 0
    for place in expected:
        assert np.abs(rows - place).min() <= 0.5
    assert len(rows) <= 9


@pytest.mark.parametrize(
    ("plane", "scout"),
    [
        ("axial", "sagittal"),
        ("coronal", "sagittal"),
        ("sagittal", "coronal"),
        (((0, 60, 0), (0, 1, 1)), "sagittal"),
        (((0, 60, 0), (1, 0, 0.2)), "coronal"),
    ],
)
def test_the_scout_is_at_right_angles(plane, scout):
    sheet = ws.lightbox(black(), plane, 3, reference_lines=True, size=(60, 60), clim=(0, 1), letters=False)
    panel, rgb = list(panels_of(sheet))[-1]
    assert panel["plane"] == scout
    assert rgb.max() > 0.3


def test_an_oblique_plane_is_an_oblique_line():
    normal = np.array([0, 1, 1]) / np.sqrt(2)
    options = {"letters": False, "size": (120, 120), "clim": (0, 1)}
    sheet = ws.lightbox(black(), ((0, 60, 20), normal), [0], reference_lines=True, columns=2, **options)
    _, rgb = list(panels_of(sheet))[-1]
    of_scout = ws.slice(black(), "sagittal", size=(120, 120), clim=(0, 1))
    rows, columns = np.nonzero(rgb.max(axis=-1) > 0.35)
    report = of_scout.report
    right, down = np.array(report["right"]), np.array(report["down"])
    world = np.array(report["origin"]) + of_scout.pixel * (columns[:, None] * right + rows[:, None] * down)
    assert len(rows) > 60
    assert np.abs((world - (0, 60, 20)) @ normal).max() <= 1.5 * of_scout.pixel


def test_positions_are_written_in_the_colours_of_the_planes():
    sheet = ws.lightbox(black(), "all", size=(200, 200), clim=(0, 1))
    for panel, rgb in panels_of(sheet):
        text = rgb[:20, :70]
        wanted = np.array(COLORS[OF_AXIS[panel["plane"]]])
        brightest = text[text.max(axis=-1) > 0.9 * wanted.max()]
        assert np.abs(brightest.mean(axis=0) - wanted).max() < 0.15


def test_the_command_line(wavesplat, tmp_path):
    black().save(tmp_path / "a.nrrd")
    command = ["slice", tmp_path / "a.nrrd", "--size", "80x80", "-q", "-o"]
    from PIL import Image

    pictures = {}
    for name, options in {
        "with": ["--plane", "all"],
        "without": ["--plane", "all", "--no-reference-lines"],
        "scout": ["--positions", "3", "--reference-lines"],
    }.items():
        done = wavesplat(*command, tmp_path / f"{name}.png", *options)
        assert done.returncode == 0, done.stderr
        with Image.open(tmp_path / f"{name}.png") as image:
            pictures[name] = np.asarray(image)[..., :3].astype(int)
    colored = {name: np.ptp(rgb, axis=-1) > 60 for name, rgb in pictures.items()}
    assert colored["with"].sum() > 300
    assert not colored["without"].any()
    assert colored["scout"].any()
    done = wavesplat(*command, tmp_path / "b.png", "--reference-lines")
    assert (done.returncode, "--reference-lines is for several slices" in done.stderr) == (2, True)
