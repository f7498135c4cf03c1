"""Place and size of a DICOM file's pixel data, and checks that they can hold the frames that its header claims.

Checked before a frame is described or memory is allocated: a header of some bytes can promise millions of frames.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from wavesplat._files import size_checks
from wavesplat._readers.dicom_deflated import DEFLATED, UnpackedStream
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

    from wavesplat._readers.dicom_header import Header

BIG_ENDIAN = "1.2.840.10008.1.2.2"
#: Transfer syntaxes whose frames are not compressed one by one.
NATIVE = {"1.2.840.10008.1.2", "1.2.840.10008.1.2.1", DEFLATED, BIG_ENDIAN}
PIXELS, FLOATS, DOUBLES = 0x7FE00010, 0x7FE00008, 0x7FE00009
UNDEFINED_LENGTH = 0xFFFFFFFF
ITEM = b"\xfe\xff\x00\xe0"


@dataclass(frozen=True)
class PixelData:
    """The element with the pixels: PIXELS, FLOATS or DOUBLES, and where its value begins in the file, once unpacked."""

    tag: int
    offset: int
    #: Bytes of the value: of compressed pixels all to the end of the file, of a packed file at most those it can hold.
    n_bytes: int
    #: Whether samples of one byte are stored in 16-bit words, in the byte order of the file.
    is_of_words: bool = False


def pixel_data_at(stream: BinaryIO | UnpackedStream, dataset: Dataset, file: Path) -> PixelData | None:
    """The pixel data of a file that was read up to them; None where only reading them shows how long they are."""
    syntax = str(dataset.file_meta.get("TransferSyntaxUID", "1.2.840.10008.1.2"))
    is_implicit, is_little = dataset.original_encoding
    order = "little" if is_little else "big"
    head = stream.read(8 if is_implicit else 12)
    begin = stream.tell()
    tag = int.from_bytes(head[:2], order) << 16 | int.from_bytes(head[2:4], order)  # type: ignore[arg-type]
    if tag not in (PIXELS, FLOATS, DOUBLES) or len(head) < (8 if is_implicit else 12):
        return PixelData(PIXELS, begin, 0)
    length = int.from_bytes(head[-4:], order)  # type: ignore[arg-type]
    if isinstance(stream, UnpackedStream):
        if length == UNDEFINED_LENGTH:
            raise FileError(f"the pixel data do not say how long they are; copy or export it again: {file}")
        return PixelData(tag, begin, min(length, file.stat().st_size * size_checks.DEFLATE_RATIO))
    if length == UNDEFINED_LENGTH and syntax in NATIVE:
        return None
    n_left = file.stat().st_size - begin
    is_of_words = not is_implicit and head[4:6] == b"OW"
    return PixelData(tag, begin, n_left if syntax not in NATIVE else min(length, n_left), is_of_words)


def n_bits_of(tag: int, header: Header) -> int:
    """Bits of a stored number."""
    return {FLOATS: 32, DOUBLES: 64}.get(tag, header.bits_allocated)


def check_enough(header: Header, n_bytes: int, n_bits: int) -> int:
    """Number of bytes that uncompressed pixels need; a `FileError` if the file holds fewer, or twice that number."""
    columns, rows = header.size
    shape = (header.n_frames, rows, columns, header.n_samples)
    if n_bits == 0:
        raise FileError(f"the header says 0 bits a pixel (BitsAllocated); copy or export it again: {header.file}")
    # In YBR_FULL_422 two pixels share their chroma samples.
    n_numbers = header.n_frames * rows * columns * header.n_samples
    if header.n_samples == 3 and header.photometric.endswith("_422"):
        n_numbers = n_numbers * 2 // 3
    needed = -(-n_numbers * n_bits // 8)
    described = " x ".join(str(n) for n in (shape if header.n_samples > 1 else shape[:3]))
    if n_bytes < needed:
        raise FileError(
            f"too little pixel data: {described} pixels of {n_bits} bits need {needed} bytes, "
            f"the file holds {n_bytes}; copy or export it again: {header.file}"
        )
    if n_bytes >= 2 * needed and n_bytes > needed + 1:  # one byte may make their number even
        raise FileError(
            f"too much pixel data: {described} pixels of {n_bits} bits need {needed} bytes, the file holds {n_bytes}, "
            f"so BitsAllocated ({header.bits_allocated}), NumberOfFrames, Rows or Columns is wrong; "
            f"export it again: {header.file}"
        )
    return needed


def check_n_frames(header: Header) -> None:
    """Raise a `FileError` if the pixel data cannot hold as many frames as the header says."""
    data = header.pixel_data
    if header.transfer_syntax in NATIVE:
        if data is not None:
            check_enough(header, data.n_bytes, n_bits_of(data.tag, header))
        else:
            n_bytes = header.file.stat().st_size
            columns, rows = header.size
            if header.n_frames * rows * columns * max(header.bits_allocated, 1) > 8 * n_bytes:
                raise FileError(
                    f"too little pixel data: the header says {header.n_frames} frames (NumberOfFrames) of "
                    f"{columns} x {rows} pixels, the file holds {n_bytes} bytes; copy or export it again: {header.file}"
                )
        return
    if data is not None and (found := _n_fragments(header.file, data)) < header.n_frames:
        raise FileError(
            f"truncated, or a wrong header: {header.n_frames} frames (NumberOfFrames) need as many compressed "
            f"fragments, the file holds {found}; copy or export it again: {header.file}"
        )


def _n_fragments(file: Path, data: PixelData) -> int:
    """Number of fragments of compressed pixels, by the heads of items alone; the first item is a table of offsets."""
    count = 0
    with file.open("rb") as stream:
        stream.seek(data.offset)
        while len(head := stream.read(8)) == 8 and head[:4] == ITEM:
            count += 1
            stream.seek(int.from_bytes(head[4:], "little"), 1)
    return max(count - 1, 0)
