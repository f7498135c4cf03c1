"""Who may speak to the viewer's server: tokens of links, each good once, and keys of pages that came with one."""

from __future__ import annotations

import hmac
import secrets
import time
from collections.abc import Callable

__all__ = ["Tokens"]

#: Wrong ones after which nobody is let in for a while, and how long that is, in seconds.
MOST_WRONG, CLOSED_S = 5, 60.0
#: Keys that are remembered.
MOST_KEYS = 64


class Tokens:
    """Tokens that were given out, and keys."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._tokens: list[str] = []
        self._keys: list[str] = []
        self._now = now
        self._n_wrong, self._closed_until = 0, 0.0

    def new(self) -> str:
        """A token for one page."""
        token = secrets.token_urlsafe(32)
        self._tokens = [*self._tokens, token][-MOST_KEYS:]
        return token

    def key_for(self, token: object, key: object) -> str | None:
        """The key of the page that shows a token, which is used up, or the key that it has; None: neither is right."""
        if self._now() < self._closed_until:
            return None
        if isinstance(key, str) and _is_in(key, self._keys):
            return key
        if isinstance(token, str) and _is_in(token, self._tokens):
            self._tokens = [one for one in self._tokens if not hmac.compare_digest(one, token)]
            made = secrets.token_urlsafe(32)
            self._keys = [*self._keys, made][-MOST_KEYS:]
            self._n_wrong = 0
            return made
        self._n_wrong += 1
        if self._n_wrong >= MOST_WRONG:
            self._n_wrong, self._closed_until = 0, self._now() + CLOSED_S
        return None


def _is_in(text: str, known: list[str]) -> bool:
    # All are compared, so that the time tells nothing.
    data = text.encode("utf-8", "replace")
    return sum(hmac.compare_digest(one.encode(), data) for one in known) > 0
