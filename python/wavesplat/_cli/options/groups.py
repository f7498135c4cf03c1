"""Groups of options that several commands share: the fields of a dataclass, passed as one value.

A field made by `option` says how the option is written; what it means is said there too, or in the documentation of
an option list of the library, such as `OpenOptions`. A group may have others as parts (`part`). Groups are dataclasses
that are neither frozen nor printed, since Python makes such classes in half of the time.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import Field, field, fields, is_dataclass
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, get_args

import typer

from wavesplat._cli.options import parsers
from wavesplat._cli.options.parsers import one_of
from wavesplat._model.arguments import sampling
from wavesplat._model.arguments.types import first_sentences

#: Annotation of a field -> type of its option; a text where another annotation stands there.
TYPES: dict[Any, Any] = {
    "bool": bool,
    "bool | None": bool | None,
    "int": int,
    "float": float,
    "int | None": int | None,
    "float | None": float | None,
    "list[str] | None": list[str] | None,
    "Path | None": Path | None,
}


def option(
    metavar: str | None = None,
    help: str | None = None,
    *names: str,
    default: Any = None,
    parser: Callable[[str], Any] | None = None,
    choices: Sequence[str] = (),
    show_default: bool = True,
) -> Any:
    """A field of a group that is an option.

    help : None is the first sentence that the group's `DOCUMENTED` has on the field, or the choices.
    names : as they are written, where these do not follow from the name of the field.
    """
    if choices:
        metavar, parser = metavar or "NAME", one_of(choices)
    how = {"metavar": metavar, "help": help, "parser": parser, "show_default": show_default}
    return field(default=default, metadata={"names": names, "how": how, "choices": choices})


def part(group: type) -> Any:
    """A field of a group that is a group itself."""
    return field(default_factory=group, metadata={"part": group})


def expanded(command: Callable[..., None]) -> Callable[..., None]:
    """The command with options in the places of its groups. An option that an earlier group has is left out."""
    signature = inspect.signature(command, eval_str=True)
    groups = {name: one.annotation for name, one in signature.parameters.items() if is_dataclass(one.annotation)}
    owners: dict[str, Any] = {name: command for name in signature.parameters if name not in groups}
    parameters: list[inspect.Parameter] = []
    for name, parameter in signature.parameters.items():
        parameters += _parameters(groups[name], owners) if name in groups else [parameter]

    @wraps(command)
    def with_options(**given: Any) -> None:
        command(
            **{name: _made(group, given, owners) for name, group in groups.items()} | _plain(given, owners, command)
        )

    return with_signature(with_options, parameters)


def with_signature(function: Callable[..., None], parameters: Sequence[inspect.Parameter]) -> Callable[..., None]:
    """The function with the parameters that Typer makes options of."""
    # Typer reads one or the other, depending on its release.
    function.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    function.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return function


def parameters_of(group: Any) -> list[inspect.Parameter]:
    """The options of a group as parameters of a command."""
    return list(_parameters(group, {}))


def _plain(given: dict[str, Any], owners: dict[str, Any], command: Any) -> dict[str, Any]:
    return {name: value for name, value in given.items() if owners.get(name) is command}


def _parameters(group: Any, owners: dict[str, Any]) -> Iterator[inspect.Parameter]:
    written = getattr(group, "WRITTEN", {})
    documented = getattr(group, "DOCUMENTED", None)
    meanings = {} if documented is None else first_sentences(documented)
    for one in fields(group):
        if "part" in one.metadata:
            yield from _parameters(one.metadata["part"], owners)
            continue
        metadata = written.get(one.name, one).metadata
        if metadata and owners.setdefault(one.name, group) is group:
            names, how = metadata["names"], metadata["how"]
            if how["help"] is None:
                # Other options of the same list are named as they are written on the command line.
                meaning = re.sub(r"`(\w+)`", lambda name: _written(name[1]), meanings.get(one.name, ""))
                how = how | {"help": meaning or f"{', '.join(metadata['choices'])}."}
            shape = _type(one, how["parser"])
            if shape is bool and not names:
                yes = _written(one.name)
                names = (f"{yes}/--no-{yes[2:]}" if one.default else yes,)
            home = next(k for k in reversed(group.__mro__) if one.name in getattr(k, "__dataclass_fields__", ()))
            panel = getattr(home, "TITLE", None) or getattr(group, "TITLE", None)
            said = Annotated[shape, typer.Option(*names, **how, rich_help_panel=panel)]  # type: ignore[valid-type]
            keyword = inspect.Parameter.KEYWORD_ONLY
            yield inspect.Parameter(one.name, keyword, default=one.default, annotation=said)


def _type(one: Field[Any], parser: object) -> Any:
    if parser is None:
        return TYPES.get(one.type, str | None)
    return list[Any] | None if str(one.type).startswith("list") else Any


def _made(group: Any, given: dict[str, Any], owners: dict[str, Any]) -> Any:
    """The group of the given options."""
    return group(
        **{
            one.name: _made(one.metadata["part"], given, owners) if "part" in one.metadata else given[one.name]
            for one in fields(group)
            if "part" in one.metadata or (owners.get(one.name) is group and one.name in given)
        }
    )


def _written(name: str) -> str:
    return "--" + name.replace("_", "-")


def given(*groups: Any) -> list[str]:
    """Names of the groups' options that were set, as they are written on the command line."""
    return sorted(name for group in groups for name in _given(group))


def _given(group: Any) -> Iterator[str]:
    for one in fields(group):
        value = getattr(group, one.name)
        if "part" in one.metadata:
            yield from _given(value)
        elif value != one.default:
            yield _written(one.name)


# Arguments and options that several commands share.

InputOrNone = Annotated[
    str | None, typer.Argument(metavar="INPUT", help="A volume: file, folder or URL.", show_default=False)
]
Input = Annotated[str, typer.Argument(metavar="INPUT", help="A volume: file, folder or URL.", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No messages and no progress bar; errors still show.")]


def output(help: str) -> Any:
    """The option of the result's file."""
    return typer.Option("--output", "-o", metavar="OUT", help=help, show_default=False)


PictureOutput = Annotated[Path, output("Picture to write: .png, .jpg, .webp, .tif, .exr, .svg or .pdf.")]


def picture_size(help: str = "Pixels.", default: str | None = "512x512") -> Any:
    """The field of a picture's size."""
    return option("WxH", help, default=default, parser=parsers.size)


def zoom() -> Any:
    """The field of a magnification."""
    return option("FACTOR", "Magnification; 1 fits the volume.", default=1.0)


def kernel() -> Any:
    """The field of a kernel."""
    return option(choices=get_args(sampling.Kernel), default="linear")


def background(default: str | None = None) -> Any:
    """The field of a background."""
    return option("COLOR", "black, white, grey, #rrggbb, r,g,b or transparent.", default=default, parser=parsers.color)


def bits() -> Any:
    """The field of the bits of a picture's file."""
    return option("8|16", "Bits per channel of a PNG or TIFF file.", default=8)


def threads() -> Any:
    """The field of worker threads."""
    return option("N", "Worker threads; all cores if not given.")


def family() -> Any:
    """The field of a family of wavelets."""
    return option("NAME", "Wavelets: cdf97, cdf53, haar, spline4, bspline2 to bspline4.", default="cdf97")


def threshold() -> Any:
    """The field of a threshold of wavelet coefficients."""
    return option("T", "Drop wavelet coefficients of less amplitude, in sample units.")
