"""Messages of the viewer's protocol as bytes, and frames as files: JPEG while something moves, PNG at rest.

`web/src/engine/framing.ts` is the twin. In the widget header and payload are content and buffer of a comm message.
"""

from __future__ import annotations

import io
import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wavesplat._picture import picture_files
from wavesplat._storage import json_texts
from wavesplat.errors import ArgumentError

PROTOCOL = 1
#: Largest message to the server, bytes: a state with a large table of colours, or a file of one.
MAX_BYTES = 1 << 20
LENGTH = struct.Struct("<I")


def packed(header: dict[str, Any], payload: bytes = b"") -> bytes:
    """A message as bytes."""
    text = json.dumps(header, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode()
    return LENGTH.pack(len(text)) + text + payload


def unpacked(message: bytes) -> tuple[dict[str, Any], bytes]:
    """The header and the payload of a message.

    Raises
    ------
    ArgumentError
        If the bytes are no message.
    """
    if len(message) < LENGTH.size:
        raise ArgumentError(f"message: {len(message)} bytes are less than the length of a header")
    (length,) = LENGTH.unpack_from(message)
    if length > len(message) - LENGTH.size:
        raise ArgumentError(f"message: the header has {length} bytes, and {len(message) - LENGTH.size} came")
    header = json_texts.decode_syntax(message[LENGTH.size : LENGTH.size + length], "message: the header")
    if not isinstance(header, dict):
        raise ArgumentError("message: the header must be an object")
    return header, message[LENGTH.size + length :]


# Frames as files: JPEG while something moves, PNG, exact, at rest.

#: Colour behind transparent pixels in a format without transparency.
PAPER = (0.0, 0.0, 0.0)


def jpeg_bytes(rgba: NDArray[np.float32], quality: int, *, subsampled: bool) -> bytes:
    """A picture as a JPEG file. `subsampled`: colours at half the resolution (4:2:0), which suits slow lines."""
    content = io.BytesIO()
    image = picture_files.rgb_image(rgba, PAPER)
    image.save(content, "jpeg", quality=quality, subsampling=2 if subsampled else 0)
    return content.getvalue()


def png_bytes(rgba: NDArray[np.float32]) -> bytes:
    """A picture as a PNG file, with the pixels of `Picture.save`, 8 bits."""
    return picture_files.png_bytes(rgba, 8)
