"""JSON Patch (RFC 6902), the part that the viewer needs: add, replace, remove. `web/src/state/patch.ts` is the twin.

Nothing is changed in place: what a patch does not touch is shared by the documents before and after.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wavesplat._storage import json_texts
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

#: Largest number of steps of a path: the deepest field of a state has seven.
MAX_STEPS = 16


def patched(document: Any, operations: Any) -> Any:
    """The document with all operations done, in their order.

    Raises
    ------
    ArgumentError
        If an operation is invalid, or its path leads nowhere; the message names both.
    """
    if not isinstance(operations, list | tuple):
        raise ArgumentError(f"patch: the operations are {described(operations)}; give a list of objects")
    for number, operation in enumerate(operations):
        what = f"patch: operations[{number}]"
        if not isinstance(operation, Mapping):
            raise ArgumentError(f"{what} is {described(operation)}; it must be an object")
        kind, path = operation.get("op"), operation.get("path")
        if kind not in ("add", "replace", "remove"):
            raise ArgumentError(f"{what}: field 'op' is {described(kind)}; use add, replace or remove")
        unknown = set(operation) - {"op", "path", "value"}
        if unknown:
            raise ArgumentError(f"{what}: unknown field {min(unknown)!r}; the fields are op, path and value")
        if kind != "remove" and "value" not in operation:
            raise ArgumentError(f"{what}: field 'value' is missing")
        json_texts.check_values(operation, f"{what}: {described(path)}")
        document = _done(document, kind, _steps(path, what), operation.get("value"), f"{what}: {path!r}")
    return document


def _steps(path: Any, what: str) -> list[str]:
    if not isinstance(path, str) or (path and not path.startswith("/")):
        raise ArgumentError(f"{what}: field 'path' is {described(path)}; it must be '' or begin with '/'")
    steps = [step.replace("~1", "/").replace("~0", "~") for step in path.split("/")[1:]]
    if len(steps) > MAX_STEPS:
        raise ArgumentError(f"{what}: field 'path' has {len(steps)} steps; {MAX_STEPS} is the most")
    return steps


def _done(inside: Any, kind: str, steps: list[str], value: Any, what: str) -> Any:
    if not steps:
        if kind == "remove":
            raise ArgumentError(f"{what}: the whole document cannot be removed")
        return value
    step, *rest = steps
    if isinstance(inside, Mapping):
        if (rest or kind != "add") and step not in inside:
            raise ArgumentError(f"{what}: there is no field {step!r}")
        changed = dict(inside)
        if rest:
            changed[step] = _done(inside[step], kind, rest, value, what)
        elif kind == "remove":
            del changed[step]
        else:
            changed[step] = value
        return changed
    if isinstance(inside, list | tuple):
        return _done_in_list(list(inside), kind, step, rest, value=value, what=what)
    raise ArgumentError(f"{what}: before {step!r} stands {described(inside)}, which has no fields")


def _done_in_list(items: list[Any], kind: str, step: str, rest: list[str], *, value: Any, what: str) -> list[Any]:
    if step == "-" and kind == "add" and not rest:
        return [*items, value]
    # As the standard has it: no sign, no zeros in front.
    if not (step.isascii() and step.isdigit()) or (len(step) > 1 and step[0] == "0") or len(step) > 9:
        raise ArgumentError(f"{what}: {step!r} is no place in a list")
    place = int(step)
    if place > len(items) or (place == len(items) and (rest or kind != "add")):
        raise ArgumentError(f"{what}: the list has {len(items)} items, so there is none at {place}")
    if rest:
        items[place] = _done(items[place], kind, rest, value, what)
    elif kind == "add":
        items.insert(place, value)
    elif kind == "remove":
        del items[place]
    else:
        items[place] = value
    return items
