"""The mark of what is public: its name begins at the package, wherever it is defined."""

from __future__ import annotations

from typing import TypeVar

__all__ = ["public"]

T = TypeVar("T")


def public(thing: T) -> T:
    """The class or function, as one of `wavesplat` itself.

    So `repr` and `help` show the name to import it by, and pickles hold that name and survive when a private module
    moves.
    """
    thing.__module__ = "wavesplat"
    return thing
