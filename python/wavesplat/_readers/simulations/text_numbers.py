"""Files of numbers as text, separated by white space; they may be packed by gzip."""

from __future__ import annotations

import gzip
import os
import re
import tempfile
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from wavesplat._system.memory import check_room
from wavesplat.errors import FileError

GZIP = b"\x1f\x8b"
#: Bytes that are unpacked, or looked through, at once.
PIECE_BYTES = 1 << 24
#: An exponent of Fortran: of three digits without a letter (1.234-100), or with a D.
EXPONENT = re.compile(rb"(?<=[\d.])(?:[Dd]([-+]?\d{1,3})|([-+]\d{3}))(?![\d.])")
#: Letters that only such numbers have behind a digit.
SIGNS = b"+-Dd"


@contextmanager
def opened_text(path: Path) -> Iterator[IO[bytes]]:
    """The file, or a temporary one of what is packed in it."""
    with path.open("rb") as file:
        is_packed = file.read(len(GZIP)) == GZIP
        file.seek(0)
        if not is_packed:
            yield file
            return
        with tempfile.TemporaryFile() as unpacked:
            n = 0
            try:
                with gzip.open(file) as packed:
                    while piece := packed.read(PIECE_BYTES):
                        n += len(piece)
                        check_room(n, f"what is packed in {path.name}", "unpack it, and crop it")
                        unpacked.write(piece)
            except (EOFError, gzip.BadGzipFile, zlib.error) as error:
                raise FileError(f"truncated or damaged, as gzip finds ({error}); copy it again: {path}") from None
            unpacked.seek(0)
            yield unpacked


def n_bytes_of(file: IO[bytes]) -> int:
    """The length of an open file."""
    file.flush()
    return os.fstat(file.fileno()).st_size


def numbers_of_text(file: IO[bytes], n: int, path: Path) -> NDArray[np.float64]:
    """The next `n` numbers of an open file, which is then behind them."""
    begin = file.tell()
    with warnings.catch_warnings():
        # A word that is no number: NumPy 2.3 and later raise an error, older ones return fewer.
        warnings.simplefilter("ignore", DeprecationWarning)
        try:
            numbers = np.fromfile(file, np.float64, n, sep=" ")
        except ValueError:
            numbers = np.empty(0)
    # NumPy takes 1.234-100 for two numbers.
    if len(numbers) != n or _has_fortran(file, begin, file.tell()):
        file.seek(begin)
        numbers = _numbers_of_fortran(file, n)
    if len(numbers) != n:
        raise FileError(
            f"truncated, or with a word that is no number: {n} numbers are promised, {len(numbers)} are there; "
            f"copy or export it again: {path}"
        )
    return numbers


def _has_fortran(file: IO[bytes], begin: int, end: int) -> bool:
    """Whether numbers between two places have exponents that NumPy does not know."""
    file.seek(begin)
    before, left, found = b"", end - begin, False
    while not found and left > 0 and (piece := file.read(min(PIECE_BYTES, left))):
        letters = np.frombuffer(before + piece, np.uint8)
        behind = letters[:-1][np.isin(letters[1:], np.frombuffer(SIGNS, np.uint8))]
        found = bool(np.isin(behind, np.frombuffer(b"0123456789.", np.uint8)).any())
        before, left = piece[-1:], left - len(piece)
    file.seek(end)
    return found


def _numbers_of_fortran(file: IO[bytes], n: int) -> NDArray[np.float64]:
    """The next numbers of a file, at most `n`, up to a line with a word that is none."""
    numbers, begin, n_found = np.empty(n), file.tell(), 0
    for line in iter(file.readline, b""):
        words = EXPONENT.sub(lambda at: b"E" + (at[1] or at[2]), line).split()
        try:
            values = [float(word) for word in words]
        except ValueError:
            break
        if n_found + len(values) > n:
            break
        numbers[n_found : n_found + len(values)] = values
        n_found, begin = n_found + len(values), begin + len(line)
        if n_found == n:
            break
    file.seek(begin)
    return numbers[:n_found]
