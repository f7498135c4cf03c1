"""`wavesplat gpu-check`."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from wavesplat._cli.options.groups import Json
from wavesplat._cli.printing import print_result

#: Pixels of a picture along each side, and number of times that it is drawn to be timed.
SIDE, N_TIMES = 256, 3


def gpu_check(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[NAME]", help="Only GPUs with this in their name.", show_default=False),
    ] = None,
    *,
    json: Json = False,
) -> None:
    """List the GPUs, test each, and compare pictures with the CPU's: a table for a report."""
    import platform

    from wavesplat import gpu
    from wavesplat._native import __version__

    wanted = [adapter for adapter in gpu.adapters() if name is None or name.lower() in adapter.name.lower()]
    checks = [_checked(adapter) for adapter in wanted]
    facts: dict[str, Any] = {"version": __version__, "system": platform.platform(), "gpus": checks}
    print_result(facts, "\n".join(_lines(facts)), as_json=json)


def _checked(adapter: Any) -> dict[str, Any]:
    """Facts of an adapter, its self-test, and its pictures compared with the CPU's."""
    from dataclasses import asdict

    from wavesplat import gpu

    name = f"{adapter.name} {adapter.backend}"
    tested = gpu.self_test(name)
    pictures = [] if tested.reason else [_compared(name, *scene) for scene in _scenes()]
    return {**asdict(adapter), "self_test": asdict(tested), "pictures": pictures}


def _scenes() -> list[tuple[str, Any, dict[str, Any]]]:
    """Titles, scenes and options of pictures of the bundled data: every kind of work that shaders do."""
    from wavesplat import examples
    from wavesplat._looks.shading import Shading
    from wavesplat._model.arguments.operators import FirstHit
    from wavesplat._scene.scene import Scene

    pelvis, ripples = examples.ct_pelvis(), examples.ripples(48)
    bone, soft = Scene(pelvis, "ct-bone"), Scene(ripples)
    in_shadow = Scene(pelvis, "ct-bone", shading=Shading(ambient_occlusion=0.7, shadow=0.6))
    return [
        ("soft", soft, {}),
        ("soft, cubic, from an eye", soft, {"kernel": "bspline3", "camera": "isometric"}),
        ("bone", bone, {"camera": "front"}),
        ("bone, ambient occlusion and shadow", in_shadow, {"camera": "front"}),
        ("isosurface", bone, {"composite": FirstHit(250.0), "camera": "left"}),
        ("maximum", Scene(pelvis), {"composite": "maximum", "camera": "front"}),
    ]


def _compared(name: str, title: str, scene: Any, options: dict[str, Any]) -> dict[str, Any]:
    """A GPU's picture compared with the CPU's: largest difference in levels of 255, pixels beyond one, and times."""
    import time

    import numpy as np

    def drawn(device: str) -> tuple[Any, float]:
        scene.render(size=(SIDE, SIDE), device=device, **options)
        times = []
        for _ in range(N_TIMES):
            begun = time.perf_counter()
            picture = scene.render(size=(SIDE, SIDE), device=device, **options)
            times.append(time.perf_counter() - begun)
        return picture, min(times)

    (own, own_s), (of_cpu, cpu_s) = drawn(name), drawn("cpu")
    apart = np.abs(own.rgba - of_cpu.rgba).max(axis=2) * 255
    device = own.report["device"]
    return {
        "picture": title,
        "drawn_by": device["name"],
        "reason": device["reason"],
        "largest_difference": float(apart.max()),
        "beyond_one_level": float((apart > 1).mean()),
        "milliseconds": 1e3 * own_s,
        "gpu_milliseconds": None if device.get("seconds") is None else 1e3 * device["seconds"],
        "cpu_milliseconds": 1e3 * cpu_s,
    }


def _lines(facts: dict[str, Any]) -> list[str]:
    """The table of results, in Markdown."""
    lines = [f"wavesplat {facts['version']}, {facts['system']}"]
    if not facts["gpus"]:
        return [*lines, "no GPU: no driver for Vulkan, Metal or DX12 reports one, so the CPU draws"]
    for number, adapter in enumerate(facts["gpus"]):
        tested = adapter["self_test"]
        ids = f"{adapter['vendor_id']:#06x}:{adapter['device_id']:#06x}"
        named = ", ".join([f"{adapter['name']} ({adapter['kind']})", adapter["backend"], adapter["driver"], ids])
        lines += ["", f"GPU {number}: {named}"]
        if tested["reason"]:
            lines.append(f"not used: {tested['reason']}")
            continue
        fetched = "four at once" if tested["gathers"] else "one by one"
        side, layers, megabytes = tested["texture_side"], tested["texture_layers"], tested["buffer_bytes"] / 1e6
        limits = f"textures of {side} x {side} x {layers}, buffers of {megabytes:.0f} MB"
        lines += [
            f"self-test passed; samples are fetched {fetched}; {limits}",
            "",
            "| picture, 256 x 256 | drawn by | largest difference, levels | beyond one level | ms | GPU ms | CPU ms |",
            "| --- | --- | ---: | ---: | ---: | ---: | ---: |",
        ]
        for row in adapter["pictures"]:
            gpu_ms = "-" if row["gpu_milliseconds"] is None else f"{row['gpu_milliseconds']:.2f}"
            lines.append(
                f"| {row['picture']} | {row['reason'] or row['drawn_by']} | {row['largest_difference']:.4f} | "
                f"{100 * row['beyond_one_level']:.3f} % | {row['milliseconds']:.1f} | {gpu_ms} | "
                f"{row['cpu_milliseconds']:.1f} |"
            )
    return lines
