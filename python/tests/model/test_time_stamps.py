"""Times as texts: in titles, reports and names of files."""

import numpy as np
import pytest
import tifffile

import wavesplat as ws
from wavesplat._model.volume.series import FIGURE_SPACE, padded, time_texts
from wavesplat._picture import lettering
from wavesplat.errors import ArgumentError


@pytest.mark.parametrize(
    ("times", "unit", "texts"),
    [
        ((0, 30, 60), "s", ("0 s", "30 s", "60 s")),
        ((0, 0.5, 1), "min", ("0.0 min", "0.5 min", "1.0 min")),
        ((0, 0.1, 0.1 + 0.2), "s", ("0.0 s", "0.1 s", "0.3 s")),
        ((0.02, 30.01, 60.3), "s", ("0.0 s", "30.0 s", "60.3 s")),
        ((-0.001, 1), "s", ("0 s", "1 s")),
        ((0, 1, 2), None, ("0", "1", "2")),
        ((5, 5), "s", ("5 s", "5 s")),
    ],
)
def test_times_have_the_decimals_that_they_need(times, unit, texts):
    assert time_texts(times, unit) == texts


def test_padded_times_are_equally_wide():
    texts = padded(("0 s", "30 s", "120 s"))
    assert [text.count(FIGURE_SPACE) for text in texts] == [2, 1, 0]
    widths = [lettering.text_width(text, 20) for text in texts]
    assert max(widths) - min(widths) < 0.01
    assert lettering.wrapped(f"t = {texts[0]}", 20, 1000) == [f"t = {texts[0]}"]


@pytest.fixture
def recording(tmp_path):
    """A file of four time points, 30 s apart, in which a cube grows brighter beside one that does not change."""
    samples = np.full((4, 12, 24, 24), 20, np.uint16)
    samples[:, 4:8, 4:10, 4:10] = 500
    for time in range(4):
        samples[time, 4:8, 14:20, 14:20] = 100 + 600 * time
    path = tmp_path / "cells.ome.tif"
    metadata = {"axes": "TZYX", "TimeIncrement": 30.0, "TimeIncrementUnit": "s"}
    tifffile.imwrite(path, samples, metadata=metadata | {f"PhysicalSize{axis}": 0.5 for axis in "XYZ"})
    return path


def test_titles_have_the_time_of_the_picture(recording):
    """Fault 6.8: the title said `t={time}`."""
    scene = ws.open_scene(recording)
    picture = scene.at_time(3).render(size=(100, 80))
    assert picture.report.time == {"number": 3, "text": "90 s"}
    stamped, written = (picture.annotated(title=title) for title in ("t = {time}", "t = 90 s"))
    np.testing.assert_array_equal(stamped.rgba, written.rgba)
    assert "t = 90 s" in stamped._canvas.title
    # Of a volume that was opened alone, and of its slices.
    volume = ws.open(recording, time=1)
    for alone in (ws.render(volume, size=(50, 50)), ws.slice(volume, size=(50, 50))):
        assert alone.report["time"]["text"] == "30 s"


def test_a_picture_of_no_time_has_none_in_its_title():
    picture = ws.render(ws.examples.ripples(8), size=(50, 50))
    assert picture.report.time is None
    with pytest.raises(ArgumentError, match="the title has {time}, and this picture is of no time point"):
        picture.annotated(title="t = {time}")


def test_pictures_of_times_have_them_in_title_and_name(wavesplat, recording):
    """Fault 6.8: `render --times 0:3 --title "t={time}" -o '{time}.png'`."""
    folder = recording.parent
    command = ("render", recording, "--times", "0:3", "--size", "80", "--quiet")
    done = wavesplat(*command, "--title", "t={time}", "-o", "{time}.png", cwd=folder)
    assert (done.returncode, done.stdout.split()) == (0, ["00s.png", "30s.png", "60s.png"]), done.stderr
    assert wavesplat(*command, "--title", "t=30 s", "-o", "same_{time}.png", cwd=folder).returncode == 0
    assert (folder / "30s.png").read_bytes() == (folder / "same_30s.png").read_bytes()
    assert (folder / "00s.png").read_bytes() != (folder / "same_00s.png").read_bytes()
    # Drawn again from itself, it has its time.
    assert wavesplat("render", "--from", "30s.png", "-o", "again.png", cwd=folder).returncode == 0
    assert (folder / "30s.png").read_bytes() == (folder / "again.png").read_bytes()


def test_a_title_of_one_time_point_of_the_command_line(wavesplat, recording):
    folder = recording.parent
    for command in ("render", "slice"):
        given = (
            command,
            recording,
            "--time",
            "2",
            "--size",
            "80",
            "--quiet",
            "-o",
            "a.png",
            "--json",
            "--title",
            "{time}",
        )
        done = wavesplat(*given, cwd=folder)
        assert done.returncode == 0, done.stderr
        assert '"text": "60 s"' in done.stdout


def test_the_look_of_all_times_is_one_and_told(wavesplat, recording):
    command = (
        "render",
        recording,
        "--times",
        "all",
        "-o",
        "{time}.png",
        "--size",
        "60",
        "--quality",
        "draft",
        "--json",
    )
    done = wavesplat(*command, cwd=recording.parent)
    assert "note: one look for all times, chosen by the brightest of time points 0, 2 and 3" in done.stderr
    import json

    looks = [one["report"]["shown"] for one in json.loads(done.stdout)["pictures"]]
    assert len(looks) == 4
    assert all(look == looks[0] for look in looks)
    # One that was chosen by hand needs no telling.
    assert wavesplat(*command, "--cmap", "inferno", "--clim", "0,900", cwd=recording.parent).stderr == ""
