"""`--suv` for pictures of several volumes: those that are PET are in SUV, the others as they are."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, TypeVar

from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from wavesplat._model.volume import Volume
    from wavesplat._model.wavelet_volume import WaveletVolume
    from wavesplat._scene.scene import Scene

__all__ = ["check_uptake", "in_uptake"]

T = TypeVar("T")


def in_uptake(opened: Callable[[bool], T], modality_of: Callable[[T], str | None], *, suv: bool, is_alone: bool) -> T:
    """A volume in SUV where `suv` asks for it; as it is where it is no PET and others are drawn with it.

    opened : opens the volume, in SUV or not.
    """
    if not suv or is_alone:
        return opened(suv)
    try:
        return opened(True)
    except (ArgumentError, FileError):
        plain = opened(False)  # which says what else is wrong
        if modality_of(plain) == "PT":
            raise
        return plain


def check_uptake(scene: Scene, *, suv: bool, others: Iterable[Volume | WaveletVolume] = ()) -> None:
    """Raise an `ArgumentError` if `--suv` is given and no volume is in SUV. `others`: volumes beside the layers."""
    if suv and not any(one.value_unit == "SUV" for one in (*(layer.drawn for layer in scene.layers), *others)):
        raise ArgumentError("--suv is for PET of DICOM, and no volume of the picture is one; leave it out")
