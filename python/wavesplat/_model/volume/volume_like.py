"""Arguments that functions take as a volume, converted to one on entry."""

from __future__ import annotations

from typing import TypeAlias

from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume

#: A `Volume`, a `WaveletVolume`, or an object of another library that `Volume` takes; `as_volume` converts it.
VolumeLike: TypeAlias = object


def as_volume(thing: VolumeLike, name: str | None = None, *, argument: str = "volume") -> Volume | WaveletVolume:
    """The volume itself, or the volume of another library's object, with its samples, place, unit and anatomy.

    name : name of the new volume in messages; None is the object's own.
    argument : name of the argument in messages.
    """
    if isinstance(thing, Volume | WaveletVolume):
        return thing
    return Volume._of(thing, name, argument)


def volume_or_none(thing: VolumeLike | None) -> Volume | WaveletVolume | None:
    """`as_volume` of an argument that may be left out."""
    return None if thing is None else as_volume(thing)
