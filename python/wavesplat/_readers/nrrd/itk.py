"""NRRD and MetaImage, by SimpleITK.

ITK's world is LPS; it is turned into RAS here, once.
An NRRD file whose `space` is no patient's says nothing of one: its axes are kept as they are.
"""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._readers.components import facts_of_colors
from wavesplat._readers.nrrd.detached_samples import MAX_HEADER_BYTES, places_of_samples
from wavesplat._readers.nrrd.image_headers import Header, inflated, of_meta_image, of_nrrd
from wavesplat._readers.nrrd.nrrd_for_itk import ListedAxis, header_for_itk, skip_lines
from wavesplat._readers.request import Grid, Request, choose
from wavesplat._storage import size_checks
from wavesplat._storage.reading import reading
from wavesplat._system.libraries import muted_stderr
from wavesplat.errors import FileError

# MetaImage headers whose samples are in a file with a percent sign in its name, and the header that ITK gets instead.
#
# ITK takes every such name for a pattern of numbered files, "slice%03d.raw 1 20 1". It is handed a header that names a
# link to the file.

#: The line that names the file, and ends the header.
NAMED = re.compile(rb"(?m)^[ \t]*ElementDataFile[ \t]*[=:][^\n]*")


@contextmanager
def meta_for_itk(path: Path, fields: dict[str, str], places: Sequence[tuple[Path, int]]) -> Iterator[Path]:
    """The file for ITK: itself, or another header, for as long as it is read. `places`: files that hold the samples."""
    name = fields.get("elementdatafile", "")
    if "%" not in name or len(places) != 1 or places[0][0].name != Path(name).name:
        yield path
        return
    with path.open("rb") as file:
        content = file.read(MAX_HEADER_BYTES)
    with tempfile.TemporaryDirectory() as made:
        link = Path(made) / "samples"
        try:
            link.symlink_to(places[0][0].absolute())
        except OSError:  # Windows, without the right to make links
            shutil.copyfile(places[0][0], link)
        header = Path(made) / "header.mhd"
        header.write_bytes(NAMED.sub(b"ElementDataFile = samples", content))
        yield header


# NRRD and MetaImage, by SimpleITK.

#: Bytes that are looked through at once, white space, and letters of a number written as text, at most.
BLOCK_BYTES, SPACES, MAX_WORD_BYTES = 1 << 20, np.frombuffer(b" \t\n\r\v\f", np.uint8), 500


def read(request: Request) -> Grid:
    """The volume in an NRRD or MetaImage file, or one of its time points or channels."""
    sitk = simple_itk()
    path = request.file
    with reading("an image", path), muted_stderr():
        reader = sitk.ImageFileReader()
        # Set, not detected: a file of any other kind under such a name could name further files.
        reader.SetImageIO(_image_io(path))
        places = places_of_samples(path, anywhere=request.external_files, within=request.within)
        header = header_of(path)
        with for_itk(path, header, places) as seen:
            reader.SetFileName(str(seen))
            reader.ReadImageInformation()
            size = reader.GetSize()
            dtype = np.dtype(dtype_of(sitk, reader.GetPixelID()))
            n_components = reader.GetNumberOfComponents()
            shape = (*size, n_components)
            _check_payload(path, places, header.fields, shape, dtype)
            # The last axis, or the components, may be times.
            has_times = header.listed is not None and not _is_of_channels(header.listed, request)
            n_times = size[3] if len(size) == 4 else n_components if has_times else 1
            n_channels = 1 if has_times else n_components
            time = choose("time", n_times, request.time, path)
            channel = choose("channel", n_channels, request.channel, path)
            if len(size) == 4:
                reader.SetExtractSize([*size[:3], 0])
                reader.SetExtractIndex([0, 0, 0, time])
            if _lacks_length(header):
                whole = inflated(path, header, (*size[::-1], n_components))
                samples = whole[time] if len(size) == 4 else whole
                samples = samples[..., 0] if n_components == 1 else samples
                place: Any = reader
            else:
                place = reader.Execute()
                samples = sitk.GetArrayFromImage(place)
            if n_components > 1:
                samples = samples[..., time if has_times else channel]
            are_colors = "-color" in header.fields.get("kinds", "").lower()
            colors = facts_of_colors(n_channels, dtype, request, are_colors=are_colors)
            facts = replace(header.facts, n_times=n_times, **colors)
            if header.listed is not None and not header.listed.is_known:
                facts = replace(facts, guesses=(*facts.guesses, _guess(header.listed, has_times)))
            if len(size) == 4:
                step = float(reader.GetSpacing()[3])
                # 1 is what is written where nothing is known.
                facts = replace(facts, time_step=step if step not in (0.0, 1.0) else None)
            return Grid(samples, world_from_index_of(place, header), facts)


def for_itk(path: Path, header: Header, places: Sequence[tuple[Path, int]]) -> AbstractContextManager[Path]:
    """The file for ITK: itself or, where ITK would take it for something else, another header while it is read."""
    rewritten = meta_for_itk if "elementdatafile" in header.fields else header_for_itk
    return rewritten(path, header.fields, places)


def _is_of_channels(axis: ListedAxis, request: Request) -> bool:
    """Whether an axis is one of channels: its kind is unknown, and a channel is asked for, or it is the fastest."""
    if axis.is_known or request.time is not None:
        return False
    return request.channel is not None or axis.number == 0


def _guess(axis: ListedAxis, has_times: bool) -> str:
    meaning = "time points" if has_times else "channels"
    return f"axis {axis.number} of the file, {axis.size} samples long, is of {meaning}: the file names no kind of it"


def _image_io(path: Path) -> str:
    with path.open("rb") as file:
        if file.read(4) == b"NRRD":
            return "NrrdImageIO"
    return "MetaImageIO" if path.suffix.lower() in (".mha", ".mhd") else "NrrdImageIO"


def simple_itk() -> Any:
    """The SimpleITK module, its warnings on stderr switched off: errors reach us as exceptions."""
    import SimpleITK

    SimpleITK.ProcessObject.SetGlobalWarningDisplay(False)
    return SimpleITK


def header_of(path: Path) -> Header:
    """The header of a file, for what ITK leaves out."""
    return of_meta_image(path) if path.suffix.lower() in (".mha", ".mhd") else of_nrrd(path)


def _lacks_length(header: Header) -> bool:
    """Whether samples are compressed and their packed size is not given: ITK then reads garbage."""
    is_packed = header.fields.get("compresseddata", "").lower().startswith(("t", "1"))
    return is_packed and "compresseddatasize" not in header.fields


def world_from_index_of(image: Any, header: Header) -> NDArray[np.float64]:
    """World from index of a 3-D image, or of the first three axes of a 4-D one."""
    n = len(image.GetSpacing())
    if n < 3:
        return np.eye(4)  # a 2-D image; the volume's own check says so
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(image.GetDirection(), (n, n))[:3, :3] * np.asarray(image.GetSpacing())[:3]
    matrix[:3, 3] = image.GetOrigin()[:3]
    matrix = np.diag([*header.ras_signs, 1.0]) @ matrix if header.facts.is_anatomical else matrix
    return header.in_one_unit(matrix)


def dtype_of(sitk: Any, pixel_id: int) -> str:
    """NumPy's name of an ITK pixel type: "vector of 16-bit signed integer" -> "int16"."""
    words = sitk.GetPixelIDValueAsString(pixel_id)
    bits = next((word.removesuffix("-bit") for word in words.split() if word.endswith("-bit")), "8")
    kind = (
        "complex" if "complex" in words else "float" if "float" in words else "uint" if "unsigned" in words else "int"
    )
    return kind + (str(2 * int(bits)) if kind == "complex" else bits)


def _check_payload(
    path: Path,
    places: Sequence[tuple[Path, int]],
    header: dict[str, str],
    shape: Sequence[int],
    dtype: np.dtype[Any],
) -> None:
    """Compare the size that the header promises with the size of the files that hold the samples."""
    for file, _ in places:
        if not file.is_file():
            raise FileError(
                f"the header names a data file that is not there, {file.name!r}; put it beside the header: {path}"
            )
    encoding = header.get("encoding", "raw").lower()
    if header.get("compresseddata", "").lower().startswith(("t", "1")) or encoding in ("gzip", "gz"):
        ratio = size_checks.DEFLATE_RATIO
    else:
        ratio = size_checks.ANY_RATIO if encoding in ("bzip2", "bz2") else 1
    stored = sum(max(file.stat().st_size - offset, 0) for file, offset in dict(places).items())
    if (packed := int(header.get("compresseddatasize") or 0)) > stored:
        raise FileError(
            f"truncated, or a wrong header: it promises {packed} compressed bytes, the file holds {stored}; copy or "
            f"export it again: {path}"
        )
    if encoding in ("ascii", "text", "txt"):
        # Each number takes at least a digit and a space.
        size_checks.check_stored(shape, np.dtype("u1"), (stored + 1) // 2, path, held=(1,))
        size_checks.check_memory(size_checks.n_bytes(shape, dtype), path)
        for file, offset in places:
            _check_words(file, offset, path)
    else:
        size_checks.check_stored(shape, dtype, stored // 2 if encoding == "hex" else stored, path, ratio=ratio)
    if ratio == size_checks.DEFLATE_RATIO:
        # ITK returns a part of the samples of a damaged stream, and does not verify checksums.
        skipped = int(header.get("headersize", 0)) if len(places) == 1 and places[0][1] == 0 else 0
        n_lines = int(header.get("line skip", 0))
        begins = [(file, _after_lines(file, offset + max(skipped, 0), n_lines)) for file, offset in places]
        size_checks.check_deflated(begins, size_checks.n_bytes(shape, dtype), path)


def _check_words(file: Path, offset: int, path: Path) -> None:
    """Raise a `FileError` for text samples with a word longer than any number: it overflows ITK's buffer."""
    longest, begin = 0, 0
    with file.open("rb") as stream:
        stream.seek(offset)
        while piece := stream.read(BLOCK_BYTES):
            ends = np.flatnonzero(np.isin(np.frombuffer(piece, np.uint8), SPACES))
            # The word at the end of a piece goes on in the next one.
            edges = np.concatenate([[begin], ends, [len(piece)]])
            longest = max(longest, int(np.diff(edges).max()))
            begin = int(edges[-2]) - len(piece)
    if longest > MAX_WORD_BYTES:
        raise FileError(
            f"damaged: among its samples stands a word of {longest - 1} letters, which is no number; copy or export it "
            f"again: {path}"
        )


def _after_lines(file: Path, offset: int, n_lines: int) -> int:
    """Offset of a packed stream: NRRD skips lines before it unpacks, and bytes after that."""
    with file.open("rb") as stream:
        stream.seek(offset)
        skip_lines(stream, n_lines)
        return stream.tell()
