"""Surfaces as triangle meshes in the world: for looking, measuring and printing where no renderer is at hand.

`isosurface` finds them; trimesh, well kept and without dependencies but NumPy, writes the files and checks that
surfaces are closed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from operator import index
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files.libraries import library
from wavesplat._files.output import check_output, write_atomically
from wavesplat._mesh.isosurface import Isosurface, isosurface
from wavesplat._model.argument_types import takes_its_types
from wavesplat._model.crop import Crop
from wavesplat._model.volume import Volume
from wavesplat._model.volume_like import VolumeLike, as_volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._public import public
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    import trimesh

__all__ = ["Mesh", "mesh"]

Floats = NDArray[np.float64]


@public
@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh in world units; made by `mesh`.

    Attributes
    ----------
    vertices : float64 array, shape (n, 3)
        World positions (x, y, z).
    faces : integer array, shape (m, 3)
        Vertices of each triangle, counter-clockwise seen from outside, where samples are smaller.
    normals : float64 array, shape (n, 3)
        Unit vectors that point outside, from the volume's gradient; on cut faces and where that points
        inside, from the triangles.
    """

    vertices: Floats
    faces: NDArray[np.int32]
    normals: Floats

    @property
    def area(self) -> float:
        """Area of all triangles, world units squared."""
        return float(np.linalg.norm(_face_vectors(self.vertices, self.faces), axis=1).sum() / 2)

    @property
    def volume(self) -> float:
        """Volume inside, world units cubed; meaningless if the mesh is open."""
        vectors = _face_vectors(self.vertices, self.faces)
        middle = self.vertices.mean(axis=0)  # near the surface, so that large coordinates cost no digits
        return float(np.einsum("ij,ij->", self.vertices[self.faces[:, 0]] - middle, vectors) / 6)

    @property
    def watertight(self) -> bool:
        """Whether every edge joins exactly two triangles, which agree on what is outside."""
        checked = self.to_trimesh()
        return bool(checked.is_watertight and checked.is_winding_consistent)

    def facts(self) -> dict[str, Any]:
        """Facts for `wavesplat mesh --json`; world units, squared and cubed. An open mesh has no volume."""
        watertight = self.watertight
        return {
            "n_vertices": len(self.vertices),
            "n_faces": len(self.faces),
            "area": self.area,
            "volume": self.volume if watertight else None,
            "watertight": watertight,
            "bounds_xyz": [self.vertices.min(axis=0).tolist(), self.vertices.max(axis=0).tolist()],
        }

    def to_trimesh(self) -> trimesh.Trimesh:
        """The mesh as a `trimesh.Trimesh`: to repair, simplify, smooth, measure or show it."""
        made: trimesh.Trimesh = library("trimesh", extra="mesh").Trimesh(
            self.vertices, self.faces, vertex_normals=self.normals, process=False
        )
        return made

    def save(self, path: str | PathLike[str]) -> None:
        """Write the mesh to a file; the suffix chooses the format.

        Coordinates are float32 (.obj: eight decimals), in the volume's world units and axes in every format.
        glTF by convention counts metres, with y up: scale and turn there what came from a scanner in millimetres.

        Parameters
        ----------
        path : path
            `.ply`, `.stl` (both binary), `.obj`, `.glb`, or `.gltf` (one file, buffers inside).
            All but `.stl` hold the normals too.

        Raises
        ------
        FileError
            If the suffix is unknown or the file cannot be written; an existing file is replaced only by a whole one.
        LibraryError
            If trimesh is not installed.
        """
        suffix = check_output(path, "meshes")
        content = _encoded(self.to_trimesh(), suffix)
        write_atomically(path, lambda part: part.write_bytes(content))

    def __repr__(self) -> str:
        return f"<Mesh: {len(self.vertices)} vertices, {len(self.faces)} faces>"


@public
@takes_its_types
def mesh(
    volume: VolumeLike,
    iso_value: float,
    *,
    closed: bool = True,
    step: int = 1,
    crop: Crop | None = None,
) -> Mesh:
    """The surface where the volume has a value, as triangles in the world.

    Parameters
    ----------
    volume : Volume, WaveletVolume, array, or what else `Volume` takes
        Inside is where samples are larger than `iso_value`; NaN and infinity are outside.
    iso_value : float
        The surface's value, in sample units.
    closed : bool, default True
        Close the surface where the volume's faces, holes or the crop cut it; else leave it open there.
    step : int, default 1
        Take every n-th sample along each axis, and the last: fewer triangles and less detail.
    crop : Crop, optional
        Only what lies in this box. An open surface ends up to a cell before it.

    Returns
    -------
    Mesh
        Vertices and normals in the world, triangles counter-clockwise seen from outside for any affine.

    Raises
    ------
    ArgumentError
        If no surface has this value; the message says the samples' range. If an argument cannot work.
    LibraryError
        If scikit-image is not installed (`pip install ".[mesh]"` in the checkout).

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> z, y, x = np.mgrid[-12:13, -12:13, -12:13]
    >>> ball = ws.Volume(10 - np.sqrt(x**2 + y**2 + z**2), spacing=(0.5, 0.5, 0.5))
    >>> surface = ws.mesh(ball, 0)
    >>> surface.watertight, round(surface.volume / (4 / 3 * np.pi * 5**3), 1)
    (True, 1.0)
    """
    iso_value, step = _checked_numbers(iso_value, step)
    if crop is not None and not isinstance(crop, Crop):
        raise ArgumentError(f"crop is a {type(crop).__name__}; give a wavesplat.Crop(lower, upper, space=...)")
    given = as_volume(volume)
    volume = given.to_volume() if isinstance(given, WaveletVolume) else given
    _check_range(volume, iso_value)
    surface = isosurface(volume, iso_value, step=step, crop=crop)
    return _in_world(volume, surface if closed else _left_open(surface, volume.name))


# Arguments -----------------------------------------------------------------------------------------------------------


def _checked_numbers(iso_value: float, step: int) -> tuple[float, int]:
    try:
        value = float(iso_value)
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"iso_value is {iso_value!r}; give a number in sample units") from None
    if not isfinite(value):
        raise ArgumentError(f"iso_value is {value}; give a finite number in sample units")
    try:
        count = index(step)
    except TypeError:
        raise ArgumentError(f"step is {step!r}; give a whole number") from None
    if count < 1:
        raise ArgumentError(f"step is {count}; give a whole number of at least 1")
    return value, count


def _check_range(volume: Volume, iso_value: float) -> None:
    low, high = volume.value_range
    if not low <= iso_value < high:
        raise ArgumentError(
            f"volume {volume.name!r} has no surface at iso value {iso_value:g}: its samples are {low:g} to {high:g}; "
            "give a value from the first to below the second"
        )


# From index space to the world ----------------------------------------------------------------------------------------


def _left_open(surface: Isosurface, name: str) -> Isosurface:
    """Remove the triangles that close the surface, and vertices that are unused then."""
    faces = surface.faces[~surface.on_cut[surface.faces].any(axis=1)]
    if len(faces) == 0:
        raise ArgumentError(f"volume {name!r}: all of the surface closes cuts, so nothing is left open; use closed")
    used = np.zeros(len(surface.positions), bool)
    used[faces] = True
    renumbered = np.cumsum(used, dtype=np.int32) - 1
    return Isosurface(surface.positions[used], surface.gradients[used], surface.on_cut[used], renumbered[faces])


def _in_world(volume: Volume, surface: Isosurface) -> Mesh:
    matrix = volume.world_from_index
    vertices = surface.positions @ matrix[:3, :3].T + matrix[:3, 3]
    mirrored = np.linalg.det(matrix[:3, :3]) < 0
    faces = np.ascontiguousarray(surface.faces[:, ::-1] if mirrored else surface.faces, np.int32)
    normals = -surface.gradients @ np.linalg.inv(matrix[:3, :3])
    of_faces = _normals_of_faces(vertices, faces)
    # Cuts have no gradient, and across a sheet as thin as a sample central differences may point inside.
    unsure = surface.on_cut | ~(np.einsum("ij,ij->i", normals, of_faces) > 0)
    normals[unsure] = of_faces[unsure]
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(vertices, faces, normals / np.where(lengths > 0, lengths, 1))


def _normals_of_faces(vertices: Floats, faces: NDArray[np.int32]) -> Floats:
    """Sum of the vectors of the faces around each vertex: their mean by area."""
    vectors = _face_vectors(vertices, faces)
    corners = faces.ravel()
    return np.stack([np.bincount(corners, np.repeat(vectors[:, axis], 3), len(vertices)) for axis in range(3)], axis=1)


def _face_vectors(vertices: Floats, faces: NDArray[np.int32]) -> Floats:
    """Outward vectors of twice the faces' areas."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    vectors: Floats = np.cross(b - a, c - a)
    return vectors


# Files ---------------------------------------------------------------------------------------------------------------


def _encoded(surface: Any, suffix: str) -> bytes:
    """The file's content."""
    if suffix == ".gltf":
        files = library("trimesh.exchange.gltf", extra="mesh").export_gltf(
            surface.scene(), include_normals=True, merge_buffers=True, embed_buffers=True
        )
        content = files["model.gltf"]
    else:
        options: dict[str, Any] = {
            ".ply": {"vertex_normal": True},
            ".obj": {"include_normals": True},
            ".glb": {"include_normals": True},
        }.get(suffix, {})
        content = surface.export(file_type=suffix[1:], **options)
    return content.encode() if isinstance(content, str) else bytes(content)
