"""JSON: texts as Python values, and objects of our formats, whose errors name the file and the field.

Transfer functions and materials are such texts; presets are files of them in a folder of the package.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any, TypeVar

from wavesplat._storage.output import write_atomically
from wavesplat._storage.paths import read_text
from wavesplat.errors import ArgumentError

# JSON texts as Python values: the one entry for documents, states, patches and messages.
#
# JSON bounds neither its whole numbers nor its texts: `json` gives numbers that no float holds, and halves of surrogate
# pairs, which no file and no font takes. Both are refused here, with the field, before anything calculates with them.

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


# JSON objects of our formats: one object a text, with a version; errors name the file and the field.

T = TypeVar("T")

VERSION = 1
#: Letters of a line that can be read at a glance.
LINE = 100


def write(fields: dict[str, Any]) -> str:
    """JSON text of an object with these fields and the version; numbers read back exactly."""
    return compact({"version": VERSION, **fields}) + "\n"


def compact(value: Any, indent: str = "") -> str:
    """JSON text for people to read and edit: a value that fits into a line, such as a node of a curve, is one line."""
    line = json.dumps(value, ensure_ascii=False)
    if not isinstance(value, dict | list | tuple) or not value or len(indent) + len(line) <= LINE:
        return line
    inner = indent + "  "
    if isinstance(value, dict):
        parts = [f"{json.dumps(key, ensure_ascii=False)}: {compact(part, inner)}" for key, part in value.items()]
    else:
        parts = [compact(part, inner) for part in value]
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    return f"{opening}\n{inner}" + f",\n{inner}".join(parts) + f"\n{indent}{closing}"


def save(path: str | PathLike[str], text: str) -> None:
    """Write a JSON text to a file, or raise a `FileError` and leave nothing behind."""
    write_atomically(path, lambda part: part.write_text(text, encoding="utf-8"))


def load(path: str | PathLike[str], what: str, build: Callable[[str], T]) -> T:
    """The object that `build` makes of a file's text; errors get the path. `what`: such as "transfer function"."""
    text = read_text(path, what)
    try:
        return build(text)
    except ArgumentError as error:
        raise ArgumentError(f"{error}: {path}") from None


def parse(text: str, what: str, contents: str) -> dict[str, Any]:
    """The object of a JSON text. `contents`: what must be in it, for the message."""
    document = decode(text, what)
    if not isinstance(document, dict):
        raise ArgumentError(f"{what}: the JSON text is not an object; it must be {{...}} with {contents}")
    return document


def names_in(folder: Any) -> list[str]:
    """Names of the JSON files in a folder of the package, without the suffix, in alphabetical order."""
    return sorted(entry.name.removesuffix(".json") for entry in folder.iterdir() if entry.name.endswith(".json"))
