"""Times of series of files are what the files say, else the numbers in their names (F13)."""

import h5py
import numpy as np
import pytest

import wavesplat as ws

SAMPLES = np.zeros((4, 5, 6), np.float32)


def save(path, fill=lambda _: None):
    with h5py.File(path, "w") as file:
        file["rho"] = SAMPLES
        fill(file)
    return path


def times_of(paths, **options):
    series = ws.open_series(paths, **options)
    return series.times, series.time_unit


def test_numbers_in_names_f13(tmp_path):
    for step in (0, 10, 100, 20):
        save(tmp_path / f"out_2d_{step}.h5")
    assert times_of(tmp_path / "out_2d_*.h5") == ((0, 10, 20, 100), None)


@pytest.mark.parametrize("names", [("a1_b2", "a2_b3"), ("a", "b"), ("a2", "a1"), ("x", "x1")])
def test_names_that_say_no_times(tmp_path, names):
    assert times_of([save(tmp_path / f"{name}.h5") for name in names]) == ((0, 1), None)


def test_attributes_before_names(tmp_path):
    for number, time in enumerate((0.5, 0.75, 2)):
        save(tmp_path / f"out_{number}.h5", lambda file, time=time: file.attrs.update(time=time))
    assert times_of(tmp_path / "out_*.h5") == ((0.5, 0.75, 2), None)
    save(tmp_path / "out_3.h5")  # one that says nothing
    assert times_of(tmp_path / "out_*.h5") == ((0, 1, 2, 3), None)


def test_openpmd_and_netcdf(tmp_path):
    for number in range(3):

        def openpmd(file, number=number):
            group = file.create_group(f"data/{number}")
            group.attrs.update(time=5.0 * number, timeUnitSI=1e-3)

        def netcdf(file, number=number):
            file["time"] = [6.0 * number]
            file["time"].attrs["units"] = "hours since 2001-01-01"

        save(tmp_path / f"p{number}.h5", openpmd)
        save(tmp_path / f"n{number}.h5", netcdf)
    assert times_of(tmp_path / "p*.h5", dataset="rho") == ((0, 0.005, 0.01), "s")
    assert times_of(tmp_path / "n*.h5") == ((0, 6, 12), "hours")


def test_bricks(tmp_path):
    SAMPLES.tofile(tmp_path / "a.values")
    for number in range(3):
        text = f"TIME: {number / 4}\nDATA_FILE: a.values\nDATA_SIZE: 6 5 4\nDATA_FORMAT: FLOAT\n"
        (tmp_path / f"a{number}.bov").write_text(text)
    assert times_of(tmp_path / "a*.bov") == ((0, 0.25, 0.5), None)


def test_a_time_in_another_file_is_not_followed(tmp_path):
    with h5py.File(tmp_path / "secret.h5", "w") as file:
        file["time"] = [7.0]
    paths = [
        save(tmp_path / f"o{n}.h5", lambda file: file.__setitem__("time", h5py.ExternalLink("secret.h5", "time")))
        for n in (4, 5)
    ]
    assert times_of(paths) == ((4, 5), None)
