"""What a command says: its result on stdout, messages on stderr."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from wavesplat.errors import WavesplatWarning

__all__ = ["json_text", "message", "print_result", "warnings_as_notes"]


def print_result(facts: dict[str, Any], text: object, *, as_json: bool) -> None:
    """Print the facts as JSON, or the text that people read."""
    print(json_text(facts) if as_json else text)


def json_text(facts: dict[str, Any]) -> str:
    """Facts as JSON."""
    import json

    return json.dumps(facts, indent=2, allow_nan=False, default=float)


def message(text: str) -> None:
    """A line on stderr."""
    print(f"wavesplat: {text}", file=sys.stderr)


@contextmanager
def warnings_as_notes(*, quiet: bool = False) -> Iterator[None]:
    """What is warned of inside becomes a note on stderr each, or nothing if `quiet`."""
    import warnings

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", WavesplatWarning)
        yield
    for warning in caught:
        if quiet and issubclass(warning.category, WavesplatWarning):
            continue
        message(f"note: {warning.message}")
