"""Pictures as files: PNG, JPEG, WebP, TIFF and OpenEXR.

Floats go to files as they are; bytes come from `straight_bytes`, which rounds as the PNG encoder does.
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
from wavesplat._model.private_names import without_folders
from wavesplat._model.sources import beside
from wavesplat._picture.png_text import KEYWORD, with_text

if TYPE_CHECKING:
    from wavesplat._picture.picture import Picture

__all__ = [
    "image",
    "png_bytes",
    "rgb_image",
    "straight_bytes",
    "with_scene",
    "write_bytes_of",
    "write_exr",
    "write_tiff",
]

#: Grey behind transparent pixels in formats without transparency.
PAPER = 1.0
METRES_PER_INCH = 0.0254


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
    document = without_folders(scene) if folder is None else beside(scene, folder)
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"))
    return with_text(content, KEYWORD, text)


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


def write_tiff(picture: Picture, path: Path, *, dpi: float | None) -> None:
    """Write a TIFF file of floats, associated."""
    import tifffile

    options: dict[str, Any] = {} if dpi is None else {"resolution": (dpi, dpi), "resolutionunit": "INCH"}
    tifffile.imwrite(
        path,
        picture.rgba,
        photometric="rgb",
        extrasamples=["assocalpha"],
        compression="zlib",
        metadata=None,
        **options,
    )


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
