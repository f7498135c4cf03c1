"""Lazy volumes from arrays of other libraries: their place, and the places of their levels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.paths import printable
from wavesplat._model.argument_types import text_of
from wavesplat._model.facts import Facts
from wavesplat._model.lazy_array import LazyArray, lazy_array
from wavesplat._model.lazy_volume import LazyVolume, lazily
from wavesplat._model.volume import _checked_affine, _checked_facts, _with_guesses
from wavesplat.errors import ArgumentError

Matrix = NDArray[np.float64]


def lazy_volume(
    samples: object,
    *,
    place: tuple[Sequence[float] | None, Any],
    given: tuple[str | None, bool | None, str | None, Facts | None],
    memory: float | str | None,
    level: int | None,
    keep: bool | str | PathLike[str],
    holes: bool,
) -> LazyVolume:
    """See `Volume.lazy`."""
    if isinstance(samples, LazyVolume):
        raise ArgumentError("this is a lazy volume already; change it with with_memory or at_level")
    (spacing, matrix), (unit, anatomical, given_name, given_facts) = place, given
    found = lazy_array(samples, has_place=spacing is not None or matrix is not None)
    name = printable((found.name or "volume") if given_name is None else text_of(given_name, "name of the volume"))
    own = found.world_from_index
    if spacing is None and matrix is None and own:
        matrices, known = [_checked_affine(None, one, name) for one in own], found.facts
    else:
        first = _checked_affine(spacing, matrix, name)
        if spacing is not None:
            first = first @ np.diag([*found.directions, 1.0])
        known = (
            found.facts if spacing is None and matrix is None else replace(found.facts, unit=None, is_anatomical=False)
        )
        matrices = [first, *(_spread(first, found.levels[0], coarser, name) for coarser in found.levels[1:])]
    facts = known if given_facts is None else _with_guesses(given_facts, known.guesses, name)
    if len(matrices) > 1 and not own:
        guess = "place of the coarser levels: they fill the same box as the finest, from the outer faces of its samples"
        facts = replace(facts, guesses=(*facts.guesses, guess))
    return lazily(
        found.levels,
        matrices,
        name,
        _checked_facts(facts, unit, anatomical, name),
        memory=memory,
        level=level,
        keep=keep,
        holes=holes,
    )


def _spread(finest: Matrix, fine: LazyArray, coarse: LazyArray, name: str) -> Matrix:
    """Affine of a coarser level that fills the same box: its samples lie in the middle of blocks of the finer one."""
    matrix = finest.copy()
    for axis, (n, m) in enumerate(zip(reversed(fine.shape), reversed(coarse.shape), strict=True)):
        if m > n:
            raise ArgumentError(
                f"volume {name!r}: a level of shape {coarse.shape} follows one of {fine.shape}; give the finest first"
            )
        # Sizes of levels are rounded: the whole factor is meant where it fits to within a sample of the coarser one.
        factor = round(n / m) if abs(n / m - round(n / m)) * m < 1 + 1e-9 else n / m
        matrix[:3, axis] = finest[:3, axis] * factor
        matrix[:3, 3] += finest[:3, axis] * (factor - 1) / 2
    return matrix
