"""Place and size of a DICOM file's pixel data, and files that are packed as a whole.

Checked before a frame is described or memory is allocated: a header of some bytes can promise millions of frames.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

from wavesplat._storage import size_checks
from wavesplat._storage.reading import BoundedFile
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from pydicom.dataset import Dataset, FileMetaDataset

    from wavesplat._readers.dicom.header import Header

# DICOM files that are packed as a whole (deflated): unpacked as far as they are read, and never further.
#
# A few MB can unpack to a few GB. The header is unpacked up to the pixel data, and the pixel data only to the size that
# the header gives.
# Format: DICOM PS3.5, A.5. File meta information as it is, and behind it the data set as one raw stream of deflate.

#: The transfer syntax of files that are packed as a whole.
DEFLATED = "1.2.840.10008.1.2.1.99"
#: Largest header in bytes, unpacked: functional groups of ten thousand frames take a tenth of it.
MAX_HEADER_BYTES = 1 << 28
PIXEL_DATA = {0x7FE00008, 0x7FE00009, 0x7FE00010}
BLOCK_BYTES = 1 << 20


class UnpackedStream:
    """A packed stream as a file to read, which keeps what it has unpacked."""

    def __init__(self, packed: BinaryIO, file: Path) -> None:
        self._packed, self._file = packed, file
        self._unpacking = zlib.decompressobj(-zlib.MAX_WBITS)
        self._content = bytearray()
        self._at = 0

    def read(self, n: int = -1) -> bytes:
        """The next bytes, fewer at the end."""
        end = MAX_HEADER_BYTES + 1 if n < 0 else self._at + n
        while len(self._content) < min(end, MAX_HEADER_BYTES + 1) and (block := self.block()):
            self._content += block
        if len(self._content) > MAX_HEADER_BYTES:
            raise FileError(
                f"the packed header unpacks to more than {MAX_HEADER_BYTES >> 20} MiB before the pixel data; "
                f"copy or export it again: {self._file}"
            )
        part = bytes(self._content[self._at : end])
        self._at += len(part)
        return part

    def seek(self, offset: int, whence: int = 0) -> int:
        """Go to a byte from the beginning (0) or from here (1)."""
        self._at = max(offset + (self._at if whence == 1 else 0), 0)
        return self._at

    def tell(self) -> int:
        """Offset of the next byte to read."""
        return self._at

    def block(self) -> bytes:
        """The next unpacked bytes, at most a block, which are not kept; empty at the end."""
        block = b""
        while not (block or self._unpacking.eof):
            packed = self._unpacking.unconsumed_tail or self._packed.read(BLOCK_BYTES)
            block = self._unpacking.decompress(packed, BLOCK_BYTES)
            if not (packed or block):
                break
        return block


def header_dataset(file: Path, stream: BinaryIO) -> tuple[Dataset, BinaryIO | UnpackedStream]:
    """The data set of a file up to its pixel data, and the stream, in which these follow."""
    from pydicom import dcmread
    from pydicom.dataset import FileDataset
    from pydicom.filereader import read_dataset

    meta = _meta_of(stream)
    if meta.get("TransferSyntaxUID") != DEFLATED:
        stream.seek(0)
        return dcmread(stream, stop_before_pixels=True, force=True), stream
    unpacked = UnpackedStream(stream, file)
    as_file = cast("BinaryIO", unpacked)  # pydicom calls only read, seek and tell
    dataset = read_dataset(as_file, False, True, stop_when=lambda tag, _vr, _length: tag in PIXEL_DATA)
    return FileDataset(str(file), dataset, b"", meta, False, True), unpacked


def unpacked_part(file: Path, offset: int, n_bytes: int) -> bytes:
    """`n_bytes` bytes of the unpacked data set from byte `offset` on, fewer where it ends."""
    content = bytearray()
    with BoundedFile(file) as stream:
        _meta_of(stream)
        unpacked = UnpackedStream(stream, file)
        while len(content) < n_bytes and (block := unpacked.block()):
            content += block[offset:]
            offset = max(offset - len(block), 0)
    return bytes(content[:n_bytes])


def check_unpacked_size(file: Path, n_bytes: int) -> None:
    """Raise a `FileError` if the data set unpacks to more than `n_bytes` and the largest header."""
    count = 0
    with BoundedFile(file) as stream:
        _meta_of(stream)
        unpacked = UnpackedStream(stream, file)
        while block := unpacked.block():
            count += len(block)
            if count > n_bytes + MAX_HEADER_BYTES:
                raise FileError(
                    f"the packed file unpacks to far more than the {n_bytes} bytes of its header and its pixels; "
                    f"copy or export it again: {file}"
                )


def _meta_of(stream: BinaryIO) -> FileMetaDataset:
    """Read the file meta information; the stream is behind it afterwards."""
    from pydicom.dataset import FileMetaDataset
    from pydicom.filereader import read_dataset, read_preamble

    stream.seek(0)
    read_preamble(stream, force=True)
    return FileMetaDataset(read_dataset(stream, False, True, stop_when=lambda tag, _vr, _length: tag >> 16 != 2))


# Place and size of a DICOM file's pixel data, and checks that they can hold the frames that its header claims.

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
