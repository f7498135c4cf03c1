"""MINC, AFNI, Philips PAR/REC and ECAT, by nibabel, which knows their scaling, slice by slice, and their places.

Samples, axes and affine are as `nibabel.load` gives them. nibabel has no time axis of its own for these formats: in
MINC it is the first one, in the others the fourth. It reads vectors of MINC 2, but takes their axis for any other.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.hdf5 import check_links
from wavesplat._model.interchange.nibabel_image import LARGEST_FLOAT32, time_axis
from wavesplat._model.volume.facts import LENGTH, Facts
from wavesplat._readers.components import check_vectors, component_of, facts_of_colors, is_length
from wavesplat._readers.request import Grid, Request, choose, quiet, unwarned
from wavesplat._storage import size_checks
from wavesplat._storage.paths import check_within
from wavesplat._storage.reading import BoundedFile, reading
from wavesplat.errors import FileError

#: Suffix -> format.
NAMES = {
    ".mnc": "MINC",
    ".head": "AFNI",
    ".brik": "AFNI",
    ".brik.gz": "AFNI",
    ".par": "PAR/REC",
    ".rec": "PAR/REC",
    ".v": "ECAT",
}
#: AFNI's codes of units of time, TAXIS_NUMS[2].
AFNI_TIME_UNITS = {77001: "ms", 77002: "s"}
#: The axis of vectors in MINC.
VECTORS = "vector_dimension"
#: Largest ratio of unpacked to compressed bytes in files of MINC 2 and AFNI.
MAX_RATIO = size_checks.ANY_RATIO


def read(request: Request) -> Grid:
    """The volume in a file, or one of its time points."""
    path = request.file
    name = next(name for suffix, name in NAMES.items() if path.name.lower().endswith(suffix))
    _check_parts(path, request.within)
    if name == "MINC" and not _is_hdf5(path):
        name = "MINC 1"
    elif name == "MINC":
        with reading(name, request.path):
            check_links(path, external_files=request.external_files)
    with reading(name, request.path), quiet("nibabel.global"), unwarned("nibabel"), _opened(path, name) as image:
        _check_kind(image, path)
        _check_size(image, path, request)
        if VECTORS in (names := _names_of_axes(image)):
            return _of_vectors(image, names.index(VECTORS), request)
        check_vectors(request, request.name)
        choose("channel", 1, request.channel, request.path)
        shape, axis = image.shape, time_axis(image)
        n_times = 1 if axis is None else int(shape[axis])
        time = choose("time", n_times, request.time, request.path)
        at: list[Any] = [slice(None)] * len(shape)
        if axis is not None:
            at[axis] = time
        samples = _compact(np.asarray(image.dataobj[tuple(at)]), image)
        return Grid(samples.T, np.array(image.affine, np.float64), _facts(image, n_times, axis))


def _names_of_axes(image: Any) -> list[str]:
    """The names of the axes of MINC; none of other formats."""
    minc = getattr(image.dataobj, "minc_file", None)
    return [] if minc is None else list(minc._dim_names)


def _of_vectors(image: Any, axis: int, request: Request) -> Grid:
    """The length of vectors of MINC 2, one of their components, or one of three colours."""
    numbers = np.moveaxis(_compact(np.asarray(image.dataobj), image), axis, -1)
    if numbers.ndim != 4:
        raise FileError(f"the file has vectors of shape {numbers.shape}; export vectors of one volume: {request.path}")
    if _stored_type(image) == np.uint8 and _are_bytes(numbers):
        numbers = np.rint(numbers).astype(np.uint8)  # colours; other vectors are bytes with a scale
    n = numbers.shape[-1]
    samples, guesses = component_of(numbers, request, request.name)
    facts = Facts(unit="mm", is_anatomical=True, guesses=guesses, **facts_of_colors(n, numbers.dtype, request))
    if is_length(n, numbers.dtype, request):
        facts = replace(facts, processing=(LENGTH,))
    return Grid(samples.T, np.array(image.affine, np.float64), facts)


def _are_bytes(numbers: NDArray[Any]) -> bool:
    """Whether scaled numbers are those that bytes hold without a scale."""
    return bool(np.all((numbers > -0.01) & (numbers < 255.01) & (np.abs(numbers - np.rint(numbers)) < 0.01)))


def _is_hdf5(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(4) == b"\x89HDF"


@contextmanager
def _opened(path: Path, name: str) -> Iterator[Any]:
    """The image of nibabel, from files that are opened here where nibabel never closes them, or reads any length."""
    import nibabel

    kinds: dict[str, Any] = {
        "ECAT": nibabel.ecat.EcatImage,
        "PAR/REC": nibabel.parrec.PARRECImage,
        "MINC 1": nibabel.minc1.Minc1Image,
    }
    if name not in kinds:
        yield _of_afni(path) if name == "AFNI" else nibabel.load(path)
        return
    files = kinds[name].filespec_to_file_map(path)
    with ExitStack() as opened:
        for part, holder in files.items():
            if name != "PAR/REC" or part == "image":  # its header is text
                holder.fileobj = opened.enter_context(BoundedFile(Path(holder.filename)))
        try:
            image = kinds[name].from_file_map(files)
        except KeyError as error:
            if error.args != (VECTORS,):
                raise
            raise FileError(
                "the file holds vectors (vector_dimension), such as a deformation, which nibabel does not read; give "
                "one component: wavesplat.Volume(xarray.open_dataset(path, engine='scipy')['image'].isel("
                f"vector_dimension=0)): {path}"
            ) from error
        yield image


def _of_afni(path: Path) -> Any:
    """An image of AFNI, also of its first versions, which wrote no matrix, but directions, steps and an origin."""
    from nibabel import brikhead

    files = brikhead.AFNIImage.filespec_to_file_map(path)
    info = brikhead.parse_AFNI_header(files["header"].filename)
    if "IJK_TO_DICOM_REAL" not in info:
        matrix = np.zeros((3, 4))
        for axis, (code, step) in enumerate(zip(info["ORIENT_SPECIFIC"], info["DELTA"], strict=True)):
            matrix[int(code) // 2, axis] = step  # x, y and z have two codes each; steps have signs
            matrix[int(code) // 2, 3] = info["ORIGIN"][axis]
        info["IJK_TO_DICOM_REAL"] = matrix.ravel().tolist()
    header = brikhead.AFNIHeader(info)
    samples = brikhead.AFNIImage.ImageArrayProxy(files["image"].filename, header)
    return brikhead.AFNIImage(samples, header.get_affine(), header, file_map=files)


def _check_kind(image: Any, path: Path) -> None:
    """Raise a `FileError` unless the image is a volume of real numbers, or several."""
    if len(image.shape) not in (3, 4):
        raise FileError(f"the file is {len(image.shape)}-D, shape {image.shape}; export one volume of it: {path}")
    if min(image.shape) < 1:
        raise FileError(f"the header says shape {image.shape}, which holds no samples: {path}")
    if (dtype := _stored_type(image)).kind not in "iuf":
        raise FileError(
            f"the samples are {dtype}, not real numbers; "
            f"give a part of them, as wavesplat.Volume(abs(nibabel.load(path).dataobj[...]).T): {path}"
        )


def _stored_type(image: Any) -> np.dtype[Any]:
    """The type of the samples in the file, before scaling; of ECAT, the type of the first time point."""
    is_ecat = type(image).__name__ == "EcatImage"
    dtype: np.dtype[Any] = np.dtype(image.get_data_dtype(0) if is_ecat else image.get_data_dtype())
    return dtype


def _check_parts(path: Path, within: Path | None) -> None:
    """Raise a `FileError` if the other file of a header and its samples is a link elsewhere."""
    if within is None:
        return
    stem = path.name.partition(".")[0]
    for file in path.parent.iterdir():
        if file.name.startswith(f"{stem}."):
            check_within(file, within)


def _check_size(image: Any, path: Path, request: Request) -> None:
    """Refuse headers that promise more samples than the files can hold, before memory is taken."""
    files = {file.filename for file in image.file_map.values() if file.filename}
    stored = sum(Path(file).stat().st_size for file in files if Path(file).exists()) or path.stat().st_size
    dtype = _stored_type(image)
    axis = time_axis(image)
    held = [n for number, n in enumerate(image.shape) if number != axis]
    size_checks.check_stored(image.shape, dtype, stored, request.path, ratio=MAX_RATIO, held=held)
    size_checks.check_memory(size_checks.n_bytes(held, np.dtype(np.float64)), request.path)


def _compact(samples: NDArray[Any], image: Any) -> NDArray[Any]:
    """Scaled integers as float32, which holds all their digits; nibabel gives float64."""
    stored = _stored_type(image)
    if samples.dtype.kind != "f" or samples.dtype.itemsize <= 4 or (stored.kind == "f" and stored.itemsize > 4):
        return samples
    if stored.itemsize > 2 or np.abs(samples).max(initial=0.0) > LARGEST_FLOAT32:
        return samples
    return samples.astype(np.float32)


def _facts(image: Any, n_times: int, axis: int | None) -> Facts:
    step, unit = _time_step(image, axis) if n_times > 1 else (None, None)
    modality = "MR" if type(image).__name__ == "PARRECImage" else None  # a format of Philips' MR scanners
    return Facts(unit="mm", is_anatomical=True, modality=modality, n_times=n_times, time_step=step, time_unit=unit)


def _time_step(image: Any, axis: int | None) -> tuple[float | None, str | None]:
    """Time between time points, and its unit; None where the file does not say that its volumes are times."""
    header = image.header
    kind = type(image).__name__
    if axis is None or kind == "EcatImage":
        return None, None
    step = float(header.get_zooms()[axis])
    if kind == "AFNIImage":
        numbers = header.info.get("TAXIS_NUMS")
        unit = AFNI_TIME_UNITS.get(int(numbers[2])) if numbers is not None else None
        return (step, unit) if unit is not None and step > 0 else (None, None)
    if kind == "PARRECImage" and list(header.get_volume_labels() or {"dynamic scan number": 0}) != [
        "dynamic scan number"
    ]:
        return None, None
    return (step, "s") if step > 0 else (None, None)
