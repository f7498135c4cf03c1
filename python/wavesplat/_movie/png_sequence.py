"""Frames as PNG files of a folder, each with a mark of what it shows, so that a movie can be gone on with.

The mark is a hash of all that decides a frame: samples and their place, looks, labels, light, clips, camera, size and
sampling, and the version of this package. It stands in a text chunk of the file.
"""

from __future__ import annotations

import hashlib
import json
import re
import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wavesplat import _native
from wavesplat._looks import look_files
from wavesplat._looks.look import Look
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._picture.picture_files import png_bytes
from wavesplat._storage.output import as_file_errors, check_writable, part_beside, remove_left_over
from wavesplat.errors import FileError

if TYPE_CHECKING:
    from wavesplat._looks.labels.labels import Labels
    from wavesplat._model.volume.volume import Volume
    from wavesplat._movie.timeline import Shot
    from wavesplat._scene.layer import Layer

KEYWORD = b"wavesplat:frame"
#: Length of the signature and the first chunk, after which others may stand.
HEADER_BYTES = 8 + 25
USUAL = "%04d.png"


def pattern_of(path: Path) -> Path | None:
    """The pattern that frames are named by, if that is what a path stands for: a folder, or a name with "%04d.png"."""
    if re.fullmatch(r"[^%]*%0?\d{0,2}d[^%]*\.png", path.name, re.IGNORECASE):
        return path
    with as_file_errors(path):
        return path / USUAL if path.suffix == "" or path.is_dir() else None


def make_folder(pattern: Path) -> None:
    """Make the folder of frames, in one that exists, if it is not there."""
    folder = pattern.parent
    with as_file_errors(folder):
        is_there = folder.is_dir()
    if is_there:
        check_writable(frame_path(pattern, 0))
        return
    check_writable(folder)
    try:
        folder.mkdir()
    except OSError as error:
        raise FileError(f"cannot make the folder: {error.strerror or error}; choose another place: {folder}") from error


def frame_path(pattern: Path, number: int) -> Path:
    """The file of a frame, from 0."""
    return pattern.with_name(pattern.name % number)


class Frame(NamedTuple):
    """A picture, the file that it becomes, and the mark of what it shows."""

    path: Path
    rgba: NDArray[np.float32]
    mark: str


def temporary_path(pattern: Path) -> Path:
    """Temporary file of a frame until it is whole."""
    remove_left_over(pattern.parent)
    return part_beside(pattern, ".part.png")


def write_frames(part: Path, frames: Iterator[Frame]) -> None:
    """Write frames with their marks, each whole or not at all."""
    for path, rgba, mark in frames:
        content = png_bytes(rgba, 8)
        data = b"tEXt" + KEYWORD + b"\0" + mark.encode("ascii")
        chunk = struct.pack(">I", len(data) - 4) + data + struct.pack(">I", zlib.crc32(data))
        with as_file_errors(path):
            try:
                part.write_bytes(content[:HEADER_BYTES] + chunk + content[HEADER_BYTES:])
                part.replace(path)
            finally:
                part.unlink(missing_ok=True)


def has_mark(path: Path, mark: str) -> bool:
    """Whether a file is there, whole, and shows what the mark says."""
    try:
        with path.open("rb") as file:
            start = file.read(HEADER_BYTES + 256)
            file.seek(-12, 2)
            end = file.read()
    except OSError:
        return False
    return KEYWORD + b"\0" + mark.encode("ascii") in start and end[4:8] == b"IEND"


class Marks:
    """The marks of frames; volumes, looks and labels that they share are hashed once."""

    def __init__(self, size: tuple[int, int], **options: Any) -> None:
        self._common = {"version": _native.__version__, "size": list(size)}
        self._common |= {name: repr(value) for name, value in sorted(options.items())}
        self._known: dict[Any, tuple[Any, Any]] = {}

    def of(self, shot: Shot, title: str | None = None) -> str:
        """The mark of a frame. `title`: the one that is written above it."""
        scene, first = shot.scene, shot.scene.layers[0]
        facts = {
            **self._common,
            "camera": shot.camera.as_json(),
            # Labels and boxes may lie on the first layer, shown or not.
            "layers": [self._fields_of_layer(layer) for layer in scene.layers if layer.is_shown or layer is first],
            "labels": self._hash_of_labels(scene.labels),
            "shading": repr(scene.shading),
            "clip": [repr(clip) for clip in scene.clip],
            "background": repr(scene.background),
            "title": title,
        }
        return hashlib.blake2b(json.dumps(facts, sort_keys=True).encode(), digest_size=16).hexdigest()

    def _fields_of_layer(self, layer: Layer) -> list[Any]:
        # The hashes of a series' volumes are kept, not the volumes, which may not all fit into memory.
        samples = self._once((id(layer.volume), layer.time), layer.volume, lambda: _hash_of_volume(layer.drawn))
        look = self._once(id(layer.look), layer.look, lambda: self._fields_of_look(layer.look))
        return [samples, look, layer.opacity if layer.visible else 0]

    def _fields_of_look(self, look: Any) -> Any:
        if not isinstance(look, Look):
            return repr(look)
        return [look_files.write(replace(look, labels=None)), self._hash_of_labels(look.labels)]

    def _hash_of_labels(self, labels: Labels | None) -> str | None:
        if labels is None:
            return None
        facts = repr((labels.labels, labels.smooth, labels.numbers, str(labels.world_from_index)))
        hashed: str = self._once(id(labels), labels, lambda: _hashed(labels._codes, facts))
        return hashed

    def _once(self, key: Any, thing: Any, made: Callable[[], Any]) -> Any:
        """Result of `made`, computed once; `thing` is kept with it, since its `id` may be reused once it is gone."""
        if key not in self._known:
            self._known[key] = thing, made()
        return self._known[key][1]


def _hash_of_volume(volume: Volume | WaveletVolume) -> str:
    samples = volume.to_volume().samples if isinstance(volume, WaveletVolume) else volume.samples
    # Some levels of wavelets are left out, which the samples do not show.
    left_out = volume.left_out if isinstance(volume, WaveletVolume) else 0
    return _hashed(samples, f"{samples.dtype} {volume.shape} {volume.world_from_index.tolist()} {left_out}")


def _hashed(samples: NDArray[Any], facts: str) -> str:
    digest = hashlib.blake2b(facts.encode(), digest_size=16)
    for part in samples:
        digest.update(np.ascontiguousarray(part).data)
    return digest.hexdigest()
