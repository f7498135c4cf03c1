"""Check of the goals of `cases.toml`: medians of ratios to a rival in the same run, over cases where we are as good.

Per case of the group "goals" the ratio is VTK's CPU time by ours. It counts where our PSNR is no lower than VTK's,
since a faster picture that is worse says nothing; other cases are named. The goal of a quality is met where the median
of the ratios that count is no less than it. Cases that were not drawn, or VTK that is not here, leave it open.
"""

from __future__ import annotations

import statistics
from collections.abc import Sequence

import growth
import scenes

GROUP = "goals"
RIVAL = "vtk"


def rival_of(case: scenes.Case, rows: Sequence[growth.Row]) -> dict[str, float] | None:
    """VTK's result for the same picture in this run, PSNR and time; None if it was not drawn."""
    return next((result for of, engine, _, result in rows if (of, engine) == (case, RIVAL)), None)


def labels() -> list[str]:
    """Labels of the cases that goals are about."""
    return [case.label for case in scenes.cases() if case.group == GROUP]


def verdicts(rows: Sequence[growth.Row]) -> list[str]:
    """A sentence for each quality that has a goal, with its numbers; none where no case of the goals was drawn."""
    if not any(case.group == GROUP for case, *_ in rows):
        return []
    return [verdict(quality, goal, rows) for quality, goal in scenes.DEFINITIONS["goals"]["speed_over_vtk"].items()]


def verdict(quality: str, goal: float, rows: Sequence[growth.Row]) -> str:
    """A sentence on the goal of one quality."""
    ratios, gains_db, worse, left = [], [], [], labels()
    for case, engine, settings, result in rows:
        rival = rival_of(case, rows)
        if case.group != GROUP or engine != "wavesplat" or settings != {"quality": quality} or rival is None:
            continue
        left.remove(case.label)
        gain_db = result["psnr_db"] - rival["psnr_db"]
        if gain_db < 0:
            worse.append(f"{case.label} ({result['psnr_db']:.1f} dB, VTK {rival['psnr_db']:.1f} dB)")
        else:
            ratios.append(rival["cpu_ms"] / result["cpu_ms"])
            gains_db.append(gain_db)
    median = statistics.median(ratios or [0.0])
    text = f"Quality {quality}: goal {goal:g}, "
    text += (
        f"not decided, without our or VTK's frame of {', '.join(left)}"
        if left
        else "met"
        if median >= goal
        else "missed"
    )
    if ratios:
        text += f"; VTK takes {median:.1f} times our CPU time, the median of {span(ratios)} in {len(ratios)} cases"
        text += f", at {span(gains_db)} dB less"
    if worse:
        text += f"; not counted, since VTK's PSNR is higher: {', '.join(worse)}"
    return f"{text}."


def span(values: Sequence[float]) -> str:
    """Text of a range, from the least value to the largest."""
    return f"{min(values):.1f} to {max(values):.1f}"
