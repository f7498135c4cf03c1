"""`wavesplat render --from`: draw a picture again, from the document in its file, in a report, or from a scene."""

from __future__ import annotations

import sys
from dataclasses import fields
from pathlib import Path
from typing import Any

import typer

from wavesplat._cli.figure_options import FigureOptions, annotated, check_figure
from wavesplat._cli.outputs import check_outputs, with_paths, write_report
from wavesplat._cli.printing import is_terminal, print_notes, print_result, warnings_as_notes
from wavesplat.errors import ArgumentError

__all__ = ["draw_from"]

#: Parameters that may be given with `--from`: where the picture goes, which files may be read, and those that do not
#: change what is drawn.
BESIDE = {
    "context",
    "again",
    "output",
    "bits",
    "threads",
    "device",
    "report",
    "json",
    "quiet",
    "external_files",
    "embed_paths",
}


def draw_from(
    context: typer.Context,
    path: Path,
    output: Path,
    *,
    figure: FigureOptions,
    bits: int,
    threads: int | None,
    device: str,
    external_files: bool,
    embed_paths: bool,
    report: Path | None,
    json: bool,
    quiet: bool,
) -> None:
    """Draw the picture of the document in a file: a scene, a report, or a PNG file; "-" is the standard input."""
    from wavesplat._cli import progress
    from wavesplat._picture.picture import check_bits
    from wavesplat._scene import scene_files, scene_json

    _refuse_others(context)
    check_outputs(str(path), output, "pictures", report)
    check_bits(bits)
    check_figure(figure)
    with warnings_as_notes(quiet=quiet):
        if str(path) == "-":
            document = scene_json.parse(sys.stdin.read(), Path.cwd(), external_files=external_files)
        else:
            document = scene_files.load(path, external_files=external_files)

    def draw(told: Any) -> Any:
        return document.scene.render(document.camera, threads=threads, device=device, progress=told, **document.options)

    with warnings_as_notes(quiet=quiet):
        picture = progress.run(draw, "drawing", shown=not quiet and is_terminal())
    if not quiet:
        print_notes(picture)
    if document.figure and figure == FigureOptions():
        picture = picture.annotated(**document.figure)
    annotated(picture, figure, document.scene, quiet=quiet).save(
        output, bits=bits, dpi=figure.dpi, embed_paths=embed_paths
    )
    facts = {"picture": str(output), "size": list(picture.size), "input": str(path), "report": picture.report}
    if report is not None:
        write_report(report, facts, embed_paths=embed_paths)
    print_result(with_paths(facts) if embed_paths else facts, output, as_json=json, written=output)


def _refuse_others(context: typer.Context) -> None:
    """Raise an `ArgumentError` for other options: the document has what they would set."""
    may_be = BESIDE | {field.name for field in fields(FigureOptions)}
    given = [
        parameter
        for parameter in context.command.params
        if parameter.name not in may_be
        and getattr(context.get_parameter_source(parameter.name or ""), "name", "") == "COMMANDLINE"
    ]
    if given:
        names = ", ".join("INPUT" if one.name == "input" else one.opts[0] for one in given)
        raise ArgumentError(f"{names}: --from has all that is drawn; leave out either it or them")
