"""Draws scenes that together use every part of the renderer, and prints a hash of each picture.

A change that should change no picture is held to that: `make scene-hashes SCENES="--save before.txt"` before it, and
`make scene-hashes SCENES="--compare before.txt"` after it, on one machine.
Only volumes that come with the package, and arrays made here, are drawn.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

SIZE = (150, 130)

Scene = Callable[[], ws.Picture]


@cache
def ct() -> ws.Volume:
    """The bundled CT."""
    return ws.examples.ct_pelvis()


@cache
def mri() -> ws.Volume:
    """The bundled MRI."""
    return ws.examples.mri_head()


@cache
def ripples() -> ws.Volume:
    """The test signal of Marschner and Lobb, uint8."""
    return ws.examples.ripples(40)


@cache
def blobs(dtype: str) -> ws.Volume:
    """Smooth synthetic samples of any type, with different spacings along the axes."""
    z, y, x = np.meshgrid(*(np.linspace(-1, 1, n) for n in (29, 40, 35)), indexing="ij")
    field = np.exp(-4 * ((x - 0.2) ** 2 + y**2 + (z + 0.1) ** 2)) + 0.6 * np.exp(
        -9 * ((x + 0.5) ** 2 + (y - 0.4) ** 2 + z**2)
    )
    scaled = field / field.max() * 240
    kind = np.dtype(dtype)
    samples: NDArray[Any] = scaled.astype(kind) if kind.kind == "f" else np.round(scaled).astype(kind)
    return ws.Volume(samples, spacing=(1.0, 1.2, 1.5))


@cache
def with_holes() -> ws.Volume:
    """Float samples, some NaN and some infinite."""
    samples = np.array(blobs("float32").samples)
    samples[10:14, 15:22, 12:20] = np.nan
    samples[3, 3, 3] = np.inf
    return ws.Volume(samples, spacing=(1.0, 1.2, 1.5))


@cache
def sheared() -> ws.Volume:
    """The CT on a grid that is rotated and sheared."""
    affine = np.array([[2.9, 0.4, 0.1, -20.0], [-0.5, 3.1, 0.6, 7.0], [0.2, -0.3, 3.3, 11.0], [0, 0, 0, 1.0]])
    return ws.Volume(ct().samples, world_from_index=affine)


@cache
def coefficients(family: str, n_cache: int | None = None) -> ws.WaveletVolume:
    """Wavelet coefficients of the MRI."""
    wavelets = ws.WaveletVolume.from_volume(mri(), keep=0.05, family=family)
    if n_cache is not None:
        wavelets.cache_bytes = n_cache
    return wavelets


def soft_ct() -> ws.TransferFunction:
    """Translucent soft tissue and bone."""
    return ws.TransferFunction(
        opacity=[(-50, 0.0), (50, 0.03), (150, 0.05), (400, 0.5), (1200, 0.8)],
        color=[(-50, 0.8, 0.4, 0.3), (150, 0.9, 0.6, 0.5), (400, 1.0, 0.95, 0.85)],
    )


def hard(value: float) -> ws.TransferFunction:
    """A step to opaque."""
    return ws.TransferFunction(opacity=[(value - 0.5, 0.0), (value + 0.5, 1.0)], color=[(value, 1.0, 0.9, 0.7)])


def soft_mri() -> ws.TransferFunction:
    """A translucent head."""
    return ws.TransferFunction(
        opacity=[(20, 0.0), (60, 0.1), (200, 0.4)], color=[(20, 0.3, 0.2, 0.9), (200, 1.0, 0.9, 0.8)]
    )


def ramp() -> ws.TransferFunction:
    """A ramp of opacity over the synthetic samples."""
    return ws.TransferFunction(opacity=[(10, 0.0), (240, 0.5)], color=[(10, 0.1, 0.3, 0.9), (240, 1.0, 0.8, 0.2)])


def oblique(volume: ws.Volume | ws.WaveletVolume, view_angle: float | None = None) -> ws.Camera:
    """Camera from the front, the right and above."""
    return ws.Camera.orbit(volume, azimuth=40, elevation=25, view_angle=view_angle, fit="view")


def inside(volume: ws.Volume) -> ws.Camera:
    """Camera inside the volume, with a wide angle."""
    lo, hi = volume.bounds
    eye = lo + (hi - lo) * np.array([0.52, 0.45, 0.5])
    return ws.Camera(tuple(eye), tuple(eye + np.array([1.0, 0.9, 0.8])), (0, 0, 1), view_angle=100)


def draw(volume: ws.Volume | ws.WaveletVolume, tf: Any, camera: ws.Camera | str, **options: Any) -> Scene:
    """A scene that is drawn when it is called."""
    options.setdefault("size", SIZE)
    return lambda: ws.study.render(volume, tf, camera, **options)


def labels() -> ws.Labels:
    """Three synthetic labels in the CT."""
    codes = np.zeros(ct().shape, np.uint8)
    codes[30:60, 20:50, 30:60] = 1
    codes[50:90, 50:80, 60:90] = 2
    codes[20:40, 60:90, 20:40] = 7
    segmentation = ws.Volume(codes, world_from_index=ct().world_from_index)
    looks = {
        1: ws.Label("#cc2222", 0.3, name="red"),
        2: ws.Label("#22cc44", 0.9, scan=0.5, tint=0.4),
        7: ws.Label("#2244cc", 0.0, tint=0.7),
    }
    return ws.Labels(segmentation, looks)


def scenes() -> Iterator[tuple[str, Scene]]:
    """Names and scenes, in the order in which they are drawn."""
    yield from of_operators()
    yield from of_kernels_and_types()
    yield from of_views()
    yield from of_light_and_labels()
    yield from of_cuts()
    yield from of_settings()
    yield from of_levels()


def of_operators() -> Iterator[tuple[str, Scene]]:
    """Scenes with every composite operator."""
    volume, tf, camera = ct(), soft_ct(), oblique(ct())
    yield "over soft", draw(volume, tf, camera)
    yield "over hard", draw(volume, hard(250), camera)
    yield "over hard depth", draw(volume, hard(250), camera, depth=True)
    yield "over soft depth", draw(volume, tf, camera, depth=True)
    yield "over unshaded", draw(volume, tf, camera, shading=None)
    yield "over plain sheets", draw(volume, hard(250), camera, pre_integration=False, early_ray_termination=False)
    yield "first hit", draw(volume, tf, camera, composite=ws.FirstHit(220), depth=True)
    yield "first hit unshaded", draw(volume, tf, camera, composite=ws.FirstHit(220), shading=None)
    for composite in ("maximum", "minimum", "mean", "sum", "x-ray", "depth-shaded-maximum", "local-maximum"):
        yield composite, draw(volume, tf, camera, composite=composite)
    yield "mean perspective", draw(volume, tf, oblique(ct(), 35), composite="mean")
    yield "maximum perspective", draw(volume, tf, oblique(ct(), 35), composite="maximum")
    yield "local maximum of threshold", draw(volume, tf, camera, composite=ws.LocalMaximum(300))


def of_kernels_and_types() -> Iterator[tuple[str, Scene]]:
    """Scenes with every kernel and sample type, and with missing samples."""
    for kernel in ("linear", "catmull-rom", "bspline2", "bspline3", "gaussian"):
        yield f"kernel {kernel} soft", draw(ripples(), ramp(), oblique(ripples()), kernel=kernel)
        yield f"kernel {kernel} hard", draw(ripples(), hard(128), oblique(ripples(), 30), kernel=kernel)
    for dtype in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"):
        samples = blobs("int16") if dtype == "int8" else blobs(dtype)
        if dtype == "int8":
            samples = ws.Volume((np.array(samples.samples) // 2).astype(np.int8), spacing=(1.0, 1.2, 1.5))
        yield f"type {dtype}", draw(samples, ramp(), oblique(samples))
    for kernel in ("linear", "bspline3"):
        yield f"holes {kernel}", draw(with_holes(), ramp(), oblique(with_holes()), kernel=kernel)
        yield f"holes {kernel} hard", draw(with_holes(), hard(120), oblique(with_holes(), 30), kernel=kernel)
    yield "holes maximum", draw(with_holes(), ramp(), oblique(with_holes()), composite="maximum")
    yield "holes first hit", draw(with_holes(), ramp(), oblique(with_holes()), composite=ws.FirstHit(100))


def of_views() -> Iterator[tuple[str, Scene]]:
    """Scenes with slices across each axis, from both sides, in perspective, from inside, on a sheared grid."""
    for view in ("anterior", "posterior", "left", "right", "superior", "inferior"):
        yield f"view {view}", draw(mri(), soft_mri(), view)
    for angle in (20, 70):
        yield f"perspective {angle}", draw(mri(), soft_mri(), oblique(mri(), angle))
        yield f"perspective {angle} hard", draw(mri(), hard(60), oblique(mri(), angle))
    diagonal = ws.Camera.orbit(mri(), azimuth=45, elevation=35.26, view_angle=40, fit="view")
    yield "three families", draw(mri(), soft_mri(), diagonal)
    yield "eye inside", draw(mri(), soft_mri(), inside(mri()))
    yield "eye inside hard depth", draw(mri(), hard(60), inside(mri()), depth=True)
    yield "sheared grid", draw(sheared(), soft_ct(), oblique(sheared()))
    yield "sheared grid hard perspective", draw(sheared(), hard(250), oblique(sheared(), 40))


def of_light_and_labels() -> Iterator[tuple[str, Scene]]:
    """Scenes with light, occlusion, shadows, gradient opacity, functions of two dimensions, labels."""
    camera = oblique(ct())
    lights = [ws.Light((-1, 1, 1)), ws.Light((1, 0, 0), color=(0.2, 0.3, 0.5), frame="world")]
    shaded = ws.Shading(ambient=0.2, diffuse=0.7, specular=0.4, specular_power=30, lights=lights)
    yield "two lights", draw(ct(), soft_ct(), camera, shading=shaded)
    occluded = ws.Shading(ambient_occlusion=0.8)
    yield "ambient occlusion", draw(ct(), hard(250), camera, shading=occluded)
    shadowed = ws.Shading(lights=lights, shadow=0.6, ambient_occlusion=0.3)
    yield "shadow", draw(ct(), soft_ct(), oblique(ct(), 30), shading=shadowed)
    yield "wide gradient", draw(ct(), hard(250), camera, shading=ws.Shading(gradient_offset=1.7))
    by_gradient = ws.TransferFunction(
        opacity=[(-50, 0.0), (400, 0.5)],
        color=[(-50, 0.8, 0.4, 0.3), (400, 1, 1, 0.9)],
        gradient_opacity=[(10, 0), (60, 1)],
    )
    yield "gradient opacity", draw(ct(), by_gradient, camera)
    yield "gradient opacity unshaded", draw(ct(), by_gradient, camera, shading=None)
    boundaries = ws.Materials.preset("ct").surfaces(0.9)
    yield "two dimensions", draw(ct(), boundaries, camera)
    yield "materials", draw(ct(), ws.Materials.preset("ct"), oblique(ct(), 30))
    yield "labels", draw(ct(), soft_ct(), camera, labels=labels())
    yield "labels hard perspective", draw(ct(), hard(250), oblique(ct(), 35), labels=labels())
    yield "labels occlusion", draw(ct(), soft_ct(), camera, labels=labels(), shading=shadowed)


def of_cuts() -> Iterator[tuple[str, Scene]]:
    """Scenes with crop boxes and clip planes."""
    camera = oblique(ct())
    lo, hi = ct().bounds
    middle = (lo + hi) / 2
    crop = ws.Crop(tuple(lo + 0.2 * (hi - lo)), tuple(lo + 0.7 * (hi - lo)))
    planes = [ws.ClipPlane(middle, (1.0, 0.4, -0.3)), ws.ClipPlane(middle, (0.0, 1.0, 0.2))]
    yield "crop", draw(ct(), soft_ct(), camera, clip=crop)
    yield "crop hard perspective", draw(ct(), hard(250), oblique(ct(), 35), clip=crop)
    yield "clip", draw(ct(), soft_ct(), camera, clip=planes)
    yield "clip hard", draw(ct(), hard(250), camera, clip=planes)
    yield "clip maximum", draw(ct(), soft_ct(), camera, clip=planes, composite="maximum")
    yield "clip mean crop", draw(ct(), soft_ct(), camera, clip=[crop, *planes], composite="mean")


def of_settings() -> Iterator[tuple[str, Scene]]:
    """Scenes with various qualities, sheets, texels, sizes, backgrounds, threads."""
    camera = oblique(ct())
    for quality in ("draft", "high"):
        yield f"quality {quality} soft", draw(ct(), soft_ct(), camera, quality=quality)
        yield f"quality {quality} hard", draw(ct(), hard(250), camera, quality=quality)
    yield "few sheets", draw(ct(), soft_ct(), camera, quality=ws.Sampling(0.3))
    yield "many sheets", draw(ct(), hard(250), camera, quality=ws.Sampling(5.3))
    yield "texels as pixels", draw(ct(), hard(250), camera, quality=ws.Sampling(oversampling=1.0))
    yield "texels 0.55", draw(ct(), soft_ct(), camera, quality=ws.Sampling(oversampling=0.55))
    yield "texels 2.5", draw(ct(), hard(250), camera, quality=ws.Sampling(oversampling=2.5))
    yield "one thread", draw(ct(), soft_ct(), camera, threads=1)
    yield "background", draw(ct(), soft_ct(), camera, background="#203040")
    yield "wide", draw(ct(), soft_ct(), camera, size=(333, 77))
    yield "tiny", draw(ct(), hard(250), camera, size=(3, 2))
    yield "preset", draw(ct(), "ct-bone", camera)
    yield "automatic", draw(mri(), None, "anterior")
    three = ws.Volume(np.array(ct().samples[50:53]), spacing=(3, 3, 3))
    yield "three slices", draw(three, soft_ct(), oblique(three))
    yield "two slices", draw(ws.Volume(np.array(ct().samples[50:52])), hard(250), "superior")


def of_levels() -> Iterator[tuple[str, Scene]]:
    """Scenes of wavelet volumes: whole, decoded in blocks, fewer levels, bands."""
    for family in ("cdf97", "cdf53"):
        wavelets = coefficients(family)
        yield f"wavelets {family}", draw(wavelets, soft_mri(), oblique(wavelets))
    whole = coefficients("cdf97")
    yield "wavelets hard", draw(whole, hard(60), oblique(whole, 30))
    yield "wavelets in blocks", draw(coefficients("cdf97", 1 << 21), soft_mri(), oblique(whole))
    yield (
        "wavelets in blocks cubic",
        draw(coefficients("cdf97", 1 << 21), soft_mri(), oblique(whole), kernel="bspline3"),
    )
    yield "one level fewer soft", draw(whole.level(1), soft_mri(), oblique(whole))
    yield "one level fewer hard", draw(whole.level(1), hard(60), oblique(whole))
    yield "two levels fewer soft", draw(whole.level(2), soft_mri(), oblique(whole))
    yield "two levels fewer hard", draw(whole.level(2), hard(60), oblique(whole))
    weights = [1.0, 1.0] + [0.0] * (whole.n_levels - 1)
    yield "bands", draw(whole.bands(weights), None, oblique(whole))


def digest(picture: ws.Picture) -> str:
    """Hash of a picture's colours, depth and values."""
    sha = hashlib.sha256()
    for part in (picture.rgba, picture.depth, picture.value):
        sha.update(b"none" if part is None else np.ascontiguousarray(part).tobytes())
    return sha.hexdigest()[:16]


def main() -> None:
    """Print, save or compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="scenes whose name has this in it")
    parser.add_argument("--save", type=Path, help="write the hashes to this file")
    parser.add_argument("--compare", type=Path, help="exit with 1 if any scene differs from those of this file")
    parser.add_argument("--png", type=Path, help="also write the pictures to this folder")
    arguments = parser.parse_args()
    found: dict[str, str] = {}
    for name, scene in scenes():
        if arguments.only in name:
            picture = scene()
            found[name] = digest(picture)
            print(f"{found[name]}  {name}", flush=True)
            if arguments.png:
                arguments.png.mkdir(parents=True, exist_ok=True)
                picture.save(arguments.png / f"{name.replace(' ', '_')}.png")
    if arguments.save:
        arguments.save.write_text("".join(f"{value}  {name}\n" for name, value in found.items()), encoding="utf-8")
    if arguments.compare:
        lines = arguments.compare.read_text(encoding="utf-8").splitlines()
        before = {name: value for value, name in (line.split("  ", 1) for line in lines)}
        missing = [name for name in before if name not in found and arguments.only in name]
        differing = [name for name, value in found.items() if before.get(name) != value]
        print(f"{len(found)} scenes, {len(differing)} differ from {arguments.compare}, {len(missing)} are missing")
        for name in differing + missing:
            print(f"  {name}")
        sys.exit(bool(differing or missing))
    print(f"{len(found)} scenes")


if __name__ == "__main__":
    main()
