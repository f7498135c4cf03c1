"""Surfaces of triangles, with their areas and normals."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._geometry import foreign_shapes
from wavesplat._geometry.paint import Color, checked_paint, paint_of
from wavesplat._geometry.positions import check_count, checked_positions, frozen, numbers_of
from wavesplat._geometry.shape import Shape
from wavesplat._public import public
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

# Areas and normals of triangles that share vertices.

Floats: TypeAlias = NDArray[np.float64]


def face_vectors(vertices: Floats, faces: NDArray[Any]) -> Floats:
    """Outward vectors of twice the faces' areas."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    vectors: Floats = np.cross(b - a, c - a)
    return vectors


def normals_of_faces(vertices: Floats, faces: NDArray[Any]) -> Floats:
    """Sum of the vectors of the faces around each vertex: their mean by area."""
    return _native.normals_of_faces(np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(faces, np.uint32))


def smooth_normals(vertices: Floats, faces: NDArray[Any]) -> NDArray[np.float32]:
    """Unit normals of the vertices, the mean of the faces around each by area; (0, 0, 1) where these have none."""
    # Relative to their size, so that areas of tiny or huge triangles neither vanish nor overflow.
    largest = float(np.ptp(vertices, axis=0).max()) or 1.0
    normals = normals_of_faces((vertices - vertices.mean(axis=0)) / largest, faces)
    lengths = np.linalg.norm(normals, axis=1)
    normals[lengths == 0] = 0, 0, 1
    lengths[lengths == 0] = 1
    unit: NDArray[np.float32] = (normals / lengths[:, None]).astype(np.float32)
    return unit


# Surfaces of triangles.

#: Colour of surfaces without one: ivory, on which shadows show.
IVORY = (0.93, 0.88, 0.78)
#: How far the length of a unit vector in float32 may be from 1.
ROUNDED = 1e-6


@public
@dataclass(frozen=True, eq=False, repr=False)
class Surface(Shape):
    """A surface of triangles, which stands in space with the volumes of a scene.

    Parameters
    ----------
    vertices : array, shape (n, 3), or an object that has vertices and faces
        World positions (x, y, z). Or a `wavesplat.Mesh`, a mesh of trimesh, PyVista, VTK or vedo, or a surface layer of
        napari, or its data (vertices, faces[, values]) in a tuple, whose axes are z, y, x.
    faces : integer array, shape (m, 3), optional
        Vertices of each triangle, by their numbers from 0. Needed with an array of vertices.
    color : colour or array, optional
        Of all: (r, g, b), "#rrggbb" or a name; or one for each vertex, shape (n, 3) or (n, 4). None is
        the colour of the mesh, if it has one, else ivory.
    values : array, shape (n,), optional
        Instead of `color`: a value for each vertex, coloured by `cmap`; where it is NaN the surface has a hole. Of a
        PyVista or VTK mesh also the name of one of its arrays.
    cmap : str, optional
        Colour map of the values; None is "viridis".
    clim : (low, high), optional
        Values of both ends of the map, or percentiles such as "1%"; None is the least and the largest.
    quantity, value_unit : str, optional
        Name of the values and their unit, such as "speed" and "m/s", for colour bars. Where `values` names an array or
        a column, this is the name.
    opacity : float, 0..1, default 1
        Of the surface, from whatever side and angle. Matter before it dims it, matter behind it is seen through it.
    normals : "smooth", "flat" or array, shape (n, 3)
        Directions for the light. "smooth": the normals of the mesh, else the mean of the triangles around each
        vertex, by area; "flat": each triangle has its own, for crystals and machine parts.
    lit : bool, default True
        The scene's light shines on it, on both sides, and matter casts its shadow on it; else colours are shown as
        given.
    clipped : bool, default False
        The scene's crops and clip planes cut it, too; cut-out boxes do not.
    visible : bool, default True
        Whether it is drawn; a hidden one stays in the scene.
    name : str, optional
        What messages and the viewer call it.

    Raises
    ------
    ArgumentError
        If an argument cannot work; the message names it, the row, and how to mend it.

    Examples
    --------
    >>> import wavesplat as ws
    >>> pelvis = ws.examples.ct_pelvis()
    >>> bone = ws.Surface(ws.mesh(pelvis, 300), color="red", opacity=0.5)
    >>> ws.Scene([pelvis, bone]).geometry[0]
    <Surface: 45855 vertices, 89938 faces>
    """

    KIND: ClassVar[str] = "surface"
    OF_FILE: ClassVar[frozenset[str]] = frozenset({"vertices", "faces", "values"})

    vertices: Any
    faces: Any = None
    _: KW_ONLY
    color: Color = None
    values: Any = None
    cmap: str | None = None
    clim: Any = None
    quantity: str | None = None
    value_unit: str | None = None
    opacity: float = 1.0
    normals: Any = "smooth"
    lit: bool = True
    clipped: bool = False
    visible: bool = True
    name: str | None = None

    def __post_init__(self) -> None:
        if self.faces is None:
            found = foreign_shapes.surface_of(self.vertices, self.values)
            normals = found.pop("normals", None)
            if normals is not None and isinstance(self.normals, str) and self.normals == "smooth":
                self._set(normals=normals)
            self._take(found)
        self._check_style()
        vertices = checked_positions(self.vertices, f"vertices of {self._title}", "vertex")
        n = len(vertices)
        color, values, cmap, clim = checked_paint(
            self.color, self.values, self.cmap, self.clim, n=n, what=self._title, each="vertex"
        )
        self._set(
            vertices=vertices,
            faces=_faces(self.faces, n, self._title),
            color=color,
            values=values,
            cmap=cmap,
            clim=clim,
            normals=_normals(self.normals, n, self._title),
        )

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Corners (lower, upper) of the world box around it, shape (2, 3), as (x, y, z)."""
        seen = self._positions
        return np.stack([seen.min(axis=0), seen.max(axis=0)])

    @property
    def _positions(self) -> NDArray[np.float64]:
        """Positions of the vertices of triangles."""
        used = np.zeros(len(self.vertices), bool)
        used[self.faces] = True
        seen: NDArray[np.float64] = self.vertices[used]
        return seen

    def _arrays(self) -> _native.MeshArrays:
        """The surface as the compiled module takes it."""
        paint, opacity = paint_of(self.color, self._mapped, self.opacity, IVORY)
        normals = self.normals
        if isinstance(normals, str):
            normals = smooth_normals(self.vertices, self.faces) if normals == "smooth" else None
        return {
            "vertices": self.vertices,
            "faces": self.faces,
            "normals": normals,
            "paint": paint,
            "style": (opacity, self.lit, self.clipped),
        }

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"<Surface{name}: {len(self.vertices)} vertices, {len(self.faces)} faces>"


def _faces(given: Any, n: int, title: str) -> NDArray[np.uint32]:
    """Checked faces; an `ArgumentError` names the first that has a vertex which does not exist."""
    form = f"an integer array of shape (m, 3): three vertices of each triangle, by their numbers 0 to {n - 1}"
    array: NDArray[Any] = np.asarray(given) if given is not None else np.empty(0)
    if given is None or array.dtype.kind not in "iu" or array.ndim != 2 or array.shape[1] != 3:
        what = described(given) if given is None or not array.ndim else f"{array.dtype} of shape {array.shape}"
        raise ArgumentError(f"faces of {title} is {what}; give {form}; quadrilaterals are two triangles each")
    check_count(array, f"faces of {title}")
    if not len(array):
        raise ArgumentError(f"faces of {title} is empty: it has no triangles; leave the surface out")
    is_right = ((array >= 0) & (array < n)).all(axis=1)
    if not is_right.all():
        row = int(np.argmin(is_right))
        raise ArgumentError(
            f"faces[{row}] of {title} is {tuple(array[row].tolist())}, and there are {n} vertices; give {form}; do "
            "vertices and faces belong together?"
        )
    return frozen(np.array(array, np.uint32))


def _normals(given: Any, n: int, title: str) -> Any:
    """A way to find normals, or checked normals."""
    form = f'"smooth", "flat" or a direction for each vertex, shape ({n}, 3)'
    if isinstance(given, str):
        if given not in ("smooth", "flat"):
            raise ArgumentError(f"normals of {title} is {given!r}; give {form}")
        return given
    array = numbers_of(given, f"normals of {title}", form)
    if array.shape != (n, 3):
        raise ArgumentError(f"normals of {title} has shape {array.shape}, and there are {n} vertices; give {form}")
    lengths = np.linalg.norm(array, axis=1)
    if not np.isfinite(lengths).all():
        row = int(np.argmin(np.isfinite(lengths)))
        raise ArgumentError(f"normals[{row}] of {title} is not finite; give {form}")
    array[lengths == 0], lengths[lengths == 0] = (0, 0, 1), 1
    lengths[np.abs(lengths - 1) < ROUNDED] = 1  # so that documents read back to the bit
    return frozen((array / lengths[:, None]).astype(np.float32))
