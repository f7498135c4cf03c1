"""Facts about a volume for `wavesplat info`, as JSON and as text."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._looks.kinds.kinds import offset_of, unit_of_values
from wavesplat._model.lazy.checks import comparing_once
from wavesplat._model.lazy.parts import MAX_OVERVIEW
from wavesplat._model.lazy.survey import HISTOGRAM_SAMPLES, step_for
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._readers.single_planes import shape_in_file

if TYPE_CHECKING:
    from wavesplat._model.volume.grid import Grid
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

PERCENTILES = (1, 5, 25, 50, 75, 95, 99)
#: Largest number of samples that percentiles are taken from; for lazy volumes, those that their surveys keep.
N_SAMPLES_MAX = 10_000_000
#: Names of facts that are reported unchanged.
OF_FILE = (
    "modality",
    "value_unit",
    "window",
    "is_inverted",
    "channel",
    "channels",
    "n_times",
    "time_step",
    "time_unit",
    "times",
    "levels",
    "conventions",
    "guesses",
    "processing",
)
#: Largest number of channels, datasets, times, ... that the text lists.
N_LISTED = 40


@dataclass(frozen=True)
class Choice:
    """A choice that a file leaves open: the option that makes it, its possible values, and their descriptions."""

    option: str
    names: tuple[str | int, ...]
    described: tuple[str, ...] = ()
    #: Why the first value could not be shown.
    problem: str | None = None

    def facts(self) -> dict[str, Any]:
        """The choice, ready for JSON."""
        facts = {"option": self.option, "names": list(self.names), "described": list(self._described())}
        return facts if self.problem is None else {**facts, "problem": self.problem}

    def lines(self) -> list[str]:
        """The choice as lines of text."""
        described = self._described()
        first = self.names[0]
        if self.option == "series":
            how = "by number, description, modality or start of the UID"
            lines = [f"series       {len(self.names)}, choose with --series, {how}:"]
            lines += [f"{'':<12} {one}" for one in described]
        else:
            text = ", ".join(described[:N_LISTED]) + (", ..." if len(described) > N_LISTED else "")
            lines = [f"{f'{self.option}s':<12} {len(self.names)}, choose with --{self.option}: {text}"]
        if self.problem is None:
            below = "the first of them" if self.option == "series" else f"--{self.option} {first}"
            return [*lines, f"{'':<12} below is {below}"]
        return [*lines, f"{'':<12} the first cannot be shown: {self.problem}"]

    def _described(self) -> tuple[str, ...]:
        names = tuple(str(name) for name in self.names)
        if not any(self.described):
            return names
        if isinstance(self.names[0], int):
            return tuple(f"{name} {text}".strip() for name, text in zip(names, self.described, strict=False))
        return self.described


def describe(volume: Volume, *, of_coarsest: bool = False) -> dict[str, Any]:
    """Facts about a volume, ready for JSON, all of one state of its files.

    of_coarsest : take the statistics of a lazy volume from its coarsest level, unless that is large.
    """
    with comparing_once([volume]):
        return _described(volume, of_coarsest=of_coarsest)


def _described(volume: Volume, *, of_coarsest: bool) -> dict[str, Any]:
    level = _coarsest(volume) if of_coarsest and isinstance(volume, LazyVolume) else None
    shown = volume.read(level=level) if level is not None and isinstance(volume, LazyVolume) else volume
    if isinstance(shown, LazyVolume) and not shown.is_looked_through:
        facts: dict[str, Any] = {"value_range": None, "percentiles": {}, "n_nonfinite": None, "is_from_cache": False}
    else:
        facts = {"value_range": list(shown.value_range), "percentiles": _percentiles(shown)}
        facts["value_unit"] = unit_of_values(shown) or None
        facts["n_nonfinite"] = shown.n_nonfinite
        facts["is_from_cache"] = isinstance(shown, LazyVolume) and shown.is_from_cache
    facts["level_of_values"] = level or None  # 0 has all samples
    place = _place(volume)
    if facts["value_range"] is not None and (offset := offset_of(shown)):
        what = f"{offset:g} seems to be added to the Hounsfield units of a CT"
        text = f"{what}, by the values; windows and presets move with it"
        place["guesses"] = [*place["guesses"], text]
    return {
        **place,
        "dtype": str(volume.dtype),
        "n_bytes": math.prod(shape_in_file(volume)) * volume.dtype.itemsize,
        **facts,
    }


def is_large_pyramid(volume: Volume) -> bool:
    """Whether all samples take long to read, and the samples of a coarser level do not."""
    return isinstance(volume, LazyVolume) and math.prod(volume.shape) > MAX_OVERVIEW and _coarsest(volume) is not None


def _coarsest(volume: LazyVolume) -> int | None:
    """The coarsest level that is a volume; None where it is too large to be read for its statistics."""
    level = max(k for k, shape in enumerate(volume.levels) if min(shape) >= 2)
    return level if math.prod(volume.levels[level]) <= MAX_OVERVIEW else None


def describe_wavelets(wavelets: WaveletVolume, original: Volume | None = None) -> dict[str, Any]:
    """Facts about a volume of coefficients, and its error against the samples that it was made from."""
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
        # Wide integers and float64 have digits that float32 has not.
        exact = np.result_type(np.float32, original.samples.dtype)
        error = wavelets.to_volume().samples - original.samples.astype(exact)
        mean_square = float(np.mean(np.square(error), dtype=np.float64))
        extent = original.value_range[1] - original.value_range[0]
        facts["largest_error"] = float(np.abs(error).max())
        # None: no error, or no range to compare it with.
        facts["psnr_db"] = 10 * float(np.log10(extent**2 / mean_square)) if mean_square > 0 and extent > 0 else None
        facts["n_bytes_of_samples"] = int(original.samples.nbytes)
    return facts


def wavelet_lines(facts: dict[str, Any]) -> list[str]:
    """The facts as text, one fact a line."""
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
        *_place_lines(facts),
        *_processing_lines(facts),
        f"values       {low:g} to {high:g}{_unit_text(facts)}",
    ]
    if "psnr_db" in facts:
        psnr = "no error at all" if facts["psnr_db"] is None else f"PSNR {facts['psnr_db']:.2f} dB"
        text.append(f"error        {psnr}, at most {facts['largest_error']:.4g}")
    kept = [f"{level}: {count}" for level, count in enumerate(details)]
    return [*text, f"by level     {', '.join([*kept, f'coarsest: {coarsest}'])}"]


def _place(grid: Grid) -> dict[str, Any]:
    facts = grid.facts.as_json()
    return {
        "name": grid.name,
        "shape_zyx": list(shape_in_file(grid)),
        "spacing_xyz": list(grid.spacing),
        "unit": grid.unit,
        "is_anatomical": grid.is_anatomical,
        "orientation": grid.orientation if grid.is_anatomical else None,
        "bounds_xyz": grid.bounds.tolist(),
        "world_from_index": grid.world_from_index.tolist(),
        **{name: facts[name] for name in OF_FILE},
    }


def lines(facts: dict[str, Any]) -> list[str]:
    """The facts as text, one fact a line."""
    z, y, x = facts["shape_zyx"]
    percentiles = "  ".join(f"{name} %: {value:g}" for name, value in facts["percentiles"].items())
    if facts["value_range"] is None:
        values = ["values       not looked through yet; the first picture does that, and keeps what it finds"]
    else:
        low, high = facts["value_range"]
        values = [f"values       {low:g} to {high:g}{_unit_text(facts)}", f"percentiles  {percentiles}"]
        values.append(f"not finite   {facts['n_nonfinite']} samples")
        if facts["is_from_cache"]:
            values.append("             from the cache")
        if facts["level_of_values"] is not None:
            values.append(f"             of level {facts['level_of_values']} alone, the coarsest; --level 0 reads all")
    return [
        f"name         {facts['name']}",
        f"samples      {x} x {y} x {z} (x, y, z), {facts['dtype']}, {facts['n_bytes'] / 2**20:.1f} MiB",
        *_place_lines(facts),
        *values,
        *(f"convention   {text}" for text in facts["conventions"]),
        *(f"guess        {text}" for text in facts["guesses"]),
        *_processing_lines(facts),
    ]


def _unit_text(facts: dict[str, Any]) -> str:
    return f" {facts['value_unit']}" if facts["value_unit"] else ""


def _processing_lines(facts: dict[str, Any]) -> list[str]:
    return [f"processing   {text}" for text in facts["processing"]]


def _place_lines(facts: dict[str, Any]) -> list[str]:
    lower, upper = facts["bounds_xyz"]
    unit = f" {facts['unit']}" if facts["unit"] else ", of a unit that the file does not name"
    orientation = (
        f"{facts['orientation']} (where the axes x, y, z point)"
        if facts["is_anatomical"]
        else "none: the file says nothing of a patient"
    )
    text = [
        f"spacing      {_joined(facts['spacing_xyz'], ' x ')}{unit}",
        f"orientation  {orientation}",
        f"world box    ({_joined(lower, ', ')}) to ({_joined(upper, ', ')})",
    ]
    if facts["modality"]:
        text.append(f"modality     {facts['modality']}")
    if facts["window"] or facts["is_inverted"]:
        low, high = facts["window"] or (None, None)
        shown = [] if low is None else [f"level {(low + high) / 2:g}, width {high - low:g}"]
        text.append(f"window       {', '.join([*shown, *(['inverted'] if facts['is_inverted'] else [])])}")
    text += [f"channel {n:<4} {_channel_text(channel)}" for n, channel in enumerate(facts["channels"])]
    if facts["n_times"] > 1:
        step = f", {facts['time_step']:g} {facts['time_unit'] or ''}".rstrip() + " apart" if facts["time_step"] else ""
        if facts["times"]:
            times = ", ".join(f"{time:g}" for time in facts["times"][:N_LISTED])
            step = f": {times}{', ...' if facts['n_times'] > N_LISTED else ''} {facts['time_unit'] or ''}".rstrip()
        text.append(f"times        {facts['n_times']}{step}")
    shapes = (f"{x} x {y} x {z}" for z, y, x in facts["levels"])
    return [*text, f"levels       {', '.join(shapes)}"] if facts["levels"] else text


def _channel_text(channel: dict[str, Any]) -> str:
    parts = [channel["name"] or "without a name"]
    if channel["color"]:
        parts.append("#" + "".join(f"{round(255 * share):02x}" for share in channel["color"]))
    if channel["emission_nm"]:
        parts.append(f"{channel['emission_nm']:g} nm")
    if channel["window"]:
        low, high = channel["window"]
        parts.append(f"shown from {low:g} to {high:g}")
    if not channel["is_active"]:
        parts.append("not shown")
    return ", ".join(parts)


def _percentiles(volume: Volume) -> dict[str, float]:
    most = HISTOGRAM_SAMPLES if isinstance(volume, LazyVolume) else N_SAMPLES_MAX
    values = volume._every(step_for(math.prod(volume.shape), most)).ravel()
    if values.dtype.kind == "f":
        values = values[np.isfinite(values)]
    if values.size == 0:
        return {}
    return {str(p): float(v) for p, v in zip(PERCENTILES, np.percentile(values, PERCENTILES), strict=True)}


def _joined(numbers: list[float], between: str) -> str:
    return between.join(f"{number:.6g}" for number in numbers)
