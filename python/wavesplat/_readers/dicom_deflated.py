"""DICOM files that are packed as a whole (deflated): unpacked as far as they are read, and never further.

A few MB can unpack to a few GB. The header is unpacked up to the pixel data, and the pixel data only to the size that
the header gives.
Format: DICOM PS3.5, A.5. File meta information as it is, and behind it the data set as one raw stream of deflate.
"""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

from wavesplat._files.bounded_file import BoundedFile
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from pydicom.dataset import Dataset, FileMetaDataset

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
