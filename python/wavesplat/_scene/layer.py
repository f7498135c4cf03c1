"""A volume of a scene, and how it is shown."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from math import isfinite
from operator import index
from typing import Any, TypeAlias

from wavesplat._looks.look import Look
from wavesplat._looks.materials import Materials
from wavesplat._looks.over_time import brightest
from wavesplat._looks.transfer_function import TransferFunction
from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat._model.argument_types import check_text, described, text_of
from wavesplat._model.series import Series
from wavesplat._model.volume import Volume
from wavesplat._model.volume_like import as_volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._public import public
from wavesplat.errors import ArgumentError

__all__ = ["AnyLook", "Layer", "drawable"]

AnyLook: TypeAlias = Look | TransferFunction | TransferFunction2D | Materials | str | None


@public
@dataclass(frozen=True)
class Layer:
    """A volume of a scene, and how it is shown.

    Parameters
    ----------
    volume : Volume, WaveletVolume, Series, array, or what else `Volume` takes
        What is shown. Of an open series, `time` says which volume.
    look : Look, TransferFunction, TransferFunction2D, Materials or str, optional
        How its values are shown; a text is the name of a preset. None chooses by the kind of data, and colours of their
        own for channels of fluorescence.
    visible : bool, default True
        Layers that are not visible are left out.
    opacity : float, 0..1, default 1
        Multiplies the opacities of the transfer function; of projections, the light that is added. 0 leaves it out.
    time : int, default 0
        Which volume of a series.
    name : str, optional
        What legends and messages call it; None is the name of the volume.

    Raises
    ------
    ArgumentError
        If the volume is none, or a number is out of range.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> a, b = ws.examples.ripples(8), ws.Volume(np.eye(8, dtype=np.uint8)[None].repeat(8, axis=0))
    >>> scene = ws.Scene([ws.Layer(a, name="a"), ws.Layer(b, "grey", opacity=0.5, name="b")])
    >>> [layer.name for layer in scene.layers]
    ['a', 'b']
    """

    volume: Any
    look: AnyLook = None
    _: KW_ONLY
    visible: bool = True
    opacity: float = 1.0
    time: int = 0
    name: str | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", _place(self.time))
        object.__setattr__(self, "volume", self.volume if isinstance(self.volume, Series) else drawable(self.volume))
        look = self.look
        if not (look is None or isinstance(look, Look | TransferFunction | TransferFunction2D | Materials | str)):
            raise ArgumentError(
                f"look is {described(look)}; give a wavesplat.Look, a TransferFunction, Materials or the name of a "
                "preset"
            )
        object.__setattr__(self, "visible", _flag(self.visible))
        object.__setattr__(self, "opacity", _share(self.opacity))
        object.__setattr__(
            self, "name", self.volume.name if self.name is None else text_of(self.name, "name of the layer")
        )
        check_text(self.name, "name of the layer")

    @property
    def drawn(self) -> Volume | WaveletVolume:
        """The volume itself, of a series the one of its time."""
        volume: Volume | WaveletVolume = self.volume
        return self.volume[self.time] if isinstance(self.volume, Series) else volume

    @property
    def looked_at(self) -> Volume | WaveletVolume:
        """The volume whose values choose a look: of a series one for all times, so that nothing flickers."""
        return brightest(self.volume) if isinstance(self.volume, Series) else self.drawn

    @property
    def is_shown(self) -> bool:
        """Whether the layer is visible, with an opacity above 0."""
        return self.visible and self.opacity > 0


def drawable(given: object) -> Volume | WaveletVolume:
    """An argument as a volume that can be drawn."""
    return as_volume(given)


def _share(number: object) -> float:
    try:
        share = float(number)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        share = float("nan")
    if isinstance(number, str) or not (isfinite(share) and 0 <= share <= 1):
        raise ArgumentError(f"opacity of the layer is {described(number)}; give a number 0..1")
    return share


def _flag(given: object) -> bool:
    try:
        return bool(given)
    except (TypeError, ValueError):
        raise ArgumentError(f"visible of the layer is {described(given)}; give True or False") from None


def _place(number: object) -> int:
    try:
        return index(number)  # type: ignore[arg-type]
    except TypeError:
        raise ArgumentError(f"time of the layer is {described(number)}; give a whole number, from 0") from None
