"""Cases of a product of parameters that run by day; the others are marked `nightly`.

Of a test with two decorators `parametrize`, every value runs once, unless it is marked `every_pair`, since its values
work on each other. Of a test with three or more, every pair of values runs once.
"""

from __future__ import annotations

from itertools import combinations, groupby
from typing import Any

import pytest


def nightly(*values: Any) -> list[Any]:
    """Values of one parameter that run at night alone, with the names of cases that they have by day."""
    return [pytest.param(value, marks=pytest.mark.nightly) for value in values]


def values(item: Any) -> tuple[Any, ...]:
    """The value of each parameter of a case, by identity; names that are set together are one parameter."""
    if not hasattr(item, "callspec"):
        return ()
    params = item.callspec.params
    together = []
    for mark in item.iter_markers("parametrize"):
        names = mark.args[0] if mark.args else mark.kwargs["argnames"]
        together.append(names.replace(" ", "").split(",") if isinstance(names, str) else list(names))
    together += [[name] for name in params if not any(name in names for names in together)]
    return tuple((i, *(id(params[name]) for name in names)) for i, names in enumerate(together))


def cover(cases: list[Any], n_together: int) -> list[Any]:
    """Few cases that have every combination of `n_together` values that any case has."""
    parts = {id(case): list(combinations(values(case), n_together)) for case in cases}
    times = {part: 0 for of_case in parts.values() for part in of_case}
    chosen = []

    def gain(case: Any) -> tuple[int, int]:
        """Number of new combinations; and, of equal ones, the case whose values were used least."""
        used = [times[part] for part in parts[id(case)]]
        return used.count(0), -sum(used)

    while 0 in times.values():
        chosen.append(max(cases, key=gain))
        for part in parts[id(chosen[-1])]:
            times[part] += 1
    return chosen


def mark_the_rest(items: list[Any]) -> None:
    """Mark the cases of products that are left out by day."""
    for _, group in groupby(items, key=lambda item: (item.path, getattr(item, "originalname", item.name))):
        cases = [item for item in group if not item.get_closest_marker("nightly")]
        n_parameters = len(values(cases[0])) if cases else 0
        if n_parameters < 2 or cases[0].get_closest_marker("every_pair"):
            continue
        chosen = {id(case) for case in cover(cases, 1 if n_parameters == 2 else 2)}
        for case in cases:
            if id(case) not in chosen:
                case.add_marker(pytest.mark.nightly)
