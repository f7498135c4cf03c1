"""Build the wheel again, from the source distribution, in another folder, and compare the bytes: `make release-check`.

    python python/tools/check_repeat.py dist/*x86_64.whl dist/*.tar.gz --zig --compatibility manylinux_2_28

The other options are those that the wheel was built with. Nothing of the first build is used, so that this takes as
long as that, minutes; it also shows that the source distribution has all that the wheel needs.
"""

from __future__ import annotations

import argparse
import os
import sys
import tarfile
import tempfile
import zipfile
from pathlib import Path

import build_wheel


def main(arguments: list[str]) -> None:
    """Build and compare; an error names the files that differ."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("wheel", type=Path)
    parser.add_argument("source", type=Path, help="the source distribution")
    given, options = parser.parse_known_args(arguments)
    os.environ.setdefault("SOURCE_DATE_EPOCH", str(build_wheel.last_commit(build_wheel.ROOT)))
    os.environ.pop("CARGO_TARGET_DIR", None)
    with tempfile.TemporaryDirectory() as name:
        with tarfile.open(given.source) as file:
            file.extractall(name, filter="data")
        [source] = Path(name).iterdir()
        again = build_wheel.build(source, Path(name) / "out", options)
        found = differences(given.wheel, again)
    if found:
        raise SystemExit(f"{given.wheel}: built again, it differs in {', '.join(found)}")
    print(f"{given.wheel.name}: built again from {given.source.name} in another folder, it has the same bytes")


def differences(one: Path, other: Path) -> list[str]:
    """Names of what differs between two wheels: files, or how they are packed; nothing if all bytes are the same."""
    if one.read_bytes() == other.read_bytes():
        return []
    with zipfile.ZipFile(one) as first, zipfile.ZipFile(other) as second:
        names, others = first.namelist(), second.namelist()
        found = sorted(set(names) ^ set(others))
        found += [name for name in names if name in others and first.read(name) != second.read(name)]
    return found or ["the order, the times or the compression of its files"]


if __name__ == "__main__":
    main(sys.argv[1:])
