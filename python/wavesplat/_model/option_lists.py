"""Options that several functions take, each list written once.

A list is a `TypedDict` whose docstring documents its keys, and a dataclass with the same fields and their defaults. A
function takes one as ``**options: Unpack[RenderOptions]``, which type checkers and editors understand; `takes_options`
gives the function the whole signature and documentation, so that `help` shows them.
"""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable
from dataclasses import fields
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from wavesplat._model.keyword_hints import check_keywords

__all__ = ["takes_options"]

P = ParamSpec("P")
R = TypeVar("R")

#: Columns of a documentation line.
WIDTH = 112


def takes_options(
    listed: type, values: type, *, in_full: bool = False, **defaults: object
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorator that writes out the ``**options`` of a function: its signature, its documentation, unknown names.

    Parameters
    ----------
    listed : TypedDict
        The options.
    values : dataclass
        Has a field of the same name for each of them, with type and default.
    in_full : bool, default False
        Write out what the options mean, in place of the entry ``**options``; else their names, in place of its name.
    defaults
        Defaults that differ from those of `values`.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        whole = _signature(function, listed, values, defaults)

        @wraps(function)
        def called(*args: P.args, **kwargs: P.kwargs) -> R:
            check_keywords(function, kwargs, whole.parameters)
            return function(*args, **kwargs)

        called.__signature__ = whole  # type: ignore[attr-defined]
        called.__doc__ = _documentation(function.__doc__, listed, in_full=in_full)
        return called

    return decorate


def _signature(
    function: Callable[..., Any], listed: type, values: type, defaults: dict[str, object]
) -> inspect.Signature:
    """The signature with a keyword for each option in place of ``**options``."""
    own = inspect.signature(function)
    written = [one for one in own.parameters.values() if one.kind is not one.VAR_KEYWORD]
    of = {field.name: field for field in fields(values)}
    for name in listed.__annotations__:
        default = defaults.get(name, of[name].default)
        written.append(
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=of[name].type)
        )
    return own.replace(parameters=written)


def _documentation(text: str | None, listed: type, *, in_full: bool) -> str | None:
    """The documentation with the options, or their names, in place of the entry ``**options``."""
    if text is None or listed.__doc__ is None:
        return text  # python -OO
    lines = inspect.cleandoc(text).splitlines()
    [begin] = [k for k, line in enumerate(lines) if line.startswith("**options")]
    end = begin + 1
    if in_full:
        while end < len(lines) and lines[end].startswith(" "):
            end += 1
        section = inspect.cleandoc(listed.__doc__).split("----------\n", 1)[1]
        entries = section.split("\n\nExamples\n", 1)[0].splitlines()
    else:
        entries = textwrap.wrap(", ".join(listed.__annotations__), WIDTH)
    return "\n".join([*lines[:begin], *entries, *lines[end:]])


def first_sentences(listed: type) -> dict[str, str]:
    """The first sentence on each option of a list, for one line of help; empty where Python left out documentation."""
    found: dict[str, list[str]] = {}
    name = ""
    for line in inspect.cleandoc(listed.__doc__ or "").partition("----------\n")[2].partition("\n\n")[0].splitlines():
        if line.startswith(" "):
            found[name].append(line.strip())
        else:
            name = line.partition(" ")[0]
            found[name] = []
    return {name: " ".join(lines).partition(". ")[0].rstrip(".") + "." for name, lines in found.items()}
