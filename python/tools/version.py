"""The version, which `Cargo.toml` has, and its copies where a format wants one of its own.

    python python/tools/version.py                   # print it; an error where a copy differs
    python python/tools/version.py --set 0.2.0       # write it everywhere
    python python/tools/version.py --expect 0.2.0    # an error if it is another one: of a tag, before it is published

The compiled module, the wheel, `wavesplat --version` and reports have that of `Cargo.toml` from the build.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
NUMBER = r"(\d+\.\d+\.\d+)"
#: File -> patterns of its copies; the first group stands before the version, the second is the version.
COPIES = {
    "Cargo.toml": [
        r'(\[workspace\.package\]\nversion = ")' + NUMBER,
        r'(wavesplat[a-z-]* = \{[^}\n]*version = ")' + NUMBER,
    ],
    "Cargo.lock": [r'(name = "wavesplat[a-z-]*"\nversion = ")' + NUMBER],
    "fuzz/Cargo.lock": [r'(name = "wavesplat-(?!fuzz)[a-z-]+"\nversion = ")' + NUMBER],
    "CITATION.cff": [r"(\nversion: )" + NUMBER],
    "packaging/conda-forge/recipe.yaml": [r"(\n  version: )" + NUMBER],
    "web/package.json": [r'(\A\{\n  "name": "[^"]+",\n  "version": ")' + NUMBER],
    "web/package-lock.json": [
        r'(\A\{\n  "name": "[^"]+",\n  "version": ")' + NUMBER,
        r'("": \{\n      "name": "[^"]+",\n      "version": ")' + NUMBER,
    ],
}


def versions(root: Path = ROOT) -> dict[str, set[str]]:
    """The versions that each file has; an error where a pattern finds none."""
    found: dict[str, set[str]] = {}
    for name, patterns in COPIES.items():
        text = (root / name).read_text(encoding="utf-8")
        for pattern in patterns:
            copies = {match[2] for match in re.finditer(pattern, text)}
            if not copies:
                raise SystemExit(f"{name} has no version where one is looked for: {pattern}")
            found.setdefault(name, set()).update(copies)
    return found


def write(version: str, root: Path = ROOT) -> None:
    """Write the version to every file that has a copy."""
    if not re.fullmatch(NUMBER, version):
        raise SystemExit(f"{version!r} is no version; write three numbers, such as 0.2.0")
    for name, patterns in COPIES.items():
        text = (root / name).read_text(encoding="utf-8")
        for pattern in patterns:
            text = re.sub(pattern, rf"\g<1>{version}", text)
        (root / name).write_text(text, encoding="utf-8")


def current(root: Path = ROOT) -> str:
    """The version, if all copies are that of `Cargo.toml`; else an error that names those that are not."""
    found = versions(root)
    [version] = {re.search(COPIES["Cargo.toml"][0], (root / "Cargo.toml").read_text(encoding="utf-8"))[2]}  # type: ignore[index]
    others = {name: sorted(copies - {version}) for name, copies in found.items() if copies != {version}}
    if others:
        raise SystemExit(
            f"Cargo.toml has version {version}, other places {others}; run {Path(__file__).name} --set {version}"
        )
    return version


def main(arguments: list[str]) -> None:
    """Do what the arguments say, and print the version."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--set", metavar="VERSION")
    parser.add_argument("--expect", metavar="VERSION")
    given = parser.parse_args(arguments)
    if given.set:
        write(given.set)
    version = current()
    if given.expect and given.expect != version:
        raise SystemExit(f"the version is {version}, not {given.expect}; tag v{version}, or set it first")
    print(version)


if __name__ == "__main__":
    main(sys.argv[1:])
