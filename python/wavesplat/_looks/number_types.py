"""Whether samples are whole numbers, with or without a sign, or floating-point numbers: their type says it.

It is the type that they have in memory, wherever they lie: 64-bit integers that are read in parts are read as float64.
"""

from __future__ import annotations

from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume


def numbers_of(volume: Volume | WaveletVolume) -> str:
    """The kind of the samples' type, as NumPy names it: "u", "i" or "f", as coefficients of wavelets have it."""
    return "f" if isinstance(volume, WaveletVolume) else volume._type_in_memory.kind
