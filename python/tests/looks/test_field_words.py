"""The command line's terms of the field: options, windows by name, and hints on options that do not exist."""

from __future__ import annotations

import json

import numpy as np
import pytest
import typer
from cases_of_the_day import nightly

import wavesplat as ws
from wavesplat._cli import COMMANDS, hints, options_of
from wavesplat._cli.options import parsers


@pytest.fixture(scope="module")
def options():
    """Options of all commands, by command."""
    return {name: options_of(name) for name in COMMANDS}


@pytest.mark.parametrize(
    ("command", "option", "said"),
    [
        # Hints by similar letters would be wrong here: --shadow, --time, --level.
        ("mesh", "--window", "it is an option of wavesplat render, view, movie, slice, tf"),
        ("mesh", "--clim", "it is an option of wavesplat render, view, movie, slice, tf"),
        ("mesh", "--legend", "it is an option of wavesplat render, movie, slice"),
        ("render", "--clims", "did you mean --clim?"),
        ("render", "--mip", "write --composite mip"),
        ("slice", "--mip", "write --slab maximum"),
        ("render", "--isosurface", "write --composite isosurface --iso-value VALUE"),
        ("mesh", "--isovalue", "write --iso-value VALUE"),
        ("render", "--colormap", "write --cmap NAME"),
        ("render", "--lut", "write --cmap NAME"),
        ("render", "--vmin", "write --clim LOW,HIGH"),
        ("render", "--window-level", "write --window LEVEL,WIDTH or a name"),
        ("render", "--opacity_scale", "write --opacity NAME|A,A,..."),
        ("info", "--voxel-size", "write --spacing X,Y,Z"),
        ("render", "--fov", "write --perspective DEG"),
        ("mesh", "--fov", "write --perspective DEG with wavesplat render"),
        ("render", "--scalebar", "write --scale-bar"),
        ("slice", "--isodose", "write --isolines FILE:VALUE,..."),
        ("slice", "--isovalue", "write --isolines FILE:VALUE,..."),
        ("slice", "--structures", "write --contours FILE"),
        ("render", "--rtstruct", "write --labels FILE"),
        ("render", "--nothing-like-it", "wavesplat render --help lists the options"),
    ],
)
def test_what_is_meant(options, command, option, said):
    assert hints.of_option(option, command, options) == said


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("draw", "no such command: draw; write wavesplat render"),
        ("Show", "no such command: Show; write wavesplat view"),
        ("gpu_check", "no such command: gpu_check; did you mean gpu-check?"),
        ("rendr", "no such command: rendr; did you mean render?"),
        ("drw", "no such command: drw; did you mean render?"),
        (
            "scan.nii.gz",
            (
                "no such command: scan.nii.gz; for a picture of a file write wavesplat render scan.nii.gz, "
                "to look at it wavesplat view scan.nii.gz"
            ),
        ),
        ("xyzzy", "no such command: xyzzy; wavesplat --help lists the commands"),
    ],
)
def test_an_unknown_command_comes_with_a_hint(wavesplat, name, said):
    done = wavesplat(name)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"wavesplat: error: {said}\n")


def test_hints_name_commands_that_there_are(options):
    assert sorted(set(hints.COMMANDS.values()) - set(options)) == []
    assert sorted(set(hints.COMMANDS) & set(options)) == []


def test_hints_name_options_that_there_are(options):
    known = {option for own in options.values() for option in own}
    offered = {text.split(" ")[0] for texts in hints.OPTIONS.values() for text in texts}
    assert sorted(offered - known) == []


def test_an_unknown_option_is_one_line(wavesplat):
    done = wavesplat("render", "a.nii", "-o", "a.png", "--colourmap", "hot")
    assert (done.returncode, done.stderr) == (
        2,
        "wavesplat: error: no such option: --colourmap; write --cmap NAME\n",
    )
    assert "--azimuth' requires an argument" in wavesplat("render", "a.nii", "--azimuth").stderr
    assert "no such option: --no-such" in wavesplat("--no-such").stderr


def test_one_number_is_a_square():
    assert parsers.size("800") == (800, 800)
    assert parsers.size("800X600") == (800, 600)
    for text in ("800x", "x", "", "8x8x8", "big"):
        with pytest.raises(typer.BadParameter, match="such as 800x600, or 800"):
            parsers.size(text)


@pytest.mark.parametrize("window", ["bone", "400,1800"])
def test_windows_of_radiologists_are_limits(wavesplat, tmp_path, window):
    samples = np.linspace(-1000, 1500, 16**3).reshape(16, 16, 16).astype(np.int16)
    scan = tmp_path / "scan.nrrd"
    ws.Volume(samples, unit="mm", anatomical=True, facts=ws.Facts(modality="CT")).save(scan)
    pictures = []
    for number, options in enumerate((["--window", window], ["--clim=-500,1300"])):
        out = tmp_path / f"{number}.png"
        done = wavesplat("render", scan, "-o", out, "--composite", "mip", "--cmap", "gray", "--size", "16", *options)
        assert (done.returncode, done.stderr) == (0, "")
        pictures.append(out.read_bytes())
    assert pictures[0] == pictures[1]


# wavesplat tf ---------------------------------------------------------------------------------------------------------


# By day without options and with two; presets and operators are printed as maps are.
@pytest.mark.parametrize(
    "options", [[], ["--cmap", "hot", "--clim", "9,99"], *nightly(["--preset", "grey"], ["--composite", "mip"])]
)
def test_the_look_that_is_printed_draws_the_same(wavesplat, ramp_file, tmp_path, options):
    done = wavesplat("tf", ramp_file, *options)
    assert (done.returncode, done.stderr) == (0, "")
    (tmp_path / "look.json").write_text(done.stdout)
    assert wavesplat("tf", ramp_file, *options, "-o", tmp_path / "again.json").returncode == 0
    assert (tmp_path / "again.json").read_text() == done.stdout
    for out, given in (("a.png", options), ("b.png", ["--tf", tmp_path / "look.json"])):
        assert wavesplat("render", ramp_file, "-o", tmp_path / out, "--size", "16", *given).returncode == 0
    from PIL import Image

    a, b = (np.asarray(Image.open(tmp_path / name)) for name in ("a.png", "b.png"))
    np.testing.assert_array_equal(a, b)


def test_an_edited_function_is_the_one_that_is_drawn(wavesplat, ramp_file, tmp_path):
    document = json.loads(wavesplat("tf", ramp_file, "--composite", "mean").stdout)
    document["transfer_function"]["color"] = [[0, 1, 0, 0], [255, 1, 0, 0]]
    (tmp_path / "red.json").write_text(json.dumps(document))
    out = tmp_path / "a.png"
    assert wavesplat("render", ramp_file, "-o", out, "--size", "16", "--tf", tmp_path / "red.json").returncode == 0
    from PIL import Image

    pixels = np.asarray(Image.open(out).convert("RGB"))
    assert (pixels[..., 0].max(), pixels[..., 1:].max()) == (255, 0)


def test_nodes_stand_in_one_line():
    text = ws.TransferFunction([(0, 0), (100, 0.5)], [(0, 1, 0.5, 0.25), (100, 1, 1, 1)]).to_json()
    assert text.splitlines() == [
        "{",
        '  "version": 1,',
        '  "opacity_unit": null,',
        '  "opacity": [[0.0, 0.0], [100.0, 0.5]],',
        '  "color": [[0.0, 1.0, 0.5, 0.25], [100.0, 1.0, 1.0, 1.0]]',
        "}",
    ]


# Several inputs -------------------------------------------------------------------------------------------------------


@pytest.fixture
def scans(tmp_path):
    """Two folders with a scan of one name each, and one besides."""
    for number, name in enumerate(("one/scan", "two/scan", "two/b.c")):
        path = tmp_path / f"{name}.nii.gz"
        path.parent.mkdir(exist_ok=True)
        ws.Volume(np.linspace(0, 9 + number, 8**3).reshape(8, 8, 8).astype(np.float32)).save(path)
    return tmp_path


def drawn(wavesplat, folder, *arguments):
    done = wavesplat("render", *arguments, "--size", "8", "--quiet", cwd=folder)
    return done, sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.suffix in (".png", ".jpg"))


def test_patterns_and_names_of_outputs(wavesplat, scans):
    done, found = drawn(wavesplat, scans, "two/*.nii.gz", "one/scan.nii.gz", "-o", "{folder}-{stem}.png")
    assert (done.returncode, done.stdout) == (0, "two-b.c.png\ntwo-scan.png\none-scan.png\n")
    assert found == ["one-scan.png", "two-b.c.png", "two-scan.png"]
    # The pictures are those of the scans drawn one by one.
    drawn(wavesplat, scans, "one/scan.nii.gz", "-o", "{stem}_{number}_{time}.png")
    assert (scans / "scan_1_{time}.png").read_bytes() == (scans / "one-scan.png").read_bytes()


def test_a_folder_for_outputs(wavesplat, scans):
    (scans / "out").mkdir()
    done, found = drawn(wavesplat, scans, "two/*", "-o", "out")
    assert (done.returncode, found) == (0, ["out/b.c.png", "out/scan.png"])
    assert wavesplat("tf", "one/scan.nii.gz", "-o", "out", cwd=scans).stdout == "out/scan.json\n"


def test_one_that_fails_does_not_stop_the_others(wavesplat, scans):
    (scans / "one" / "broken.nii.gz").write_bytes(b"no")
    done, found = drawn(wavesplat, scans, "one/*", "-o", "{stem}.png", "--json")
    assert (done.returncode, found) == (1, ["scan.png"])
    assert [result["picture"] for result in json.loads(done.stdout)["results"]] == ["scan.png"]
    assert [line for line in done.stderr.splitlines() if "broken.nii.gz" in line]
    assert done.stderr.splitlines()[-1] == "wavesplat: 1 of 2 inputs failed"


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["two/*.nii.gz", "-o", "a.png"], 2, r"2 volumes, and --output names one file; write {stem} in its name"),
        (["two/*.nii.gz", "-o", "{stem}.png", "--report", "a.json"], 2, "--report names one file; write {stem}"),
        (["one/*", "two/*", "-o", "{stem}.png"], 2, "would be one file, scan.png; write {folder} or {number}"),
        (["*.nii", "-o", "{stem}.png"], 1, "no file matches this pattern; check the name: *.nii"),
        (["one/*", "two/*", "-o", "{number}.png", "--preset", "no-such"], 2, "unknown preset 'no-such'"),
    ],
)
def test_what_cannot_be_is_said_before_anything_is_drawn(wavesplat, scans, arguments, code, message):
    done, found = drawn(wavesplat, scans, *arguments)
    assert (done.returncode, done.stdout, found, done.stderr.count("\n")) == (code, "", [], 1)
    assert message in done.stderr


def test_info_of_several(wavesplat, scans):
    done = wavesplat("info", "*/*.nii.gz", cwd=scans)
    titles = [line for line in done.stdout.splitlines() if line.endswith(".nii.gz") and " " not in line]
    assert (done.returncode, titles) == (0, ["one/scan.nii.gz", "two/b.c.nii.gz", "two/scan.nii.gz"])
    results = json.loads(wavesplat("info", "*/*.nii.gz", "--json", cwd=scans).stdout)["results"]
    assert [result["name"] for result in results] == ["scan.nii.gz", "b.c.nii.gz", "scan.nii.gz"]


def test_a_name_with_marks_of_patterns_is_itself(wavesplat, scans):
    (scans / "one" / "scan.nii.gz").rename(scans / "one" / "scan[1].nii.gz")
    done, found = drawn(wavesplat, scans, "one/scan[1].nii.gz", "-o", "{stem}.png")
    assert (done.returncode, found) == (0, ["scan[1].png"])
    (scans / "one").rename(scans / "[1]")
    done, found = drawn(wavesplat, scans, "[1]/s*.gz", "-o", "{stem}.png")
    assert (done.returncode, found) == (0, ["scan[1].png"])
