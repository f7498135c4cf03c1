"""Optional libraries, which only some functions need."""

from __future__ import annotations

import re
from importlib import import_module, metadata
from typing import Any

from wavesplat.errors import LibraryError

__all__ = ["how_to_install", "library"]


def library(name: str, *, extra: str) -> Any:
    """The module, or a `LibraryError` that names the extra of the package that installs it."""
    try:
        return import_module(name)
    except ImportError as error:
        missing = (error.name or name).partition(".")[0]
        raise LibraryError(f"{missing} is not installed; {how_to_install(extra)}") from error


def how_to_install(extra: str) -> str:
    """The end of a message about a missing package: the commands that install what an extra has.

    The packages are named too, since whoever installed a wheel has no checkout, and the name of ours is not taken yet.
    """
    packages = _packages_of(extra)
    first = f"run: pip install {packages}, or " if packages else ""
    return f'{first}in the checkout of Wavesplat: pip install ".[{extra}]"'


def _packages_of(extra: str) -> str:
    """The packages of an extra, quoted for a shell, by the metadata of the installed package; "" where it has none."""
    try:
        needed = metadata.requires("wavesplat") or []
    except metadata.PackageNotFoundError:
        return ""
    parts = (one.partition(";") for one in needed)
    own = [name.strip() for name, _, when in parts if re.fullmatch(rf"\s*extra\s*==\s*['\"]{extra}['\"]\s*", when)]
    return " ".join(f'"{name}"' for name in own)
