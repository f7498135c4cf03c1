"""Standard splatting, high-resolution splatting and its ablations, ray casting, side by side; `make study` runs this.

After "High Resolution Image Splatting" (Int. J. of Advanced Computational Engineering and Networking 2-7, 2014): the
ripples of 32^3 samples, a CT of half a pelvis, an MRI of a head; a soft and a hard transfer function each, Phong
shading, parallel projection from an oblique view. Ways to draw are listed in `entries.py`, volumes in `../subjects.py`.

What they are compared with:

converged   The reference ray caster, linear kernel, 20 steps per sample distance; 16 rays a pixel for hard functions.
signal      Of the ripples: rays through the formula itself (`signal_caster.py`), as in the paper's figure 8.

PSNR = 10 log10(1 / mean squared error) over all pixels and colour channels, over black; the error is the mean absolute
difference in grey levels of 255. Milliseconds are of the processor, all threads together: the least of a few runs after
one that prepares the volume. The ray caster is the reference of the tests, written to be exact and not to be fast.
The ablations are drawn by `wavesplat.study.splat`, which is no faster: its times say nothing about the method.

One page of HTML with the pictures goes to `--out`, and the tables as Markdown beside it; `--record` also writes them to
RESULTS.md beside this file. Converged pictures are kept in `.cache/study`.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import argparse
import datetime as dt
import hashlib
import math
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import entries
import machine
import page
import signal_caster
import subjects
from entries import Entry
from tables import as_markdown, as_text

ROOT = Path(__file__).resolve().parents[2]
CACHE = ROOT / ".cache" / "study"
RESULTS = Path(__file__).with_name("RESULTS.md")

SUBJECTS = {"ripples": subjects.RIPPLES, "ct": subjects.CT, "mri": subjects.MRI}
CURVES = ("soft", "hard")

#: Step of the converged pictures, in voxels.
STEP_VOXELS = 0.05
HARD_RAYS = 16

#: Samples of the ripples along a side, and the views on the signal: azimuth and elevation.
N_RIPPLES = 32
SIGNAL_VIEWS = {"oblique": subjects.RIPPLES.view, "from above": (0, 90)}

#: A measurement is repeated until this much processor time is spent.
TIMING_MS = 120

#: Curve over the view's angle: elevations in degrees, and the side of the pictures in pixels.
ANGLES = (0, 10, 20, 30, 40, 44)
ANGLE_SIZE_PX = 160

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Row:
    """Measurements of a picture."""

    scene: tuple[str, str]
    entry: Entry
    #: Processor time, milliseconds; NaN for a literal twin.
    ms: float
    psnr_db: float
    #: Mean absolute error, grey levels.
    error: float
    picture: Array


def transfer_function(name: str, curve: str) -> ws.TransferFunction:
    """Transfer function of a subject: its curve "soft" or "hard"."""
    drawn = SUBJECTS[name]
    return subjects.hard_function(drawn.hard) if curve == "hard" else subjects.soft_function(*drawn.soft)


def scene_of(name: str, curve: str, volume: ws.Volume, size_px: int) -> dict[str, Any]:
    """Arguments that `render` and `raycast` have in common."""
    drawn = SUBJECTS[name]
    return {
        "transfer_function": transfer_function(name, curve),
        "camera": ws.Camera.orbit(volume, *drawn.view, fit="view"),
        "size": (size_px, size_px),
        "clip": drawn.crop or (),
    }


def rgb(rgba: NDArray[Any]) -> Array:
    """Colour over black, 0..1."""
    return np.clip(np.asarray(rgba[..., :3], np.float64), 0, 1)


def psnr_db(picture: Array, wanted: Array) -> float:
    """PSNR over all pixels and channels, dB."""
    square = float(np.mean((picture - wanted) ** 2))
    return 10 * math.log10(1 / square) if square > 0 else math.inf


def grey_levels(picture: Array, wanted: Array) -> float:
    """Mean absolute difference, in grey levels of 255."""
    return float(255 * np.abs(picture - wanted).mean())


def converged(volume: ws.Volume, scene: dict[str, Any], *, is_hard: bool) -> Array:
    """The converged picture, from the cache if it is there."""
    how = {**scene, "step": STEP_VOXELS, "rays_per_pixel": HARD_RAYS if is_hard else 1}
    digest = hashlib.sha256(repr(how).encode() + volume.samples.tobytes()).hexdigest()[:16]
    path = CACHE / f"{digest}.npy"
    if not path.exists():
        CACHE.mkdir(parents=True, exist_ok=True)
        np.save(path, ws.reference.raycast(volume, **how).rgba)
    found: Array = np.load(path)
    return rgb(found)


def timed(entry: Entry, volume: ws.Volume, scene: dict[str, Any]) -> tuple[float, Array]:
    """Milliseconds of processor time, the least of a few runs, and the picture."""
    if entry.is_literal:
        return math.nan, rgb(entry.draw(volume, scene).rgba)
    if entry.draws is not ws.reference.raycast:
        entry.draw(volume, {**scene, "size": (8, 8)})
    spent: list[float] = []
    while sum(spent) < TIMING_MS and len(spent) < 7:
        started = time.process_time()
        picture = entry.draw(volume, scene)
        spent.append(1e3 * (time.process_time() - started))
    return min(spent), rgb(picture.rgba)


def measure(name: str, curve: str, size_px: int) -> tuple[Array, list[Row]]:
    """Draw the converged picture of a scene, and measure every way to draw it."""
    started = time.monotonic()
    volume = SUBJECTS[name].source()
    scene = scene_of(name, curve, volume, size_px)
    wanted = converged(volume, scene, is_hard=curve == "hard")
    rows = []
    ways = [*entries.RAYS, *entries.STANDARDS, *entries.QUALITIES, *entries.SETTINGS, *entries.ABLATIONS]
    for entry in ways:
        ms, picture = timed(entry, volume, scene)
        rows.append(Row((name, curve), entry, ms, psnr_db(picture, wanted), grey_levels(picture, wanted), picture))
    print(f"{name}, {curve}: {time.monotonic() - started:.0f} s", file=sys.stderr, flush=True)
    return wanted, rows


def at_equal_time(rows: list[Row]) -> tuple[Row, Row]:
    """Rows of standard splatting and of our best setting that takes no longer, or of the fastest if all take longer."""
    standard = next(row for row in rows if row.entry is entries.STANDARD)
    ours = [row for row in rows if row.entry in entries.SETTINGS]
    in_time = [row for row in ours if row.ms <= standard.ms]
    best = max(in_time, key=lambda row: row.psnr_db) if in_time else min(ours, key=lambda row: row.ms)
    return standard, best


@dataclass(frozen=True)
class Signal:
    """The signal's picture of a view and a curve, and the ways to draw its samples, nearest first."""

    view: str
    curve: str
    picture: Array
    ranking: list[tuple[float, float, Entry, Array]]


def against_signal(view: str, curve: str, size_px: int) -> Signal:
    """Compare every kernel by every way with the signal."""
    started = time.monotonic()
    volume = ws.examples.ripples(N_RIPPLES)
    camera = ws.Camera.orbit(volume, *SIGNAL_VIEWS[view], fit="view")
    tf = transfer_function("ripples", curve)
    is_hard = curve == "hard"
    # A tenth of a sample distance is a sixteenth of the shortest wave; surfaces are refined by bisection.
    fineness: dict[str, Any] = {"rays_per_axis": 3, "step": 0.2} if is_hard else {"step": 0.1}
    drawn = signal_caster.draw(tf, camera, N_RIPPLES, (size_px, size_px), is_hard=is_hard, **fineness)
    wanted = rgb(drawn)
    scene = {"transfer_function": tf, "camera": camera, "size": (size_px, size_px)}
    found = []
    for entry in entries.AGAINST_SIGNAL:
        picture = rgb(entry.draw(volume, scene).rgba)
        found.append((psnr_db(picture, wanted), grey_levels(picture, wanted), entry, picture))
    found.sort(key=lambda row: -row[0])
    print(f"signal, {view}, {curve}: {time.monotonic() - started:.0f} s", file=sys.stderr, flush=True)
    return Signal(view, curve, wanted, found)


def angles() -> dict[str, list[float]]:
    """Mean brightness of the head over the view's elevation, percent of the ray caster's."""
    volume = SUBJECTS["mri"].source()
    ways = {
        "high-resolution splatting": entries.BASE,
        "the same, not corrected": entries.UNCORRECTED,
        "standard, sheets along the axes": entries.STANDARDS[0],
        "the same, not corrected ": entries.STANDARDS[3],
        "standard, parallel to the view": entries.STANDARDS[4],
        "the same, not corrected  ": entries.STANDARDS[5],
    }
    found: dict[str, list[float]] = {label: [] for label in ways}
    for angle in ANGLES:
        scene = scene_of("mri", "soft", volume, ANGLE_SIZE_PX)
        scene["camera"] = ws.Camera.orbit(volume, 0, angle, fit="view")
        wanted = rgb(entries.RAYS[1].draw(volume, scene).rgba).mean()
        for label, entry in ways.items():
            found[label].append(100 * float(rgb(entry.draw(volume, scene).rgba).mean() / wanted))
    return found


def scene_table(rows: list[Row]) -> list[list[str]]:
    """Table of all ways to draw a scene, in the order of the entries."""
    lines = [["", "", "CPU ms", "PSNR, dB", "error, grey levels"]]
    for row in rows:
        if row.entry not in entries.SETTINGS:
            ms = "" if row.entry.is_literal else f"{row.ms:.1f}"
            numbers = [ms, f"{row.psnr_db:.1f}", f"{row.error:.2f}"]
            lines.append([row.entry.group, row.entry.label, *numbers])
    return lines


def equal_time_table(scenes: dict[tuple[str, str], list[Row]]) -> list[list[str]]:
    """Table of standard splatting, and of our best setting in the same time."""
    lines = [["scene", "standard, ms", "dB", "ours in that time", "ms", "dB", "dB gained"]]
    for (name, curve), rows in scenes.items():
        standard, ours = at_equal_time(rows)
        gain = ours.psnr_db - standard.psnr_db
        numbers = [f"{standard.ms:.1f}", f"{standard.psnr_db:.1f}", ours.entry.label, f"{ours.ms:.1f}"]
        lines.append([f"{name}, {curve}", *numbers, f"{ours.psnr_db:.1f}", f"{gain:+.1f}"])
    return lines


def signal_table(signals: list[Signal]) -> list[list[str]]:
    """Table of the PSNR against the signal, by way to draw."""
    lines = [["", "", *(f"{signal.view}, {signal.curve}" for signal in signals), "mean"]]
    for entry in entries.AGAINST_SIGNAL:
        numbers = [next(db for db, _, other, _ in signal.ranking if other is entry) for signal in signals]
        shown = [f"{number:.1f}" for number in numbers]
        lines.append([entry.group, entry.label, *shown, f"{np.mean(numbers):.1f}"])
    return lines


def angle_table(found: dict[str, list[float]]) -> list[list[str]]:
    """Table of the brightness over the angle."""
    heading = ["percent of the ray caster's", *(f"{angle} degrees" for angle in ANGLES)]
    return [heading, *([label.strip(), *(f"{value:.1f}" for value in values)] for label, values in found.items())]


def findings(scenes: dict[tuple[str, str], list[Row]], signals: list[Signal]) -> list[str]:
    """Sentences that sum up the numbers."""
    said = []
    for (name, curve), rows in scenes.items():
        standard, ours = at_equal_time(rows)
        high = next(row for row in rows if row.entry is entries.QUALITIES[2])
        when = "in no more time" if ours.ms <= standard.ms else f"in {ours.ms / standard.ms:.2f} times the time"
        said.append(
            f"{name}, {curve}: standard splatting is {standard.psnr_db:.1f} dB from the converged picture, "
            f"high-resolution splatting {when} {ours.psnr_db:.1f} dB ({ours.psnr_db - standard.psnr_db:+.1f}), and "
            f"{high.psnr_db:.1f} dB at its best quality."
        )
    for signal in signals:
        db, _, best, _ = signal.ranking[0]
        other_db, _, other, _ = next(row for row in signal.ranking if row[2].group != best.group)
        said.append(
            f"Ripples {signal.view}, {signal.curve}: nearest to the unsampled signal is {best.group}, {best.label} "
            f"({db:.1f} dB); the nearest of another kind is {other.group}, {other.label} ({other_db:.1f} dB)."
        )
    return said


def report(
    scenes: dict[tuple[str, str], list[Row]], signals: list[Signal], found: dict[str, list[float]], size_px: int
) -> str:
    """The tables as Markdown."""
    tables = "\n\n".join(
        f"## {name}, {curve}\n\n{as_markdown(scene_table(rows))}" for (name, curve), rows in scenes.items()
    )
    said = "\n".join(f"- {sentence}" for sentence in findings(scenes, signals))
    return f"""# Splatting, old and high-resolution, and ray casting

{dt.datetime.now(dt.UTC).date()}, {machine.describe()}, {size_px} x {size_px} pixels.
Command: `make study STUDY=--record`, which also makes a page with the pictures.
What is measured, and how, stands at the head of `method.py`.

{said}

## At equal time

The best of the settings in `entries.py` that takes no longer than standard splatting with sheets along the axes; linear
kernel, compared with the converged picture.

{as_markdown(equal_time_table(scenes))}

## Nearest to the unsampled signal

PSNR in dB from the ripples drawn without samples. All at quality high; d is half the width of the differences for
gradients in sample distances. 32 samples a side do not carry all of this signal (its waves are 1.6 samples long at
r = 1), so that no kernel comes close everywhere.

{as_markdown(signal_table(signals))}

## Brightness over the view's angle

The head, soft, from the front, at elevations up to 44 degrees.

{as_markdown(angle_table(found))}

{tables}
"""


def blocks(
    wanted: dict[tuple[str, str], Array],
    scenes: dict[tuple[str, str], list[Row]],
    signals: list[Signal],
    found: dict[str, list[float]],
) -> list[tuple[str, str]]:
    """Titles and HTML of the page's blocks."""
    shown = [
        ("At equal time", page.table(equal_time_table(scenes)) + page.time_plot(scenes)),
        ("Nearest to the unsampled signal", page.table(signal_table(signals))),
    ]
    shown += [(f"The ripples {s.view}, {s.curve}", page.signal_strip(s)) for s in signals]
    for (name, curve), rows in scenes.items():
        inside = page.scene_strip(wanted[name, curve], rows, at_equal_time(rows)[1])
        inside += f"<details><summary>All numbers</summary>{page.table(scene_table(rows))}</details>"
        shown.append((f"{name}, {curve}", inside))
    shown.append(("Brightness over the view's angle", page.angle_plot(ANGLES, found) + page.table(angle_table(found))))
    for (name, curve), rows in scenes.items():
        if curve == "hard":
            shown.append(
                (f"What each part of the method buys: {name}, hard", page.ablation_strips(wanted[name, curve], rows))
            )
    return shown


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description="Compare ways to draw volumes.")
    parser.add_argument("--size", type=int, default=400, metavar="PX", help="side of the pictures; 400")
    parser.add_argument("--only", nargs="+", default=list(SUBJECTS), dest="subjects", choices=SUBJECTS, help="volumes")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "study", help="folder of the page")
    parser.add_argument("--record", action="store_true", help="write RESULTS.md; all volumes")
    return parser.parse_args()


def main() -> int:
    """Measure, print, write the page."""
    options = arguments()
    if options.record and options.subjects != list(SUBJECTS):
        print("--record needs all volumes; leave out --only", file=sys.stderr)
        return 2
    started = time.monotonic()
    wanted: dict[tuple[str, str], Array] = {}
    scenes: dict[tuple[str, str], list[Row]] = {}
    for name in options.subjects:
        for curve in CURVES:
            wanted[name, curve], scenes[name, curve] = measure(name, curve, options.size)
    signals = [against_signal(view, curve, options.size) for view in SIGNAL_VIEWS for curve in CURVES]
    found = angles()
    text = report(scenes, signals, found, options.size)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "study.md").write_text(text, encoding="utf-8")
    heading = f"{dt.datetime.now(dt.UTC).date()}, {machine.describe()}, {options.size} x {options.size} pixels."
    page.write(options.out / "index.html", findings(scenes, signals), heading, blocks(wanted, scenes, signals, found))
    if options.record:
        RESULTS.write_text(text, encoding="utf-8")
    for rows in (equal_time_table(scenes), signal_table(signals), angle_table(found)):
        print(f"\n{as_text(rows)}")
    print(f"\n{time.monotonic() - started:.0f} s. The page is {options.out / 'index.html'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
