"""Time, quality and memory of the frames of `cases.toml`, ours, VTK's and VolPack's in turn; `make bench` runs this.

Every row is a fresh process: one frame is thrown away, then the camera turns by 0.3 degrees from frame to frame. CPU
milliseconds are those of the whole process per frame, the median over the frames; the picture that is compared is the
view itself. PSNR (peak 1) and mean absolute error (grey levels of 255) are over all pixels and channels, over black,
against `wavesplat.reference.raycast` (double precision, a step of 0.05 voxels, 16 rays a pixel where the transfer
function is a hard step), which is kept in `.cache/bench`. Noise: engines take turns, `--rounds` times, and the table
shows the lowest median of the rounds.

Our rows are what a user asks for by name: a quality, or a PSNR. Columns give VTK's CPU time for the same picture in the
same run over the row's, the row's PSNR less VTK's, and with `psnr` the PSNR that the report promises.
Below the table stands whether the goals of `cases.toml` are met (`goals.py`).

`--against REVISION` adds rows of our renderer as it was at a git revision, built into `.cache/bench`.

`--only scaling` shows how time grows with the task (`growth.py`), `--only large` also how much memory a large volume
takes: the peak of the whole process, less what it held before that volume was made of a small one.

`--record` writes the tables, with date, machine, command and commit, to `records/` beside this file, and the group
"goals", where all of it was drawn, into the README there.
"""

from __future__ import annotations

import argparse
import ctypes.util
import dataclasses
import json
import os
import re
import resource
import shlex
import statistics
import subprocess
import sys
import time
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import goals
import growth
import records
import scale
import scenes

ROOT = scenes.ROOT
README = Path(__file__).with_name("README.md")
N_FRAMES = 7

#: Fields of the report of a picture with `psnr`: the sampling that was chosen, and the PSNR that it promises.
PROMISES = ("sheets_per_slice", "oversampling", "expected_psnr_db", "expected_psnr_spread_db")

Job = tuple[scenes.Case, str, dict[str, Any]]


def measure(draw: Callable[[float], Any]) -> dict[str, float]:
    """Median CPU and wall milliseconds per frame; `draw` draws the scene turned by some degrees."""
    draw(0.3)
    cpu, wall = [], []
    for frame in range(N_FRAMES):
        cpu_0, wall_0 = time.process_time(), time.perf_counter()
        draw(0.3 * (frame + 2))
        cpu.append(1e3 * (time.process_time() - cpu_0))
        wall.append(1e3 * (time.perf_counter() - wall_0))
    return {"cpu_ms": statistics.median(cpu), "wall_ms": statistics.median(wall)}


def run_wavesplat(case: scenes.Case, settings: dict[str, Any]) -> dict[str, float]:
    """Measure our renderer on a case."""
    kept = None
    if "like_turned_deg" in settings:
        # All frames are of one scene, which keeps what it measured for its first picture.
        settings, kept = dict(settings), scenes.scene(case)
        scenes.render(case, settings.pop("like_turned_deg"), kept=kept, **settings)
    result = measure(lambda turn: scenes.render(case, turn, kept=kept, **settings))
    result["samples_mib"] = scenes.load(case.volume, case.grid).samples.nbytes / 2**20
    if case.compared and case.composite == "over":
        picture = scenes.render(case, kept=kept, **settings)
        result["psnr_db"], result["levels"] = scenes.errors(scenes.over_black(picture.rgba), scenes.converged(case))
        if "psnr" in settings:
            result |= {name: picture.report[name] for name in PROMISES if name in picture.report}
    return result


def run_vtk(case: scenes.Case, settings: dict[str, Any]) -> dict[str, float]:
    """Measure VTK's ray caster for CPUs on a case."""
    import vtk_peer

    peer = vtk_peer.Scene(case, **settings)
    result = measure(peer.draw)
    result["psnr_db"], result["levels"] = scenes.errors(peer.picture(), scenes.converged(case))
    return result


def run_volpack(case: scenes.Case, settings: dict[str, Any]) -> dict[str, float]:
    """Measure VolPack's shear-warp on a case."""
    import volpack_peer

    peer = volpack_peer.Scene(case, **settings)
    result = measure(peer.draw)
    result["psnr_db"], result["levels"] = scenes.errors(peer.picture(), scenes.converged(case))
    return result | {"preparation_ms": peer.preparation_ms}


ENGINES = {"wavesplat": run_wavesplat, "vtk": run_vtk, "volpack": run_volpack}


def one_row(request: str) -> None:
    """Measure one row in the fresh process, and print it as JSON."""
    asked = json.loads(request)
    case = scenes.Case(**asked["case"])
    result = {}
    if case.grid != "own":
        scenes.load(case.volume)
        result["start_mib"] = rss_mib()
    result |= ENGINES[asked["engine"]](case, asked["settings"])
    result["rss_mib"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps(result))


def rss_mib() -> float:
    """Resident memory of this process now, MiB; 0 without /proc."""
    statm = Path("/proc/self/statm")
    return int(statm.read_text().split()[1]) * resource.getpagesize() / 2**20 if statm.exists() else 0.0


def fresh_process(engine: str, case: scenes.Case, settings: dict[str, Any]) -> dict[str, float]:
    """Measure a row in a process of its own. `engine` may be "wavesplat@REVISION", after `build_revision` of it."""
    kind, _, revision = engine.partition("@")
    request = json.dumps({"engine": kind, "case": dataclasses.asdict(case), "settings": settings})
    environment = dict(os.environ)
    if revision:
        environment["PYTHONPATH"] = str(package_of(revision))
    command = [sys.executable, __file__, "--row", request]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode != 0:
        raise SystemExit(f"{engine}, {case.label}, {settings}:\n{done.stderr}")
    result: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return result


def package_of(revision: str) -> Path:
    """Folder in which the package of a revision is kept."""
    return scenes.CACHE / f"package-{revision}"


def build_revision(name: str) -> str:
    """Build our package as it was at a git revision, unless it is kept; return the short form of the revision."""
    git = ["git", "-C", str(ROOT)]
    revision = subprocess.check_output([*git, "rev-parse", "--short", f"{name}^{{commit}}"], text=True).strip()
    package = package_of(revision)
    if not package.exists():
        tree = scenes.CACHE / f"tree-{revision}"
        subprocess.run([*git, "worktree", "add", "--force", "--detach", str(tree), revision], check=True)
        try:
            build = ["maturin", "build", "--release", "--locked", "--out", str(tree / "wheel")]
            subprocess.run(build, check=True, cwd=tree, env={**os.environ, "CARGO_TARGET_DIR": str(ROOT / "target")})
            (wheel,) = (tree / "wheel").glob("*.whl")
            unfinished = package.with_suffix(".part")
            zipfile.ZipFile(wheel).extractall(unfinished)
            unfinished.rename(package)
        finally:
            subprocess.run([*git, "worktree", "remove", "--force", str(tree)], check=True)
    return revision


def installed_rivals() -> set[str]:
    """Names of the other engines that are installed; print how to get the missing ones."""
    probe = [sys.executable, "-c", "import vtkmodules"]
    found = {
        ("vtk", "pip install vtk"): subprocess.run(probe, capture_output=True, check=False).returncode == 0,
        ("volpack", "apt-get install libvolpack1-dev"): ctypes.util.find_library("volpack") is not None,
    }
    for (name, remedy), is_here in found.items():
        if not is_here:
            print(f"{name} is not installed, its rows are left out: {remedy}", file=sys.stderr)
    return {name for (name, _), is_here in found.items() if is_here}


def jobs_of(case: scenes.Case, engines: Sequence[str], rivals: set[str]) -> list[Job]:
    """Jobs of a case: our engines with all its settings, and others where they can draw the same."""
    jobs: list[Job] = [(case, engine, settings) for settings in case.settings for engine in engines]
    if case.rival and case.composite == "over" and case.kernel == "linear":
        if "vtk" in rivals:
            jobs.append((case, "vtk", {"sample_distance": 1.0 if case.curve == "soft" else 0.5}))
        if "volpack" in rivals and case.projection == "orthographic":
            jobs.append((case, "volpack", {"min_opacity": 0.002}))
    return jobs


def describe(engine: str, settings: dict[str, Any]) -> str:
    """An engine and its settings in a few words."""
    words = [f"{name.replace('_', ' ')} {value}" for name, value in settings.items()]
    return ", ".join([engine, *words])


def table(rows: Sequence[growth.Row]) -> str:
    """A Markdown table of pictures drawn for their own sake; columns that no row fills are left out."""
    lines = [cells_of(row, goals.rival_of(row[0], rows)) for row in rows]
    headings = [name for name in lines[0] if any(line[name] for line in lines)]
    return growth.as_markdown(headings, [[line[name] for name in headings] for line in lines])


def cells_of(row: growth.Row, rival: dict[str, float] | None) -> dict[str, str]:
    """The cells of a row by their headings. `rival`: VTK's row of the same case."""
    case, engine, settings, result = row

    def told(form: str, *names: str) -> str:
        return form.format(*(result[name] for name in names)) if all(name in result for name in names) else ""

    is_compared = rival is not None and "psnr_db" in result
    words = describe(engine, settings) + told(", prepared in {:.0f} ms", "preparation_ms")
    return {
        "case": case.label,
        "engine": words,
        "CPU ms": told("{:.1f}", "cpu_ms"),
        "VTK's CPU ms / these": f"{rival['cpu_ms'] / result['cpu_ms']:.1f}" if rival else "",
        "wall ms": told("{:.1f}", "wall_ms"),
        "expected, dB": told("{:.1f} +- {:.1f}", "expected_psnr_db", "expected_psnr_spread_db"),
        "PSNR, dB": told("{:.1f}", "psnr_db"),
        "above VTK's": f"{result['psnr_db'] - rival['psnr_db']:+.1f}" if rival and is_compared else "",
        "levels": told("{:.2f}", "levels"),
        "sheets a slice": told("{:g}", "sheets_per_slice"),
        "texels a pixel": told("{:.2f}", "oversampling"),
        "peak RSS, MiB": told("{:.0f}", "rss_mib"),
    }


def tables(rows: Sequence[growth.Row]) -> str:
    """Markdown tables, one for each kind of case."""
    of_pictures = [row for row in rows if not row[0].change]
    of_time = [row for row in rows if row[0].change and row[0].group == "scaling"]
    of_memory = [row for row in rows if row[0].change and row[0].group == "large"]
    parts = [(table, of_pictures), (growth.time_table, of_time), (growth.memory_table, of_memory)]
    texts = [make(chosen) for make, chosen in parts if chosen]
    return "\n\n".join([*texts, *goals.verdicts(rows)])


def show_in_readme(rows: Sequence[growth.Row], record: Path) -> None:
    """Put the table of the goals into the README of this folder, with the record that it is from."""
    source = f"From the record of [{record.stem}]({record.relative_to(README.parent).as_posix()})."
    block = f"<!-- bench -->\n\n{source}\n\n{tables(rows)}\n\n<!-- /bench -->"
    content = README.read_text(encoding="utf-8")
    content = re.sub(r"<!-- bench -->.*<!-- /bench -->", lambda _: block, content, flags=re.DOTALL)
    README.write_text(content, encoding="utf-8")


def large_volumes(*, is_recorded: bool) -> int:
    """Volumes larger than memory, and several processes: `scale.py`."""
    text = scale.table()
    if is_recorded:
        records.keep('make bench BENCH="--only scale"', text)
    return 0


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Time and quality of frames, ours and others'.")
    parser.add_argument(
        "--only", action="append", default=[], metavar="TEXT", help="cases whose label or group holds it"
    )
    parser.add_argument(
        "--against", action="append", default=[], metavar="REVISION", help="also our renderer at a git revision"
    )
    parser.add_argument("--rounds", type=int, default=2, help="turns of all engines; 2 if not given")
    parser.add_argument(
        "--record", action="store_true", help="keep the tables in benches/records, the goals also in benches/README.md"
    )
    parser.add_argument("--row", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.row:
        one_row(options.row)
        return 0
    if options.only == ["scale"]:
        return large_volumes(is_recorded=options.record)
    chosen = [
        case
        for case in scenes.cases()
        if not options.only or any(text in case.label or text == case.group for text in options.only)
    ]
    left_out = sorted({case.volume for case in chosen if not scenes.is_available(case.volume)})
    if left_out:
        print(f"not here, left out: {', '.join(left_out)}; BENCH_DATA names the folder of the files", file=sys.stderr)
    others = [f"wavesplat@{build_revision(name)}" for name in options.against]
    rivals = installed_rivals()
    jobs: list[Job] = []
    for case in chosen:
        if case.volume not in left_out:
            jobs += jobs_of(case, ["wavesplat", *others], rivals)
    results: list[list[dict[str, float]]] = [[] for _ in jobs]
    for round_idx in range(options.rounds):
        for job_idx, (case, engine, settings) in enumerate(jobs):
            results[job_idx].append(fresh_process(engine, case, settings))
            found = results[job_idx][-1]
            progress = f"[{round_idx + 1}/{options.rounds}, {job_idx + 1}/{len(jobs)}]"
            print(f"{progress} {case.label}: {describe(engine, settings)}: {found}", file=sys.stderr, flush=True)
    rows = [
        (case, engine, settings, min(found, key=lambda result: result["cpu_ms"]))
        for (case, engine, settings), found in zip(jobs, results, strict=True)
    ]
    text = tables(rows)
    print(text)
    if options.record:
        record = records.keep(f'make bench BENCH="{shlex.join(sys.argv[1:])}"', text)
        of_goals = [row for row in rows if row[0].group == goals.GROUP]
        # The README gets the table only if all cases of the goals were drawn.
        if {case.label for case, *_ in of_goals} == set(goals.labels()):
            show_in_readme(of_goals, record)
    return 0


if __name__ == "__main__":
    sys.exit(main())
