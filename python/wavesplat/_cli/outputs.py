"""Checks of output paths before the work, so that nothing is made that cannot be kept; and reports."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from wavesplat._cli.printing import json_text
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._files.output import Kind

__all__ = ["check_outputs", "with_paths", "write_report"]


def check_outputs(
    input: str, output: Path, kind: Kind, report: Path | None = None, *, option: str = "--output"
) -> None:
    """Raise if a result cannot be written, or would replace the input or another result. `option`: of the output."""
    from wavesplat._files.output import check_output, check_writable
    from wavesplat._files.paths import expanded, real_path

    check_output(output, kind)
    places = {"INPUT": expanded(input), option: output}
    if report is not None:
        check_writable(report)
        places["--report"] = report
    owners: dict[Path, str] = {}
    for name, path in places.items():
        owner = owners.setdefault(real_path(path), name)
        if owner != name:
            raise ArgumentError(f"{owner} and {name} are the same file, which would be lost; change a name: {path}")


def with_paths(facts: dict[str, Any]) -> dict[str, Any]:
    """The facts about a result with the whole paths of its volumes."""
    from wavesplat._model.private_names import whole

    found: dict[str, Any] = whole(facts)
    return found


def write_report(path: Path, facts: dict[str, Any], *, embed_paths: bool) -> None:
    """Write the facts about a result to a JSON file, with paths or with names of files alone."""
    from wavesplat._files.output import write_atomically
    from wavesplat._model.private_names import without_folders

    if embed_paths:
        facts = with_paths(facts)
    else:
        # So that `picture` and `input` are treated as the paths in the scene are.
        named = without_folders({name: {"path": facts[name]} for name in ("picture", "input") if name in facts})
        facts = {**without_folders(facts), **{name: one["path"] for name, one in named.items()}}
    write_atomically(path, lambda part: part.write_text(json_text(facts) + "\n", encoding="utf-8"))
