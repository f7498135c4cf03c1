"""Values that users, documents and files give: whether one is a number, how large it may be, and errors where not.

A number is whatever Python takes for a float, except texts and switches: True in the place of a number is a slip.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, isfinite, ulp
from operator import index
from typing import Any

from wavesplat.errors import ArgumentError

#: Letters of a value in a message, at most; longer ones are named by their type.
MAX_LETTERS = 60


def described(value: object, *, lists: bool = False) -> str:
    """Text of a value for a message, or its type where that is long; `lists`: lists are written out too."""
    if (
        value is None
        or isinstance(value, str | int | float | complex | tuple | bytes)
        or (lists and isinstance(value, list))
    ):
        try:
            text = repr(value)
        except ValueError:  # whole numbers of more than 4300 digits
            text = "a number of very many digits"
        if len(text) <= MAX_LETTERS:
            return text
    return f"a {type(value).__name__}"


def float_of(value: Any) -> float | None:
    """A number as a float, which may be infinite or NaN; None for anything else."""
    if isinstance(value, str | bytes | bytearray | bool):
        return None
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        return None


def number(
    value: object,
    what: str,
    form: str = "a finite number",
    *,
    least: float = -inf,
    most: float = inf,
    finite: bool = True,
) -> float:
    """A number as a float, or an `ArgumentError` that says what was given, and what to give: the `form`.

    finite : False lets infinities and NaN pass, for callers that say more about them.
    """
    found = float_of(value)
    if found is None or (finite and not (isfinite(found) and least <= found <= most)):
        raise ArgumentError(f"{what} is {described(value)}; give {form}")
    return found


def positive(value: object, what: str, form: str = "a positive number") -> float:
    """A finite number above 0, or an `ArgumentError`."""
    return number(value, what, form, least=ulp(0.0))


def share(value: object, what: str, form: str = "a number 0..1") -> float:
    """A number from 0 to 1, or an `ArgumentError`."""
    return number(value, what, form, least=0.0, most=1.0)


def numbers(
    values: Iterable[Any],
    what: str,
    form: str = "finite numbers",
    *,
    n: int | None = None,
    least: float = -inf,
    most: float = inf,
    finite: bool = True,
) -> tuple[float, ...]:
    """Numbers as floats, `n` of them, or an `ArgumentError`; see `number`."""
    try:
        found = [float_of(value) for value in values]
    except TypeError:
        found = [None]
    right = [one for one in found if one is not None and (not finite or (isfinite(one) and least <= one <= most))]
    if len(right) != len(found) or n not in (None, len(right)):
        raise ArgumentError(f"{what} is {described(values, lists=True)}; give {form}")
    return tuple(right)


def whole(value: Any, what: str, form: str = "a whole number", *, least: float = -inf, most: float = inf) -> int:
    """A whole number as an int, or an `ArgumentError`."""
    try:
        found = None if isinstance(value, bool) else index(value)
    except TypeError:
        found = None
    if found is None or not least <= found <= most:
        raise ArgumentError(f"{what} is {described(value)}; give {form}")
    return found
