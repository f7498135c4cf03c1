"""JSON: texts as Python values, and objects of our formats, whose errors name the file and the field.

Transfer functions and materials are such texts; presets are files of them in a folder of the package.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from os import PathLike
from typing import Any, TypeVar

from wavesplat import _native
from wavesplat._storage.output import write_atomically
from wavesplat._storage.paths import read_text
from wavesplat.errors import ArgumentError

# JSON texts as Python values: the one entry for documents, states, patches and messages.


def decode(text: str | bytes, what: str) -> Any:
    """The value of a JSON text. `what`: such as "transfer function", which begins the messages.

    Raises
    ------
    ArgumentError
        If it is not JSON, or holds a value that cannot be used; the message names the field.
    """
    value = decode_syntax(text, what)
    _native.check_values(value, what)
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
