"""Labels of a file for `wavesplat info`: numbers, names, colours, voxels and volumes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from wavesplat._model.lazy_volume import LazyVolume

if TYPE_CHECKING:
    from wavesplat._looks.label_names import Named
    from wavesplat._model.volume import Volume

__all__ = ["counted", "lines"]

#: Cubic millimetres of a millilitre.
MM3_PER_ML = 1000.0
#: Largest number of labels that the text lists.
N_LISTED = 150


def counted(volume: Volume, named: Mapping[int, Named]) -> list[dict[str, Any]]:
    """The labels by number, those that occur and those that are only named; none where samples are no labels."""
    if isinstance(volume, LazyVolume) or volume.dtype.kind not in "iu":
        return []
    found = np.unique(volume.samples, return_counts=True)
    counts = {int(number): int(count) for number, count in zip(*found, strict=True) if number != 0}
    voxel = abs(float(np.linalg.det(volume.world_from_index[:3, :3])))
    labels = []
    for number in sorted({*counts, *named} - {0}):
        name, color = named.get(number, ("", None))
        n = counts.get(number, 0)
        labels.append(
            {
                "number": number,
                "name": name or str(number),
                "color": None if color is None else list(color),
                "n_voxels": n,
                "volume_ml": n * voxel / MM3_PER_ML if volume.unit == "mm" else None,
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
        parts.append(f"{label['volume_ml']:.4g} ml")
    return parts
