"""Times of surfaces, lines and points in the picture, and pictures beside VTK's: `make bench-shapes`.

Draws the bundled CT, 512 x 512, on the CPU, without shapes and with: 200,000 triangles, opaque and clear; 100,000
balls; 10,000 paths of 100 positions, as strokes of two pixels and as tubes; 5 million triangles. Told are the median
processor and wall times of frames, and what each takes beside the frame without shapes drawn right before it.

With `--vtk FOLDER`: the same surface, balls and volume by VTK, with depth peeling, side by side with ours and with the
ray caster in double precision, with the PSNR of both against that and their times.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

SIZE = (512, 512)
N_FRAMES = 5
MIB = 1 << 10  # of the kibibytes that the system counts in


def bumpy_ball(n: int, center: NDArray[Any], radius: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Vertices and faces of a ball with bumps: `n` by `n` vertices."""
    theta, phi = np.meshgrid(np.linspace(0.01, np.pi - 0.01, n), np.linspace(0, 2 * np.pi, n), indexing="ij")
    far = radius * (1 + 0.1 * np.sin(6 * phi) * np.sin(5 * theta))
    around = [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
    vertices = np.stack([c + far * x for c, x in zip(center, around, strict=True)], axis=-1).reshape(-1, 3)
    first = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    near, across = [first, first + 1, first + n], [first + 1, first + n + 1, first + n]
    return vertices, np.concatenate([np.stack(near, axis=-1), np.stack(across, axis=-1)])


def random_paths(lower: NDArray[Any], size: NDArray[Any], n: int) -> list[NDArray[Any]]:
    """`n` curved paths of 100 positions, a unit apart, in a box."""
    random = np.random.default_rng(1)
    along = np.arange(100)[:, None]
    paths = []
    for number in range(n):
        way = random.normal(size=3)
        way /= np.linalg.norm(way)
        aside = 2 * np.sin(0.1 * along + number) * np.array([way[1], -way[0], 0])
        paths.append(lower + random.random(3) * size + along * way + aside)
    return paths


def shapes_of(scan: ws.Volume) -> Iterator[tuple[str, list[Any], int]]:
    """Name, shapes, and number of frames of each case."""
    lower, upper = np.array(scan.bounds)
    center, size = (lower + upper) / 2, upper - lower
    surface = bumpy_ball(317, center, 100.0)
    yield "200,000 triangles", [ws.Surface(*surface, color="orange")], N_FRAMES
    yield "200,000 triangles, clear", [ws.Surface(*surface, color="orange", opacity=0.3)], N_FRAMES
    spots = lower + np.random.default_rng(2).random((100_000, 3)) * size
    yield "100,000 balls", [ws.Points(spots, radius=1.0, color="yellow")], N_FRAMES
    paths = random_paths(lower, size, 10_000)
    yield "10,000 paths, strokes", [ws.Lines(paths, width=2, color="cyan")], N_FRAMES
    yield "10,000 paths, tubes", [ws.Lines(paths, radius=0.5, color="cyan")], N_FRAMES
    yield "5 million triangles", [ws.Surface(*bumpy_ball(1582, center, 100.0), color="orange")], 3


def timed(scene: ws.Scene, threads: int) -> tuple[float, float, int]:
    """Processor and wall time of a frame, ms, and its number of texels."""
    processor, wall = time.process_time(), time.perf_counter()
    picture = scene.render(size=SIZE, threads=threads, device="cpu")
    return 1e3 * (time.process_time() - processor), 1e3 * (time.perf_counter() - wall), picture.report["n_texels"]


def times(threads: int) -> None:
    """Print the table of times."""
    scan = ws.examples.ct_pelvis()
    plain = ws.Scene(scan)
    print(f"{'':26s} {'processor':>10s} {'wall':>8s} {'beside':>9s} {'texels':>8s} {'memory':>8s}")
    for name, shapes, n in shapes_of(scan):
        scene = ws.Scene(scan, geometry=shapes)
        timed(plain, threads), timed(scene, threads)
        pairs = [(timed(plain, threads), timed(scene, threads)) for _ in range(n)]
        processor = statistics.median(own[0] for _, own in pairs)
        wall = statistics.median(own[1] for _, own in pairs)
        beside = statistics.median(own[0] - before[0] for before, own in pairs)
        texels = pairs[0][1][2] / pairs[0][0][2]
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / MIB
        numbers = f"{processor:7.0f} ms {wall:5.0f} ms {beside:+6.0f} ms {texels:7.2f}x {memory:5.0f} MiB"
        print(f"{name:26s} {numbers}", flush=True)


def beside_vtk(folder: Path) -> None:
    """Draw a surface and balls in a volume by ourselves, by VTK and by the ray caster, and compare."""
    import shapes_vtk

    shapes_vtk.compare(folder)


def main() -> None:
    """Measure, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--vtk", type=Path, help="folder of the pictures beside VTK's")
    arguments = parser.parse_args()
    if arguments.vtk is None:
        times(arguments.threads)
    else:
        beside_vtk(arguments.vtk)


if __name__ == "__main__":
    main()
