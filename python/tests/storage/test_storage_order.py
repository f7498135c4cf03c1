"""A volume stored in another order of axes lies in the same place, so that it is framed alike."""

import itertools

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._render.framing import FILLED, _from_both_ends


def blob(shape):
    """A ball beside the middle, whose edge lies between samples."""
    z, y, x = np.mgrid[tuple(slice(0, n) for n in shape)]
    r2 = ((z - 0.47 * shape[0]) / 11.3) ** 2 + ((y - 0.55 * shape[1]) / 9.7) ** 2 + ((x - 0.4 * shape[2]) / 13.1) ** 2
    return np.exp(-r2).astype(np.float32)


def stored(samples, order, flips):
    """A volume of the same field in the world, with its axes permuted and flipped in memory."""
    n = samples.shape
    matrix = np.zeros((4, 4))
    matrix[3, 3] = 1
    for place, axis in enumerate(order):  # place in memory (z, y, x), axis of the field
        column = 2 - place
        matrix[2 - axis, column] = -1 if flips[axis] else 1
        if flips[axis]:
            matrix[2 - axis, 3] = n[axis] - 1
    turned = samples[tuple(slice(None, None, -1 if flip else 1) for flip in flips)].transpose(order)
    return ws.Volume(np.ascontiguousarray(turned), world_from_index=matrix)


STORES = [((0, 1, 2), flips) for flips in itertools.product((False, True), repeat=3)] + [
    ((2, 0, 1), (False, True, False)),
    ((1, 2, 0), (True, False, True)),
    ((0, 2, 1), (True, True, True)),
]


@pytest.mark.parametrize("shape", [(60, 70, 83), (64, 64, 64), (31, 40, 200)])
def test_framing_does_not_depend_on_the_order_of_storage(shape):
    samples = blob(shape)
    look = ws.TransferFunction([(0.3, 0), (0.9, 0.5)], [(0, 1, 1, 1), (1, 1, 1, 1)])
    cameras = [
        ws.render(stored(samples, *store), look, "isometric", size=(16, 12), device="cpu").camera for store in STORES
    ]
    for camera in cameras[1:]:
        assert camera.parallel_scale == pytest.approx(cameras[0].parallel_scale, rel=1e-6)
        np.testing.assert_allclose(camera.position, cameras[0].position, atol=1e-4)


def test_framing_of_large_volumes_is_off_by_one_sample_of_those_looked_at():
    # With more than 2 million samples the statistics are of every second one, since lazy volumes keep no more.
    shape = (130, 141, 152)
    z, y, x = np.mgrid[tuple(slice(0, n) for n in shape)]
    samples = (((z - 60.3) / 30) ** 2 + ((y - 80.7) / 25) ** 2 + ((x - 70.2) / 35) ** 2 < 1).astype(np.uint8)
    look = ws.TransferFunction([(0.5, 0), (0.6, 0.5)], [(0, 1, 1, 1)])
    scales = [
        ws.render(stored(samples, *store), look, "front", size=(8, 8), device="cpu").camera.parallel_scale
        for store in (STORES[0], STORES[3], STORES[-1])
    ]
    assert max(scales) - min(scales) <= 2 / FILLED


@pytest.mark.parametrize("step", [1, 2, 3, 7])
@pytest.mark.parametrize("n", [1, 2, 3, 8, 9, 50])
def test_places_are_the_same_from_both_ends(n, step):
    places = _from_both_ends(n, step)
    np.testing.assert_array_equal(places, n - 1 - places[::-1])
    assert places[0] == 0
    assert np.diff(places).max(initial=1) < 2 * step
