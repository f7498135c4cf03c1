"""Mosaics of Siemens' MR scanners: the slices of a volume side by side in one picture, row by row.

Their number, and the direction in which they follow each other, stand in private elements: NumberOfImagesInMosaic
(0019,xx0A), and the vendor's own header (CSA), which nibabel parses. ImagePositionPatient is the corner of a slice of
the whole picture's size around the first slice's centre, so half of the difference of sizes is added; see
https://nipy.org/nibabel/dicom/dicom_mosaic.html.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from wavesplat._readers.dicom_values import as_numbers, as_text, raw_value
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["MOSAIC", "Tiles", "positions_of", "slices_in", "tiles_of"]

#: The word for these pictures in the image type.
MOSAIC = "MOSAIC"
#: The tag of the number of slices, and of the name of the block that it is in.
N_SLICES, CREATOR = 0x0019100A, (0x00190010, "SIEMENS MR HEADER")

Numbers = TypeVar("Numbers", bound=np.generic)


@dataclass(frozen=True)
class Tiles:
    """Slices side by side in a picture: their number, that in a row, and the direction from one to the next."""

    n: int
    n_per_row: int
    direction: NDArray[np.float64] | None

    def size_of_one(self, size: tuple[int, int]) -> tuple[int, int]:
        """Columns and rows of a slice. `size`: those of the picture."""
        return size[0] // self.n_per_row, size[1] // self.n_per_row


def tiles_of(dataset: Dataset, size: tuple[int, int], file: Path) -> Tiles | None:
    """The slices of a mosaic; None where their number is not said. `size`: columns and rows of the picture."""
    n, direction = _said(dataset)
    if n < 2:
        return None
    n_per_row = math.isqrt(n - 1) + 1
    if size[0] % n_per_row or size[1] % n_per_row:
        raise FileError(
            f"the file holds a mosaic (Siemens) of {n} slices, whose {size[0]} x {size[1]} pixels are no multiple of "
            f"{n_per_row}; export it again: {file}"
        )
    return Tiles(n, n_per_row, direction)


def positions_of(
    tiles: Tiles,
    size: tuple[int, int],
    position: NDArray[np.float64],
    orientation: NDArray[np.float64],
    steps: tuple[float, float, float],
) -> NDArray[np.float64]:
    """Positions of the slices, LPS, from those of the whole picture.

    size : columns and rows of the picture. steps : distances of columns, rows and slices, mm.
    """
    along_row, along_column = orientation[:3], orientation[3:]
    columns, rows = tiles.size_of_one(size)
    normal = np.cross(along_row, along_column)
    across = normal if tiles.direction is None or tiles.direction @ normal >= 0 else -normal
    with np.errstate(over="ignore", invalid="ignore"):  # of distances that cannot be, which are told later
        first = position + along_row * (steps[0] * (size[0] - columns) / 2)
        first = first + along_column * (steps[1] * (size[1] - rows) / 2)
        positions: NDArray[np.float64] = first + np.arange(tiles.n)[:, None] * (steps[2] * across)
    return positions


def slices_in(picture: NDArray[Numbers], tiles: Tiles) -> NDArray[Numbers]:
    """The slices of a mosaic [rows, columns], shape (slices, rows, columns)."""
    side = tiles.n_per_row
    rows, columns = picture.shape[0] // side, picture.shape[1] // side
    apart = picture.reshape(side, rows, side, columns).swapaxes(1, 2)
    return apart.reshape(side * side, rows, columns)[: tiles.n]


def _said(dataset: Dataset) -> tuple[int, NDArray[np.float64] | None]:
    """Number of slices, 0 where it is not said, and the direction from one to the next, None where it is not said."""
    tags = _of_vendor(dataset)
    found = tags.get("NumberOfImagesInMosaic") or []
    if as_text(raw_value(dataset, CREATOR[0])).startswith(CREATOR[1]):
        found = as_numbers(raw_value(dataset, N_SLICES), "u2") or found
    normal = np.array(tags.get("SliceNormalVector") or [], np.float64)
    is_direction = normal.shape == (3,) and np.isfinite(normal).all() and normal.any()
    return int(found[0]) if found else 0, normal if is_direction else None


def _of_vendor(dataset: Dataset) -> dict[str, list[Any]]:
    """Values of the vendor's header (CSA) by name; empty where there is none that can be read."""
    with warnings.catch_warnings():
        # Of nibabel: that its readers of DICOM are new, and of what it finds in damaged headers.
        warnings.simplefilter("ignore")
        from nibabel.nicom import csareader

        try:
            found = csareader.get_csa_header(dataset)
            return {} if found is None else {name: tag["items"] for name, tag in found["tags"].items()}
        except Exception:  # noqa: BLE001 - parsers of damaged headers raise nearly anything
            return {}
