"""Volumes as their wavelet coefficients of large amplitude."""

from __future__ import annotations

import json
import math
import sys
import threading
import zipfile
from collections.abc import Callable, Sequence
from concurrent.futures import Future, wait
from dataclasses import replace
from itertools import accumulate
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.volume.facts import Facts
from wavesplat._model.volume.grid import Grid, name_in_files
from wavesplat._model.volume.sources import Source, of_file, then
from wavesplat._model.volume.volume import Volume
from wavesplat._public import public
from wavesplat._storage import size_checks
from wavesplat._storage.output import check_output, write_atomically
from wavesplat._storage.paths import expanded
from wavesplat._storage.reading import reading
from wavesplat._storage.stored_arrays import check_members
from wavesplat._system.memory import check_room
from wavesplat._system.values import number, numbers, whole
from wavesplat.errors import ArgumentError, FileError

# Ctrl-C while compiled code runs, which does not check for signals itself.

T = TypeVar("T")

#: Seconds between checks for signals; on Windows waiting itself is not interrupted.
POLL_S = 0.1


def interruptible(work: Callable[[], T]) -> T:
    """The result of `work`; on Ctrl-C a `KeyboardInterrupt` is raised at once, and the result is dropped.

    It must release the interpreter lock while it runs, and change nothing but its result: after Ctrl-C it goes on in
    its thread until it is done.
    """
    if threading.current_thread() is not threading.main_thread():
        return work()  # only the main thread gets signals
    done: Future[T] = Future()

    def run() -> None:
        try:
            done.set_result(work())
        except BaseException as error:  # noqa: BLE001 - carried to the thread that waits, which raises it
            done.set_exception(error)

    threading.Thread(target=run, name="wavesplat-work", daemon=True).start()
    while not wait([done], POLL_S).done:
        pass
    return done.result()


# Volumes as their wavelet coefficients of large amplitude.

#: Names of the norms by which a coefficient's amplitude is measured.
NORMALISATIONS = ("l2", "peak")

#: Default of `cache_bytes`: bytes of decoded samples that are kept for the next picture.
CACHE_BYTES = 1 << 29

#: Decoded levels and bands that are cached at a time, at most.
MAX_DECODED = 6

#: Each of these takes at most one part in LARGEST_SHARE of the cache.
LARGEST_SHARE = 2

#: Largest sample: sums of a few hundred of them must not leave float32.
LARGEST = 1e35

#: The head of a file of coefficients. Version 2 adds an offset to the decoded samples, which readers of version 1 would
#: leave out in silence; so it is written only where there is one.
FORMAT, FORMAT_VERSIONS = "wavesplat wavelets", ("1", "2")


@public
class WaveletVolume(Grid):
    """A volume as its wavelet coefficients of large amplitude; made by `WaveletVolume.from_volume`, or loaded.

    `render` draws it like a volume, all of it, only its coarse levels (`level`), or only details of chosen sizes
    (`bands`); it decodes what it looks at, and keeps at most `cache_bytes` of decoded samples.
    Level 0 holds the finest details, each further one details twice as large.

    Examples
    --------
    >>> import wavesplat as ws
    >>> wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(32), family="cdf53", threshold=12)
    >>> round(100 * wavelets.kept_fraction, 1)
    20.0
    """

    __slots__ = ("_cache_bytes", "_core", "_decoded_levels", "_family", "_left_out", "_psnr", "_source", "_weights")

    def __init__(
        self,
        core: _native.WaveletVolume,
        name: str,
        world_from_index: NDArray[np.float64],
        family: str,
        facts: Facts | None = None,
    ) -> None:
        super().__init__(name, core.shape, world_from_index, facts or Facts())
        self._core = core
        self._family = family
        #: A factor for each level's details, and for the coarsest samples.
        self._weights = (1.0,) * (core.n_levels + 1)
        self._left_out = 0
        self._psnr = core.psnr
        #: Source of the coefficients for documents, None if unknown (`_model.volume.sources`).
        self._source: Source | None = None
        self._cache_bytes = CACHE_BYTES
        #: The decoded volumes that were drawn last, by levels left out and weights.
        self._decoded_levels: dict[tuple[int, tuple[float, ...]], _native.DecodedVolume] = {}

    @classmethod
    @takes_its_types
    def from_volume(
        cls,
        volume: object,
        family: str = "cdf97",
        *,
        threshold: float | None = None,
        keep: float | None = None,
        psnr: float | None = None,
        levels: int | None = None,
        normalisation: str = "l2",
    ) -> WaveletVolume:
        """The coefficients of a volume that have a large amplitude.

        Parameters
        ----------
        volume : Volume, array, or what else `Volume` takes
            All samples finite. Where they are far from 0, their middle is subtracted before they are made float32, and
            added to decoded ones, so that they keep their digits.
        family : str
            Biorthogonal, by lifting: "cdf97" (the best picture per coefficient), "cdf53" (linear B-spline), "haar",
            "spline4" (cubic B-spline). Semi-orthogonal on the interval: "bspline2", "bspline3", "bspline4", by order.
        threshold : float, optional
            Drop coefficients of less amplitude, in the units of the samples; 0, the default, drops nothing.
        keep : float, optional
            Keep this share of the coefficients instead, 0 to 1.
        psnr : float, optional
            Keep the fewest coefficients that give the samples back with this PSNR, in dB, its peak the range of the
            samples; `psnr` of the result is the one that was reached.
        levels : int, optional
            Levels of details; None is the largest number that the shape allows.
        normalisation : str
            An amplitude is the coefficient times the norm of its basis function: "l2" (finest spacing 1), or "peak".

        Raises
        ------
        ArgumentError
            If a name is unknown, more than one of threshold, keep and psnr is given, a number is out of range, or
            samples are NaN or infinite, or the PSNR is more than samples in float32 can have.
        """
        if not isinstance(volume, Volume):
            volume = Volume._of(volume, None, "volume")
        families = _native.WaveletVolume.families()
        if family not in families:
            raise ArgumentError(f"there is no wavelet family {family!r}; the families are {', '.join(families)}")
        if normalisation not in NORMALISATIONS:
            raise ArgumentError(f"normalisation is {normalisation!r}; it is one of {', '.join(NORMALISATIONS)}")
        if volume.n_nonfinite:
            raise ArgumentError(
                f"volume {volume.name!r} has {volume.n_nonfinite} samples that are NaN or infinite, which wavelets "
                "would spread over the volume; replace them first, as with numpy.nan_to_num"
            )
        if levels is not None and whole(levels, "levels") < 0:
            raise ArgumentError(f"levels is {levels}; give 0 or more, or nothing for as many as there are")
        if max(map(abs, volume.value_range)) > LARGEST:
            raise ArgumentError(
                f"volume {volume.name!r} has samples from {volume.value_range[0]:g} to {volume.value_range[1]:g}, too "
                f"large for coefficients in float32; scale them to less than {LARGEST:g}"
            )
        how, amount = _what_stays(threshold, keep, psnr)
        peak = normalisation == "peak"
        given: Any = {"family": family, "keep": how, "amount": amount, "levels": levels, "peak": peak}
        try:
            core = interruptible(lambda: _native.WaveletVolume(volume._core, **given))
        except ValueError as error:
            raise ArgumentError(f"volume {volume.name!r}: {error}") from None
        made = cls(core, volume.name, volume.world_from_index, family, volume.facts)
        options = {how: float(amount), "levels": levels, "normalisation": normalisation}
        made._source = then(volume._source, "wavelets", family=family, **options)
        return made

    @property
    def family(self) -> str:
        """Name of the wavelet family."""
        return self._family

    @property
    def n_levels(self) -> int:
        """Number of levels of details."""
        return self._core.n_levels

    @property
    def threshold(self) -> float:
        """Amplitude below which coefficients were dropped."""
        return self._core.threshold

    @property
    def psnr(self) -> float | None:
        """PSNR that was reached, in dB, where `from_volume` was given one; else None.

        Infinite where the samples come back exactly, as samples that are all equal do. Pickles keep it, files do not.
        """
        return self._psnr

    @property
    def kept_by_level(self) -> tuple[int, ...]:
        """Coefficients that are kept of each level's details, the finest first, and of the coarsest samples."""
        return tuple(self._core.n_kept_by_level)

    @property
    def kept_fraction(self) -> float:
        """Share of the coefficients that is kept."""
        return sum(self._core.n_kept_by_level) / math.prod(self._shape)

    @property
    def nbytes(self) -> int:
        """Bytes of the coefficients and their positions in memory."""
        return self._core.n_bytes

    @property
    def cache_bytes(self) -> int:
        """Bytes of decoded samples that are kept for the next picture; a smaller number takes longer to draw.

        Levels and bands that were drawn share it, so that drawing coarse to fine decodes each level once. A coarser
        level takes about 10 MB more, to match the brightness of the finer ones.
        """
        return self._cache_bytes

    @cache_bytes.setter
    def cache_bytes(self, n_bytes: int) -> None:
        # A float will do, as 2e9 is easier to read.
        if not 0 <= number(n_bytes, "cache_bytes", "a number", finite=False) < math.inf:
            raise ArgumentError(f"cache_bytes is {n_bytes}; give 0 or more")
        self._cache_bytes = min(int(n_bytes), sys.maxsize)
        self._decoded_levels.clear()

    @property
    def is_detail(self) -> bool:
        """Whether the coarsest samples are left out, so that values are details of both signs."""
        return self._weights[-1] == 0

    @property
    def n_nonfinite(self) -> int:
        """Number of samples that are NaN or infinite: 0, they are refused."""
        return 0

    @property
    def value_range(self) -> tuple[float, float]:
        """Smallest and largest sample."""
        return self._decoded().value_range

    @property
    def left_out(self) -> int:
        """Number of levels of details that are left out, the finest first."""
        return self._left_out

    def to_volume(self) -> Volume:
        """The volume that the coefficients stand for, float32, on the grid it was made from.

        Examples
        --------
        >>> import wavesplat as ws
        >>> wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(16))
        >>> wavelets.level(2).to_volume().shape  # smooth, on all samples
        (16, 16, 16)
        """
        check_room(4 * math.prod(self._shape), "the samples", "draw the coefficients as they are, or fewer levels")
        weights = (0.0,) * self._left_out + self._weights[self._left_out :]
        samples = interruptible(lambda: self._core.samples(weights))
        made = Volume(samples, world_from_index=self._world_from_index, name=self._name, facts=self._facts)
        made._source = then(self._source, "to_volume")
        return made

    @takes_its_types
    def level(self, left_out: int) -> WaveletVolume:
        """The same coefficients without the details of some levels, the finest first.

        What is left is drawn at its own resolution, with fewer sheets and texels (B-spline families: at the full one),
        and classified by the samples that it stands for, so that the picture keeps its brightness.

        Parameters
        ----------
        left_out : int
            Number of levels to leave out, at most all that there are.

        Raises
        ------
        ArgumentError
            If there are fewer levels.

        Examples
        --------
        >>> import wavesplat as ws
        >>> wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(16))
        >>> ws.render(wavelets.level(1), size=(16, 16)).size
        (16, 16)
        """
        self._check_levels(left_out)
        chosen = self._copy()
        chosen._left_out = left_out
        chosen._source = then(self._source, "level", left_out=left_out)
        return chosen

    def bands(self, weights: Sequence[float]) -> WaveletVolume:
        """The same coefficients with a factor for each level's details, the finest first, and for the coarsest samples.

        Parameters
        ----------
        weights : sequence of float
            Those not given are 1. Without the coarsest samples (weight 0) values are signed details, which get a
            diverging transfer function where none is given.

        Raises
        ------
        ArgumentError
            If there are more weights than levels and one, or a weight is not finite.

        Examples
        --------
        >>> import wavesplat as ws
        >>> wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(16), levels=2)
        >>> wavelets.bands([0, 1, 0]).is_detail  # only details of the second size
        True
        """
        what = "weights of bands"
        given = list(numbers(weights, what, "numbers, the finest level first", finite=False))
        n = self.n_levels
        if len(given) > n + 1 or not all(math.isfinite(weight) for weight in given):
            raise ArgumentError(
                f"{what} is {given}; give at most {n + 1} finite numbers: one for each of the {n} "
                f"levels of {self._name!r}, the finest first, and one for the coarsest samples"
            )
        given += [1.0] * (n + 1 - len(given))
        weighted = self._copy()
        weighted._weights = tuple(a * b for a, b in zip(self._weights, given, strict=True))
        weighted._source = then(self._source, "bands", weights=given)
        return weighted

    def _copy(self) -> WaveletVolume:
        """A copy that shares the decoded levels."""
        copy = WaveletVolume(self._core, self._name, self._world_from_index, self._family, self._facts)
        copy._left_out, copy._psnr = self._left_out, self._psnr
        copy._source = self._source
        copy._weights = self._weights
        copy._cache_bytes = self._cache_bytes
        copy._decoded_levels = self._decoded_levels
        return copy

    @takes_its_types
    def save(self, path: str | PathLike[str]) -> None:
        """Write the coefficients to a file, `.wavelets`: a NumPy archive of what `load` needs.

        The range of the samples that they stand for goes with them; where nothing was drawn yet, everything is
        decoded once to find it.

        Raises
        ------
        FileError
            If the name has another suffix or the file cannot be written.
        """
        check_output(path, "wavelet coefficients")
        has_block, masks, values, _ = self._core.parts()
        arrays: dict[str, Any] = {
            "format": np.array([FORMAT, FORMAT_VERSIONS[self._core.offset != 0], self._family, name_in_files(self)]),
            "shape": np.array(self._shape),
            "levels_and_threshold": np.array([self.n_levels, self.threshold]),
            "offset": np.array([self._core.offset], np.float32),
            "weights": np.array(self._weights),
            "left_out": np.array([self._left_out]),
            "world_from_index": self._world_from_index,
            # A text, which releases that do not know it leave alone.
            "facts": np.array(json.dumps(replace(self._facts, description=None).as_json())),
            "has_block": np.packbits(has_block),
            "n_blocks": np.array([has_block.size]),
            "masks": masks,
            "values": values,
        }
        # Found by decoding everything: once here, not before the first picture of each program.
        value_range = np.array(self._core.value_range, np.float32)
        if np.isfinite(value_range).all():
            arrays["value_range"] = value_range

        def write(part: Path) -> None:
            with part.open("wb") as file:
                np.savez_compressed(file, allow_pickle=False, **arrays)

        write_atomically(path, write)

    @classmethod
    @takes_its_types
    def load(cls, path: str | PathLike[str]) -> WaveletVolume:
        """Coefficients that `save` wrote.

        Raises
        ------
        FileError
            If the file is not there, is not one of coefficients, or is damaged.
        """
        size_checks.check_readable(expanded(path))
        # Opened here, since NumPy leaves files open that are no archives.
        with (
            reading("wavelet coefficients", path),
            expanded(path).open("rb") as file,
        ):
            with zipfile.ZipFile(file) as promised:
                check_members(promised, promised.namelist(), path)
            file.seek(0)
            with np.load(file, allow_pickle=False) as archive:
                loaded = cls._from_arrays({name: archive[name] for name in archive.files}, path)
            loaded._source = of_file(path, {})
            return loaded

    @classmethod
    def _from_arrays(cls, arrays: dict[str, NDArray[Any]], path: object) -> WaveletVolume:
        """The coefficients in an archive that `save` wrote; raises nearly anything where its arrays do not agree."""
        kind, version, family, name = (str(text) for text in arrays["format"])
        if kind != FORMAT or version not in FORMAT_VERSIONS:
            raise FileError(
                f"this is {kind!r} version {version}; this program reads {FORMAT!r} version "
                f"{' and '.join(FORMAT_VERSIONS)}: {path}"
            )
        levels, threshold = arrays["levels_and_threshold"]
        n_z, n_y, n_x = (int(n) for n in arrays["shape"])
        packed, n_blocks = arrays["has_block"], int(arrays["n_blocks"][0])
        if not 0 <= n_blocks <= 8 * packed.size:
            raise ValueError(f"there are {n_blocks} blocks, and bits for {8 * packed.size}")
        size_checks.check_memory(n_blocks, path)
        # Older files have no offset, range of values, facts or levels left out.
        offset = float(arrays["offset"][0]) if "offset" in arrays else 0.0
        lo_hi = arrays.get("value_range")
        facts = Facts.from_json(json.loads(str(arrays["facts"]))) if "facts" in arrays else Facts()
        core = _native.WaveletVolume.from_parts(
            (n_z, n_y, n_x),
            family,
            int(levels),
            float(threshold),
            offset,
            np.unpackbits(packed, count=n_blocks),
            arrays["masks"],
            arrays["values"],
            None if lo_hi is None else tuple(lo_hi.tolist()),
        )
        try:
            # A volume of any samples, for the sake of its checks.
            place = Volume(np.zeros((2, 2, 2), np.uint8), world_from_index=arrays["world_from_index"], name=name)
            made = cls(core, name, place.world_from_index, family, facts).bands(arrays["weights"].tolist())
            return made.level(int(arrays["left_out"][0])) if "left_out" in arrays else made
        except ArgumentError as error:
            raise ValueError(str(error)) from None

    def _every(self, step: int) -> NDArray[Any]:
        """Every n-th sample along each axis, [z, y, x]."""
        decoded = self._decoded()
        return decoded.every(step)

    def _check_levels(self, left_out: int) -> None:
        if not 0 <= whole(left_out, "left_out") <= self.n_levels:
            raise ArgumentError(
                f"left_out is {left_out}; {self._name!r} has {self.n_levels} levels, so give 0 to {self.n_levels}"
            )

    def _decoded(self, left_out: int = 0) -> _native.DecodedVolume:
        """The decoded volume of a level, for drawing; those drawn last are kept."""
        key = left_out, self._weights
        decoded = self._decoded_levels.pop(key, None)
        if decoded is None:
            share = self._cache_bytes // LARGEST_SHARE
            decoded = self._core.decoded(left_out, self._weights, self._world_from_index, self._name, share)
        self._decoded_levels[key] = decoded
        # The latest first. Other threads may draw from the same coefficients, and drop the same ones.
        latest = list(self._decoded_levels.items())[::-1]
        taken = list(accumulate(level.cache_bytes for _, level in latest))
        for k, (oldest, _) in enumerate(latest):
            if k >= MAX_DECODED or taken[k] > self._cache_bytes:
                self._decoded_levels.pop(oldest, None)
        return decoded

    def __reduce__(self) -> tuple[Any, ...]:
        core = self._core
        how = self._shape, self._family, self.n_levels, core.threshold, core.offset, *core.parts()
        place = self._name, self._world_from_index, self._facts
        return self._rebuild, (how, place, (self._weights, self._left_out, self._psnr, self._source), self._cache_bytes)

    @classmethod
    def _rebuild(
        cls,
        how: tuple[Any, ...],
        place: tuple[str, NDArray[np.float64], Facts],
        shown: tuple[Sequence[float], int, float | None, Source | None],
        cache_bytes: int,
    ) -> WaveletVolume:
        name, world_from_index, facts = place
        weights, left_out, psnr, source = shown
        made = cls(_native.WaveletVolume.from_parts(*how), name, world_from_index, how[1], facts)
        rebuilt = made.bands(weights).level(left_out)
        rebuilt.cache_bytes = cache_bytes
        rebuilt._psnr, rebuilt._source = psnr, source
        return rebuilt

    def __repr__(self) -> str:
        return (
            f"<WaveletVolume {self._name!r}: z, y, x {' x '.join(map(str, self._shape))}, {self._family}, "
            f"{self.n_levels} levels, {100 * self.kept_fraction:.3g} % of the coefficients in {self.nbytes} bytes>"
        )


def _what_stays(threshold: float | None, keep: float | None, psnr: float | None) -> tuple[str, float]:
    given = {
        name: value for name, value in (("threshold", threshold), ("keep", keep), ("psnr", psnr)) if value is not None
    }
    if len(given) > 1:
        raise ArgumentError(f"got {' and '.join(given)}; give one of threshold, keep and psnr")
    name, value = next(iter(given.items()), ("threshold", 0.0))
    value = number(value, name, "a number", finite=False)
    bounds = {"threshold": (0, math.inf), "keep": (0, 1), "psnr": (0, 200)}[name]
    if not bounds[0] <= value <= bounds[1]:
        raise ArgumentError(f"{name} is {value}; give a number from {bounds[0]} to {bounds[1]}")
    return name, value
