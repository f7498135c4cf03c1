"""Stored numbers of DICOM files, frame by frame, without slope and without inversion for display.

Uncompressed pixels are taken from the bytes, which are counted first: there may be too few. RLE is unpacked by pydicom,
all else by SimpleITK (GDCM), from a copy without slopes and display settings, so that GDCM applies none.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._readers.dicom.header import Header
from wavesplat._readers.dicom.mosaic import slices_in
from wavesplat._readers.dicom.pixel_data import (
    BIG_ENDIAN,
    DEFLATED,
    DOUBLES,
    FLOATS,
    NATIVE,
    PIXELS,
    check_enough,
    n_bits_of,
    unpacked_part,
)
from wavesplat._readers.nrrd.itk import simple_itk
from wavesplat._storage import size_checks
from wavesplat._storage.reading import BoundedFile
from wavesplat._system.libraries import muted_stderr
from wavesplat.errors import FileError

RLE = "1.2.840.10008.1.2.5"
#: Transfer syntaxes that GDCM unpacks: JPEG (baseline, extended, lossless), JPEG-LS and JPEG 2000.
JPEG = {f"1.2.840.10008.1.2.4.{number}" for number in (50, 51, 57, 70, 80, 81, 90, 91)}
#: Transfer syntaxes with loss, by which numbers can come out larger than they went in; and transfer syntaxes of
#: JPEG-LS.
LOSSY = {f"1.2.840.10008.1.2.4.{number}" for number in (50, 51, 81, 91)}
JPEG_LS = {f"1.2.840.10008.1.2.4.{number}" for number in (80, 81)}
#: Transfer syntaxes of video: MPEG-2, MPEG-4 and HEVC.
VIDEO = {f"1.2.840.10008.1.2.4.{number}" for number in range(100, 109)}
SECONDARY_CAPTURE = "1.2.840.10008.5.1.4.1.1.7"
ITEM, END_OF_ITEMS = b"\xfe\xff\x00\xe0", b"\xfe\xff\xdd\xe0"


def frames_in(header: Header) -> NDArray[Any]:
    """All frames of a file, shape (frames, rows, columns), and samples behind if a pixel has several."""
    if header.tiles is not None and header.whole is not None:
        return slices_in(frames_in(header.whole)[0], header.tiles)
    check_syntax(header)
    columns, rows = header.size
    shape = (header.n_frames, rows, columns)
    size_checks.check_memory(math.prod(shape) * header.n_colors * max(header.bits_allocated // 8, 1), header.file)
    stored = _stored(header, shape)
    return _looked_up(stored, header) if header.photometric == "PALETTE COLOR" else stored


def _stored(header: Header, shape: tuple[int, int, int]) -> NDArray[Any]:
    if header.transfer_syntax == RLE:
        unpacked = _unpacked_rle(header).reshape((*shape, header.n_samples) if header.n_samples > 1 else shape)
        return _as_rgb(unpacked, header) if header.n_samples > 1 else _meant(unpacked, header)
    if header.n_samples > 1:
        is_native = header.transfer_syntax in NATIVE
        return _by_neutral_copy(header, shape, None if is_native else _fragments(header))
    if header.transfer_syntax in NATIVE:
        return _native(header, shape)
    fragments = _fragments(header)
    stored = _by_neutral_copy(header, shape, fragments)
    _check_bits(max(stored.dtype.itemsize * 8, _jpeg_precision(fragments)), header)
    if header.transfer_syntax in LOSSY and not header.is_signed:
        return stored.view(f"u{stored.dtype.itemsize}")  # numbers just beyond the stored bits are pixels, too
    return _meant(stored, header)


def _as_rgb(stored: NDArray[Any], header: Header) -> NDArray[Any]:
    """Red, green and blue of unpacked colours, which may be stored as brightness and two differences (YBR)."""
    from pydicom.pixels.processing import convert_color_space

    if header.photometric not in ("YBR_FULL", "YBR_FULL_422") or stored.dtype != np.uint8:
        return stored
    return np.stack([convert_color_space(frame, header.photometric, "RGB") for frame in stored])


def _looked_up(stored: NDArray[Any], header: Header) -> NDArray[Any]:
    """Colours of stored numbers, red, green and blue, in the palette of the file.

    Entries of 16 bits, of which only the lowest 8 are used, are of 8.
    """
    from pydicom import dcmread
    from pydicom.pixels.processing import apply_color_lut

    with BoundedFile(header.file) as stream:
        dataset = dcmread(stream, stop_before_pixels=True, force=True)
    try:
        colors = np.concatenate([apply_color_lut(frame, dataset)[None, ..., :3] for frame in stored])
    except (AttributeError, KeyError, ValueError) as error:
        reason = str(error).strip().splitlines()[0].rstrip(".")
        raise FileError(f"the palette cannot be read: {reason}; export it again: {header.file}") from error
    return colors.astype(np.uint8) if colors.dtype == np.uint16 and colors.max(initial=0) < 1 << 8 else colors


def frame_by_frame(header: Header) -> Callable[[int], NDArray[Any]]:
    """A function from the number of a frame to its stored numbers, shape (rows, columns).

    Uncompressed masks of one bit are unpacked when they are asked for: all at once they are eight times as large.
    """
    check_syntax(header)
    if header.transfer_syntax not in NATIVE or header.bits_allocated != 1:
        return frames_in(header).__getitem__
    columns, rows = header.size
    packed = np.frombuffer(_native_bytes(header)[1], np.uint8)
    n = rows * columns

    def frame(index: int) -> NDArray[Any]:
        begin = index * n  # in bits; frames follow each other without gaps
        bits = np.unpackbits(packed[begin // 8 : -(-(begin + n) // 8)], bitorder="little")
        return bits[begin % 8 : begin % 8 + n].reshape(rows, columns)

    return frame


def _check_bits(n_bits: int, header: Header) -> None:
    """Raise a `FileError` if unpacked numbers have more bits than the header says, which would be cut."""
    if n_bits > max(header.bits_allocated, 8):
        raise FileError(
            f"the compressed pixels have {n_bits} bits, the header says {header.bits_allocated} (BitsAllocated); "
            f"export it again: {header.file}"
        )


def _jpeg_precision(fragments: bytes) -> int:
    """Bits of a pixel by the frame header (SOF) of the first JPEG or JPEG-LS stream; 0 if none is found.

    ITU-T T.81, B.2.2: a marker, two bytes of length, one of precision.
    """
    at = 8 + int.from_bytes(fragments[4:8], "little") + 8 + 2  # after the offset table, the item's head and the mark
    while fragments[at : at + 1] == b"\xff" and at + 5 <= len(fragments):
        marker = fragments[at + 1]
        if marker == 0xF7 or (0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC)):
            return fragments[at + 4]
        at += 2 + int.from_bytes(fragments[at + 2 : at + 4], "big")
    return 0


def check_syntax(header: Header) -> None:
    """Raise a `FileError` if the pixels are compressed in a way that is not read."""
    syntax = header.transfer_syntax
    if syntax in NATIVE or syntax in JPEG or syntax == RLE:
        return
    from pydicom.uid import UID

    name = UID(syntax).name
    if syntax in VIDEO:
        raise FileError(f"the file holds a video ({name}), and no volume; name a series of slices: {header.file}")
    raise FileError(
        f"the pixels are compressed as {name}, which is not read here; convert the files to JPEG 2000, JPEG-LS, RLE or "
        f"uncompressed pixels, such as by `gdcmconv --raw`: {header.file}"
    )


def _native(header: Header, shape: tuple[int, int, int]) -> NDArray[Any]:
    tag, content = _native_bytes(header)
    n_bits = n_bits_of(tag, header)
    if n_bits == 1:
        bits = np.unpackbits(np.frombuffer(content, np.uint8), bitorder="little")
        return bits[: math.prod(shape)].reshape(shape)
    if n_bits not in (8, 16, 32, 64):
        raise FileError(f"pixels of {n_bits} bits cannot be read; export them with 8, 16 or 32: {header.file}")
    kind = "f" if tag in (FLOATS, DOUBLES) else "u"
    dtype = np.dtype(f"{kind}{n_bits // 8}").newbyteorder(">" if header.transfer_syntax == BIG_ENDIAN else "<")
    stored = np.frombuffer(content, dtype).reshape(shape).astype(dtype.newbyteorder("="), copy=False)
    if kind == "f":
        return stored
    meant = _meant(stored, header)
    if is_padding_beyond_bits(header):
        low, high = header.padding or (0, 0)
        whole = stored.view(f"{'i' if header.is_signed else 'u'}{stored.dtype.itemsize}")
        meant[(whole >= low) & (whole <= high)] = -(1 << header.bits_stored - 1) if header.is_signed else 0
    return meant


def is_padding_beyond_bits(header: Header) -> bool:
    """Whether the padding value does not fit into the stored bits, which would show another number instead."""
    n_bits = header.bits_stored
    if header.padding is None or not 0 < n_bits < header.bits_allocated:
        return False
    low, high = (-(1 << n_bits - 1), (1 << n_bits - 1) - 1) if header.is_signed else (0, (1 << n_bits) - 1)
    return header.padding[0] > high or header.padding[1] < low


def _native_bytes(header: Header) -> tuple[int, bytes]:
    """Tag and bytes of uncompressed pixels, exactly as many bytes as the frames need."""
    if (data := header.pixel_data) is not None:
        n_bits = n_bits_of(data.tag, header)
        needed = check_enough(header, data.n_bytes, n_bits)
        if header.transfer_syntax == DEFLATED:
            content = unpacked_part(header.file, data.offset, needed)
            check_enough(header, len(content), n_bits)
            return data.tag, content
        is_swapped = data.is_of_words and n_bits == 8 and header.transfer_syntax == BIG_ENDIAN
        with header.file.open("rb") as stream:
            stream.seek(data.offset)
            content = stream.read(needed + needed % 2 if is_swapped else needed)
        return data.tag, np.frombuffer(content, "u2").byteswap().tobytes()[:needed] if is_swapped else content
    from pydicom import dcmread

    with BoundedFile(header.file) as stream:
        dataset = dcmread(stream, force=True)
    tag = next((tag for tag in (PIXELS, FLOATS, DOUBLES) if tag in dataset), PIXELS)
    content = bytes(dataset.get_item(tag).value or b"") if tag in dataset else b""
    return tag, content[: check_enough(header, len(content), n_bits_of(tag, header))]


def _meant(stored: NDArray[Any], header: Header) -> NDArray[Any]:
    """The stored bits of each pixel, with their sign; the other bits may hold anything."""
    n_bits = stored.dtype.itemsize * 8
    unsigned = np.dtype(f"u{stored.dtype.itemsize}")
    signed = np.dtype(f"i{stored.dtype.itemsize}")
    if not 0 < header.bits_stored < n_bits:
        return stored.view(signed if header.is_signed else unsigned)
    # Shifted to the top, which drops the bits above, and back, which extends the sign.
    up = max(n_bits - 1 - header.high_bit, 0)
    top = np.left_shift(stored.view(unsigned), unsigned.type(up))
    down = n_bits - header.bits_stored
    meant: NDArray[Any] = np.right_shift(top.view(signed if header.is_signed else unsigned), down)
    return meant


def _unpacked_rle(header: Header) -> NDArray[Any]:
    from pydicom import dcmread
    from pydicom.pixels import decoders

    with BoundedFile(header.file) as stream:
        dataset = dcmread(stream, stop_before_pixels=True, force=True)
    _set_pixels(dataset, _fragments(header))
    of_all: Any = decoders
    try:
        array: NDArray[Any] = of_all.RLELosslessDecoder.as_array(dataset, raw=True)[0]
    except (RuntimeError, ValueError) as error:
        reason = str(error).strip().splitlines()[-1].rpartition("pydicom: ")[2].rstrip(".")
        raise FileError(
            f"the compressed pixels (RLE) do not unpack: {reason}; export it again: {header.file}"
        ) from error
    return array


def _set_pixels(dataset: Any, fragments: bytes) -> None:
    """Give a dataset the compressed pixels of a file."""
    dataset.PixelData = fragments
    dataset["PixelData"].VR = "OB"
    dataset["PixelData"].is_undefined_length = True


def _fragments(header: Header) -> bytes:
    """Items of compressed pixels, without the end mark, which must be there: else the file was cut.

    (pydicom would warn and take what there is.)
    """
    data = header.pixel_data
    if data is None:
        raise FileError(f"the compressed pixels cannot be found; copy or export it again: {header.file}")
    with header.file.open("rb") as stream:
        stream.seek(data.offset)
        content = stream.read(data.n_bytes)
    end = 0
    while content[end : end + 4] == ITEM and end + 8 <= len(content):
        end += 8 + int.from_bytes(content[end + 4 : end + 8], "little")
    if content[end : end + 4] != END_OF_ITEMS:
        raise FileError(f"truncated: the compressed pixels have no end; copy or export it again: {header.file}")
    return _one_a_frame(content[:end], header) if header.transfer_syntax in JPEG_LS else content[:end]


def _one_a_frame(fragments: bytes, header: Header) -> bytes:
    """The same items with one for each frame: GDCM does not join fragments of JPEG-LS."""
    from pydicom.encaps import encapsulate, generate_frames

    frames = list(generate_frames(fragments + END_OF_ITEMS + bytes(4), number_of_frames=header.n_frames))
    return encapsulate(frames, has_bot=False)


def _by_neutral_copy(header: Header, shape: tuple[int, int, int], fragments: bytes | None) -> NDArray[Any]:
    """Frames by GDCM, from a copy of the pixels alone. `fragments`: compressed pixels; None for uncompressed ones."""
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import UID

    copy = Dataset()
    copy.file_meta = FileMetaDataset()
    copy.file_meta.TransferSyntaxUID = UID(header.transfer_syntax)
    copy.file_meta.MediaStorageSOPClassUID = copy.SOPClassUID = UID(SECONDARY_CAPTURE)
    copy.file_meta.MediaStorageSOPInstanceUID = copy.SOPInstanceUID = UID("2.25.1")
    copy.SamplesPerPixel = header.n_samples
    copy.PhotometricInterpretation = "MONOCHROME2" if header.n_samples == 1 else header.photometric
    copy.Columns, copy.Rows = header.size
    copy.BitsAllocated, copy.BitsStored, copy.HighBit = header.bits_allocated, header.bits_stored, header.high_bit
    copy.PixelRepresentation = int(header.is_signed)
    if header.n_frames > 1:
        copy.NumberOfFrames = header.n_frames
    if header.n_samples > 1:
        copy.PlanarConfiguration = header.planes
    if fragments is None:
        content = _native_bytes(header)[1]
        copy.PixelData = content + b"\0" * (len(content) % 2)
        copy["PixelData"].VR = "OW" if header.bits_allocated > 8 else "OB"
    else:
        _set_pixels(copy, fragments)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "pixels.dcm"
        copy.save_as(file, enforce_file_format=True)
        return _by_itk(file, shape)


def _by_itk(file: Path, shape: tuple[int, int, int]) -> NDArray[Any]:
    sitk = simple_itk()
    with muted_stderr():
        image = sitk.ReadImage(str(file))
    array: NDArray[Any] = sitk.GetArrayFromImage(image)
    n_components = int(image.GetNumberOfComponentsPerPixel())
    return array.reshape((*shape, n_components) if n_components > 1 else shape)
