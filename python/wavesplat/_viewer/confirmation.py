"""Confirmation of a page's changes: the state after them, and where it differs from what the page has.

A page shows its changes before they are confirmed. The session completes and checks what a page sends, so the state
that it takes may differ from the page's; the differences go back with the confirmation. `web/src/state/replica.ts` does
the same for the page. Fields that differ are sent whole, so a page that makes its own changes and then these has the
session's document, whatever was completed or corrected.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from wavesplat._viewer.patches import patched
from wavesplat._viewer.state import ViewerState, is_same


def confirmed(state: ViewerState, operations: Sequence[Any]) -> tuple[ViewerState, list[dict[str, Any]]]:
    """The state after a page's changes, and the operations that turn the page's document into its document.

    Raises
    ------
    ArgumentError
        If the changes cannot be made; the message names the field.
    """
    if not operations:
        return state, []
    of_page = patched(state.document, operations)
    after = state.replaced(of_page)
    return after, [
        {"op": "add", "path": f"/{name}", "value": value}
        for name, value in after.document.items()
        if not is_same(value, of_page[name])
    ]
