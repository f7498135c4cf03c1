"""Imports between modules, in Python and in Rust, and rules on which may import which; `test_layout.py` applies them.

Modules are named `room.module`, or by their room alone: a room is a folder below the root of a package or crate, or a
file there.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

Imports = Mapping[str, Collection[str]]


def check_order(imports: Imports, rooms: Sequence[str], leaves: Collection[str] = ()) -> list[str]:
    """Return a line per fault: imports from a later room, from a leaf, and rooms that have no place in the order.

    imports : modules that each module imports.
    rooms : in order; modules import from their own room and from those before it.
    leaves : rooms beside each other after the last one, which import from any of them, and nothing imports from.
    """
    place = {room: number for number, room in enumerate(rooms)} | dict.fromkeys(leaves, len(rooms))
    wrong = []
    for module, imported in sorted(imports.items()):
        room = room_of(module)
        if room not in place:
            wrong.append(f"{module}: its room, {room}, has no place in the order")
            continue
        for other in sorted(imported):
            theirs = room_of(other)
            if theirs == room:
                continue
            if theirs in leaves:
                wrong.append(f"{module} imports {other}, which nothing may import")
            elif theirs in place and place[theirs] > place[room]:
                wrong.append(f"{module} imports {other}, but {theirs} comes after {room}")
    return wrong


def circle_of_rooms(imports: Imports) -> list[str]:
    """A cycle of rooms that import each other, the first named again at the end; empty if there is none."""
    rooms: dict[str, set[str]] = {}
    for module, imported in imports.items():
        room = room_of(module)
        rooms.setdefault(room, set()).update(other for other in map(room_of, imported) if other != room)
    try:
        TopologicalSorter(rooms).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def circles_of_modules(imports: Imports) -> list[list[str]]:
    """Groups of modules that import each other, directly or by way of others, imports inside functions counted."""
    direct = {module: {_module_of(name, imports) for name in imported} - {None} for module, imported in imports.items()}
    reached = {module: _reached_from(module, direct) for module in imports}
    groups = {frozenset(b for b in reached[a] if a in reached[b]) for a in imports if a in reached[a]}
    return sorted(sorted(group) for group in groups if len(group) > 1)


def _module_of(name: str, modules: Collection[str]) -> str | None:
    """The module that an imported name is of: the longest of its beginnings that is one."""
    parts = name.split(".")
    beginnings = (".".join(parts[:n]) for n in range(len(parts), 0, -1))
    return next((one for one in beginnings if one in modules), None)


def _reached_from(module: str, direct: Mapping[str, Collection[str | None]]) -> set[str]:
    reached: set[str] = set()
    waiting = list(direct[module])
    while waiting:
        if (one := waiting.pop()) is not None and one not in reached:
            reached.add(one)
            waiting += direct[one]
    return reached


def check_exceptions(found: Mapping[str, str], exceptions: Mapping[str, str]) -> list[str]:
    """Return a line per fault: findings that are not excepted, and exceptions that are no longer needed.

    found : message on each name that breaks a rule.
    exceptions : why each name is one.
    """
    new = [f"{name}: {what}" for name, what in sorted(found.items()) if name not in exceptions]
    past = [f"{name}: all right now; take it off the list" for name in sorted(exceptions) if name not in found]
    return new + past


def room_of(module: str) -> str:
    """The first part of a module's name."""
    return module.partition(".")[0]


# Python


def python_imports(folder: Path) -> dict[str, set[str]]:
    """The modules of a package's folder, each with the modules of the package that it imports anywhere in the file.

    The package's own file is the room `__init__`, also where something imports a public name from it.
    """
    package = folder.name
    modules = {}
    for path in sorted(folder.rglob("*.py")):
        *folders, name = path.relative_to(folder).with_suffix("").parts
        modules[tuple(folders if folders and name == "__init__" else [*folders, name])] = path
    rooms = {parts[0] for parts in modules} | {"_native"}
    found = {}
    for parts, path in modules.items():
        imported = set()
        for name in imported_names(ast.parse(path.read_text(encoding="utf-8"))):
            first, *rest = name.split(".")
            if first == package:
                imported.add(".".join(rest) if rest and rest[0] in rooms else "__init__")
        found[".".join(parts)] = imported
    return found


def imported_names(tree: ast.AST) -> Iterator[str]:
    """Dotted names of all imports: inside functions, for the type checker alone, and by `import_module` too."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            if node.level:
                raise ValueError(f"line {node.lineno}: a relative import; write the package's name")
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Call) and _called(node) == "import_module":
            # Of an f-string the first part, which is known.
            name = node.args[0].values[0] if isinstance(node.args[0], ast.JoinedStr) else node.args[0]
            if isinstance(name, ast.Constant) and not name.value.endswith("."):
                yield name.value
            elif isinstance(name, ast.Constant) and "." in name.value[:-1]:
                yield name.value[:-1]


def _called(call: ast.Call) -> str:
    return call.func.id if isinstance(call.func, ast.Name) else getattr(call.func, "attr", "")


# Rust

CODE_ONLY = re.compile(
    r"""//[^\n]*                            # a comment
      | /\*.*?\*/                           # one of several lines
      | b?r(\#*)".*?"\1                     # a raw string
      | b?"(?:\\.|[^"\\])*"                 # a string
      | b?'(?:\\u\{[^}]*\}|\\.|[^'\\])'     # a character, not a lifetime
    """,
    re.DOTALL | re.VERBOSE,
)
TEST_MODULE = re.compile(
    r"#\[cfg\((?:all\(\s*)?test\b[^\]]*\]\s*(?:#\[[^\]]*\]\s*)*(?:pub(?:\([^)]*\))?\s+)?mod\s+(\w+)\s*([;{])"
)
USE = re.compile(r"\buse\s+([^;]+);")
PATH = re.compile(r"\b(?:crate|super)(?:\s*::\s*\w+)+")
ITEM = re.compile(r"[{}]|\b(impl|trait|struct|enum|union|type)\b(?:\s+(\w+))?")


def rust_sources(src: Path) -> dict[str, str]:
    """The modules of a crate and their code, without comments, texts and test modules; the root is `lib`."""
    sources, tests = {}, set()
    for path in sorted(src.rglob("*.rs")):
        parts = path.relative_to(src).with_suffix("").parts
        parts = parts[:-1] if parts[-1] == "mod" else parts
        code, test_files = _without_tests(CODE_ONLY.sub(" ", path.read_text(encoding="utf-8")))
        inside = parts if parts != ("lib",) else ()
        tests |= {".".join((*inside, name)) for name in test_files}
        sources[".".join(parts)] = code
    return {name: code for name, code in sources.items() if name not in tests}


def rust_imports(sources: Mapping[str, str]) -> dict[str, set[str]]:
    """The imports of each module of a crate from the same crate, by `use` or by a path; `lib` is the crate's root."""
    rooms = {room_of(name) for name in sources} - {"lib"}
    found = {}
    for name, code in sources.items():
        inside = [] if name == "lib" else name.split(".")
        paths = [path for tree in USE.findall(code) for path in _leaves(tree)]
        paths += [re.sub(r"\s", "", path) for path in PATH.findall(USE.sub(" ", code))]
        imported = set()
        for parts in (path.split("::") for path in paths):
            absolute = _absolute(parts, inside)
            if absolute:
                imported.add(".".join(absolute) if absolute[0] in rooms else "lib")
        found[name] = imported
    return found


def rust_types(code: str) -> list[str]:
    """Names of structs, enums, unions, traits and aliases, without associated types of traits."""
    names, blocks, opens = [], [], "other"
    for match in ITEM.finditer(code):
        word, name = match[1], match[2]
        if match[0] == "{":
            blocks.append(opens)
            opens = "other"
        elif match[0] == "}":
            blocks.pop()
        elif word == "impl":
            opens = "members"
        elif name and not (word == "type" and blocks[-1:] == ["members"]):
            names.append(name)
            opens = "members" if word == "trait" else "other"
    return names


def _without_tests(code: str) -> tuple[str, list[str]]:
    """The code without modules of tests in it, and the names of those that are files of their own."""
    kept, files, start = [], [], 0
    for match in TEST_MODULE.finditer(code):
        if match.start() < start:
            continue
        kept.append(code[start : match.start()])
        start = match.end() if match[2] == ";" else _end_of_block(code, match.end())
        if match[2] == ";":
            files.append(match[1])
    return "".join([*kept, code[start:]]), files


def _end_of_block(code: str, inside: int) -> int:
    depth = 1
    for match in re.compile(r"[{}]").finditer(code, inside):
        depth += 1 if match[0] == "{" else -1
        if depth == 0:
            return match.end()
    raise ValueError("a block has no end")


def _leaves(tree: str) -> list[str]:
    """Paths that a use tree stands for: `a::{b, c::d}` is `a::b` and `a::c::d`."""
    tree = re.sub(r"\s+as\s+\w+", "", tree).strip()
    before, brace, rest = tree.partition("{")
    if not brace:
        return [re.sub(r"\s", "", tree)] if tree else []
    branches, depth, start = [], 0, 0
    inside = rest[: rest.rindex("}")]
    for place, letter in enumerate(inside):
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            branches.append(inside[start:place])
            start = place + 1
    branches.append(inside[start:])
    return [re.sub(r"\s", "", before) + leaf for branch in branches for leaf in _leaves(branch)]


def _absolute(parts: list[str], inside: list[str]) -> list[str]:
    """The path from the crate's root of a path that begins with `crate`, `super` or `self`; empty for others."""
    if parts[0] == "crate":
        return parts[1:]
    if parts[0] not in ("super", "self"):
        return []
    while parts[0] in ("super", "self"):
        inside = inside[:-1] if parts[0] == "super" else inside
        parts = parts[1:]
        if not parts:
            return inside or ["lib"]
    return [*inside, *parts]
