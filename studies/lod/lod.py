"""Change of a picture's brightness where levels of details are left out; `make study-lod` runs this.

A coarse sample stands for many samples. Classified by its own value (the plain low-pass) thin structures vanish and the
picture gets darker; `WaveletVolume.level(n)` classifies it by what it stands for (crates/lod).
Both are drawn from the coarse samples at quality normal, which has two sheets a slice and a texel a pixel for plain, a
volume of its own; for a level the texels grow with the samples, and a steep function has one sheet.

Every CT, MRI and engine that is to be had, soft and hard functions, three views: change of the mean brightness of the
picture (mean over pixels and channels, shaded, over black) from the picture of all levels, in percent; the mean over
the views, and in brackets the view that is worst.
Goals: at most half of plain's change; below 8 % at one level; below 4 % at two on CT with a soft function.

Time is of the processor for a frame with everything kept that may be kept (least of 16), at last that of a frame
without any details, which is what the pixels cost: it does not fall with the level. "times less" is the frame with all
levels by that with some left out. Times are reported without a goal. `--large` adds 512^3 and 1024^3 samples, the
engine repeated, of which only times are taken.

A sheet of pictures per volume and function goes to `--out`: above plain, below ours.

`--record` writes the table to RESULTS.md beside this file. Volumes are from BENCH_DATA or, where it lacks them,
bundled.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import argparse
import datetime as dt
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import wavesplat as ws

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import machine
from subjects import DATA, ROOT
from tables import as_markdown

RESULTS = Path(__file__).with_name("RESULTS.md")

#: Azimuth and elevation, degrees.
VIEWS = ((20, 15), (-65, -20), (35, 60))
MAX_DROPPED = 3

#: Sides of the large volumes, and of their pictures.
LARGE = 512, 1024
LARGE_SIZE = 1024

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Subject:
    """A volume, the values of opacity 0, 0.05 and 0.2, and that of the hard step; in the units of its file."""

    file: str
    soft: tuple[float, float, float]
    hard: float
    is_ct: bool = True
    bundled: Callable[[], ws.Volume] | None = None

    def volume(self) -> ws.Volume | None:
        """The volume, from its file or bundled; None if there is neither."""
        path = DATA / self.file
        return ws.open(path) if path.exists() else self.bundled() if self.bundled else None


SUBJECTS = {
    "engine": Subject("engine.nrrd", (70, 180, 255), 100, is_ct=False),
    "ct pelvis": Subject("ct_pelvis_right.nii.gz", (-75, 255, 1000), 199, bundled=ws.examples.ct_pelvis),
    "ct abdomen": Subject("ct_abdomen_pelvis_3mm.nii.gz", (-75, 255, 1000), 199),
    "ct torso, 8 bits": Subject("ct_torso_u8.mha", (100, 180, 255), 170),
    "ct pelvis, DICOM": Subject("dicom_ct_pelvis", (-75, 255, 1000), 199),
    "mri head": Subject("mri_head_t1.nii.gz", (24, 60, 95), 24, is_ct=False, bundled=ws.examples.mri_head),
}


@dataclass(frozen=True)
class Changes:
    """Changes of brightness, percent, by levels left out and view."""

    plain: Array
    ours: Array


@dataclass(frozen=True)
class Row:
    """Measurements of a transfer function on a volume."""

    subject: str
    curve: str
    #: None for large volumes.
    changes: Changes | None
    frame_ms: Sequence[float]

    @property
    def times_less(self) -> list[float]:
        """Time of a frame with all levels over that with one, two, three levels left out."""
        whole, *fewer = self.frame_ms
        return [whole / ms for ms in fewer[:MAX_DROPPED]]

    def misses(self) -> list[str]:
        """Goals that do not hold."""
        if self.changes is None:
            return []
        plain, ours = (np.abs(change.mean(axis=1)) for change in (self.changes.plain, self.changes.ours))
        missed = [f"half of plain at {n + 1}" for n in range(MAX_DROPPED) if ours[n] > plain[n] / 2]
        if ours[0] >= 8:
            missed.append("8 % at 1")
        if self.curve == "soft" and SUBJECTS[self.subject].is_ct and ours[1] >= 4:
            missed.append("4 % at 2")
        return missed


def transfer_function(subject: Subject, curve: str, unit: float) -> ws.TransferFunction:
    """The soft or the hard transfer function of a subject."""
    if curve == "hard":
        return ws.TransferFunction([(subject.hard, 0), (subject.hard + 1, 1)], [(subject.hard, 1, 0.9, 0.75)], unit)
    first, middle, last = subject.soft
    colors = [(first, 0.8, 0.4, 0.25), (middle, 1, 0.8, 0.6), (last, 1, 1, 0.95)]
    return ws.TransferFunction([(first, 0), (middle, 0.05), (last, 0.2)], colors, unit)


def plain_level(wavelets: ws.WaveletVolume, n_dropped: int) -> ws.Volume:
    """The coarse samples, on a grid of their own; cdf97 has them on every second sample of the level before."""
    wider = np.diag([2.0**n_dropped] * 3 + [1.0])
    samples = wavelets._decoded(n_dropped).every(1)
    return ws.Volume(samples, world_from_index=wavelets.world_from_index @ wider, name=wavelets.name)


def draw(
    volume: Any, tf: ws.TransferFunction, view: tuple[int, int], size: int, camera_of: Any = None, **options: Any
) -> Array:
    """Picture as RGB, 0..1."""
    picture = ws.render(
        volume, tf, ws.Camera.orbit(camera_of or volume, *view, fit="view"), size=(size, size), **options
    )
    return np.clip(picture.rgba[..., :3], 0.0, 1.0).astype(np.float64)


def least_ms(work: Callable[[], object]) -> float:
    """Least processor time, ms, of at least 4 runs that take a fifth of a second, after one that is not counted."""
    work()
    times: list[float] = []
    while len(times) < 4 or sum(times) < 200:
        start = time.process_time()
        work()
        times.append(1e3 * (time.process_time() - start))
    return min(times)


def frame_times(wavelets: ws.WaveletVolume, tf: ws.TransferFunction, size: int) -> list[float]:
    """Milliseconds of a frame by the number of levels left out: none, one, and so on; at last all.

    Each is the least of some rounds, so that a slow spell of the machine does not meet all frames of a level.
    """
    camera = ws.Camera.orbit(wavelets, *VIEWS[0], fit="view")

    def frame(n: int) -> ws.Picture:
        return ws.render(wavelets.level(n), tf, camera, size=(size, size))

    n_dropped = [*range(MAX_DROPPED + 1), wavelets.n_levels]
    rounds = [[least_ms(partial(frame, n)) for n in n_dropped] for _ in range(4)]
    return [min(times) for times in zip(*rounds, strict=True)]


def measure(name: str, size: int, pages: dict[str, list[list[Array]]]) -> list[Row]:
    """Measure both transfer functions on a volume."""
    subject = SUBJECTS[name]
    volume = subject.volume()
    if volume is None:
        print(f"{name}: no {subject.file} in {DATA}; left out", file=sys.stderr)
        return []
    wavelets = ws.WaveletVolume.from_volume(volume)
    low_pass = [plain_level(wavelets, n + 1) for n in range(MAX_DROPPED)]
    unit = float(np.prod(volume.spacing) ** (1 / 3))
    rows = []
    for curve in ("soft", "hard"):
        tf = transfer_function(subject, curve, unit)
        changes = np.zeros((2, MAX_DROPPED, len(VIEWS)))
        for v, view in enumerate(VIEWS):
            whole = draw(wavelets, tf, view, size)
            page = [[whole], [whole]]
            for n in range(MAX_DROPPED):
                plain = draw(low_pass[n], tf, view, size, camera_of=wavelets)
                pictures = plain, draw(wavelets.level(n + 1), tf, view, size)
                changes[:, n, v] = [100 * (picture.mean() / whole.mean() - 1) for picture in pictures]
                for line, picture in zip(page, pictures, strict=True):
                    line.append(picture)
            if v == 0:
                pages[f"{name}, {curve}"] = page
        rows.append(Row(name, curve, Changes(*changes), frame_times(wavelets, tf, size)))
    return rows


def large(n: int) -> list[Row]:
    """Measure the times alone of n^3 samples: the engine, repeated."""
    subject = SUBJECTS["engine"]
    engine = subject.volume()
    if engine is None:
        return []
    repeats = [-(-n // m) for m in engine.samples.shape]
    wavelets = ws.WaveletVolume.from_volume(ws.Volume(np.tile(engine.samples, repeats)[:n, :n, :n]), keep=0.03)
    # A level may have half of the cache.
    wavelets.cache_bytes = 3 * 4 * n**3

    def row(curve: str) -> Row:
        tf = transfer_function(subject, curve, 1.0)
        return Row(f"engine, {n}^3, {LARGE_SIZE} px", curve, None, frame_times(wavelets, tf, LARGE_SIZE))

    return [row(curve) for curve in ("soft", "hard")]


def table(rows: Sequence[Row]) -> list[list[str]]:
    """Table of a row per volume and function; cells hold numbers by levels left out, with slashes between."""

    def changes(values: Array) -> str:
        worst = [line[np.argmax(np.abs(line))] for line in values]
        return " / ".join(f"{mean:+.1f} ({far:+.0f})" for mean, far in zip(values.mean(axis=1), worst, strict=True))

    lines = [["volume", "function", "plain, %", "ours, %", "frame, CPU ms", "times less", "goals missed"]]
    for row in rows:
        frames = " / ".join(f"{ms:.0f}" if ms >= 100 else f"{ms:.3g}" for ms in row.frame_ms)
        times = " / ".join(f"{times:.1f}" for times in row.times_less)
        shown, missed = ["", ""], ""
        if row.changes is not None:
            shown = [changes(row.changes.plain), changes(row.changes.ours)]
            missed = ", ".join(row.misses()) or "none"
        lines.append([row.subject, row.curve, *shown, frames, times, missed])
    return lines


def save_pages(pages: dict[str, list[list[Array]]], folder: Path) -> None:
    """Save a PNG per volume and function: above plain, below ours, more levels left out to the right."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, lines in pages.items():
        rgb = np.concatenate([np.concatenate(line, axis=1) for line in lines], axis=0)
        rgba = np.concatenate([rgb, np.ones((*rgb.shape[:2], 1))], axis=2)
        ws.Picture(rgba.astype(np.float32)).save(folder / f"{name.replace(', ', '_').replace(' ', '_')}.png")


def record(rows: Sequence[Row], size: int) -> None:
    """Keep the table in the repository."""
    RESULTS.write_text(
        f"""# Levels of detail left out

{dt.datetime.now(dt.UTC):%Y-%m-%d}, {machine.describe()}, {size} x {size} pixels, cdf97, all coefficients.
Command: `make study-lod STUDY_LOD="{" ".join(sys.argv[1:])}"`. What is measured stands at the head of `lod.py`.
Numbers are for one / two / three levels left out; those of a frame begin with none and end with all.
Goals are about brightness; times are reported without one.

{as_markdown(table(rows))}
""",
        encoding="utf-8",
    )


def main() -> int:
    """Print the table, write the pictures."""
    parser = argparse.ArgumentParser(description="Leave out levels of details and look at the brightness.")
    parser.add_argument("--size", type=int, default=384, metavar="PX", help="side of the pictures; 384")
    parser.add_argument("--only", nargs="+", default=list(SUBJECTS), choices=SUBJECTS, help="volumes")
    parser.add_argument("--large", action="store_true", help="time 512^3 and 1024^3 samples too; 10 GB")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "study-lod", help="folder of the pictures")
    parser.add_argument("--record", action="store_true", help="write RESULTS.md")
    options = parser.parse_args()
    pages: dict[str, list[list[Array]]] = {}
    rows = [row for name in options.only for row in measure(name, options.size, pages)]
    if options.large:
        rows += [row for n in LARGE for row in large(n)]
    print(as_markdown(table(rows)))
    save_pages(pages, options.out)
    if options.record:
        record(rows, options.size)
    print(f"\nThe pictures are in {options.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
