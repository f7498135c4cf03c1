"""Instructions per texel of the renderer, counted by callgrind; `make instructions` runs this.

Times on shared machines vary by a factor, counts do not. The frames are those of `crates/splat/examples/frames.rs` on
one thread: a phantom, which is always counted, and the scans of `cases.toml` whose files are in BENCH_DATA. The count
of one frame is that of two frames less that of one, so that set-up falls out. Valgrind knows no AVX-512, so these are
the counts of the AVX2 kernels. Exit code 1 if a count is more than 10 % above the one in `instructions.json`;
`--record` writes that file. `--beside PROGRAM` times the scans instead, beside another build of the example: processor
time of six frames over the other's, medians of five pairs, least and most.

Vector instructions that are functions of their own in the program are an error too, of any width: they are called from
a closure or function that is not `#[inline(always)]`, which costs a call and a trip through memory per instruction.
"""

from __future__ import annotations

import json
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FRAMES = ROOT / "target" / "release" / "examples" / "frames"
RECORD = Path(__file__).with_name("instructions.json")
ALLOWED = 1.10

#: Curves and lights that are counted.
SCENES = (("soft", "headlight"), ("hard", "headlight"), ("soft", "default"))


def scans() -> dict[str, dict[str, list[str]]]:
    """Writes the samples of each scan whose file is there to `.cache`, and returns the example's arguments by curve."""
    import scenes

    arguments: dict[str, dict[str, list[str]]] = {}
    for name in ("engine", "mri"):
        definition = scenes.DEFINITIONS["volumes"][name]
        if (scenes.DATA / definition["file"]).exists():
            volume = scenes.load(name)
            scenes.CACHE.mkdir(parents=True, exist_ok=True)
            path = scenes.CACHE / f"{name}.raw"
            path.write_bytes(volume.samples.tobytes())
            head = [str(path), *map(str, reversed(volume.samples.shape)), *map(str, volume.spacing)]
            ramps = {"soft": definition["ramp"], "hard": [definition["threshold"] - 1, definition["threshold"]]}
            arguments[name] = {curve: [*head, *map(str, ramp)] for curve, ramp in ramps.items()}
    return arguments


def processor_seconds(program: Path, curve: str, light: str, file: list[str]) -> float:
    """Processor time of six frames and their set-up."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([program, curve, light, "6", *file], capture_output=True, check=True)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def compare_times(other: Path) -> None:
    """Prints the processor time of each scan over that of another build."""
    for name, curves in scans().items():
        for curve, light in SCENES:
            pairs = [[processor_seconds(p, curve, light, curves[curve]) for p in (FRAMES, other)] for _ in range(5)]
            ratios = sorted(own / others for own, others in pairs)
            print(f"{name} {curve}, {light}: {ratios[2]:.2f} [{ratios[0]:.2f}..{ratios[-1]:.2f}]", flush=True)


def run(curve: str, light: str, n_frames: int, file: list[str]) -> tuple[int, int]:
    """Instructions of the whole program, and texels of a frame."""
    with tempfile.TemporaryDirectory() as folder:
        command = [
            "valgrind",
            "--tool=callgrind",
            f"--callgrind-out-file={folder}/out",
            str(FRAMES),
            curve,
            light,
            str(n_frames),
            *file,
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    collected = re.search(r"Collected : (\d+)", done.stderr)
    if collected is None:
        raise SystemExit(f"valgrind told no count:\n{done.stderr}")
    return int(collected[1]), int(done.stdout.split()[0])


def calls_of_vector_instructions() -> list[str]:
    """Names of vector instructions that were not inlined."""
    names = subprocess.run(["nm", "--demangle", str(FRAMES)], capture_output=True, text=True, check=True).stdout
    return sorted(set(re.findall(r"core_arch::.*::(_mm(?:256|512)_\w+)", names)))


def main() -> int:
    """Count, print, compare."""
    if sys.argv[1:2] == ["--beside"]:
        compare_times(Path(sys.argv[2]))
        return 0
    counts = {}
    volumes: dict[str, dict[str, list[str]]] = {"ripples": {"soft": [], "hard": []}, **scans()}
    for name, curves in volumes.items():
        for curve, light in SCENES:
            file = curves[curve]
            (once, n_texels), (twice, _) = run(curve, light, 1, file), run(curve, light, 2, file)
            counts[f"{name} {curve}, {light}"] = round((twice - once) / n_texels, 2)
    recorded = json.loads(RECORD.read_text(encoding="utf-8"))
    if "--record" in sys.argv[1:]:
        recorded |= counts
        RECORD.write_text(json.dumps(recorded, indent=1) + "\n", encoding="utf-8")
    status = 0
    if called := calls_of_vector_instructions():
        print(f"called, not inlined: {', '.join(called)}; some closure or function around them lacks inline(always)")
        status = 1
    for scene, count in counts.items():
        change = count / recorded[scene]
        print(f"{scene}: {count} instructions per texel, {recorded[scene]} recorded, {change - 1:+.1%}")
        if change > ALLOWED:
            print(f"{scene}: more than {ALLOWED - 1:.0%} above the record; mend it, or record why it is worth it")
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
