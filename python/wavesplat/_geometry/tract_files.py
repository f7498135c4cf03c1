"""Tracts of TrackVis (.trk) and MRtrix (.tck), by nibabel, which brings them into the scanner's world (RAS, mm)."""

from __future__ import annotations

from typing import Any

import numpy as np

from wavesplat._files.libraries import library
from wavesplat._files.size_checks import check_memory
from wavesplat._geometry.read_shape import Asked, ReadShape
from wavesplat.errors import ArgumentError

SUFFIXES = (".trk", ".tck")
#: Bytes of tracts in memory for each of the file: float32 becomes float64, twice.
BYTES_PER_BYTE = 5


def read(asked: Asked) -> ReadShape:
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
