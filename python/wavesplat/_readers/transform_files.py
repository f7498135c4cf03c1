"""Affine transforms from the files of registrations: ITK (ANTs, 3D Slicer, elastix), LTA of FreeSurfer, FLIRT of FSL.

Each is read as the map from the moving scan's world to the fixed scan's. The files' own directions:

- ITK stores the map from points of the fixed scan to points of the moving one, LPS, which resampling needs.
- LTA of type 0 or 1 stores the map from `src` to `dst`, in voxels or RAS. `src` is the moving scan (`--mov` of
  `mri_robust_register` and `bbregister`), unless its grid is the grid of the fixed one. Source: FreeSurfer,
  utils/transform.cpp.
- FLIRT stores the map from the moving scan (`-in`) to the fixed one (`-ref`) between voxel indices times spacing, the
  first axis reversed where the affine's determinant is positive. Source: FSL, wiki "FLIRT/FAQ", newimage.h
  (`newimagevox2mm_mat`, `sampling_mat` with `swapmat`).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.arguments.types import takes_its_types
from wavesplat._model.interchange.hdf5 import check_links
from wavesplat._model.volume import affine
from wavesplat._model.volume.grid import Grid
from wavesplat._model.volume.volume_like import VolumeLike, as_volume
from wavesplat._public import public
from wavesplat._storage.paths import check_no_pipe, expanded
from wavesplat._system.threads import warn
from wavesplat.errors import ArgumentError, FileError

Matrix = NDArray[np.float64]

ITK, LTA, MAT = (".tfm", ".txt", ".h5", ".hdf5"), (".lta",), (".mat",)
FIELDS = (".nii", ".nii.gz", ".mgz", ".mgh", ".m3z", ".nrrd", ".nhdr", ".mha", ".mhd")
NO_FIELDS = (
    "is not affine: it moves every place by itself. Resample the scan with the tool that made it (antsApplyTransforms, "
    "applywarp, mri_vol2vol, or Harden Transform in 3D Slicer), and open the result"
)
#: Other formats of linear transforms, and a command that converts each.
CONVERTED = {
    ".xfm": "lta_convert --inmni FILE --outlta a.lta --src MOVING --trg FIXED",
    ".dat": "lta_convert --inreg FILE --outlta a.lta --src MOVING --trg FIXED",
    ".1d": "cat_matvec -ONELINE, or ConvertTransformFile of ANTs, to an ITK transform",
}
#: LTA: the map is between voxels, or between places of the RAS world.
VOXELS, PLACES = 0, 1
#: Millimetres, within which two grids are one: headers are rounded.
SAME_GRID_MM = 0.05
#: Bytes of a text file of one transform, at most.
N_TEXT_BYTES = 1 << 20


@public
@takes_its_types
def open_transform(path: str | PathLike[str], *, moving: VolumeLike, fixed: VolumeLike) -> NDArray[np.float64]:
    r"""The affine map of a registration, from the world of the moving scan to the world of the fixed one.

    Parameters
    ----------
    path : path
        ITK, ANTs, 3D Slicer, elastix, SimpleITK (.tfm, .txt, .h5, .mat): points of the fixed scan to points of the
        moving one, LPS, as these programs write it. FreeSurfer (.lta): `src` to `dst`. FSL's FLIRT (.mat of 4 x 4
        numbers): `-in` to `-ref`. Each is turned into the same direction.
    moving, fixed : Volume, WaveletVolume, or what else `Volume` takes
        The scan that is moved onto the other one. FLIRT's file counts in their voxels, so they have to be the scans
        that FLIRT was given, or others on the same grids; of LTA their grids say which is `src`.

    Returns
    -------
    array, shape (4, 4), float64
        Column vectors, world units (RAS millimetres of patients): `moving.moved(matrix)` lies on `fixed`.

    Raises
    ------
    FileError
        If the file cannot be read.
    ArgumentError
        If the transform is not affine, not of three dimensions, or of a kind whose direction is not known, or a scan is
        not in millimetres.

    Warns
    -----
    WavesplatWarning
        If the file's direction had to be guessed, or was reversed.

    Examples
    --------
    >>> import wavesplat as ws
    >>> from pathlib import Path
    >>> scan = ws.examples.ct_pelvis()
    >>> text = "#Insight Transform File V1.0\nTransform: TranslationTransform_double_3_3\nParameters: 5 0 0\n"
    >>> _ = Path("shift.tfm").write_text(text + "FixedParameters:\n")
    >>> ws.open_transform("shift.tfm", moving=scan, fixed=scan)[:3, 3]  # RAS, the other way
    array([5., 0., 0.])
    """
    grids = [one if isinstance(one, Grid) else as_volume(one) for one in (moving, fixed)]
    return transform_between(path, *grids)


def transform_between(path: str | PathLike[str], moving: Grid, fixed: Grid) -> Matrix:
    """See `open_transform`."""
    place = expanded(path)
    name = place.name.lower()
    for grid in (moving, fixed):
        if grid.unit not in (None, "mm"):
            raise ArgumentError(
                f"transforms are in millimetres, and {grid.name!r} is in {grid.unit}; open it with unit='mm' and "
                f"spacing=: {path}"
            )
    if name.endswith(FIELDS):
        raise ArgumentError(f"the transform {NO_FIELDS}: {path}")
    suffix = place.suffix.lower()
    if suffix in CONVERTED:
        raise ArgumentError(f"transforms {suffix} are not read; convert it: {CONVERTED[suffix]}: {path}")
    if suffix not in (*ITK, *LTA, *MAT):
        raise ArgumentError(
            "unknown kind of transform; give .tfm, .txt, .h5 or .mat of ITK, .lta of FreeSurfer, or .mat of FLIRT: "
            f"{path}"
        )
    if not place.is_file():
        raise FileError(f"no such file: {path}")
    check_no_pipe(place)
    if suffix in LTA:
        found = _of_lta(_text(place), moving, fixed, path)
    elif (numbers := _four_by_four(place)) is None:
        found = _of_itk(place, moving, fixed)
    elif suffix in MAT:
        numbers = affine.checked_map(numbers, f"the transform {place.name!r}")
        _guess(f"a .mat of 4 x 4 numbers is taken for FLIRT's, -in {moving.name!r}, -ref {fixed.name!r}: {path}")
        found = fixed.world_from_index @ np.linalg.inv(_scaled(fixed)) @ numbers @ _scaled(moving)
        found = found @ np.linalg.inv(moving.world_from_index)
    else:
        raise ArgumentError(
            "4 x 4 numbers do not say which way they map, nor in which space; name the file .mat if it is of FLIRT, or "
            f"write an ITK transform (c3d_affine_tool FILE -oitk a.txt, if it is of Convert3D or greedy): {path}"
        )
    return affine.checked_map(found, f"the transform {place.name!r}")


def _guess(text: str) -> None:
    warn(f"guess: {text}", stacklevel=5)


def _text(place: Path) -> str:
    try:
        with place.open(encoding="utf-8", errors="replace") as file:
            return file.read(N_TEXT_BYTES)
    except OSError as error:
        raise FileError(f"cannot be read: {error.strerror}: {place}") from None


def _four_by_four(place: Path) -> Matrix | None:
    """The numbers of a text file that has four rows of four, and nothing else."""
    rows = [line.split() for line in _text(place).splitlines() if line.strip()]
    if [len(row) for row in rows] != [4, 4, 4, 4]:
        return None
    try:
        return np.array(rows, np.float64)
    except ValueError:
        return None


# ITK


def _of_itk(place: Path, moving: Grid, fixed: Grid) -> Matrix:
    import h5py
    import SimpleITK

    if h5py.is_hdf5(place):
        check_links(place, external_files=True)
    SimpleITK.ProcessObject.SetGlobalWarningDisplay(False)
    try:
        transform: Any = SimpleITK.ReadTransform(str(place))
    except (RuntimeError, ValueError):  # a message that repeats the file may be no text
        raise FileError(f"not a transform that ITK reads, or damaged: {place}") from None
    if transform.GetDimension() != 3:
        raise ArgumentError(f"the transform has {transform.GetDimension()} dimensions, and scans have 3: {place}")
    if not transform.IsLinear():
        raise ArgumentError(f"the transform {NO_FIELDS}: {place}")
    moving_from_fixed = np.eye(4)
    origin = np.array(transform.TransformPoint((0.0, 0.0, 0.0)))
    moving_from_fixed[:3, :3] = np.transpose([transform.TransformPoint(axis.tolist()) - origin for axis in np.eye(3)])
    moving_from_fixed[:3, 3] = origin
    if not abs(np.linalg.det(moving_from_fixed)) > 0:
        raise ArgumentError(f"the transform has no inverse: {place}")
    # ITK's places are LPS where the world is a patient's.
    flips = [affine.RAS_FROM_LPS if grid.is_anatomical else np.eye(4) for grid in (moving, fixed)]
    found: Matrix = flips[1] @ np.linalg.inv(moving_from_fixed) @ flips[0]
    return found


# FreeSurfer


class _Geometry(NamedTuple):
    """A volume of an LTA: its size along x, y, z, and its affine."""

    size: tuple[int, ...]
    world_from_index: Matrix
    name: str

    def is_of(self, grid: Grid) -> bool:
        """Whether a grid is the volume's."""
        if self.size != grid.shape[::-1]:
            return False
        corners = [affine.box_corners(matrix, grid.shape) for matrix in (self.world_from_index, grid.world_from_index)]
        return bool(np.abs(corners[0] - corners[1]).max() <= SAME_GRID_MM)


def _of_lta(text: str, moving: Grid, fixed: Grid, path: object) -> Matrix:
    lines = [line.partition("#")[0].strip() for line in text.splitlines()]
    lines = [line for line in lines if line]
    try:
        kind, count = (int(_value(lines, name)) for name in ("type", "nxforms"))
        start = lines.index("1 4 4") + 1
        numbers = np.array([line.split() for line in lines[start : start + 4]], np.float64).reshape(4, 4)
        src, dst = (_geometry(lines[lines.index(f"{name} volume info") + 1 :]) for name in ("src", "dst"))
    except (ValueError, KeyError):
        raise FileError(f"not an LTA with a matrix and two volumes, or damaged: {path}") from None
    if count != 1:
        raise ArgumentError(f"the LTA has {count} transforms; give one of one: {path}")
    if kind not in (VOXELS, PLACES):
        raise ArgumentError(
            f"the LTA is of type {kind}; write one of type 1: lta_convert --inlta FILE --outlta a.lta: {path}"
        )
    if kind == VOXELS:
        if src is None or dst is None:
            raise ArgumentError(f"the LTA is between voxels, and its volumes are not valid: {path}")
        numbers = dst.world_from_index @ numbers @ np.linalg.inv(src.world_from_index)
    if src is not None and dst is not None and _is_reversed(src, dst, moving, fixed, path):
        return np.asarray(
            np.linalg.inv(affine.checked_map(numbers, f"the transform {Path(str(path)).name!r}")), np.float64
        )
    return numbers


def _is_reversed(src: _Geometry, dst: _Geometry, moving: Grid, fixed: Grid, path: object) -> bool:
    """Whether the moving scan is `dst`, by the grids; a warning where that is so, and where they are no help."""
    as_named = src.is_of(moving) + dst.is_of(fixed)
    reverse = dst.is_of(moving) + src.is_of(fixed)
    if reverse > as_named:
        text = f"the LTA is undone: {moving.name!r} has the grid of its dst, or {fixed.name!r} of its src: {path}"
        warn(text, stacklevel=6)
        return True
    if as_named == 0:
        _guess(f"{moving.name!r} is taken for the LTA's src, {src.name!r}, whose grid is another: {path}")
    return False


def _value(lines: Sequence[str], name: str) -> str:
    for line in lines:
        found = re.fullmatch(rf"{name}\s*=\s*(.*)", line)
        if found:
            return found[1]
    raise KeyError(name)


def _geometry(lines: Sequence[str]) -> _Geometry | None:
    """A volume of an LTA, from the lines after its heading; None where it is not valid."""
    if int(_value(lines[:1], "valid")) != 1:
        return None
    block = lines[:8]
    vectors = {
        name: np.array(_value(block, name).split(), np.float64).reshape(3)
        for name in ("voxelsize", "xras", "yras", "zras", "cras")
    }
    size = tuple(int(n) for n in _value(block, "volume").split())
    if len(size) != 3:
        raise ValueError(size)
    matrix = np.eye(4)
    matrix[:3, :3] = np.column_stack([vectors["xras"], vectors["yras"], vectors["zras"]]) * vectors["voxelsize"]
    matrix[:3, 3] = vectors["cras"] - matrix[:3, :3] @ size / 2
    return _Geometry(size, matrix, Path(_value(block, "filename")).name)


# FSL


def _scaled(grid: Grid) -> Matrix:
    """FLIRT's millimetres from voxel indices: times the spacing, the first axis from its other end if not reversed."""
    matrix = np.diag([*grid.spacing, 1.0])
    if np.linalg.det(grid.world_from_index[:3, :3]) > 0:
        matrix[0, 0] = -grid.spacing[0]
        matrix[0, 3] = (grid.shape[2] - 1) * grid.spacing[0]
    return matrix
