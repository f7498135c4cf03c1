"""A scene from a file: all of its channels as layers, in the file's colours and windows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import index
from os import PathLike
from typing import TYPE_CHECKING, Any

from wavesplat import _native
from wavesplat._looks.curves.colors import parse
from wavesplat._looks.kinds.channel_colors import color_of
from wavesplat._looks.look import Look
from wavesplat._looks.over_time import brightest
from wavesplat._model.arguments.sampling import Composite
from wavesplat._model.arguments.types import takes_its_types, takes_options
from wavesplat._model.volume.facts import Channel, Rgb
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._public import public
from wavesplat._readers.options import FileOptions
from wavesplat._readers.request import Request, SeveralError
from wavesplat._readers.time_points import open_series
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import MAX_LAYERS, Scene
from wavesplat._storage.addresses import safe_address
from wavesplat._system.threads import warn
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from typing import Unpack


@dataclass(frozen=True)
class _Wanted:
    """A channel to show, with its colour and window where they are given."""

    number: int
    color: Rgb | None = None
    window: Any = None
    #: Whether it is shown also where the file does not want it.
    is_asked_for: bool = False


@public
@takes_its_types
@takes_options(FileOptions, Request)
def open_scene(
    path: str | PathLike[str] | Sequence[str | PathLike[str]],
    *,
    channels: Sequence[Any] | None = None,
    time: int = 0,
    composite: Composite = "over",
    **options: Unpack[FileOptions],
) -> Scene:
    """A scene of all channels in a file, in the file's colours and windows.

    Parameters
    ----------
    path : path, URL, pattern or list of paths
        As for `wavesplat.open`; of time points in files of their own as for `wavesplat.open_series`.
    channels : sequence, optional
        Which ones, by number from 0 or by name: `[0, "DAPI"]`. With a colour and a window of values where the file's
        are not wanted: `[("DAPI", "blue"), (1, "green", (100, 900))]`; None leaves one of them to the file. All, if not
        given; of more than eight the first eight that the file wants shown.
    time : int, default 0
        Which time point, if the file holds several. The scene keeps all of them: `scene.at_time(3)`.
    composite : str, default "over"
        Operator that several channels are shown with: "over", or "maximum", whose colours add up.
    **options : FileOptions
        As for `wavesplat.open`.

    Returns
    -------
    Scene
        A layer for each channel, with its name; those that the file does not want shown are not visible. Several
        channels are shown as light, without shading (`Look.channel`), on black. Without a colour in the file, or with
        one that another channel has, they are green, magenta, cyan, yellow, red, blue. A single one has the look that
        suits its kind of data (`Look.auto`). Looks are chosen once for all time points.

    Raises
    ------
    FileError
        If there is no such file, or it is unreadable, or holds no volume.
    ArgumentError
        If there is no such channel or time point, or an option has no meaning for that format.

    Warns
    -----
    WavesplatWarning
        If the file holds more than eight channels, and eight of them are taken.

    Examples
    --------
    >>> import numpy as np, wavesplat as ws
    >>> z, y, x = np.mgrid[:16, :16, :16]
    >>> blobs = [np.exp(-((x - c) ** 2 + (y - 8) ** 2 + (z - 8) ** 2) / 9) for c in (5, 10)]
    >>> np.save("cells.npy", np.stack(blobs, axis=-1).astype(np.float32)[None])  # time, z, y, x, channel
    >>> channels = [(0, "green"), (1, "magenta", (0.2, 1))]
    >>> scene = ws.open_scene("cells.npy", channels=channels, composite="maximum")
    >>> scene, scene.render(size=(32, 32)).rgba.shape
    (<Scene: 'channel 0', 'channel 1'>, (32, 32, 4))
    """
    source = _Source(path, options, time)
    if channels is None and source.refusal is not None:
        raise source.refusal
    wanted = _all_of(source) if channels is None else [_wanted(one, source) for one in channels]
    if not 1 <= len(wanted) <= MAX_LAYERS:
        raise ArgumentError(f"a scene has 1 to {MAX_LAYERS} channels, not {len(wanted)}")
    if len(wanted) == 1 and wanted[0].color is None and wanted[0].window is None:
        return Scene(_layer(source, wanted[0], None))
    colors = _native.distinct_colors([one.color for one in wanted], [source.color(one.number) for one in wanted])
    looks = []
    for one, color in zip(wanted, colors, strict=True):
        looks.append(Look.channel(source.volume_of(one.number), color, one.window, composite))
    return Scene([_layer(source, one, look) for one, look in zip(wanted, looks, strict=True)])


class _Source:
    """The channels of a file, each read once, when it is first asked for."""

    def __init__(self, path: Any, options: FileOptions, time: int) -> None:
        self.path, self.options, self.time = path, options, time
        self._read: dict[int, Series] = {}
        self.n, self._names = 1, tuple[str, ...]()
        #: The error for channels that are no light, so that one of them is to be chosen.
        self.refusal: SeveralError | None = None
        try:
            only = open_series(path, **options)
            only[time]
        except SeveralError as error:
            if error.option != "channel":
                raise
            self.refusal = None if error.are_light else error
            self.n, self._names = len(error.names), error.described
        else:
            self._read[0] = only

    def series(self, number: int) -> Series:
        if number not in self._read:
            self._read[number] = open_series(self.path, channel=number, **self.options)
            self._read[number][self.time]  # or an error
        return self._read[number]

    def volume_of(self, number: int) -> Volume:
        """The volume that a channel's look is made for."""
        return brightest(self.series(number))

    def facts(self, number: int) -> Channel:
        """The file's facts about a channel; any channel that was read has the facts of all."""
        read = next(iter(self._read), number)
        facts = self.series(read)[self.time].facts
        return facts.channels[number] if number < len(facts.channels) else Channel()

    def color(self, number: int) -> Rgb | None:
        """The file's colour of a channel, else the usual colour of its light; None if neither is known."""
        return color_of(self.facts(number), [self.facts(one) for one in range(self.n)])

    def name(self, number: int) -> str:
        if number < len(self._names):
            return self._names[number]
        return self.facts(number).name


def _all_of(source: _Source) -> list[_Wanted]:
    if source.n <= MAX_LAYERS:
        return [_Wanted(number) for number in range(source.n)]
    active = [number for number in range(source.n) if source.facts(number).is_active]
    taken = (active or list(range(source.n)))[:MAX_LAYERS]
    listed = ", ".join(str(number) for number in taken)
    warn(
        f"the file holds {source.n} channels, a scene at most {MAX_LAYERS}: {listed} are taken; choose others with "
        f"channels= (--channel): {safe_address(source.path)}",
        stacklevel=5,
    )
    return [_Wanted(number) for number in taken]


def _wanted(given: Any, source: _Source) -> _Wanted:
    parts = list(given) if isinstance(given, tuple | list) else [given]
    if not 1 <= len(parts) <= 3:
        raise ArgumentError(
            f"a channel is {described(given)}; give a number or a name, or (number or name, colour, (low, high))"
        )
    which, color, window = (*parts, None, None)[:3]
    parsed = parse(color)
    return _Wanted(_number(which, source), None if parsed is None else parsed[:3], window, True)


def _number(which: Any, source: _Source) -> int:
    names = [source.name(number) for number in range(source.n)] if isinstance(which, str) else []
    if isinstance(which, str):
        found = [number for number, name in enumerate(names) if name == which]
        found = found or [number for number, name in enumerate(names) if name.lower() == which.lower()]
        if found:
            return found[0]
        listed = ", ".join(repr(name) for name in names if name)
        names_text = f"names {listed}" if listed else "names none of its channels; give a number"
        raise ArgumentError(f"there is no channel {which!r}; the file {names_text}: {safe_address(source.path)}")
    try:
        number = index(which)
    except TypeError:
        raise ArgumentError(f"a channel is {described(which)}; give a number from 0, or a name") from None
    if not 0 <= number < source.n:
        raise ArgumentError(
            f"channel {number}, but the file holds {source.n} channels, 0..{source.n - 1}: {safe_address(source.path)}"
        )
    return number


def _layer(source: _Source, wanted: _Wanted, look: Look | None) -> Layer:
    times = source.series(wanted.number)
    has_many = len(times) > 1
    name = source.name(wanted.number) or (f"channel {wanted.number}" if source.n > 1 else None)
    return Layer(
        times if has_many else times[0],
        look,
        visible=wanted.is_asked_for or source.facts(wanted.number).is_active,
        time=source.time if has_many else 0,
        name=name,
    )
