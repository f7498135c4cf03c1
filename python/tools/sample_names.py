"""Print ten functions of ten rooms, drawn at random: name, arguments and first line, without the code.

A reader who does not know the project says what each does; names and first lines that were misread are mended.
`python python/tools/sample_names.py SEED`.
"""

from __future__ import annotations

import ast
import random
import re
import sys
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RUST = re.compile(r"((?:^ *//[/!].*\n)+)(?:^ *#\[.*\n)*^ *(?:pub(?:\([a-z]+\))? )?fn (\w+)([^{]*)", re.MULTILINE)


def functions() -> dict[str, list[str]]:
    """Documented functions of every room: folders of crates and of the package."""
    found: dict[str, list[str]] = defaultdict(list)
    for path in sorted(ROOT.glob("crates/*/src/**/*.rs")):
        room = path.parent.relative_to(ROOT).as_posix()
        for comment, name, rest in RUST.findall(path.read_text(encoding="utf-8")):
            lines = [line.strip().lstrip("/! ") for line in comment.strip().splitlines()]
            paragraph = " ".join(lines[: lines.index("") if "" in lines else None])
            found[room].append(f"{path.stem}::{name}{' '.join(rest.split())}\n    {paragraph}")
    for path in sorted(ROOT.glob("python/wavesplat/_*/**/*.py")):
        room = path.parent.relative_to(ROOT).as_posix()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and (docstring := ast.get_docstring(node)):
                first = docstring.splitlines()[0]
                found[room].append(f"{path.stem}.{node.name}({ast.unparse(node.args)})\n    {first}")
    return found


def main() -> None:
    """Print the ten."""
    chance = random.Random(int(sys.argv[1]) if len(sys.argv) > 1 else 1)  # noqa: S311 - a draw, no secret
    of_rooms = functions()
    for room in chance.sample(sorted(of_rooms), 10):
        print(f"{room}: {chance.choice(of_rooms[room])}\n")


if __name__ == "__main__":
    main()
