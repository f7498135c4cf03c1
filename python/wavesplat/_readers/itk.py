"""NRRD, MetaImage and legacy VTK images, by SimpleITK.

ITK's world is LPS; it is turned into RAS here, once.
A VTK file, or an NRRD file whose `space` is none of a patient, says nothing of one: its axes are kept as they are.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._files import payload
from wavesplat._files.reading import reading
from wavesplat._model import affine
from wavesplat._readers.image_headers import Header, inflated, of_meta_image, of_nrrd, of_vtk
from wavesplat._readers.request import Grid, Request, choose
from wavesplat.errors import FileError

if TYPE_CHECKING:
    import SimpleITK

__all__ = ["affine_of", "read", "silenced", "simple_itk"]


def read(request: Request) -> Grid:
    """The volume in an NRRD, MetaImage or VTK file, or one of its time points or channels."""
    sitk = simple_itk()
    path = request.file
    with reading("an image", path), silenced():
        reader = sitk.ImageFileReader()
        reader.SetFileName(str(path))
        reader.ReadImageInformation()
        size = reader.GetSize()
        dtype = np.dtype(_dtype_of(sitk, reader.GetPixelID()))
        header = _header(path)
        n_components = reader.GetNumberOfComponents()
        _check_payload(path, header.fields, (*size, n_components), dtype)
        if len(size) == 4:
            time = choose("time", size[3], request.time, path)
            reader.SetExtractSize([*size[:3], 0])
            reader.SetExtractIndex([0, 0, 0, time])
        else:
            choose("time", 1, request.time, path)
        if _lacks_length(header):
            whole = inflated(path, header, (*size[::-1], n_components))
            samples = whole[request.time or 0] if len(size) == 4 else whole
            samples = samples[..., 0] if n_components == 1 else samples
            place: Any = reader
        else:
            place = reader.Execute()
            samples = sitk.GetArrayFromImage(place)
        channel = choose("channel", n_components, request.channel, path)
        if n_components > 1:
            samples = samples[..., channel]
        facts = replace(header.facts, n_times=size[3] if len(size) == 4 else 1)
        return Grid(samples, _world_from_index(place, header), facts)


def simple_itk() -> Any:
    """The SimpleITK module, its warnings on stderr switched off: errors reach us as exceptions."""
    import SimpleITK

    SimpleITK.ProcessObject.SetGlobalWarningDisplay(False)
    return SimpleITK


@contextmanager
def silenced() -> Iterator[None]:
    """Hide what C libraries under ITK print to the standard streams, past Python and past ITK's own switch."""
    saved = [(number, os.dup(number)) for number in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for number, _ in saved:
            os.dup2(nowhere, number)
        yield
    finally:
        os.close(nowhere)
        for number, copy in saved:
            os.dup2(copy, number)
            os.close(copy)


def affine_of(image: SimpleITK.Image) -> NDArray[np.float64]:
    """World (LPS) from index of a 3-D ITK image."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(image.GetDirection(), (3, 3)) * np.asarray(image.GetSpacing())
    matrix[:3, 3] = image.GetOrigin()
    return matrix


def _header(path: Path) -> Header:
    if path.suffix.lower() in (".mha", ".mhd"):
        return of_meta_image(path)
    return of_vtk() if path.suffix.lower() == ".vtk" else of_nrrd(path)


def _lacks_length(header: Header) -> bool:
    """Whether samples are compressed and their packed size is not given: ITK then reads garbage."""
    return header.fields.get("compresseddata", "").lower() == "true" and "compresseddatasize" not in header.fields


def _world_from_index(image: Any, header: Header) -> NDArray[np.float64]:
    """World from index of a 3-D image, or of the first three axes of a 4-D one."""
    n = len(image.GetSpacing())
    if n < 3:
        return np.eye(4)  # a 2-D image; the volume's own check says so
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(image.GetDirection(), (n, n))[:3, :3] * np.asarray(image.GetSpacing())[:3]
    matrix[:3, 3] = image.GetOrigin()[:3]
    matrix = affine.RAS_FROM_LPS @ matrix if header.facts.is_anatomical else matrix
    return header.in_one_unit(matrix)


def _dtype_of(sitk: Any, pixel_id: int) -> str:
    """NumPy's name of an ITK pixel type: "vector of 16-bit signed integer" -> "int16"."""
    words = sitk.GetPixelIDValueAsString(pixel_id)
    bits = next((word.removesuffix("-bit") for word in words.split() if word.endswith("-bit")), "8")
    kind = (
        "complex" if "complex" in words else "float" if "float" in words else "uint" if "unsigned" in words else "int"
    )
    return kind + (str(2 * int(bits)) if kind == "complex" else bits)


def _check_payload(path: Path, header: dict[str, str], shape: Sequence[int], dtype: np.dtype[Any]) -> None:
    """Compare the promised size with the size of the file that holds the samples, if the header names one."""
    name = header.get("elementdatafile") or header.get("data file") or header.get("datafile") or "LOCAL"
    if name.upper().startswith("LIST") or "%" in name:
        payload.check_memory(payload.n_bytes(shape, dtype), path)
        return
    data = path if name.upper() == "LOCAL" else path.parent / name
    if not data.is_file():
        raise FileError(f"the header names a data file that is not there, {name!r}; put it beside the header: {path}")
    encoding = header.get("encoding", "raw").lower()
    if header.get("compresseddata", "").lower() == "true" or encoding in ("gzip", "gz"):
        ratio = payload.DEFLATE_RATIO
    else:
        ratio = payload.ANY_RATIO if encoding in ("bzip2", "bz2") else 1
    if encoding not in ("ascii", "text", "txt", "hex"):
        payload.check_stored(shape, dtype, data.stat().st_size, path, ratio=ratio)
