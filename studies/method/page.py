"""The study as one page of HTML, pictures and plots inside it, so that it can be sent as a file."""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import base64
import html
import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import entries
import numpy as np
from numpy.typing import NDArray
from PIL import Image
from tables import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from method import Row, Signal

Array = NDArray[np.float64]
Scenes = dict[tuple[str, str], list["Row"]]

#: Factor by which differences are amplified where they are shown.
STRONGER = 4
#: Part of a picture that shows what an ablation does, as a share of its side.
CROP = 0.35

STYLE = """
:root { color-scheme: light dark; --line: #8884; --dim: #888; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 80rem; margin: 2rem auto; padding: 0 1.5rem; }
h1 { font-size: 1.7rem; } h2 { margin-top: 3rem; border-top: 1px solid var(--line); padding-top: 1.5rem; }
p, li { max-width: 50rem; }
table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums; margin: 1rem 0; }
th, td { padding: .2rem .8rem .2rem 0; text-align: left; border-bottom: 1px solid var(--line); }
td.number, th.number { text-align: right; }
.strip { display: grid; grid-template-columns: repeat(auto-fill, minmax(11.5rem, 1fr)); gap: .8rem; margin: 1rem 0; }
figure { margin: 0; } figure img { width: 100%; display: block; background: #000; image-rendering: pixelated; }
figure img + img { margin-top: 2px; }
figcaption { font-size: .8rem; line-height: 1.3; margin-top: .3rem; } figcaption span { color: var(--dim); }
img.plot { max-width: 100%; background: #fff; } .wide { overflow-x: auto; }
details summary { cursor: pointer; margin: 1rem 0; }
"""


def source(picture: Array) -> str:
    """A picture as a data URL, in WebP: PNG would make a page of 40 MB."""
    buffer = io.BytesIO()
    Image.fromarray(np.rint(255 * np.clip(picture, 0, 1)).astype(np.uint8)).save(buffer, "WEBP", quality=95)
    return f"data:image/webp;base64,{base64.b64encode(buffer.getvalue()).decode()}"


def figure(label: str, note: str, pictures: Iterable[Array]) -> str:
    """HTML of pictures one above the other, with a caption."""
    alt = html.escape(label)
    images = "".join(f'<img src="{source(picture)}" alt="{alt}" loading="lazy">' for picture in pictures)
    return f"<figure>{images}<figcaption>{alt}<br><span>{html.escape(note)}</span></figcaption></figure>"


def strip(figures: Iterable[str]) -> str:
    """HTML of figures side by side."""
    return f'<div class="strip">{"".join(figures)}</div>'


def is_number(cell: str) -> bool:
    """Whether a cell may stand in a column of numbers: it is a number, or empty."""
    return not cell or cell.lstrip("+-").replace(".", "", 1).isdigit()


def table(lines: Table) -> str:
    """HTML of a table, its columns of numbers aligned to the right."""
    heading, *body = lines
    numeric = [all(is_number(line[i]) for line in body) for i in range(len(heading))]

    def row(tag: str, cells: Sequence[str]) -> str:
        marks = [' class="number"' if number else "" for number in numeric]
        inside = (f"<{tag}{mark}>{html.escape(cell)}</{tag}>" for cell, mark in zip(cells, marks, strict=True))
        return f"<tr>{''.join(inside)}</tr>"

    rows = "".join(row("td", line) for line in body)
    return f'<div class="wide"><table><thead>{row("th", heading)}</thead><tbody>{rows}</tbody></table></div>'


def plot(drawing: Figure, alt: str) -> str:
    """HTML of a plot, as an image."""
    buffer = io.BytesIO()
    drawing.savefig(buffer, format="png", dpi=130)
    encoded = base64.b64encode(buffer.getvalue()).decode()
    return f'<img class="plot" src="data:image/png;base64,{encoded}" alt="{html.escape(alt)}">'


def difference(picture: Array, wanted: Array) -> Array:
    """Absolute difference, amplified by `STRONGER`."""
    return np.asarray(STRONGER * np.abs(picture - wanted))


def middle(picture: Array) -> Array:
    """The part of a picture that is shown of an ablation."""
    side = picture.shape[0]
    lo, hi = round(side * (1 - CROP) / 2), round(side * (1 + CROP) / 2)
    return picture[lo:hi, lo:hi]


def numbers(row: Row) -> str:
    """Caption of a picture: PSNR, error and time."""
    ms = "" if row.entry.is_literal else f", {row.ms:.0f} ms"
    return f"{row.psnr_db:.1f} dB, {row.error:.2f} grey levels{ms}"


def scene_strip(wanted: Array, rows: list[Row], best: Row) -> str:
    """HTML of the converged picture, and of the main ways to draw it above their differences from it."""
    shown = [*entries.QUALITIES[::-1], best.entry, *entries.STANDARDS, *entries.RAYS]
    by_entry = {id(row.entry): row for row in rows}
    figures = [figure("converged ray casting", "below: differences, four times as strong", [wanted, 0 * wanted])]
    for entry in dict.fromkeys(map(id, shown)):
        row = by_entry[entry]
        label = f"{row.entry.group}: {row.entry.label}"
        label += ", at standard's time" if row is best else ""
        figures.append(figure(label, numbers(row), [row.picture, difference(row.picture, wanted)]))
    return strip(figures)


def ablation_strips(wanted: Array, rows: list[Row]) -> str:
    """HTML of the effect of each ablation, in the middle of the picture."""
    parts = []
    groups = dict.fromkeys(entry.group for entry in entries.ABLATIONS)
    base = next(row for row in rows if row.entry is entries.BASE)
    for group in groups:
        members = [row for row in rows if row.entry in entries.ABLATIONS and row.entry.group == group]
        figures = [figure("converged ray casting", "", [middle(wanted)])]
        if base not in members:
            figures.append(figure("as the method has it", numbers(base), [middle(base.picture)]))
        figures += [figure(row.entry.label, numbers(row), [middle(row.picture)]) for row in members]
        parts.append(f"<h4>{html.escape(group)}</h4>{strip(figures)}")
    return "".join(parts)


def time_plot(scenes: Scenes) -> str:
    """Plot of quality over time, by scene."""
    from matplotlib.figure import Figure

    names = list(dict.fromkeys(name for name, _ in scenes))
    drawing = Figure(figsize=(4.2 * len(names), 7), layout="constrained")
    grid = drawing.subplots(2, len(names), squeeze=False)
    kinds = (
        ("ray casting (reference)", entries.RAYS, "C7s-"),
        ("standard splatting", entries.STANDARDS, "C3x"),
        ("high-resolution splatting", [*entries.QUALITIES, *entries.SETTINGS], "C0."),
    )
    for (name, curve), rows in scenes.items():
        axes = grid[int(curve == "hard")][names.index(name)]
        for label, members, style in kinds:
            mine = [row for row in rows if row.entry in members]
            axes.plot([row.ms for row in mine], [row.psnr_db for row in mine], style, label=label)
        axes.set(xscale="log", title=f"{name}, {curve}", xlabel="milliseconds of the processor", ylabel="PSNR, dB")
        axes.grid(alpha=0.3)
    grid[0][0].legend(fontsize=8)
    return plot(drawing, "PSNR over time")


def angle_plot(angles: Sequence[float], found: dict[str, list[float]]) -> str:
    """Plot of brightness over the angle."""
    from matplotlib.figure import Figure

    drawing = Figure(figsize=(7.5, 4), layout="constrained")
    axes = drawing.subplots()
    for number, (label, values) in enumerate(found.items()):
        axes.plot(angles, values, f"C{(0, 3, 2)[number // 2]}{'--' if number % 2 else '-'}", label=label)
    axes.set(xlabel="elevation of the eye, degrees", ylabel="brightness, % of the ray caster's")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    return plot(drawing, "Brightness over the view's angle")


def signal_strip(signal: Signal) -> str:
    """HTML of the signal, and of the nearest picture of each kind with the linear kernel beside it."""
    figures = [figure("the signal itself", "no samples", [signal.picture, 0 * signal.picture])]
    seen: set[str] = set()
    for db, error, entry, picture in signal.ranking:
        is_usual = entry.label in {"linear, d = 1", "linear, sheets along the axes"}
        if entry.group in seen and not is_usual:
            continue
        nearest = "nearest of its kind" if entry.group not in seen else "the usual kernel"
        seen.add(entry.group)
        note = f"{nearest}: {db:.1f} dB, {error:.2f} grey levels"
        figures.append(figure(f"{entry.group}: {entry.label}", note, [picture, difference(picture, signal.picture)]))
    return strip(figures)


def write(
    path: Path,
    said: Sequence[str],
    heading: str,
    blocks: Sequence[tuple[str, str]],
) -> None:
    """Write the page: the findings, then the blocks, each a title and its HTML."""
    points = "".join(f"<li>{html.escape(sentence)}</li>" for sentence in said)
    body = "".join(f"<h2>{html.escape(title)}</h2>{inside}" for title, inside in blocks)
    path.write_text(
        f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Splatting, old and high-resolution, and ray casting</title><style>{STYLE}</style></head><body>
<h1>Splatting, old and high-resolution, and ray casting</h1>
<p>{html.escape(heading)}</p>
<p>Pictures are compared with the converged ray caster, and those of the ripples with the signal itself, drawn without
samples. Below a picture: PSNR, mean absolute difference, and time of the processor; the lower image is the difference,
{STRONGER} times as strong.</p>
<h2>What was found</h2><ul>{points}</ul>
{body}
</body></html>
""",
        encoding="utf-8",
    )
