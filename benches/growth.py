"""Tables of how time and memory grow with the task: the cases under `growth` in `cases.toml`.

The claims behind the limits: time grows at most linearly with pixels and slices, a picture in which nothing is visible
takes a tenth of the time at most, and a volume of 1024^3 bytes is drawn within its own size, 15 % and a few MB a
thread.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import scenes

Row = tuple[scenes.Case, str, dict[str, Any], dict[str, float]]


def time_table(rows: Sequence[Row]) -> str:
    """Table of times, each also as a multiple of the same engine's base."""
    bases = {engine: result for case, engine, _, result in rows if case.change == "the base"}
    lines = []
    for case, engine, _, result in rows:
        cells = [case.label, engine]
        for time in ("cpu_ms", "wall_ms"):
            ratio = f"{result[time] / bases[engine][time]:.2f}" if engine in bases else ""
            cells += [f"{result[time]:.1f}", ratio]
        limit = f"{case.at_most:.2f}" if case.at_most else ""
        lines.append([*cells[:4], limit, *cells[4:]])
    headings = ["case", "engine", "CPU ms", "times the base", "at most", "wall ms", "times the base"]
    return as_markdown(headings, lines)


def memory_table(rows: Sequence[Row]) -> str:
    """Table of the process's peak memory, less what it held before the large volume, against the samples' size."""
    lines = []
    for case, engine, _, result in rows:
        samples, start, peak = (result[name] for name in ("samples_mib", "start_mib", "rss_mib"))
        numbers = [f"{result['cpu_ms']:.1f}", f"{samples:.0f}", f"{start:.0f}", f"{peak:.0f}"]
        limit = f"{case.at_most:.2f}" if case.at_most else ""
        lines.append([case.label, engine, *numbers, f"{(peak - start) / samples:.3f}", limit])
    headings = ["case", "engine", "CPU ms", "samples, MiB", "before, MiB", "peak RSS, MiB"]
    return as_markdown([*headings, "(peak - before) / samples", "at most"], lines)


def as_markdown(headings: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    return "\n".join("| " + " | ".join(line) + " |" for line in [headings, ["---"] * len(headings), *lines])
