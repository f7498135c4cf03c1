"""Brightness of looks that are chosen for a volume, beside the box, the voxels and maximum projections.

    python studies/looks/brightness.py

Luminance: Rec. 709 weights on encoded values, 0 to 255, of pixels that differ from black by more than 6. The stacks
are made: a ball, and a network one to two slices thick in 14 slices, with the noise of photons.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def main() -> None:
    """Print the tables."""
    print("Green in the middle of a ball of radius 5 voxels and value 1000, window 0 to 1000:")
    for shape in ((64, 64, 64), (14, 64, 64), (96, 256, 256), (128, 512, 512)):
        print(f"  box {' x '.join(map(str, shape)):15s} {ball(shape, 0.2, 5.0):6.1f}")
    print("The same ball of radius 1.2 um, by the size of the voxels:")
    for step in (0.1, 0.2, 0.4):
        print(f"  {step} um {ball((48, 48, 48), step, 1.2 / step):6.1f}")
    print("A network in 14 slices, and each slice repeated: mean and 99th percentile of luminance")
    for times in (1, 4, 12):
        stack = network(times)
        look = ws.Look.auto(stack)
        maximum = ws.Look.auto(stack, "maximum")
        print(
            f"  {stack.shape[0]:3d} slices: first picture {measured(stack, look)}, with exposure 2 "
            f"{measured(stack, look.changed(exposure=2))}, maximum projection {measured(stack, maximum)}"
        )


def ball(shape: tuple[int, int, int], step: float, radius: float) -> float:
    """Green, 0 to 255, in the middle of a ball that is looked at along z."""
    z, y, x = np.meshgrid(*[np.arange(n, dtype=np.float32) - (n - 1) / 2 for n in shape], indexing="ij")
    samples = np.where(z * z + y * y + x * x < radius * radius, np.float32(1000), np.float32(0))
    volume = ws.Volume(samples, spacing=(step, step, step), unit="um")
    camera = ws.Camera.view(volume, "xy").zoomed(shape[1] * step / 6.0)
    scene = ws.Scene(ws.Layer(volume, ws.Look.channel(volume, "green", (0, 1000))), background="black")
    return 255 * float(scene.render(camera, size=(50, 50)).rgba[25, 25, 1])


def network(times: int) -> ws.Volume:
    """A network of threads in 14 slices, each of which is there so many times."""
    rng = np.random.default_rng(3)

    def smooth(width: float) -> NDArray[np.float64]:
        field = blurred(rng.normal(0, 1, (256, 256)), width)
        return np.asarray(field / field.std())

    threads = blurred((np.abs(smooth(5)) < 0.35).astype(np.float64), 1.0)
    light = 1000 * threads * np.exp(0.3 * smooth(3))
    depth = 7 + 2.5 * smooth(12)
    z = np.arange(14)[:, None, None]
    counts = rng.poisson(100 + light * np.exp(-0.5 * ((z - depth) / 0.9) ** 2)).astype(np.uint16)
    return ws.Volume(np.repeat(counts, times, axis=0), spacing=(0.1, 0.1, 0.1), unit="um")


def blurred(field: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """A field that goes on beyond its edges, blurred by a Gaussian of a standard deviation in samples."""
    fy, fx = np.fft.fftfreq(field.shape[0])[:, None], np.fft.rfftfreq(field.shape[1])[None]
    gain = np.exp(-2 * (np.pi * width) ** 2 * (fy * fy + fx * fx))
    return np.asarray(np.fft.irfft2(np.fft.rfft2(field) * gain, field.shape))


def measured(volume: ws.Volume, look: ws.Look) -> str:
    """Mean and 99th percentile of the luminance where something is seen along z."""
    levels = 255 * ws.render(volume, look, "xy", size=(384, 384), background="black").rgba[..., :3]
    seen = (levels @ LUMINANCE)[(levels > 6).any(axis=2)]
    return f"{seen.mean():.0f} and {np.percentile(seen, 99):.0f}"


if __name__ == "__main__":
    main()
