"""Images of SimpleITK and ITK.

ITK's world is LPS; it is turned into RAS here. An image that ITK read from an NRRD file whose `space` is no patient's,
or from a VTK file, keeps its axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._model.interchange.converted import Converted
from wavesplat._model.volume import affine, units
from wavesplat._model.volume.facts import Facts, value_unit_of
from wavesplat._model.volume.grid import NO_PLACE, is_without_place
from wavesplat.errors import ArgumentError

#: NRRD's spaces whose axes are a patient's, by their names -> the letters of the axes. A time axis may follow, and the
#: name has -time or T at its end.
SPACES = {
    **dict.fromkeys(("left-posterior-superior", "lps"), "LPS"),
    **dict.fromkeys(("right-anterior-superior", "ras"), "RAS"),
    **dict.fromkeys(("left-anterior-superior", "las"), "LAS"),
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
#: DICOM's codes of images (PS3.3, C.7.3.1.1.1) under its own key, beside those above.
DICOM_KEY = "0008|0060"
DICOM_CODES = {
    *("BI", "BMD", "CR", "DG", "DX", "ES", "GM", "IO", "IVOCT", "IVUS", "LS", "MG", "OCT", "OP", "OPM", "OPT", "OT"),
    *("PA", "PX", "RF", "RG", "RTIMAGE", "SEG", "SM", "TG", "XA", "XC"),
}
#: ITK's key for NRRD's space, the space that is no patient's, and our keys for the unit of lengths, and of values.
SPACE, NO_ANATOMY, UNIT, VALUE_UNIT = "NRRD_space", "3D-right-handed", "unit", "value_unit"
#: Keys of metadata that are read, in lower case.
KEYS = {SPACE.lower(), UNIT, VALUE_UNIT, "itk_inputfiltername", "modality", "0008|0060"}
#: Signs from LPS to RAS.
SIGNS_OF_ITK = (-1.0, -1.0, 1.0)
#: ITK's readers of formats that say nothing of a patient, unless the file names a space.
WITHOUT_ANATOMY = ("NrrdImageIO", "VTKImageIO")


def of_simple_itk(image: Any) -> Converted:
    """Convert an image of SimpleITK."""
    import SimpleITK

    _check(image, image.GetDimension(), "SimpleITK.VectorIndexSelectionCast(image, 0)")
    metadata = {key.lower(): image.GetMetaData(key) for key in image.GetMetaDataKeys()}
    return _converted(SimpleITK.GetArrayFromImage(image), affine_of(image), metadata)


def of_itk(image: Any) -> Converted:
    """Convert an image of ITK, as `itk.imread` and filters return."""
    import itk  # type: ignore[import-not-found, unused-ignore]

    _check(image, image.GetImageDimension(), "itk.vector_index_selection_cast_image_filter(image)")
    matrix = affine.affine_of(
        np.asarray(itk.array_from_matrix(image.GetDirection())), tuple(image.GetSpacing()), tuple(image.GetOrigin())
    )
    # Samples begin at the buffered region, the origin is the place of index 0.
    first = np.array(tuple(image.GetBufferedRegion().GetIndex()), np.float64)
    matrix[:3, 3] += matrix[:3, :3] @ first
    return _converted(itk.array_from_image(image), matrix, _metadata(image.GetMetaDataDictionary()))


def _metadata(dictionary: Any) -> dict[str, str]:
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


def _converted(samples: NDArray[Any], lps: NDArray[np.float64], metadata: dict[str, str]) -> Converted:
    """The converted image. `metadata`: its metadata, keys in lower case."""
    space, signs = metadata.get(SPACE.lower()), None
    if space is None:
        is_anatomical = metadata.get("itk_inputfiltername") not in WITHOUT_ANATOMY
    else:
        signs = ras_signs_of(space)
        is_anatomical = signs is not None
    unit, factor = units.of_file(metadata.get(UNIT))
    lps = np.diag([factor, factor, factor, 1.0]) @ lps
    conventions = []
    if is_anatomical and space is None:
        conventions.append("axes of a patient: ITK counts them so")
    if is_anatomical and unit is None:
        unit = "mm"
        conventions.append("unit mm: the image names none; millimetres are ITK's convention")
    modality = modality_of(metadata)
    if len(conventions) > 1 and modality is None and is_without_place(lps):
        conventions.append(NO_PLACE)
    facts = Facts(
        unit=unit,
        is_anatomical=is_anatomical,
        modality=modality,
        value_unit=value_unit_of(metadata.get(VALUE_UNIT)),
        conventions=tuple(conventions),
    )
    world_from_index = np.diag([*(signs or SIGNS_OF_ITK), 1.0]) @ lps if is_anatomical else lps
    return Converted(samples, world_from_index, facts)


def ras_signs_of(space: str) -> tuple[float, float, float] | None:
    """Signs by which ITK's world of an NRRD file becomes RAS; None where its space is no patient's.

    ITK turns all spaces of patients to LPS, but for spaces with a time axis, which it leaves as they are.
    """
    folded = space.strip().lower()
    if folded in SPACES:
        return SIGNS_OF_ITK
    letters = SPACES.get(folded.removesuffix("-time")) or SPACES.get(folded.removesuffix("t"))
    return None if letters is None else (-1.0 if letters[0] == "L" else 1.0, -1.0 if letters[1] == "P" else 1.0, 1.0)


def modality_of(metadata: Mapping[str, str]) -> str | None:
    """DICOM's code of the modality that metadata name, keys in lower case; None where they name none, or another."""
    words = [metadata.get(key, "").strip().lower().removeprefix("met_mod_") for key in ("modality", DICOM_KEY)]
    known = next((MODALITIES[word] for word in words if word in MODALITIES), None)
    return known or (words[1].upper() if words[1].upper() in DICOM_CODES else None)
