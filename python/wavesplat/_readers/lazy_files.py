"""NRRD and MetaImage whose samples are stored as they are, which are read as they are drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from wavesplat._readers.levels import Levels, OneVolume, one_stream, stored_samples
from wavesplat._readers.nrrd import detached_samples, itk
from wavesplat._readers.request import Grid, Request
from wavesplat._storage import size_checks
from wavesplat._system.libraries import muted_stderr
from wavesplat.errors import FileError


def levels(request: Request) -> Levels | Grid:
    """The volume in an NRRD or MetaImage file; with `memory` one whose samples are read as they are drawn."""
    if request.memory is None:
        return itk.read(request)
    path = request.file
    header = itk.header_of(path)
    fields = header.fields
    packed = fields.get("compresseddata", "").lower().startswith(("t", "1"))
    encoding = fields.get("encoding", "raw").lower()
    if packed or encoding in ("gzip", "gz", "bzip2", "bz2"):
        raise one_stream(path, "zlib" if packed else encoding)
    if encoding != "raw" or fields.get("binarydata", "true").lower()[:1] not in ("t", "1"):
        raise FileError(f"the samples are written as text; open the file without memory=: {path}")
    places = detached_samples.places_of_samples(path, anywhere=request.external_files, within=request.within)
    if len(places) != 1:
        raise FileError(f"the samples are in {len(places)} files; open the header without memory=: {path}")
    file, offset = places[0]
    sitk = itk.simple_itk()
    with muted_stderr(), itk.for_itk(path, header, places) as seen:
        reader = sitk.ImageFileReader()
        reader.SetFileName(str(seen))
        reader.ReadImageInformation()
        size, n_components = reader.GetSize(), reader.GetNumberOfComponents()
        dtype = np.dtype(itk.dtype_of(sitk, reader.GetPixelID()))
        matrix = itk.world_from_index_of(reader, header)
    if len(size) != 3 or n_components != 1:
        raise FileError(f"the file holds several times or channels; open it without memory=: {path}")
    byte_order = fields.get("binarydatabyteordermsb", fields.get("elementbyteordermsb", "f")).lower()
    is_big = fields.get("endian", "little").lower() == "big" or byte_order[:1] in ("t", "1")
    offset = _first_sample(file, offset, fields, size_checks.n_bytes(size, dtype))
    stored = dtype.newbyteorder(">" if is_big else "<")
    volume = OneVolume((0, 1, 2), [None] * 3, stored, stored)
    return Levels([stored_samples(file, offset, size[::-1], volume)], [matrix], header.facts)


def _first_sample(file: Path, offset: int, fields: dict[str, str], n_bytes: int) -> int:
    """Bytes before the first sample in a file, of which `offset` are a header; what NRRD and MetaImage skip is added.

    NRRD skips lines first, then bytes: https://teem.sourceforge.net/nrrd/format.html#lineskip. -1 stands for as many
    bytes as leave the samples at the end of the file. MetaImage counts from the start of the file.
    """
    meta_skip = int(fields.get("headersize", 0))
    if meta_skip > 0:
        return meta_skip
    skip = int(fields.get("byte skip", fields.get("byteskip", meta_skip)))
    if skip == -1:
        return file.stat().st_size - n_bytes
    with file.open("rb") as stream:
        stream.seek(offset)
        for _ in range(int(fields.get("line skip", fields.get("lineskip", 0)))):
            stream.readline()
        return stream.tell() + skip
