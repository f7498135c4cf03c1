"""Surfaces, lines and points of other libraries' objects, as fields of ours.

Objects are recognised by the library of their class, so that nothing is imported that was not given.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.volume import units
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

#: Layers of napari -> the kind of shape that they become.
NAPARI = {"Surface": "surface", "Tracks": "lines", "Shapes": "lines", "Points": "points"}
#: Corners of a closed curve for an ellipse of napari.
ELLIPSE = 48


def libraries_of(thing: object) -> set[str]:
    """Libraries of the class of an object and of its bases."""
    return {base.__module__.partition(".")[0] for base in type(thing).__mro__}


def is_shape_like(thing: object) -> bool:
    """Whether an object is a surface, lines or points of a library that we take, or a mesh of ours."""
    return kind_of(thing) is not None


def kind_of(thing: object) -> str | None:
    """Kind of shape that an object becomes; None for anything else."""
    if _is_mesh_of_ours(thing):
        return "surface"
    libraries, name = libraries_of(thing), type(thing).__name__
    if "napari" in libraries:
        return NAPARI.get(name)
    if "nibabel" in libraries and hasattr(thing, "streamlines"):
        return "lines"
    if "nibabel" in libraries and name == "ArraySequence":
        return "lines"
    if "trimesh" in libraries and hasattr(thing, "vertices"):
        return "surface" if hasattr(thing, "faces") else "points"
    mesh = _poly_data(thing, libraries)
    if mesh is None:
        return None
    if mesh.GetNumberOfPolys() or mesh.GetNumberOfStrips():
        return "surface"
    return "lines" if mesh.GetNumberOfLines() else "points"


def _is_mesh_of_ours(thing: object) -> bool:
    return type(thing).__module__ == "wavesplat" and type(thing).__name__ == "Mesh"


def _poly_data(thing: Any, libraries: set[str]) -> Any:
    """A vtkPolyData: the object itself, or the data of a mesh of vedo; None for anything else."""
    if "vedo" in libraries and hasattr(thing, "dataset"):
        thing = thing.dataset
        libraries = libraries_of(thing)
    is_one = bool(libraries & {"vtkmodules", "pyvista"}) and hasattr(thing, "GetPolys")
    return thing if is_one else None


# Surfaces -------------------------------------------------------------------------------------------------------------


def surface_of(thing: Any, values: Any) -> dict[str, Any]:
    """Fields of a surface; an `ArgumentError` for what has no faces. `values`: perhaps the name of an array."""
    libraries = libraries_of(thing)
    if _is_mesh_of_ours(thing):
        found = {"vertices": thing.vertices, "faces": thing.faces, "normals": thing.normals, "color": thing.color}
        return found | {"name": thing.name or None}
    if "trimesh" in libraries and hasattr(thing, "faces"):
        return {"vertices": thing.vertices, "faces": thing.faces, **_colors_of_trimesh(thing)}
    if "napari" in libraries and type(thing).__name__ == "Surface":
        return _of_napari_surface(thing)
    mesh = _poly_data(thing, libraries)
    if mesh is not None:
        faces = _triangles(mesh)
        if not len(faces):
            raise ArgumentError(
                f"this {type(thing).__name__} has no triangles; draw its lines with wavesplat.Lines, its points with "
                "wavesplat.Points"
            )
        return {"vertices": _points(mesh), "faces": faces, **_named_values(mesh, values)}
    if isinstance(thing, tuple) and len(thing) in (2, 3) and np.ndim(thing[0]) == 2 == np.ndim(thing[1]):
        # As napari has it: axes z, y, x.
        vertices = np.asarray(thing[0])[:, ::-1]
        return {"vertices": vertices, "faces": thing[1], **({"values": thing[2]} if len(thing) == 3 else {})}
    raise ArgumentError(
        f"faces is missing, and vertices is {described(thing)}; give faces too, an integer array of shape (m, 3), or a "
        "mesh: of wavesplat.mesh, trimesh, PyVista, VTK or vedo, or a surface layer of napari"
    )


def _colors_of_trimesh(mesh: Any) -> dict[str, Any]:
    """Colours of the vertices, where the mesh has such."""
    visual: Any = getattr(mesh, "visual", None)
    if getattr(visual, "kind", None) not in ("vertex", "face"):
        return {}
    colors: NDArray[Any] = np.asarray(visual.vertex_colors)
    return {"color": colors} if colors.shape == (len(mesh.vertices), 4) else {}


def _of_napari_surface(layer: Any) -> dict[str, Any]:
    vertices, faces, values = layer.data
    world = napari_world(layer, np.asarray(vertices, np.float64))
    values = np.asarray(values)
    has_values = values.shape == (len(world),) and np.ptp(values) > 0
    return {"vertices": world, "faces": faces, "name": str(layer.name), **({"values": values} if has_values else {})}


def _triangles(mesh: Any) -> NDArray[np.int64]:
    """Triangles of a vtkPolyData; polygons of more corners are fans of them."""
    cells = mesh.GetPolys()
    corners = _array(cells.GetConnectivityArray())
    starts = _array(cells.GetOffsetsArray())
    n = np.diff(starts)
    fans = [
        np.stack([corners[begin], corners[begin + k], corners[begin + k + 1]], axis=1)
        for k in range(1, int(n.max(initial=2)) - 1)
        for begin in [starts[:-1][n > k + 1]]
    ]
    strips = _strips(mesh)
    return np.concatenate([*fans, *strips]) if fans or strips else np.empty((0, 3), np.int64)


def _strips(mesh: Any) -> list[NDArray[np.int64]]:
    """Triangles of triangle strips, every second one turned round."""
    found = []
    for strip in _cells(mesh.GetStrips()):
        k = np.arange(len(strip) - 2)
        odd = k % 2
        found.append(np.stack([strip[k], strip[k + 1 + odd], strip[k + 2 - odd]], axis=1))
    return found


# Lines ----------------------------------------------------------------------------------------------------------------


def lines_of(thing: Any, values: Any) -> dict[str, Any]:
    """Fields of lines; none where the object is of no library that we know."""
    libraries, name = libraries_of(thing), type(thing).__name__
    if "nibabel" in libraries:
        streamlines = getattr(thing, "streamlines", thing)
        return {"paths": [np.asarray(one) for one in streamlines]}
    if "napari" in libraries:
        if name == "Tracks":
            return _of_napari_tracks(thing)
        if name == "Shapes":
            return _of_napari_shapes(thing)
        raise ArgumentError(f"a layer of {name} has no lines; give one of tracks or shapes")
    mesh = _poly_data(thing, libraries)
    if mesh is None:
        return {}
    points, cells = _points(mesh), _cells(mesh.GetLines())
    if not cells:
        raise ArgumentError(
            f"this {name} has no lines; draw its triangles with wavesplat.Surface, its points with wavesplat.Points"
        )
    found = _named_values(mesh, values)
    if "values" in found:
        found["values"] = np.concatenate([found["values"][cell] for cell in cells])
    return {"paths": [points[cell] for cell in cells], **found}


def _of_napari_tracks(layer: Any) -> dict[str, Any]:
    data = np.asarray(layer.data, np.float64)
    numbers, positions = data[:, 0], data[:, 1:]
    order = np.lexsort((positions[:, 0], numbers))
    world = napari_world(layer, positions, n_times=1)[order]
    ends = np.flatnonzero(np.diff(numbers[order])) + 1
    return {"paths": np.split(world, ends), "name": str(layer.name)}


def _of_napari_shapes(layer: Any) -> dict[str, Any]:
    return {"paths": napari_outlines(layer), "name": str(layer.name)}


def napari_outlines(layer: Any) -> list[NDArray[np.float64]]:
    """World positions, shape (n, 3), along the outline of each shape of a layer of shapes."""
    paths = []
    for data, kind in zip(layer.data, layer.shape_type, strict=True):
        corners = np.asarray(data, np.float64)
        if kind == "ellipse":
            angles = np.linspace(0, 2 * np.pi, ELLIPSE)[:, None]
            middle, a, b = corners.mean(axis=0), (corners[1] - corners[0]) / 2, (corners[3] - corners[0]) / 2
            corners = middle + np.cos(angles) * a + np.sin(angles) * b
        elif kind in ("rectangle", "polygon"):
            corners = np.concatenate([corners, corners[:1]])
        paths.append(napari_world(layer, corners))
    return paths


# Points ---------------------------------------------------------------------------------------------------------------


def points_of(thing: Any, values: Any) -> dict[str, Any]:
    """Fields of points; none where the object is of no library that we know."""
    libraries = libraries_of(thing)
    if "napari" in libraries:
        if type(thing).__name__ != "Points":
            raise ArgumentError(f"a layer of {type(thing).__name__} has no points; give one of points")
        return {"positions": napari_world(thing, np.asarray(thing.data, np.float64)), "name": str(thing.name)}
    if "trimesh" in libraries and hasattr(thing, "vertices"):
        return {"positions": thing.vertices}
    mesh = _poly_data(thing, libraries)
    return {} if mesh is None else {"positions": _points(mesh), **_named_values(mesh, values)}


# Of libraries ---------------------------------------------------------------------------------------------------------


def napari_world(layer: Any, positions: NDArray[Any], n_times: int = 0) -> NDArray[np.float64]:
    """World positions (x, y, z) of positions in a layer, whose last axes are z, y and x; of planes z is 0.

    n_times : axes of times at the beginning, which are no places.
    """
    n = int(np.shape(positions)[1])
    # napari keeps its transforms apart, and composes them itself: the map of the axes gives the whole affine map.
    ends = np.array([layer.data_to_world(one) for one in np.vstack([np.zeros(n), np.eye(n)])], np.float64)
    world = positions @ (ends[1:] - ends[0]) + ends[0]
    axes = [axis for axis in (n - 1, n - 2, n - 3) if axis >= n_times]
    xyz = np.zeros((len(world), 3))
    xyz[:, : len(axes)] = world[:, axes]
    named = [units.canonical(unit) for unit in (getattr(layer, "units", None) or ())]
    if len(named) == n and len(axes) == 3:
        _, factors = units.in_one_unit((named[-1], named[-2], named[-3]))
        xyz *= factors
    return xyz


def _points(mesh: Any) -> NDArray[np.float64]:
    points = mesh.GetPoints()
    if points is None or not points.GetNumberOfPoints():
        raise ArgumentError(f"this {type(mesh).__name__} has no points; leave it out")
    return _array(points.GetData()).astype(np.float64)


def _cells(cells: Any) -> list[NDArray[np.int64]]:
    if cells is None or not cells.GetNumberOfCells():
        return []
    corners, starts = _array(cells.GetConnectivityArray()), _array(cells.GetOffsetsArray())
    return np.split(corners, starts[1:-1])


def _array(array: Any) -> NDArray[Any]:
    from vtkmodules.util.numpy_support import vtk_to_numpy  # the object's own library

    found: NDArray[Any] = vtk_to_numpy(array)
    return found


def _named_values(mesh: Any, name: Any) -> dict[str, Any]:
    """Values of the points by the name of an array; none where no name is given."""
    if not isinstance(name, str):
        return {}
    of_points = mesh.GetPointData()
    array = of_points.GetArray(name)
    if array is None:
        names: Iterable[str] = [str(of_points.GetArrayName(k)) for k in range(of_points.GetNumberOfArrays())]
        raise ArgumentError(f"the points have no array {name!r}; there are: {', '.join(names) or 'none'}")
    values = _array(array)
    is_vector = values.ndim > 1
    return {
        "values": np.linalg.norm(values, axis=1) if is_vector else values,
        "quantity": f"{name} magnitude" if is_vector else name,
    }
