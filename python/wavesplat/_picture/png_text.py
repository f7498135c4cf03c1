"""Texts in PNG files: chunks of the kind iTXt, UTF-8, compressed (PNG, third edition, 11.3.3.4).

A long text is cut into several chunks of one keyword: Pillow opens no file with a chunk of more than 1 MiB of text.
"""

from __future__ import annotations

import struct
import zlib

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
