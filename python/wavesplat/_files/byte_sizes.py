"""Amounts of memory as people write them: 512 MB, 1.5 GiB, or a number of bytes."""

from __future__ import annotations

import math
import re

from wavesplat.errors import ArgumentError

UNITS = {"b": 1, "kb": 10**3, "mb": 10**6, "gb": 10**9, "tb": 10**12, "kib": 1 << 10, "mib": 1 << 20, "gib": 1 << 30}
UNITS |= {"": 1, "k": 10**3, "m": 10**6, "g": 10**9, "t": 10**12, "tib": 1 << 40}
#: Bound of amounts: more than any machine addresses.
MAX_BYTES = 1 << 63
AMOUNT = re.compile(r"\s*((?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?:e[0-9]+)?)\s*([a-z]*)\s*", re.IGNORECASE)


def bytes_of(given: float | str, what: str = "memory") -> int:
    """Bytes, from a number of them or a text such as "2 GB"; decimal units, and binary ones with an i.

    what : name of the argument in messages.
    """
    if isinstance(given, str):
        found = AMOUNT.fullmatch(given)
        factor = UNITS.get(found[2].lower()) if found else None
        number = float(found[1]) * factor if found and factor else math.nan
    else:
        try:
            number = float(given)
        except (TypeError, ValueError, OverflowError):
            number = math.nan
    if not 1 <= number < MAX_BYTES:
        raise ArgumentError(
            f'{what} is {_named(given)}; give an amount such as "2 GB" or "512 MiB", or a number of bytes'
        )
    return int(number)


def _named(given: object) -> str:
    """A value in a message, or its type where it is long; Python writes no whole numbers of more than 4300 digits."""
    is_long = isinstance(given, int) and abs(given) > MAX_BYTES**2
    return f"a {type(given).__name__}" if is_long or len(repr(given)) > 60 else repr(given)


def byte_size(n_bytes: float) -> str:
    """A number of bytes as text, in decimal units."""
    for factor, unit in ((10**12, "TB"), (10**9, "GB"), (10**6, "MB"), (10**3, "kB")):
        if n_bytes >= factor:
            return f"{n_bytes / factor:.3g} {unit}"
    return f"{n_bytes:.0f} bytes"
