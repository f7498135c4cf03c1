"""Everything that Wavesplat raises on purpose, split by whose move is next.

Each message says what happened, where, and how to mend it; a path comes last.
"""

from __future__ import annotations

import unicodedata

__all__ = [
    "ArgumentError",
    "CancelledError",
    "FileError",
    "FileWarning",
    "LibraryError",
    "LimitError",
    "WavesplatError",
    "WavesplatWarning",
]


#: Letters of the beginning and of the end of a message; what is between, a value of a file as a rule, is left out.
HALF_LETTERS = 2000


class _OneLine:
    """A message in one line of letters that are seen: others, which files may hold, are escaped.

    A name in a file could else clear the terminal that the error is shown on, or write a line of its own there.
    """

    def __str__(self) -> str:
        text = super().__str__()
        text = text if text.isprintable() else "".join(map(_seen, text))
        return text if len(text) <= 2 * HALF_LETTERS else f"{text[:HALF_LETTERS]} ... {text[-HALF_LETTERS:]}"


def _seen(letter: str) -> str:
    """The letter, or its number where it is no sign or would not be seen as one. Blanks of all widths are seen."""
    return letter if letter.isprintable() or unicodedata.category(letter) == "Zs" else ascii(letter)[1:-1]


class WavesplatError(_OneLine, Exception):
    """Base of all errors of this package."""


class ArgumentError(WavesplatError, ValueError):
    """An argument has a value that cannot work: the caller's move."""


class FileError(WavesplatError, OSError):
    """A file is missing, unreadable, truncated, of an unknown kind, or cannot be written."""


class WavesplatWarning(_OneLine, UserWarning):
    """The work was done, but perhaps not what was meant: a preset for other units, say."""


class FileWarning(WavesplatWarning):
    """A file was read although a part of it is missing or damaged; the message names and counts it.

    Not an error, since the rest is worth a look; `warnings.simplefilter("error", wavesplat.errors.FileWarning)` makes
    it one.
    """


class LibraryError(WavesplatError, ImportError):
    """A library that only this task needs is not installed; the message says how to install it."""


class LimitError(WavesplatError):
    """The work is right but too big for this machine or for the format."""


class ClusterError(WavesplatError):
    """The workers of a cluster were lost, and no others have come: the work can be done again with new ones."""


class CancelledError(WavesplatError):
    """The progress callback asked to stop; no picture was made."""
