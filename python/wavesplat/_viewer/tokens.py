"""Tokens of links, each good once, and keys of the pages that came with one.

Both have 256 random bits. Nobody guesses one, so wrong ones are refused and not counted: a count would let any program
of this machine keep the right page out.
"""

from __future__ import annotations

import hmac
import secrets

__all__ = ["Tokens"]

#: Largest number of tokens, and of keys, that are remembered.
MAX_KEYS = 64


class Tokens:
    """Tokens that were given out, and keys."""

    def __init__(self) -> None:
        self._tokens: list[str] = []
        self._keys: list[str] = []

    def new(self) -> str:
        """A token for one page."""
        token = secrets.token_urlsafe(32)
        self._tokens = [*self._tokens, token][-MAX_KEYS:]
        return token

    def key_for(self, token: object, key: object) -> str | None:
        """The key for a page with a valid token, which is used up, or with a valid key; None if neither is valid."""
        if isinstance(key, str) and _is_in(key, self._keys):
            return key
        if isinstance(token, str) and _is_in(token, self._tokens):
            self._tokens = [one for one in self._tokens if not hmac.compare_digest(one, token)]
            made = secrets.token_urlsafe(32)
            self._keys = [*self._keys, made][-MAX_KEYS:]
            return made
        return None


def _is_in(text: str, known: list[str]) -> bool:
    # All are compared, so that the time reveals nothing.
    data = text.encode("utf-8", "replace")
    return sum(hmac.compare_digest(one.encode(), data) for one in known) > 0
