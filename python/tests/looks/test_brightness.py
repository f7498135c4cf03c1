"""Brightness of looks that are chosen by themselves: of the matter, whatever the box, the voxels and the padding."""

import numpy as np
import pytest

import wavesplat as ws

GREEN = np.array([0.2126, 0.7152, 0.0722])


def ball(shape, radius=5.0, value=1000.0):
    z, y, x = np.meshgrid(*[np.arange(n) - (n - 1) / 2 for n in shape], indexing="ij")
    return np.where(z * z + y * y + x * x < radius * radius, np.float32(value), np.float32(0))


def middle_of(volume, window=(0, 1000), side=6.0):
    """Green in the middle of a picture of a ball, 0..255: `side` is the height of the picture, world units."""
    look = ws.Look.channel(volume, "green", window)
    camera = ws.Camera.view(volume, "xy")
    camera = camera.zoomed(volume.shape[1] * volume.spacing[1] / side)
    picture = ws.Scene(ws.Layer(volume, look), background="black").render(camera, size=(50, 50))
    return 255 * picture.rgba[25, 25, 1]


@pytest.mark.parametrize("value", [1000, 500, 250])
def test_a_ball_is_as_bright_in_every_box_fault_2(value):
    """A green ball was 248 in a box of 64 and 119 in one of 128 x 512 x 512."""
    shapes = [(64, 64, 64), (14, 64, 64), (40, 160, 96), (96, 256, 256)]
    green = [middle_of(ws.Volume(ball(shape, value=value), spacing=(0.2, 0.2, 0.2), unit="um")) for shape in shapes]
    assert np.ptp(green) < 0.05 * np.mean(green)
    assert green[0] > 200 * value / 1000


def test_a_ball_is_as_bright_with_every_voxel_size_fault_2():
    steps = (0.1, 0.2, 0.4)
    same_voxels = [
        middle_of(ws.Volume(ball((48, 48, 48)), spacing=(step,) * 3, unit="um"), side=30 * step) for step in steps
    ]
    assert np.ptp(same_voxels) < 0.05 * np.mean(same_voxels)
    same_ball = [middle_of(ws.Volume(ball((48, 48, 48), 1.2 / step), spacing=(step,) * 3, unit="um")) for step in steps]
    assert np.ptp(same_ball) < 0.05 * np.mean(same_ball)


def cells(shape=(40, 96, 96), n=30, seed=3):
    """Blurred cells over a background of noise, counts of photons."""
    rng = np.random.default_rng(seed)
    z, y, x = np.mgrid[: shape[0], : shape[1], : shape[2]].astype(np.float32)
    light = np.full(shape, 100, np.float32)
    for cz, cy, cx in rng.uniform((5, 5, 5), np.array(shape) - 5, (n, 3)):
        squared = (z - cz) ** 2 + (y - cy) ** 2 + (x - cx) ** 2
        light += rng.uniform(300, 1500) * np.exp(-squared / (2 * rng.uniform(2, 4) ** 2))
    return rng.poisson(light).astype(np.uint16)


def test_a_crop_is_as_bright_as_the_same_place_in_the_whole_fault_2b():
    """A part of a light-sheet scan was 2.3 times as bright alone (54 and 124)."""
    samples = cells((40, 128, 128), 60)
    whole = ws.Volume(samples, spacing=(0.5, 0.5, 0.5), unit="um")
    matrix = np.diag([0.5, 0.5, 0.5, 1.0])
    matrix[:2, 3] = 20, 16
    part = ws.Volume(samples[:, 32:96, 40:72], world_from_index=matrix, unit="um")
    camera = ws.Camera.view(part, "xy")
    clip = ws.Crop((40, 32, 0), (71, 95, 39), space="index")
    means = []
    for volume, cut in ((whole, clip), (part, ())):
        scene = ws.Scene(ws.Layer(volume, ws.Look.channel(volume, "green", (140, 1200))), background="black", clip=cut)
        means.append((scene.render(camera, size=(96, 96)).rgba[..., :3] @ GREEN).mean())
    assert means[0] == pytest.approx(means[1], rel=0.05)


def test_a_padded_copy_and_its_window_are_those_of_the_scan():
    samples = cells()
    padded = np.pad(samples, ((30, 30), (20, 50), (40, 0)))
    looks = [ws.Look.auto(ws.Volume(one, spacing=(0.5, 0.5, 1), unit="um")) for one in (samples, padded)]
    here, there = (np.array(look.transfer_function.opacity) for look in looks)
    np.testing.assert_allclose(there[:, 1], here[:, 1])
    np.testing.assert_allclose(there[:, 0], here[:, 0], rtol=0.03)


@pytest.mark.parametrize("n_slices", [3, 8, 14])
def test_thin_stacks_are_as_bright_as_their_maximum_projection_fault_3(n_slices):
    """A stack of 14 slices had the mean 26 and the percentile 80, its maximum projection 101 and 223."""
    rng = np.random.default_rng(1)
    y, x = np.mgrid[:128, :128].astype(np.float32)
    light = np.full((n_slices, 128, 128), 100, np.float32)
    for cy, cx in rng.uniform(10, 118, (14, 2)):
        ring = np.exp(-(((np.hypot(y - cy, x - cx) - rng.uniform(8, 14)) / 1.5) ** 2))
        depth = np.exp(-0.5 * (np.arange(n_slices) - rng.uniform(0.3, 0.7) * n_slices) ** 2)
        light += rng.uniform(300, 1200) * depth[:, None, None] * ring
    stack = ws.Volume(rng.poisson(light).astype(np.uint16), spacing=(0.1, 0.1, 0.3), unit="um")
    look = ws.Look.auto(stack)
    window = look.transfer_function.opacity[0][0], look.transfer_function.opacity[-1][0]
    first = ws.render(stack, look, "xy", size=(160, 160), background="black")
    maximum = ws.render(stack, ws.Look.channel(stack, (0.35, 1, 0.45), window, "maximum"), "xy", size=(160, 160))
    means, tops = [], []
    for picture in (first, maximum):
        luminance = picture.rgba[..., :3] @ GREEN
        means.append(luminance.mean())
        tops.append(np.percentile(luminance, 99))
    assert means[0] > 0.6 * means[1]
    assert tops[0] > 0.8 * tops[1]
    assert tops[0] > 160 / 255
