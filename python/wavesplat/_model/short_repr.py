"""Representation of an object as the call that makes it, without default arguments."""

from __future__ import annotations

from inspect import signature
from typing import Any


def short_repr(thing: Any) -> str:
    """`Facts(unit='mm')`: the arguments that differ from their defaults, read from the attributes of their names."""
    arguments = signature(type(thing)).parameters
    given = [
        f"{name}={value!r}"
        for name, argument in arguments.items()
        if (value := getattr(thing, name)) != argument.default
    ]
    return f"{type(thing).__name__}({', '.join(given)})"
