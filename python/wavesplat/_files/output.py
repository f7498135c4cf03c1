"""What can be written where, and files that appear whole or not at all.

A file is written beside its place under another name, then moved there.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Literal, TypeAlias

from wavesplat.errors import FileError

__all__ = ["SUFFIXES", "Kind", "check_output", "check_writable", "write_atomically"]

Kind: TypeAlias = Literal["pictures", "meshes", "wavelet coefficients"]

#: What each kind of result is written as; the suffix chooses the format.
SUFFIXES: dict[Kind, tuple[str, ...]] = {
    "pictures": (".png", ".tif", ".tiff", ".exr"),
    "meshes": (".ply", ".stl", ".obj", ".glb", ".gltf"),
    "wavelet coefficients": (".wavelets",),
}


def check_output(path: str | PathLike[str], kind: Kind) -> str:
    """The suffix in lower case, if a result of this kind can be written there; else a `FileError`."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES[kind]:
        given = f"as {suffix}" if suffix else "to a name without a suffix"
        raise FileError(f"cannot write {kind} {given}; use one of: {', '.join(SUFFIXES[kind])}: {path}")
    check_writable(path)
    return suffix


def check_writable(path: str | PathLike[str]) -> Path:
    """The path, if a file can be written there; else a `FileError`."""
    target = Path(path)
    folder = target.parent
    if not folder.is_dir():
        raise FileError(f"cannot write: the folder does not exist; make it first, or change the name: {target}")
    if target.is_dir():
        raise FileError(f"cannot write: this is a folder; add a file name to it: {target}")
    if target.exists() and not target.is_file():
        raise FileError(
            f"cannot write: this is a device or a pipe, which cannot be replaced whole; name a file: {target}"
        )
    if not os.access(folder, os.W_OK):
        raise FileError(f"cannot write: no permission in its folder; choose another folder: {target}")
    return target


def write_atomically(path: str | PathLike[str], write: Callable[[Path], object]) -> None:
    """Let `write` fill a new file beside `path`, then put it in place; on failure nothing is left.

    The new file has the same suffix, since some libraries choose the format by it.
    """
    target = check_writable(path)
    part = target.with_name(f".{target.stem}.{os.getpid()}.part{target.suffix}")
    try:
        write(part)
        part.replace(target)
    except OSError as error:
        raise FileError(
            f"cannot write: {error.strerror or error}; free some space or choose another folder: {target}"
        ) from error
    finally:
        part.unlink(missing_ok=True)
