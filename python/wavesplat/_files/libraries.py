"""Optional libraries, which only some functions need."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from wavesplat.errors import LibraryError


def library(name: str, *, extra: str) -> Any:
    """The module, or a `LibraryError` that names the extra of the package that installs it."""
    try:
        return import_module(name)
    except ImportError as error:
        missing = (error.name or name).partition(".")[0]
        raise LibraryError(f"{missing} is not installed; {how_to_install(extra)}") from error


def how_to_install(extra: str) -> str:
    """The end of a message about a missing package: the command that installs what an extra has.

    Where Wavesplat is installed, from a wheel or from a checkout, pip finds it there and adds only what is missing.
    Where its modules are run as they lie, pip would look for the name where packages are published.
    """
    from importlib import metadata

    try:
        metadata.version("wavesplat")
    except metadata.PackageNotFoundError:
        return f'in the checkout of Wavesplat, run: pip install ".[{extra}]"'
    return f'run: pip install "wavesplat[{extra}]"'
