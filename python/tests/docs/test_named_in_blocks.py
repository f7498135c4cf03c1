"""Names in blocks of the pages exist: functions, attributes, keywords, commands and options.

By day few pages run (see `test_pages.py`); this holds all of them, without running a block.
"""

from __future__ import annotations

import ast
import inspect
import shlex

import pages
import pytest

import wavesplat as ws
import wavesplat.study
from wavesplat._cli import command_of

PAGES = [pages.ROOT / "README.md", *sorted((pages.ROOT / "docs").glob("*.md"))]
PAGES += sorted((pages.ROOT / "docs" / "how_to").glob("*.md"))
#: The classes and functions of the package.
PUBLIC = [getattr(ws, name) for name in dir(ws) if not name.startswith("_")]
CLASSES = [one for one in PUBLIC if inspect.isclass(one)]


def of_ws(node: ast.AST) -> list[str] | None:
    """The words after `ws` of `ws.a.b`; nothing for another expression."""
    words: list[str] = []
    while isinstance(node, ast.Attribute):
        words.insert(0, node.attr)
        node = node.value
    return words if isinstance(node, ast.Name) and node.id in ("ws", "wavesplat") else None


def found(words: list[str]) -> object:
    """The value of `ws.a.b`; None where there is nothing of this name."""
    thing: object = ws
    for word in words:
        thing = getattr(thing, word, None)
    return thing


def takes(function: object, keyword: str) -> bool:
    """Whether a function has this keyword, or takes any."""
    try:
        parameters = inspect.signature(function).parameters.values()  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return True
    return any(one.kind is one.VAR_KEYWORD or one.name == keyword for one in parameters)


def mistakes_in_python(code: str) -> list[str]:
    """Names of a block that the package does not have."""
    wrong = []
    nodes = list(ast.walk(ast.parse(code)))
    others = {alias.asname or alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    for node in nodes:
        words = of_ws(node)
        if words and found(words) is None:
            wrong.append("ws." + ".".join(words))
        if not isinstance(node, ast.Call):
            continue
        words = of_ws(node.func)
        if words:
            functions = [found(words)]
        elif isinstance(node.func, ast.Attribute) and ast.unparse(node.func.value) not in others:
            # A method of one of our classes, if any has this name.
            functions = [getattr(one, node.func.attr) for one in CLASSES if hasattr(one, node.func.attr)]
        else:
            functions = []
        wrong += [
            f"{ast.unparse(node.func)}({keyword.arg}=)"
            for keyword in node.keywords
            if functions and keyword.arg and not any(takes(function, keyword.arg) for function in functions)
        ]
    return wrong


def mistakes_in_commands(code: str) -> list[str]:
    """Lines whose command or options are not those of the command line."""
    wrong = []
    for line in code.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if words[:1] != ["wavesplat"] or len(words) == 1 or words[1] == "--version":
            continue
        try:
            command = command_of(words[1])
            command.make_parser(command.context_class(command)).parse_args(words[2:])
        except Exception as error:  # noqa: BLE001 - Typer has its own copy of the errors
            wrong.append(f"{line}: {error!r}")
    return wrong


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_what_blocks_name_is_there(page):
    wrong = []
    for block in pages.blocks_of(page):
        if block.language == "python":
            wrong += mistakes_in_python(block.code)
        elif block.language in ("sh", "console"):
            wrong += mistakes_in_commands(block.code.replace("$ ", ""))
    assert wrong == []


def test_names_that_are_not_there_are_found():
    assert mistakes_in_python("ws.drawn(v)") == ["ws.drawn"]
    assert mistakes_in_python("ws.Camera.orbited(v)") == ["ws.Camera.orbited"]
    assert mistakes_in_python("ws.render(v, breadth=3)") == ["ws.render(breadth=)"]
    assert mistakes_in_python("volume.smoothed(sigmas=1)") == ["volume.smoothed(sigmas=)"]
    for line in ("wavesplat drawn a", "wavesplat render a --breadth 3", "wavesplat render a -o"):
        assert len(mistakes_in_commands(line)) == 1, line
