"""The command line: `wavesplat` render, view, movie, slice, info, presets and others, a module for each.

Results go to stdout; messages, errors and the progress bar to stderr.
A command's module is imported, and its options are made, when the command is run; everything but argument parsing is
imported inside of the command. So `--help` of a command and mistakes answer at once, and small pictures take no longer.
"""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from typing import Annotated, Any, NoReturn

import typer
from typer.core import TyperCommand, TyperGroup

from wavesplat._cli.printing import message, print_lines, take_any_name
from wavesplat.errors import ArgumentError, WavesplatError, WavesplatWarning

EXIT_OK, EXIT_FAILED, EXIT_USAGE, EXIT_INTERRUPTED = 0, 1, 2, 130

#: Base class of Typer's errors of the command line: Typer does not export it, only its subclass `BadParameter`.
CommandLineError: Any = typer.BadParameter.__mro__[2]

#: Environment variable: set to anything, errors are raised with their tracebacks.
SHOW_TRACEBACK = "WAVESPLAT_TRACEBACK"

EPILOG = (
    "Exit codes: 0 it worked; 1 the file, the data or the machine failed; 2 wrong arguments; 130 interrupted. "
    "Results go to stdout, messages to stderr. NO_COLOR switches colours off."
)


#: Commands in the order of the help; each is the function of its name in the module of its name.
COMMANDS = (
    "render",
    "view",
    "movie",
    "slice",
    "info",
    "presets",
    "tf",
    "convert",
    "wavelet",
    "mesh",
    "plan",
    "gpu-check",
    "demo",
)

#: Objects made, less those deleted, before Python looks for cycles of them. Its default of 700 makes a tenth of the
#: processor time of a small picture, most of it over the objects of imports, which all stay.
OBJECTS_BETWEEN_COLLECTIONS = 50_000


class _Command(TyperCommand):
    """A command whose help lists options by the titles of their groups."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        listed: dict[str, list[tuple[str, str]]] = {"Arguments": [], "Options": []}
        for parameter in self.get_params(ctx):
            title = "Arguments" if parameter.param_type_name == "argument" else "Options"
            record = parameter.get_help_record(ctx)
            if record is not None:
                listed.setdefault(getattr(parameter, "rich_help_panel", None) or title, []).append(record)
        for title, records in listed.items():
            if records:
                with formatter.section(title):
                    formatter.write_dl(records)


class _Commands(TyperGroup):
    """The commands, whose options are made when they are asked for; unknown ones come with a hint."""

    def list_commands(self, _ctx: Any) -> list[str]:
        return list(COMMANDS)

    def get_command(self, _ctx: Any, cmd_name: str) -> Any:
        return command_of(cmd_name) if cmd_name in COMMANDS else None

    def resolve_command(self, ctx: Any, args: list[str]) -> tuple[str | None, Any, list[str]]:
        if args and args[0] not in COMMANDS and not args[0].startswith("-"):
            from wavesplat._cli import hints

            raise ArgumentError(f"no such command: {args[0]}; {hints.of_command(args[0], COMMANDS)}")
        return super().resolve_command(ctx, args)


@cache
def command_of(name: str) -> Any:
    """A command with its options."""
    from wavesplat._cli.options.groups import expanded

    function = name.replace("-", "_")
    command = expanded(getattr(import_module(f"wavesplat._cli.commands.{function}"), function))
    alone = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    alone.command(name, cls=_Command, epilog=EPILOG)(command)
    return typer.main.get_command(alone)


#: Messages of the system's linker when memory is too little to load a compiled module.
NO_ROOM = ("failed to map segment", "annot allocate memory")


def options_of(name: str) -> set[str]:
    """The options of a command, as they are written."""
    return {option for parameter in command_of(name).params for option in (*parameter.opts, *parameter.secondary_opts)}


app = typer.Typer(
    name="wavesplat",
    cls=_Commands,
    help="Pictures of volumes, by high-resolution splatting.",
    epilog=EPILOG,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    if version:
        from wavesplat._native import __version__

        print_lines(f"wavesplat {__version__}")
        raise typer.Exit(EXIT_OK)
    if context.invoked_subcommand is None:
        print_lines(context.get_help())
        raise typer.Exit(EXIT_USAGE)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and leave with its exit code; every failure is one line on stderr."""
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS)
    take_any_name()
    with _warnings_as_notes():
        sys.exit(_exit_code_of(arguments))


def _exit_code_of(arguments: Sequence[str] | None) -> int:
    """Run a command, print its failure on stderr, and return its exit code."""
    try:
        code = app(args=arguments, standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        code = EXIT_INTERRUPTED
    except BrokenPipeError:
        # The reader of our output has gone, as in `wavesplat info x | head -1`.
        if sys.stderr is not None:
            sys.stderr.close()
        sys.exit(EXIT_OK)
    except BaseException as error:
        if isinstance(error, SystemExit) or os.environ.get(SHOW_TRACEBACK):
            raise
        text, code = _explained(error)
        message("error: " + " ".join(text.split()))
        return code
    if code == EXIT_INTERRUPTED:  # some releases of Typer return it, some raise
        message("interrupted; nothing was written")
    return code if isinstance(code, int) else EXIT_OK


@contextmanager
def _warnings_as_notes() -> Iterator[None]:
    """Print Wavesplat's warnings as notes on stderr, also warnings of threads that read while a picture is drawn."""
    import warnings

    usual = warnings.showwarning

    def show(said: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
        if issubclass(category, WavesplatWarning):
            message(f"note: {said}")
        else:
            usual(said, category, *where, **more)

    warnings.showwarning = show  # type: ignore[assignment]
    try:
        yield
    finally:
        warnings.showwarning = usual


def _explained(error: BaseException) -> tuple[str, int]:
    """The message for an error, and the exit code."""
    if isinstance(error, WavesplatError):
        return str(error), EXIT_USAGE if isinstance(error, ArgumentError) else EXIT_FAILED
    if isinstance(error, CommandLineError) and hasattr(error, "possibilities"):
        return _unknown_option_message(error), EXIT_USAGE
    if isinstance(error, CommandLineError):
        return error.format_message().rstrip(".") + "; see wavesplat --help", EXIT_USAGE
    if isinstance(error, MemoryError):
        return "not enough memory; use a smaller picture, a coarser level or a smaller volume", EXIT_FAILED
    if isinstance(error, ImportError) and any(words in str(error) for words in NO_ROOM):
        what = "not enough memory to load the compiled module of wavesplat"
        return f"{what}; raise the memory limit of this process", EXIT_FAILED
    if isinstance(error, OSError):
        return f"{error.strerror or error}; check names, permissions and free space", EXIT_FAILED
    what = ": ".join(part for part in (type(error).__name__, str(error)) if part)
    return f"{what}; this is a mistake of wavesplat: report it, with the command and the volume", EXIT_FAILED


def _unknown_option_message(error: Any) -> str:
    """The message for an unknown option."""
    from wavesplat._cli import hints

    context = error.ctx
    if context.parent is None:
        return f"no such option: {error.option_name}; see wavesplat --help"
    options = {name: options_of(name) for name in COMMANDS}
    return f"no such option: {error.option_name}; {hints.of_option(error.option_name, context.info_name, options)}"
