"""`wavesplat render`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from wavesplat._cli.batches import Batch
from wavesplat._cli.crop_options import CutOptions, takes_cut_options
from wavesplat._cli.eye_options import EyeOptions, eye_arguments, takes_eye_options
from wavesplat._cli.figure_options import FigureOptions, annotated, check_figure, takes_figure_options
from wavesplat._cli.from_document import draw_from
from wavesplat._cli.layer_options import LayerOptions, names_of_pictures, takes_layer_options, times_of
from wavesplat._cli.light_options import LightOptions, takes_light_options
from wavesplat._cli.outputs import check_outputs, with_paths, write_report
from wavesplat._cli.printing import is_terminal, print_notes, print_result
from wavesplat._cli.processing_options import ProcessingOptions, takes_processing_options
from wavesplat._cli.reader_options import InputOrNone, ReaderOptions, takes_reader_options_but_channel
from wavesplat._cli.sampling_options import SamplingOptions, drawing_arguments, takes_sampling_options
from wavesplat._cli.scene_options import (
    ChosenScene,
    SceneOptions,
    check_scene_options,
    chosen_scene,
    takes_scene_options,
)
from wavesplat._cli.several_inputs import takes_several_inputs
from wavesplat._cli.shared_options import Bits, Json, PictureOutput, Quiet, Size
from wavesplat._cli.transfer_function_options import ColorOptions, takes_color_options
from wavesplat._cli.view_options import ViewOptions, camera_for, check_view_options, takes_view_options
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._looks.look import Look
    from wavesplat._model.camera import Camera
    from wavesplat._scene.scene import Scene

__all__ = ["render"]

#: Place of the channel in the name of an output: a picture of each channel alone.
PLACE_OF_CHANNEL = "{channel}"


@takes_several_inputs(".png", words=("channel", "time"))
@takes_figure_options
@takes_cut_options
@takes_light_options
@takes_reader_options_but_channel
@takes_layer_options
@takes_color_options
@takes_processing_options
@takes_sampling_options
@takes_scene_options
@takes_eye_options
@takes_view_options
def render(
    context: typer.Context,
    output: PictureOutput,
    input: InputOrNone = None,
    *,
    again: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="FILE",
            help="Draw again, instead of INPUT: a scene, report, or PNG file that says how it was made; - is stdin.",
        ),
    ] = None,
    layering: LayerOptions,
    showing: SceneOptions,
    colors: ColorOptions,
    viewing: ViewOptions,
    eyes: EyeOptions,
    size: Size = "512x512",
    sampling: SamplingOptions,
    cuts: CutOptions,
    lighting: LightOptions,
    bits: Bits = 8,
    figure: FigureOptions,
    embed_scene: Annotated[
        bool, typer.Option("--embed-scene/--no-embed-scene", help="Write the scene into a PNG file, for --from.")
    ] = True,
    embed_paths: Annotated[
        bool,
        typer.Option(
            "--embed-paths/--no-embed-paths", help="Write folders too into PNG files and reports, not names alone."
        ),
    ] = False,
    report: Annotated[Path | None, typer.Option(metavar="FILE.json", help="Write how the picture was made.")] = None,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    batch: Batch | None = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw a picture of a volume and print its path."""
    if again is not None:
        how: Any = {"figure": figure, "bits": bits, "report": report, "json": json, "quiet": quiet}
        how |= {"threads": sampling.threads, "device": sampling.device, "external_files": reader.external_files}
        how["embed_paths"] = embed_paths
        draw_from(context, again, output, **how)
        return
    if input is None:
        raise ArgumentError("INPUT is missing: name a volume, a file, folder or URL, or give --from")
    check_scene_options(showing, colors, cuts)
    check_view_options(viewing)
    of_eyes = eye_arguments(eyes)
    check_outputs(input, output, "pictures", report)
    from wavesplat._picture.picture import check_bits

    check_bits(bits)
    check_figure(figure)

    def choose(path: str, looks: Sequence[Look] | None, is_quiet: bool) -> ChosenScene:
        return chosen_scene(
            path,
            showing,
            colors=colors,
            layering=layering,
            cuts=cuts,
            lighting=lighting,
            reader=reader,
            processing=processing,
            quiet=is_quiet,
            looks=looks,
        )

    batch = batch or Batch([input], is_quiet=quiet)
    chosen = batch.chosen(input, choose, lambda one: _settled(one, viewing, size, eyes))
    scene, look, operator = chosen.scene, chosen.look, chosen.operator
    pictures = _pictures(scene, layering.times, input, output)
    camera = camera_for([one.scene for one in pictures], look, viewing, size, eyes)
    made = _drawn_all(
        pictures,
        camera,
        input,
        figure=figure,
        bits=bits,
        embed_scene=embed_scene,
        embed_paths=embed_paths,
        batch=batch,
        quiet=quiet,
        size=size,
        composite=operator,
        **of_eyes,
        **drawing_arguments(sampling),
    )
    facts = made[0] if layering.times is None and len(made) == 1 else {"pictures": made}
    if report is not None:
        write_report(report, facts, embed_paths=embed_paths)
    print_result(
        with_paths(facts) if embed_paths else facts,
        "\n".join(str(one.path) for one in pictures),
        as_json=json,
        written=pictures[-1].path,
    )


def _settled(chosen: ChosenScene, viewing: ViewOptions, size: tuple[int, int], eyes: EyeOptions) -> ChosenScene:
    """The scene with greys written out that else follow each view."""
    from wavesplat._movie.seen import with_settled_looks

    if all(layer.look is not None for layer in chosen.scene.layers):
        return chosen
    camera = camera_for([chosen.scene], chosen.look, viewing, size, eyes)
    scene, _ = with_settled_looks(chosen.scene, chosen.operator, camera, size)
    first: Any = scene.layers[0].look
    return chosen._replace(scene=scene, look=first)


class _Planned(NamedTuple):
    """A picture to draw, its file, and its time and channel as text; empty for the only one."""

    scene: Scene
    path: Path
    told: str = ""


def _pictures(scene: Scene, times: str | None, input: str, output: Path) -> list[_Planned]:
    """The pictures of each time, and of each channel, that are asked for."""
    from wavesplat._model.series import Series
    from wavesplat._model.time_stamps import time_texts

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
    from wavesplat._mesh.safe_names import safe_names

    layers = planned.scene.layers
    names = [layer.name or layer.drawn.name for layer in layers]
    made = []
    for layer, name, safe in zip(layers, names, safe_names(names, range(len(names))), strict=True):
        path = planned.path.with_name(planned.path.name.replace(PLACE_OF_CHANNEL, safe))
        told = ", ".join(text for text in (planned.told, name) if text)
        made.append(_Planned(planned.scene.with_(layers=[layer]), path, told))
    return made


def _drawn_all(
    pictures: Sequence[_Planned],
    camera: Camera,
    input: str,
    *,
    figure: FigureOptions,
    bits: int,
    embed_scene: bool,
    embed_paths: bool,
    batch: Batch,
    quiet: bool,
    **options: Any,
) -> list[dict[str, Any]]:
    """Draw and write pictures; return the facts about each."""
    from wavesplat._scene.summary import stamped

    made, title = [], figure.title
    for scene, path, told in pictures:
        if title and len(pictures) > 1:
            figure = replace(figure, title=stamped(title, scene))
        picture = _drawn(scene, camera, shown=not quiet and is_terminal(), **options)
        if not quiet:
            print_notes(picture)
        picture = annotated(picture, figure, scene, quiet=quiet)
        batch.add(input, told if len(pictures) > 1 else None, picture, scene.layers[0])
        picture.save(path, bits=bits, dpi=figure.dpi, scene=embed_scene, embed_paths=embed_paths)
        made.append({"picture": str(path), "size": list(picture.size), "input": input, "report": picture.report})
    return made


def _drawn(scene: Scene, camera: Camera, *, shown: bool, **options: Any) -> Any:
    """Draw a picture, with a progress bar if `shown`; Ctrl-C stops it."""
    from wavesplat._cli import progress

    return progress.run(lambda report: scene.render(camera, progress=report, **options), "drawing", shown=shown)
