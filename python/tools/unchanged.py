"""Whether sources are those that a slow check passed on last: `unchanged.py kernels` exits with 0 if they are.

`unchanged.py --record kernels` keeps the hash of today's sources in `.ci/passed.json`; the recipes of the checks do so.
"""

import hashlib
import json
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
RECORDS = ROOT / ".ci" / "passed.json"

#: Files and folders that each check depends on.
SOURCES = {
    # Vector code on ARM, memcheck, counted instructions.
    "kernels": ["crates/compute/src", *(f"crates/splat/src/{room}" for room in ("kernel", "sheet", "optics", "ray"))],
    # Translation of shaders to the languages of other systems.
    "shaders": ["crates/gpu/src", "crates/gpu/tests/shaders.rs"],
    # Licences and sources of crates.
    "licences": ["Cargo.lock", "deny.toml"],
}


def source_hash(paths: list[str]) -> str:
    """SHA-256 of the names and contents of files, and of those in folders, in the order of their names."""
    places = [ROOT / path for path in paths]
    files = sorted(file for place in places for file in [place, *place.rglob("*")] if file.is_file())
    digest = hashlib.sha256()
    for file in files:
        content = hashlib.sha256(file.read_bytes()).hexdigest()
        digest.update(f"{content} {file.relative_to(ROOT).as_posix()}\n".encode())
    return digest.hexdigest()


def main() -> int:
    """Compare, or record."""
    record = sys.argv[1:2] == ["--record"]
    names = sys.argv[1 + record :]
    if not names or not SOURCES.keys() >= set(names):
        print(f"usage: unchanged.py [--record] {'|'.join(SOURCES)} ...", file=sys.stderr)
        return 2
    passed = json.loads(RECORDS.read_text(encoding="utf-8")) if RECORDS.exists() else {}
    today = {name: source_hash(SOURCES[name]) for name in names}
    if record:
        RECORDS.write_text(json.dumps(passed | today, indent=1, sort_keys=True) + "\n", encoding="utf-8")
        return 0
    return not passed.items() >= today.items()


if __name__ == "__main__":
    sys.exit(main())
