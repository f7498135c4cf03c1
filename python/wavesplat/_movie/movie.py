"""The movie: some frames are drawn at once, while those before are encoded in a thread beside.

The compiled renderer and the encoders work without Python's interpreter lock, so they run at the same time.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict, TypeVar

import numpy as np
from numpy.typing import NDArray

from wavesplat._looks.look import Look
from wavesplat._model.arguments.sampling import Sampling
from wavesplat._model.arguments.types import takes_its_types, takes_options
from wavesplat._model.camera.camera import Camera
from wavesplat._movie import encoding, png_sequence
from wavesplat._movie.films import film_frame, film_of, rate_of, shots_of
from wavesplat._movie.frames import check_client, drawn_by_client
from wavesplat._movie.key_frame import KeyFrame
from wavesplat._movie.pipeline import MAX_AT_ONCE, Progress, made_ahead, work_beside
from wavesplat._movie.seen import camera_of, with_settled_looks
from wavesplat._movie.timeline import Shot, Timeline
from wavesplat._movie.turn import Turn, cameras_of, key_frames
from wavesplat._picture.annotating import Corner, Figure, Orientation, Side
from wavesplat._picture.picture import Picture
from wavesplat._public import public
from wavesplat._render.arguments import checked_size
from wavesplat._render.options import DrawOptions, FrameOptions
from wavesplat._scene.drawing.summary import stamped
from wavesplat._scene.layer import AnyLook
from wavesplat._scene.scene import Scene, as_scene
from wavesplat._storage.output import check_output, removed_when_terminated, write_atomically
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from typing import Unpack

# Options of movies: the options of their frames, and the marks that are drawn on every frame.


class FigureOptions(TypedDict, total=False):
    """Marks of a figure; `Picture.annotated` documents them."""

    scale_bar: bool | float | str
    orientation: Orientation | None
    colorbar: bool | str | Sequence[str]
    legend: bool | Iterable[str]
    title: str | None
    unit: str | None
    values: str | None
    font_size: float | None
    color: str | Sequence[float] | None
    font: str | PathLike[str] | None
    scale_bar_at: Corner
    orientation_at: Corner
    colorbar_at: Side
    legend_at: Side


class MovieOptions(FrameOptions, FigureOptions, total=False):
    """Options of `movie`: the options of pictures, and the marks of figures."""


@dataclass(frozen=True, kw_only=True)
class MovieValues(DrawOptions, Figure):
    """The defaults of `MovieOptions`."""


def parted(options: MovieOptions) -> tuple[dict[str, Any], dict[str, Any]]:
    """Options of drawing, and arguments of `Picture.annotated`."""
    drawing: dict[str, Any] = dict(options)
    return drawing, {name: drawing.pop(name) for name in FigureOptions.__annotations__ if name in drawing}


# Marks of a figure on the frames of a movie: the same on every frame, at the same place.


class FrameFigure:
    """Marks for frames; `arguments` are the arguments of `Picture.annotated`.

    is_still : whether the looks of all frames are the same.
    """

    def __init__(self, arguments: Mapping[str, Any], *, is_still: bool) -> None:
        self._arguments = dict(arguments)
        legend: object = arguments.get("legend", False)
        if isinstance(legend, Iterable) and not isinstance(legend, str):
            self._arguments["legend"] = list(legend)  # for more than one frame
        if self._arguments.get("colorbar", False) is not False and not is_still:
            raise ArgumentError(
                "a colour bar shows one look, and key frames change it; leave out the colour bar, or the looks of the "
                "key frames"
            )
        self._size: tuple[int, int] | None = None

    def title_of(self, scene: Scene) -> str | None:
        """The title above a frame, with the scene's time, as wide as at every other time."""
        title: object = self._arguments.get("title")
        return stamped(title, scene) if isinstance(title, str) else None

    def drawn(self, picture: Picture, scene: Scene) -> NDArray[np.float32]:
        """The frame with its marks; as large as the others."""
        if self._arguments:
            title = self.title_of(scene)
            picture = picture.annotated(**self._arguments | ({} if title is None else {"title": title}))
        self._size = self._size or picture.size
        if picture.size != self._size:
            (width, height), (first_width, first_height) = picture.size, self._size
            raise ArgumentError(
                f"with its marks a frame has {width} x {height} pixels, and another one {first_width} x "
                f"{first_height}; leave out the legend or the title, or give a smaller font_size"
            )
        return picture.rgba


# The movie: some frames are drawn at once, while those before are encoded in a thread beside.

T = TypeVar("T")

#: Frames a second, by default.
FPS = 30.0
#: Most pixels of all frames that are drawn at once: each takes some hundred bytes meanwhile.
MAX_PIXELS_AT_ONCE = 8_000_000

#: Default sampling of frames: the detail that it loses hardly shows in compressed frames that move.
MOVIE_SAMPLING = Sampling(sheets_per_slice=1, oversampling=0.6)

#: Path of a movie: a turn, cameras of single frames, or key frames.
Along: TypeAlias = Turn | Sequence[Camera] | Sequence[KeyFrame]


@public
@takes_its_types
@takes_options(MovieOptions, MovieValues, quality=None)
def movie(
    what: Any,
    path: str | PathLike[str],
    along: Along | None = None,
    look: AnyLook | Sequence[AnyLook] = None,
    *,
    fps: float | None = None,
    background: str | Sequence[float] | None = None,
    crf: int | None = None,
    resume: bool = False,
    client: Any = None,
    **options: Unpack[MovieOptions],
) -> Path:
    """A movie of a volume or a scene: a turn, a flight along cameras, or what changes between key frames.

    Parameters
    ----------
    what : Scene, Volume, WaveletVolume, array, Layer, or several volumes or layers in a list
        What to show, as for `render`. A `Scene` also gives clips, labels and light. A film, a series of single
        pictures such as ultrasound, is shown frame by frame, each as `slice` shows it.
    path : path
        The suffix chooses the format. `.mp4`: H.264, which every browser and every slide plays; `.webm`: VP9; `.gif`
        and `.webp`: animations that repeat. A folder, or a name such as `frames/%04d.png`: a PNG file for each frame.
    along : Turn, sequence of Camera, or sequence of KeyFrame, optional
        `Turn(frames=120)` goes round at one scale, which is what None does. Cameras are a frame each
        (`Camera.interpolate` makes them from a few). Key frames say what is shown when, and change it in between. Of a
        film None is all of its frames, or key frames with a time each.
    look : Look, TransferFunction, TransferFunction2D, Materials or str, optional
        How values are shown, as for `render`. What is chosen by the data is chosen once, for all frames.
    fps : float, optional
        Frames a second. None is 30, and of a film its own rate.
    background : colour, optional
        None is the scene's own, or black. Only PNG and WebP files can be transparent.
    crf : int, optional
        Constant rate factor of videos: less loses less, in a larger file; 18 of H.264 and 24 of VP9 look clean.
    resume : bool
        For PNG files: keep frames that are there and show what they must, and draw the others.
    client : dask.distributed.Client or "threads", optional
        Draw frames on the workers of a Dask cluster, as `render_frames`; not with `psnr`.
    **options : MovieOptions
        From `scale_bar` on as for `Picture.annotated`, drawn on every frame at the same place; with colours beside the
        picture frames are larger than `size`. `{time}` in the title is the time of a series with its unit, "30 s".
        The others as for `wavesplat.render`. `quality` None is one sheet a slice and 0.6 texels a pixel: on frames of
        the bundled CT 31 to 35 dB, where "normal" has 35 to 37 and takes four times as long. With `psnr` the first
        frame is measured, and later ones where the view differs much. Videos have even sides: a row or column of an
        odd size is repeated. A film has its own size where none is given, and what is said on space has no meaning.

    Returns
    -------
    pathlib.Path
        The file; of single frames the pattern of their names.

    Raises
    ------
    ArgumentError
        If an argument cannot work.
    FileError
        If the suffix is unknown or the file cannot be written; an existing file is replaced only by a whole one.
    LibraryError
        If the encoder is not installed (`pip install "wavesplat[movie]"`).
    CancelledError
        If `progress` returned False; of a video nothing is left, of single frames those that are done.

    Examples
    --------
    >>> import wavesplat as ws
    >>> pelvis = ws.examples.ct_pelvis()
    >>> ws.movie(pelvis, "turn.gif", ws.Turn(frames=3), "ct-bone", size=(32, 32)).name
    'turn.gif'
    >>> keys = [ws.KeyFrame(0, camera="front", look="ct-skin"), ws.KeyFrame(0.1, camera="left", look="ct-bone")]
    >>> ws.movie(pelvis, "opened/%04d.png", keys, size=(32, 32)).parent.name
    'opened'
    """
    pattern = check_movie(path, fps=FPS if fps is None else fps, crf=crf, resume=resume)
    target = Path(path)
    drawing, marks = parted(options)
    values = DrawOptions(**{"quality": None, **drawing})
    width, height = checked_size(values.size)
    if min(width, height) < 1:
        raise ArgumentError(f"size is {width} x {height} pixels; width and height must be at least 1")
    check_client(client, values.psnr)
    scene = as_scene(what, look, labels=None, shading="look", clip=(), background=background)
    eyes = values.eyes
    film = film_of(scene)
    fps = ((rate_of(film) if film else None) or FPS) if fps is None else fps
    if film is not None:
        shots = _Shots(shots_of(scene, film, along))
        width, height = (width, height) if "size" in options else film_frame(shots[0].scene).size
    else:
        shots = _shots(scene, Turn() if along is None else along, fps, values)
    figure = FrameFigure(marks, is_still=shots.have_one_look)
    quality = values.quality
    if quality is None:
        quality = MOVIE_SAMPLING if values.psnr is None else "normal"
    same: dict[str, Any] = {
        "quality": quality,
        "psnr": values.psnr,
        "kernel": values.kernel,
        "composite": values.composite,
        "stereo": eyes.stereo,
        "panorama": eyes.panorama,
    }
    progress = Progress(values.progress, len(shots))
    draw = _Drawing(
        shots,
        progress,
        values.threads,
        client,
        size=(width, height),
        device=values.device,
        is_film=film is not None,
        **same,
    )
    if pattern is None:
        frames = draw.all(range(len(shots)), lambda number, picture: figure.drawn(picture, shots[number].scene))
        settings: Any = {"fps": fps, "crf": crf}
        write_atomically(
            target,
            lambda part: work_beside(lambda come: encoding.encode(part, come, len(shots), **settings), frames),
        )
        return target
    png_sequence.make_folder(pattern)
    hashes = png_sequence.Marks((width, height), figure=marks, **same)

    def hash_of(number: int) -> str:
        return hashes.of(shots[number], figure.title_of(shots[number].scene))

    def frame(number: int, picture: Picture) -> png_sequence.Frame:
        rgba = figure.drawn(picture, shots[number].scene)
        return png_sequence.Frame(png_sequence.frame_path(pattern, number), rgba, hash_of(number))

    missing = _missing(pattern, len(shots), hash_of, progress) if resume else range(len(shots))
    part = png_sequence.temporary_path(pattern)
    with removed_when_terminated(part):
        work_beside(lambda come: png_sequence.write_frames(part, come), draw.all(missing, frame))
    return pattern


class _Drawing:
    """Draws frames, several of the same scene at once, which share the threads that one picture has."""

    def __init__(
        self,
        shots: _Shots,
        progress: Progress,
        threads: int | None,
        client: Any = None,
        *,
        is_film: bool = False,
        **options: Any,
    ) -> None:
        self._is_film = is_film
        self._shots, self._progress, self._threads, self._options = shots, progress, threads, options
        self._client = client
        self._n_threads = 1

    def all(self, numbers: Iterable[int], made: Callable[[int, Picture], T]) -> Generator[T]:
        """Yield `made` of each frame, in order; several frames are drawn at once, here or elsewhere."""
        if self._client is None or self._is_film:
            yield from made_ahead(lambda number: made(number, self(number)), numbers, self.at_once, self._progress)
            return
        wanted = list(numbers)
        pictures = drawn_by_client([self._shots[number] for number in wanted], self._options, self._client)
        for number, picture in zip(wanted, pictures, strict=True):
            self._progress.finish(number)
            self._progress.report()
            yield made(number, picture)

    def __call__(self, number: int) -> Picture:
        shot, at_once = self._shots[number], self.at_once()
        if self._is_film:
            return film_frame(shot.scene, self._options["size"], self._threads)
        threads = self._threads if at_once == 1 else self._n_threads // at_once
        picture = shot.scene.render(shot.camera, threads=threads, progress=self._progress.of(number), **self._options)
        if at_once == 1:
            self._n_threads = int(picture.report.get("n_threads", 1))
        return picture

    def at_once(self) -> int:
        """Number of frames to draw at once; one until the number of threads is known."""
        width, height = self._options["size"]
        most = min(self._n_threads, MAX_AT_ONCE, max(1, MAX_PIXELS_AT_ONCE // (width * height)))
        # With `psnr`, errors measured on a frame are used for the next one, so frames follow each other.
        if self._options["psnr"] is not None or not self._shots.show_one_scene:
            most = 1
        # Each frame gets the same number of threads: the n that leaves fewest idle, the largest such n.
        return max(range(1, most + 1), key=lambda n: (n * (self._n_threads // n), n))


def check_movie(path: str | PathLike[str], *, fps: float, crf: int | None, resume: bool) -> Path | None:
    """Refuse what cannot be written, before anything is drawn; return the pattern of names where frames are files."""
    target = Path(path)
    pattern = png_sequence.pattern_of(target)
    if pattern is None:
        if target.suffix.lower() == ".png":
            raise FileError(f"a PNG file is one frame; number them, as in %04d.png, or name a folder: {target}")
        check_output(target, "movies")
    suffix = target.suffix.lower() if pattern is None else ".png"
    encoding.check_speed(suffix, fps)
    if crf is not None:
        encoding.check_crf(suffix, crf)
    if pattern is None:
        encoding.needed_library(suffix)
        if resume:
            raise ArgumentError(f"resume keeps frames that are there, and {target.name} is one file; name a folder")
    return pattern


class _Shots:
    """The shots of a movie, on black where neither scene nor look has a background."""

    def __init__(self, shots: Timeline | Sequence[Shot]) -> None:
        self._shots = shots
        self._last: tuple[Scene, Scene] | None = None

    @property
    def show_one_scene(self) -> bool:
        """Whether only the camera moves."""
        return not isinstance(self._shots, Timeline) or self._shots.is_still

    @property
    def have_one_look(self) -> bool:
        """Whether colours of values are the same in all frames."""
        return not isinstance(self._shots, Timeline) or self._shots.has_one_look

    def __len__(self) -> int:
        return len(self._shots)

    def __getitem__(self, number: int) -> Shot:
        scene, camera = self._shots[number]
        look = scene.layers[0].look
        if scene.background is None and not (isinstance(look, Look) and look.background is not None):
            if self._last is None or self._last[0] is not scene:
                self._last = scene, scene.with_(background="black")
            scene = self._last[1]
        return Shot(scene, camera)


def _shots(scene: Scene, along: Along, fps: float, values: DrawOptions) -> _Shots:
    composite, size, eyes = values.composite, checked_size(values.size), values.eyes
    aspect = eyes.aspect_of(size)
    if isinstance(along, Turn):
        cameras = cameras_of(along, scene, composite, aspect, eyes)
        settled, name = with_settled_looks(scene, composite, cameras[0], size)
        if along.times is not None:
            keys = key_frames(along, cameras, fps)
            return _Shots(Timeline(keys, settled, fps=fps, composite=composite, name=name, aspect=aspect, eyes=eyes))
        return _Shots([Shot(settled, camera) for camera in cameras])
    try:
        steps = list(along)
    except TypeError:
        steps = []
    cameras = [step for step in steps if isinstance(step, Camera)]
    keys = [step for step in steps if isinstance(step, KeyFrame)]
    if cameras and len(cameras) == len(steps):
        settled, _ = with_settled_looks(scene, composite, cameras[0], size)
        return _Shots([Shot(settled, camera) for camera in cameras])
    if not keys or len(keys) != len(steps):
        raise ArgumentError(
            f"along is {described(along)}; give a wavesplat.Turn, a list of Camera, or a list of KeyFrame"
        )
    begin = next((key.camera for key in keys if key.camera is not None), None)
    first = camera_of(scene, begin, composite, aspect, eyes=eyes)
    settled, name = with_settled_looks(scene, composite, first, size)
    return _Shots(Timeline(keys, settled, fps=fps, composite=composite, name=name, aspect=aspect, eyes=eyes))


def _missing(pattern: Path, n: int, hash_of: Callable[[int], str], progress: Progress) -> list[int]:
    """Numbers of the frames that are not written yet."""
    missing = []
    for number in range(n):
        if png_sequence.has_mark(png_sequence.frame_path(pattern, number), hash_of(number)):
            progress.finish(number)
        else:
            missing.append(number)
    return missing
