"""A segmentation over a slice: every label's colour, faint inside and full along its outline."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.labels import Labels
from wavesplat._render.slicing import Planes

#: Opacity of a label's inside, as a share of its outline's: the scan shows through.
FILL = 0.4
#: Pixels that are worked on at once: their positions, in float64, take little memory.
PIXELS_AT_ONCE = 1 << 18


def laid_over(rgba: NDArray[np.float32], planes: Planes, labels: Labels) -> tuple[NDArray[np.float32], set[int]]:
    """A slice with the labels of the samples next to its middle plane, and the numbers of these.

    Outlines are as opaque as labels in space.

    labels : on samples in the scan's order of axes, as `Labels.for_slices_of` gives them.
    """
    codes = codes_at(planes, labels)
    shares, colors = colors_of_labels(labels)
    edge = np.zeros(codes.shape, bool)
    for one, other in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        differs = codes[one] != codes[other]
        edge[one] |= differs
        edge[other] |= differs
    alpha = (shares[codes] * np.where(edge, 1.0, FILL))[..., None]
    over = np.concatenate([colors[codes], np.ones((*codes.shape, 1))], axis=2)
    mixed: NDArray[np.float32] = (over * alpha + (1 - alpha) * rgba).astype(np.float32)
    seen = {labels.numbers[code] for code in np.unique(codes).tolist() if code < len(labels.numbers)}
    return mixed, seen


def colored(rgba: NDArray[np.float32], planes: Planes, labels: Labels) -> tuple[NDArray[np.float32], set[int]]:
    """A slice of a segmentation in the colours of its labels, black where there is none, and the numbers of these."""
    codes = codes_at(planes, labels)
    shares, colors = colors_of_labels(labels)
    is_label = (shares[codes] > 0)[..., None]
    black = np.array([0, 0, 0, 1]) * (rgba[..., 3:] > 0)
    opaque = np.concatenate([colors[codes], np.ones((*codes.shape, 1))], axis=2)
    is_inside = (codes < len(labels.numbers))[..., None]
    shown = np.where(is_label, opaque, np.where(is_inside, black, rgba)).astype(np.float32)
    return shown, {labels.numbers[code] for code in np.unique(codes).tolist() if code < len(labels.numbers)}


def colors_of_labels(labels: Labels) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Opacities of outlines, and colours, shape (n, 3), by the codes of `codes_at`; the last is for pixels outside."""
    looks = [labels.labels.get(number) for number in labels.numbers]
    shares = np.array([0.0 if look is None else max(look.opacity, look.tint) for look in looks] + [0.0])
    colors = np.array([(0.0,) * 3 if look is None else look.color for look in looks] + [(0.0,) * 3])
    return shares, colors


def codes_at(planes: Planes, labels: Labels) -> NDArray[np.intp]:
    """Index of the label's number in `Labels.numbers` for every pixel; one more than the last outside their samples."""
    cut, frame = planes.cut, planes.frame
    assert labels.world_from_index is not None
    to_index = np.linalg.inv(labels.world_from_index)
    first = to_index[:3, :3] @ frame.origin + to_index[:3, 3]
    across, down = (to_index[:3, :3] @ (frame.pixel * way) for way in (cut.right, -cut.up))
    width, height = frame.size
    codes = np.full((height, width), len(labels.numbers), np.intp)
    rows_at_once = max(1, PIXELS_AT_ONCE // width)
    for start in range(0, height, rows_at_once):
        rows = np.arange(start, min(start + rows_at_once, height))[:, None]
        columns = np.arange(width)[None, :]
        x, y, z = (np.rint(first[a] + columns * across[a] + rows * down[a]).astype(np.intp) for a in range(3))
        n_z, n_y, n_x = labels.shape
        inside = (x >= 0) & (x < n_x) & (y >= 0) & (y < n_y) & (z >= 0) & (z < n_z)
        codes[rows[:, 0]] = np.where(
            inside, labels._codes[z.clip(0, n_z - 1), y.clip(0, n_y - 1), x.clip(0, n_x - 1)], len(labels.numbers)
        )
    return codes
