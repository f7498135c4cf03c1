"""ParaView's lists of files, .pvd and .series: times are theirs (A10 of sim.md)."""

from __future__ import annotations

import numpy as np
import pytest
from vti_files import save_vti
from vtk_series_files import save_pvd, save_series

import wavesplat as ws
from wavesplat.errors import FileError

SAMPLES = np.arange(60, dtype=np.float32).reshape(3, 4, 5)
TIMES = (0.0, 0.5, 1.0)
NAMES = ("a_0.vti", "a_10.vti", "a_20.vti")


@pytest.mark.parametrize(("save", "name"), [(save_pvd, "a.pvd"), (save_series, "a.vti.series")])
def test_times_are_those_of_the_list(tmp_path, wavesplat, save, name):
    for number, file in enumerate(NAMES):
        save_vti(tmp_path / file, {"v": SAMPLES + 100 * number})
    path = save(tmp_path / name, list(zip(TIMES, NAMES, strict=True))[::-1])
    series = ws.open_series(path)
    assert series.times == TIMES
    for number in range(3):
        assert np.array_equal(series[number].samples, SAMPLES + 100 * number)
    assert ws.open(path, time=1).facts.times == TIMES
    said = wavesplat("info", path).stdout
    assert "times        3, choose with --time: 0 at 0, 1 at 0.5, 2 at 1" in said
    assert "v " in said


def test_lists_that_cannot_be_a_series_say_why(tmp_path):
    save_vti(tmp_path / "a.vti", {"v": SAMPLES})
    for files, words in (
        ([(0, "a.vti"), (0, "b.vti")], r"several files at the time 0, parts of one grid.*combine\(\)"),
        ([], "names no file"),
        ([(0, "../a.vti")], "external_files"),
        ([(0, "b.vti")], "'b.vti', which is not there"),
        ([(0, "a.pvd")], "another list"),
    ):
        with pytest.raises(FileError, match=words):
            ws.open(save_pvd(tmp_path / "a.pvd", files))
