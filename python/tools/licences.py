"""The terms of the crates that the compiled module holds, which their authors ask to be given on with it.

    python python/tools/licences.py [--target aarch64-unknown-linux-gnu]

A wheel has them as `LICENSES-OF-OTHERS.txt`: each text once, below the crates that have it.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
FILES = re.compile(r"(licen[cs]e|copying|notice|unlicense|copyright)", re.IGNORECASE)


def main(arguments: list[str]) -> None:
    """Print the terms."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--target", help="the processor and system of the module; without it, this machine's")
    print(of_crates(ROOT, parser.parse_args(arguments).target))


def of_crates(source: Path, target: str | None = None) -> str:
    """The terms of the crates that the module of a checkout is built from for a target."""
    crates = {(package["name"], package["version"]): package for package in packages(source)}
    texts: dict[str, list[str]] = {}
    silent = []
    for name, version in linked(source, target):
        package = crates[name, version]
        found = sorted({path.read_text(encoding="utf-8", errors="replace").strip() for path in files_of(package)})
        for text in found:
            texts.setdefault(text, []).append(f"{name} {version} ({package['license']})")
        if not found:
            silent.append(f"{name} {version} ({package['license']})")
    parts = [f"{chr(10).join(users)}\n\n{text}\n" for text, users in sorted(texts.items(), key=lambda one: one[1])]
    if silent:
        parts.append("\n".join(["These give no file of their terms, but the names of them:", *silent, ""]))
    return f"\n{'-' * 80}\n\n".join(parts)


def packages(source: Path) -> list[dict[str, Any]]:
    """Manifests of all crates of the lock file, ours left out."""
    metadata = json.loads(_cargo(source, "metadata", "--locked", "--format-version", "1"))
    return [package for package in metadata["packages"] if package["source"] is not None]


def linked(source: Path, target: str | None) -> list[tuple[str, str]]:
    """Name and version of each crate of others that becomes part of the module, in order."""
    options = ["-p", "wavesplat-python", "-e", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}"]
    if target is not None:
        options += ["--target", target]
    lines = _cargo(source, "tree", "--locked", *options).splitlines()
    matches = [re.match(r"(\S+) v(\S+)", line) for line in lines if not re.search(r" \(.*[/\\].*\)", line)]
    return sorted({(match[1], match[2]) for match in matches if match})


def files_of(package: dict[str, Any]) -> list[Path]:
    """Files of a crate that say its terms."""
    folder = Path(package["manifest_path"]).parent
    return [path for path in sorted(folder.iterdir()) if path.is_file() and FILES.match(path.name)]


def _cargo(source: Path, *words: str) -> str:
    done = subprocess.run(["cargo", *words], cwd=source, capture_output=True, text=True, encoding="utf-8", check=False)  # noqa: S603, S607 - our own command
    if done.returncode:
        raise SystemExit(f"cargo {' '.join(words)} failed:\n{done.stderr}")
    return done.stdout


if __name__ == "__main__":
    main(sys.argv[1:])
