"""Vectors in NIfTI: three numbers at each place, along the fifth axis, or, as programs for diffusion write, the fourth.

The fifth axis is that of the standard: displacements of a registration (intent 1006 or 1007), of which the length is
drawn. Three float images along the fourth axis, the axis of times, are the directions of fibres (V1 of FSL) where their
vectors are of length 1 wherever they are not 0; which images of a time series never are. Directions are drawn as is
usual for them: red, green and blue are the magnitudes of the x, y and z component (Pajevic and Pierpaoli 1999).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.facts import COLORS, LENGTH, Facts
from wavesplat._readers.components import AXES, N_COMPONENTS, component_of
from wavesplat._readers.request import Request, choose
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable

#: Largest difference of a direction's length from 1, and least share of the vectors that have it. (FSL's V1: all.)
OFF, MIN_SHARE = 0.02, 0.99
LENGTH_NOTE = (
    "{!r} holds directions, vectors of length 1, by its values: red, green and blue are the magnitudes of x, y and z; "
    'or component="x" (--component x)'
)


def components(
    shape: tuple[int, ...], dtype: np.dtype[Any], request: Request, read: Callable[[tuple[int, int]], NDArray[Any]]
) -> NDArray[Any] | None:
    """The components [x, y, z, component] of a file of vectors; None of other files.

    read : function of (time, channel) that gives one volume, with slope and intercept.
    """
    sizes = [*shape, *[1] * (5 - len(shape))]
    is_float = dtype.kind == "f"
    if sizes[4] > 1:
        if request.component is None and (sizes[4] != N_COMPONENTS or not is_float):
            return None
        time = choose("time", sizes[3], request.time, request.path)
        return np.stack([read((time, number)) for number in range(sizes[4])], axis=-1)
    if sizes[3] != N_COMPONENTS or not (is_float or request.component is not None) or request.time is not None:
        if request.component is not None:
            raise ArgumentError(f"component={request.component!r}, but the file holds no vectors: {request.path}")
        return None
    found = np.stack([read((number, 0)) for number in range(N_COMPONENTS)], axis=-1)
    return found if request.component is not None or _are_directions(found) else None


def drawn(vectors: NDArray[Any], facts: Facts, request: Request) -> tuple[NDArray[Any], Facts]:
    """The samples [x, y, z] that are drawn of vectors [x, y, z, component], and the facts with sentences about them."""
    if request.component is None and _are_directions(vectors):
        number = choose("channel", N_COMPONENTS, request.channel, request.path, described=[c.name for c in COLORS[:3]])
        facts = replace(facts, channels=COLORS[:3], channel=COLORS[number])
        return np.abs(vectors[..., number]), replace(facts, guesses=(*facts.guesses, LENGTH_NOTE.format(request.name)))
    samples, guesses = component_of(vectors, request, request.name)
    done = (LENGTH,) if request.component in (None, "magnitude") and request.channel is None else ()
    return samples, replace(facts, guesses=(*facts.guesses, *guesses), processing=(*facts.processing, *done))


def _are_directions(vectors: NDArray[Any]) -> bool:
    """Whether vectors [..., component] are three numbers of length 1, or 0 outside of the object."""
    if vectors.shape[-1] != len(AXES):
        return False
    squares = np.einsum("...i,...i->...", vectors, vectors, dtype=np.float64)
    found = squares[squares > 0]
    return bool(found.size) and float(np.mean(np.abs(np.sqrt(found) - 1) <= OFF)) >= MIN_SHARE
