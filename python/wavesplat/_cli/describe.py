"""What `wavesplat info` says about a volume."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from wavesplat._model.grid import Grid
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["describe", "describe_wavelets", "lines", "wavelet_lines"]

PERCENTILES = (1, 5, 25, 50, 75, 95, 99)
#: Samples that the percentiles are taken from, at most.
N_SAMPLES_MAX = 10_000_000


def describe(volume: Volume) -> dict[str, Any]:
    """Facts about a volume, ready for JSON."""
    low, high = volume.value_range
    return {
        **_place(volume),
        "dtype": str(volume.dtype),
        "n_bytes": int(volume.samples.nbytes),
        "value_range": [low, high],
        "percentiles": _percentiles(volume),
        "n_nonfinite": volume.n_nonfinite,
    }


def describe_wavelets(wavelets: WaveletVolume, original: Volume | None = None) -> dict[str, Any]:
    """Facts about a volume of coefficients, and how near it is to the samples that it was made from."""
    low, high = wavelets.value_range
    facts: dict[str, Any] = {
        **_place(wavelets),
        "family": wavelets.family,
        "n_levels": wavelets.n_levels,
        "threshold": wavelets.threshold,
        "kept_fraction": wavelets.kept_fraction,
        "kept_by_level": list(wavelets.kept_by_level),
        "n_bytes": wavelets.nbytes,
        "value_range": [low, high],
    }
    if original is not None:
        error = wavelets.to_volume().samples - original.samples.astype(np.float32)
        mean_square = float(np.mean(np.square(error), dtype=np.float64))
        extent = original.value_range[1] - original.value_range[0]
        facts["largest_error"] = float(np.abs(error).max())
        # None: no error, or no range to compare it with.
        facts["psnr_db"] = 10 * float(np.log10(extent**2 / mean_square)) if mean_square > 0 and extent > 0 else None
        facts["n_bytes_of_samples"] = int(original.samples.nbytes)
    return facts


def wavelet_lines(facts: dict[str, Any]) -> list[str]:
    """The same for people, one fact a line."""
    z, y, x = facts["shape_zyx"]
    low, high = facts["value_range"]
    size = f"{facts['n_bytes'] / 2**20:.3g} MiB"
    if "n_bytes_of_samples" in facts:
        size += f", samples {facts['n_bytes_of_samples'] / 2**20:.3g} MiB"
    *details, coarsest = facts["kept_by_level"]
    text = [
        f"name         {facts['name']}",
        f"samples      {x} x {y} x {z} (x, y, z)",
        f"wavelets     {facts['family']}, {facts['n_levels']} levels",
        f"threshold    {facts['threshold']:.6g}",
        f"kept         {100 * facts['kept_fraction']:.4g} % of the coefficients",
        f"memory       {size}",
        f"values       {low:g} to {high:g}",
    ]
    if "psnr_db" in facts:
        psnr = "no error at all" if facts["psnr_db"] is None else f"PSNR {facts['psnr_db']:.2f} dB"
        text.append(f"error        {psnr}, at most {facts['largest_error']:.4g}")
    kept = [f"{level}: {count}" for level, count in enumerate(details)]
    return [*text, f"by level     {', '.join([*kept, f'coarsest: {coarsest}'])}"]


def _place(grid: Grid) -> dict[str, Any]:
    return {
        "name": grid.name,
        "shape_zyx": list(grid.shape),
        "spacing_xyz": list(grid.spacing),
        "orientation": grid.orientation,
        "bounds_xyz": grid.bounds.tolist(),
        "world_from_index": grid.world_from_index.tolist(),
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
