"""Decorator of public names: their module is the package, wherever they are defined."""

from __future__ import annotations

from typing import TypeVar

T = TypeVar("T")


def public(thing: T) -> T:
    """The class or function, with `wavesplat` as its module.

    So `repr` and `help` show the name to import it by, and pickles hold that name and survive when a private module
    moves.
    """
    thing.__module__ = "wavesplat"
    return thing
