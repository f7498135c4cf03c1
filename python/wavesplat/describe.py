"""What `wavesplat info` says about a volume."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from wavesplat.volume import Volume

__all__ = ["describe", "lines"]

PERCENTILES = (1, 5, 25, 50, 75, 95, 99)
#: Samples that the percentiles are taken from, at most.
N_SAMPLES_MAX = 10_000_000


def describe(volume: Volume) -> dict[str, Any]:
    """Facts about a volume, ready for JSON."""
    low, high = volume.value_range
    return {
        "name": volume.name,
        "shape_zyx": list(volume.shape),
        "dtype": str(volume.dtype),
        "n_bytes": int(volume.samples.nbytes),
        "spacing_xyz": list(volume.spacing),
        "orientation": volume.orientation,
        "bounds_xyz": volume.bounds.tolist(),
        "world_from_index": volume.world_from_index.tolist(),
        "value_range": [low, high],
        "percentiles": _percentiles(volume),
        "n_nonfinite": volume.n_nonfinite,
    }


def lines(facts: dict[str, Any]) -> list[str]:
    """The same for people, one fact a line."""
    z, y, x = facts["shape_zyx"]
    lower, upper = facts["bounds_xyz"]
    percentiles = "  ".join(f"{name} %: {value:g}" for name, value in facts["percentiles"].items())
    return [
        f"name         {facts['name']}",
        f"samples      {x} x {y} x {z} (x, y, z), {facts['dtype']}, {facts['n_bytes'] / 2**20:.1f} MiB",
        f"spacing      {_joined(facts['spacing_xyz'], ' x ')}",
        f"orientation  {facts['orientation']} (where the axes x, y, z point)",
        f"world box    ({_joined(lower, ', ')}) to ({_joined(upper, ', ')})",
        f"values       {facts['value_range'][0]:g} to {facts['value_range'][1]:g}",
        f"percentiles  {percentiles}",
        f"not finite   {facts['n_nonfinite']} samples",
    ]


def _percentiles(volume: Volume) -> dict[str, float]:
    step = max(1, int(np.ceil((volume.samples.size / N_SAMPLES_MAX) ** (1 / 3))))
    values = volume.samples[::step, ::step, ::step].ravel()
    if values.dtype.kind == "f":
        values = values[np.isfinite(values)]
    if values.size == 0:
        return {}
    return {str(p): float(v) for p, v in zip(PERCENTILES, np.percentile(values, PERCENTILES), strict=True)}


def _joined(numbers: list[float], between: str) -> str:
    return between.join(f"{number:.6g}" for number in numbers)
