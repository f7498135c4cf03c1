"""Processor times of frames by the module of WebAssembly, beside the same code for this processor: `make bench-wasm`.

The module runs in Node (`web/wasm/twin.mjs`), its twin (`crates/wasm/examples/twin.rs`) once with SSE2, whose registers
are as wide as those of WebAssembly, and once with AVX2; all on one thread. Every frame is drawn by each in turn, from
three views, `--rounds` times. Told are the least processor times of a frame: plan, base planes, warp, and bytes of 8
bits. "Same" are the views whose floats have one hash on all.
"""

from __future__ import annotations

import argparse
import gzip
import itertools
import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import records

import wavesplat as ws

ROOT = Path(__file__).parents[1]
SIZE = [512, 512]
#: Views about the volume: azimuth and elevation, degrees, in perspective.
VIEWS = [[30, 20], [75, -15], [140, 40]]
ANGLE = 30
#: Samples along each axis of the volume of arithmetic.
N = 128

Head = dict[str, Any]
Calls = dict[str, Any]


class Answering:
    """A program that answers calls, line by line."""

    def __init__(self, *command: str | Path) -> None:
        self._program = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __call__(self, call: Calls) -> dict[str, Any]:
        """The answer to a call."""
        assert self._program.stdin is not None
        assert self._program.stdout is not None
        self._program.stdin.write(json.dumps(call) + "\n")
        self._program.stdin.flush()
        answer: dict[str, Any] = json.loads(self._program.stdout.readline())
        if "error" in answer:
            raise RuntimeError(f"{call}: {answer['error']}")
        return answer

    def close(self) -> None:
        """End the program."""
        self._program.communicate()


def ripples(folder: Path) -> Calls:
    """A volume of 8 bits: the signal of Marschner and Lobb."""
    scan = ws.examples.ripples(N)
    samples = np.asarray(scan.samples, dtype=np.float64)
    low, high = samples.min(), samples.max()
    path = folder / "ripples.raw"
    path.write_bytes(np.round((samples - low) / (high - low) * 255).astype(np.uint8).tobytes())
    rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]
    head = {"name": "ripples", "type": "uint8", "size": [N, N, N], "world_from_index": rows}
    return {"samples": head, "path": str(path)}


def bundled_ct(folder: Path) -> Calls:
    """The bundled CT."""
    scan = ws.examples.ct_pelvis()
    samples = np.ascontiguousarray(scan.samples)
    path = folder / "ct.raw"
    path.write_bytes(samples.tobytes())
    head = {
        "name": "ct",
        "type": samples.dtype.name,
        "size": list(samples.shape[::-1]),
        "world_from_index": np.asarray(scan.world_from_index)[:3].tolist(),
        "facts": {"unit": "mm", "is_anatomical": True, "modality": "CT"},
    }
    return {"samples": head, "path": str(path)}


def curves(*opacity: tuple[float, float]) -> Calls:
    """A look without light."""
    color = [[0, 0.2, 0.4, 1], [255, 1, 0.9, 0.5]]
    return {"document": {"version": 1, "transfer_function": {"opacity": opacity, "color": color}, "shading": None}}


#: Name, volume, look and quality of each case.
CASES: list[tuple[str, Any, Calls, str]] = [
    ("soft ramp", ripples, curves((60, 0), (255, 0.05)), "normal"),
    ("hard step", ripples, curves((127, 0), (128, 0.9)), "normal"),
    ("CT, `ct-bone`", bundled_ct, {"preset": "ct-bone"}, "draft"),
    ("CT, `ct-bone`", bundled_ct, {"preset": "ct-bone"}, "normal"),
    ("CT, `ct-soft-tissue`", bundled_ct, {"preset": "ct-soft-tissue"}, "draft"),
    ("CT, `ct-soft-tissue`", bundled_ct, {"preset": "ct-soft-tissue"}, "normal"),
]


def measured(engines: dict[str, Answering], rounds: int, folder: Path) -> str:
    """The table."""
    lines = [
        "| case | quality | wasm | SSE2 | AVX2 | wasm / SSE2 | wasm / AVX2 | first frame, wasm / AVX2 | same |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    opened = None
    for name, volume, look, quality in CASES:
        if opened is not volume:
            for engine in engines.values():
                engine(volume(folder))
            opened = volume
        draw = {"ask": "draw", "asked": {"size": SIZE, "quality": quality}}
        least: dict[str, float] = {}
        first: dict[str, float] = {}
        hashes: dict[tuple[str, int], int] = {}
        for engine_name, engine in engines.items():
            engine({"ask": "look", "asked": look})
            engine({"ask": "camera", "asked": {"orbit": VIEWS[0], "view_angle": ANGLE}})
            first[engine_name] = engine(draw)["ms"]
        for _, (number, view) in itertools.product(range(rounds), enumerate(VIEWS)):
            for engine_name, engine in engines.items():
                engine({"ask": "camera", "asked": {"orbit": view, "view_angle": ANGLE}})
                ms = engine(draw)["ms"]
                least[engine_name] = min(ms, least.get(engine_name, ms))
                hashes[engine_name, number] = engine({"ask": "floats"})["crc32"]
        same = sum(len({hashes[engine_name, number] for engine_name in engines}) == 1 for number in range(len(VIEWS)))
        wasm, sse2, avx2 = least.values()
        lines.append(
            f"| {name} | {quality} | {wasm:.0f} | {sse2:.0f} | {avx2:.0f} | {wasm / sse2:.2f} | {wasm / avx2:.2f} "
            f"| {first['wasm']:.0f} / {first['avx2']:.0f} | {same} of {len(VIEWS)} |"
        )
        print(lines[-1], flush=True)
    return "\n".join(lines)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--module", type=Path, required=True, help="the module")
    parser.add_argument("--twin", type=Path, required=True, help="its twin")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--record", action="store_true", help="keep the table in benches/records")
    asked = parser.parse_args()
    engines = {
        "wasm": Answering("node", ROOT / "web/wasm/twin.mjs", asked.module),
        "sse2": Answering(asked.twin, "sse2"),
        "avx2": Answering(asked.twin, "avx2"),
    }
    with tempfile.TemporaryDirectory() as folder:
        table = measured(engines, asked.rounds, Path(folder))
    for engine in engines.values():
        engine.close()
    module = asked.module.read_bytes()
    size = f"The module has {len(module) / 1e6:.2f} MB, {len(gzip.compress(module, 9)) / 1e3:.0f} kB by gzip."
    print(f"{table}\n\n{size}")
    if asked.record:
        text = f"CPU ms of a frame of {SIZE[0]} x {SIZE[1]}, one thread.\n\n{table}\n\n{size}"
        records.keep("make bench-wasm", text)


if __name__ == "__main__":
    main()
