"""`wavesplat render`, also `--from` the document of a picture that is drawn again."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import typer

from wavesplat._cli.batches import Batch
from wavesplat._cli.options.figure import FigureOptions, MarkOptions, annotated, check_figure
from wavesplat._cli.options.groups import InputOrNone, Json, PictureOutput, Quiet, bits, option
from wavesplat._cli.options.layers import names_of_pictures, times_of
from wavesplat._cli.options.picture import PictureOptions
from wavesplat._cli.options.scene import ChosenScene, chosen_scene
from wavesplat._cli.options.view import camera_for, eye_arguments
from wavesplat._cli.printing import (
    check_outputs,
    is_terminal,
    print_notes,
    print_result,
    warnings_as_notes,
    with_paths,
    write_report,
)
from wavesplat._cli.several_inputs import takes_several_inputs
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._model.camera.camera import Camera
    from wavesplat._scene.scene import Scene

#: Place of the channel in the name of an output: a picture of each channel alone.
PLACE_OF_CHANNEL = "{channel}"


@dataclass(repr=False)
class FileOptions:
    """The picture that is drawn again, and the files that are written."""

    again: Path | None = option(
        "FILE",
        "Draw again, instead of INPUT: a scene, report, or PNG file that says how it was made; - is stdin.",
        "--from",
    )
    bits: int = bits()
    embed_scene: bool = option(help="Write the scene into a PNG file, for --from.", default=True)
    embed_paths: bool = option(
        None,
        "Write folders too into PNG files and reports, not names alone.",
        "--embed-paths/--no-embed-paths",
        default=False,
    )
    report: Path | None = option("FILE.json", "Write how the picture was made.")


@takes_several_inputs(".png", words=("channel", "time"))
def render(
    context: typer.Context,
    output: PictureOutput,
    input: InputOrNone = None,
    *,
    files: FileOptions,
    drawing: PictureOptions,
    figure: FigureOptions,
    batch: Batch | None = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw a picture of a volume and print its path."""
    if files.again is not None:
        _refuse_others(context)
        pictures = [output]
        made = [_drawn_again(files.again, output, files, drawing, figure=figure, quiet=quiet)]
    elif input is None:
        raise ArgumentError("INPUT is missing: name a volume, a file, folder or URL, or give --from")
    else:
        drawing.check()
        check_outputs(input, output, "pictures", files.report)
        _check_file(files, figure)
        batch = batch or Batch([input], is_quiet=quiet)
        pictures, made = _drawn_all(input, output, files, drawing, figure=figure, batch=batch, quiet=quiet)
    facts = made[0] if len(made) == 1 and (drawing.scene.opening.layering.times is None) else {"pictures": made}
    if files.report is not None:
        write_report(files.report, facts, embed_paths=files.embed_paths)
    print_result(
        with_paths(facts) if files.embed_paths else facts,
        "\n".join(map(str, pictures)),
        as_json=json,
        written=pictures[-1],
    )


def _check_file(files: FileOptions, figure: FigureOptions) -> None:
    from wavesplat._picture.picture import check_bits

    check_bits(files.bits)
    check_figure(figure)


def _drawn_all(
    input: str,
    output: Path,
    files: FileOptions,
    drawing: PictureOptions,
    *,
    figure: FigureOptions,
    batch: Batch,
    quiet: bool,
) -> tuple[list[Path], list[dict[str, Any]]]:
    """Draw and write the pictures of an input; return their paths, and the facts about each."""
    from wavesplat._cli import progress
    from wavesplat._scene.drawing.summary import stamped

    def choose(path: str, looks: Sequence[Look] | None, is_quiet: bool) -> ChosenScene:
        return chosen_scene(path, drawing.scene, quiet=is_quiet, looks=looks)

    size = drawing.sampling.size
    chosen = batch.chosen(input, choose, lambda one: _settled(one, drawing))
    planned = _pictures(chosen.scene, drawing.scene.opening.layering.times, input, output)
    camera = _camera([one.scene for one in planned], chosen.look, drawing)
    options = {"size": size, "composite": chosen.operator, **drawing.sampling.arguments()}
    options |= eye_arguments(drawing.eyes, chosen.unit)
    shown = not quiet and is_terminal()
    made, title = [], figure.marks.title
    for scene, path, label in planned:
        if title and len(planned) > 1:
            figure = replace(figure, marks=replace(figure.marks, title=stamped(title, scene)))

        def draw(report_progress: Any, scene: Scene = scene) -> Any:
            return scene.render(camera, progress=report_progress, **options)

        picture: Any = progress.run(draw, "drawing", shown=shown)
        if not quiet:
            print_notes(picture)
        picture = annotated(picture, figure, scene, quiet=quiet)
        batch.add(input, label if len(planned) > 1 else None, picture, scene.layers[0])
        picture.save(path, bits=files.bits, dpi=figure.dpi, scene=files.embed_scene, embed_paths=files.embed_paths)
        made.append({"picture": str(path), "size": list(picture.size), "input": input, "report": picture.report})
    return [one.path for one in planned], made


def _camera(scenes: Sequence[Scene], look: Look, drawing: PictureOptions) -> Camera:
    return camera_for(scenes, look, drawing.viewing, drawing.sampling.size, drawing.eyes)


def _settled(chosen: ChosenScene, drawing: PictureOptions) -> ChosenScene:
    """The scene with greys written out that else follow each view."""
    from wavesplat._movie.seen import with_settled_looks

    if all(layer.look is not None for layer in chosen.scene.layers):
        return chosen
    camera = _camera([chosen.scene], chosen.look, drawing)
    scene, _ = with_settled_looks(chosen.scene, chosen.operator, camera, drawing.sampling.size)
    first: Any = scene.layers[0].look
    return chosen._replace(scene=scene, look=first)


class _Planned(NamedTuple):
    """A picture to draw, its file, and its time and channel as text; empty for the only one."""

    scene: Scene
    path: Path
    label: str = ""


def _pictures(scene: Scene, times: str | None, input: str, output: Path) -> list[_Planned]:
    """The pictures of each time, and of each channel, that are asked for."""
    from wavesplat._model.volume.series import Series, time_texts

    planned = [_Planned(scene, output)]
    if times is not None:
        series = next((layer.volume for layer in scene.layers if isinstance(layer.volume, Series)), None)
        texts = ("0",) if series is None else time_texts(series.times, series.time_unit)
        planned = [
            _Planned(scene if series is None else scene.at_time(number), path, texts[number])
            for number, path in names_of_pictures(output, times_of(times, len(texts)), texts)
        ]
    if PLACE_OF_CHANNEL in output.name:
        planned = [channel for one in planned for channel in _of_channels(one)]
    if len(planned) > 1 or planned[0].path != output:
        for one in planned:
            check_outputs(input, one.path, "pictures")
    return planned


def _of_channels(planned: _Planned) -> list[_Planned]:
    """One picture for each layer, named after it, instead of one picture of all layers."""
    from wavesplat._mesh.mesh_files import safe_names

    layers = planned.scene.layers
    names = [layer.name or layer.drawn.name for layer in layers]
    made = []
    for layer, name, safe in zip(layers, names, safe_names(names, range(len(names))), strict=True):
        path = planned.path.with_name(planned.path.name.replace(PLACE_OF_CHANNEL, safe))
        label = ", ".join(text for text in (planned.label, name) if text)
        made.append(_Planned(planned.scene.with_(layers=[layer]), path, label))
    return made


# `--from`: a picture is drawn again, from the document in its file, in a report, or from a scene.

#: Parameters that may be given with `--from`: where the picture goes, which files may be read, and those that do not
#: change what is drawn.
BESIDE = {"context", "output", "threads", "device", "json", "quiet", "external_files"} | {
    one.name for kind in (FileOptions, FigureOptions, MarkOptions) for one in fields(kind) if one.name != "embed_scene"
}


def _drawn_again(
    path: Path, output: Path, files: FileOptions, drawing: PictureOptions, *, figure: FigureOptions, quiet: bool
) -> dict[str, Any]:
    """Draw the picture of the document in a file: a scene, a report, or a PNG file; "-" is the standard input."""
    from wavesplat._cli import progress
    from wavesplat._scene.documents import scene_files, scene_json

    check_outputs(str(path), output, "pictures", files.report)
    _check_file(files, figure)
    external_files = drawing.scene.opening.reader.external_files
    with warnings_as_notes(quiet=quiet):
        if str(path) == "-":
            document = scene_json.parse(sys.stdin.read(), Path.cwd(), external_files=external_files)
        else:
            document = scene_files.load(path, external_files=external_files)
    how: Any = {"threads": drawing.sampling.threads, "device": drawing.sampling.device, **document.options}

    def draw(report_progress: Any) -> Any:
        return document.scene.render(document.camera, progress=report_progress, **how)

    with warnings_as_notes(quiet=quiet):
        picture = progress.run(draw, "drawing", shown=not quiet and is_terminal())
    if not quiet:
        print_notes(picture)
    if document.figure and figure == FigureOptions():
        picture = picture.annotated(**document.figure)
    picture = annotated(picture, figure, document.scene, quiet=quiet)
    picture.save(output, bits=files.bits, dpi=figure.dpi, embed_paths=files.embed_paths)
    return {"picture": str(output), "size": list(picture.size), "input": str(path), "report": picture.report}


def _refuse_others(context: typer.Context) -> None:
    """Raise an `ArgumentError` for other options: the document has what they would set."""
    given = [
        parameter
        for parameter in context.command.params
        if parameter.name not in BESIDE
        and getattr(context.get_parameter_source(parameter.name or ""), "name", "") == "COMMANDLINE"
    ]
    if given:
        names = ", ".join("INPUT" if one.name == "input" else one.opts[0] for one in given)
        raise ArgumentError(f"{names}: --from has all that is drawn; leave out either it or them")
