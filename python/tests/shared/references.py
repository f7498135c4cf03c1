"""Converged pictures that take minutes to draw: kept as files, and drawn anew where the ray caster has changed."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[3]
FOLDER = Path(__file__).parents[1] / "fixtures" / "references"
#: The sources of references; the file beside the pictures has the hash of those that they were drawn with.
SOURCES = ("crates/study/src", "crates/core/src")
HASH_FILE = FOLDER / "sources.sha256"
REMEDY = "`python python/tools/make_references.py` draws them anew; commit them with the reason for the change"
#: Pictures are kept in twelve bits a colour. The rounding has a PSNR of 83 dB, thresholds of tests end at 50 dB.
TOP = 4095
#: The least PSNR of a kept picture against the same picture drawn now.
LEAST_DB = 75


def hash_of_sources() -> str:
    """Hash names and contents of the files that draw references; some milliseconds."""
    found = hashlib.sha256()
    for folder in SOURCES:
        files = sorted((ROOT / folder).rglob("*.rs"))
        assert files, f"{folder} has no Rust files; tell {__file__} where the ray caster is now"
        for path in files:
            found.update(f"{path.relative_to(ROOT).as_posix()}\0".encode() + path.read_bytes())
    return found.hexdigest()


def levels_of(picture: np.ndarray) -> np.ndarray:
    """Red, green and blue in twelve bits."""
    return np.rint(np.clip(picture[..., :3], 0, 1) * TOP).astype(np.uint16)


class References:
    """The references of a run of tests.

    They are "kept": read from files, and drawn where they are missing. They are "compared", with those drawn now, at
    night, when none may be missing, and where the sources have another hash. They are "made" by
    `python/tools/make_references.py`: drawn now and written.
    """

    def __init__(self, way: str) -> None:
        self.may_be_missing = way == "kept"
        if way == "kept" and hash_of_sources() != HASH_FILE.read_text(encoding="ascii").strip():
            way = "compared"
        self.way = way
        self._files: dict[str, dict[str, np.ndarray]] = {}

    def picture(self, file: str, name: str, draw: Callable[[], np.ndarray]) -> np.ndarray:
        """Red, green and blue of the reference `name`, [y, x, channel] from 0 to 1, which `draw` draws."""
        if self.way == "made":
            levels = levels_of(draw())
            assert self._files.setdefault(file, {}).setdefault(name, levels) is levels, f"{name} is drawn twice"
            self._write(file)
            return levels / TOP
        if file not in self._files:
            with np.load(FOLDER / f"{file}.npz") as pictures:
                self._files[file] = {key: np.cumsum(pictures[key], axis=1, dtype=np.uint16) for key in pictures}
        if name not in self._files[file]:
            if not self.may_be_missing:
                pytest.fail(f"there is no reference {name!r} of {file}; {REMEDY}")
            self._files[file][name] = levels_of(draw())
        kept = self._files[file][name] / TOP
        if self.way == "compared":
            error = np.mean((kept - draw()[..., :3]) ** 2)
            if error > 10 ** (-LEAST_DB / 10):
                found_db = -10 * np.log10(error)
                pytest.fail(f"the reference {name!r} of {file} has changed: PSNR {found_db:.1f} dB; {REMEDY}")
        return kept

    def _write(self, file: str) -> None:
        """Write what was made so far, as differences of neighbours, which are packed better than values."""
        FOLDER.mkdir(exist_ok=True)
        rows = {name: np.diff(levels, axis=1, prepend=np.uint16(0)) for name, levels in self._files[file].items()}
        np.savez_compressed(FOLDER / f"{file}.npz", **rows)
        HASH_FILE.write_text(hash_of_sources() + "\n", encoding="ascii")
