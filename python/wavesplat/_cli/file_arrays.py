"""Arrays in a file, and the grid that they lie on, for `wavesplat info`."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wavesplat._cli.reader_options import ReaderOptions

__all__ = ["contents", "lines"]

#: Maximum number of arrays that the text lists, and width of a name in letters.
N_LISTED, NAME_WIDTH = 40, 24


def contents(input: str, reader: ReaderOptions) -> dict[str, Any]:
    """The arrays of a file and their grid; empty if the format has no list of arrays or the file cannot be read."""
    from wavesplat._readers.opening import contents as contents_of
    from wavesplat._readers.request import requested
    from wavesplat.errors import WavesplatError

    try:
        found = contents_of(requested(input, **vars(reader)))
    except WavesplatError:
        return {}  # opening the file reports the error
    if found is None or not (found.arrays or found.grid):
        return {}
    return {
        "arrays": [asdict(array) for array in found.arrays],
        "grid": None if found.grid is None else asdict(found.grid),
    }


def lines(facts: dict[str, Any]) -> list[str]:
    """The arrays and the grid as text, one a line."""
    if "arrays" not in facts:
        return []
    arrays, grid, text = facts["arrays"], facts["grid"], []
    if grid is not None:
        low, high = (", ".join(f"{number:.6g}" for number in corner) for corner in grid["bounds"])
        blocks = f" in {grid['n_blocks']} blocks" if grid["n_blocks"] > 1 else ""
        text = [
            f"grid         {grid['described']}: {grid['n_points']} points, {grid['n_cells']} cells{blocks}",
            f"grid bounds  ({low}) to ({high})",
        ]
        if grid["cell_widths"] is not None:
            smallest, largest = grid["cell_widths"]
            text.append(f"cell widths  {smallest:.4g} to {largest:.4g}")
    n = len(arrays)
    text.append(f"arrays       {n}{', choose with --dataset:' if n > 1 else ':' if n else ''}")
    text += [f"{'':<12} {array['name']:<{NAME_WIDTH}} {_described(array)}" for array in arrays[:N_LISTED]]
    return [*text, f"{'':<12} and {n - N_LISTED} more; --json has all"] if n > N_LISTED else text


def _described(array: dict[str, Any]) -> str:
    n = array["n_components"]
    kind = array["dtype"] + (f", {n} components" if n > 1 else "")
    where = array["place"] or " x ".join(map(str, array["shape"]))
    ranges = [f"{one[0]:g} to {one[1]:g}" if one is not None else "no finite number" for one in array["ranges"]]
    return ", ".join([kind, where, *(["; ".join(ranges)] if ranges else [])])
