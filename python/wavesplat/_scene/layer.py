"""A volume of a scene, and how it is shown."""

from __future__ import annotations

from collections.abc import Iterable
from copy import copy
from dataclasses import KW_ONLY, dataclass, replace
from operator import index
from typing import Any, TypeAlias

from wavesplat._looks.curves.materials import Materials
from wavesplat._looks.curves.transfer_function import TransferFunction
from wavesplat._looks.curves.transfer_function_2d import TransferFunction2D
from wavesplat._looks.kinds import overlays
from wavesplat._looks.layer_names import FoundName, layer_name_of
from wavesplat._looks.look import Look
from wavesplat._looks.over_time import brightest
from wavesplat._model.arguments.types import check_text, takes_its_types, text_of
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.volume_like import as_volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._public import public
from wavesplat._system.values import described, share
from wavesplat.errors import ArgumentError

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
        own for channels of fluorescence; volumes over another one, such as PET over CT, get the colours of a map.
        Presets, and looks for projections, that are opaque from the lowest value on are made clear there where the
        layer lies over another one, so that they do not hide it. Looks of one's own for "over", and transfer functions,
        are drawn as they are. `Layer.overlay` makes layers with looks by name.
    visible : bool, default True
        Layers that are not visible are left out.
    opacity : float, 0..1, default 1
        Multiplies the opacities of the transfer function; of projections, the light that is added. 0 leaves it out.
    time : int, default 0
        Which volume of a series.
    name : str, optional
        What legends and messages call it; None is the name of the volume. Scans of patients are then called by channel,
        quantity or modality ("CT"), not by their files, and where a scene has two of one name, by description or number
        too.
    color_from : Layer, Volume, Series, array, or what else `Volume` takes, optional
        A second field, whose values give the colours, while the values of `volume` say how opaque it is, or where
        its surface lies (`FirstHit`): density coloured by temperature. A `Layer` gives the colours of its look, in
        values of its own volume; the opacities of that look count for nothing. Without a look one is chosen by the kind
        of data. Of a series it is the volume of this layer's `time`. The field has its own samples and must cover
        `volume`; where either value is missing (NaN), nothing is drawn. With a `TransferFunction2D(..., rows="field")`
        as `look` both fields decide opacity and colour together. Both must be in memory. The labels of a segmentation
        have the colour of the field's mean over each of them; without a look "viridis", from the least mean to the
        largest. None colours the layer by its own values.

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

    One field coloured by another:

    >>> height = ws.Volume(np.indices((8, 8, 8))[0].astype(np.float32), name="height")
    >>> ws.render(ws.Scene(ws.Layer(a, color_from=height)), size=(32, 32)).report["shown"][0]["name"]
    'height'
    """

    volume: Any
    look: AnyLook = None
    _: KW_ONLY
    visible: bool = True
    opacity: float = 1.0
    time: int = 0
    name: str | None = None
    color_from: Any = None

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
        object.__setattr__(self, "opacity", share(self.opacity, "opacity of the layer"))
        is_found = self.name is None or isinstance(self.name, FoundName)
        name = layer_name_of(self.volume, self.time) if is_found else text_of(self.name, "name of the layer")
        object.__setattr__(self, "name", name)
        check_text(self.name, "name of the layer")
        if self.color_from is not None:
            object.__setattr__(self, "color_from", _color_layer(self.color_from, self.time))

    @classmethod
    @takes_its_types
    def overlay(
        cls,
        volume: Any,
        look: str | None = None,
        window: Iterable[float | str] | None = None,
        *,
        threshold: float | None = None,
        opacity: float = 1.0,
        time: int = 0,
        name: str | None = None,
    ) -> Layer:
        """A layer that lies over another one, clear where its values are least: PET over CT.

        Parameters
        ----------
        volume, opacity, time, name
            As for `Layer`.
        look : str, optional
            A colour map (see `TransferFunction.from_colormap`), a colour, as for `Look.channel`, or a preset. None is
            "gray" where there is a window, else the look of a layer without one.
        window : (low, high), optional
            Values up to the first are clear, and opacity rises to the second: numbers, or percentiles of the samples,
            such as ("1%", "99.8%"). Of a diverging map: the ends of the map
            where they have two signs, clear about 0; else a dead zone of both signs: (3, 10) is clear from -3 to 3, and
            opaque at -10 and 10. None: the values that count as the volume's smallest and largest, of a diverging map
            as far from 0 as the farthest; the lowest twelfth is clear. Presets have values of their own.
        threshold : float, optional
            Hide values below it, and show all others as opaque as the layer is, instead of opacity that rises over the
            window: a statistic above its threshold. Of looks that show values of two signs it hides those between
            -threshold and threshold. Without look and window the map is "coolwarm" or, without negative values, "hot".

        Raises
        ------
        ArgumentError
            If there is no such look, or the window cannot work.

        Examples
        --------
        >>> import wavesplat as ws
        >>> layer = ws.Layer.overlay(ws.examples.ripples(16), "coolwarm", (0.3, 1))
        >>> layer.look.transfer_function.opacity
        ((-1.0, 1.0), (-0.3, 0.0), (0.3, 0.0), (1.0, 1.0))
        """
        layer = cls(volume, opacity=opacity, time=time, name=name)
        name = None if look is None or look.lower() == "auto" else look
        if name is None and window is None and threshold is None:
            return layer
        return replace(layer, look=overlays.overlay(layer.looked_at, name, window, threshold))

    @property
    def _has_own_name(self) -> bool:
        """Whether the name differs from the one that the layer would get by default."""
        return self.name != layer_name_of(self.volume, self.time)

    def _with_name(self, name: str) -> Layer:
        """The layer under a name that was found, which `dataclasses.replace` would look for again."""
        made = copy(self)
        object.__setattr__(made, "name", name)
        return made

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


def _color_layer(given: object, time: int) -> Layer:
    """The field that colours a layer, as a layer of its own."""
    layer = given if isinstance(given, Layer) else Layer(given)
    if layer.color_from is not None:
        raise ArgumentError(
            f"color_from is the layer {layer.name!r}, which has a color_from itself; give the field of its colours"
        )
    return replace(layer, time=time) if isinstance(layer.volume, Series) else layer


def drawable(given: object) -> Volume | WaveletVolume:
    """An argument as a volume that can be drawn."""
    return as_volume(given)


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
