"""JSON objects of our formats: one object a text, with a version; errors name the file and the field.

Transfer functions and materials are such texts; presets are files of them in a folder of the package.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection
from os import PathLike
from typing import Any, TypeVar

from wavesplat._files import json_text
from wavesplat._files.output import write_atomically
from wavesplat._files.paths import read_text
from wavesplat._files.values import is_number
from wavesplat.errors import ArgumentError

__all__ = ["check_fields", "check_list", "compact", "load", "names_in", "optional_number", "parse", "save", "write"]

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
    document = json_text.decode(text, what)
    if not isinstance(document, dict):
        raise ArgumentError(f"{what}: the JSON text is not an object; it must be {{...}} with {contents}")
    return document


def check_fields(
    document: dict[str, Any], what: str, *, needed: Collection[str], known: Collection[str], hint: str
) -> None:
    """Refuse an object that lacks a field or has one too many. `hint`: where its form is described."""
    for name in needed:
        if name not in document:
            raise ArgumentError(f"{what}: field {name!r} is missing; see {hint} for the form")
    version = document.get("version", VERSION)
    if version != VERSION or type(version) is not int:
        raise ArgumentError(f"{what}: field 'version' is {version!r}; this release reads version {VERSION}")
    unknown = sorted(set(document) - set(known))
    if unknown:
        raise ArgumentError(f"{what}: unknown field {unknown[0]!r}; the fields are {', '.join(sorted(known))}")


def check_list(document: dict[str, Any], what: str, name: str, form: str) -> None:
    """Refuse a field that is no list. `form`: how the list is written, for the message."""
    if not isinstance(document.get(name, []), list):
        raise ArgumentError(f"{what}: field {name!r} is not a list; write {form}")


def optional_number(document: dict[str, Any], what: str, name: str) -> float | None:
    """The number in a field; None if it is null or not there."""
    number: Any = document.get(name)
    if number is not None and not is_number(number):
        raise ArgumentError(f"{what}: field {name!r} is {number!r}; it must be a number or null")
    return number


def names_in(folder: Any) -> list[str]:
    """Names of the JSON files in a folder of the package, without the suffix, in alphabetical order."""
    return sorted(entry.name.removesuffix(".json") for entry in folder.iterdir() if entry.name.endswith(".json"))
