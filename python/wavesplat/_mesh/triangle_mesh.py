"""Triangle meshes in the world, one of a surface or several of labels, and what they measure.

trimesh, well kept and without dependencies but NumPy, writes most files and checks that surfaces are closed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.surface import face_vectors
from wavesplat._mesh import mesh_files
from wavesplat._mesh.mesh_files import safe_names
from wavesplat._public import public
from wavesplat._storage.output import check_output, write_atomically
from wavesplat._system.libraries import library
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    import trimesh

Floats = NDArray[np.float64]

#: Words in braces that stand for the name and the number of each label in the name of a file.
PLACE = re.compile(r"\{(name|number)\}")


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
        Unit vectors that point outside, from the volume's gradient; on cut faces, where that points inside, and of
        labels, from the triangles.
    name : str
        Name of the label; empty for the surface of a value.
    color : three numbers 0..1, optional
        Red, green and blue of the label.
    unit : str, optional
        Unit of the world's lengths, such as "mm", where it is known.
    """

    vertices: Floats
    faces: NDArray[np.int32]
    normals: Floats
    name: str = ""
    color: tuple[float, float, float] | None = None
    unit: str | None = None

    @property
    def area(self) -> float:
        """Area of all triangles, world units squared."""
        return float(np.linalg.norm(face_vectors(self.vertices, self.faces), axis=1).sum() / 2)

    @property
    def volume(self) -> float:
        """Volume inside, world units cubed; meaningless if the mesh is open."""
        vectors = face_vectors(self.vertices, self.faces)
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
            `.ply`, `.stl` (both binary), `.obj`, `.glb`, `.gltf` (one file, buffers inside), or `.3mf`, for printers,
            whose lengths have a unit (millimetres where the mesh has none). All but `.stl` and `.3mf` hold the normals
            too. glTF and 3MF hold name and colour.

        Raises
        ------
        FileError
            If the suffix is unknown or the file cannot be written; an existing file is replaced only by a whole one.
        LibraryError
            If trimesh is not installed.
        """
        suffix = check_output(path, "meshes")
        _write(path, mesh_files.encoded([self], suffix))

    def __repr__(self) -> str:
        name = f" {self.name!r}" if self.name else ""
        return f"<Mesh{name}: {len(self.vertices)} vertices, {len(self.faces)} faces>"


@public
@dataclass(frozen=True, eq=False)
class Meshes:
    """Meshes of the labels of a segmentation, in the order of their numbers; made by `mesh`.

    They are in a sequence, and found by number or name: `meshes[5]`, `meshes["liver"]`.

    Attributes
    ----------
    parts : tuple of Mesh
        A closed mesh of each label, with its name and colour.
    numbers : tuple of int
        The labels' numbers, in the same order.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> segmentation = np.zeros((9, 9, 9), np.uint8)
    >>> segmentation[2:7, 2:7, 2:7] = 1
    >>> meshes = ws.mesh(ws.Labels(segmentation, {1: ws.Label("red", name="cube")}), labels="all")
    >>> meshes, round(meshes["cube"].volume, 1)
    (<Meshes: cube>, 125.0)
    >>> [path.name for path in meshes.save("{name}.3mf")]
    ['cube.3mf']
    """

    parts: tuple[Mesh, ...]
    numbers: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.parts)

    def __iter__(self) -> Iterator[Mesh]:
        return iter(self.parts)

    def __getitem__(self, label: int | str) -> Mesh:
        """The mesh of a label, by its number or its name."""
        for number, part in zip(self.numbers, self.parts, strict=True):
            if label in (number, part.name):
                return part
        raise ArgumentError(f"there is no mesh of the label {described(label)}; there are {', '.join(self.names)}")

    @property
    def names(self) -> tuple[str, ...]:
        """The labels' names, in order."""
        return tuple(part.name for part in self.parts)

    def paths(self, path: str | PathLike[str]) -> list[Path]:
        """The files that `save` writes: one of each label where `path` has a word in braces, else one of all.

        Raises
        ------
        FileError
            If one of them cannot be written, or their suffix is unknown.
        ArgumentError
            If one file is to hold several meshes, and its format cannot.
        """
        text = fspath(path)
        if not PLACE.search(Path(text).name):
            suffix = check_output(path, "meshes")
            if len(self.parts) > 1 and suffix not in mesh_files.OF_PARTS:
                raise ArgumentError(
                    f"{suffix} holds one mesh, and there are {len(self.parts)} labels; write {{name}} in the file's "
                    f"name, as in '{{name}}{suffix}', or use one of {', '.join(mesh_files.OF_PARTS)}: {path}"
                )
            return [Path(text)]
        found = [
            Path(text).with_name(Path(text).name.replace("{name}", name).replace("{number}", str(number)))
            for name, number in zip(safe_names(self.names, self.numbers), self.numbers, strict=True)
        ]
        for one in found:
            check_output(one, "meshes")
        return found

    def save(self, path: str | PathLike[str]) -> list[Path]:
        """Write the meshes: each to a file of its own, or all to one, as parts with names and colours.

        Parameters
        ----------
        path : path
            With `{name}` or `{number}` in the file's name, such as `{name}.stl`, a file of each label, in any format of
            `Mesh.save`; what file systems do not take in a name becomes `_`. Else one file: `.3mf`, `.glb` or `.gltf`.

        Returns
        -------
        list of Path
            The files, in the order of the labels.

        Raises
        ------
        FileError
            If a suffix is unknown or a file cannot be written.
        ArgumentError
            If the format holds but one mesh.
        LibraryError
            If trimesh is not installed.
        """
        paths = self.paths(path)
        groups = [[part] for part in self.parts] if len(paths) == len(self.parts) else [list(self.parts)]
        for one, parts in zip(paths, groups, strict=True):
            _write(one, mesh_files.encoded(parts, check_output(one, "meshes")))
        return paths

    def __repr__(self) -> str:
        return f"<Meshes: {', '.join(self.names[:8])}{', ...' if len(self) > 8 else ''}>"


def _write(path: str | PathLike[str], content: bytes) -> None:
    write_atomically(path, lambda part: part.write_bytes(content))
