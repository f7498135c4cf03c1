"""A ray caster in plain NumPy that shares nothing with the renderer: neither code nor method.

All of it happens in the world. A box, a crop and a clip plane are half spaces `n . x >= c`; a ray is a point and a unit
direction, so that its parameter is a length; the place of a point in the grid follows from the same normals of the
box's faces. The model is that of the docs: piecewise linear transfer function after trilinear reconstruction, a step
of length `s` has opacity `1 - (1 - a)^(s / opacity_unit)`, front to back over, Phong with the reflection vector.
Only the data of scenes, arrays and numbers, come from the tests.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Eye:
    """A camera, with half the height of the view, or with its vertical angle in degrees."""

    position: tuple[float, float, float]
    focal_point: tuple[float, float, float]
    view_up: tuple[float, float, float]
    parallel_scale: float | None = None
    view_angle: float | None = None

    def axes(self):
        """Right, up and forward, unit vectors."""
        forward = unit(np.subtract(self.focal_point, self.position))
        right = unit(np.cross(forward, self.view_up))
        return right, np.cross(right, forward), forward

    def rays(self, size, rays_per_side=1):
        """Origins and unit directions, both [row, column, ray of the pixel, xyz]; row 0 is the top."""
        width, height = size
        right, up, forward = self.axes()
        within = (np.arange(rays_per_side) + 0.5) / rays_per_side
        rows, columns, down, along = np.meshgrid(np.arange(height), np.arange(width), within, within, indexing="ij")
        x = ((columns + along) - width / 2) / (height / 2)  # from -aspect to aspect
        y = 1 - (rows + down) / (height / 2)
        x, y = (number.reshape(height, width, -1, 1) for number in (x, y))
        if self.view_angle is None:
            origins = np.asarray(self.position) + self.parallel_scale * (x * right + y * up)
            return origins, np.broadcast_to(forward, origins.shape)
        slope = np.tan(np.radians(self.view_angle) / 2)
        directions = unit(forward + slope * (x * right + y * up))
        return np.broadcast_to(np.asarray(self.position, float), directions.shape), directions


@dataclass(frozen=True)
class Light:
    """Coefficients of Phong's model, with one white light behind the eye."""

    ambient: float = 0.1
    diffuse: float = 0.7
    specular: float = 0.2
    power: float = 10.0
    gradient_offset: float = 1.0


@dataclass(frozen=True)
class Scene:
    """Samples [z, y, x] with their place in the world, curves, light, crops and clip planes."""

    samples: np.ndarray
    world_from_index: np.ndarray
    opacity: list[tuple[float, float]] = field(default_factory=lambda: [(0.0, 1.0)])
    color: list[tuple[float, float, float, float]] = field(default_factory=lambda: [(0.0, 1.0, 1.0, 1.0)])
    opacity_unit: float | None = None
    light: Light | None = None
    crop_index: tuple | None = None
    crop_world: tuple | None = None
    clip_planes: tuple = ()

    @property
    def edges(self):
        """Steps to the next sample along x, y and z, world units."""
        return [self.world_from_index[:3, axis] for axis in range(3)]

    @property
    def origin(self):
        return self.world_from_index[:3, 3]

    def index(self, points):
        """Index positions of world points: distance from a face over the distance of neighbouring slices."""
        coordinates = []
        for edge, normal in zip(self.edges, face_normals(self.edges), strict=True):
            coordinates.append((points - self.origin) @ normal / (edge @ normal))
        return np.stack(coordinates, axis=-1)

    def half_spaces(self):
        """Half spaces that bound the scene, as pairs (n, c); a point is inside where `n . x >= c` for all."""
        last = np.array(self.samples.shape[::-1]) - 1.0
        lower, upper = np.zeros(3), last
        if self.crop_index is not None:
            lower, upper = np.maximum(lower, self.crop_index[0]), np.minimum(upper, self.crop_index[1])
        spaces = []
        for axis, (edge, normal) in enumerate(zip(self.edges, face_normals(self.edges), strict=True)):
            inward = normal * np.sign(normal @ edge)
            spaces.append((inward, inward @ (self.origin + lower[axis] * edge)))
            spaces.append((-inward, -inward @ (self.origin + upper[axis] * edge)))
        if self.crop_world is not None:
            for axis, (low, high) in enumerate(zip(*self.crop_world, strict=True)):
                spaces.append((np.eye(3)[axis], low))
                spaces.append((-np.eye(3)[axis], -high))
        for point, normal in self.clip_planes:
            spaces.append((np.asarray(normal, float), np.dot(point, normal)))
        return spaces


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def face_normals(edges):
    a, b, c = edges
    return [np.cross(b, c), np.cross(c, a), np.cross(a, b)]


def passage(scene, origins, directions):
    """Entry and exit of rays, as lengths from their origin, and the half spaces that they enter and leave by."""
    entry = np.zeros(origins.shape[:-1])
    leave = np.full(origins.shape[:-1], np.inf)
    entered, left = (np.full(origins.shape[:-1], -1) for _ in range(2))
    for number, (normal, offset) in enumerate(scene.half_spaces()):
        height, rate = origins @ normal - offset, directions @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            at = -height / rate
        later, sooner = (rate > 0) & (at > entry), (rate < 0) & (at < leave)
        entry, entered = np.where(later, at, entry), np.where(later, number, entered)
        leave, left = np.where(sooner, at, leave), np.where(sooner, number, left)
        leave = np.where((rate == 0) & (height < 0), -1.0, leave)
    return entry, leave, np.stack([entered, left], axis=-1)


def length(scene, eye, size, rays_per_side=1):
    """World length of every ray inside of the scene, [row, column, ray], and the faces by which it passes."""
    entry, leave, faces = passage(scene, *eye.rays(size, rays_per_side))
    return np.maximum(leave - entry, 0), faces


def trilinear(samples, index):
    """Values at index positions (x, y, z); beyond the first and the last sample these are repeated."""
    shape = np.array(samples.shape[::-1])
    index = np.clip(index, 0, shape - 1)
    cell = np.minimum(np.floor(index).astype(int), np.maximum(shape - 2, 0))
    (i, j, k), (x, y, z) = np.moveaxis(cell, -1, 0), np.moveaxis(index - cell, -1, 0)
    i1, j1, k1 = (np.minimum(n + 1, last) for n, last in zip((i, j, k), shape - 1, strict=True))
    low = (samples[k, j, i] * (1 - x) + samples[k, j, i1] * x) * (1 - y)
    low = low + (samples[k, j1, i] * (1 - x) + samples[k, j1, i1] * x) * y
    high = (samples[k1, j, i] * (1 - x) + samples[k1, j, i1] * x) * (1 - y)
    high = high + (samples[k1, j1, i] * (1 - x) + samples[k1, j1, i1] * x) * y
    return low * (1 - z) + high * z


def world_gradient(scene, index):
    """Central differences along the grid's axes, turned into the world.

    A gradient g has g . edge = the difference along that edge, which the face normals solve: the sum of
    difference x normal / (edge . normal).
    """
    offset = scene.light.gradient_offset
    total = np.zeros(index.shape)
    for axis, (edge, normal) in enumerate(zip(scene.edges, face_normals(scene.edges), strict=True)):
        step = offset * np.eye(3)[axis]
        difference = trilinear(scene.samples, index + step) - trilinear(scene.samples, index - step)
        total += (difference / (2 * offset))[..., None] * normal / (edge @ normal)
    return total


def phong(light, color, gradient, to_eye, to_light):
    """Phong shading, lit on both sides; ambient and diffuse light have the matter's colour, the highlight is white."""
    size = np.linalg.norm(gradient, axis=-1, keepdims=True)
    exists = size > 1e-12
    normal = gradient / np.where(exists, size, 1)
    n_l = np.sum(normal * to_light, axis=-1, keepdims=True)
    reflected = 2 * n_l * normal - to_light
    r_v = np.maximum(np.sum(reflected * to_eye, axis=-1, keepdims=True), 0)
    lit = color * (light.ambient + light.diffuse * np.abs(n_l)) + light.specular * r_v**light.power
    return np.where(exists, lit, light.ambient * color)


def march(scene, eye, size, step, rays_per_side, *, with_ends=False):
    """Mask [row, column, ray] of the rays that meet the scene, and an iterator over their steps, from the eye on.

    A step gives the points in its middle as index positions, its lengths, and the rays' directions. `with_ends`:
    points from the first face to the last, with half a step at both, the trapezoid rule instead of the midpoint rule.
    """
    origins, directions = eye.rays(size, rays_per_side)
    entry, leave, _ = passage(scene, origins, directions)
    hit = leave > entry
    origins, directions, entry, way = origins[hit], directions[hit], entry[hit], (leave - entry)[hit]
    n_steps = int(np.ceil(way.max() / step))

    def steps():
        for number in range(n_steps + with_ends):
            at = entry + (number if with_ends else number + 0.5) / n_steps * way
            part = 0.5 if with_ends and number in (0, n_steps) else 1.0
            yield scene.index(origins + at[:, None] * directions), part * way / n_steps, directions

    return hit, steps()


def over(scene, eye, size, *, step, rays_per_side=2):
    """Premultiplied RGBA [row, column], the mean of each pixel's rays."""
    spacings = [np.linalg.norm(edge) for edge in scene.edges]
    opacity_unit = scene.opacity_unit or np.prod(spacings) ** (1 / 3)
    values, opacities = np.transpose(scene.opacity)
    places, *colors = np.transpose(scene.color)
    to_light = -eye.axes()[2]
    hit, steps = march(scene, eye, size, step, rays_per_side)
    picture, through = np.zeros((hit.sum(), 4)), np.ones((hit.sum(), 1))
    for index, thickness, directions in steps:
        value = trilinear(scene.samples, index)
        alpha = 1 - (1 - np.interp(value, values, opacities)) ** (thickness / opacity_unit)
        seen = alpha > 0  # only there can shading matter
        color = np.stack([np.interp(value[seen], places, channel) for channel in colors], axis=-1)
        if scene.light is not None:
            color = phong(scene.light, color, world_gradient(scene, index[seen]), -directions[seen], to_light)
        alpha = alpha[seen, None]
        picture[seen] += through[seen] * alpha * np.concatenate([color, np.ones_like(alpha)], axis=-1)
        through[seen] *= 1 - alpha
    return _per_ray(hit, picture, 0).mean(axis=2)


def project(scene, eye, size, operator, *, step, rays_per_side=1):
    """Projection by an operator: a number per pixel, the mean of its rays; NaN where one of them misses the volume."""
    hit, steps = march(scene, eye, size, step, rays_per_side, with_ends=True)
    largest, smallest, total, way = -np.inf, np.inf, 0.0, 0.0
    for index, thickness, _ in steps:
        value = trilinear(scene.samples, index)
        largest, smallest = np.maximum(largest, value), np.minimum(smallest, value)
        total, way = total + value * thickness, way + thickness
    number = {"maximum": largest, "minimum": smallest, "mean": total / way, "sum": total}[operator]
    return _per_ray(hit, number, np.nan).mean(axis=2)


def _per_ray(hit, numbers, missed):
    full = np.full((*hit.shape, *numbers.shape[1:]), missed, dtype=float)
    full[hit] = numbers
    return full
