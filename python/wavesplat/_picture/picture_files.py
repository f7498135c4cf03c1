"""Pictures as files: PNG with its texts, JPEG, WebP, TIFF and OpenEXR.

OpenEXR holds the floats as they are; bytes come from `straight_bytes`, which rounds as the PNG encoder does.
"""

from __future__ import annotations

import io
import json
import struct
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._model.volume.private_names import Published, whole, without_folders
from wavesplat._model.volume.sources import beside

if TYPE_CHECKING:
    from wavesplat._picture.picture import Picture

# Texts in PNG files: chunks of the kind iTXt, UTF-8, compressed (PNG, third edition, 11.3.3.4).
#
# A long text is cut into several chunks of one keyword: Pillow opens no file with a chunk of more than 1 MiB of text.

SIGNATURE = b"\x89PNG\r\n\x1a\n"
#: The keyword of the scene.
KEYWORD = "wavesplat"
#: Length of the signature and the first chunk, after which others may stand.
HEADER = len(SIGNATURE) + 25
#: Largest text of a chunk, and of all chunks together, bytes.
MAX_PIECE = 1 << 19
MAX_TEXT = 1 << 26


def with_text(content: bytes, keyword: str, text: str) -> bytes:
    """The content of a PNG file with a text in it."""
    # A character has up to four bytes.
    pieces = [text[first : first + MAX_PIECE // 4] for first in range(0, max(len(text), 1), MAX_PIECE // 4)]
    chunks = b"".join(_chunk(keyword, piece) for piece in pieces)
    return content[:HEADER] + chunks + content[HEADER:]


def _chunk(keyword: str, text: str) -> bytes:
    data = zlib.compress(text.encode(), 9)
    body = b"iTXt" + keyword.encode("latin-1") + b"\0\1\0\0\0" + data
    return struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))


def text_in(content: bytes, keyword: str) -> str | None:
    """The text with a keyword; None where there is none.

    Raises
    ------
    ValueError
        If the file is damaged.
    """
    pieces: list[bytes] = []
    place = len(SIGNATURE)
    while place + 8 <= len(content):
        (length,) = struct.unpack_from(">I", content, place)
        kind, body = content[place + 4 : place + 8], content[place + 8 : place + 8 + length]
        place += 12 + length
        if kind != b"iTXt" or not body.startswith(keyword.encode("latin-1") + b"\0"):
            continue
        rest = body[len(keyword) + 1 :]
        is_compressed, _, rest = rest[:1] == b"\1", rest[1:2], rest[2:]
        _language, _, rest = rest.partition(b"\0")
        _translated, _, data = rest.partition(b"\0")
        pieces.append(_inflated(data, MAX_TEXT - sum(map(len, pieces))) if is_compressed else data)
    return b"".join(pieces).decode() if pieces else None


def _inflated(data: bytes, most: int) -> bytes:
    inflater = zlib.decompressobj()
    try:
        # One byte more than allowed: no limit at all is written as 0.
        text = inflater.decompress(data, most + 1)
    except zlib.error as error:
        raise ValueError(f"its text is damaged: {error}") from None
    if len(text) > most or inflater.unconsumed_tail or not inflater.eof:
        raise ValueError("its text is damaged, or larger than any that wavesplat writes")
    return text


# Pictures as files: PNG, JPEG, WebP, TIFF and OpenEXR.

#: Grey behind transparent pixels in formats without transparency.
PAPER = 1.0
METRES_PER_INCH = 0.0254
#: Release of ImageJ that the description of a TIFF file names; any marks it as one whose unit ImageJ reads.
IMAGEJ = "1.54f"


def straight_bytes(rgba: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Associated floats as bytes of colour, not multiplied by opacity, and opacity."""
    levels = _native.straight_bytes(np.ascontiguousarray(rgba, dtype=np.float32))
    return np.frombuffer(levels, np.uint8).reshape(rgba.shape).copy()


def image(rgba: NDArray[np.float32]) -> Any:
    """A `PIL.Image.Image` with straight alpha."""
    from PIL import Image

    return Image.fromarray(straight_bytes(rgba))


def rgb_image(rgba: NDArray[np.float32], paper: tuple[float, float, float]) -> Any:
    """A `PIL.Image.Image` without alpha, over an opaque colour."""
    from PIL import Image

    levels = _native.rgb_bytes(np.ascontiguousarray(rgba, dtype=np.float32), paper)
    return Image.frombuffer("RGB", (rgba.shape[1], rgba.shape[0]), levels, "raw", "RGB", 0, 1)


def png_bytes(rgba: NDArray[np.float32], bits: int, dpi: float | None = None) -> bytes:
    """The content of a PNG file."""
    content = _native.encode_png(np.ascontiguousarray(rgba, dtype=np.float32), bits)
    if dpi is None:
        return content
    per_metre = round(dpi / METRES_PER_INCH)
    data = b"pHYs" + struct.pack(">IIB", per_metre, per_metre, 1)
    chunk = struct.pack(">I", len(data) - 4) + data + struct.pack(">I", zlib.crc32(data))
    header = 8 + 25  # the signature and the first chunk, after which others may stand
    return content[:header] + chunk + content[header:]


def with_scene(content: bytes, scene: Any, folder: Path | None) -> bytes:
    """The content of a PNG file with a scene's document.

    folder : of the file: paths are relative to it where they can be; None writes names of files alone.
    """
    if not isinstance(scene, dict):
        return content
    document = _without_folders(scene) if folder is None else beside(whole(scene), folder)
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"))
    return with_text(content, KEYWORD, text)


def _without_folders(scene: dict[str, Any]) -> Any:
    return scene if isinstance(scene, Published) else without_folders(scene)


def write_bytes_of(picture: Picture, path: Path, *, dpi: float | None, quality: int) -> None:
    """Write a JPEG or WebP file; the suffix chooses."""
    # Encoded in memory: errors of the disk are then the system's own `OSError`.
    content = io.BytesIO()
    if path.suffix.lower() == ".webp":
        image(picture.rgba).save(content, "webp", quality=quality, lossless=quality == 100, method=4)
    else:
        options: dict[str, Any] = {} if dpi is None else {"dpi": (dpi, dpi)}
        # Without subsampling: thin coloured lines stay sharp.
        rgb_image(picture.rgba, (PAPER,) * 3).save(content, "jpeg", quality=quality, subsampling=0, **options)
    path.write_bytes(content.getvalue())


#: Least distance of pixels that a ratio of 32-bit numbers holds, in its unit.
MIN_STEP = 1e-8


def write_tiff(picture: Picture, path: Path, *, bits: int, dpi: float | None) -> None:
    """Write a TIFF file of whole numbers, RGB or, where something is transparent, RGBA; with the distance of pixels.

    ImageJ reads the distance from the tags of resolution, pixels per unit, and the unit from its own description.
    """
    import tifffile

    pixels = straight_bytes(picture.rgba) if bits == 8 else _straight_words(picture.rgba)
    is_opaque = bool((pixels[..., 3] == np.iinfo(pixels.dtype).max).all())
    options: dict[str, Any] = {} if is_opaque else {"extrasamples": ["unassalpha"]}
    step = _pixel_of_all(picture)
    if dpi is not None:
        options |= {"resolution": (dpi, dpi), "resolutionunit": "INCH"}
    elif step is not None and MIN_STEP < step < 1 / MIN_STEP:
        # Descriptions are in ASCII.
        named = f"unit={picture.unit}\n" if picture.unit and picture.unit.isascii() else ""
        options |= {"resolution": (1 / step, 1 / step), "resolutionunit": "NONE"}
        options["description"] = f"ImageJ={IMAGEJ}\n{named}"
    tifffile.imwrite(
        path,
        pixels[..., :3] if is_opaque else pixels,
        photometric="rgb",
        compression="zlib",
        metadata=None,
        software="wavesplat",
        **options,
    )


def _straight_words(rgba: NDArray[np.float32]) -> NDArray[np.uint16]:
    """Associated floats as 16-bit numbers of straight colour and opacity, rounded as in PNG files."""
    alpha = np.clip(rgba[..., 3:], 0, 1)
    color = np.clip(rgba[..., :3] / np.where(alpha > 0, alpha, np.inf), 0, 1)
    return np.floor(np.concatenate([color, alpha], axis=2) * 65535 + np.float32(0.5)).astype(np.uint16)


def _pixel_of_all(picture: Picture) -> float | None:
    """Distance of pixels, world units, where it is the same in all of the picture: not in perspective."""
    camera = picture.report.get("camera") or {}
    return None if camera.get("view_angle") is not None else picture.pixel


def write_exr(picture: Picture, path: Path) -> None:
    """Write an EXR file of floats, associated, and the depth as channel Z."""
    import OpenEXR

    channels: dict[str, NDArray[np.float32]] = {"RGBA": np.ascontiguousarray(picture.rgba)}
    if picture.depth is not None:
        channels["Z"] = np.ascontiguousarray(np.nan_to_num(picture.depth, nan=np.inf))
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    try:
        with OpenEXR.File(header, channels) as file:
            file.write(str(path))
    except (RuntimeError, ValueError) as error:
        raise OSError(str(error)) from error
