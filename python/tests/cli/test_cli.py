import inspect
import json
import os
import signal
import subprocess
import sys
import time
import warnings
from dataclasses import replace

import numpy as np
import pytest
from tiff_pixels import tiff_pixels

import wavesplat as ws
from wavesplat import _cli
from wavesplat._model.arguments.clips import combined_clips
from wavesplat._render.arguments import chosen_camera
from wavesplat.errors import WavesplatWarning

COMMANDS = ("render", "movie", "slice", "info", "presets", "wavelet", "mesh", "demo")


def check(done, code, *, stdout="", stderr=""):
    """Exit code, all of stdout, and a part of stderr; never a traceback, and errors are one line."""
    assert done.returncode == code, done.stderr
    assert done.stdout == stdout
    assert stderr in done.stderr
    assert "Traceback" not in done.stderr
    if code:
        assert done.stderr.startswith("wavesplat: error: ")
        assert done.stderr.count("\n") == 1


def test_version_and_help(wavesplat):
    check(wavesplat("--version"), 0, stdout=f"wavesplat {ws.__version__}\n")
    for arguments in (["--help"], *([command, "--help"] for command in COMMANDS), ["info", "-h"]):
        done = wavesplat(*arguments)
        assert done.returncode == 0
        assert "Exit codes: 0 it worked; 1 the file" in done.stdout
    assert wavesplat().returncode == 2


def test_render_prints_the_path(wavesplat, ramp_file, tmp_path):
    out = tmp_path / "a.png"
    done = wavesplat("render", ramp_file, "-o", out, "--size", "32x24")
    check(done, 0, stdout=f"{out}\n")
    assert done.stderr == ""  # no progress bar without a terminal, no messages
    assert out.read_bytes().startswith(b"\x89PNG")
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["a.png", "ramp.nii.gz"]


def test_render_says_as_json_what_it_did(wavesplat, ramp_file, tmp_path):
    out, report = tmp_path / "a.tif", tmp_path / "report.json"
    command = ["render", ramp_file, "-o", out, "--size", "32x24", "--json", "--report", report, "--embed-paths"]
    done = wavesplat(*command)
    assert done.returncode == 0
    facts = json.loads(done.stdout)
    assert facts["picture"] == str(out)
    assert facts["size"] == [32, 24]
    assert facts["report"]["n_texels"] > 0
    assert json.loads(report.read_text()) == facts


def test_the_command_line_makes_the_picture_of_the_api(wavesplat, ramp_file, tmp_path):
    import tifffile

    out = tmp_path / "a.tif"
    options = "--preset grey --azimuth 30 --elevation 20 --zoom 1.5 --perspective 40 --size 40x30 --kernel bspline3"
    more = "--quality draft --background #102030 --crop-index 0,0,0,15,15,9.5 --no-shading --composite over"
    more += " --threads 1"
    assert wavesplat("render", ramp_file, "-o", out, *options.split(), *more.split()).returncode == 0
    volume, crop = ws.open(ramp_file), ws.Crop((0, 0, 0), (15, 15, 9.5), space="index")
    look = replace(ws.Look.preset("grey", volume), composite="over")
    expected = ws.render(
        volume,
        look,
        chosen_camera(None, [(volume, look)], combined_clips(crop), 40 / 30, turned=(30, 20), zoom=1.5, view_angle=40),
        size=(40, 30),
        kernel="bspline3",
        quality="draft",
        background="#102030",
        clip=crop,
        shading=None,
    )
    np.testing.assert_array_equal(tifffile.imread(out), tiff_pixels(expected))


@pytest.mark.parametrize(
    "options",
    [
        ["--composite", "maximum", "--view", "left"],
        ["--composite", "local-maximum", "--local-threshold", "100"],
        ["--composite", "depth-shaded-maximum", "--depth-shading", "1", "--preset", "grey"],
        ["--composite", "x-ray", "--attenuation=0,1e-3", "--azimuth", "30"],
        ["--composite", "sum"],
        ["--composite", "first-hit", "--iso-value", "100", "--view", "superior"],
        ["--sheets-per-slice", "1", "--oversampling", "0.5", "--background", "transparent"],
        ["--crop", "0,0,0,5,5,5", "--bits", "16", "--quiet"],
        ["--azimuth", "-30", "--spacing", "1,1,2"],
        ["--view", "left", "--azimuth", "3"],
    ],
)
def test_more_ways_to_render(wavesplat, ramp_file, tmp_path, options):
    out = tmp_path / "a.png"
    check(wavesplat("render", ramp_file, "-o", out, "--size", "16x16", *options), 0, stdout=f"{out}\n")
    assert out.stat().st_size > 0


def test_transfer_functions_from_files(wavesplat, ramp_file, tmp_path):
    (tmp_path / "tf.json").write_text(ws.TransferFunction([(0, 0), (255, 1)], [(0, 1, 1, 1)]).to_json())
    out = tmp_path / "a.png"
    check(
        wavesplat("render", ramp_file, "-o", out, "--tf", tmp_path / "tf.json", "--size", "9x9"), 0, stdout=f"{out}\n"
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "--output"),
        (["-o", "OUT"], "INPUT is missing"),
        (["IN"], "--output"),
        (["IN", "-o", "OUT", "--size", "12x"], "'12x' is not WIDTHxHEIGHT"),
        (["IN", "-o", "OUT", "--size", "0x5"], "width is 0"),
        (["IN", "-o", "OUT", "--size", "1000000x5"], "give at most 16384 pixels a side"),
        (["IN", "-o", "OUT", "--kernel", "cubic"], "'cubic' is not one of: linear"),
        (["IN", "-o", "OUT", "--composite", "add"], "'add' is not one of: over"),
        (["IN", "-o", "OUT", "--composite", "first-hit"], "--iso-value"),
        (
            ["IN", "-o", "OUT", "--local-threshold", "3"],
            "--local-threshold is for --composite local-maximum, not for over",
        ),
        (["IN", "-o", "OUT", "--composite", "x-ray", "--attenuation", "3"], "'3' is not 2 numbers"),
        (["IN", "-o", "OUT", "--quality", "best"], "'best' is not one of: draft"),
        (["IN", "-o", "OUT", "--view", "sideways"], "'sideways' is not one of: anterior"),
        (["IN", "-o", "OUT", "--preset", "bone"], "unknown preset 'bone'; did you mean ct-bone"),
        (["IN", "-o", "OUT", "--preset", "grey", "--tf", "a.json"], "--preset and --tf"),
        (["IN", "-o", "OUT", "--background", "#12"], "color is '#12'"),
        (["IN", "-o", "OUT", "--crop", "1,2,3"], "'1,2,3' is not 6 numbers"),
        (["IN", "-o", "OUT", "--crop", "50,50,50,60,60,60"], "crop"),
        (["IN", "-o", "OUT", "--perspective", "200"], "view_angle is 200"),
        (["IN", "-o", "OUT", "--zoom", "0"], "zoom is 0"),
        (["IN", "-o", "OUT", "--threads", "0"], "threads is 0"),
        (["IN", "-o", "OUT", "--bits", "12"], "bits is 12"),
        (["IN", "-o", "OUT", "--time", "1"], "time=1, but the file holds 1"),
        (["IN", "-o", "OUT", "--level", "1"], "level= has no meaning"),
        (["IN", "-o", "OUT", "--spacing", "0,1,1"], "spacing is (0, 1, 1)"),
        (["IN", "-o", "OUT", "--nothing"], "--nothing"),
    ],
)
def test_wrong_arguments_exit_with_2(wavesplat, ramp_file, tmp_path, arguments, message):
    places = {"IN": ramp_file, "OUT": tmp_path / "a.png"}
    check(wavesplat("render", *[places.get(a, a) for a in arguments], NO_COLOR="1"), 2, stderr=message)
    assert not (tmp_path / "a.png").exists()


def test_failures_exit_with_1_and_leave_nothing(wavesplat, ramp_file, tmp_path):
    out = tmp_path / "a.png"
    check(wavesplat("render", tmp_path / "no.nii", "-o", out), 1, stderr="no such file or folder; check the name: ")
    (tmp_path / "cut.nii.gz").write_bytes(ramp_file.read_bytes()[:500])
    check(wavesplat("render", tmp_path / "cut.nii.gz", "-o", out), 1, stderr="truncated")
    np.save(tmp_path / "flat.npy", np.full((4, 4, 4), 7, np.uint8))
    check(wavesplat("render", tmp_path / "flat.npy", "-o", out), 1, stderr="every sample is 7")
    np.save(tmp_path / "4d.npy", np.zeros((2, 4, 4, 4)))
    check(wavesplat("render", tmp_path / "4d.npy", "-o", out), 1, stderr="time=0..1")
    check(wavesplat("render", ramp_file, "-o", tmp_path / "no" / "a.png"), 1, stderr="folder does not exist")
    check(
        wavesplat("render", ramp_file, "-o", tmp_path / "a.gif"),
        1,
        stderr="use one of: .png, .jpg, .jpeg, .webp, .tif, .tiff, .exr, .svg, .pdf",
    )
    check(
        wavesplat("render", ramp_file, "-o", out, "--tf", tmp_path / "no.json"),
        1,
        stderr="cannot read the look",
    )
    assert not [entry for entry in tmp_path.iterdir() if "a." in entry.name]


@pytest.mark.parametrize(
    ("command", "suffix", "options"),
    [
        ("render", "png", []),
        ("slice", "exr", []),
        ("mesh", "stl", ["--iso-value", "1"]),
        ("wavelet", "wavelets", []),
    ],
)
def test_bad_outputs_are_found_before_the_work(wavesplat, tmp_path, command, suffix, options):
    def run(output, *more):
        return wavesplat(command, tmp_path / "no.nii", "-o", output, *options, *more)

    check(run(tmp_path / "no" / f"a.{suffix}"), 1, stderr="folder does not exist")
    check(run(tmp_path / "a.gif"), 1, stderr="as .gif; use one of: .")
    check(run(tmp_path / "no.nii" / f"a.{suffix}"), 1, stderr="folder does not exist")
    check(run(tmp_path / f"a.{suffix}"), 1, stderr="no such file or folder; check the name: ")
    if command in ("render", "slice"):
        check(run(tmp_path / f"a.{suffix}", "--bits", "12"), 2, stderr="bits is 12")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["render", "IN", "-o", "IN"], "INPUT and --output are the same file"),
        (["slice", "IN", "-o", "IN"], "INPUT and --output are the same file"),
        (["render", "IN", "-o", "OUT", "--report", "OUT"], "--output and --report are the same file"),
        (["render", "IN", "-o", "OUT", "--report", "IN"], "INPUT and --report are the same file"),
    ],
)
def test_no_file_is_written_over_another_of_the_command(wavesplat, tmp_path, arguments, message):
    import tifffile

    places = {"IN": tmp_path / "a.tif", "OUT": tmp_path / "." / "b.png"}
    tifffile.imwrite(places["IN"], np.random.default_rng(1).random((4, 4, 4), np.float32), photometric="minisblack")
    before = places["IN"].read_bytes()
    check(wavesplat(*[places.get(a, a) for a in arguments]), 2, stderr=message)
    assert places["IN"].read_bytes() == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.tif"]


def test_demo_finds_out_first_whether_it_can_write(wavesplat, tmp_path):
    (tmp_path / "ripples.png").mkdir()  # the last picture
    check(wavesplat("demo", "-o", tmp_path), 1, stderr="this is a folder")


def test_notes_go_to_stderr_and_quiet_stops_them(wavesplat, tmp_path):
    samples = np.zeros((4, 4, 4), np.float32)
    samples[1:3] = 1
    samples[0, 0, 0] = np.nan
    np.save(tmp_path / "a.npy", samples)
    arguments = ("render", tmp_path / "a.npy", "-o", tmp_path / "a.png", "--preset", "ct-bone", "--size", "8x8")
    loud, quiet = wavesplat(*arguments), wavesplat(*arguments, "--quiet")
    assert loud.stdout == quiet.stdout == f"{tmp_path / 'a.png'}\n"
    assert "note: 1 samples are NaN" in loud.stderr
    assert "transparent over the volume's values, 0 to 1" in loud.stderr
    assert quiet.stderr == ""


def test_warnings_are_notes_while_a_command_runs_and_not_after(monkeypatch, capsys):
    during = []

    def run(**_):
        during.append(warnings.showwarning)
        warnings.showwarning(WavesplatWarning("look here"), WavesplatWarning, "a.py", 1)
        return 0

    monkeypatch.setattr(_cli, "app", run)
    usual = warnings.showwarning
    with pytest.raises(SystemExit) as left:
        _cli.main([])
    assert left.value.code == 0
    assert during != [usual]
    assert warnings.showwarning is usual
    assert capsys.readouterr().err.splitlines() == ["wavesplat: note: look here"]


def test_info(wavesplat, ramp_file):
    facts = json.loads(wavesplat("info", ramp_file, "--json").stdout)
    assert facts["shape_zyx"] == [16, 16, 16]
    assert facts["value_range"] == [0, 255]
    assert facts["orientation"] == "RAS"
    assert facts["bounds_xyz"] == [[0, 0, 0], [15, 15, 15]]
    assert facts["n_nonfinite"] == 0
    assert facts["percentiles"]["50"] == pytest.approx(127, abs=1)
    text = wavesplat("info", ramp_file).stdout
    assert "16 x 16 x 16 (x, y, z), uint8" in text


def test_info_reads_raw(wavesplat, tmp_path):
    (tmp_path / "a.raw").write_bytes(bytes(24))
    done = wavesplat("info", tmp_path / "a.raw", "--shape", "2,3,4", "--dtype", "uint8", "--spacing", "1,2,3", "--json")
    assert json.loads(done.stdout)["spacing_xyz"] == [1, 2, 3]


@pytest.mark.parametrize("command", [command for command in COMMANDS if command != "demo"])
def test_every_command_that_reads_takes_the_options_of_open(wavesplat, command):
    options = [name for name in inspect.signature(ws.open).parameters if name != "path"]
    shown = wavesplat(command, "--help").stdout
    assert all(f"\n  --{name.replace('_', '-')} " in shown for name in options)


def test_wavelets_are_made_told_of_and_drawn(wavesplat, ramp_file, tmp_path):
    kept = tmp_path / "a.wavelets"
    done = wavesplat("wavelet", ramp_file, "-o", kept, "--family", "cdf53", "--keep", "0.1", "--json")
    facts = json.loads(done.stdout)
    assert facts["family"] == "cdf53"
    assert facts["kept_fraction"] == pytest.approx(0.1, rel=0.01)
    assert facts["n_bytes_of_file"] == kept.stat().st_size
    told = json.loads(wavesplat("info", kept, "--json").stdout)
    assert told.pop("choices") == []
    assert told == {name: facts[name] for name in told} | {"name": told["name"]}
    out = tmp_path / "a.png"
    for source, options in [
        (kept, ["--wavelet-level", "2", "--bands", "0.5,1"]),
        (ramp_file, ["--threshold", "3", "--family", "haar"]),
    ]:
        check(wavesplat("render", source, "-o", out, "--size", "16x16", *options), 0, stdout=f"{out}\n")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["info", "COEFFICIENTS", "--time", "0", "--byte-order", "big"],
            "--byte-order, --time say nothing about",
        ),
        (["render", "COEFFICIENTS", "-o", "OUT", "--threshold", "1"], "--threshold is for samples"),
        (
            ["render", "COEFFICIENTS", "-o", "OUT", "--wavelet-level", "9"],
            "'a' has 1, so give 0 to 1",
        ),
        (["wavelet", "COEFFICIENTS"], "load it with wavesplat.WaveletVolume.load"),
    ],
)
def test_wrong_arguments_about_wavelets_exit_with_2(wavesplat, tmp_path, arguments, message):
    places = {"COEFFICIENTS": tmp_path / "a.wavelets", "OUT": tmp_path / "a.png"}
    samples = np.random.default_rng(1).random((4, 4, 4), np.float32)
    ws.WaveletVolume.from_volume(ws.Volume(samples, name="a"), levels=1).save(places["COEFFICIENTS"])
    check(wavesplat(*[places.get(a, a) for a in arguments]), 2, stderr=message)


def test_demo(wavesplat, tmp_path):
    done = wavesplat("demo", "-o", tmp_path / "new" / "out")
    assert done.returncode == 0
    paths = done.stdout.splitlines()
    assert sorted(paths) == sorted(str(path) for path in (tmp_path / "new" / "out").iterdir())
    assert len(paths) == 6


@pytest.mark.skipif(sys.platform == "win32", reason="needs a pseudo-terminal")
@pytest.mark.parametrize("no_color", [False, True])
def test_the_bar_shows_on_a_terminal_and_respects_no_color(ramp_file, tmp_path, no_color):
    import pty

    leader, follower = pty.openpty()
    environment = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "80"}
    environment.pop("NO_COLOR", None)
    if no_color:
        environment["NO_COLOR"] = "1"
    command = [sys.executable, "-m", "wavesplat", "render", ramp_file, "-o", tmp_path / "a.png", "--quality", "high"]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=follower, env=environment, check=True, timeout=60)
    os.close(follower)
    shown = os.read(leader, 2**16)
    os.close(leader)
    assert b"drawing" in shown
    assert (b"\x1b[38;" in shown) != no_color
    assert done.stdout.decode() == f"{tmp_path / 'a.png'}\n"


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_ctrl_c_exits_with_130_and_leaves_nothing(tmp_path):
    np.save(tmp_path / "a.npy", np.random.default_rng(1).random((96, 96, 96), np.float32))
    # The work takes minutes, so that the command is still drawing when the signal comes.
    options = ["--size", "4000x4000", "--oversampling", "3", "--sheets-per-slice", "64", "--kernel", "bspline3"]
    command = [sys.executable, "-m", "wavesplat", "render", tmp_path / "a.npy", "-o", tmp_path / "a.png", *options]
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A shell that runs the tests in the background has them ignore the signal, and children inherit that.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509
    ) as process:
        for attempt in range(6):
            # On a busy machine the first signal may come while Python is still importing, where it can be lost.
            time.sleep(2 + 4 * attempt)
            process.send_signal(signal.SIGINT)
            try:
                stdout, stderr = process.communicate(timeout=15)
                break
            except subprocess.TimeoutExpired:
                continue
        else:
            process.kill()
            pytest.fail("six interrupts did not end the command")
    assert process.returncode == 130
    assert stdout == ""
    assert stderr == "wavesplat: interrupted; nothing was written\n"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.npy"]
