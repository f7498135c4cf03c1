import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError


def test_the_bundled_scans():
    head, pelvis = ws.examples.mri_head(), ws.examples.ct_pelvis()
    assert (head.shape, head.dtype) == ((171, 171, 128), np.uint8)
    assert head.spacing == pytest.approx((1.5, 1.5, 1.5), rel=1e-5)
    assert (pelvis.shape, pelvis.dtype) == ((112, 101, 122), np.int16)
    assert pelvis.value_range == (-1207, 3382)


def test_ripples_follow_their_formula():
    volume = ws.examples.ripples(9)
    assert volume.spacing == (1, 1, 1)
    samples = volume.samples
    # On the axis r = 0, so that cos(2 pi 6 cos 0) = 1 and rho = (1 - sin(pi z / 2) + 0.5) / 2.5.
    z = np.linspace(-1, 1, 9)
    np.testing.assert_allclose(samples[:, 4, 4], 255 * (1.5 - np.sin(np.pi * z / 2)) / 2.5, rtol=1e-6)
    np.testing.assert_array_equal(samples, samples.transpose(0, 2, 1))
    with pytest.raises(ArgumentError, match="n is 1"):
        ws.examples.ripples(1)
