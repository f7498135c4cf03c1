"""Labels of a file for `wavesplat info`: numbers, names, colours, voxels and volumes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._looks.default_colors import label_color
from wavesplat._looks.kinds import kind_of
from wavesplat._model import units
from wavesplat._model.lazy_volume import LazyVolume

if TYPE_CHECKING:
    from wavesplat._looks.label_names import Named
    from wavesplat._model.volume import Volume

__all__ = ["counted", "lines"]

#: Cubic metres of a millilitre, and its cubic micrometres; fewer millilitres than these are listed in the latter.
M3_PER_ML, UM3_PER_ML, MIN_ML = 1e-6, 1e12, 1e-6
#: Largest number of labels that the text lists.
N_LISTED = 150


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
            color = label_color(places[number])
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


def lines(labels: Sequence[Mapping[str, Any]]) -> list[str]:
    """A line for each label."""
    text = [f"label {label['number']:<6} {', '.join(_parts(label))}" for label in labels[:N_LISTED]]
    more = len(labels) - N_LISTED
    return [*text, f"{'':<12} and {more} more; --json has all"] if more > 0 else text


def _parts(label: Mapping[str, Any]) -> list[str]:
    parts = [label["name"]]
    if label["color"] is not None:
        parts.append("#" + "".join(f"{round(255 * share):02x}" for share in label["color"]))
    parts.append(f"{label['n_voxels']} voxels")
    if label["volume_ml"] is not None:
        ml = label["volume_ml"]
        parts.append(f"{ml:.4g} ml" if ml == 0 or ml >= MIN_ML else f"{ml * UM3_PER_ML:.4g} um^3")
    return parts
