"""The surface term of materials."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError

FLESH = ws.Material("flesh", [(0, 1), (100, 1), (200, 0)], (1, 0, 0), 0.2)
BONE = ws.Material("bone", [(100, 0), (200, 1)], (1, 1, 1), 0.6)
BOTH = ws.Materials([FLESH, BONE])


@pytest.mark.parametrize("share", [0.0, 0.6, 1.0])
def test_opacity_is_the_mixture_times_the_strength(share):
    tf = BOTH.surfaces(share, thickness=4)
    for value in (20, 60, 130, 150, 177, 250):
        # D rises by 1 from 100 to 200.
        slope = 0.01 if 100 < value < 200 else 0.0
        for magnitude in (0.0, 3.0, 10.0, 20.0, 25.0, 200.0):
            strength = min(1.0, 4 * slope * magnitude)
            want = BOTH.transfer_function()([value])[0]
            got = tf([value], [magnitude])[0]
            np.testing.assert_allclose(got[3], want[3] * (1 - share + share * strength), atol=5e-3)
            np.testing.assert_allclose(got[:3], want[:3], atol=5e-3)


def test_materials_of_the_same_density_have_no_surface():
    flesh, bone = (
        ws.Material(m.name, m.probability, m.color, m.opacity, density=number) for m, number in ((FLESH, 3), (BONE, 3))
    )
    with pytest.raises(ArgumentError, match="densities or curves are equal"):
        ws.Materials([flesh, bone]).surfaces()


@pytest.mark.nightly
def test_pictures_agree_with_direct_evaluation():
    scan = ws.examples.ct_pelvis()
    tf = ws.Materials.preset("ct").surfaces(0.9, thickness=6)
    view = {"camera": ws.Camera.orbit(scan, 30, 20, zoom=14, fit="view"), "size": (28, 28)}
    got = ws.render(scan, tf, quality=ws.Sampling(16, 4), **view).rgba
    want = ws.reference.raycast(scan, tf, step=0.05, rays_per_pixel=4, **view).rgba
    assert np.abs(got - want).mean() < 1e-3
    plain = ws.render(scan, ws.Materials.preset("ct"), **view).rgba
    assert got[..., 3].mean() < plain[..., 3].mean()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"share": 1.5}, "share"),
        ({"share": -1}, "share"),
        ({"thickness": 0}, "thickness"),
        ({"thickness": float("nan")}, "thickness"),
    ],
)
def test_numbers_out_of_range(options, message):
    with pytest.raises(ArgumentError, match=message):
        BOTH.surfaces(**options)


def test_the_command_line_has_surfaces(tmp_path, ramp_file, wavesplat):
    picture = tmp_path / "a.png"
    done = wavesplat("render", ramp_file, "-o", picture, "--materials", "ct", "--surfaces", "0.8", "--size", "24x24")
    assert done.returncode == 0, done.stderr
    refused = wavesplat("render", ramp_file, "-o", tmp_path / "b.png", "--surfaces", "0.8")
    assert "give it with --materials" in refused.stderr
    assert refused.returncode != 0
