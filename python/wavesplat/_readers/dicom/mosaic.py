"""Slices of a volume side by side in one picture, row by row: mosaics of Siemens' MR scanners, and grids of UIH's.

Siemens: the number of slices, and the direction in which they follow each other, stand in private elements:
NumberOfImagesInMosaic (0019,xx0A), and the vendor's own header of the image (CSA, 0029,xx10), which nibabel parses.
Where these were removed, the protocol of the series may be left (0029,xx20), a text with the centre of each slice.
ImagePositionPatient is the corner of a slice of the whole picture's size around the first slice's centre, so half of
the difference of sizes is added; see https://nipy.org/nibabel/dicom/dicom_mosaic.html.

UIH (United Imaging): the number of slices is in (0065,xx50), and a sequence (0065,xx51) has the position and the time
of each; see https://github.com/rordenlab/dcm2niix/tree/master/UIH.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from wavesplat._readers.dicom.values import Creator, as_numbers, numbers, raw_value
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

#: Words of the image type for such pictures, with their names, and what is missing where they are not split.
MOSAIC, GRID = "MOSAIC", "VFRAME"
NAMES = {MOSAIC: "mosaic (Siemens)", GRID: "grid (United Imaging)"}
MISSING = {
    MOSAIC: "private 0019,xx0A, the CSA header 0029,xx10, or the protocol 0029,xx20; and ImagePositionPatient",
    GRID: "private 0065,xx50 and 0065,xx51; and ImageOrientationPatient",
}
#: The tag of the number of slices of Siemens, and of the name of the block that it is in; both of UIH; its slices.
N_SLICES, CREATOR = 0x0019100A, Creator(0x00190010, "SIEMENS MR HEADER", "SIEMENS")
N_OF_GRID, CREATOR_OF_GRID, SLICES = 0x00651050, Creator(0x00650010, "Image Private Header", "UIH"), 0x00651051
#: Groups that may hold the protocol of Siemens, and its lines: the number of slices, and coordinates of their centres.
GROUPS_OF_PROTOCOL = (0x0029, 0x0021)
BEGIN, END = b"### ASCCONV BEGIN", b"### ASCCONV END"
SIZE = re.compile(rb"^[ \t]*sSliceArray\.lSize[ \t]*=[ \t]*(\d{1,6})\b", re.MULTILINE)
CENTRE = re.compile(
    rb"^[ \t]*sSliceArray\.asSlice\[(\d{1,6})\]\.sPosition\.d(Sag|Cor|Tra)[ \t]*=[ \t]*(\S{1,40})", re.MULTILINE
)
AXES = (b"Sag", b"Cor", b"Tra")
#: The assumption if neither the image header nor the protocol gives the order of the slices.
ASSUMED_ORDER = (
    "slices of a mosaic along the normal of its picture: the file does not say their order (0029,xx10 or 0029,xx20)"
)
#: Slices of a protocol, at most: a scanner's have some hundreds.
MAX_SLICES = 4096

Numbers = TypeVar("Numbers", bound=np.generic)


@dataclass(frozen=True)
class Picture:
    """The picture of a file, and where its header puts it: lengths in mm, LPS; NaN where nothing is said."""

    image_type: str
    #: Columns and rows.
    size: tuple[int, int]
    position: NDArray[np.float64]
    orientation: NDArray[np.float64]
    #: Distances between rows, between columns, and between slices.
    pixel_spacing: tuple[float, float]
    slice_step: float
    file: Path


@dataclass(frozen=True)
class Tiles:
    """Slices side by side in a picture: their number, and how many are beside and below each other."""

    n: int
    n_per_row: int
    n_per_column: int

    def size_of_one(self, size: tuple[int, int]) -> tuple[int, int]:
        """Columns and rows of a slice. `size`: columns and rows of the picture."""
        return size[0] // self.n_per_row, size[1] // self.n_per_column


@dataclass(frozen=True)
class Split:
    """The slices of a picture, their positions, LPS, the item of a sequence about each, of UIH, and an assumption."""

    tiles: Tiles
    positions: NDArray[np.float64]
    items: Sequence[Any] = ()
    guess: str = ""


def unsplit_note(image_type: str) -> str:
    """A sentence on pictures of several slices that cannot be split; "" of other image types."""
    word = _word(image_type)
    if not word:
        return ""
    return (
        f"each file holds a {NAMES[word]}, the slices of a volume side by side in one picture, and the elements that "
        f"say how many there are and where ({MISSING[word]}) were removed; export the series with them"
    )


def split_of(dataset: Dataset, picture: Picture) -> Split | None:
    """The slices of a picture; None if it is a single one, or the file does not say how it is to be split."""
    word = _word(picture.image_type)
    if not word or not np.isfinite(picture.orientation).all():
        return None
    if word == GRID:
        return _split_grid(dataset, picture)
    return _split_mosaic(dataset, picture) if np.isfinite(picture.position).all() else None


def slices_in(pixels: NDArray[Numbers], tiles: Tiles) -> NDArray[Numbers]:
    """The slices of a picture [rows, columns], shape (slices, rows, columns)."""
    rows, columns = pixels.shape[0] // tiles.n_per_column, pixels.shape[1] // tiles.n_per_row
    apart = pixels.reshape(tiles.n_per_column, rows, tiles.n_per_row, columns).swapaxes(1, 2)
    return apart.reshape(-1, rows, columns)[: tiles.n]


def _word(image_type: str) -> str:
    words = {word.strip() for word in image_type.upper().split("\\")}
    return next((word for word in NAMES if word in words), "")


def _tiles(word: str, n: int, picture: Picture) -> Tiles:
    """The layout of `n` slices: Siemens' mosaics are square, UIH's grids have only the rows they need."""
    n_per_row = math.isqrt(n - 1) + 1
    n_per_column = n_per_row if word == MOSAIC else -(-n // n_per_row)
    size = picture.size
    if size[0] % n_per_row or size[1] % n_per_column:
        sides = f"{n_per_row}" if n_per_row == n_per_column else f"{n_per_row} and {n_per_column}"
        raise FileError(
            f"the file holds a {NAMES[word]} of {n} slices, whose {size[0]} x {size[1]} pixels are no multiple of "
            f"{sides}; export it again: {picture.file}"
        )
    return Tiles(n, n_per_row, n_per_column)


# UIH


def _split_grid(dataset: Dataset, picture: Picture) -> Split | None:
    if not CREATOR_OF_GRID.is_in(dataset):
        return None
    items = _items(dataset)
    count = as_numbers(raw_value(dataset, N_OF_GRID), "decimal")
    n = int(count[0]) if count and math.isfinite(count[0]) else len(items)
    if len(items) < 2:
        return None
    if n != len(items):
        raise FileError(
            f"the file holds a {NAMES[GRID]} of {n} slices (0065,xx50), and describes {len(items)} (0065,xx51); export "
            f"it again: {picture.file}"
        )
    positions = np.array([numbers(item, 0x00200032, 3) for item in items])
    if not np.isfinite(positions).all():
        return None
    return Split(_tiles(GRID, n, picture), positions, items)


def _items(dataset: Dataset) -> Sequence[Any]:
    """The items of the sequence of slices; a file of implicit types does not say that it is one."""
    from pydicom.sequence import Sequence as Items
    from pydicom.values import convert_SQ

    if SLICES not in dataset:
        return ()
    value = dataset[SLICES].value
    if isinstance(value, bytes):
        is_implicit, is_little = dataset.original_encoding
        try:
            value = convert_SQ(value, bool(is_implicit), bool(is_little))
        except Exception:  # noqa: BLE001 - parsers of damaged headers raise nearly anything
            return ()
    return value if isinstance(value, Items) else ()


# Siemens


def _split_mosaic(dataset: Dataset, picture: Picture) -> Split | None:
    tags = _of_image(dataset)
    count = tags.get("NumberOfImagesInMosaic") or []
    if CREATOR.is_in(dataset):
        count = as_numbers(raw_value(dataset, N_SLICES), "u2") or count
    vector = np.array(tags.get("SliceNormalVector") or [], np.float64)
    is_direction = vector.shape == (3,) and np.isfinite(vector).all() and vector.any()
    centres = _centres(dataset) if not count or not is_direction else None
    if not count and centres is None:
        return None
    n = int(count[0]) if count else len(centres)  # type: ignore[arg-type]
    if n < 2:
        return None
    tiles = _tiles(MOSAIC, n, picture)
    columns, rows = tiles.size_of_one(picture.size)
    along_row = picture.orientation[:3] * picture.pixel_spacing[1]
    along_column = picture.orientation[3:] * picture.pixel_spacing[0]
    normal, step = np.cross(picture.orientation[:3], picture.orientation[3:]), picture.slice_step
    with np.errstate(over="ignore", invalid="ignore"):  # impossible distances are refused later
        first = picture.position + along_row * (picture.size[0] - columns) / 2
        first = first + along_column * (picture.size[1] - rows) / 2
        if centres is not None and len(centres) == n:
            vector, between = _order(centres, first + along_row * columns / 2 + along_column * rows / 2, normal)
            step = step if np.isfinite(numbers(dataset, 0x00180088, 1)).all() else between
        across = -normal if vector.shape == (3,) and vector @ normal < 0 else normal
        positions: NDArray[np.float64] = first + np.arange(n)[:, None] * (step * across)
    is_known = vector.shape == (3,) and bool(vector.any())
    return Split(tiles, positions, guess="" if is_known else ASSUMED_ORDER)


def _order(
    centres: NDArray[np.float64], first: NDArray[np.float64], normal: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """The direction from slice to slice of a picture, and their distance.

    A protocol lists slices upwards also where the scanner numbers them downwards: `first`, the centre of the picture's
    first slice, is the centre of the first or the last slice of the list.
    """
    along = (centres - first) @ normal
    way = centres[-1] - centres[0]
    between = float(np.linalg.norm(way)) / (len(centres) - 1)
    return (way if abs(along[0]) <= abs(along[-1]) else -way), between


def _of_image(dataset: Dataset) -> dict[str, list[Any]]:
    """Values in Siemens' image header (CSA) by name; empty if it is missing or cannot be read."""
    with warnings.catch_warnings():
        # nibabel warns that its readers of DICOM are new, and about damaged headers.
        warnings.simplefilter("ignore")
        from nibabel.nicom import csareader

        try:
            found = csareader.get_csa_header(dataset)
            return {} if found is None else {name: tag["items"] for name, tag in found["tags"].items()}
        except Exception:  # noqa: BLE001 - parsers of damaged headers raise nearly anything
            return {}


def _centres(dataset: Dataset) -> NDArray[np.float64] | None:
    """Centres of slices, LPS, mm, from the protocol of the series, which omits coordinates of 0; None without one."""
    for tag in dataset.keys():  # noqa: SIM118 - a dataset iterates over its elements, and converts them
        if tag.group not in GROUPS_OF_PROTOCOL:
            continue
        content = raw_value(dataset, tag)[0]
        if (begin := content.find(BEGIN)) < 0:
            continue
        protocol = content[begin : content.find(END, begin)]
        size = SIZE.search(protocol)
        n = int(size[1]) if size else 0
        if not 2 <= n <= MAX_SLICES:
            continue
        centres = np.zeros((n, 3))
        try:
            for number, axis, value in CENTRE.findall(protocol):
                centres[int(number), AXES.index(axis)] = float(value)
        except (ValueError, IndexError):
            return None
        if np.isfinite(centres).all() and (centres[0] != centres[-1]).any():
            return centres
    return None
