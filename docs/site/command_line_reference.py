"""Directive `command-line`: a section for each command of `wavesplat`, its usage and options, from its parsers."""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import inspect
from typing import Any

import typer.main
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from wavesplat._cli import COMMANDS, command_of
from wavesplat._cli import app as command_line


def setup(app: Sphinx) -> dict[str, Any]:
    """Name the directive."""
    app.add_directive("command-line", CommandLine)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


class CommandLine(SphinxDirective):  # type: ignore[misc]  # Sphinx need not be there
    """The sections of all commands, in the order of `wavesplat --help`."""

    def run(self) -> list[nodes.Node]:
        """Return the sections."""
        program: Any = typer.main.get_command(command_line)
        root = program.make_context("wavesplat", ["--version"], resilient_parsing=True)
        return [section_of(name, command_of(name), root) for name in COMMANDS]


def section_of(name: str, command: Any, root: Any) -> nodes.section:
    """The section of a command: its purpose, its usage, its arguments and options.

    command, root : a command and the context of the program, of the library that Typer stands on.
    """
    context = command.context_class(command, info_name=name, parent=root)
    section = nodes.section(ids=[nodes.make_id(f"wavesplat-{name}")])
    section += nodes.title(text=f"wavesplat {name}")
    section += [paragraph(part) for part in inspect.cleandoc(command.help).split("\n\n")]
    usage = " ".join([context.command_path, *command.collect_usage_pieces(context)])
    section += nodes.literal_block(usage, usage, language="none")
    records = [parameter.get_help_record(context) for parameter in command.get_params(context)]
    section += definitions([record for record in records if record is not None])
    return section


def definitions(records: list[tuple[str, str]]) -> nodes.definition_list:
    """A list of names, each with what it means."""
    listed = nodes.definition_list()
    for names, meaning in records:
        term = nodes.term("", "", nodes.literal(text=names))
        listed += nodes.definition_list_item("", term, nodes.definition("", paragraph(meaning)))
    return listed


def paragraph(text: str) -> nodes.paragraph:
    """A text in one line, what stands between backquotes in it as code."""
    parts = " ".join(text.split()).split("`")
    return nodes.paragraph("", "", *(nodes.literal(text=p) if n % 2 else nodes.Text(p) for n, p in enumerate(parts)))
