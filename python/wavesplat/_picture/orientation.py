"""Marks of a picture's orientation: letters at its edges, a cube with lettered faces, or three axes.

The world of medical data is RAS: x to the patient's right, y to the front, z up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wavesplat._picture.lettering import CAP_HEIGHT, text_width
from wavesplat._picture.marks import Block, Color, Halo, Mark, Polygon, Style, Text, disc, stroke

if TYPE_CHECKING:
    from wavesplat._picture.report_facts import View

Array = NDArray[np.float64]

#: Letters of the negative and the positive direction of the RAS world's x, y and z; and of any other world's.
LETTERS = ("LR", "PA", "IS")
AXES = tuple(("\N{MINUS SIGN}" + name, name) for name in "xyz")
#: Least component of a direction along an axis, the sine of 11.5 degrees, that gets the axis's letter.
MIN_LEAN = 0.2
#: Half an edge of the cube, and length of an axis, in sizes of the font.
CUBE, AXIS = 1.25, 2.2
#: Least part of a face's normal towards the eye (a cosine) at which it has room for a letter.
MIN_FACE = 0.15
#: Greys of the cube's lightest and darkest face; colour of its edges and letters.
FACES, EDGE = (0.93, 0.66), (0.25, 0.25, 0.25)
#: Colours of the x, y and z axis: red, green and blue, of a brightness that is seen on black and on white.
AXIS_COLORS: tuple[Color, ...] = ((0.86, 0.26, 0.22), (0.18, 0.60, 0.28), (0.25, 0.47, 0.92))
#: Direction to the light, in the picture: right, up, to the eye.
LIGHT = np.array([-0.35, 0.55, 0.76])


def edge_letters(right: Array, up: Array) -> dict[str, str]:
    """Letters of the edges of a picture in the RAS world, such as "R" or, with the nearest axis first, "AS"."""
    return {"left": _letters(-right), "right": _letters(right), "top": _letters(up), "bottom": _letters(-up)}


def letter_marks(view: View, width: float, height: float, margin: float, style: Style) -> list[Mark]:
    """Letters at the middles of the edges of a picture."""
    letters, size = edge_letters(view.right, view.up), 1.15 * style.size
    middle = height / 2 + CAP_HEIGHT * size / 2
    places = {
        "left": (margin, middle, "start"),
        "right": (width - margin, middle, "end"),
        "top": (width / 2, margin + CAP_HEIGHT * size, "middle"),
        "bottom": (width / 2, height - margin, "middle"),
    }
    return [
        Text(x, y, letters[edge], size, style.ink, anchor, style.halo)  # type: ignore[arg-type]
        for edge, (x, y, anchor) in places.items()
    ]


def cube_block(view: View, style: Style, *, is_anatomical: bool) -> Block:
    """A cube along the world's axes, as the eye sees it; hidden faces are left out."""
    axes = np.stack([view.right, view.up, view.back])  # columns: the world's x, y and z in the picture
    half = CUBE * style.size
    radius = half * np.sqrt(3) + 0.1 * style.size
    names = LETTERS if is_anatomical else AXES
    marks: list[Mark] = []
    for axis, sign in _seen(axes):
        normal = sign * axes[:, axis]
        light = FACES[1] + (FACES[0] - FACES[1]) * max(0.0, float(normal @ LIGHT))
        face = _face(axes, (axis, sign), half=half, radius=radius, fill=(light, light, light), halo=style.halo)
        marks.append(face)
        ends = zip(face.points, (*face.points[1:], face.points[0]), strict=True)
        marks += [stroke(start, end, max(1.0, 0.06 * style.size), EDGE) for start, end in ends]
        if normal[2] >= MIN_FACE:
            name = names[axis][int(sign > 0)]
            # The letter's up is the world's up; on the top face the world's back, on the bottom face its front.
            above = axes[:, 2] if axis != 2 else -sign * axes[:, 1]
            across = np.cross(above, normal)
            slant = (float(across[0]), float(-across[1]), float(-above[0]), float(above[1]))
            size = min(1.5 * style.size, 1.5 * half / text_width(name, 1, style.font))
            down = _middle(name) * size
            x, y = radius + half * normal[0] + down * slant[2], radius - half * normal[1] + down * slant[3]
            marks.append(Text(x, y, name, size, EDGE, "middle", slant=slant))
    return Block(tuple(marks), 2 * radius, 2 * radius)


def axes_block(view: View, style: Style, *, is_anatomical: bool) -> Block:
    """The world's axes as arrows from one point, those that point to the eye last."""
    axes = np.stack([view.right, view.up, view.back])
    length, size = AXIS * style.size, style.size
    radius = length + 0.9 * size
    names = [letters[1] for letters in (LETTERS if is_anatomical else AXES)]
    center = (radius, radius)
    marks: list[Mark] = [disc(center, 0.12 * size, EDGE, style.halo)]
    for axis in sorted(range(3), key=lambda axis: axes[2, axis]):
        across, up, _ = axes[:, axis]
        color, reach = AXIS_COLORS[axis], float(np.hypot(across, up))
        tip = (radius + length * across, radius - length * up)
        if reach * length > 0.3 * size:
            along, side = (across / reach, -up / reach), (up / reach, across / reach)
            head = min(0.5 * size, reach * length)
            neck = (tip[0] - head * along[0], tip[1] - head * along[1])
            marks.append(stroke(center, neck, 0.13 * size, color, style.halo))
            wings = [(neck[0] + way * 0.19 * size * side[0], neck[1] + way * 0.19 * size * side[1]) for way in (1, -1)]
            marks.append(Polygon((tip, *wings), color, style.halo))
        else:
            marks.append(disc(center, 0.2 * size, color, style.halo))
        # The letter stands beyond the tip, or beside the tip of an axis that points at the eye.
        x, y = (length * across, -length * up) if reach > 0.15 else (0.0, 0.0)
        beyond = (across / reach, -up / reach) if reach > 0.15 else (-0.8, 0.8)
        name = names[axis]
        place = (radius + x + 0.55 * size * beyond[0], radius + y + 0.55 * size * beyond[1])
        marks.append(Text(place[0], place[1] + _middle(name) * size, name, size, color, "middle", style.halo))
    return Block(tuple(marks), 2 * radius, 2 * radius)


def _letters(direction: Array) -> str:
    leaning = [axis for axis in range(3) if abs(direction[axis]) >= MIN_LEAN]
    leaning.sort(key=lambda axis: -round(abs(float(direction[axis])), 6))
    return "".join(LETTERS[axis][int(direction[axis] > 0)] for axis in leaning)


def _seen(axes: Array) -> list[tuple[int, int]]:
    """Axes and signs of the faces that look to the eye, by more than rounding."""
    return [(axis, sign) for axis in range(3) for sign in (-1, 1) if sign * axes[2, axis] > 1e-3]


def _face(axes: Array, side: tuple[int, int], *, half: float, radius: float, fill: Color, halo: Halo | None) -> Polygon:
    axis, sign = side
    one, other = (axes[:, across] for across in range(3) if across != axis)
    corners = [sign * axes[:, axis] + a * one + b * other for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return Polygon(tuple((radius + half * float(x), radius - half * float(y)) for x, y, _ in corners), fill, halo)


def _middle(name: str) -> float:
    """Distance from the middle of a letter to its baseline, in its sizes: small letters are lower."""
    return 0.26 if name[-1] in "xyz" else CAP_HEIGHT / 2
