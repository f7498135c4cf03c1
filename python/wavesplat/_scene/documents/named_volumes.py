"""Volumes and files that documents name: which may be named, and how they are opened or made again.

A document is data: a picture that somebody sent must not make a program read other files of the user, ask servers in
the user's network, or be given what only the user can give.
"""

from __future__ import annotations

import glob
import inspect
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from wavesplat import examples
from wavesplat._looks.body.largest_body import largest_body
from wavesplat._model.volume.private_names import CONTENT, file_of_content
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.volume import Volume
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._readers.opening import open as open_volume
from wavesplat._readers.request import named_within
from wavesplat._readers.time_points import open_series
from wavesplat._storage.addresses import checked, is_address, is_web, safe_address
from wavesplat._storage.paths import lies_in, real_path
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError, FileError

# Checks of the fields of documents, whose errors name the field.

T = TypeVar("T")


def made_at(what: str, make: Callable[[], T]) -> T:
    """The result of `make`; its errors get the place in the document."""
    try:
        return make()
    except TypeError as error:
        raise ArgumentError(f"{what}: {error}") from None
    except ArgumentError as error:
        raise ArgumentError(f"{what}: {error}") from None


# Files and addresses that a document may name: in its folder, and on public web servers, unless more is allowed.

#: Largest number of characters of a path that a message quotes.
MAX_LETTERS = 120
MEND = "if you trust the document, open it with external_files=True (--external-files)"


@dataclass(frozen=True)
class Reach:
    """Files and addresses that a document may name.

    folder : absolute; relative paths start there.
    external_files : whether the user allows it to name any file or address, and files to name others.
    """

    folder: Path
    external_files: bool = False

    @property
    def within(self) -> Path | None:
        """The folder that files must lie in; None where any may be named."""
        return None if self.external_files else real_path(self.folder)

    def options(self, options: dict[str, Any], what: str) -> dict[str, Any]:
        """Options of opening a file, as the document has them, with the path checked.

        Raises
        ------
        FileError
            If it names a file elsewhere, or wants more to be read than it may.
        ArgumentError
            If it says where files are written.
        """
        if options.get("external_files") and not self.external_files:
            raise FileError(f"{what} asks that the file may name other files, which only you can allow; {MEND}")
        if "cache" in options:
            raise ArgumentError(f"{what}: unknown field 'cache'; where files are written is not a document's to say")
        path = options["path"]
        found = [self.path(one, what) for one in path] if isinstance(path, list) else self.path(path, what)
        return {**options, "path": found}

    def of_name(self, path: Any) -> Reach:
        """The reach for a path: of a name alone that is not in the folder, the working directory, if it is there.

        Pictures hold names of files without their folders.
        """
        names = path if isinstance(path, list) else [path]
        if not all(isinstance(one, str) and _is_bare(one) for one in names):
            return self
        here = Path.cwd()
        is_here_alone = not any(_is_in(one, self.folder) for one in names) and all(_is_in(one, here) for one in names)
        return Reach(here, self.external_files) if is_here_alone else self

    def check_there(self, path: Any, what: str) -> None:
        """Raise a `FileError` that says where was looked for a name alone, if it is in none of these folders."""
        for name in path if isinstance(path, list) else [path]:
            here = Path.cwd()
            if isinstance(name, str) and _is_bare(name) and not (_is_in(name, self.folder) or _is_in(name, here)):
                also = "" if self.folder == here else f", nor in the working directory, {here}"
                shown = "a scan by its content" if name.startswith(CONTENT) else repr(name[:MAX_LETTERS])
                raise FileError(
                    f"{what} names {shown}, and there is no such file in the document's folder, "
                    f"{self.folder}{also}; go to the file's folder, or copy the document there"
                )

    def path(self, path: str, what: str) -> str:
        """The absolute path, or the address, that a document names."""
        if is_address(path):
            if not (self.external_files or is_web(path)):
                raise FileError(f"{what} names {safe_address(path)!r}, which is no address of a web server; {MEND}")
            checked(path)
            return path
        named = file_of_content(path, self.folder) if path.startswith(CONTENT) else None
        place = os.path.normpath(named or self.folder / path)
        if not self.external_files:
            # Readers check what a pattern matches, what a folder holds, and other parts of a file (`check_within`).
            self._check(place, path, what)
        return place

    def _check(self, place: str, path: str, what: str) -> None:
        if "\0" in place or not lies_in(place, real_path(self.folder)):
            raise FileError(
                f"{what} names {path[:MAX_LETTERS]!r}, which lies outside of the document's folder, {self.folder}; "
                f"{MEND}, or put the file into that folder"
            )


def _is_bare(path: str) -> bool:
    """Whether a path is the name of a file alone."""
    return path not in ("", ".", "..") and "\0" not in path and not is_address(path) and not set(path) & {"/", os.sep}


def _is_in(name: str, folder: Path) -> bool:
    """Whether a folder has a file of a name, or of a content, or files that fit it where it is a pattern."""
    if name.startswith(CONTENT):
        return file_of_content(name, folder) is not None
    place = folder / name
    return os.path.lexists(place) or (glob.has_magic(name) and any(folder.glob(name)))


# Volumes that documents name: opened from files or made, and processed again as they were.

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
    options = dict(source)
    steps = options.pop("then", [])
    volume: Volume | WaveletVolume | Series
    if "example" in options:
        # Files of the package, wherever the document lies.
        volume = _called(EXAMPLES[options.pop("example")], options, what)
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
    ((name, options),) = step.items()
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
