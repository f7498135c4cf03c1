"""`wavesplat movie`."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from wavesplat._cli.crop_options import CutOptions, takes_cut_options
from wavesplat._cli.eye_options import EyeOptions, eye_arguments, takes_eye_options
from wavesplat._cli.figure_options import FigureOptions, check_figure, marks_of, takes_frame_figure_options
from wavesplat._cli.layer_options import LayerOptions, takes_layer_options, times_of
from wavesplat._cli.light_options import LightOptions, takes_light_options
from wavesplat._cli.outputs import check_outputs
from wavesplat._cli.printing import is_terminal, message, print_result
from wavesplat._cli.processing_options import ProcessingOptions, takes_processing_options
from wavesplat._cli.reader_options import Input, ReaderOptions, takes_reader_options_but_channel
from wavesplat._cli.sampling_options import SamplingOptions, drawing_arguments, takes_sampling_options
from wavesplat._cli.scene_options import (
    ChosenScene,
    SceneOptions,
    check_scene_options,
    chosen_scene,
    takes_scene_options,
    unit_of,
)
from wavesplat._cli.shared_options import Json, Quiet, Size
from wavesplat._cli.slice_input import FirstLayers, first_layers
from wavesplat._cli.transfer_function_options import ColorOptions, takes_color_options
from wavesplat._cli.view_options import (
    ViewOptions,
    camera_for,
    check_view_options,
    given_camera,
    takes_view_options,
)
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.camera import Camera
    from wavesplat._movie.key_frame import KeyFrame
    from wavesplat._movie.turn import Turn
    from wavesplat._scene.scene import Scene

EXIT_INTERRUPTED = 130
#: Frames of a turn by default: four seconds.
TURN = 120
#: Pixels of a frame of a volume by default; a film has its own.
DEFAULT_SIZE = (512, 512)


@takes_frame_figure_options
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
def movie(
    input: Input,
    output: Annotated[
        Path,
        typer.Option(
            "--output",
            "-o",
            metavar="OUT",
            help="Movie to write: .mp4, .webm, .gif or .webp; or a folder, or a name such as %04d.png, for a PNG file "
            "of each frame.",
            show_default=False,
        ),
    ],
    *,
    turn: Annotated[
        int | None,
        typer.Option(
            metavar="FRAMES",
            help=f"A turn of so many frames, at one scale, with --times through the times; {TURN} without them.",
        ),
    ] = None,
    degrees: Annotated[float, typer.Option(metavar="DEG", help="How far it turns; less than 0: to the right.")] = 360.0,
    fps: Annotated[
        float | None,
        typer.Option(metavar="N", help="Frames a second; 30 if not given, and of a film its own."),
    ] = None,
    crf: Annotated[
        int | None,
        typer.Option(metavar="N", help="Of .mp4 (18) and .webm (24): less loses less, in a larger file."),
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Keep PNG files that are there and show the same.")] = False,
    layering: LayerOptions,
    showing: SceneOptions,
    colors: ColorOptions,
    viewing: ViewOptions,
    eyes: EyeOptions,
    size: Size = "512x512",
    sampling: SamplingOptions,
    cuts: CutOptions,
    lighting: LightOptions,
    figure: FigureOptions,
    reader: ReaderOptions,
    processing: ProcessingOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw a movie of a volume, a turn, all time points or both, or of a film, and print its path."""
    check_scene_options(showing, colors, cuts)
    check_view_options(viewing)
    of_eyes = eye_arguments(eyes)
    check_figure(figure)
    from wavesplat._cli import progress
    from wavesplat._movie.movie import FPS, check_movie
    from wavesplat._movie.movie import movie as make
    from wavesplat._movie.turn import Turn
    from wavesplat._readers.request import PictureError

    round_trip = None if turn is None and layering.times is not None else Turn(TURN if turn is None else turn, degrees)
    rate = FPS if fps is None else fps
    pattern = check_movie(output, fps=rate, crf=crf, resume=resume)
    if pattern is None:
        check_outputs(input, output, "movies")
    try:
        chosen = chosen_scene(
            input,
            showing,
            colors=colors,
            layering=layering,
            cuts=cuts,
            lighting=lighting,
            reader=reader,
            processing=processing,
            quiet=quiet,
        )
    except PictureError as error:
        if error.n_times == 1 or turn is not None:
            raise
        first = first_layers(
            input,
            reader,
            layering.channel,
            look=showing,
            colors=colors,
            processing=processing,
            is_alone=True,
            all_times=True,
            quiet=quiet,
        )
        shown = _film(first, showing, colors, layering.times, size=size, fps=fps)
        shown.arguments["threads"] = sampling.threads
    else:
        along = _along(chosen, round_trip, layering.times, viewing, size=size, fps=rate, eyes=eyes)
        shown = _Shown(chosen.scene, along, chosen.look.name, chosen.look.reason, rate, size)
        shown.arguments |= drawing_arguments(sampling) | {"composite": chosen.operator, **of_eyes}
        if sampling.quality is None and sampling.sheets_per_slice is None and sampling.oversampling is None:
            shown.arguments["quality"] = None
    try:
        with progress.bar("drawing", shown=not quiet and is_terminal()) as told:
            make(
                shown.scene,
                output,
                shown.along,
                fps=shown.fps,
                size=shown.size,
                crf=crf,
                resume=resume,
                progress=told,
                **shown.arguments,
                **marks_of(figure, unit_of(shown.scene), quiet=quiet),
            )
    except KeyboardInterrupt:
        if pattern is None:
            raise
        message("interrupted; the frames that are done stay, and --resume goes on with them")
        raise SystemExit(EXIT_INTERRUPTED) from None
    n = shown.along.frames if isinstance(shown.along, Turn) else len(shown.along)
    facts: dict[str, Any] = {"movie": str(pattern or output), "frames": n}
    facts |= {"fps": shown.fps, "size": list(shown.size), "input": input}
    facts["look"] = {"name": shown.look, "reason": shown.reason}
    print_result(facts, str(pattern or output), as_json=json, written=output)


@dataclass
class _Shown:
    """The scene of a movie, the look to report, and further arguments of `wavesplat.movie`."""

    scene: Scene
    along: list[KeyFrame] | list[Camera] | Turn
    look: str
    reason: str
    fps: float
    size: tuple[int, int]
    arguments: dict[str, Any] = field(default_factory=dict)


def _film(
    first: FirstLayers,
    showing: SceneOptions,
    colors: ColorOptions,
    times: str | None,
    *,
    size: tuple[int, int],
    fps: float | None,
) -> _Shown:
    """The frames of a film, in its own size and at its own rate where no others are given."""
    from wavesplat._looks.transfer_function import TransferFunction
    from wavesplat._movie.films import film_frame, film_of, rate_of
    from wavesplat._movie.key_frame import KeyFrame
    from wavesplat._movie.movie import FPS
    from wavesplat._render import windows
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.scene import Scene

    look = first.transfer_function
    if first.is_grey and (colors.window or colors.clim):
        low, high = windows.limits(first.volume, colors.window, colors.clim)
        look = TransferFunction.from_colormap("gray", clim=(low, high), opacity=1)
    layers = first.layers if isinstance(first.layers[0], Layer) else [Layer(first.layers[0], look)]
    scene = Scene(layers, background=showing.background or "black")
    film = film_of(scene)
    assert film is not None
    numbers = range(len(film)) if times is None else times_of(times, len(film))
    along = [KeyFrame(float(k), time=number) for k, number in enumerate(numbers)]
    own = film_frame(scene).size if size == DEFAULT_SIZE else size
    return _Shown(scene, along, "film", "a film, as it is", fps or rate_of(film) or FPS, own)


def _along(
    chosen: ChosenScene,
    turn: Turn | None,
    times: str | None,
    viewing: ViewOptions,
    *,
    size: tuple[int, int],
    fps: float,
    eyes: EyeOptions,
) -> list[KeyFrame] | list[Camera] | Turn:
    """A turn, through the times if any are given, or a key frame for each of them."""
    from wavesplat._movie.key_frame import KeyFrame
    from wavesplat._movie.turn import key_frames, turned_in_place

    numbers = None if times is None else _numbers(chosen, times)
    if turn is not None and eyes.eye is not None:
        scenes = [chosen.scene] if numbers is None else [chosen.scene.at_time(number) for number in numbers]
        turn = replace(turn, times=numbers)
        cameras = turned_in_place(turn, camera_for(scenes, chosen.look, viewing, size, eyes))
        return cameras if numbers is None else key_frames(turn, cameras, fps)
    if turn is not None:
        turn = replace(turn, times=numbers)
        camera = given_camera(viewing)
        if camera is not None:
            return replace(turn, start=camera)
        azimuth, elevation = viewing.azimuth, viewing.elevation
        is_turned = azimuth is not None or elevation is not None
        return replace(
            turn,
            start=viewing.view or chosen.look.view or ("anterior" if is_turned else None),
            azimuth=azimuth or 0.0,
            elevation=elevation or 0.0,
            zoom=viewing.zoom,
            view_angle=viewing.perspective,
        )
    assert numbers is not None
    camera = camera_for([chosen.scene.at_time(number) for number in numbers], chosen.look, viewing, size, eyes)
    return [KeyFrame(k / fps, camera=camera, time=number) for k, number in enumerate(numbers)]


def _numbers(chosen: ChosenScene, times: str) -> list[int]:
    """The time points that `--times` names."""
    from wavesplat._model.series import Series

    series = next((layer.volume for layer in chosen.scene.layers if isinstance(layer.volume, Series)), None)
    if series is None:
        raise ArgumentError("--times makes a movie of time points, and the file holds one; leave it out for a turn")
    return times_of(times, len(series))
