"""Options that are declared once, as the fields of a dataclass, and taken together by commands.

A command has a parameter of the dataclass and the decorator `takes`: Typer then sees one option for each field in its place,
and the command gets them together.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import fields
from functools import wraps
from typing import Any, get_type_hints

__all__ = ["given", "takes"]


def takes(group: type[Any], parameter: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """A decorator that gives a command a group's options on the command line, in the place of one of its parameters."""

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        hints = get_type_hints(group, include_extras=True)
        options = [
            inspect.Parameter(
                field.name, inspect.Parameter.KEYWORD_ONLY, default=field.default, annotation=hints[field.name]
            )
            for field in fields(group)
        ]

        @wraps(command)
        def with_options(**arguments: Any) -> None:
            grouped = group(**{option.name: arguments.pop(option.name) for option in options})
            command(**arguments, **{parameter: grouped})

        parameters: list[inspect.Parameter] = []
        for one in inspect.signature(command, eval_str=True).parameters.values():
            parameters += options if one.name == parameter else [one]
        # Typer asks for both, depending on its release.
        with_options.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        with_options.__annotations__ = {one.name: one.annotation for one in parameters}
        return with_options

    return decorate


def given(group: object) -> list[str]:
    """The options of a group that were set, as they are written."""
    names = [field.name for field in fields(group) if getattr(group, field.name) != field.default]  # type: ignore[arg-type]
    return sorted("--" + name.replace("_", "-") for name in names)
