"""Frames on a GPU, beside our CPU path and VTK's GPU mapper: `make bench-gpu`.

What is drawn are the cases of the group "goals" of `cases.toml`, at quality "normal", on the device that is named, or
the best there is. Of a GPU: its own time by timestamps, the wall time with reading back, and the parts of the wall time
between plan and warp, all medians of turned frames after a first one; bytes of samples and bytes moved. On an
H200 frames after a second without work took up to six times as long as many in a row. Beside it our
CPU path in the same run, and, where VTK is installed, its `vtkOpenGLGPUVolumeRayCastMapper` with the coarsest step that
has our PSNR, or the finest that is tried. For a software device no times are given: they say nothing of GPUs. Counts
are: quads of samples that were fetched, texels of sheets, bytes, and how far the pictures are from the CPU's.
"""

from __future__ import annotations

import argparse
import statistics
import time
from typing import Any

import numpy as np
import records
import scenes

import wavesplat as ws
from wavesplat import _native

#: Frames that are timed, and how far the view turns from one to the next, degrees.
N_FRAMES, TURN = 15, 0.3
#: Parts of the wall time in the report of a picture that a GPU drew.
PARTS = ("prepare_seconds", "march_seconds", "read_back_seconds")
#: Steps of VTK's rays that are tried, in voxels, coarsest first.
VTK_STEPS = (1.0, 0.5, 0.25, 0.125)


def main() -> None:
    """Print the table, and record it if asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--device", default="gpu", help="gpu, or part of a GPU's name")
    parser.add_argument("--no-vtk", action="store_true", help="leave VTK out")
    parser.add_argument("--record", action="store_true", help="keep the table in benches/records")
    asked = parser.parse_args()
    chosen = [a for a in ws.gpu.adapters() if asked.device == "gpu" or asked.device.lower() in a.name.lower()]
    if asked.device == "gpu":
        chosen = [a for a in chosen if a.kind != "software"] or chosen
    if not chosen:
        raise SystemExit("no GPU, and no program that stands for one: install a driver, or mesa-vulkan-drivers")
    adapter = chosen[0]
    is_software, name = adapter.kind == "software", f"{adapter.name} {adapter.backend}"
    lines = [f"Device: {adapter.name} ({adapter.kind}), {adapter.backend}, {adapter.driver}.", ""]
    lines += _counts(name) if is_software else _times(name, with_vtk=not asked.no_vtk)
    text = "\n".join(lines)
    print(text)
    if asked.record:
        print(f"kept in {records.keep('make bench-gpu', text)}")


def _cases() -> list[scenes.Case]:
    return [case for case in scenes.cases() if case.group == "goals"]


def _drawn(case: scenes.Case, device: str, turn: float = 0.0, kept: Any = None) -> ws.Picture:
    return scenes.render(case, turn, kept=kept, quality="normal", device=device)


def _counts(name: str) -> list[str]:
    """Fetches, texels and bytes of each case, and how far the picture is from the CPU's."""
    _native.gpu_count(True)
    lines = [
        "| case | M texels | M fetches | fetches a texel | MB of samples | MB moved | levels apart | PSNR, dB |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for case in _cases():
        picture, of_cpu = _drawn(case, name), _drawn(case, "cpu")
        told = picture.report["device"]
        apart = 255 * float(np.abs(picture.rgba - of_cpu.rgba).max())
        psnr, _ = scenes.errors(scenes.over_black(picture.rgba), scenes.converged(case))
        lines.append(
            f"| {case.label} | {told['texels'] / 1e6:.2f} | {told['fetches'] / 1e6:.1f} | "
            f"{told['fetches'] / max(told['texels'], 1):.1f} | {told['sample_bytes'] / 1e6:.1f} | "
            f"{told['moved_bytes'] / 1e6:.1f} | {apart:.4f} | {psnr:.1f} |"
        )
    _native.gpu_count(False)
    return lines


def _times(name: str, *, with_vtk: bool) -> list[str]:
    """Times of each case, of the GPU, of our CPU path, and of VTK on the same GPU."""
    lines = [
        "| case | GPU ms | wall ms | prepare, march, read back | CPU ms | dB | MB there | moved | VTK ms | dB | step |",
        "| --- | ---: | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for case in _cases():
        ours, told = _timed(case, name), _drawn(case, name).report["device"]
        by_cpu = _timed(case, "cpu")
        psnr, _ = scenes.errors(scenes.over_black(_drawn(case, name).rgba), scenes.converged(case))
        vtk_wall, vtk_psnr, step = _vtk(case, psnr) if with_vtk else ("-", "-", "-")
        wall, *parts, on_gpu = ours
        gpu_ms = "-" if on_gpu is None else f"{on_gpu:.2f}"
        lines.append(
            f"| {case.label} | {gpu_ms} | {wall:.2f} | {', '.join(f'{part:.2f}' for part in parts)} | "
            f"{by_cpu[0]:.2f} | {psnr:.1f} | "
            f"{told['sample_bytes'] / 1e6:.1f} | {told['moved_bytes'] / 1e6:.1f} | {vtk_wall} | {vtk_psnr} | {step} |"
        )
    return lines


def _timed(case: scenes.Case, device: str) -> list[float | None]:
    """Median times of a frame, ms: wall time, its parts ``PARTS``, and by the GPU's clock (None where not known)."""
    kept = scenes.scene(case)
    _drawn(case, device, kept=kept)
    rows = []
    for frame in range(N_FRAMES):
        begun = time.perf_counter()
        picture = _drawn(case, device, TURN * (frame + 1), kept)
        wall = time.perf_counter() - begun
        told = picture.report["device"]
        rows.append([wall, *(told.get(part) for part in PARTS), told.get("seconds")])
    columns = [[seconds for seconds in column if seconds is not None] for column in zip(*rows, strict=True)]
    return [1e3 * statistics.median(column) if column else None for column in columns]


def _vtk(case: scenes.Case, wanted_db: float) -> tuple[str, str, str]:
    """VTK's GPU mapper with the coarsest step that has a PSNR: wall ms, PSNR, step; or why there is none."""
    try:
        import vtk_peer
    except ImportError:
        return "not installed", "-", "-"
    for step in VTK_STEPS:
        peer = vtk_peer.Scene(case, step, on_gpu=True)
        psnr, _ = scenes.errors(peer.picture(), scenes.converged(case))
        if psnr >= wanted_db or step == VTK_STEPS[-1]:
            break
    peer.draw(0.0)
    wall = []
    for frame in range(N_FRAMES):
        begun = time.perf_counter()
        peer.draw(TURN * (frame + 1))
        peer.wait()
        wall.append(1e3 * (time.perf_counter() - begun))
    return f"{statistics.median(wall):.2f} ({peer.renderer()})", f"{psnr:.1f}", f"{step:g}"


if __name__ == "__main__":
    main()
