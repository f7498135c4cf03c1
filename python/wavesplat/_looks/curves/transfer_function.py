"""Transfer functions: sample value -> opacity and colour; also as JSON.

Two piecewise-linear curves, looked up after reconstruction; constant beyond their first and last node.
Two nodes at the same value make a step.

    {"version": 1, "opacity_unit": 1.0,
     "opacity": [[150, 0], [400, 0.8]],
     "color": [[150, 0.8, 0.5, 0.3], [400, 1, 1, 0.9]]}

`"values": "fraction"` marks curves whose values are fractions of a volume's robust range; `value_scale` has others.
`"opacity_unit_share": 0.01` instead of a unit is a share of the longest side of the volume's box.
`"gradient_opacity": [[magnitude, factor], ...]` may be left out.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat import _native
from wavesplat._looks.curves import value_scale
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.volume.volume_like import VolumeLike, as_volume, volume_or_none
from wavesplat._public import public
from wavesplat._storage import json_texts
from wavesplat._system import values
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.curves.colormaps import Opacity
    from wavesplat._model.arguments.sampling import Composite
    from wavesplat._model.volume.volume import Volume
    from wavesplat._model.volume.wavelet_volume import WaveletVolume


@public
@dataclass(frozen=True, init=False)
class TransferFunction:
    """Opacity and colour of each sample value.

    Parameters
    ----------
    opacity : sequence of (value, alpha)
        Nodes in order of value. `alpha`, 0..1, is the opacity of a slab one `opacity_unit` thick; 1 is opaque at any
        thickness. A ray crosses a peak that touches 1 at a single value in no length: it weighs 0.1 % more than one
        of 0.9999.
    color : sequence of (value, red, green, blue)
        Nodes in order of value; 0..1, used as given (no gamma).
    opacity_unit : float, optional
        Thickness that the opacities belong to, world units.
        None takes the geometric mean of the volume's spacings.
    gradient_opacity : sequence of (magnitude, factor), optional
        Nodes in order of the gradient's magnitude, sample units per world unit. The factor, 0..1, scales the
        extinction: opacity alpha becomes 1 - (1 - alpha) ** factor, nearly factor * alpha where it is faint.
        Boundaries stand out where the curve rises from 0. Without nodes the gradient does not matter.

    Raises
    ------
    ArgumentError
        If a curve is empty or not in order, or an opacity, colour or factor is outside 0..1.

    Examples
    --------
    >>> import wavesplat as ws
    >>> tf = ws.TransferFunction(opacity=[(0, 0.0), (100, 1.0)], color=[(0, 1, 0, 0), (100, 1, 1, 1)])
    >>> tf([50]).tolist()  # red, green, blue, opacity
    [[1.0, 0.5, 0.5, 0.5]]
    """

    opacity: tuple[tuple[float, float], ...]
    color: tuple[tuple[float, float, float, float], ...]
    opacity_unit: float | None
    gradient_opacity: tuple[tuple[float, float], ...]
    _core: _native.TransferFunction = field(init=False, repr=False, compare=False)

    @takes_its_types
    def __init__(
        self,
        opacity: Iterable[Iterable[float]],
        color: Iterable[Iterable[float]],
        opacity_unit: float | None = None,
        gradient_opacity: Iterable[Iterable[float]] = (),
    ) -> None:
        # Checked at once, so that an error points at the line that made it.
        unit = None if opacity_unit is None else float(opacity_unit)
        opacity_nodes = _nodes(opacity, "opacity", ("value", "alpha"))
        color_nodes = _nodes(color, "color", ("value", "red", "green", "blue"))
        gradient_nodes = _nodes(gradient_opacity, "gradient_opacity", ("magnitude", "factor"))
        object.__setattr__(self, "gradient_opacity", gradient_nodes)
        object.__setattr__(self, "opacity", opacity_nodes)
        object.__setattr__(self, "color", color_nodes)
        object.__setattr__(self, "opacity_unit", unit)
        object.__setattr__(self, "_core", _native.TransferFunction(opacity_nodes, color_nodes, unit, gradient_nodes))

    def __repr__(self) -> str:
        values = sorted(node[0] for nodes in (self.opacity, self.color) for node in nodes)
        unit = "" if self.opacity_unit is None else f", per {self.opacity_unit:.4g}"
        by_gradient = ", by the gradient too" if self.gradient_opacity else ""
        return (
            f"<TransferFunction: values {values[0]:.4g} to {values[-1]:.4g}, {len(self.opacity)} nodes of opacity "
            f"up to {max(alpha for _, alpha in self.opacity):.4g}, {len(self.color)} of colour{unit}{by_gradient}>"
        )

    def __call__(self, values: ArrayLike) -> NDArray[np.float64]:
        """Colour and opacity of some sample values, shape (n, 4): red, green, blue, opacity per `opacity_unit`."""
        return self._core.evaluate(_floats(values).ravel())

    def _moved(self, offset: float) -> TransferFunction:
        """The same colours and opacities at values that are larger by `offset`."""
        opacity = [(value + offset, alpha) for value, alpha in self.opacity]
        color = [(value + offset, *rgb) for value, *rgb in self.color]
        return TransferFunction(opacity, color, self.opacity_unit, self.gradient_opacity)

    @classmethod
    @takes_its_types
    def auto(cls, volume: VolumeLike, composite: Composite = "over") -> TransferFunction:
        """A transfer function from the volume's histogram, for a first look at any kind of data.

        Parameters
        ----------
        volume : Volume, WaveletVolume, array, or what else `Volume` takes
            CT, MR, microscopy, simulation: any range, any units. Details alone get `diverging`.
        composite : str, default "over"
            The operator it is for; projections, such as "maximum", get greys for the values that they project to along
            the three index axes.

        Raises
        ------
        ArgumentError
            If all samples are equal: there is nothing to tell apart.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.TransferFunction.auto(ws.examples.ripples(16)).opacity[0][1]
        0.0
        """
        from wavesplat._looks.kinds import automatic

        function = automatic.automatic(as_volume(volume), composite).transfer_function
        assert isinstance(function, cls)
        return function

    @classmethod
    @takes_its_types
    def diverging(cls, limit: float, *, opacity: float = 0.5) -> TransferFunction:
        """A transfer function for signed values: blue below 0, red above, nothing near it.

        Parameters
        ----------
        limit : float
            Value, and minus it, of full colour and opacity.
        opacity : float, default 0.5
            Opacity there; from a tenth of the limit it rises evenly.

        Raises
        ------
        ArgumentError
            If the limit is not a positive finite number.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.TransferFunction.diverging(10).opacity
        ((-10.0, 0.5), (-1.0, 0.0), (1.0, 0.0), (10.0, 0.5))
        """
        if not 0 < limit < float("inf"):
            raise ArgumentError(f"limit is {limit}; give the value that gets full colour, a positive number")
        near = 0.1 * limit
        # Endpoints of Moreland's diverging map (2009), which keep their hue to the middle: pale colours hide in white.
        blue, red = (0.23, 0.30, 0.75), (0.71, 0.02, 0.15)
        return cls(
            [(-limit, opacity), (-near, 0.0), (near, 0.0), (limit, opacity)],
            [(-limit, *blue), (-near, 0.55, 0.69, 1.0), (near, 0.96, 0.6, 0.48), (limit, *red)],
        )

    @classmethod
    @takes_its_types
    def from_colormap(
        cls,
        name: str,
        volume: VolumeLike | None = None,
        *,
        clim: tuple[float | str, float | str] | None = None,
        opacity: Opacity = "linear",
        log: bool = False,
        gamma: float = 1.0,
        opacity_unit: float | None = None,
    ) -> TransferFunction:
        """The colours of a map by name over a range of values: "viridis", "inferno", "gray", "coolwarm_r", ...

        Parameters
        ----------
        name : str
            A map of matplotlib, cmocean, ColorBrewer, Crameri, napari or another collection of the package `cmap`; for
            one of a certain collection "cmocean:ice". "_r" turns it round. Case does not matter.
        volume : Volume or WaveletVolume, optional
            Needed if `clim` is not given.
        clim : (low, high), optional
            Values of the first and the last colour, or percentiles of the volume's samples ("1%"); None takes those
            that count as the volume's smallest and largest, for `log` as its smallest and largest of those above 0,
            with a warning if there are others.
        opacity : str, float, sequence of float, or sequence of (value, alpha)
            Opacity of a slab one `opacity_unit` thick: "linear", "sigmoid" or "sqrt" from 0 at low to 1 at high; one
            number everywhere; numbers evenly over the range; or nodes in sample values. Numbers are 0..1.
        log : bool
            Map colours to the logarithm of the values.
        gamma : float, default 1
            Colours and opacities go with ((value - low) / (high - low)) ** gamma: less than 1 brightens.
        opacity_unit : float, optional
            As for the class.

        Raises
        ------
        ArgumentError
            If there is no map of that name (the message offers near ones), or a range or an opacity cannot work.

        Warns
        -----
        WavesplatWarning
            If `log` is taken of a volume with values of 0 or less.

        Examples
        --------
        >>> import wavesplat as ws
        >>> tf = ws.TransferFunction.from_colormap("gray", clim=(0, 500), opacity=[0, 0.1, 0.5])
        >>> tf([250, 500])[:, [0, 3]].round(2).tolist()  # red and opacity
        [[0.5, 0.1], [1.0, 0.5]]
        """
        from wavesplat._looks.curves import colormaps

        return colormaps.transfer_function(
            name, volume_or_none(volume), clim=clim, opacity=opacity, log=log, gamma=gamma, opacity_unit=opacity_unit
        )

    @classmethod
    @takes_its_types
    def from_json(cls, text: str, volume: VolumeLike | None = None) -> TransferFunction:
        """The transfer function that a JSON text describes, as `to_json` writes it.

        Parameters
        ----------
        text : str
            An object with `version` 1, `opacity`, `color` and, optionally, `opacity_unit` and `gradient_opacity`.
            With `"values": "fraction"` its values are fractions of the volume's robust range, 0..1.
        volume : Volume, optional
            Needed when the values are fractions.

        Raises
        ------
        ArgumentError
            If it is not such a text; the message names the field.

        Examples
        --------
        >>> import wavesplat as ws
        >>> tf = ws.TransferFunction([(0, 0), (1, 1)], [(0, 1, 1, 1)])
        >>> ws.TransferFunction.from_json(tf.to_json()) == tf
        True
        """
        return parse(text, volume_or_none(volume))

    def to_json(self) -> str:
        """The transfer function as a JSON text, which `from_json` reads back exactly."""
        return write(self)

    @classmethod
    def load(
        cls, path: str | PathLike[str], volume: VolumeLike | None = None, name: str | None = None
    ) -> TransferFunction:
        """The transfer function of a look in a file, ours or one of 3D Slicer or ParaView; see `Look.load`.

        Parameters
        ----------
        path : path
            See `Look.load`.
        volume : Volume or WaveletVolume, optional
            Needed where values are relative to a volume's.
        name : str, optional
            Which one, if the file holds several.

        Raises
        ------
        FileError
            If the file cannot be read.
        ArgumentError
            If it does not describe a transfer function, or one of two dimensions, or holds several and none is named.
        """
        from wavesplat._looks.look import Look

        function = Look.load(path, volume, name).transfer_function
        if not isinstance(function, TransferFunction):
            raise ArgumentError(f"this transfer function is of gradients too; read it by Look.load: {path}")
        return function

    def save(self, path: str | PathLike[str]) -> None:
        """Write the transfer function to a JSON file.

        Raises
        ------
        FileError
            If the file cannot be written; nothing is left behind.
        """
        from wavesplat._storage import json_texts

        json_texts.save(path, self.to_json())

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.opacity, self.color, self.opacity_unit, self.gradient_opacity)


def _floats(values: ArrayLike) -> NDArray[np.float64]:
    try:
        return np.ascontiguousarray(np.atleast_1d(values), dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError("transfer function: values are no array of numbers; give the sample values") from None


def _nodes(nodes: Iterable[Iterable[Any]], curve: str, names: tuple[str, ...]) -> tuple[Any, ...]:
    """Tuples of floats from any nested sequence or array."""
    if not isinstance(nodes, Iterable):
        raise ArgumentError(f"transfer function: {curve} is {described(nodes)}; it must be nodes ({', '.join(names)})")
    checked = []
    for index, node in enumerate(nodes):
        form = f"{len(names)} numbers ({', '.join(names)})"
        numbers = values.numbers(node, f"transfer function: {curve} node {index}", form, n=len(names), finite=False)
        checked.append(numbers)
    return tuple(checked)


# Transfer functions as JSON: one object, with a version, whose errors name the field.

WHAT = "transfer function"


def write(transfer_function: TransferFunction) -> str:
    """JSON text of a transfer function; numbers read back exactly."""
    return json_texts.write(fields_of(transfer_function))


def fields_of(transfer_function: TransferFunction) -> dict[str, Any]:
    """The curves of a transfer function as the fields of its JSON object."""
    curves: dict[str, Any] = {
        "opacity_unit": transfer_function.opacity_unit,
        "opacity": transfer_function.opacity,
        "color": transfer_function.color,
    }
    if transfer_function.gradient_opacity:
        curves["gradient_opacity"] = transfer_function.gradient_opacity
    return curves


def parse(text: str, volume: Volume | WaveletVolume | None) -> TransferFunction:
    """The transfer function in a JSON text."""
    return build(json_texts.parse(text, WHAT, "opacity and color"), volume)


def build(
    document: dict[str, Any], volume: Volume | WaveletVolume | None, *, in_look: bool = False
) -> TransferFunction:
    """The transfer function that an object describes. `in_look`: it is a part of a look, and has no version."""
    scale, opacity, color, unit, gradient_opacity, share = _native.curves_fields(document, in_look)
    curves = TransferFunction(opacity, color, unit, gradient_opacity)
    if scale in value_scale.ABSOLUTE and share is None:
        return curves
    if volume is None:
        name = document.get("name", "these curves")
        raise ArgumentError(f"transfer function: {name} is relative to a volume's values; pass the volume too")
    if share is not None:
        lower, upper = volume.bounds
        unit = share * float(max(upper - lower))
    return TransferFunction(
        value_scale.nodes_on(scale, curves.opacity, volume),
        value_scale.nodes_on(scale, curves.color, volume),
        unit,
        value_scale.widths_on(scale, curves.gradient_opacity, volume),
    )
