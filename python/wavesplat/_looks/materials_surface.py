"""Surfaces between materials: Drebin's surface term, as a function of value and gradient magnitude.

With p_i(v) the share of material i in a sample of value v and rho_i its number (`Material.density`), the strength of a
surface is the gradient of D(v) = sum p_i rho_i. D depends on the place through the value alone, so that

    S = |grad D| = |D'(v)| |grad v|

Source: Drebin, Carpenter and Hanrahan, Volume Rendering, SIGGRAPH 1988, section 4. There S scales what a surface
reflects; here it scales the opacity, so that the inside of materials recedes and their boundaries stay:

    alpha(v, |grad v|) = alpha(v) ((1 - share) + share min(1, thickness S))
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wavesplat._looks.transfer_function_2d import TransferFunction2D
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.materials import Materials

#: Size of the table: columns between the first and the last node, and rows up to the gradient of complete surfaces.
N_VALUES = 256
N_MAGNITUDES = 48
#: Least slope of a boundary, as a share of the steepest one's.
FLAT = 1e-3
#: Largest change of D from column to column that is rounding.
ROUNDING = 1e-9


def surfaces(materials: Materials, share: float, thickness: float) -> TransferFunction2D:
    """See `Materials.surfaces`."""
    if not 0 <= share <= 1:
        raise ArgumentError(f"materials: the share of the surfaces is {share!r}; give a number 0..1")
    if not (np.isfinite(thickness) and thickness > 0):
        raise ArgumentError(f"materials: the thickness of surfaces is {thickness!r}; give a positive number")
    nodes = [value for material in materials.materials for value, _ in material.probability]
    lo, hi = min(nodes), max(nodes)
    # Beyond the last node nothing changes any more, which one more column shows.
    margin = (hi - lo) / N_VALUES or 1.0
    columns = np.unique([lo - margin, *np.linspace(lo, hi, N_VALUES), *nodes, hi + margin])
    mixture = materials.transfer_function()
    rgba = mixture(columns)
    densities = np.array([material.density for material in materials.materials], dtype=np.float64)
    numbers = materials.percentages(columns) @ densities
    slope = np.abs(np.gradient(numbers, columns))
    if slope.max() * margin < ROUNDING:
        raise ArgumentError("materials: none of them has a boundary with another; their densities or curves are equal")
    # The strength of every column grows with the magnitude up to one of these, and is constant beyond.
    complete = 1 / (thickness * slope[slope > FLAT * slope.max()])
    rows = np.unique([0.0, *np.quantile(complete, np.linspace(0, 1, N_MAGNITUDES))])
    strength = np.minimum(1.0, thickness * slope * rows[:, None])
    table = np.repeat(rgba[None], len(rows), axis=0)
    table[:, :, 3] *= (1 - share) + share * strength
    return TransferFunction2D(columns.tolist(), rows.tolist(), table, mixture.opacity_unit)
