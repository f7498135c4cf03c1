"""What our JSON texts share: one object, with a version, whose errors name the file and the field."""

from __future__ import annotations

import json
from collections.abc import Callable, Collection
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from wavesplat.errors import ArgumentError, FileError

__all__ = ["check_fields", "load", "parse"]

T = TypeVar("T")


def load(path: str | PathLike[str], what: str, build: Callable[[str], T]) -> T:
    """What `build` makes of a file's text; its errors get the path. `what`: such as "transfer function"."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise FileError(f"cannot read the {what}: {error.strerror or error}; check the name: {path}") from None
    except UnicodeDecodeError:
        raise FileError(f"the {what} is not text; give a JSON file: {path}") from None
    try:
        return build(text)
    except ArgumentError as error:
        raise ArgumentError(f"{error}: {path}") from None


def parse(text: str, what: str, contents: str) -> dict[str, Any]:
    """The object of a JSON text. `contents`: what must be in it, for the message."""
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ArgumentError(f"{what}: not JSON: {error}") from None
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
    version = document.get("version", 1)
    if version != 1:
        raise ArgumentError(f"{what}: field 'version' is {version!r}; this release reads version 1")
    unknown = sorted(set(document) - set(known))
    if unknown:
        raise ArgumentError(f"{what}: unknown field {unknown[0]!r}; the fields are {', '.join(sorted(known))}")
