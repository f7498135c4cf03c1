"""The ripples signal drawn as it is, without samples: rays through the formula itself, as in the paper's figure 8.

Every reconstruction from samples differs from this picture by what the samples do not hold; a converged ray caster of
the samples does too. The formula is that of `wavesplat.examples.ripples` (Marschner and Lobb 1994), its gradient is
worked out by hand, and the light is that of `wavesplat.Shading`:

    colour * (ambient + diffuse |n l|) + specular max(0, r e)^power,   r = 2 (n l) n - l

Soft functions are integrated with midpoints, `1 - exp(-tau * step)`; a step from clear to opaque is a surface, which is
looked for in steps and then by bisection.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

Array = NDArray[np.float64]

F_M, ALPHA = 6.0, 0.25
BISECTIONS = 24
ROWS_AT_ONCE = 8


def signal(index: Array, n: int) -> Array:
    """Values 0..255 at index positions (..., 3), x first, of a grid of n samples a side."""
    x, y, z = np.moveaxis(2 * index / (n - 1) - 1, -1, 0)
    wave = np.cos(2 * np.pi * F_M * np.cos(np.pi * np.hypot(x, y) / 2))
    return np.asarray(255 * (1 - np.sin(np.pi * z / 2) + ALPHA * (1 + wave)) / (2 * (1 + ALPHA)))


def gradient(index: Array, n: int) -> Array:
    """Gradient of the signal, per index step."""
    x, y, z = np.moveaxis(2 * index / (n - 1) - 1, -1, 0)
    r = np.maximum(np.hypot(x, y), 1e-12)
    inner = 2 * np.pi * F_M * np.cos(np.pi * r / 2)
    along_r = ALPHA * np.sin(inner) * 2 * np.pi * F_M * np.sin(np.pi * r / 2) * np.pi / 2
    along_z = -np.cos(np.pi * z / 2) * np.pi / 2
    scale = 255 / (2 * (1 + ALPHA)) * 2 / (n - 1)
    return np.asarray(scale * np.stack([along_r * x / r, along_r * y / r, along_z], axis=-1))


def lit(rgb: Array, normal: Array, to_eye: Array) -> Array:
    """Shaded colours under one white headlight."""
    shading = ws.Shading.headlight()
    unit = normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    n_l = unit @ to_eye
    # The light is where the eye is: r e = 2 (n e)^2 - 1.
    highlight = np.maximum(2 * n_l**2 - 1, 0) ** shading.specular_power
    weight = shading.ambient + shading.diffuse * np.abs(n_l)
    return np.asarray(rgb * weight[..., None] + shading.specular * highlight[..., None])


class Rays:
    """Parallel rays through the unit grid of n samples a side: where they enter it, and how far they run in it."""

    def __init__(self, camera: ws.Camera, n: int, size: tuple[int, int], per_axis: int) -> None:
        self.n = n
        width, height = size
        if camera.parallel_scale is None:
            raise ValueError("the signal is drawn in parallel projection only")
        forward = np.subtract(camera.focal_point, camera.position)
        self.forward: Array = forward / np.linalg.norm(forward)
        right = np.cross(self.forward, camera.view_up)
        right /= np.linalg.norm(right)
        up = np.cross(right, self.forward)
        x = (np.arange(width * per_axis) + 0.5) / per_axis
        y = (np.arange(height * per_axis) + 0.5) / per_axis
        per_pixel = camera.parallel_scale / (height / 2)
        across = (x - width / 2) * per_pixel
        down = (height / 2 - y) * per_pixel
        self.origin: Array = np.asarray(camera.position) + across[None, :, None] * right + down[:, None, None] * up
        # Slabs between opposite faces; a ray along a face divides by nearly nothing.
        direction = np.where(np.abs(self.forward) < 1e-12, 1e-12, self.forward)
        ends = np.sort(np.stack([(0 - self.origin) / direction, (n - 1 - self.origin) / direction]), axis=0)
        self.near: Array = ends[0].max(axis=-1)
        self.far: Array = ends[1].min(axis=-1)

    def at(self, rows: slice, distance: Array) -> Array:
        """Positions at distances from the eye."""
        return np.asarray(self.origin[rows, :, None, :] + distance[..., None] * self.forward)


def steps(rays: Rays, rows: slice, step: float) -> tuple[Array, Array]:
    """Distances that cut the part of each ray inside the grid into equal parts about a step long, and their length."""
    near = rays.near[rows]
    length = np.maximum(rays.far[rows] - near, 0)
    n_steps = max(1, int(np.ceil(length.max() / step)))
    each = length / n_steps
    return near[..., None] + each[..., None] * np.arange(n_steps + 1), each


def soft_rows(rays: Rays, rows: slice, tf: ws.TransferFunction, step: float) -> Array:
    """Pixels of some rows, by emission and absorption along their rays."""
    cuts, each = steps(rays, rows, step)
    if not each.any():
        return np.zeros((*each.shape, 4))
    position = rays.at(rows, (cuts[..., 1:] + cuts[..., :-1]) / 2)
    rgba = tf(signal(position, rays.n).ravel()).reshape(*position.shape[:-1], 4)
    # Opacities are per sample distance, which is 1.
    alpha = 1 - (1 - rgba[..., 3]) ** each[..., None]
    color = lit(rgba[..., :3], gradient(position, rays.n), -rays.forward)
    before = np.cumprod(1 - alpha, axis=-1)
    through = np.concatenate([np.ones_like(before[..., :1]), before[..., :-1]], axis=-1)
    weight = alpha * through
    return np.concatenate([(weight[..., None] * color).sum(axis=-2), weight.sum(axis=-1)[..., None]], axis=-1)


def hard_rows(rays: Rays, rows: slice, tf: ws.TransferFunction, step: float) -> Array:
    """Pixels of some rows, by the first place on their rays where the function is opaque."""
    cuts, each = steps(rays, rows, step)
    edge = tf.opacity[-1][0]
    is_inside = signal(rays.at(rows, cuts), rays.n) >= edge
    hit = is_inside.any(axis=-1) & (each > 0)
    first = is_inside.argmax(axis=-1)
    hi = np.take_along_axis(cuts, first[..., None], axis=-1)[..., 0]
    lo = np.where(first > 0, hi - each, hi)
    for _ in range(BISECTIONS):
        middle = (lo + hi) / 2
        inside = signal(rays.at(rows, middle[..., None])[..., 0, :], rays.n) >= edge
        lo, hi = np.where(inside, lo, middle), np.where(inside, middle, hi)
    position = rays.at(rows, hi[..., None])[..., 0, :]
    rgb = tf(np.array([edge]))[0, :3]
    color = lit(np.broadcast_to(rgb, position.shape), gradient(position, rays.n), -rays.forward)
    return np.where(hit[..., None], np.concatenate([color, np.ones_like(hit, float)[..., None]], axis=-1), 0.0)


def draw(
    tf: ws.TransferFunction,
    camera: ws.Camera,
    n: int,
    size: tuple[int, int],
    *,
    is_hard: bool,
    rays_per_axis: int = 1,
    step: float = 0.05,
) -> Array:
    """Associated RGBA (height, width, 4) of the signal on the grid of `wavesplat.examples.ripples(n)`.

    `step` in sample distances; `rays_per_axis` squared is the number of rays of a pixel, which are averaged.
    """
    rays = Rays(camera, n, size, rays_per_axis)
    work = hard_rows if is_hard else soft_rows
    height = size[1] * rays_per_axis
    parts = [
        work(rays, slice(row, min(row + ROWS_AT_ONCE, height)), tf, step) for row in range(0, height, ROWS_AT_ONCE)
    ]
    fine = np.concatenate(parts)
    return np.asarray(fine.reshape(size[1], rays_per_axis, size[0], rays_per_axis, 4).mean(axis=(1, 3)))
