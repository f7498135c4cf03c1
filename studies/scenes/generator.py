"""Random scenes: volumes, looks, labels, clips, lights and cameras of all kinds, each by its number.

A scene is a function of a seed and a number alone. What it is made of is drawn in one order, and every part has its own
stream of random numbers, so that a scene can be drawn again without one of its parts (`Parts`) and the rest stays.
"""

# ruff: noqa: INP001 - beside a script, not in a package
from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

SIZE = (28, 24)

KERNELS = ("linear", "catmull-rom", "bspline2", "bspline3", "gaussian")
TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8", "f2", ">i2", ">f4", "?", "i8", "u8", ">u2")
MATTER = ("waves", "blobs", "bodies", "noise")


@dataclass(frozen=True)
class Scene:
    """A random scene with its camera and kernel."""

    seed: int
    number: int
    #: Words for the parts of the scene, which the report counts.
    traits: tuple[str, ...]
    scene: ws.Scene
    camera: ws.Camera
    kernel: Any
    #: Samples of each layer as they were made, [z, y, x], of any type.
    samples: tuple[NDArray[Any], ...]

    def draw(self, quality: Any = "normal", **options: Any) -> NDArray[np.float64]:
        """Draw the scene by the renderer."""
        picture = ws.render(
            self.scene, camera=self.camera, size=SIZE, kernel=self.kernel, quality=quality, device="cpu", **options
        )
        return np.asarray(picture.rgba, np.float64)

    def cast(self, step: float = 0.1, rays_per_pixel: int = 16) -> NDArray[np.float64]:
        """Draw the scene by the reference ray caster."""
        picture = ws.reference.raycast(
            self.scene,
            camera=self.camera,
            size=SIZE,
            kernel=self.kernel,
            step=step,
            rays_per_pixel=rays_per_pixel,
        )
        return np.asarray(picture.rgba, np.float64)


@dataclass(frozen=True)
class Parts:
    """Parts of a random scene that are drawn."""

    missing: bool = True
    labels: bool = True
    clips: bool = True
    light: bool = True
    layers: bool = True
    #: Surfaces, lines and points, which scenes have only where they are asked for.
    geometry: bool = False
    #: Kernel to draw with, in place of the scene's own.
    kernel: str | None = None


@dataclass
class _Draw:
    """Generator of a scene: a stream of random numbers for each part, and the traits so far."""

    seed: int
    number: int
    traits: list[str] = field(default_factory=list)

    def stream(self, part: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, self.number, part])


def scene(seed: int, number: int, parts: Parts | None = None) -> Scene:
    """The scene of a seed and a number."""
    parts = parts or Parts()
    draw = _Draw(seed, number)
    random = draw.stream(0)
    kernel = str(random.choice(KERNELS))
    n_layers = int(random.choice([1, 1, 1, 2, 3]))
    shape = tuple(int(n) for n in random.integers(5, 19, 3))
    affine = _affine(draw)
    layers, samples = [], []
    for k in range(n_layers if parts.layers else 1):
        # Further layers lie elsewhere, and have shapes and spacings of their own.
        own_shape = shape if k == 0 else tuple(int(n) for n in draw.stream(20 + k).integers(5, 19, 3))
        own = affine if k == 0 else _beside(draw, k, affine, shape, own_shape)
        layer, made = _layer(draw, k, own_shape, own, parts)
        layers.append(layer)
        samples.append(made)
    if len(layers) > 1:
        draw.traits.append(f"{len(layers)} layers")
    first = layers[0].volume
    whole = ws.Scene(
        layers,
        labels=_labels(draw, shape) if parts.labels else None,
        shading=_shading(draw) if parts.light else None,
        clip=_clips(draw, first) if parts.clips else (),
    )
    if parts.geometry:
        whole = whole.with_(geometry=_geometry(draw, first))
    camera = _camera(draw, first)
    kernel = parts.kernel or kernel
    return Scene(seed, number, (kernel, *draw.traits), whole, camera, kernel, tuple(samples))


def _affine(draw: _Draw) -> NDArray[np.float64]:
    """World from index: spacings from 1e-6 to 1e6, along one axis up to three times those of another; maybe sheared."""
    random = draw.stream(1)
    spacing = 10.0 ** random.choice([-6, -3, 0, 0, 0, 3, 6]) * np.exp(random.uniform(0, np.log(3), 3))
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    matrix = np.diag(spacing)
    if random.random() < 0.4:
        draw.traits.append("sheared")
        shear = np.eye(3)
        shear[np.triu_indices(3, 1)] = random.uniform(-0.5, 0.5, 3)
        matrix = turn @ matrix @ shear
    affine = np.eye(4)
    affine[:3, :3] = matrix
    affine[:3, 3] = spacing * random.uniform(-20, 20, 3)
    return affine


def _beside(
    draw: _Draw, k: int, affine: NDArray[np.float64], shape: tuple[int, ...], own: tuple[int, ...]
) -> NDArray[np.float64]:
    """World from index of a grid along the axes of the first, partly beside it."""
    random = draw.stream(30 + k)
    extent = np.array(shape[::-1]) - 1.0
    steps = extent / (np.array(own[::-1]) - 1.0) * random.uniform(0.5, 1.1, 3)
    start = extent * random.uniform(-0.2, 0.4, 3)
    placed = np.eye(4)
    placed[:3, :3] = np.diag(steps)
    placed[:3, 3] = start
    return affine @ placed


def _field(random: np.random.Generator, shape: tuple[int, ...], matter: str) -> NDArray[np.float64]:
    """Random samples from 0 to 1: waves, blobs, bodies or noise."""
    z, y, x = np.meshgrid(*(np.arange(n, dtype=float) for n in shape), indexing="ij")
    if matter == "waves":
        total = np.zeros(shape)
        for _ in range(4):
            # Waves of 5 to 20 samples, which a sampled volume represents well.
            wave = random.normal(size=3)
            wave *= random.uniform(0.05, 0.2) * 2 * np.pi / np.linalg.norm(wave)
            total += np.cos(x * wave[0] + y * wave[1] + z * wave[2] + random.uniform(0, 2 * np.pi))
    elif matter in ("blobs", "bodies"):
        total = np.zeros(shape)
        for _ in range(6):
            center = random.random(3) * (np.array(shape[::-1]) - 1)
            radius = random.uniform(1.5, 4.5)
            distance = np.sqrt((x - center[0]) ** 2 + (y - center[1]) ** 2 + (z - center[2]) ** 2)
            # A scanner's blur is about a sample wide.
            height = random.uniform(0.3, 1)
            edge = 1 / (1 + np.exp((distance - radius) / 0.4))
            total = np.maximum(total, height * (edge if matter == "bodies" else np.exp(-((distance / radius) ** 2))))
    else:
        total = random.normal(size=shape)
        for axis in range(3):
            total = 0.25 * np.roll(total, 1, axis) + 0.5 * total + 0.25 * np.roll(total, -1, axis)
    lowest, highest = total.min(), total.max()
    scaled: NDArray[np.float64] = (total - lowest) / max(highest - lowest, 1e-9)
    return scaled


def _layer(
    draw: _Draw, k: int, shape: tuple[int, ...], affine: NDArray[np.float64], parts: Parts
) -> tuple[ws.Layer, NDArray[Any]]:
    """A layer, and its samples as they were made."""
    random = draw.stream(40 + k)
    matter, kind = str(random.choice(MATTER)), np.dtype(str(random.choice(TYPES)))
    values = _field(random, shape, matter)
    if kind.kind == "b":
        samples: NDArray[Any] = values > 0.5
        low, high = 0.0, 1.0
    elif kind.kind == "f":
        low, high = sorted(random.uniform(-1, 1, 2) * 10.0 ** random.integers(-3, 4))
        high = max(high, low + 1e-3 * max(abs(low), 1e-3))
        samples = (low + (high - low) * values).astype(kind)
    else:
        info = np.iinfo(kind)
        low, high = (max(info.min, -1000), min(info.max, 30000)) if kind.itemsize > 1 else (info.min, info.max)
        samples = np.round(low + (high - low) * values).astype(kind)
    missing = draw.stream(50 + k)
    if kind.kind == "f" and missing.random() < 0.5:
        mask = _missing(missing, shape)
        if parts.missing:
            draw.traits.append("missing")
            samples[mask] = missing.choice([np.nan, np.inf, -np.inf])
    draw.traits += [matter] if k == 0 else []
    look = draw.stream(60 + k)
    function = _look(look, draw, k, float(low), float(high))
    opacity = float(look.choice([1.0, 1.0, 0.6]))
    return ws.Layer(ws.Volume(samples, world_from_index=affine), function, opacity=opacity), samples


def _missing(random: np.random.Generator, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Mask of missing samples: lone ones, or a ball, or all on one side of a plane."""
    form = random.integers(3)
    if form == 0:
        lone: NDArray[np.bool_] = random.random(shape) < random.choice([0.002, 0.05])
        return lone
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, n) for n in shape), indexing="ij")
    if form == 1:
        center = random.uniform(-0.6, 0.6, 3)
        return np.asarray((x - center[0]) ** 2 + (y - center[1]) ** 2 + (z - center[2]) ** 2 < 0.3)
    normal = random.normal(size=3)
    return np.asarray(x * normal[0] + y * normal[1] + z * normal[2] > 0.5 * np.linalg.norm(normal))


def _look(random: np.random.Generator, draw: _Draw, k: int, low: float, high: float) -> ws.TransferFunction:
    def value(share: float) -> float:
        return low + (high - low) * share

    def rgb() -> tuple[float, float, float]:
        r, g, b = random.random(3)
        return float(r), float(g), float(b)

    is_hard = random.random() < 0.35
    most = 1.0 if random.random() < 0.1 else float(random.uniform(0.1, 0.95))
    if is_hard:
        edge = float(random.uniform(0.25, 0.75))
        opacity = [(value(edge), 0.0), (value(edge + 0.02), most)]
    else:
        places = np.sort(random.random(int(random.integers(2, 5))))
        opacity = [(value(float(p)), most * float(random.random())) for p in places + 1e-3 * np.arange(len(places))]
    if k == 0:
        draw.traits.append("hard" if is_hard else "soft")
    color = [(value(share), *rgb()) for share in (0.0, 0.5, 1.0)]
    return ws.TransferFunction(opacity, color)


def _labels(draw: _Draw, shape: tuple[int, ...]) -> ws.Labels | None:
    random = draw.stream(2)
    if random.random() > 0.3:
        return None
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, n) for n in shape), indexing="ij")
    codes = np.zeros(shape, np.uint16)
    for number in (1, 2, 3):
        center, radii = random.uniform(-0.7, 0.7, 3), random.uniform(0.3, 0.8, 3)
        inside = sum(((c - m) / r) ** 2 for c, m, r in zip((x, y, z), center, radii, strict=True)) < 1
        codes[inside] = number
    smooth = bool(random.random() < 0.5)
    draw.traits.append("smooth labels" if smooth else "hard labels")
    present = [number for number in (1, 2, 3) if (codes == number).any()]
    looks = {}
    for number in present:
        r, g, b = (float(c) for c in random.random(3))
        kind = random.integers(3)
        if kind == 0:
            scan = None if random.random() < 0.5 else float(random.random())
            looks[number] = ws.Label((r, g, b), opacity=float(random.uniform(0.1, 1)), scan=scan)
        elif kind == 1:
            looks[number] = ws.Label((r, g, b), opacity=0, tint=float(random.uniform(0.3, 1)))
        else:
            looks[number] = ws.Label((r, g, b), opacity=0, scan=float(random.random()))
    return ws.Labels(codes, looks, smooth=smooth) if looks else None


def _shading(draw: _Draw) -> ws.Shading | None:
    random = draw.stream(3)
    kind = random.integers(3)
    if kind == 0:
        return None
    draw.traits.append("light")
    if kind == 1:
        return ws.Shading.headlight()
    direction = random.normal(size=3)
    frame: Any = "world" if random.random() < 0.5 else "camera"
    lights = (ws.Light(tuple(direction), frame=frame),) if random.random() < 0.5 else ()
    return ws.Shading(lights=lights)


def _clips(draw: _Draw, volume: ws.Volume) -> tuple[ws.Crop | ws.ClipPlane | ws.CutOut, ...]:
    random = draw.stream(4)
    if random.random() > 0.4:
        return ()
    kind = random.integers(3)
    last = np.array(volume.shape[::-1]) - 1.0
    if kind == 0:
        draw.traits.append("crop")
        lower = last * random.uniform(0, 0.4, 3)
        return (ws.Crop(lower, last * random.uniform(0.6, 1, 3), space="index"),)
    matrix = volume.world_from_index
    center = matrix[:3, :3] @ (last / 2) + matrix[:3, 3]
    if kind == 1:
        draw.traits.append("plane")
        # The normal is one of index space, so that the plane cuts through any grid.
        normal = np.linalg.inv(matrix[:3, :3]).T @ random.normal(size=3)
        return (ws.ClipPlane(center, normal / np.linalg.norm(normal)),)
    draw.traits.append("cut-out")
    corner = last * random.uniform(0.3, 0.7, 3)
    return (ws.CutOut(ws.Crop((-1, -1, -1), corner, space="index")),)


def _geometry(draw: _Draw, volume: ws.Volume) -> list[Any]:
    """One to three shapes in the box of a volume and around it."""
    random = draw.stream(6)
    last = np.array(volume.shape[::-1]) - 1.0
    matrix = volume.world_from_index
    size = float(np.min(np.linalg.norm(matrix[:3, :3] * last, axis=0)))

    def places(n: int) -> NDArray[np.float64]:
        return np.asarray(random.uniform(-0.2, 1.2, (n, 3)) * last @ matrix[:3, :3].T + matrix[:3, 3])

    shapes: list[Any] = []
    for _ in range(int(random.integers(1, 4))):
        kind = str(random.choice(["triangles", "balls", "tubes", "strokes", "discs"]))
        r, g, b = (float(c) for c in random.random(3))
        look: Any = {"color": (r, g, b), "opacity": float(random.choice([1.0, 0.7, 0.3]))}
        look |= {"lit": bool(random.random() < 0.7), "clipped": bool(random.random() < 0.3)}
        draw.traits.append(kind)
        if kind == "triangles":
            normals: Any = random.choice(["flat", "smooth"])
            shapes.append(ws.Surface(places(6), [[0, 1, 2], [2, 1, 3], [3, 4, 5]], normals=str(normals), **look))
        elif kind == "balls":
            shapes.append(ws.Points(places(4), radius=size * random.uniform(0.05, 0.3), **look))
        elif kind == "tubes":
            shapes.append(ws.Lines([places(4), places(2)], radius=size * random.uniform(0.03, 0.15), **look))
        elif kind == "strokes":
            shapes.append(ws.Lines([places(4), places(3)], width=float(random.uniform(1, 4)), **look))
        else:
            shapes.append(ws.Points(places(5), size=float(random.uniform(2, 8)), **look))
    return shapes


def _camera(draw: _Draw, volume: ws.Volume) -> ws.Camera:
    random = draw.stream(5)
    angles = (float(random.uniform(-180, 180)), float(random.uniform(-85, 85)))
    if random.random() < 0.15:
        draw.traits.append("along an axis")
        angles = (float(random.choice([0, 90, 180, 270])), float(random.choice([0, 0, 90, -90])))
    is_perspective = random.random() < 0.5
    view_angle = float(random.uniform(15, 60)) if is_perspective else None
    aspect = SIZE[0] / SIZE[1]
    camera = ws.Camera.orbit(
        volume, *angles, zoom=float(random.uniform(0.8, 1.8)), view_angle=view_angle, aspect=aspect
    )
    draw.traits.append("perspective" if is_perspective else "parallel")
    if is_perspective and random.random() < 0.25:
        draw.traits.append("eye inside")
        share = random.uniform(0.25, 0.75, 3)
        matrix = volume.world_from_index
        inside = matrix[:3, :3] @ (share * (np.array(volume.shape[::-1]) - 1.0)) + matrix[:3, 3]
        moved = np.asarray(camera.focal_point) - np.asarray(camera.position)
        return ws.Camera(inside, inside + moved, camera.view_up, view_angle=60.0)
    return camera


def without(random_scene: Scene, **parts: Any) -> Scene:
    """A scene drawn again without some of its parts; the others stay the same."""
    return scene(random_scene.seed, random_scene.number, replace(Parts(), **parts))
