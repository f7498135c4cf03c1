"""Checks of the fields of documents, whose errors name the field."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from wavesplat._model.argument_types import described
from wavesplat.errors import ArgumentError

T = TypeVar("T")


def check_fields(thing: Any, what: str, *, needed: Any, known: Any) -> None:
    if not isinstance(thing, dict):
        raise ArgumentError(f"{what} is {described(thing)}; it must be an object")
    for name in needed:
        if name not in thing:
            raise ArgumentError(f"{what}: field {name!r} is missing")
    unknown = sorted(set(thing) - set(known))
    if unknown:
        raise ArgumentError(f"{what}: unknown field {unknown[0]!r}; the fields are {', '.join(sorted(known))}")


def list_in(document: dict[str, Any], name: str, what: str) -> list[Any]:
    found = document.get(name, [])
    if not isinstance(found, list):
        raise ArgumentError(f"{what}: field {name!r} is {described(found)}; it must be a list")
    return found


def made_at(what: str, make: Callable[[], T]) -> T:
    """The result of `make`; its errors get the place in the document."""
    try:
        return make()
    except TypeError as error:
        raise ArgumentError(f"{what}: {error}") from None
    except ArgumentError as error:
        raise ArgumentError(f"{what}: {error}") from None
