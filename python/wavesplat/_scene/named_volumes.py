"""Volumes that documents name: opened from files or made, and processed again as they were."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from wavesplat import examples
from wavesplat._looks.largest_body import largest_body
from wavesplat._model.argument_types import described
from wavesplat._model.series import Series
from wavesplat._model.volume import Volume
from wavesplat._model.wavelet_volume import WaveletVolume
from wavesplat._readers.opening import open as open_volume
from wavesplat._readers.request import named_within
from wavesplat._readers.time_points import open_series
from wavesplat._scene.document_paths import Reach
from wavesplat.errors import ArgumentError, FileError

EXAMPLES = {name: getattr(examples, name) for name in examples.__all__}
#: Steps of processing a volume, by their name in a document.
STEPS: dict[str, Callable[..., Any]] = {
    "smoothed": Volume.smoothed,
    "largest_body": largest_body,
    "moved": lambda volume, matrix: volume.moved(matrix),
    "wavelets": WaveletVolume.from_volume,
    "level": WaveletVolume.level,
    "bands": WaveletVolume.bands,
    "to_volume": WaveletVolume.to_volume,
    "times": lambda series, start=None, stop=None, step=None: series[start:stop:step],
}

#: Types that steps are for, where it is not a volume of samples.
KINDS: dict[str, tuple[type, ...]] = {
    "moved": (Volume, Series),
    "level": (WaveletVolume,),
    "bands": (WaveletVolume,),
    "to_volume": (WaveletVolume,),
    "times": (Series,),
}


def volume_named(source: Any, what: str, reach: Reach) -> Volume | WaveletVolume | Series:
    """The volume, or the series, that a document names.

    what : its place there, for messages.
    reach : which files the document may name.
    """
    if not isinstance(source, dict):
        raise ArgumentError(f"{what} is {described(source)}; it must be an object with the path of a file")
    options = dict(source)
    steps = options.pop("then", [])
    if not isinstance(steps, list):
        raise ArgumentError(f"{what}: field 'then' is {described(steps)}; it must be a list")
    volume: Volume | WaveletVolume | Series
    if "example" in options:
        volume = _example(options, what)  # files of the package, wherever the document lies
    else:
        place = reach.of_name(options.get("path"))
        try:
            with named_within(place.within):
                volume = _first(options, what, place)
        except FileError:
            reach.check_there(source.get("path"), what)
            raise
    for number, step in enumerate(steps):
        volume = _done(volume, step, f"{what}.then[{number}]")
    return volume


def _example(options: dict[str, Any], what: str) -> Any:
    name = options.pop("example")
    if name not in EXAMPLES:
        raise ArgumentError(f"{what}: there is no example {described(name)}; they are {', '.join(EXAMPLES)}")
    return _called(EXAMPLES[name], options, what)


def _first(options: dict[str, Any], what: str, reach: Reach) -> Any:
    if options.get("path") is None:
        raise ArgumentError(
            f"{what} came from no file when this was written, or from a folder, whose name is written only with "
            "embed_paths=True (--embed-paths); open its samples, and make the scene anew"
        )
    options = reach.options(options, what)
    path = options["path"]
    if options.pop("series_of_times", False):
        return _called(open_series, options, what)
    if not isinstance(path, str):
        raise ArgumentError(f"{what}: field 'path' is {described(path)}; it must be the name of a file")
    if path.lower().endswith(".wavelets"):
        return _called(WaveletVolume.load, options, what)
    return _called(open_volume, options, what)


def _done(volume: Any, step: Any, what: str) -> Any:
    if not (isinstance(step, dict) and len(step) == 1 and next(iter(step)) in STEPS):
        raise ArgumentError(f"{what} is {described(step)}; it must be an object of one field: {', '.join(STEPS)}")
    ((name, options),) = step.items()
    if not isinstance(options, dict):
        raise ArgumentError(f"{what}.{name} is {described(options)}; it must be an object")
    kinds = KINDS.get(name, (Volume,))
    if not isinstance(volume, kinds):
        kind = " or ".join(kind.__name__ for kind in kinds)
        raise ArgumentError(f"{what}: {name!r} is for a {kind}, and this is a {type(volume).__name__}")
    return _called(lambda **given: STEPS[name](volume, **given), options, f"{what}.{name}", STEPS[name])


def _called(function: Callable[..., Any], options: dict[str, Any], what: str, known: Any = None) -> Any:
    names = list(inspect.signature(known or function).parameters)[known is not None :]
    unknown = sorted(set(options) - set(names))
    if unknown:
        raise ArgumentError(f"{what}: unknown field {unknown[0]!r}; the fields are {', '.join(sorted(names))}")
    try:
        return function(**options)
    except TypeError as error:
        raise ArgumentError(f"{what}: {error}") from None
    except ArgumentError as error:
        raise ArgumentError(f"{what}: {error}") from None
