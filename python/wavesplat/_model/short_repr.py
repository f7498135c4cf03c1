"""A thing as the call that makes it, without what is usual."""

from __future__ import annotations

from inspect import signature
from typing import Any

__all__ = ["short_repr"]


def short_repr(thing: Any) -> str:
    """`Facts(unit='mm')`: those of a type's arguments, kept under their names, that are not their defaults."""
    arguments = signature(type(thing)).parameters
    given = [
        f"{name}={value!r}"
        for name, argument in arguments.items()
        if (value := getattr(thing, name)) != argument.default
    ]
    return f"{type(thing).__name__}({', '.join(given)})"
