"""Absurdly large counts and lengths are refused at once, with the bound, before memory is taken."""

import tracemalloc

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._model.arguments.sampling import MAX_SIDE_PX
from wavesplat._picture.lettering import MAX_LETTERS
from wavesplat._render import arguments
from wavesplat.errors import ArgumentError, FileError, LimitError
from wavesplat.examples import BYTES_A_SAMPLE

VOLUME = ws.examples.ripples(8)
CAMERA = ws.Camera.view(VOLUME, "left")
PICTURE = ws.render(VOLUME, "grey", size=(24, 24), device="cpu")


def keys(seconds):
    return [ws.KeyFrame(0, camera=CAMERA), ws.KeyFrame(seconds, camera=CAMERA.turned(azimuth=90))]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ws.Materials.fit(VOLUME, 10**9), "materials is 1000000000; give a number from 1 to 32"),
        (lambda: ws.Materials.fit(VOLUME, [str(n) for n in range(33)]), "from 1 to 32"),
        (lambda: ws.Materials.fit(VOLUME, -1), "from 1 to 32"),
        (lambda: ws.Turn(frames=10**9), "from 1 to 432000"),
        (lambda: ws.Camera.interpolate([CAMERA], 10**9), "from 1 to 432000"),
        (lambda: ws.Camera.interpolate([CAMERA, CAMERA.zoomed(2)], 10**9, closed=True), "from 1 to 432000"),
        (lambda: ws.movie(VOLUME, "a.gif", keys(1e9), size=(8, 8)), "at most 432000"),
        (lambda: ws.movie(VOLUME, "a.gif", keys(1e308), size=(8, 8), fps=50), "at most 432000"),
        (lambda: PICTURE.annotated(title="a" * 100_000), f"the title has 100000 letters.*at most {MAX_LETTERS}"),
        (lambda: PICTURE.annotated(title="a b " * 25_000), "the title has 100000 letters"),
        (lambda: PICTURE.annotated(colorbar=True, values="a" * 100_000), "has 100000 letters"),
        (lambda: PICTURE.annotated(title="a", font_size=1000, dpi=9000), "give a smaller font_size or dpi"),
    ],
)
def test_counts_have_bounds(make, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tracemalloc.start()
    try:
        with pytest.raises(ArgumentError, match=message):
            make()
        assert tracemalloc.get_traced_memory()[1] < 8 << 20
    finally:
        tracemalloc.stop()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("n", [10**5, 10**9, 2**62])
def test_a_test_signal_that_no_memory_holds(n):
    with pytest.raises(LimitError, match="give a smaller n"):
        ws.examples.ripples(n)


def test_a_test_signal_takes_the_room_that_is_checked():
    n = 96
    tracemalloc.start()
    try:
        ws.examples.ripples(n)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert 0.9 < peak / (BYTES_A_SAMPLE * n**3) < 1.01


def test_pictures_have_the_largest_side_of_the_compiled_module(monkeypatch):
    def draw(width):
        return ws.render(VOLUME, "grey", size=(width, 1), device="cpu").rgba

    assert draw(MAX_SIDE_PX).shape == (1, MAX_SIDE_PX, 4)
    with pytest.raises(ArgumentError, match=f"size is .*at most {MAX_SIDE_PX} pixels a side"):
        draw(MAX_SIDE_PX + 1)
    monkeypatch.setattr(arguments, "MAX_SIDE_PX", 2**31)
    with pytest.raises(ArgumentError, match=f"at most {MAX_SIDE_PX} pixels a side"):
        draw(MAX_SIDE_PX + 1)


def test_a_legend_with_a_name_that_is_too_long():
    labels = ws.Labels(np.ones((8, 8, 8), np.uint8), {1: ws.Label("red", name="a" * 100_000)})
    look = ws.TransferFunction([(0, 0), (255, 0.5)], [(0, 1, 1, 1)])
    picture = ws.render(VOLUME, look, labels=labels, size=(16, 16), device="cpu")
    with pytest.raises(ArgumentError, match="a name in the legend has 100000 letters"):
        picture.annotated(legend=True)


@pytest.mark.parametrize("path", ["a" * 100_000, "a" * 100_000 + "/%04d.png", "a" * 100_000 + ".gif"])
def test_movies_with_names_that_are_too_long(path):
    with pytest.raises(FileError, match="cannot write"):
        ws.movie(VOLUME, path, ws.Turn(frames=2), size=(8, 8))


def test_a_pattern_of_very_many_digits_is_none(tmp_path):
    with pytest.raises(FileError, match="number them"):
        ws.movie(VOLUME, tmp_path / "%0999999999d.png", ws.Turn(frames=2), size=(8, 8))


@pytest.mark.parametrize(
    "rgba",
    [
        np.zeros((0, 5, 4), np.float32),
        np.zeros((5, 0, 4), np.float32),
        np.zeros((5, 5, 3), np.float32),
        np.zeros((5, 4), np.float32),
        np.zeros((5, 5, 4), np.uint8),
        np.zeros((5, 5, 4), complex),
        [[[0, 0, 0, 0]]],
        None,
    ],
)
def test_a_picture_without_pixels_is_none(rgba):
    with pytest.raises(ArgumentError, match="rgba of the picture is"):
        ws.Picture(rgba)


@pytest.mark.parametrize("name", ["depth", "value"])
def test_a_picture_has_a_number_for_each_pixel(name):
    rgba = np.zeros((3, 5, 4), np.float32)
    ws.Picture(rgba, **{name: np.zeros((3, 5), np.float32)})
    with pytest.raises(ArgumentError, match=f"{name} of the picture has shape"):
        ws.Picture(rgba, **{name: np.zeros((5, 3), np.float32)})


def test_nested_lists_are_drawn_like_their_array():
    samples = np.asarray(VOLUME.samples)
    drawn = ws.render(samples, "grey", size=(12, 12), device="cpu").rgba
    for rows in (samples.tolist(), tuple(map(tuple, samples.tolist())), list(samples)):
        np.testing.assert_array_equal(ws.render(rows, "grey", size=(12, 12), device="cpu").rgba, drawn)
        assert len(ws.Scene(rows).layers) == 1
    assert len(ws.Scene([samples, samples.tolist()]).layers) == 2
    for wrong in ([], [[1, 2], [3, 4]], [1, 2], "ab", [[["a"]]]):
        with pytest.raises(ArgumentError):
            ws.Scene(wrong)


def test_light_does_not_depend_on_the_unit_of_lengths():
    z, y, x = np.mgrid[-1:1:14j, -1:1:14j, -1:1:14j]
    samples = np.exp(-4 * (x * x + y * y + z * z)).astype(np.float32)
    look = ws.TransferFunction([(0.1, 0), (0.8, 0.9)], [(0, 1, 0.5, 0.2), (1, 1, 1, 1)])

    def drawn(spacing):
        return ws.render(ws.Volume(samples, spacing=(spacing,) * 3), look, size=(24, 24), device="cpu").rgba

    for spacing in (1e-18, 1e-9, 1e9, 1e14):
        np.testing.assert_allclose(drawn(spacing), drawn(1), atol=0.01)
    for spacing in (1e-19, 1.1e14, 1e16, 1e17):
        with pytest.raises(ArgumentError, match="give them in other units"):
            drawn(spacing)
