"""Time of a frame by stage, against what a core could do in that time; `make roofline` runs this.

One thread draws frames under `perf`, which notes 2000 times a second of CPU where it is. A place belongs to the first
stage of `STAGES` whose pattern matches the files and functions that are inlined there. The compiler merges look-up and
compositing, so they are one stage. The limits are bytes read and written by a copy of 256 MiB, and floating-point
operations of a matrix product in f32; the tables show how much of each would fit into a stage's time for a texel.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import timeit
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import growth
import numpy as np
import records
import scenes

from wavesplat import _native

STAGES = {
    "shading": r"optics/shade\.rs",
    "warp": r"picture/(warp|resample)\.rs",
    "slices combined and transposed": r"source/(slices|window|transposed)\.rs",
    "weights of footprints": r"kernel/footprint.*\bbuild\b",
    "densities and gradients": r"sheet/(buffer|upsample)\.rs",
    "look-up, opacity, compositing": r"optics/(classify|preintegrate)\.rs|ray/",
    "rays": r"sheet/tile_rays\.rs|view/region\.rs",
    "empty-space skipping": r"source/(min_max_bricks|occupancy)\.rs|render/empty_space\.rs",
    "rest of the renderer": "",
}
CPU_SECONDS = 4.0


def case_of(label: str) -> scenes.Case:
    """The first case with a label."""
    return next(case for case in scenes.cases() if case.label == label)


def draw(label: str, quality: str) -> dict[str, float]:
    """Draw frames of a case for some seconds of CPU, in a process that `perf` watches."""
    case = dataclasses.replace(case_of(label), threads=1)
    scenes.render(case, quality=quality)
    n_texels = n_frames = 0
    start, cpu_0 = time.monotonic(), time.process_time()
    while time.process_time() - cpu_0 < CPU_SECONDS:
        n_texels += scenes.render(case, 0.3 * (n_frames % 20), quality=quality).report["n_texels"]
        n_frames += 1
    cpu_ms = 1e3 * (time.process_time() - cpu_0) / n_frames
    return {"start": start, "end": time.monotonic(), "cpu_ms": cpu_ms, "n_texels": n_texels / n_frames}


def limits() -> dict[str, float]:
    """Bandwidth and arithmetic rate: bytes and floating-point operations per nanosecond, the best of five tries."""
    source, target = np.ones(2**28, np.uint8), np.ones(2**28, np.uint8)
    square = np.ones((2048, 2048), np.float32)
    tasks = (lambda: np.copyto(target, source), lambda: square @ square)
    best = [min(timeit.repeat(task, timer=time.process_time, number=1, repeat=5)) for task in tasks]
    return {"bytes_per_ns": 2 * source.nbytes / best[0] / 1e9, "flop_per_ns": 2 * len(square) ** 3 / best[1] / 1e9}


def alone(task: str, *perf: str, options: Sequence[str] = ()) -> dict[str, float]:
    """Result of a task ("limits" or a case's label), run in a process of its own with one thread for NumPy too."""
    command = [*perf, sys.executable, __file__, "--task", task, *options]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    return json.loads(subprocess.check_output(command, text=True, env=environment))


def places(profile: Path, start: float, end: float) -> tuple[Counter[int], int]:
    """Counts of profile samples between two times: by address in the compiled module, and elsewhere."""
    command = f"perf script -i {profile} --show-mmap-events -F time,ip".split()
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    library = re.escape(Path(_native.__file__).name)
    mapped = re.search(rf"\[0x(\w+)\(0x(\w+)\) @ (\w+) [^]]*\]: r-xp .*{library}$", text, re.MULTILINE)
    headers = subprocess.check_output(["readelf", "-lW", _native.__file__], text=True)
    segment = re.search(r"LOAD +(0x\w+) (0x\w+) .* R E ", headers)
    if mapped is None or segment is None:
        raise SystemExit("perf did not see the compiled module")
    first, size = int(mapped[1], 16), int(mapped[2], 16)
    address_from_ip = int(mapped[3], 0) - first + int(segment[2], 0) - int(segment[1], 0)
    samples = re.findall(r"^ *(\d+\.\d+): +([0-9a-f]+)$", text, re.MULTILINE)
    ips = [int(ip, 16) for seconds, ip in samples if start <= float(seconds) <= end]
    inside = Counter(ip + address_from_ip for ip in ips if first <= ip < first + size)
    return inside, len(ips) - inside.total()


def stages(inside: Counter[int]) -> Counter[str]:
    """Counts of profile samples by stage."""
    command = ["addr2line", "-a", "-i", "-f", "-e", _native.__file__]
    asked = "\n".join(hex(address) for address in inside)
    told = subprocess.run(command, input=asked, capture_output=True, text=True, check=True).stdout
    counts: Counter[str] = Counter()
    for chain in re.split(r"^(?=0x\w+$)", told, flags=re.MULTILINE)[1:]:
        address, _, frames = chain.partition("\n")
        # Files first, so that a pattern can ask for a file and a function.
        lines = [line.rpartition("/")[2] for line in frames.splitlines()]
        text = " ".join([*lines[1::2], *lines[::2]])
        stage = next(stage for stage, pattern in STAGES.items() if re.search(pattern, text))
        counts[stage] += inside[int(address, 16)]
    return counts


def table(label: str, quality: str, limit: dict[str, float]) -> str:
    """Table of a case's stages."""
    with tempfile.TemporaryDirectory() as folder:
        profile = Path(folder) / "perf.data"
        frames = alone(
            label, *f"perf record -q -e cpu-clock -F 2000 -k mono -o {profile}".split(), options=["--quality", quality]
        )
        inside, n_outside = places(profile, frames["start"], frames["end"])
    counts = stages(inside)
    counts["memory pages, Python"] = n_outside
    ns_per_texel = 1e6 * frames["cpu_ms"] / frames["n_texels"]
    lines = []
    for name, count in [*counts.most_common(), ("all", counts.total())]:
        ns = count / counts.total() * ns_per_texel
        numbers = [f"{count / counts.total():.1%}", f"{ns:.3f}", f"{1e3 / ns:.0f}"]
        lines.append([name, *numbers, f"{ns * limit['flop_per_ns']:.0f}", f"{ns * limit['bytes_per_ns']:.1f}"])
    headings = ["stage", "share", "ns per texel", "M texels/s per core", "flop it could do", "bytes it could move"]
    head = f"{label}, quality {quality}: {frames['n_texels'] / 1e6:.2f} M texels and {frames['cpu_ms']:.1f} ms a frame."
    return f"{head}\n\n{growth.as_markdown(headings, lines)}"


def main() -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(description="Time by stage against the limits of a core.")
    parser.add_argument("cases", nargs="*", metavar="LABEL", help='as "ct soft"; else "engine soft" and "engine hard"')
    parser.add_argument(
        "--quality", choices=("draft", "normal", "fine", "high"), default="normal", help="normal if not given"
    )
    parser.add_argument("--record", action="store_true", help="keep the tables in benches/records")
    parser.add_argument("--task", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.task:
        print(json.dumps(limits() if options.task == "limits" else draw(options.task, options.quality)))
        return 0
    missing = [tool for tool in ("perf", "addr2line", "readelf") if shutil.which(tool) is None]
    if missing:
        print(f"not installed: {', '.join(missing)}; perf is in linux-tools, the others in binutils", file=sys.stderr)
        return 1
    limit = alone("limits")
    text = f"One core: {limit['bytes_per_ns']:.1f} GB/s of copying, {limit['flop_per_ns']:.0f} Gflop/s of f32."
    for label in options.cases or [f"{scenes.growth_volume()} {curve}" for curve in ("soft", "hard")]:
        text += f"\n\n{table(label, options.quality, limit)}"
    print(text)
    if options.record:
        records.keep(f'make roofline ROOFLINE="{shlex.join(sys.argv[1:])}"', text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
