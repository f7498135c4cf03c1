"""Facts on what a file holds, for `wavesplat info`: arrays, images of OME-Zarr, labels, regions of a structure set."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat import _native
from wavesplat._looks.kinds.kinds import kind_of
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume import units
from wavesplat._readers.dicom.structures import Structure, is_structure_set, structures_in
from wavesplat._readers.opening import contents, is_zarr
from wavesplat._readers.request import requested
from wavesplat._readers.zarr import ome_zarr
from wavesplat._storage.addresses import is_address
from wavesplat._storage.paths import expanded
from wavesplat.errors import WavesplatError

if TYPE_CHECKING:
    from wavesplat._cli.options.reader import ReaderOptions
    from wavesplat._looks.labels.label_names import Named
    from wavesplat._model.volume.volume import Volume

#: Arrays or images that the text lists, labels that it lists, and width of the name of an array in letters.
N_LISTED, N_LABELS, NAME_WIDTH = 40, 150, 24
#: Cubic metres of a millilitre, and its cubic micrometres; fewer millilitres than these are listed in the latter.
M3_PER_ML, UM3_PER_ML, MIN_ML = 1e-6, 1e12, 1e-6

# Arrays, and the grid that they lie on


def arrays_in(input: str, reader: ReaderOptions) -> dict[str, Any]:
    """The arrays of a file and their grid; empty if the format has no list of arrays or the file cannot be read."""
    try:
        found = contents(requested(input, **vars(reader)))
    except WavesplatError:
        return {}  # opening the file reports the error
    if found is None or not (found.arrays or found.grid):
        return {}
    return {
        "arrays": [asdict(array) for array in found.arrays],
        "grid": None if found.grid is None else asdict(found.grid),
    }


def array_lines(facts: dict[str, Any]) -> list[str]:
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
    text += [f"{'':<12} {array['name']:<{NAME_WIDTH}} {_array_text(array)}" for array in arrays[:N_LISTED]]
    return [*text, f"{'':<12} and {n - N_LISTED} more; --json has all"] if n > N_LISTED else text


def _array_text(array: dict[str, Any]) -> str:
    n = array["n_components"]
    kind = array["dtype"] + (f", {n} components" if n > 1 else "")
    where = array["place"] or " x ".join(map(str, array["shape"]))
    ranges = [f"{one[0]:g} to {one[1]:g}" if one is not None else "no finite number" for one in array["ranges"]]
    return ", ".join([kind, where, *(["; ".join(ranges)] if ranges else [])])


# Images, wells and labels of OME-Zarr


def images_in(input: str, reader: ReaderOptions) -> dict[str, Any]:
    """Facts on the images of a series, wells of a plate, and labels of an image; none of files of other kinds."""
    return ome_zarr.contents(input, reader.dataset) if is_zarr(input, **vars(reader)) else {}


def image_lines(facts: dict[str, Any]) -> list[str]:
    """The contents as text."""
    if "images" not in facts:
        return []
    text = []
    if facts["images"]:
        named = [f"{image['path']} {image['name']!r}" if image["name"] else image["path"] for image in facts["images"]]
        text.append(f"images       {len(named)}, choose with --dataset: {_listed(named)}")
    for well in facts["wells"][:N_LISTED]:
        n = len(well["fields"])
        fields = f"{n} field{'' if n == 1 else 's'}{': ' if n else ''}{_listed(well['fields'])}"
        text.append(f"well {well['name']:<7} {', '.join(part for part in (well['path'], fields) if part)}")
    if len(facts["wells"]) > N_LISTED:
        text.append(f"{'':<12} and {len(facts['wells']) - N_LISTED} wells more; --json has all")
    if facts["label_images"]:
        first = facts["label_images"][0]
        text.append(f"label images {_listed(facts['label_images'])}; draw one with the image: --labels {first}")
    return text


def _listed(names: list[str]) -> str:
    return ", ".join(names[:N_LISTED]) + (", ..." if len(names) > N_LISTED else "")


# Labels


def counted(volume: Volume, named: Mapping[int, Named]) -> list[dict[str, Any]]:
    """The labels by number, including named labels without voxels; empty if the samples are not labels.

    Labels without a colour in the file have the one that they are drawn in; a mask without a name has none.
    """
    if isinstance(volume, LazyVolume) or not (named or kind_of(volume) in ("labels", "mask")):
        return []
    found = np.unique(volume.samples, return_counts=True)
    if not np.array_equal(found[0], np.rint(found[0])) or (not named and found[0].min() < 0):
        return []
    counts = {int(number): int(count) for number, count in zip(*found, strict=True) if number != 0}
    places = {number: place for place, number in enumerate(counts)}
    is_colored = bool(named) or kind_of(volume) == "labels"
    voxel = abs(float(np.linalg.det(volume.world_from_index[:3, :3])))
    metres = units.metres(volume.unit)
    labels = []
    for number in sorted({*counts, *named} - {0}):
        name, color = named.get(number, ("", None))
        if color is None and is_colored and number in places:
            color = _native.label_color(places[number])
        n = counts.get(number, 0)
        labels.append(
            {
                "number": number,
                "name": name or str(number),
                "color": None if color is None else list(color),
                "n_voxels": n,
                "volume_ml": None if metres is None else n * voxel * metres**3 / M3_PER_ML,
            }
        )
    return labels


def label_lines(labels: Sequence[Mapping[str, Any]]) -> list[str]:
    """A line for each label."""
    text = [f"label {label['number']:<6} {', '.join(_label_parts(label))}" for label in labels[:N_LABELS]]
    more = len(labels) - N_LABELS
    return [*text, f"{'':<12} and {more} more; --json has all"] if more > 0 else text


def _label_parts(label: Mapping[str, Any]) -> list[str]:
    parts = [label["name"]]
    if label["color"] is not None:
        parts.append(_hex(label["color"]))
    parts.append(f"{label['n_voxels']} voxels")
    if label["volume_ml"] is not None:
        ml = label["volume_ml"]
        parts.append(f"{ml:.4g} ml" if ml == 0 or ml >= MIN_ML else f"{ml * UM3_PER_ML:.4g} um^3")
    return parts


# Regions of a structure set (RTSTRUCT)


def regions_of(input: str) -> dict[str, Any] | None:
    """The regions of a structure set, ready for JSON; None for other files."""
    path = Path(input if is_address(input) else expanded(input))
    if is_address(input) or not is_structure_set(path):
        return None
    return {
        "name": path.name,
        "modality": "RTSTRUCT",
        "regions": [_region_facts(region) for region in structures_in(path)],
    }


def _region_facts(region: Structure) -> dict[str, Any]:
    points = np.concatenate(region.lines) if region.lines else None
    return {
        "number": region.number,
        "name": region.name,
        "color": None if region.color is None else list(region.color),
        "kind": region.kind,
        "n_lines": len(region.lines),
        "n_open": region.n_open,
        "bounds_xyz": None if points is None else [points.min(axis=0).tolist(), points.max(axis=0).tolist()],
    }


def region_lines(facts: Mapping[str, Any]) -> list[str]:
    """The facts as text, a line for each region."""
    listed = [f"region {region['number']:<5} {', '.join(_region_parts(region))}" for region in facts["regions"]]
    return [
        f"name         {facts['name']}",
        "modality     RTSTRUCT, to draw on its scan: --contours, --labels",
        *listed,
    ]


def _region_parts(region: Mapping[str, Any]) -> list[str]:
    parts = [region["name"]]
    if region["color"] is not None:
        parts.append(_hex(region["color"]))
    parts += [region["kind"]] if region["kind"] else []
    parts.append(f"{region['n_lines']} lines" if region["n_lines"] else "no closed lines")
    if region["bounds_xyz"] is not None:
        lower, upper = (f"({', '.join(f'{number:.6g}' for number in corner)})" for corner in region["bounds_xyz"])
        parts.append(f"{lower} to {upper} mm")
    return parts


def _hex(color: Sequence[float]) -> str:
    return "#" + "".join(f"{round(255 * share):02x}" for share in color)
