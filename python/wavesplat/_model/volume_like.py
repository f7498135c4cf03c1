"""What functions take as a volume, made one at the door."""

from __future__ import annotations

from typing import TypeAlias

from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume

__all__ = ["VolumeLike", "as_volume", "volume_or_none"]

#: A `Volume`, a `WaveletVolume`, or an object of another library that `Volume` takes; `as_volume` says which it is.
VolumeLike: TypeAlias = object


def as_volume(thing: VolumeLike, name: str | None = None, *, argument: str = "volume") -> Volume | WaveletVolume:
    """The volume itself, or one of what another library holds: samples, place, unit and anatomy as it says them.

    name : what messages call the volume; of an object that has one, its own.
    argument : what messages call the argument.
    """
    if isinstance(thing, Volume | WaveletVolume):
        return thing
    return Volume._of(thing, name, argument)


def volume_or_none(thing: VolumeLike | None) -> Volume | WaveletVolume | None:
    """`as_volume` of an argument that may be left out."""
    return None if thing is None else as_volume(thing)
