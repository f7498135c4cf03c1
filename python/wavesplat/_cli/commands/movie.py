"""`wavesplat movie`."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from wavesplat._cli.options.figure import MarkOptions, check_marks, marks_of
from wavesplat._cli.options.groups import Input, Json, Quiet, option, output
from wavesplat._cli.options.layers import times_of
from wavesplat._cli.options.opened_layers import first_layers
from wavesplat._cli.options.picture import PictureOptions
from wavesplat._cli.options.scene import ChosenScene, chosen_scene
from wavesplat._cli.options.view import camera_for, eye_arguments, given_camera, unit_of
from wavesplat._cli.printing import check_outputs, is_terminal, message, print_result
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from wavesplat._model.camera.camera import Camera
    from wavesplat._movie.key_frame import KeyFrame
    from wavesplat._movie.turn import Turn
    from wavesplat._scene.scene import Scene

EXIT_INTERRUPTED = 130
#: Frames of a turn by default: four seconds.
TURN = 120
#: Pixels of a frame of a volume by default; a film has its own.
DEFAULT_SIZE = (512, 512)


@dataclass(repr=False)
class MovieOptions:
    """Options of a movie's course and file."""

    turn: int | None = option(
        "FRAMES", f"Frames of a turn, at one scale, with --times through the times; {TURN} without them."
    )
    degrees: float = option("DEG", "How far it turns; less than 0: to the right.", default=360.0)
    fps: float | None = option("N", "Frames a second; 30 if not given, and of a film its own.")
    crf: int | None = option("N", "Of .mp4 (18) and .webm (24): less loses less, in a larger file.")
    resume: bool = option(help="Keep PNG files that are there and show the same.", default=False)


def movie(
    input: Input,
    output: Annotated[
        Path,
        output(
            "Movie to write: .mp4, .webm, .gif or .webp; or a folder, or a name such as %04d.png, for a PNG file of "
            "each frame."
        ),
    ],
    *,
    course: MovieOptions,
    drawing: PictureOptions,
    marks: MarkOptions,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Draw a movie of a volume, a turn, all time points or both, or of a film, and print its path."""
    drawing.check()
    check_marks(marks)
    from wavesplat._cli import progress
    from wavesplat._movie.movie import FPS, check_movie
    from wavesplat._movie.movie import movie as make
    from wavesplat._movie.turn import Turn
    from wavesplat._readers.request import PictureError

    turn = None
    if course.turn is not None or drawing.scene.opening.layering.times is None:
        turn = Turn(TURN if course.turn is None else course.turn, course.degrees)
    rate = FPS if course.fps is None else course.fps
    pattern = check_movie(output, fps=rate, crf=course.crf, resume=course.resume)
    if pattern is None:
        check_outputs(input, output, "movies")
    try:
        shown = _of_volume(input, turn, drawing, fps=rate, quiet=quiet)
    except PictureError as error:
        if error.n_times == 1 or course.turn is not None:
            raise
        shown = _film(input, drawing, fps=course.fps, quiet=quiet)
    try:
        with progress.bar("drawing", shown=not quiet and is_terminal()) as report_progress:
            make(
                shown.scene,
                output,
                shown.along,
                fps=shown.fps,
                size=shown.size,
                crf=course.crf,
                resume=course.resume,
                progress=report_progress,
                **shown.arguments,
                **marks_of(marks, unit_of(shown.scene), quiet=quiet),
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


def _of_volume(input: str, turn: Turn | None, drawing: PictureOptions, *, fps: float, quiet: bool) -> _Shown:
    chosen, sampling = chosen_scene(input, drawing.scene, quiet=quiet), drawing.sampling
    along = _along(chosen, turn, drawing, fps=fps)
    shown = _Shown(chosen.scene, along, chosen.look.name, chosen.look.reason, fps, sampling.size)
    shown.arguments |= sampling.arguments() | {"composite": chosen.operator}
    shown.arguments |= eye_arguments(drawing.eyes, chosen.unit)
    if sampling.quality is None and sampling.sheets_per_slice is None and sampling.oversampling is None:
        shown.arguments["quality"] = None
    return shown


def _film(input: str, drawing: PictureOptions, *, fps: float | None, quiet: bool) -> _Shown:
    """The frames of a film, in its own size and at its own rate where no others are given."""
    from wavesplat._looks.curves.transfer_function import TransferFunction
    from wavesplat._movie.films import film_frame, film_of, rate_of
    from wavesplat._movie.key_frame import KeyFrame
    from wavesplat._movie.movie import FPS
    from wavesplat._render import windows
    from wavesplat._scene.layer import Layer
    from wavesplat._scene.scene import Scene

    opening, showing, colors = drawing.scene.opening, drawing.scene.showing, drawing.scene.colors
    first = first_layers(
        input,
        opening.layering,
        opening.reader,
        opening.processing,
        look=showing,
        colors=colors,
        is_alone=True,
        all_times=True,
        quiet=quiet,
    )
    look = first.transfer_function
    if first.is_grey and (colors.window or colors.clim):
        low, high = windows.limits(first.volume, colors.window, colors.clim)
        look = TransferFunction.from_colormap("gray", clim=(low, high), opacity=1)
    layers = first.layers if isinstance(first.layers[0], Layer) else [Layer(first.layers[0], look)]
    scene = Scene(layers, background=showing.background or "black")
    film = film_of(scene)
    assert film is not None
    times, size = opening.layering.times, drawing.sampling.size
    numbers = range(len(film)) if times is None else times_of(times, len(film))
    along = [KeyFrame(float(k), time=number) for k, number in enumerate(numbers)]
    own = film_frame(scene).size if size == DEFAULT_SIZE else size
    arguments = {"threads": drawing.sampling.threads}
    return _Shown(scene, along, "film", "a film, as it is", fps or rate_of(film) or FPS, own, arguments)


def _along(
    chosen: ChosenScene,
    turn: Turn | None,
    drawing: PictureOptions,
    *,
    fps: float,
) -> list[KeyFrame] | list[Camera] | Turn:
    """A turn, through the times if any are given, or a key frame for each of them."""
    from wavesplat._movie.key_frame import KeyFrame
    from wavesplat._movie.turn import key_frames, turned_in_place

    viewing, size, eyes = drawing.viewing, drawing.sampling.size, drawing.eyes
    times = drawing.scene.opening.layering.times
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
    from wavesplat._model.volume.series import Series

    series = next((layer.volume for layer in chosen.scene.layers if isinstance(layer.volume, Series)), None)
    if series is None:
        raise ArgumentError("--times makes a movie of time points, and the file holds one; leave it out for a turn")
    return times_of(times, len(series))
