"""Messages of the viewer's protocol as bytes: the header's length (u32, little-endian), the header (JSON), payload.

`web/src/engine/framing.ts` is the twin. In the widget header and payload are content and buffer of a comm message.
"""

from __future__ import annotations

import json
import struct
from typing import Any

from wavesplat._files import json_text
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
    header = json_text.decode_syntax(message[LENGTH.size : LENGTH.size + length], "message: the header")
    if not isinstance(header, dict):
        raise ArgumentError("message: the header must be an object")
    return header, message[LENGTH.size + length :]
