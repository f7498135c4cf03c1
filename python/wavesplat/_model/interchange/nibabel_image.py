"""Images of nibabel: their place, scaled samples and facts, for images in memory and for images that the reader opens.

NIfTI's world is RAS already; the sform wins over the qform.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.converted import Converted
from wavesplat._model.volume.facts import OF_INTENTS, Facts
from wavesplat._storage.paths import FileName
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from nibabel.spatialimages import SpatialImage


#: NIfTI's codes of units (nifti1.h, NIFTI_UNITS_*), in the three low bits of a number and in the next three: metres,
#: millimetres, micrometres; seconds, milliseconds, microseconds; and units of fourth axes that are none of times.
MM_PER_UNIT = {1: 1000.0, 2: 1.0, 3: 0.001}
TIME_UNITS = {8: "s", 16: "ms", 24: "us"}
NO_TIMES = {32: "Hz", 40: "ppm", 48: "rad/s"}
LARGEST_FLOAT32 = float(np.finfo(np.float32).max)
#: Description that `Volume.to_nibabel` writes for a world that is no patient's, since NIfTI has no code for it.
NO_ANATOMY = "axes without anatomy"


def of_nibabel(image: Any) -> Converted:
    """Convert an image in memory, or one whose samples are still in its file."""
    if not hasattr(image, "dataobj") or getattr(image, "affine", None) is None:
        raise ArgumentError(f"a {type(image).__name__} has no samples on a grid; give an image from nibabel.load")
    shape = tuple(image.shape)
    if time_axis(image) == 0:
        raise ArgumentError(
            f"the image is 4-D, shape {shape} (time, ...); give one volume of it, as "
            f"nibabel.Nifti1Image(image.dataobj[0], image.affine) for the first"
        )
    if len(shape) > 3 and set(shape[3:]) != {1}:
        first = ", ".join(["0"] * (len(shape) - 3))
        raise ArgumentError(
            f"the image is {len(shape)}-D, shape {shape} (x, y, z, time, ...); give one volume of it, as "
            f"image.slicer[..., 0] for the first"
            if len(shape) == 4
            else f"the image is {len(shape)}-D, shape {shape}; give one volume of it, as "
            f"nibabel.Nifti1Image(image.dataobj[..., {first}], image.affine, image.header)"
        )
    proxy = image.dataobj
    if hasattr(proxy, "get_unscaled") and isinstance(getattr(proxy, "slope", None), float | int | np.floating):
        samples = scaled(np.asarray(proxy.get_unscaled()), float(proxy.slope), float(proxy.inter))
    else:
        samples = np.asarray(proxy)
    if samples.dtype.names:
        raise ArgumentError(
            f"the image has {len(samples.dtype.names)} channels of colour; give one of them, as "
            f"wavesplat.Volume(image.dataobj[{samples.dtype.names[0]!r}].T, world_from_index=image.affine)"
        )
    file = image.get_filename()
    name = None if file is None else FileName(Path(file).name, is_private=True)
    return Converted(samples.reshape(shape[:3], order="F").T, world_from_index(image), facts_of(image), name)


def scaled(stored: NDArray[Any], slope: float, intercept: float) -> NDArray[Any]:
    """Samples with slope and intercept applied; integers stay integers where nothing is lost."""
    if (slope, intercept) == (1.0, 0.0):
        return stored
    limits = (int(stored.min()), int(stored.max())) if stored.dtype.kind in "iu" else None
    dtype = type_of_scaled(stored.dtype, slope, intercept, limits)
    if dtype != np.float32:
        return in_type(stored, slope, intercept, dtype)
    values = in_type(stored, slope, intercept, np.dtype(np.float64))
    # Slopes near the limit of float32 make values beyond it.
    may_be_large = max(abs(slope), abs(intercept)) > 1e20 or (stored.dtype.kind == "f" and abs(slope) > 1)
    return values if may_be_large and _largest(values) > LARGEST_FLOAT32 else values.astype(np.float32)


def type_of_scaled(
    stored: np.dtype[Any], slope: float, intercept: float, limits: tuple[int, int] | None = None
) -> np.dtype[Any]:
    """The type of scaled samples, by `limits`, the smallest and largest stored integer, or else by their type."""
    if stored.kind in "iu" and slope.is_integer() and intercept.is_integer():
        limits = limits or (int(np.iinfo(stored).min), int(np.iinfo(stored).max))
        ends = [end * int(slope) + int(intercept) for end in limits]
        for dtype in (np.int16, np.int32):
            if np.iinfo(dtype).min <= min(ends) and max(ends) <= np.iinfo(dtype).max:
                return np.dtype(dtype)
    return np.dtype(np.float64 if stored.itemsize > 4 else np.float32)


def in_type(stored: NDArray[Any], slope: float, intercept: float, dtype: np.dtype[Any]) -> NDArray[Any]:
    """Scaled samples in a type."""
    if dtype.kind == "i":
        return (stored.astype(np.int64) * int(slope) + int(intercept)).astype(dtype)
    return (stored * np.float64(slope) + intercept).astype(dtype, copy=False)


def _largest(values: NDArray[np.float64]) -> float:
    return float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))


def world_from_index(image: SpatialImage) -> NDArray[np.float64]:
    """World (RAS, millimetres where units are known) from index."""
    header: Any = image.header
    if not _has_orientation(image):
        # The standard's method 1: spacing only. (nibabel would centre the volume and mirror x, as SPM did.)
        world_from_index = np.diag([*(abs(float(zoom)) or 1.0 for zoom in header.get_zooms()[:3]), 1.0])
    else:
        world_from_index = np.array(image.affine, dtype=np.float64)
    if _has_units(image):
        world_from_index[:3] *= MM_PER_UNIT.get(_unit_codes(image)[0], 1.0)
    return world_from_index


def _quantity(image: Any) -> str | None:
    """The quantity that the intent of NIfTI names; None where it has none, or one of images."""
    get_intent = getattr(image.header, "get_intent", None)
    return None if get_intent is None else OF_INTENTS.get(get_intent()[0])


def _unit_codes(image: SpatialImage) -> tuple[int, int]:
    """The codes of the units of lengths and of times, 0 where none is named (nibabel stops at unknown ones)."""
    header: Any = image.header
    code = int(header["xyzt_units"]) if _has_units(image) else 0
    return code & 0x07, code & 0x38


def _time_unit(image: SpatialImage, code: int) -> str | None:
    from nibabel.freesurfer.mghformat import MGHImage

    # FreeSurfer's format has the repetition time in milliseconds.
    return "ms" if isinstance(image, MGHImage) else TIME_UNITS.get(code)


def time_axis(image: SpatialImage) -> int | None:
    """The axis of time points: the first of MINC, the fourth of other formats; None of an image of three axes."""
    from nibabel.minc1 import Minc1Image

    if len(image.shape) < 4:
        return None
    return 0 if isinstance(image, Minc1Image) else 3


def _has_units(image: SpatialImage) -> bool:
    """Whether an image is NIfTI; Analyze and FreeSurfer's format have no field for units."""
    return hasattr(image.header, "get_xyzt_units")


def _has_orientation(image: SpatialImage) -> bool:
    """Whether the image says how its axes lie in the world; Analyze never does, other formats always."""
    from nibabel.analyze import AnalyzeHeader

    header: Any = image.header
    if _has_units(image):
        return bool(header["sform_code"] > 0 or header["qform_code"] > 0)
    return not isinstance(header, AnalyzeHeader)


def facts_of(image: SpatialImage) -> Facts:
    """Facts of an image's header."""
    header: Any = image.header
    is_placed = _has_orientation(image)
    is_anatomical = is_placed and not (_has_units(image) and header["descrip"].item() == NO_ANATOMY.encode())
    n_times = int(image.shape[3]) if len(image.shape) > 3 else 1
    unit, time_unit = _unit_codes(image)
    conventions, guesses = [], []
    if not is_placed:
        guesses.append(
            "axes without anatomy, sample (0, 0, 0) at the origin: the file has no orientation (its qform and sform "
            "codes are 0, or it is Analyze), only distances"
        )
    ours = "mm" if unit in MM_PER_UNIT else None
    if unit and ours is None:
        guesses.append(f"lengths as numbers of millimetres: the file's unit has code {unit}, which NIfTI has not")
        ours = "mm"
    if ours is None and is_anatomical:
        ours = "mm"
        programs = "read NIfTI" if _has_units(image) else "read such files"
        conventions.append(f"unit mm: the file names none; programs that {programs} take millimetres")
    # Asked for of several times alone: an image of ECAT has no distances of samples in its header.
    zooms: tuple[Any, ...] = header.get_zooms() if n_times > 1 else ()
    step = float(zooms[3]) if len(zooms) > 3 and zooms[3] > 0 else None
    if step is not None and time_unit and time_unit not in TIME_UNITS:
        known = NO_TIMES.get(time_unit)
        meaning = f"its steps are {step:g} {known}" if known else f"its unit has code {time_unit}, which NIfTI has not"
        guesses.append(f"volumes of the fourth axis as times without a clock: {meaning}")
        step = None
    return Facts(
        unit=ours,
        is_anatomical=is_anatomical,
        quantity=_quantity(image),
        n_times=max(n_times, 1),
        time_step=step,
        time_unit=_time_unit(image, time_unit) if step is not None else None,
        conventions=tuple(conventions),
        guesses=tuple(guesses),
    )
