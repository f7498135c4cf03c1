"""Tokens of links, each good once, and keys of the pages that came with one.

Both have 256 random bits. Nobody guesses one, so wrong ones are refused and not counted: a count would let any program
of this machine keep the right page out.
"""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Iterable

#: Largest number of tokens, and of keys of pages that have gone, that are remembered.
MAX_KEYS = 64


class Tokens:
    """Tokens that were given out, and keys."""

    def __init__(self) -> None:
        self._tokens: list[str] = []
        #: Keys, and how many connections have each: those that were left longest ago come first.
        self._keys: dict[str, int] = {}

    def new(self) -> str:
        """A token for one page."""
        token = secrets.token_urlsafe(32)
        self._tokens = [*self._tokens, token][-MAX_KEYS:]
        return token

    def key_for(self, token: object, key: object) -> str | None:
        """The key for a page with a valid token, which is used up, or with a valid key; None if neither is valid.

        Call `leave` with the key when the page's connection ends.
        """
        if isinstance(key, str) and _is_in(key, self._keys):
            self._keys[key] += 1
            return key
        if isinstance(token, str) and _is_in(token, self._tokens):
            self._tokens = [one for one in self._tokens if not hmac.compare_digest(one, token)]
            made = secrets.token_urlsafe(32)
            self._keys[made] = 1
            return made
        return None

    def leave(self, key: str) -> None:
        """End a connection of a page, which may come again; keys of pages that are here are never forgotten."""
        self._keys[key] = self._keys.pop(key) - 1
        gone = [one for one, n_connections in self._keys.items() if n_connections == 0]
        for one in gone[:-MAX_KEYS]:
            del self._keys[one]


def _is_in(text: str, known: Iterable[str]) -> bool:
    # All are compared, so that the time reveals nothing.
    data = text.encode("utf-8", "replace")
    return sum(hmac.compare_digest(one.encode(), data) for one in known) > 0
