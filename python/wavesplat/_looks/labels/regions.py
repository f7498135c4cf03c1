"""Regions as closed lines, of a structure set of radiotherapy or of one's own."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks.curves import colors
from wavesplat._looks.labels.structure_labels import chosen_structures
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._public import public
from wavesplat._readers.dicom.structures import is_structure_set, structures_in
from wavesplat._storage.paths import expanded
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, FileError

#: Coordinates that no point has: their squares are still far from the end of float64.
FAR = 1e15


@public
@dataclass(frozen=True, init=False, eq=False)
class Region:
    """A region that closed lines enclose, such as an organ as a radiotherapist drew it, slice by slice.

    Parameters
    ----------
    lines : sequence of arrays (points, 3)
        Points x, y, z of each line in the world, three at least; the last one is joined to the first.
    color : colour
        (r, g, b), "#rrggbb" or a name.
    name : str
        Such as "liver".
    is_of_patient : bool, default False
        Whether the points are a patient's, RAS in millimetres, whatever the unit of the scan.

    Raises
    ------
    ArgumentError
        If one of them cannot be.

    Examples
    --------
    >>> import wavesplat as ws
    >>> scan = ws.examples.ct_pelvis()
    >>> square = [(-20, 130, 260), (20, 130, 260), (20, 170, 260), (-20, 170, 260)]
    >>> picture = ws.slice(scan, "axial", 260, contours=[ws.Region([square], "yellow", name="target")])
    >>> picture.report["lines"]
    [{'name': 'target', 'color': [1.0, 1.0, 0.0]}]
    """

    lines: tuple[NDArray[np.float64], ...]
    color: tuple[float, float, float]
    name: str
    is_of_patient: bool

    @takes_its_types
    def __init__(
        self, lines: Sequence[Any], color: str | Iterable[float], *, name: str = "", is_of_patient: bool = False
    ) -> None:
        rgba = colors.parse(color)
        if rgba is None:
            raise ArgumentError(f"region {name!r}: the colour is {described(color)}; give (r, g, b), #rrggbb or a name")
        try:
            found = tuple(np.array(line, np.float64) for line in lines)
        except (TypeError, ValueError, OverflowError):
            found = (np.zeros(0),)
        for line in found:
            if line.ndim != 2 or line.shape[1] != 3 or len(line) < 3 or not (np.abs(line) < FAR).all():
                raise ArgumentError(f"region {name!r}: a line is no list of three or more finite points x, y, z")
        given = {"lines": found, "color": rgba[:3], "name": str(name), "is_of_patient": bool(is_of_patient)}
        for attribute, value in given.items():
            object.__setattr__(self, attribute, value)

    @classmethod
    def open(cls, path: str | PathLike[str], *, segments: Iterable[str | int] | None = None) -> list[Region]:
        """The regions of a structure set of radiotherapy (RTSTRUCT), in RAS, mm, with their names and colours.

        Parameters
        ----------
        path : path
            The DICOM file.
        segments : sequence of str or int, optional
            Which ones, by name, by a pattern of names such as "rib*", or by number (ROINumber); all if not given.

        Raises
        ------
        FileError
            If the file is no structure set, cannot be read, or has no closed lines of these regions.
        ArgumentError
            If there is no such region.

        Warns
        -----
        FileWarning
            If a region has no closed lines, and is left out.
        """
        file = expanded(path)
        if not is_structure_set(file):
            raise FileError(f"the file is no structure set (RTSTRUCT), or is not there; name one: {path}")
        chosen = None if segments is None else [segments] if isinstance(segments, str) else list(segments)
        regions = []
        for place, one in enumerate(chosen_structures(structures_in(file), chosen, file, has_outline=True)):
            if one.lines:
                color = one.color or _native.label_color(place)
                regions.append(cls(one.lines, color, name=one.name, is_of_patient=True))
        return regions

    def __repr__(self) -> str:
        return f"<Region {self.name!r}: {len(self.lines)} lines>"
