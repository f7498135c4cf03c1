"""Texts in PNG files: chunks of the kind iTXt, UTF-8, compressed (PNG, third edition, 11.3.3.4)."""

from __future__ import annotations

import struct
import zlib

__all__ = ["KEYWORD", "SIGNATURE", "text_in", "with_text"]

SIGNATURE = b"\x89PNG\r\n\x1a\n"
#: The keyword of the scene.
KEYWORD = "wavesplat"
#: Length of the signature and the first chunk, after which others may stand.
HEADER = len(SIGNATURE) + 25
#: Largest text, bytes.
MAX_TEXT = 1 << 26


def with_text(content: bytes, keyword: str, text: str) -> bytes:
    """The content of a PNG file with a text in it."""
    data = zlib.compress(text.encode(), 9)
    body = b"iTXt" + keyword.encode("latin-1") + b"\0\1\0\0\0" + data
    chunk = struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))
    return content[:HEADER] + chunk + content[HEADER:]


def text_in(content: bytes, keyword: str) -> str | None:
    """The text with a keyword; None where there is none.

    Raises
    ------
    ValueError
        If the file is damaged.
    """
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
        return _inflated(data).decode() if is_compressed else data.decode()
    return None


def _inflated(data: bytes) -> bytes:
    inflater = zlib.decompressobj()
    try:
        text = inflater.decompress(data, MAX_TEXT)
    except zlib.error as error:
        raise ValueError(f"its text is damaged: {error}") from None
    if inflater.unconsumed_tail or not inflater.eof:
        raise ValueError("its text is damaged, or larger than any that wavesplat writes")
    return text
