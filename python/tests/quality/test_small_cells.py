"""Label images of small cells are recognised by their values, and no picture of few grey levels is taken for one.

Fault 5 of microscopy: 256 numbered balls of radius 4 were fluorescence, since half of a small cell is border.
"""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks.kinds.kinds import kind_of

RNG = np.random.default_rng(3)
SIZE = 64


def balls(radius, n_balls, n_numbers=None):
    """Numbered balls that do not meet."""
    side = round((n_balls * (2.6 * radius) ** 3) ** (1 / 3))
    samples = np.zeros((side,) * 3, np.uint16)
    around = np.ogrid[tuple(slice(-radius, radius + 1) for _ in range(3))]
    ball = sum(place**2 for place in around) <= radius**2
    made = 0
    for middle in RNG.integers(radius, side - radius, (100_000, 3)):
        box = tuple(slice(at - radius, at + radius + 1) for at in middle)
        if not samples[box][ball].any():
            samples[box][ball] = made % (n_numbers or n_balls) + 1
            made += 1
            if made == n_balls:
                break
    return samples


def smooth(n_levels):
    """A smooth field in whole numbers, with a standard deviation of `n_levels`."""
    noise = RNG.normal(size=(SIZE,) * 3)
    wave = np.fft.fftfreq(SIZE)
    low_pass = np.exp(-(sum(np.meshgrid(wave**2, wave**2, wave**2)) * 2 * np.pi**2 * 9))
    field = np.fft.ifftn(np.fft.fftn(noise) * low_pass).real
    return field / field.std() * n_levels


def cells_without_gaps():
    """Every sample has the number of the nearest of 200 places."""
    places = RNG.integers(0, SIZE, (200, 3))
    lattice = np.stack(np.meshgrid(*[np.arange(SIZE)] * 3, indexing="ij"), -1)
    nearest = np.argmin([((lattice - place) ** 2).sum(-1) for place in places], axis=0)
    return nearest.astype(np.uint16) + 1


def shells():
    """Thirty numbered shells, one sample thick, that lie apart: pieces of bone, walls of vessels."""
    samples = np.zeros((SIZE,) * 3, np.uint8)
    away = np.sqrt(sum(place**2 for place in np.ogrid[-5:6, -5:6, -5:6]))
    shell = np.abs(away - 4) < 0.5
    for number in range(30):
        corner = 12 * np.array(np.unravel_index(number, (5, 5, 5)))
        box = tuple(slice(at, at + 11) for at in corner)
        samples[box][shell] = number + 1
    return samples


LABELS = {
    "thin shells": shells(),
    "balls of radius 2": balls(2, 256),
    "balls of radius 4": balls(4, 256),
    "balls of 3 numbers": balls(4, 100, 3),
    "large balls": balls(9, 12),
    "cells without gaps": cells_without_gaps(),
}
SCANS = {
    "single photons": RNG.poisson(0.01, (SIZE,) * 3).astype(np.uint8),
    "dots of any value": np.where(RNG.random((SIZE,) * 3) < 0.002, RNG.integers(3, 200, (SIZE,) * 3), 0).astype(
        np.uint8
    ),
    "few photons": RNG.poisson(0.5, (SIZE,) * 3).astype(np.uint8),
    "noise above a threshold": np.where(RNG.normal(size=(SIZE,) * 3) > 1, RNG.integers(99, 255, (SIZE,) * 3), 0),
    "smooth, few levels": np.clip(smooth(1.5), 0, 255).astype(np.uint8),
    "smooth, many levels": np.clip(smooth(40), 0, 255).astype(np.uint8),
    "smooth, above a threshold": np.where((field := smooth(4)) > 4, np.clip(field, 0, 255), 0).astype(np.uint8),
    "bright and dark, with noise": (100 * (smooth(1) > 1) + RNG.integers(0, 3, (SIZE,) * 3)).astype(np.uint8),
    "enlarged by repetition": np.repeat(RNG.integers(0, 255, (SIZE, SIZE, SIZE // 2)), 2, axis=2).astype(np.uint8),
}


@pytest.mark.parametrize("name", LABELS)
@pytest.mark.parametrize("dtype", ["u2", "i4", "f4"])
def test_labels_are_labels(name, dtype):
    volume = ws.Volume(LABELS[name].astype(dtype), spacing=(0.2, 0.2, 0.2), unit="um")
    assert kind_of(volume) == "labels"
    assert ws.Look.auto(volume).reason.startswith("labels")


@pytest.mark.parametrize("name", SCANS)
def test_scans_of_few_levels_are_no_labels(name):
    assert kind_of(ws.Volume(SCANS[name].astype(np.uint8))) != "labels"


def test_a_cell_has_one_colour_at_all_times():
    """Colours were by rank among the numbers of each time, so that they swapped where a cell came or went."""
    z, y, x = np.indices((24, 24, 60))
    volumes = []
    for present in ((1, 2, 3), (2, 3), (1, 2, 3)):
        samples = np.zeros((24, 24, 60), np.uint16)
        for number in present:
            samples[(z - 12) ** 2 + (y - 12) ** 2 + (x - 20 * number + 10) ** 2 < 49] = 7 * number
        volumes.append(ws.Volume(samples, unit="um"))
    scene = ws.Scene(ws.Layer(ws.Series(volumes)), background="black")
    camera = ws.Camera.view(volumes[0], "xz")
    shown = [scene.at_time(time).render(camera, size=(90, 90)).rgba for time in range(3)]
    np.testing.assert_array_equal(shown[0], shown[2])
    np.testing.assert_allclose(shown[1][:, 45:], shown[0][:, 45:], atol=0.02)
