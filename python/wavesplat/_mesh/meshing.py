"""Surfaces as triangle meshes in the world: for looking, measuring and printing where no renderer is at hand.

`isosurface` finds the surface of a value, `label_surfaces` finds the surfaces of labels.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import overload

import numpy as np

from wavesplat._geometry.surface import normals_of_faces
from wavesplat._looks.labels.labels import Labels
from wavesplat._mesh.isosurface import Isosurface, isosurface
from wavesplat._mesh.label_surfaces import boxes_of, chosen_numbers, surface_of
from wavesplat._mesh.triangle_mesh import Mesh, Meshes
from wavesplat._model.arguments.clips import Crop
from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.volume_like import VolumeLike, as_volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._public import public
from wavesplat._system.values import number, share, whole
from wavesplat.errors import ArgumentError


@overload
def mesh(
    volume: VolumeLike, iso_value: float, *, closed: bool = True, step: int = 1, crop: Crop | None = None
) -> Mesh: ...


@overload
def mesh(
    volume: VolumeLike | Labels,
    *,
    labels: int | str | Iterable[int | str],
    smoothing: float = 0.5,
) -> Meshes: ...


@public
@takes_its_types
def mesh(
    volume: VolumeLike | Labels,
    iso_value: float | None = None,
    *,
    closed: bool = True,
    step: int = 1,
    crop: Crop | None = None,
    labels: str | int | Iterable[int | str] | None = None,
    smoothing: float = 0.5,
) -> Mesh | Meshes:
    """The surface where the volume has a value, or the surfaces of its labels, as triangles in the world.

    Parameters
    ----------
    volume : Volume, WaveletVolume, array, or what else `Volume` takes
        Inside is where samples are larger than `iso_value`; NaN and infinity are outside. For `labels` a segmentation,
        or `Labels`, whose names and colours the meshes have.
    iso_value : float, optional
        The surface's value, in sample units.
    closed : bool, default True
        Close the surface where the volume's faces, holes or the crop cut it; else leave it open there.
    step : int, default 1
        Take every n-th sample along each axis, and the last: fewer triangles and less detail.
    crop : Crop, optional
        Only what lies in this box. An open surface ends up to a cell before it.
    labels : "all", or numbers and names, optional
        Instead of `iso_value`: a closed mesh of each of these labels, smoothed by a windowed sinc, which encloses the
        volume of the label's samples.
    smoothing : float, 0 to 1, default 0.5
        How much meshes of labels are smoothed, as in 3D Slicer; 0 leaves the stairs of the samples.

    Returns
    -------
    Mesh or Meshes
        Vertices and normals in the world, triangles counter-clockwise seen from outside for any affine. `Meshes`, one
        for each label, where `labels` is given.

    Raises
    ------
    ArgumentError
        If no surface has this value; the message says the samples' range. If there is no such label. If an argument
        cannot work.
    LibraryError
        If scikit-image or SciPy is not installed (`pip install "wavesplat[mesh]"`).

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> z, y, x = np.mgrid[-12:13, -12:13, -12:13]
    >>> ball = ws.Volume(10 - np.sqrt(x**2 + y**2 + z**2), spacing=(0.5, 0.5, 0.5))
    >>> surface = ws.mesh(ball, 0)
    >>> surface.watertight, round(surface.volume / (4 / 3 * np.pi * 5**3), 1)
    (True, 1.0)

    Of a segmentation, a mesh of each label:

    >>> segmentation = np.where(x < 0, 1, 2) * (ball.samples > 0)
    >>> meshes = ws.mesh(segmentation, labels="all")
    >>> meshes.names, round(meshes[1].volume / int(np.sum(segmentation == 1)), 2)
    (('1', '2'), 1.0)

    Notes
    -----
    Smoothing: G. Taubin, T. Zhang, G. Golub, Optimal surface smoothing as filter design (ECCV 1996). The number of
    iterations and the pass band are as in 3D Slicer, 20 + 40 s and 10^(-4 s), for `smoothing` s; thin parts, which
    would shrink, have a wider band. Then the surface is moved along its normals until its volume is right.
    """
    if labels is not None:
        if iso_value is not None:
            raise ArgumentError("iso_value and labels both say what the surface is; give one of them")
        given = [name for name, is_given in (("closed", not closed), ("step", step != 1), ("crop", crop)) if is_given]
        if given:
            raise ArgumentError(f"{', '.join(given)}: only for the surface of a value; leave out either it or labels")
        return _of_labels(volume, labels, smoothing)
    if isinstance(volume, Labels):
        raise ArgumentError('volume is a Labels; say which of them, as labels="all"')
    if iso_value is None:
        raise ArgumentError('mesh needs the surface\'s value, iso_value=, or labels="all" of a segmentation')
    iso_value = number(iso_value, "iso_value", "a finite number in sample units")
    step = whole(step, "step", "a whole number of at least 1", least=1)
    if crop is not None and not isinstance(crop, Crop):
        raise ArgumentError(f"crop is a {type(crop).__name__}; give a wavesplat.Crop(lower, upper, space=...)")
    scanned = as_volume(volume)
    scan = scanned.to_volume() if isinstance(scanned, WaveletVolume) else scanned
    _check_range(scan, iso_value)
    surface = isosurface(scan, iso_value, step=step, crop=crop)
    return _in_world(scan, surface if closed else _left_open(surface, scan.name))


def _of_labels(segmentation: VolumeLike | Labels, which: object, smoothing: float) -> Meshes:
    strength = share(smoothing, "smoothing", "a number 0..1, 0 leaves the stairs of samples")
    unit = segmentation.unit if isinstance(segmentation, Volume) else None
    labels = segmentation if isinstance(segmentation, Labels) else Labels(segmentation)
    numbers, boxes = chosen_numbers(labels, which), boxes_of(labels)
    parts = (surface_of(labels, number, boxes[number], smoothing=strength, unit=unit) for number in numbers)
    return Meshes(tuple(parts), tuple(numbers))


# Arguments -----------------------------------------------------------------------------------------------------------


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
    of_faces = normals_of_faces(vertices, faces)
    # Cuts have no gradient, and across a sheet as thin as a sample central differences may point inside.
    unsure = surface.on_cut | ~(np.einsum("ij,ij->i", normals, of_faces) > 0)
    normals[unsure] = of_faces[unsure]
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(vertices, faces, normals / np.where(lengths > 0, lengths, 1), unit=volume.unit)
