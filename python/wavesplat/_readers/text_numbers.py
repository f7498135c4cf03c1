"""Numbers that a file holds as text, separated by white space."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from wavesplat.errors import FileError

__all__ = ["numbers_of_text"]


def numbers_of_text(file: IO[bytes], n: int, path: Path) -> NDArray[np.float64]:
    """The next `n` numbers of an open file, which is then behind them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # a word that is no number: fewer are returned
        numbers = np.fromfile(file, np.float64, n, sep=" ")
    if len(numbers) != n:
        raise FileError(
            f"truncated, or with a word that is no number: {n} numbers are promised, {len(numbers)} are there; "
            f"copy or export it again: {path}"
        )
    return numbers
