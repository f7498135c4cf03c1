"""Everything that Wavesplat raises on purpose, split by whose move is next.

Each message says what happened, where, and how to mend it; a path comes last.
"""

from __future__ import annotations

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


class WavesplatError(Exception):
    """Base of all errors of this package."""


class ArgumentError(WavesplatError, ValueError):
    """An argument has a value that cannot work: the caller's move."""


class FileError(WavesplatError, OSError):
    """A file is missing, unreadable, truncated, of an unknown kind, or cannot be written."""


class WavesplatWarning(UserWarning):
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


class CancelledError(WavesplatError):
    """The progress callback asked to stop; no picture was made."""
