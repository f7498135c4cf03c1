"""Time series: volumes at several times, each read when it is asked for, and their times as texts."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import isfinite
from operator import index
from os import PathLike
from threading import RLock
from typing import TYPE_CHECKING, Any, Literal, Protocol, overload, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat._model.arguments.types import takes_its_types, text_of
from wavesplat._model.interchange import volume_file
from wavesplat._model.volume import affine
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.sources import Source, then
from wavesplat._model.volume.stack import stacked
from wavesplat._model.volume.volume import Volume
from wavesplat._public import public
from wavesplat._storage.paths import printable
from wavesplat._system.values import described, numbers
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.volume.wavelet_volume import WaveletVolume

# Times of volumes as texts: "30 s", all of a series with the same number of decimals.

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
    """The texts, filled up in front with figure spaces, so that texts of digits are equally wide."""
    longest = max(map(len, texts))
    return [text.rjust(longest, FIGURE_SPACE) for text in texts]


# Time series: volumes at several times, each read when it is asked for.

#: Volumes that are kept, so that going back and forth between two times, or comparing them, reads each once.
N_KEPT = 3


@runtime_checkable
class TimePoints(Protocol):
    """Volumes that are read on demand, and their times."""

    def __len__(self) -> int:
        """Number of volumes."""

    def __getitem__(self, number: int) -> Volume:
        """The volume of a number, from 0 on."""

    def times(self) -> tuple[tuple[float, ...], str | None]:
        """Time of each volume, and the unit of the times."""

    def description(self) -> str:
        """Description of the volumes' source in messages."""


@public
class Series:
    """Volumes at several times, each read when it is asked for; the last few are kept.

    `wavesplat.open_series` makes one of files.

    Parameters
    ----------
    volumes : sequence of Volume
        One for each time, or anything with a length whose `[n]` gives a volume, which is asked for when it is needed.
    times : sequence of float, optional
        Time of each volume; 0, 1, 2, ... if not given.
    time_unit : str, optional
        Unit of the times, such as "s".
    name : str, default "series"
        Name in messages.

    Raises
    ------
    ArgumentError
        If there is no volume, or there are more or fewer times than volumes.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> beating = np.random.default_rng(1).random((5, 8, 8, 8), np.float32)
    >>> series = ws.Series([ws.Volume(one, spacing=(1, 1, 2)) for one in beating], times=[0, 2, 4, 6, 8], time_unit="s")
    >>> len(series), series[-1].shape, series[::2].times
    (5, (8, 8, 8), (0.0, 4.0, 8.0))
    """

    def __init__(
        self,
        volumes: Sequence[Volume] | TimePoints,
        *,
        times: Sequence[float] | None = None,
        time_unit: str | None = None,
        name: str = "series",
    ) -> None:
        if isinstance(volumes, Volume) or not (hasattr(volumes, "__len__") and hasattr(volumes, "__getitem__")):
            raise ArgumentError(f"volumes of a series are {described(volumes)}; give a list of wavesplat.Volume")
        n = len(volumes)
        if n == 0:
            raise ArgumentError("a series needs at least one volume; the list is empty")
        self._name = printable(text_of(name, "name of the series"))
        self._volumes = volumes
        self._numbers = range(n)
        self._times = None if times is None else _checked_times(times, n)
        self._time_unit = None if time_unit is None else text_of(time_unit, "time_unit of the series")
        #: Source of the series for documents, None if unknown (`_model.volume.sources`).
        self._source: Source | None = None
        self._kept: OrderedDict[int, Volume] = OrderedDict()
        self._lock = RLock()
        #: Number of the volume that looks are made for, and that volume (`_looks.over_time`).
        self._brightest: tuple[int, Volume] | None = None
        #: Name of layers that show the series, once it was found (`_looks.layer_names`).
        self._shown_name: str | None = None

    @property
    def name(self) -> str:
        """Name in messages; of a file its name."""
        return self._name

    @property
    def times(self) -> tuple[float, ...]:
        """Time of each volume, in `time_unit`; 0, 1, 2, ... where nothing is known. A file may be read to find out."""
        times = self._known_times()[0]
        return tuple(times[number] for number in self._numbers)

    @property
    def time_unit(self) -> str | None:
        """Unit of `times`, such as "s"; None where nothing is known."""
        return self._known_times()[1]

    @takes_its_types
    def save(self, path: str | PathLike[str], *, downsampling: Literal["mean", "nearest"] | None = None) -> None:
        """Write all volumes, with their times, to one file; the suffix chooses the format.

        Parameters
        ----------
        path, downsampling
            As for `Volume.save`; `.ome.tif` and `.ome.zarr` hold several times.

        Raises
        ------
        FileError
            If the suffix is unknown or the file cannot be written; an existing file is replaced only by a whole one.
        ArgumentError
            If the volumes differ in shape or place, or the format holds one volume.

        Examples
        --------
        >>> import numpy as np, wavesplat as ws
        >>> beating = np.random.default_rng(1).integers(0, 255, (5, 8, 8, 8), np.uint8)
        >>> series = ws.Series([ws.Volume(one) for one in beating], times=[0, 2, 4, 6, 8], time_unit="s")
        >>> series.save("beating.ome.tif")
        >>> ws.open_series("beating.ome.tif").times
        (0.0, 2.0, 4.0, 6.0, 8.0)
        """
        volume_file.save(stacked([self], None, self.times, self.time_unit), path, downsampling)

    def __len__(self) -> int:
        return len(self._numbers)

    @overload
    def __getitem__(self, key: int) -> Volume: ...
    @overload
    def __getitem__(self, key: slice) -> Series: ...
    def __getitem__(self, key: int | slice) -> Volume | Series:
        """The volume of a number, negative ones from the end; for a slice a series, which reads nothing yet."""
        if isinstance(key, slice):
            return self._part(self._numbers[key], key)
        try:
            place = index(key)
        except TypeError:
            raise ArgumentError(
                f"number of a time point is {described(key)}; give a whole number, or a slice"
            ) from None
        n = len(self)
        if not -n <= place < n:
            raise ArgumentError(f"time point {place}, but {self._description()} holds {n}, 0..{n - 1}")
        return self._volume(self._numbers[place])

    def moved(self, matrix: ArrayLike) -> Series:
        """The series with volumes that are moved when they are read, as by `Volume.moved`.

        Parameters
        ----------
        matrix : array, shape (4, 4)
            Affine from the volumes' world to the new one, world units.

        Raises
        ------
        ArgumentError
            If it is no affine map, or has no inverse.
        """
        world_from_world = affine.checked_map(matrix, f"series {self.name!r}: the matrix to move it by")
        made = Series(_Moved(self, world_from_world), name=self.name)
        made._source = then(self._source, "moved", matrix=world_from_world.tolist())
        return made

    def __iter__(self) -> Iterator[Volume]:
        return (self._volume(number) for number in self._numbers)

    def __repr__(self) -> str:
        n = len(self)
        return f"<Series {self.name!r}: {n} time point{'' if n == 1 else 's'}>"

    def __getstate__(self) -> dict[str, Any]:
        # What is kept can be read again.
        return {name: value for name, value in vars(self).items() if name not in ("_kept", "_lock", "_brightest")}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state, _kept=OrderedDict(), _lock=RLock(), _brightest=None)

    def _part(self, numbers: range, key: slice) -> Series:
        if not numbers:
            raise ArgumentError(
                f"no time point lies in {key.start}:{key.stop}:{key.step}; {self._description()} holds {len(self)}"
            )
        part = Series.__new__(Series)
        vars(part).update(vars(self), _numbers=numbers, _brightest=None)  # what is kept is shared
        part._source = then(self._source, "times", start=key.start, stop=key.stop, step=key.step)
        return part

    def _volume(self, number: int) -> Volume:
        with self._lock:
            if number in self._kept:
                self._kept.move_to_end(number)
                return self._kept[number]
            volume = self._volumes[number]
            if not isinstance(volume, Volume):
                raise ArgumentError(
                    f"time point {number} of series {self.name!r} is {described(volume)}; give a list of volumes, as "
                    "[wavesplat.Volume(array, spacing=(x, y, z)) for array in arrays]"
                )
            self._kept[number] = volume
            while len(self._kept) > N_KEPT:
                self._kept.popitem(last=False)
            return volume

    def _known_times(self) -> tuple[tuple[float, ...], str | None]:
        with self._lock:
            if self._times is None:
                self._times = tuple(float(number) for number in range(len(self._volumes)))
                if isinstance(self._volumes, TimePoints):
                    self._times, self._time_unit = self._volumes.times()
            return self._times, self._time_unit

    def _description(self) -> str:
        return self._volumes.description() if isinstance(self._volumes, TimePoints) else f"series {self.name!r}"


def _checked_times(times: Sequence[float], n: int) -> tuple[float, ...]:
    moments = numbers(times, "times of a series", "a number for each volume", finite=False)
    if len(moments) != n:
        raise ArgumentError(f"{len(moments)} times are given for {n} volumes; give one for each")
    if not all(isfinite(time) for time in moments):
        raise ArgumentError("times of a series must be finite numbers")
    return moments


class _Moved:
    """The volumes of a series, moved when they are read."""

    def __init__(self, series: Series, matrix: NDArray[np.float64]) -> None:
        self._series, self._matrix = series, matrix

    def __len__(self) -> int:
        return len(self._series)

    def __getitem__(self, number: int) -> Volume:
        return self._series[number].moved(self._matrix)

    def times(self) -> tuple[tuple[float, ...], str | None]:
        return self._series.times, self._series.time_unit

    def description(self) -> str:
        return f"series {self._series.name!r}"
