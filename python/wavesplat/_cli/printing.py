"""What a command says: its result on stdout, messages on stderr."""

from __future__ import annotations

import sys
from typing import Any

__all__ = ["json_text", "message", "print_result"]


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
