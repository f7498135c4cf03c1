"""Pictures of several inputs that are to be compared: one look for all, and sheets of all."""

import json

import numpy as np
import pytest
import tifffile
from cases_of_the_day import nightly

import wavesplat as ws
from wavesplat._cli.batches import Batch, _distinct_names
from wavesplat._cli.contact_sheet import GAP_PX, columns_of, sheet_of
from wavesplat._picture import lettering

images = pytest.importorskip("PIL.Image")

SIZE = 96


def cells(brightness, seed=2):
    rng = np.random.default_rng(seed)
    z, y, x = np.mgrid[:16, :40, :40]
    light = np.zeros((16, 40, 40))
    for cz, cy, cx in rng.uniform((4, 8, 8), (12, 32, 32), (9, 3)):
        light += np.exp(-(4 * (z - cz) ** 2 + (y - cy) ** 2 + (x - cx) ** 2) / 14)
    return (10 + brightness * light).astype(np.uint16)


def save(path, samples):
    sizes = {f"PhysicalSize{axis}": 0.2 for axis in "XYZ"} | {f"PhysicalSize{axis}Unit": "µm" for axis in "XYZ"}
    tifffile.imwrite(path, samples, metadata={"axes": "CZYX" if samples.ndim == 4 else "ZYX", **sizes})


@pytest.fixture
def dyes(tmp_path):
    """A bright dye and one a tenth as bright, and a folder for pictures."""
    for name, brightness in (("a_bright", 2000), ("b_dim", 200)):
        save(tmp_path / f"{name}.ome.tif", cells(brightness))
    (tmp_path / "out").mkdir()
    return tmp_path


def render(wavesplat, folder, *options, inputs="*.ome.tif"):
    done = wavesplat("render", inputs, "-o", "out", "--size", SIZE, *options, cwd=folder)
    means = {
        path.stem: np.asarray(images.open(path).convert("RGB")).max(axis=2).mean() for path in folder.glob("out/*")
    }
    return done, means


# By day one operator: the look of the first input is kept before it is drawn.
@pytest.mark.parametrize("operator", ["over", *nightly("maximum", "mean")])
def test_one_look_keeps_how_bright_dyes_are(wavesplat, dyes, operator):
    """Dyes of 10 : 1 came out as means of 91 and 97 (micro.md, section 3); they differ at least four times."""
    given = () if operator == "over" else ("--composite", operator)
    done, means = render(wavesplat, dyes, *given)
    assert done.returncode == 0, done.stderr
    assert means["a_bright"] < 2.5 * means["b_dim"]
    note = "the inputs are shown over values of their own (a_bright.ome.tif: "
    assert done.stderr.count(note) == 1
    assert "--same-look first, or brightest" in done.stderr
    for wanted in ("first", "brightest", "a_bright.ome.tif"):
        done, means = render(wavesplat, dyes, *given, "--same-look", wanted)
        assert (done.returncode, note in done.stderr) == (0, False), done.stderr
        assert means["a_bright"] > 4 * means["b_dim"]


def test_one_look_is_that_of_python(wavesplat, dyes):
    (dyes / "a_bright.ome.tif").rename(dyes / "z_bright.ome.tif")
    render(wavesplat, dyes, "--same-look", "brightest", "--embed-paths")
    bright, dim = (ws.open(dyes / f"{name}.ome.tif") for name in ("z_bright", "b_dim"))
    own = ws.render(dim, ws.Look.auto(bright), size=(SIZE, SIZE), background="black")
    np.testing.assert_array_equal(np.asarray(images.open(dyes / "out" / "b_dim.png")), np.asarray(own))
    # The first is the dim one now, and the bright one is drawn in its look.
    render(wavesplat, dyes, "--same-look", "first")
    own = ws.render(bright, ws.Look.auto(dim), size=(SIZE, SIZE), background="black")
    np.testing.assert_array_equal(np.asarray(images.open(dyes / "out" / "z_bright.png")), np.asarray(own))


@pytest.mark.parametrize("options", [("--clim", "10,900"), ("--quiet",), ("--same-look", "first")])
def test_windows_that_are_the_same_need_no_note(wavesplat, dyes, options):
    done, _ = render(wavesplat, dyes, *options)
    assert (done.returncode, "values of their own" in done.stderr) == (0, False)
    save(dyes / "b_dim.ome.tif", cells(2000))
    done, _ = render(wavesplat, dyes)
    assert (done.returncode, done.stderr) == (0, "")


def test_one_look_of_several_channels(wavesplat, tmp_path):
    """Each channel has the look of the same channel; the brightest input of one need not be that of another."""
    (tmp_path / "out").mkdir()
    save(tmp_path / "a.ome.tif", np.stack([cells(2000), cells(150, 5)]))
    save(tmp_path / "b.ome.tif", np.stack([cells(200), cells(1500, 5)]))
    done, _ = render(wavesplat, tmp_path, "--same-look", "brightest", "--json")
    assert done.returncode == 0, done.stderr
    shown = [one["report"]["shown"] for one in json.loads(done.stdout)["results"]]
    assert shown[0] == shown[1]
    ends = [layer["transfer_function"]["color"][-1][0] for layer in shown[0]]
    assert all(end > 900 for end in ends)
    save(tmp_path / "c.ome.tif", cells(300))
    done, means = render(wavesplat, tmp_path, "--same-look", "first")
    assert done.returncode == 1
    assert "gives the looks of 2 channels, and this file has 1" in done.stderr
    assert set(means) == {"a", "b"}


def test_a_blank_input_is_blank_in_the_look_of_another(wavesplat, dyes):
    save(dyes / "c_blank.ome.tif", np.full((16, 40, 40), 10, np.uint16))
    done, _ = render(wavesplat, dyes)
    assert done.returncode == 1  # there is nothing to choose a look by
    done, means = render(wavesplat, dyes, "--same-look", "first")
    assert done.returncode == 0, done.stderr
    assert means["c_blank"] == 0


def test_labels_keep_their_own_volume(wavesplat, tmp_path):
    (tmp_path / "out").mkdir()
    for name, start in (("a", 1), ("b", 4)):
        labels = np.zeros((24, 24, 24), np.uint16)
        for number in range(8):
            place = [start + 12 * (number >> axis & 1) for axis in range(3)]
            labels[tuple(slice(at, at + 8) for at in place)] = 11 * number + 3
        np.save(tmp_path / f"{name}.npy", labels)
    assert ws.Look.auto(ws.open(tmp_path / "a.npy")).labels is not None
    pictures = []
    for options in ((), ("--same-look", "first")):
        done, _ = render(wavesplat, tmp_path, *options, inputs="*.npy")
        assert done.returncode == 0, done.stderr
        pictures.append((tmp_path / "out" / "b.png").read_bytes())
    assert pictures[0] == pictures[1]


def test_one_look_that_cannot_be(wavesplat, dyes):
    done, means = render(wavesplat, dyes, "--same-look", "none.tif")
    assert (done.returncode, means) == (2, {})
    assert "--same-look is first, brightest or a volume: no such file" in done.stderr
    done = wavesplat("render", "--from", "x.png", "-o", "y.png", "--same-look", "first", cwd=dyes)
    assert (done.returncode, "--same-look: --from has all that is drawn" in done.stderr) == (2, True)


def test_an_input_that_fails_gives_no_look(wavesplat, dyes):
    (dyes / "a.ome.tif").write_bytes(b"no")
    for wanted in ("first", "brightest"):
        done, means = render(wavesplat, dyes, "--same-look", wanted)
        assert done.returncode == 1
        assert means["a_bright"] > 4 * means["b_dim"]


# Sheets.


def test_a_sheet_has_all_pictures_and_their_names(wavesplat, dyes):
    save(dyes / "c.ome.tif", cells(700))
    done, _ = render(wavesplat, dyes, "--same-look", "first", "--sheet", "sheet.png", "--json", "--title", "dye")
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout)["results"][-1]
    assert (facts["sheet"], facts["names"]) == ("sheet.png", ["a_bright", "b_dim", "c"])
    sheet = np.asarray(images.open(dyes / "sheet.png").convert("RGB"))
    assert list(sheet.shape[1::-1]) == facts["size"]
    one = np.asarray(images.open(dyes / "out" / "a_bright.png").convert("RGB"))
    height, width = one.shape[:2]
    np.testing.assert_array_equal(sheet[GAP_PX : GAP_PX + height, GAP_PX : GAP_PX + width], one)
    below = sheet[GAP_PX + height : GAP_PX + height + 8, GAP_PX : GAP_PX + width]
    assert below.max() > 200  # its name
    other = np.asarray(images.open(dyes / "out" / "b_dim.png").convert("RGB"))
    np.testing.assert_array_equal(sheet[GAP_PX : GAP_PX + height, 2 * GAP_PX + width :][:, :width], other)


def test_scans_of_patients_are_numbered_on_a_sheet_unless_a_caption_is_asked_for(wavesplat, tmp_path):
    names = ("DOE_JANE", "DOE_JOHN")
    for name, seed in zip(names, (1, 2), strict=True):
        samples = np.random.default_rng(seed).integers(0, 900, (4, 5, 6)).astype(np.int16)
        ws.Volume(samples, spacing=(1, 1, 2), anatomical=True).save(tmp_path / f"{name}.nii.gz")
    command = ("render", *(f"{name}.nii.gz" for name in names), "-o", "{stem}.png", "--size", "64", "--json")
    found = {}
    for caption in ((), ("--caption", "{number}: {stem}")):
        done = wavesplat(*command, "--sheet", "sheet.png", *caption, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        found[caption] = json.loads(done.stdout)["results"][-1]["names"]
    assert [*found.values()] == [["MR 1", "MR 2"], ["1: DOE_JANE", "2: DOE_JOHN"]]
    done = wavesplat(*command, "--caption", "{stem}", cwd=tmp_path)
    assert (done.returncode, "give it with --sheet" in done.stderr) == (2, True)


def test_a_sheet_of_times(wavesplat, tmp_path):
    (tmp_path / "out").mkdir()
    samples = np.stack([cells(500 + 100 * time) for time in range(3)])
    times = {"TimeIncrement": 0.5, "TimeIncrementUnit": "min"}
    tifffile.imwrite(tmp_path / "t.ome.tif", samples, metadata={"axes": "TZYX", **times})
    command = (
        "render",
        "t.ome.tif",
        "-o",
        "out/t.png",
        "--times",
        "all",
        "--size",
        "40",
        "--json",
        "--sheet",
        "all.png",
    )
    done = wavesplat(*command, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    pictures, sheet = json.loads(done.stdout)["results"]
    assert len(pictures["pictures"]) == 3
    assert sheet["names"] == ["0.0 min", "0.5 min", "1.0 min"]


def test_a_sheet_that_cannot_be_written_is_told_first(wavesplat, dyes):
    done, means = render(wavesplat, dyes, "--sheet", "sheet.mp4")
    assert (done.returncode, means) == (1, {})
    assert "cannot write pictures as .mp4" in done.stderr
    done, means = render(wavesplat, dyes, "--sheet", "a_bright.ome.tif")
    assert (done.returncode, means) == (2, {})
    assert "INPUT and --sheet are the same file" in done.stderr
    done, means = render(wavesplat, dyes, "--sheet", "out/b_dim.png")
    assert (done.returncode, means) == (2, {})
    assert "--output and --sheet are the same file" in done.stderr


def test_pictures_of_several_sizes_lie_in_the_middle():
    def of(height, width, light):
        return np.full((height, width, 4), (light, light, light, 1), np.float32)

    sheet = sheet_of([("a", of(40, 60, 1)), ("b", of(20, 30, 0)), ("c", np.zeros((40, 60, 4), np.float32))]).rgba
    assert (sheet[GAP_PX : GAP_PX + 40, GAP_PX : GAP_PX + 60] == 1).all()
    left = 2 * GAP_PX + 60
    assert (sheet[GAP_PX + 10 : GAP_PX + 30, left + 15 : left + 45, :3] == 0).all()
    assert sheet[..., 3].min() == 1
    alone = sheet_of([("a", of(40, 60, 1))]).rgba
    assert alone.shape[1] == 60 + 2 * GAP_PX


@pytest.mark.parametrize(
    ("n", "size", "columns"),
    [
        *[(1, (400, 330), 1), (2, (400, 330), 2), (2, (300, 430), 2), (2, (900, 200), 1)],
        *[(4, (300, 300), 2), (6, (300, 300), 3), (9, (400, 330), 3), (12, (300, 300), 4)],
    ],
)
def test_a_sheet_is_about_as_wide_as_a_screen(n, size, columns):
    assert columns_of(n, *size) == columns


def test_names_tell_inputs_apart():
    assert _distinct_names(["x/a.ome.tif", "x/b.nii.gz"]) == ["a", "b"]
    assert _distinct_names(["p.zarr/A/1/0", "p.zarr/B/1/0"]) == ["A/1/0", "B/1/0"]
    assert _distinct_names(["a/x.tif", "b/x.tif", "b/y.tif"]) == ["a/x", "b/x", "b/y"]
    assert _distinct_names(["a/x.tif", "a/x.nrrd"]) == ["x.tif", "x.nrrd"]


def test_long_names_lose_their_middle():
    long = "experiment_of_a_very_long_name_t0001"
    short = lettering.fitting(long, 10, 100)
    assert lettering.text_width(short, 10) <= 100 < lettering.text_width(long, 10)
    assert short.startswith("exper")
    assert short.endswith("0001")
    assert lettering.fitting("ab", 10, 100) == "ab"


def test_windows_are_noted_once(capsys):
    def picture(low, high):
        function = {"opacity": [(low, 1)], "color": [(low, 0, 0, 0), (high, 1, 1, 1)]}
        return ws.Picture(np.zeros((2, 2, 4), np.float32), report={"shown": [{"transfer_function": function}]})

    batch = Batch(["a.tif", "b.tif", "c.tif"])
    for name, high in (("a.tif", 9), ("b.tif", 9), ("c.tif", 7)):
        batch.add(name, None, picture(1, high), ws.Layer(np.zeros((2, 2, 2), np.uint8)))
    batch.finish(as_json=False)
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "(a.tif: 1 to 9; c.tif: 1 to 7)" in told
