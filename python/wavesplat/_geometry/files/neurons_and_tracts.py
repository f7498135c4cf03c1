"""Neurons in SWC files, and tracts of TrackVis and MRtrix.

Format: http://www.neuronland.org/NLMorphologyConverter/MorphologyFormats/SWC/Spec.html; lengths are micrometres.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.files.read_shape import Asked, ReadShape
from wavesplat._storage.paths import read_text
from wavesplat._storage.size_checks import check_memory
from wavesplat._system.libraries import library
from wavesplat.errors import ArgumentError

#: Columns: number, type, x, y, z, radius, parent (-1: none).
N_COLUMNS = 7
SOMA, AXON, DENDRITE, APICAL = 1, 2, 3, 4


def read_neuron(asked: Asked) -> ReadShape:
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


# Tracts of TrackVis (.trk) and MRtrix (.tck), by nibabel, which brings them into the scanner's world (RAS, mm).

SUFFIXES = (".trk", ".tck")
#: Bytes of tracts in memory for each of the file: float32 becomes float64, twice.
BYTES_PER_BYTE = 5


def read_tracts(asked: Asked) -> ReadShape:
    """The tracts in a file; `values` names one of a TRK file's numbers for each position or tract."""
    check_memory(BYTES_PER_BYTE * asked.file.stat().st_size, asked.file)
    streamlines: Any = library("nibabel.streamlines", extra="geometry")
    # Taken before loading: nibabel replaces it by the number of tracts that it has read.
    promised = _count(streamlines.load(str(asked.file), lazy_load=True).header)
    tractogram = streamlines.load(str(asked.file)).tractogram
    tracts = [np.asarray(one, np.float64) for one in tractogram.streamlines]
    if len(tracts) < promised:
        raise ValueError(f"truncated: its header promises {promised} tracts, and it holds {len(tracts)}")
    n_lost = sum(not np.isfinite(one).all() for one in tracts)
    kept = [k for k, one in enumerate(tracts) if len(one) and np.isfinite(one).all()]
    if not kept:
        raise ValueError("it holds no tracts")
    fields: dict[str, Any] = {"paths": [tracts[k] for k in kept]}
    if asked.values is not None:
        fields["values"] = _values(tractogram, asked, kept)
    guesses = (f"{n_lost} of {len(tracts)} tracts left out: they have positions that are not finite",) if n_lost else ()
    return ReadShape("lines", fields, "mm", guesses)


def _count(header: Any) -> int:
    """The number of tracts in the header; 0 if the header has no count."""
    try:
        return int(header.get("nb_streamlines") or header.get("count") or 0)
    except (TypeError, ValueError):
        return 0


def _values(tractogram: Any, asked: Asked, kept: list[int]) -> Any:
    of_points, of_tracts = tractogram.data_per_point, tractogram.data_per_streamline
    if asked.values in of_points:
        return np.concatenate([np.asarray(of_points[asked.values][k], np.float64)[:, 0] for k in kept])
    if asked.values in of_tracts:
        numbers = np.asarray(of_tracts[asked.values], np.float64)[kept, 0]
        return np.repeat(numbers, [len(tractogram.streamlines[k]) for k in kept])
    listed = ", ".join([*of_points, *of_tracts]) or "none"
    raise ArgumentError(f"the tracts have no values {asked.values!r}; there are: {listed}: {asked.file}")
