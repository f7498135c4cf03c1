"""JSON texts as Python values: the one entry for documents, states, patches and messages.

JSON bounds neither its whole numbers nor its texts: `json` gives numbers that no float holds, and halves of surrogate
pairs, which no file and no font takes. Both are refused here, with the field, before anything calculates with them.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from wavesplat.errors import ArgumentError

__all__ = ["check_values", "decode", "decode_syntax", "is_text"]

#: The largest whole number of a document: the largest float64.
MAX_WHOLE = int(1.7976931348623157e308)
#: Letters of a path that fit in a message.
MAX_PATH = 100


def decode(text: str | bytes, what: str) -> Any:
    """The value of a JSON text. `what`: such as "transfer function", which begins the messages.

    Raises
    ------
    ArgumentError
        If it is not JSON, or holds a value that cannot be used; the message names the field.
    """
    value = decode_syntax(text, what)
    check_values(value, what)
    return value


def decode_syntax(text: str | bytes, what: str) -> Any:
    """The value of a JSON text, unchecked: for messages whose parts are checked where they are used.

    Raises
    ------
    ArgumentError
        If it is not JSON.
    """
    try:
        # Editors of Windows begin texts with a byte-order mark, which `json` takes of bytes only.
        return json.loads(text.removeprefix("\ufeff") if isinstance(text, str) else text)
    except (ValueError, RecursionError) as error:
        raise ArgumentError(f"{what}: not JSON: {_reason(error)}") from None


def check_values(value: Any, what: str) -> None:
    """Refuse a document that has whole numbers beyond float64 or texts with half a surrogate pair.

    Raises
    ------
    ArgumentError
        If it has one; the message names the field.
    """
    # A stack instead of recursion: documents may be nested deeper than Python's recursion limit.
    pending: list[tuple[Any, tuple[Any, ...]]] = [(value, ())]
    while pending:
        found, steps = pending.pop()
        if isinstance(found, str):
            if not is_text(found):
                raise ArgumentError(f"{what}: {_place(steps)} has half of a surrogate pair in its text; remove it")
        elif isinstance(found, int):
            if not -MAX_WHOLE <= found <= MAX_WHOLE:
                raise ArgumentError(
                    f"{what}: {_place(steps)} is a whole number of more than 308 digits; write a smaller one"
                )
        elif isinstance(found, Mapping):
            for name, part in found.items():
                if isinstance(name, str) and not is_text(name):
                    raise ArgumentError(f"{what}: {_place(steps)} has half of a surrogate pair in a name; remove it")
                pending.append((part, (steps, name)))
        elif isinstance(found, list | tuple):
            pending.extend((part, (steps, number)) for number, part in enumerate(found))


def is_text(text: str) -> bool:
    """Whether a text can be written: it has no half of a surrogate pair."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _reason(error: ValueError | RecursionError) -> str:
    """Reason of a decoding error; Python's own, for very long whole numbers, would advise to change its settings."""
    if isinstance(error, json.JSONDecodeError | UnicodeDecodeError | RecursionError):
        return str(error)
    return "a whole number has more than 4300 digits"


def _place(steps: tuple[Any, ...]) -> str:
    """A field as a path, such as field 'layers[0].name'."""
    names = []
    while steps:
        steps, name = steps
        names.append(f"[{name}]" if isinstance(name, int) else f".{name}")
    path = "".join(reversed(names)).removeprefix(".")
    if not path:
        return "the document"
    return f"field {path!r}" if len(path) <= MAX_PATH else f"a field below {path[:MAX_PATH]!r}"
