"""The mixture of materials as piecewise-linear curves of opacity and colour.

Between two nodes, opacity and colour of the mixture are quotients of linear functions, N(t) / D(t): of the sum of the
claims where it exceeds 1, and of the opacity.
Such a curve is A + B / D.
A chord over a stretch where D grows from d by a factor q is wrong by |B| (1/d - 1/(q d)) (r - 1) / (r + 1) at most,
with r = sqrt(q), so nodes at equal factors of D make the error of the associated colour the same on all stretches.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Largest error of the transfer function's colour, and of its opacity: together they stay below 1e-3.
TOLERANCE = 5e-4
#: Largest difference that is rounding, and makes no nodes.
ROUNDING = 1e-9


def curves(values: Array, totals: Array, parts: Array) -> tuple[list[tuple[float, float]], list[tuple[float, ...]]]:
    """Nodes (value, opacity) and (value, red, green, blue) of a mixture, exact to `TOLERANCE` between them.

    values : in order; where the claims jump, twice, for what is below and above.
    totals : sum of the claims at each.
    parts : sum of the claims times opacity times (red, green, blue, 1) at each, shape (n, 4).
    """
    opacity: list[tuple[float, float]] = []
    color: list[tuple[float, ...]] = []
    points = _points(values, totals, parts)
    # A single point stands for itself.
    for start, end in zip(points, [*points[1:], points[-1]], strict=True):
        opacity += _opacity_nodes(start, end)
        color += _color_nodes(start, end)
    # Where everything is clear any colour will do; black adds nothing.
    return _once(opacity), _once(color) or [(points[0].value, 0.0, 0.0, 0.0)]


def _points(values: Array, totals: Array, parts: Array) -> list[_Point]:
    """The mixture at every value, and where the claims begin to exceed 1."""
    points: list[_Point] = []
    for value, total, part in zip(values, totals, parts, strict=True):
        if points and (share := _crossing(points[-1].total, total)) is not None:
            before = points[-1]
            crossing = before.value + share * (value - before.value)
            points.append(_Point(crossing, 1.0, before.part + share * (part - before.part)))
        points.append(_Point(float(value), float(total), part))
    return [_Point(value, max(total, 1.0), part) for value, total, part in points]


class _Point(NamedTuple):
    """The mixture at a value, before it is divided by the claims' sum: linear from point to point."""

    value: float
    total: float
    part: NDArray[np.float64]
    """Associated red, green, blue, and opacity."""

    @property
    def opacity(self) -> float:
        return min(float(self.part[3]) / self.total, 1.0)

    @property
    def color(self) -> NDArray[np.float64]:
        clipped: NDArray[np.float64] = np.clip(self.part[:3] / self.part[3], 0.0, 1.0)
        return clipped


def _opacity_nodes(start: _Point, end: _Point) -> list[tuple[float, float]]:
    """Nodes of the opacity curve between two points: relative errors count, since thin fog adds up."""
    change = abs(end.opacity - start.opacity)
    ratio = max(start.total, end.total) / min(start.total, end.total)
    tolerance = TOLERANCE * max(start.opacity, end.opacity) / ratio
    points = _between(start, end, (start.total, end.total), change, tolerance)
    return [(point.value, point.opacity) for point in points]


def _color_nodes(start: _Point, end: _Point) -> list[tuple[float, ...]]:
    """Nodes of the colour curve between two points: errors count as much as the opacity shows."""
    least, most = sorted((float(start.part[3]), float(end.part[3])))
    if most == 0.0:
        return []
    if least <= ROUNDING * most:
        # All opacities begin or end here, so their shares, and with them the colour, do not change.
        color = (end if end.part[3] > start.part[3] else start).color
        return [(start.value, *color), (end.value, *color)]
    change = float(np.abs(end.color - start.color).max())
    points = _between(start, end, (float(start.part[3]), float(end.part[3])), change, TOLERANCE / most)
    return [(point.value, *point.color) for point in points]


def _between(
    start: _Point, end: _Point, divisors: tuple[float, float], change: float, tolerance: float
) -> list[_Point]:
    """Both points, and those between them at equal factors of D that keep chords within the tolerance where D is most.

    The quotient changes by `change`, and `divisors` are D at the points; see the head of the file.
    """
    d0, d1 = divisors
    ratio = max(d0, d1) / min(d0, d1)
    pieces = 1
    if change > tolerance and ratio > 1.0 and start.value < end.value:
        while change / (ratio - 1.0) * _bend(ratio ** (1.0 / pieces)) > tolerance:
            pieces += 1
    shares = ((d0 * (d1 / d0) ** (piece / pieces) - d0) / (d1 - d0) for piece in range(1, pieces))
    inner = (_Point(*((1.0 - share) * a + share * b for a, b in zip(start, end, strict=True))) for share in shares)
    return [start, *inner, end]


def _bend(factor: float) -> float:
    """Largest distance of 1 / D from its chord where D grows by `factor` to 1."""
    root = math.sqrt(factor)
    return (factor - 1.0) * (root - 1.0) / (root + 1.0)


def _crossing(before: float, after: float) -> float | None:
    """Place between two points where the sum of the claims passes 1, as a share of the way; None if it does not."""
    apart = min(abs(before - 1.0), abs(after - 1.0)) > ROUNDING
    return (1.0 - before) / (after - before) if apart and (before < 1.0) != (after < 1.0) else None


def _once(nodes: list[Any]) -> list[Any]:
    """The nodes, without those that repeat the one before."""
    return [node for number, node in enumerate(nodes) if number == 0 or node != nodes[number - 1]]
