"""Transfer functions of two dimensions: value and gradient, or the values of two fields -> opacity and colour.

The boundary of two materials passes through all values between theirs, so a value alone cannot distinguish it from a
third material; at a boundary the gradient is large, inside a material it is small.
Sources: Levoy, Display of surfaces from volume data, 1988; Kniss, Kindlmann and Hansen, Interactive volume rendering
using multi-dimensional transfer functions, 2001.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wavesplat import _native
from wavesplat._looks.curves import colors
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._public import public
from wavesplat._system import values
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

WHAT = "two-dimensional transfer function"
#: Ratio of the gradient at which a surface is whole to the least gradient at which there is one.
FADE = 1.5
ROWS = ("gradient", "field")


@public
@dataclass(frozen=True, init=False, eq=False)
class TransferFunction2D:
    """Opacity and colour by sample value and magnitude of the gradient, or by the values of two fields.

    A table, bilinear between its nodes.

    Parameters
    ----------
    values : sequence of float
        Sample values of the table's columns, in order; constant beyond the first and the last.
    magnitudes : sequence of float
        Magnitudes of the gradient of its rows, sample units per world unit, 0 or more, in order; constant beyond. With
        rows="field" values of the second field, in its units.
    rgba : array, shape (magnitudes, values, 4)
        Red, green, blue and opacity, 0..1. Opacity is that of a slab one `opacity_unit` thick.
        Colour is interpolated on its own, so give clear nodes the colour of their neighbours.
    opacity_unit : float, optional
        Thickness that the opacities belong to, world units.
        None takes the geometric mean of the volume's spacings.
    rows : "gradient" or "field", default "gradient"
        What the rows are: magnitudes of the gradient, or values of the field that colours a layer,
        `Layer(volume, function, color_from=field)`.

    Raises
    ------
    ArgumentError
        If the nodes are not in order, the shape does not fit, or a number is outside 0..1.

    Examples
    --------
    Only where the gradient exceeds 20 per unit of length:

    >>> import numpy as np, wavesplat as ws
    >>> rgba = np.ones((3, 2, 4))
    >>> rgba[:2, :, 3] = 0
    >>> tf = ws.TransferFunction2D([0, 255], [0, 20, 30], rgba)
    >>> tf([100, 100], [10, 25])[:, 3].tolist()
    [0.0, 0.5]

    Of two fields: opaque where the first exceeds 10 and the second is negative:

    >>> rgba = [[[1, 1, 1, 0], [0, 0, 1, 1]], [[1, 1, 1, 0], [1, 0, 0, 0]]]
    >>> tf = ws.TransferFunction2D([9, 10], [-1, 1], rgba, rows="field")
    >>> tf(10, [-1, 0, 1])[:, 3].round(2).tolist()
    [1.0, 0.5, 0.0]
    """

    values: tuple[float, ...]
    magnitudes: tuple[float, ...]
    rgba: NDArray[np.float64]
    opacity_unit: float | None
    rows: Literal["gradient", "field"]
    _core: _native.TransferFunction = field(init=False, repr=False)

    @takes_its_types
    def __init__(
        self,
        values: Iterable[float],
        magnitudes: Iterable[float],
        rgba: ArrayLike,
        opacity_unit: float | None = None,
        *,
        rows: Literal["gradient", "field"] = "gradient",
    ) -> None:
        if rows not in ROWS:
            raise ArgumentError(f"{WHAT}: rows is {described(rows)}; give {' or '.join(map(repr, ROWS))}")
        columns, places = _numbers(values, "values"), _numbers(magnitudes, "magnitudes")
        try:
            table = np.array(rgba, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise ArgumentError(f"{WHAT}: rgba is no array of numbers; give shape (magnitudes, values, 4)") from None
        if table.shape != (len(places), len(columns), 4):
            raise ArgumentError(
                f"{WHAT}: rgba has shape {table.shape}; with {len(places)} magnitudes and {len(columns)} values it "
                f"must be ({len(places)}, {len(columns)}, 4)"
            )
        table.flags.writeable = False
        unit = None if opacity_unit is None else float(opacity_unit)
        # Checked at once, so that an error points at the line that made it.
        core = _native.TransferFunction.two_dimensional(
            columns, places, [(r, g, b, a) for r, g, b, a in table.reshape(-1, 4).tolist()], unit, rows == "field"
        )
        for name, value in zip(self.__dataclass_fields__, (columns, places, table, unit, rows, core), strict=True):
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        rows = "magnitudes" if self.rows == "gradient" else "values of a second field"
        return (
            f"<TransferFunction2D: {len(self.values)} values {self.values[0]:.4g} to {self.values[-1]:.4g}, "
            f"{len(self.magnitudes)} {rows} {self.magnitudes[0]:.4g} to {self.magnitudes[-1]:.4g}>"
        )

    def __call__(self, values: ArrayLike, magnitudes: ArrayLike) -> NDArray[np.float64]:
        """Colour and opacity of pairs of value and magnitude, shape (n, 4); the two are broadcast."""
        pairs = np.broadcast_arrays(np.asarray(values, np.float64), np.asarray(magnitudes, np.float64))
        flat_values, flat_magnitudes = (np.ascontiguousarray(flat).ravel() for flat in pairs)
        return self._core.evaluate_at(flat_values, flat_magnitudes)

    def _moved(self, offset: float) -> TransferFunction2D:
        """The same colours and opacities at values that are larger by `offset`."""
        moved = [v + offset for v in self.values]
        return TransferFunction2D(moved, self.magnitudes, self.rgba, self.opacity_unit, rows=self.rows)

    def _with_rgba(self, rgba: NDArray[np.float64]) -> TransferFunction2D:
        """The function with another table at the same nodes."""
        return TransferFunction2D(self.values, self.magnitudes, rgba, self.opacity_unit, rows=self.rows)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TransferFunction2D):
            return NotImplemented
        return (self.values, self.magnitudes, self.opacity_unit, self.rows) == (
            other.values,
            other.magnitudes,
            other.opacity_unit,
            other.rows,
        ) and np.array_equal(self.rgba, other.rgba)

    def __hash__(self) -> int:
        return hash((self.values, self.magnitudes, self.opacity_unit, self.rows, self.rgba.tobytes()))

    @classmethod
    @takes_its_types
    def boundaries(
        cls,
        boundaries: Sequence[tuple[float, float, float, Any, float]],
        *,
        opacity_unit: float | None = None,
        n_values: int = 256,
    ) -> TransferFunction2D:
        """Surfaces at values, as wide as the gradient makes them: Levoy's triangles.

        Where the gradient is large, a surface covers many values; where it is small, few.
        So a surface looks equally thick everywhere.

        Parameters
        ----------
        boundaries : sequence of (value, thickness, least, color, opacity)
            The surface is opaque by `opacity` at `value`, and fades to nothing where the value differs by the gradient
            times `thickness` (world units, half the thickness of the surface). Where the gradient is below `least`
            (sample units per world unit) there is no surface; from there to a half more it fades in. Of surfaces that
            overlap the more opaque one shows. Surfaces thinner than a voxel need more sheets than usual.
        opacity_unit : float, optional
            As for the table.
        n_values : int, default 256
            Columns of the table.

        Raises
        ------
        ArgumentError
            If a boundary is not five such numbers, or a thickness is not positive.

        Examples
        --------
        >>> import wavesplat as ws
        >>> bone = ws.TransferFunction2D.boundaries([(300, 1.0, 100, "#fff2d9", 0.6)])
        >>> bone([300, 300, 380], [50, 200, 160])[:, 3].round(2).tolist()
        [0.0, 0.6, 0.3]
        """
        checked = [_boundary(boundary, number) for number, boundary in enumerate(boundaries)]
        if not checked:
            raise ArgumentError(f"{WHAT}: no boundary is given; give (value, thickness, least, color, opacity)")
        # Rows end where every surface covers all values around its neighbours; beyond, nothing changes.
        centres = [value for value, *_ in checked]
        spread = max(max(centres) - min(centres), *(4 * thickness * least for _, thickness, least, *_ in checked), 1e-9)
        most = max(spread / thickness for _, thickness, *_ in checked)
        rows = sorted({*np.linspace(0.0, most, 65), *(m for b in checked for m in (b[2], b[2] * FADE))})
        columns = np.unique([*np.linspace(min(centres) - spread, max(centres) + spread, n_values), *centres])
        table = np.zeros((len(rows), len(columns), 4))
        nearest = np.argmin([np.abs(columns - value) / thickness for value, thickness, *_ in checked], axis=0)
        table[:, :, :3] = np.array([color for *_, color, _ in checked])[nearest]
        for value, thickness, least, color, opacity in checked:
            for row, magnitude in enumerate(rows):
                if magnitude <= least:
                    continue
                risen = min((magnitude / least - 1) / (FADE - 1), 1.0) if least > 0 else 1.0
                alpha = opacity * risen * np.clip(1 - np.abs(columns - value) / (thickness * magnitude), 0, 1)
                wins = alpha > table[row, :, 3]
                table[row, wins, :3], table[row, wins, 3] = color, alpha[wins]
        return cls(columns.tolist(), rows, table, opacity_unit)

    @classmethod
    @takes_its_types
    def from_json(cls, text: str) -> TransferFunction2D:
        """The function that a JSON text describes, as `to_json` writes it.

        Raises
        ------
        ArgumentError
            If it is not such a text; the message names the field.

        Examples
        --------
        >>> import wavesplat as ws
        >>> tf = ws.TransferFunction2D([0, 1], [0], [[[1, 0, 0, 0], [1, 1, 1, 0.5]]])
        >>> ws.TransferFunction2D.from_json(tf.to_json()) == tf
        True
        """
        from wavesplat._storage import json_texts

        return cls._of_fields(json_texts.parse(text, WHAT, "values, magnitudes and rgba"))

    @classmethod
    def _of_fields(cls, document: dict[str, Any]) -> TransferFunction2D:
        """The function that a JSON object describes."""
        columns, places, rgba, unit, is_of_fields = _native.table_fields(document)
        table = np.array(rgba).reshape(len(places), len(columns), 4)
        return cls(columns, places, table, unit, rows="field" if is_of_fields else "gradient")

    def to_json(self) -> str:
        """The function as a JSON text, which `from_json` reads back exactly."""
        return json.dumps({"version": 1, **self._fields()}) + "\n"

    def _fields(self) -> dict[str, Any]:
        """The table as the fields of its JSON object."""
        table = {"opacity_unit": self.opacity_unit, "values": self.values, "magnitudes": self.magnitudes}
        rows = {} if self.rows == "gradient" else {"rows": self.rows}
        return {**table, **rows, "rgba": self.rgba.tolist()}

    @classmethod
    def load(cls, path: str | PathLike[str]) -> TransferFunction2D:
        """The function in a JSON file; see `from_json`.

        Raises
        ------
        FileError
            If the file cannot be read.
        ArgumentError
            If it does not describe such a function.
        """
        from wavesplat._storage import json_texts as json_object

        return json_object.load(path, WHAT, cls.from_json)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the function to a JSON file.

        Raises
        ------
        FileError
            If the file cannot be written; nothing is left behind.
        """
        from wavesplat._storage import output

        text = self.to_json()
        output.write_atomically(path, lambda part: part.write_text(text, encoding="utf-8"))

    def __reduce__(self) -> tuple[Any, ...]:
        made = partial(type(self), rows=self.rows)
        return made, (self.values, self.magnitudes, self.rgba, self.opacity_unit)


def _numbers(numbers: Iterable[float], what: str) -> tuple[float, ...]:
    return values.numbers(numbers, f"{WHAT}: {what}", "numbers in order", finite=False)


def _boundary(boundary: Any, number: int) -> tuple[float, float, float, tuple[float, float, float], float]:
    form = "(value, thickness, least, color, opacity)"
    try:
        value, thickness, least, color, opacity = boundary
        value, thickness, least, opacity = (float(x) for x in (value, thickness, least, opacity))
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"{WHAT}: boundary {number} is {described(boundary, lists=True)}; give {form}") from None
    if not (0 < thickness < np.inf and 0 <= least < np.inf and np.isfinite(value)):
        raise ArgumentError(
            f"{WHAT}: boundary {number} is {described(boundary, lists=True)}; the thickness must be positive, "
            "the least gradient 0 or more"
        )
    rgba = colors.parse(color)
    if rgba is None:
        raise ArgumentError(f"{WHAT}: boundary {number} has no colour; give (r, g, b), #rrggbb or a name")
    return value, thickness, least, rgba[:3], opacity
