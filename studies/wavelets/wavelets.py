"""Errors that dropping wavelet coefficients causes, in samples and in pictures; `make study-wavelets` runs this.

The experiments of "High Resolution Image Splatting" (Int. J. of Advanced Computational Engineering and Networking 2-7,
2014): thresholds on the amplitudes of the coefficients, and levels left out. Their scans are not to be had; ours are a
CT of half a pelvis and an MRI of a head, from BENCH_DATA or, where that folder lacks them, bundled. "mri-half" is the
head averaged over 2 x 2 x 2 samples, which is about the size of theirs. All samples are rounded to 8 bits: we take the
printed thresholds as levels of 255.

The size of a coefficient is L2-normalised, in grey levels; PSNR = 10 log10(255^2 / mean squared error of the samples).
The error of a picture is the mean absolute difference, over all pixels and channels, in grey levels of 255, from the
picture of the samples that nothing was dropped of. That number depends on the scene more than on the coefficients, so
there are three scenes, and a table of more:

fog     Along z, one pixel per column of samples and one sheet per slice, grey = value, opacity rising from 0 at 60 to
        0.15 at 255, unshaded. The goals are in this scene: with the bare sum over the slices it gives 3.10 and 2.50 for
        the ripples at threshold 12, with cdf53 and cdf97, and 0.42 for the CT with cdf97.
soft    Oblique, Phong-shaded, opacity 0.05 to 0.2 per voxel.
hard    Oblique, Phong-shaded, opacity from 0 to 1 within one grey level, as the paper has it for the ripples.

The pictures of a hard step do not measure small errors: a pixel at an edge is either the surface or what lies behind
it, and shading turns a bent surface into another grey. Such numbers move with the view, the light and the share of the
picture that the object covers, which we do not know of the paper's; nor whether those are distances from its own
picture with nothing dropped, or from its ray caster's.

Milliseconds are of the processor (all threads): the least of 2 runs, or of up to 5 within 50 ms. A frame is the
hard picture of the decoded samples. `--reference` adds the distance of the soft and the hard pictures from the
converged ones of the whole volume, which take minutes and are kept in `.cache/study-wavelets`.

`--record` writes the tables to RESULTS.md beside this file. Plots and rows of pictures go to `--out`.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import argparse
import datetime as dt
import math
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

import wavesplat as ws

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import machine
from scenes import (
    FOG,
    HARD,
    SCENES,
    SOFT,
    SUBJECTS,
    Array,
    converged,
    distance,
    draw,
    drawing,
    loaded,
    picture_error,
    rgba_levels,
    wanted,
)
from tables import as_markdown, as_text

ROOT = Path(__file__).resolve().parents[2]
RESULTS = Path(__file__).with_name("RESULTS.md")

THRESHOLDS = (0, 2, 4, 12, 14, 16, 32, 64)
FAMILIES = ("cdf53", "cdf97", "bspline2", "bspline4")

#: Number of levels of the paper's first picture of levels; its pictures go from seven down to two.
MAX_LEVELS = 7
N_LEVEL_PICTURES = 6

#: A measurement is repeated until this much processor time is spent.
TIMING_MS = 50

T = TypeVar("T")


def timed(work: Callable[[], T]) -> tuple[float, T]:
    """Milliseconds of processor time, the least of a few runs, and the result."""
    spent: list[float] = []
    while len(spent) < 2 or (sum(spent) < TIMING_MS and len(spent) < 5):
        started = time.process_time()
        result = work()
        spent.append(1e3 * (time.process_time() - started))
    return min(spent), result


@dataclass(frozen=True)
class Row:
    """Measurements at an operating point. `threshold` is None where the share was asked for."""

    subject: str
    family: str
    threshold: int | None
    #: Share of the coefficients that are kept, percent.
    kept: float
    psnr_db: float
    fog: float
    soft: float
    hard: float
    converged_soft: float
    converged_hard: float
    analysis_ms: float
    decoding_ms: float
    frame_ms: float
    n_bytes: int


def measure(name: str, family: str, size_px: int, threshold: int | None, keep: float | None, *, reference: bool) -> Row:
    """Analyse, decode and draw a subject, and measure each."""
    volume = loaded(name)
    analysis_ms, wavelets = timed(lambda: ws.WaveletVolume.from_volume(volume, family, threshold=threshold, keep=keep))
    decoding_ms, decoded = timed(wavelets.to_volume)
    mean_square = float(np.mean((decoded.samples - volume.samples.astype(np.float64)) ** 2))
    frame_ms, hard = timed(lambda: draw(decoded, name, HARD, size_px))
    soft = draw(decoded, name, SOFT, size_px)
    return Row(
        subject=name,
        family=family,
        threshold=threshold,
        kept=100 * wavelets.kept_fraction,
        psnr_db=10 * math.log10(255**2 / mean_square) if mean_square > 0 else math.inf,
        fog=picture_error(decoded, name, FOG, size_px),
        soft=distance(soft, wanted(name, SOFT, size_px)),
        hard=distance(hard, wanted(name, HARD, size_px)),
        converged_soft=distance(soft, converged(name, SOFT, size_px)) if reference else math.nan,
        converged_hard=distance(hard, converged(name, HARD, size_px)) if reference else math.nan,
        analysis_ms=analysis_ms,
        decoding_ms=decoding_ms,
        frame_ms=frame_ms,
        n_bytes=wavelets.nbytes,
    )


def measure_all(options: argparse.Namespace) -> list[Row]:
    """Every row of the tables."""
    rows = []
    for name in options.subjects:
        started = time.monotonic()
        printed_share = SUBJECTS[name].printed.kept / 100
        for family in options.families:
            for threshold in (*THRESHOLDS, None):
                keep = printed_share if threshold is None else None
                rows.append(measure(name, family, options.size, threshold, keep, reference=options.reference))
        print(f"{name}: {time.monotonic() - started:.0f} s", file=sys.stderr, flush=True)
    return rows


def frame_table(names: Sequence[str], n_rounds: int = 3) -> list[list[str]]:
    """Frames straight from the coefficients of the best family at the printed shares, beside those of the samples.

    512 x 512, soft, shaded, quality normal; milliseconds of the processor, the least of the rounds, in turn. The first
    frame is of a volume that has drawn nothing yet. With a cache of a quarter of the volume most blocks are decoded
    again for every frame.
    """
    lines = [["volume", "of samples", "of coefficients", "ratio", "first", "ratio", "small cache", "bytes per kept"]]
    for name in names:
        volume = loaded(name)
        share = SUBJECTS[name].printed.kept / 100
        wavelets = ws.WaveletVolume.from_volume(volume, "cdf97", keep=share)
        how: Any = {**drawing(name, SOFT, 512), "quality": "normal"}
        function = how.pop("transfer_function")
        quarter = ws.WaveletVolume.from_volume(volume, "cdf97", keep=share)
        quarter.cache_bytes = math.prod(volume.shape)
        best = dict.fromkeys(("samples", "coefficients", "first", "quarter"), math.inf)

        def frame(kind: str, drawn: ws.Volume | ws.WaveletVolume) -> None:
            started = time.process_time()
            ws.render(drawn, function, **how)  # noqa: B023 - called at once
            best[kind] = min(best[kind], 1e3 * (time.process_time() - started))  # noqa: B023 - called at once

        for drawn in (volume, wavelets, quarter):
            ws.render(drawn, function, **how)
        for _ in range(n_rounds):
            frame("samples", volume)
            frame("coefficients", wavelets)
            frame("first", ws.WaveletVolume.from_volume(volume, "cdf97", keep=share))
            frame("quarter", quarter)
        plain = best["samples"]
        lines.append([
            name,
            f"{plain:.0f}",
            f"{best['coefficients']:.0f}",
            f"{best['coefficients'] / plain:.2f}",
            f"{best['first']:.0f}",
            f"{best['first'] / plain:.2f}",
            f"{best['quarter']:.0f}",
            f"{wavelets.nbytes / sum(wavelets.kept_by_level):.1f}",
        ])  # fmt: skip
    return lines


def point(rows: Sequence[Row], name: str, family: str | None, threshold: int | None) -> Row | None:
    """A row, by the best family in the goals' scene if none is named; None if it was not measured."""
    found = [r for r in rows if r.subject == name and r.threshold == threshold and family in {None, r.family}]
    return min(found, key=lambda row: row.fog, default=None)


#: Subject, family (None: the best), threshold (None: the printed share), percent kept from and to, error.
GOALS = (
    ("ripples", "cdf53", 12, (19.9, 20.2), 3.2),
    ("ripples", "cdf97", 12, (0.0, 18.8), 2.7),
    ("ct", None, None, (0.0, 3.55), 1.5),
    ("mri", None, None, (0.0, 1.27), 1.5),
    ("mri-half", None, None, (0.0, 1.27), 1.5),
)
#: Largest error with nothing dropped, for soft transfer functions and any family, grey levels.
GOAL_ROUND_TRIP = 0.01


def verdict(*, met: bool) -> str:
    """Verdict on a goal, in a word."""
    return "met" if met else "missed"


def goal_table(rows: Sequence[Row]) -> list[list[str]]:
    """Table of the goals, and of what we reach."""
    lines = [["", "family", "kept, %", "goal", "error, fog", "goal", "", "soft", "hard", "theirs"]]
    for name, family, threshold, (least, most), error in GOALS:
        row = point(rows, name, family, threshold)
        if row is None:
            continue
        # Shares are compared after rounding to two digits, as they are printed.
        met = least <= round(row.kept, 2) <= most and row.fog <= error
        where = f"{name}, " + ("printed share" if threshold is None else f"threshold {threshold}")
        share = f"{least} to {most}" if least else f"at most {most}"
        printed = SUBJECTS[name].printed
        line = [where, row.family, f"{row.kept:.2f}", share, f"{row.fog:.2f}", f"{error}", verdict(met=met)]
        lines.append([*line, f"{row.soft:.2f}", f"{row.hard:.2f}", f"{printed.errors[printed.threshold]}"])
    for name in dict.fromkeys(row.subject for row in rows):
        whole = [row for row in rows if row.subject == name and row.threshold == 0]
        fog, soft, hard = (max(getattr(row, scene) for row in whole) for scene in ("fog", "soft", "hard"))
        met = max(fog, soft) < GOAL_ROUND_TRIP
        line = [f"{name}, nothing dropped", "worst", f"{max(row.kept for row in whole):.2f}", "", f"{fog:.5f}"]
        line += [f"{GOAL_ROUND_TRIP}", verdict(met=met), f"{soft:.5f}", f"{hard:.5f}"]
        lines.append([*line, f"{SUBJECTS[name].printed.errors[0]}"])
    return lines


def scene_table(rows: Sequence[Row], size_px: int) -> list[list[str]]:
    """Table of the error of the same coefficients in other pictures."""
    points = [row for goal in GOALS if (row := point(rows, *goal[:3])) is not None]
    lines = [["scene", *(f"{row.subject}, {row.family}, {row.kept:.3g} %" for row in points)]]

    @cache
    def decoded(row: Row, *, rounded: bool) -> ws.Volume:
        volume = loaded(row.subject, rounded=rounded)
        keep = SUBJECTS[row.subject].printed.kept / 100 if row.threshold is None else None
        return ws.WaveletVolume.from_volume(volume, row.family, threshold=row.threshold, keep=keep).to_volume()

    for scene in SCENES:
        line = [scene.label]
        for row in points:
            has_part = scene.cropped or SUBJECTS[row.subject].drawn.crop is not None
            volume = decoded(row, rounded=scene.rounded)
            line.append(f"{picture_error(volume, row.subject, scene, size_px):.2f}" if has_part else "")
        lines.append(line)
    return lines


def subject_table(rows: Sequence[Row], name: str) -> list[list[str]]:
    """Table of all rows of a volume."""
    printed = SUBJECTS[name].printed
    with_reference = any(not math.isnan(row.converged_hard) for row in rows)
    lines = [["family", "threshold", "kept, %", "theirs", "PSNR, dB", "fog", "soft", "hard", "theirs"]]
    lines[0] += ["soft, to converged", "hard, to converged"] * with_reference
    lines[0] += ["analysis, ms", "decoding, ms", "frame, ms", "KiB"]
    for row in rows:
        if row.subject != name:
            continue
        threshold = printed.threshold if row.threshold is None else row.threshold
        line = [row.family, "share" if row.threshold is None else f"{threshold}", f"{row.kept:.2f}"]
        line += [f"{printed.kept}" if threshold == printed.threshold else "", f"{row.psnr_db:.1f}"]
        line += [f"{row.fog:.2f}", f"{row.soft:.2f}", f"{row.hard:.2f}", f"{printed.errors.get(threshold, '')}"]
        line += [f"{row.converged_soft:.2f}", f"{row.converged_hard:.2f}"] * with_reference
        line += [f"{row.analysis_ms:.1f}", f"{row.decoding_ms:.1f}", f"{row.frame_ms:.0f}", f"{row.n_bytes / 1024:.0f}"]
        lines.append(line)
    return lines


def size_of(name: str) -> str:
    """Text on the number of a subject's samples, and the memory that they take."""
    volume = loaded(name)
    kib = volume.samples.nbytes / 1024
    shape = " x ".join(map(str, volume.shape[::-1]))
    return (
        f"From {volume.name}: {shape} samples; plain, they take {kib:.0f} KiB with 8 bits, {4 * kib:.0f} KiB as float32"
    )


def record(rows: Sequence[Row], frames: list[list[str]], size_px: int) -> None:
    """Keep the tables in the repository."""
    tables = "\n\n".join(
        f"## {name}\n\n{size_of(name)}.\n\n{as_markdown(subject_table(rows, name))}" for name in SUBJECTS
    )
    # The recipe says itself where plots go.
    given = sys.argv[3:] if sys.argv[1:2] == ["--out"] else sys.argv[1:]
    RESULTS.write_text(
        f"""# Wavelet coefficients dropped

{dt.datetime.now(dt.UTC):%Y-%m-%d}, {machine.describe()}, {size_px} x {size_px} pixels.
Command: `make study-wavelets STUDY_WAVELETS="{" ".join(given)}"`.
What is measured, and how, stands at the head of `wavelets.py`; "theirs" is what the paper prints, of other scans.

## Goals

Errors are mean absolute differences in grey levels from the picture with nothing dropped.

{as_markdown(goal_table(rows))}

## Frames

Milliseconds of the processor, 512 x 512, soft, shaded, quality normal, cdf97 at the printed shares. A coefficient is 4
bytes; the small cache is a quarter of the decoded volume.

{as_markdown(frames)}

## What the error of a picture depends on

The same coefficients in other pictures.

{as_markdown(scene_table(rows, size_px))}

{tables}
""",
        encoding="utf-8",
    )


def plot_curves(rows: Sequence[Row], name: str, folder: Path) -> None:
    """Plot the retained share and the error over the threshold, as the paper's figures 11, 15 and 17."""
    from matplotlib.figure import Figure

    printed = SUBJECTS[name].printed
    figure = Figure(figsize=(11, 4.2), layout="constrained", dpi=120)
    share, error = figure.subplots(1, 2)
    places = range(len(THRESHOLDS))
    for number, family in enumerate(dict.fromkeys(row.family for row in rows)):
        mine = [row for row in rows if (row.subject, row.family) == (name, family) and row.threshold is not None]
        share.plot(places, [row.kept for row in mine], f"C{number}.-", label=family)
        for scene, dashes in (("hard", "-"), ("soft", "--"), ("fog", ":")):
            error.plot(places, [getattr(row, scene) for row in mine], f"C{number}{dashes}")
            if number == 0:
                error.plot([], [], f"k{dashes}", label=scene)
    share.plot(THRESHOLDS.index(printed.threshold), printed.kept, "kx", label="printed")
    error.plot(
        [THRESHOLDS.index(threshold) for threshold in printed.errors], printed.errors.values(), "kx", label="printed"
    )
    share.set(yscale="log", ylabel="coefficients kept, %")
    error.set(ylabel="mean absolute error of the picture, grey levels", ylim=(0, None))
    for axes in (share, error):
        axes.set(xlabel="threshold on L2-normalised amplitudes", xticks=places, xticklabels=THRESHOLDS)
        axes.grid(alpha=0.3)
        axes.legend(handlelength=3)
    figure.suptitle(f"{name}: {' x '.join(map(str, loaded(name).shape[::-1]))} samples")
    figure.savefig(folder / f"figure_{printed.figure}_{name}.png")


def sheet(path: Path, title: str, rows: dict[str, list[tuple[str, Array]]]) -> None:
    """Save rows of pictures with labels, on one page."""
    from matplotlib.figure import Figure

    n_columns = max(map(len, rows.values()))
    page = Figure(figsize=(2.2 * n_columns, 2.45 * len(rows) + 0.3), layout="constrained", dpi=120)
    for axes_row, (name, pictures) in zip(
        page.subplots(len(rows), n_columns, squeeze=False), rows.items(), strict=True
    ):
        for axes, (label, picture) in zip(axes_row, pictures, strict=True):
            axes.imshow(picture[..., :3] / 255, interpolation="nearest")
            axes.set_title(label, fontsize=8)
            axes.set(xticks=[], yticks=[])
        axes_row[0].set_ylabel(name, fontsize=9)
    page.suptitle(title, fontsize=10)
    page.savefig(path)


def threshold_sheet(name: str, families: Sequence[str], size_px: int, folder: Path) -> None:
    """Save the hard picture at the thresholds of the paper's rows, figures 12 to 14."""
    pictures: dict[str, list[tuple[str, Array]]] = {}
    for family in families:
        for threshold in SUBJECTS[name].printed.row:
            wavelets = ws.WaveletVolume.from_volume(loaded(name), family, threshold=threshold)
            picture = draw(wavelets.to_volume(), name, HARD, size_px)
            error = distance(picture, wanted(name, HARD, size_px))
            label = f"threshold {threshold:g}: {100 * wavelets.kept_fraction:.3g} %, error {error:.1f}"
            pictures.setdefault(family, []).append((label, picture))
    sheet(folder / f"thresholds_{name}.png", f"{name}: coefficients kept, and error in grey levels", pictures)


def level_sheet(name: str, family: str, size_px: int, folder: Path) -> None:
    """Save pictures with the finest levels left out one by one, figure 16."""
    wavelets = ws.WaveletVolume.from_volume(loaded(name), family, levels=MAX_LEVELS)
    pictures: dict[str, list[tuple[str, Array]]] = {}
    for scene in (HARD, SOFT):
        for dropped in range(min(N_LEVEL_PICTURES, wavelets.n_levels)):
            picture = draw(wavelets.level(dropped).to_volume(), name, scene, size_px)
            share = 100 * sum(wavelets.kept_by_level[dropped:]) / loaded(name).samples.size
            label = f"levels: {wavelets.n_levels - dropped}, {share:.3g} %"
            pictures.setdefault(scene.curve, []).append((label, picture))
    sheet(folder / f"levels_{name}.png", f"{name}, {family}: levels of details, coefficients kept", pictures)


def cracked_bar() -> ws.Volume:
    """A cast bar, its density varying slowly, with noise; across it a hairline crack, 8 % less dense."""
    z, y, x = np.mgrid[0:64, 0:64, 0:96].astype(np.float64)
    edge = [1 / (1 + np.exp((np.abs(a - middle) - half) / 3)) for a, middle, half in
            ((x, 47.5, 30), (y, 31.5, 17), (z, 31.5, 17))]  # fmt: skip
    density = 180 + 25 * np.sin(x / 23 + z / 31) * np.cos(y / 19)
    crack = np.exp(-(((x - 48 - 4 * np.sin(y / 9) - 0.2 * (z - 32)) / 0.8) ** 2)) * (z > 26) * (np.abs(y - 31) < 13)
    noise = np.random.default_rng(1).normal(0, 1, x.shape)
    return ws.Volume((np.prod(edge, axis=0) * density * (1 - 0.08 * crack) + noise).astype(np.float32), name="bar")


def band_sheet(size_px: int, folder: Path) -> None:
    """Save pictures of a crack that the whole picture hides: the finest two bands alone, and over the whole."""
    volume = cracked_bar()
    wavelets = ws.WaveletVolume.from_volume(volume)
    camera = ws.Camera.orbit(volume, -35, 35, fit="view")
    gray = ws.TransferFunction(
        [(60, 0), (150, 0.03), (255, 0.12)], [(60, 0.5, 0.55, 0.65), (160, 0.8, 0.82, 0.86), (255, 1, 1, 1)]
    )
    whole = ws.render(wavelets, gray, camera, size=(size_px, size_px))
    details = ws.render(
        wavelets.bands([1, 1] + [0] * (wavelets.n_levels - 1)),
        ws.TransferFunction.diverging(12, opacity=0.35),
        camera,
        size=(size_px, size_px),
        shading=None,
    )
    pictures = {"all bands": whole, "bands 0 and 1": details, "over all": details.over(whole)}
    row = [(label, rgba_levels(picture)) for label, picture in pictures.items()]
    sheet(folder / "bands.png", "A hairline crack, 8 % less dense", {"bar": row})


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description="Drop wavelet coefficients and look at the pictures.")
    parser.add_argument("--size", type=int, default=256, metavar="PX", help="side of the oblique pictures; 256")
    parser.add_argument("--only", nargs="+", default=list(SUBJECTS), dest="subjects", choices=SUBJECTS, help="volumes")
    parser.add_argument("--families", nargs="+", default=list(FAMILIES), metavar="NAME", help=" ".join(FAMILIES))
    parser.add_argument("--reference", action="store_true", help="compare with converged pictures too; minutes")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "study-wavelets", help="folder of the pictures")
    parser.add_argument("--record", action="store_true", help="write RESULTS.md; all volumes and these families")
    return parser.parse_args()


def main() -> int:
    """Print the tables, write the pictures."""
    options = arguments()
    if options.record and (options.subjects != list(SUBJECTS) or options.families != list(FAMILIES)):
        print("--record needs all volumes and the families of the study; leave out --only, --families", file=sys.stderr)
        return 2
    rows = measure_all(options)
    for name in options.subjects:
        print(f"\n{name}. {size_of(name)}.\n{as_text(subject_table(rows, name))}")
    print(f"\n{as_text(goal_table(rows))}\n\n{as_text(scene_table(rows, options.size))}")
    frames = frame_table(options.subjects)
    print(f"\n{as_text(frames)}")
    if options.record:
        record(rows, frames, options.size)
    options.out.mkdir(parents=True, exist_ok=True)
    for name in options.subjects:
        best = point(rows, name, None, None)
        plot_curves(rows, name, options.out)
        threshold_sheet(name, options.families, options.size, options.out)
        level_sheet(name, best.family if best else options.families[0], options.size, options.out)
    band_sheet(options.size, options.out)
    print(f"\nThe pictures are in {options.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
