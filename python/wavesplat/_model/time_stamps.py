"""Times of volumes as texts: "30 s", all of a series with the same number of decimals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

from wavesplat._model.facts import Facts
from wavesplat._model.series import Series

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume

#: A blank as wide as a digit.
FIGURE_SPACE = "\u2007"
#: Largest error of a written time, as a share of the shortest step between times.
MAX_ERROR = 0.01
#: Largest number of decimals.
MAX_DECIMALS = 9


@dataclass(frozen=True)
class TimeStamp:
    """The time of a volume among several: its number from 0, and the texts of all of their times."""

    number: int
    texts: tuple[str, ...]

    @property
    def text(self) -> str:
        """The time with its unit, or the number where no times are known."""
        return self.texts[self.number]

    @property
    def padded(self) -> str:
        """The same text, with figure spaces in front, so that all times are equally wide."""
        return padded(self.texts)[self.number]


def time_stamp_of(volume: Volume | WaveletVolume | Series, number: int = 0) -> TimeStamp | None:
    """The time of a volume that is one of several of its file, or of a volume of a series; else None.

    number : which volume, of a series.
    """
    if isinstance(volume, Series):
        if len(volume) == 1:
            return None
        return TimeStamp(number % len(volume), time_texts(volume.times, volume.time_unit))
    chosen = (volume._source or {}).get("time")
    n = volume.facts.n_times
    if not isinstance(chosen, int) or n < 2 or not -n <= chosen < n:
        return None
    return TimeStamp(chosen % n, time_texts(*times_of_facts(volume.facts, n)))


def times_of_facts(facts: Facts, n: int) -> tuple[tuple[float, ...], str | None]:
    """Times of `n` time points and their unit, as the file states them, else 0, 1, 2, ... without a unit."""
    if len(facts.times) == n:
        return facts.times, facts.time_unit
    step = facts.time_step
    return tuple(number * (step or 1.0) for number in range(n)), facts.time_unit if step else None


@lru_cache(maxsize=16)
def time_texts(times: tuple[float, ...], unit: str | None) -> tuple[str, ...]:
    """Times with their unit; as few decimals as leave an error of a hundredth of the shortest step between them."""
    ordered = sorted(set(times))
    steps = [after - before for before, after in pairwise(ordered)]
    error = MAX_ERROR * (min(steps) if steps else max(abs(ordered[0]), 1.0))
    decimals = next(
        (n for n in range(MAX_DECIMALS) if all(abs(round(time, n) - time) <= error for time in ordered)), MAX_DECIMALS
    )
    # Adding 0 makes -0 a 0.
    return tuple(f"{round(time, decimals) + 0.0:.{decimals}f}{f' {unit}' if unit else ''}" for time in times)


def padded(texts: Sequence[str]) -> list[str]:
    """The texts, filled up in front with figure spaces, so that those of digits are equally wide."""
    longest = max(map(len, texts))
    return [text.rjust(longest, FIGURE_SPACE) for text in texts]
