"""Layers of different extent, with shadows: the picture is the same whichever axis the slices lie across."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws

LOOK = ws.TransferFunction([(40, 0.0), (220, 0.05)], [(0, 0.2, 0.3, 0.8), (255, 1.0, 1.0, 0.9)])
CAMERAS = {
    "oblique": ws.Camera((60, 30, 25), (0, 0, 0), (0, 0, 1), parallel_scale=20),
    "from an eye": ws.Camera((60, 10, 5), (0, 0, 0), (0, 0, 1), view_angle=40),
    "from the other side": ws.Camera((-60, -30, 25), (0, 0, 0), (0, 0, 1), parallel_scale=20),
}


def volume(n_x):
    x, y, z = (np.linspace(-1, 1, n) for n in (n_x, 30, 30))
    wave = np.sin(3 * x[None, None] + 2) * np.cos(4 * y[None, :, None]) * (0.8 + 0.2 * np.sin(5 * z))[:, None, None]
    world_from_index = np.eye(4)
    world_from_index[:3, 3] = [-(n - 1) / 2 for n in (n_x, 30, 30)]
    return ws.Volume((120 + 100 * wave).clip(0, 255).astype(np.uint8), world_from_index=world_from_index)


def with_axes_swapped(of):
    samples = np.ascontiguousarray(np.asarray(of.samples).transpose(2, 1, 0))
    return ws.Volume(samples, world_from_index=np.array(of.world_from_index)[:, [2, 1, 0, 3]])


@pytest.mark.parametrize("name", CAMERAS)
def test_light_beyond_the_first_layer(name):
    short_and_long = [volume(10), volume(40)]
    shading = ws.Shading(ambient_occlusion=0.8, shadow=0.5)
    pictures = [
        ws.Scene(volumes, [LOOK, LOOK], shading=shading).render(CAMERAS[name], size=(90, 90))
        for volumes in (short_and_long, [with_axes_swapped(one) for one in short_and_long])
    ]
    assert pictures[0].rgba[..., 3].max() > 0.3
    assert np.abs(pictures[0].rgba - pictures[1].rgba).max() < 2 / 255
