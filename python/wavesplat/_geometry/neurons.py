"""Neurons in SWC files: a tree of points, each with a radius and its parent.

Format: http://www.neuronland.org/NLMorphologyConverter/MorphologyFormats/SWC/Spec.html; lengths are micrometres.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.paths import read_text
from wavesplat._geometry.read_shape import Asked, ReadShape
from wavesplat.errors import ArgumentError

#: Columns: number, type, x, y, z, radius, parent (-1: none).
N_COLUMNS = 7
SOMA, AXON, DENDRITE, APICAL = 1, 2, 3, 4


def read(asked: Asked) -> ReadShape:
    """The branches of a neuron as lines, as thick as their points are on the average.

    `values` may be "radius" or "type" (1 soma, 2 axon, 3 dendrite, 4 apical dendrite).
    """
    rows = _rows(read_text(asked.file, "neuron"))
    numbers = rows[:, 0].astype(np.int64)
    order = {int(number): row for row, number in enumerate(numbers)}
    if len(order) < len(numbers):
        raise ValueError("two of its points have one number")
    parents = np.array([order.get(int(parent), -1) for parent in rows[:, 6]])
    if (parents == np.arange(len(rows))).any():
        raise ValueError("a point is its own parent")
    chains = _branches(parents)
    columns = {"radius": 5, "type": 1}
    if asked.values is not None and asked.values not in columns:
        raise ArgumentError(f"a neuron has no values {asked.values!r}; there are: radius, type: {asked.file}")
    fields = {"paths": [rows[chain, 2:5] for chain in chains]}
    radii = rows[np.concatenate(chains), 5]
    guesses: tuple[str, ...] = ("lengths are micrometres, as SWC files have them",)
    if (radii > 0).any():
        fields["radius"] = float(radii[radii > 0].mean())  # type: ignore[assignment]
        guesses = (*guesses, "branches are drawn with the mean radius of their points")
    if asked.values is not None:
        fields["values"] = rows[np.concatenate(chains), columns[asked.values]]
    return ReadShape("lines", fields, "um", guesses)


def _rows(text: str) -> NDArray[np.float64]:
    lines = [line.split("#")[0].split() for line in text.splitlines()]
    rows = [line[:N_COLUMNS] for line in lines if line]
    if not rows or any(len(row) < N_COLUMNS for row in rows):
        raise ValueError(f"its lines have no {N_COLUMNS} numbers: number, type, x, y, z, radius, parent")
    return np.array(rows, np.float64)


def _branches(parents: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Chains of points, each from a branching point, or the root, to the next one or an end."""
    n_children = np.bincount(parents[parents >= 0], minlength=len(parents))
    ends = np.flatnonzero((n_children != 1) & (parents >= 0))
    chains = []
    n_seen = 0
    for end in ends:
        chain = [int(end)]
        while (parent := int(parents[chain[-1]])) >= 0:
            chain.append(parent)
            n_seen += 1
            if n_seen > len(parents):
                raise ValueError("its points are their own ancestors")
            if n_children[parent] != 1:
                break
        chains.append(np.array(chain[::-1]))
    if not chains:
        raise ValueError("it has no branch of two points")
    return chains
