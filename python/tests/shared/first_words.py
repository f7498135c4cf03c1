"""First words of definitions: doc comments of Rust and TypeScript, docstrings and `#:` of Python, comments of WGSL.

`python python/tests/shared/first_words.py [FILE ...]` lists the lines that do not begin like a definition.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[3]

#: Ellipses: the reader must guess the noun.
ELLIPSES = re.compile(r"(What|That of|Those|As of|As those|As that|Of (it|them|all|each|those|what)|Theirs|None of)\b")

#: The head of a block of comments, by the name's end; the text is what follows.
HEADS = {
    ".rs": re.compile(r"\s*//[/!] ?(.*)"),
    ".wgsl": re.compile(r"\s*// ?(.*)"),
    ".ts": re.compile(r"\s*/\*\* ?(.*)"),
}
HEADS[".tsx"] = HEADS[".ts"]


def first_lines(path: Path) -> Iterator[tuple[int, str]]:
    """Line number and first line of every definition's comment."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        was_comment = False
        for number, line in enumerate(text.splitlines(), 1):
            found = HEADS[path.suffix].match(line)
            if found and not was_comment:
                yield number, found.group(1)
            was_comment = found is not None
        return
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            docstring = ast.get_docstring(node)
            if docstring:
                yield getattr(node, "lineno", 1), docstring.splitlines()[0]
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("#: "):
            yield number, line.lstrip()[3:]


def sources() -> list[Path]:
    """The files of the checkout that git knows, of languages that are looked at."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True).stdout
    paths = (ROOT / name for name in listed.decode().split("\0") if name)
    return [path for path in paths if path.suffix in (".py", *HEADS) and path.exists()]


def ellipses(paths: list[Path]) -> list[str]:
    """`file:line: text` of every first line that begins with an ellipsis."""
    return [
        f"{path}:{number}: {line}"
        for path in paths
        for number, line in first_lines(path)
        if ELLIPSES.match(line.lstrip("`* "))
    ]


if __name__ == "__main__":
    print("\n".join(ellipses([Path(name) for name in sys.argv[1:]] or sources())))
