"""Groups of options that several commands share: the fields of a dataclass, passed as one value."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import fields
from functools import wraps
from typing import Any, get_type_hints

__all__ = ["given", "with_options_of"]


def with_options_of(
    group: Any, name: str, command: Callable[..., None], without: Sequence[str] = ()
) -> Callable[..., None]:
    """The command with an option for each field of the dataclass `group`, in the place of its parameter `name`.

    without : fields for which the command has no option, or one of its own.
    """
    hints = get_type_hints(group, include_extras=True)
    options = [
        inspect.Parameter(
            field.name, inspect.Parameter.KEYWORD_ONLY, default=field.default, annotation=hints[field.name]
        )
        for field in fields(group)
        if field.name not in without
    ]

    @wraps(command)
    def with_options(**given: Any) -> None:
        together = group(**{option.name: given.pop(option.name) for option in options})
        command(**given, **{name: together})

    parameters: list[inspect.Parameter] = []
    for parameter in inspect.signature(command, eval_str=True).parameters.values():
        parameters += options if parameter.name == name else [parameter]
    # Typer reads one or the other, depending on its release.
    with_options.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    with_options.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return with_options


def given(group: Any) -> list[str]:
    """Names of a group's options that were set, as they are written on the command line."""
    names = [field.name for field in fields(group) if getattr(group, field.name) != field.default]
    return sorted("--" + name.replace("_", "-") for name in names)
