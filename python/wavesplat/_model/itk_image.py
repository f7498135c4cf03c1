"""Images of SimpleITK and ITK.

ITK's world is LPS; it is turned into RAS here. An image that ITK read from an NRRD file whose `space` is no patient's,
or from a VTK file, keeps its axes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model import affine, units
from wavesplat._model.converted import Converted
from wavesplat._model.facts import Facts, value_unit_of
from wavesplat._model.placement import NO_PLACE, is_without_place
from wavesplat.errors import ArgumentError

__all__ = [
    "ANATOMICAL_SPACES",
    "MODALITIES",
    "NO_ANATOMY",
    "SPACE",
    "UNIT",
    "VALUE_UNIT",
    "affine_of",
    "of_itk",
    "of_simple_itk",
]

#: NRRD's spaces whose axes are a patient's, as in ITK; a time axis may follow.
ANATOMICAL_SPACES = {
    "left-posterior-superior",
    "lps",
    "right-anterior-superior",
    "ras",
    "left-anterior-superior",
    "las",
}
#: Words of headers for the modality -> DICOM's codes.
MODALITIES = {
    "mri": "MR",
    "dwmri": "MR",
    "mr": "MR",
    "ct": "CT",
    "pet": "PT",
    "pt": "PT",
    "nm": "NM",
    "us": "US",
    "rtdose": "RTDOSE",
}
#: ITK's key for NRRD's space, the space that is no patient's, and our keys for the unit of lengths, and of values.
SPACE, NO_ANATOMY, UNIT, VALUE_UNIT = "NRRD_space", "3D-right-handed", "unit", "value_unit"
#: Keys of metadata that are read, in lower case.
KEYS = {SPACE.lower(), UNIT, VALUE_UNIT, "itk_inputfiltername", "modality", "0008|0060"}
#: ITK's readers of formats that say nothing of a patient, unless the file names a space.
WITHOUT_ANATOMY = ("NrrdImageIO", "VTKImageIO")


def of_simple_itk(image: Any) -> Converted:
    """Convert an image of SimpleITK."""
    import SimpleITK

    _check(image, image.GetDimension(), "SimpleITK.VectorIndexSelectionCast(image, 0)")
    said = {key.lower(): image.GetMetaData(key) for key in image.GetMetaDataKeys()}
    return _converted(SimpleITK.GetArrayFromImage(image), affine_of(image), said)


def of_itk(image: Any) -> Converted:
    """Convert an image of ITK, as `itk.imread` and filters return."""
    import itk  # type: ignore[import-not-found, unused-ignore]

    _check(image, image.GetImageDimension(), "itk.vector_index_selection_cast_image_filter(image)")
    matrix = affine.affine_of(
        np.asarray(itk.array_from_matrix(image.GetDirection())), tuple(image.GetSpacing()), tuple(image.GetOrigin())
    )
    # Samples begin at the buffered region, the origin is that of index 0.
    first = np.array(tuple(image.GetBufferedRegion().GetIndex()), np.float64)
    matrix[:3, 3] += matrix[:3, :3] @ first
    return _converted(itk.array_from_image(image), matrix, _said(image.GetMetaDataDictionary()))


def _said(dictionary: Any) -> dict[str, str]:
    """The texts of ITK's metadata under `KEYS`; other values may have types that Python does not know."""
    keys = [key for key in dictionary.GetKeys() if key.lower() in KEYS]
    return {key.lower(): str(dictionary[key]) for key in keys}


def affine_of(image: Any) -> NDArray[np.float64]:
    """World (LPS) from index of a 3-D image of SimpleITK."""
    return affine.affine_of(np.reshape(image.GetDirection(), (3, 3)), image.GetSpacing(), image.GetOrigin())


def _check(image: Any, n_axes: int, mend: str) -> None:
    if n_axes != 3:
        example = "image[:, :, :, 0]" if n_axes == 4 else "a 3-D image"
        raise ArgumentError(f"the image is {n_axes}-D; a volume is 3-D: give one of its parts, as {example}")
    n_channels = image.GetNumberOfComponentsPerPixel()
    if n_channels > 1:
        raise ArgumentError(f"the image has {n_channels} channels; give one of them, as with {mend}")


def _converted(samples: NDArray[Any], lps: NDArray[np.float64], said: dict[str, str]) -> Converted:
    """The converted image. `said`: its metadata, keys in lower case."""
    space = said.get(SPACE.lower())
    if space is None:
        is_anatomical = said.get("itk_inputfiltername") not in WITHOUT_ANATOMY
    else:
        is_anatomical = space.lower().removesuffix("-time") in ANATOMICAL_SPACES
    unit, factor = units.of_file(said.get(UNIT))
    lps = np.diag([factor, factor, factor, 1.0]) @ lps
    conventions = []
    if is_anatomical and space is None:
        conventions.append("axes of a patient: ITK counts them so")
    if is_anatomical and unit is None:
        unit = "mm"
        conventions.append("unit mm: the image names none; millimetres are ITK's convention")
    modality = said.get("modality", said.get("0008|0060", "")).strip().lower().removeprefix("met_mod_")
    if len(conventions) > 1 and modality not in MODALITIES and is_without_place(lps):
        conventions.append(NO_PLACE)
    facts = Facts(
        unit=unit,
        is_anatomical=is_anatomical,
        modality=MODALITIES.get(modality),
        value_unit=value_unit_of(said.get(VALUE_UNIT)),
        conventions=tuple(conventions),
    )
    return Converted(samples, affine.RAS_FROM_LPS @ lps if is_anatomical else lps, facts)
