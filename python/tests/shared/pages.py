"""Pages of the documentation that run: their blocks of Python and of commands, in order, in one folder.

A section is the text below a heading of two `#`. Blocks of ```python share their names within a page's set-up and a
section; in ```sh every line is a command that begins with `wavesplat`. Other blocks are not run.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[3]


class Block(NamedTuple):
    """A block of code between two fences; `line` is the number of the first fence's line."""

    section: str
    language: str
    code: str
    line: int


def blocks_of(page: Path) -> list[Block]:
    """The blocks of a page, in order; those above the first heading are in the section ""."""
    found: list[Block] = []
    section, fence, lines = "", None, []
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if fence is None and line.startswith("## "):
            section = line[3:].strip()
        if not line.startswith("```"):
            lines.append(line)
            continue
        if fence is None:
            fence, lines = (line[3:].strip(), number), []
        else:
            found.append(Block(section, fence[0], "\n".join(lines), fence[1]))
            fence = None
    return found


def run(page: Path, blocks: list[Block], command: Callable[..., Any], folder: Path, names: dict[str, Any]) -> None:
    """Run blocks; the working folder is `folder` already. `command`: runs `wavesplat` with arguments."""
    for block in blocks:
        where = f"{page.name}, line {block.line}"
        if block.language == "python":
            # Leading newlines number the lines as in the page, so that a traceback names the right one.
            exec(compile("\n" * block.line + block.code, str(page), "exec"), names)  # noqa: S102 - our own pages
        elif block.language == "sh":
            for line in block.code.replace("\\\n", " ").splitlines():
                words = shlex.split(line, comments=True)
                if not words:
                    continue
                assert words[0] == "wavesplat", f"{where}: {line} is no command of ours"
                done = command(*words[1:], cwd=folder)
                assert done.returncode == 0, f"{where}: {line}\n{done.stderr}"
