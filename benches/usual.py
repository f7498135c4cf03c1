"""Times of the pictures that people ask for: `make bench-usual`.

`make bench` draws by a headlight, as the renderers that it compares do. This draws the bundled CT and MRI as users get
them, 512 x 512, on the CPU: the automatic look and its own light, with ambient occlusion, with a second volume, with
labels, a frame of the viewer while it moves, and a slice. Told are median processor and wall times of turned frames,
after two, and the share of the headlight's processor time, with its least and most over the frames.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable, Iterator

import layers
import numpy as np

import wavesplat as ws

SIZE = (512, 512)
#: Frames that are timed, and how far the view turns from one to the next, degrees.
N_FRAMES, TURN = 9, 0.7
#: PSNR of a moving frame: one of those that the viewer asks for.
MOVING_DB = 39.0

#: Draws a frame, given its number.
Draw = Callable[[int], object]


def drawn(scan: ws.Volume, threads: int) -> Iterator[tuple[str, Draw]]:
    """Name and way of drawing of each picture, the headlight's first."""
    scene = ws.Scene(scan)

    def turned(scene: ws.Scene, **options: object) -> Draw:
        def draw(frame: int) -> object:
            camera = ws.Camera.orbit(scan, 30 + TURN * frame, 20)
            return scene.render(camera, size=SIZE, threads=threads, device="cpu", **options)

        return draw

    yield "headlight", turned(scene.with_(shading=ws.Shading.headlight()))
    yield "light of the look", turned(scene)
    yield "with ambient occlusion", turned(scene.with_(shading=ws.Shading(ambient_occlusion=0.7)))
    hot = ws.TransferFunction.from_colormap("hot", clim=(2, 8), opacity="linear")
    second = ws.Layer(layers.uptake(scan), ws.Look(transfer_function=hot, shading=None))
    yield "with a second volume", turned(ws.Scene([ws.Layer(scan), second]))
    values = scan.samples
    labels = ws.Labels((values > np.percentile(values, 90)).astype(np.uint8), {1: ws.Label("#40a0e0", 0.6)})
    yield "with labels", turned(scene.with_(labels=labels))
    yield f"moving frame, {MOVING_DB:.0f} dB", turned(scene, psnr=MOVING_DB)
    middle = scan.bounds[0][2], scan.bounds[1][2]
    at = [middle[0] + (middle[1] - middle[0]) * (0.4 + 0.01 * frame) for frame in range(N_FRAMES + 2)]
    yield "slice", lambda frame: ws.slice(scan, "axial", at[frame], size=SIZE, threads=threads)


def frame_times(draw: Draw) -> tuple[list[float], list[float]]:
    """Processor and wall times of frames, ms."""
    processor, wall = [], []
    for frame in range(N_FRAMES + 2):
        begun = time.process_time(), time.perf_counter()
        draw(frame)
        processor.append(1e3 * (time.process_time() - begun[0]))
        wall.append(1e3 * (time.perf_counter() - begun[1]))
    return processor[2:], wall[2:]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=1)
    asked = parser.parse_args()
    print("| volume | picture | processor, ms | wall, ms | of the headlight's | least .. most |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    for name in ("ct_pelvis", "mri_head"):
        base: list[float] = []
        for what, draw in drawn(getattr(ws.examples, name)(), asked.threads):
            processor, wall = frame_times(draw)
            base = base or processor
            shares = [own / other for own, other in zip(processor, base, strict=True)]
            numbers = f"{statistics.median(processor):.1f} | {statistics.median(wall):.1f}"
            spread = f"{statistics.median(shares):.2f} | {min(shares):.2f} .. {max(shares):.2f}"
            print(f"| {name} | {what} | {numbers} | {spread} |", flush=True)


if __name__ == "__main__":
    main()
