"""Docstrings and source links of the reference of Python, as Sphinx needs them.

Public classes and functions name `wavesplat` as their module, and Sphinx would look for their source there. Docstrings
are written for `help`, where long lists of names are wrapped, and a `*` is one.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

import wavesplat

#: Quoted patterns of file names, such as "organs/*.nii.gz".
QUOTED_PATTERN = re.compile(r'"[^"]*\*[^"]*"')


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect to Sphinx, before docstrings are parsed."""
    app.connect("autodoc-process-docstring", mend_docstring, priority=100)
    app.connect("viewcode-follow-imported", home_of)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def home_of(_app: Sphinx, module: str, name: str) -> str | None:
    """The module that a public name is defined in; None where it is defined where it says.

    module, name : as `wavesplat` and `Volume.save`.
    """
    home = wavesplat._HOMES.get(name.partition(".")[0]) if module == "wavesplat" else None
    return f"wavesplat.{home}" if home else None


def mend_docstring(_app: Sphinx, _kind: str, _name: str, _thing: Any, _options: Any, lines: list[str]) -> None:
    """Join wrapped lists of names, and escape asterisks of patterns, in the lines of a docstring."""
    mended: list[str] = []
    for line in lines:
        if mended and mended[-1].endswith(",") and not mended[-1].startswith(" "):
            mended[-1] += f" {line.strip()}"
        else:
            mended.append(line)
    lines[:] = [line if line.lstrip().startswith((">>>", "...")) else _escaped(line) for line in mended]


def _escaped(line: str) -> str:
    return QUOTED_PATTERN.sub(lambda found: found.group().replace("*", r"\*"), line)
