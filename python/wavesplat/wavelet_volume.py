"""A volume as the wavelet coefficients that matter."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat.errors import ArgumentError
from wavesplat.volume import Volume

__all__ = ["WaveletVolume"]

#: What counts as the size of a coefficient.
NORMALISATIONS = ("l2", "peak")


class WaveletVolume:
    """A volume as its wavelet coefficients of large amplitude; made by `WaveletVolume.from_volume`.

    `render` draws it like a volume, all of it, only its coarse levels, or only details of chosen sizes.
    Level 0 holds the finest details, each further one details twice as large.

    Examples
    --------
    >>> import wavesplat as ws
    >>> wavelets = ws.WaveletVolume.from_volume(ws.examples.ripples(32), family="cdf53", threshold=12)
    >>> round(100 * wavelets.kept_fraction, 1)
    20.0
    """

    __slots__ = ("_core", "_drawn", "_family", "_name", "_shape", "_world_from_index")

    def __init__(self, core: _native.WaveletVolume, volume: Volume, family: str) -> None:
        self._core = core
        self._family = family
        self._name = volume.name
        self._shape = volume.shape
        self._world_from_index = volume.world_from_index
        #: The volume that was drawn last, and of which levels.
        self._drawn: tuple[tuple[float, ...], Volume] | None = None

    @classmethod
    def from_volume(
        cls,
        volume: Volume,
        family: str = "cdf97",
        *,
        threshold: float | None = None,
        keep: float | None = None,
        psnr: float | None = None,
        levels: int | None = None,
        normalisation: str = "l2",
    ) -> WaveletVolume:
        """The coefficients of a volume that matter.

        Parameters
        ----------
        volume : Volume
            All samples finite; they are taken as float32.
        family : str
            Biorthogonal, by lifting: "cdf97" (the best picture per coefficient), "cdf53" (linear B-spline), "haar",
            "spline4" (cubic B-spline). Semi-orthogonal on the interval: "bspline2", "bspline3", "bspline4", by order.
        threshold : float, optional
            Drop coefficients of less amplitude, in the units of the samples; 0, the default, drops nothing.
        keep : float, optional
            Keep this share of the coefficients instead, 0 to 1.
        psnr : float, optional
            Keep as few as give the samples back with this PSNR, in dB, its peak the range of the samples.
        levels : int, optional
            Levels of details; None is as many as there are.
        normalisation : str
            An amplitude is the coefficient times the norm of its basis function: "l2" (finest spacing 1), or "peak".

        Raises
        ------
        ArgumentError
            If a name is unknown, more than one of threshold, keep and psnr is given, a number is out of range, or
            samples are NaN or infinite.
        """
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
        if levels is not None and levels < 0:
            raise ArgumentError(f"levels is {levels}; give 0 or more, or nothing for as many as there are")
        how, amount = _what_stays(threshold, keep, psnr)
        samples = np.ascontiguousarray(volume.samples, dtype=np.float32)
        core = _native.WaveletVolume(
            samples, family=family, keep=how, amount=amount, levels=levels, peak=normalisation == "peak"
        )
        return cls(core, volume, family)

    @property
    def name(self) -> str:
        """What messages call the volume."""
        return self._name

    @property
    def family(self) -> str:
        """The wavelets."""
        return self._family

    @property
    def shape(self) -> tuple[int, int, int]:
        """Samples along (z, y, x)."""
        return self._shape

    @property
    def world_from_index(self) -> NDArray[np.float64]:
        """Affine from the index (x, y, z) of a sample to the world, shape (4, 4)."""
        return self._world_from_index

    @property
    def n_levels(self) -> int:
        """Levels of details."""
        return self._core.n_levels

    @property
    def threshold(self) -> float:
        """Coefficients of less amplitude were dropped."""
        return self._core.threshold

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
        """Bytes held for the coefficients and their places."""
        return self._core.n_bytes

    def to_volume(self, *, drop_levels: int = 0, band_weights: Sequence[float] | None = None) -> Volume:
        """The volume that the coefficients stand for, float32, on the grid it was made from.

        Parameters
        ----------
        drop_levels : int
            Leave out the details of this many levels, the finest first.
        band_weights : sequence of float, optional
            A factor for each level's details, the finest first, and as number `n_levels` for the coarsest
            samples; those not given are 1.

        Raises
        ------
        ArgumentError
            If there are not as many levels, or a weight is not finite.
        """
        weights = self._weights(drop_levels, band_weights)
        return Volume(self._core.samples(list(weights)), world_from_index=self._world_from_index, name=self._name)

    def _volume_to_draw(self, drop_levels: int, band_weights: Sequence[float] | None) -> Volume:
        """As `to_volume`; the one that was drawn last is kept."""
        weights = self._weights(drop_levels, band_weights)
        if self._drawn is None or self._drawn[0] != weights:
            self._drawn = None
            self._drawn = weights, self.to_volume(drop_levels=drop_levels, band_weights=band_weights)
        return self._drawn[1]

    def _weights(self, drop_levels: int, band_weights: Sequence[float] | None) -> tuple[float, ...]:
        n = self.n_levels
        if not 0 <= drop_levels <= n:
            raise ArgumentError(f"drop_levels is {drop_levels}; {self._name!r} has {n} levels, so give 0 to {n}")
        weights = [float(weight) for weight in (band_weights if band_weights is not None else ())]
        if len(weights) > n + 1 or not all(math.isfinite(weight) for weight in weights):
            raise ArgumentError(
                f"band_weights is {weights}; give at most {n + 1} finite numbers: one for each of the {n} levels of "
                f"{self._name!r}, the finest first, and one for the coarsest samples"
            )
        weights += [1.0] * (n + 1 - len(weights))
        return (0.0,) * drop_levels + tuple(weights[drop_levels:])

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
    value = float(value)
    bounds = {"threshold": (0, math.inf), "keep": (0, 1), "psnr": (0, 200)}[name]
    if not bounds[0] <= value <= bounds[1]:
        raise ArgumentError(f"{name} is {value}; give a number from {bounds[0]} to {bounds[1]}")
    return name, value
