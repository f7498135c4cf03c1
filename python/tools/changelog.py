"""The changelog of a version, from the notes in `changes/`.

    python python/tools/changelog.py --release 0.2.0    # make the notes a section of CHANGELOG.md, dated today
    python python/tools/changelog.py --of 0.2.0         # print the section of a version, or of "Unreleased": the notes

A note is `changes/<name>.<added|changed|fixed|removed>.md`: sentences, or a list; links in it lead from `changes/`.
`changes/README.md` is no note.
"""

from __future__ import annotations

import argparse
import datetime as dt
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
KINDS = ("added", "changed", "fixed", "removed")
UNRELEASED = "## [Unreleased]\n"


def notes(root: Path = ROOT) -> dict[str, list[Path]]:
    """The notes of each kind, by number and name; an error about a file that is none."""
    found: dict[str, list[Path]] = {kind: [] for kind in KINDS}
    for path in sorted((root / "changes").glob("*"), key=_place):
        if path.name == "README.md":
            continue
        kind = path.name.split(".")[-2] if path.name.count(".") == 2 and path.suffix == ".md" else ""
        if kind not in KINDS:
            raise SystemExit(f"changes/{path.name} is no note; name it <name>.<{'|'.join(KINDS)}>.md")
        found[kind].append(path)
    return found


def _place(path: Path) -> tuple[int, str]:
    number = re.match(r"\d+", path.name)
    return int(number[0]) if number else sys.maxsize, path.name


def section(root: Path = ROOT) -> str:
    """The text of all notes, by kind, each an item of a list."""
    parts = []
    for kind, paths in notes(root).items():
        if paths:
            items = "".join(_items(path.read_text(encoding="utf-8")) for path in paths)
            parts.append(f"### {kind.title()}\n\n{items}")
    return "\n".join(parts)


def _items(text: str) -> str:
    """A note as items: a list as it is; sentences as one item, with a list behind them inside of it."""
    text = re.sub(r"\]\(\.\./", "](", text.strip())
    lines = [line for line in text.splitlines() if line.strip()]
    if lines[0].startswith("- "):
        return "".join(f"{line}\n" for line in lines)
    return "".join(f"{'- ' if number == 0 else '  '}{line}\n" for number, line in enumerate(lines))


def of_version(version: str, root: Path = ROOT) -> str:
    """The section of a released version in CHANGELOG.md, or the notes for "Unreleased"."""
    if version == "Unreleased":
        return section(root)
    text = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    found = re.search(rf"^## \[{re.escape(version)}\][^\n]*\n(.*?)(?=^## \[|\Z)", text, re.MULTILINE | re.DOTALL)
    if found is None:
        raise SystemExit(f"CHANGELOG.md has no version {version}; make it by --release {version}")
    return found[1].strip() + "\n"


def release(version: str, day: dt.date, root: Path = ROOT) -> None:
    """Move the notes into a section of CHANGELOG.md."""
    text = section(root)
    if not text:
        raise SystemExit("changes/ has no notes: there is nothing to release")
    path = root / "CHANGELOG.md"
    whole = path.read_text(encoding="utf-8")
    if whole.count(UNRELEASED) != 1 or f"## [{version}]" in whole:
        raise SystemExit(f"CHANGELOG.md has version {version} already, or no section {UNRELEASED.strip()!r}")
    before, _, after = whole.partition(UNRELEASED)
    rest = after.partition("\n## [")
    older = f"\n## [{rest[2]}" if rest[1] else ""
    path.write_text(
        f"{before}{UNRELEASED}\nSee `changes/`.\n\n## [{version}] - {day}\n\n{text}{older}", encoding="utf-8"
    )
    for paths in notes(root).values():
        for one in paths:
            one.unlink()


def main(arguments: list[str]) -> None:
    """Do what the arguments say."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    group = parser.add_mutually_exclusive_group(required=True)
    group.add_argument("--release", metavar="VERSION")
    group.add_argument("--of", metavar="VERSION")
    given = parser.parse_args(arguments)
    if given.release:
        release(given.release, dt.datetime.now(dt.UTC).date())
    else:
        print(of_version(given.of), end="")


if __name__ == "__main__":
    main(sys.argv[1:])
