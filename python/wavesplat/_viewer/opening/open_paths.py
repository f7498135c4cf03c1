"""Contents of a path, opened as the command opens it: volumes as layers, a segmentation, or a shape."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, TypeAlias

from wavesplat._geometry.files.brain_surfaces import is_freesurfer
from wavesplat._geometry.files.opening import SUFFIXES as OF_GEOMETRY
from wavesplat._geometry.files.opening import open_geometry
from wavesplat._geometry.shape import Shape
from wavesplat._looks.kinds.kinds import kind_of
from wavesplat._looks.labels.labels import Labels
from wavesplat._model.lazy.volume import LazyVolume
from wavesplat._model.volume import sources
from wavesplat._model.volume.wavelet_volume import WaveletVolume
from wavesplat._readers.dicom.structures import is_structure_set
from wavesplat._readers.opening import SUFFIXES as OF_VOLUMES
from wavesplat._readers.request import SeveralError, named_within
from wavesplat._scene.layer import Layer
from wavesplat._scene.opening import open_scene
from wavesplat._scene.scene import MAX_LAYERS, Scene
from wavesplat._storage.addresses import is_address, safe_address
from wavesplat._storage.paths import expanded
from wavesplat._system.threads import collected_notes
from wavesplat.errors import ArgumentError, CancelledError, WavesplatError

Kind: TypeAlias = Literal["volume", "labels", "shape"]
#: Options that choose among what a file holds, which a page may be asked for.
CHOICES = ("series", "dataset")
#: Files that are read as volumes first, and as shapes if they hold none.
OF_BOTH = (".vtk", ".vtu", ".vtp")


@dataclass(frozen=True)
class Found:
    """The contents of a path.

    kind : "volume"; "shape"; "labels", which can be drawn as a volume too, but for the lines of a structure set.
    layers : of volumes and labels; none of a structure set.
    is_part : whether these are a series or dataset that was chosen of several in the file.
    """

    kind: Kind
    name: str
    path: Path | str
    layers: tuple[Layer, ...] = ()
    shape: Shape | None = None
    folder: Path | None = None
    notes: tuple[str, ...] = ()
    is_part: bool = False

    def labels(self, scan: Any) -> Labels:
        """The segmentation, of a scan."""
        if self.is_part and self.layers:
            # The file alone does not say which part.
            volume = self.layers[0].drawn
            return Labels(volume.read() if isinstance(volume, LazyVolume) else volume)
        with named_within(self.folder):
            labels = Labels.open(self.path, scan=scan)
        return labels if self.folder is None else labels._changed(_source=_own_source(labels._source, self.folder))


class Several(Exception):  # noqa: N818 - a question to the page, no error
    """The file holds several things, one of which is to be chosen: an option, its values, and words for each."""

    def __init__(self, path: Path | str, error: SeveralError) -> None:
        super().__init__(str(error))
        self.path, self.option = path, error.option
        self.names = list(error.names)
        self.described = list(error.described) or [str(name) for name in error.names]


def found_at(
    path: Path | str, *, folder: Path | None = None, unit: str | None = None, choice: Mapping[str, Any] | None = None
) -> Found:
    """The contents of a path.

    folder : of an upload, in which all that it names must lie; None where the user named the path.
    unit : of the world that shapes are brought to.
    choice : the value of an option by its name, "series" or "dataset".

    Raises
    ------
    WavesplatError
        If the path cannot be opened.
    Several
        If it holds several series or datasets.
    """
    with collected_notes() as collected, named_within(folder):
        found = _found(path, unit, dict(choice or {}))
    return _named(replace(found, folder=folder, notes=(*map(str, collected), *found.notes)))


def scene_with(base: Scene | None, found: Sequence[Found], *, as_labels: bool) -> Scene:
    """A scene with what was found added to it. as_labels : whether segmentations are labels of the first volume.

    Raises
    ------
    ArgumentError
        If they do not go together: too many layers, labels of another scan.
    """
    layers = [] if base is None else list(base.layers)
    shapes = [] if base is None else list(base.geometry)
    labels = None if base is None else base.labels
    segmentations = [one for one in found if one.kind == "labels" and (as_labels or not one.layers)]
    for one in found:
        if one not in segmentations:
            layers += one.layers
        if one.shape is not None:
            shapes.append(one.shape)
    if not layers:
        raise ArgumentError(
            "shapes and segmentations are shown with a volume, and none is open; open the volume first, or all together"
        )
    if len(layers) > MAX_LAYERS:
        raise ArgumentError(f"a scene has up to {MAX_LAYERS} layers, and these are {len(layers)}; remove one first")
    if len(segmentations) > 1:
        names = ", ".join(one.name for one in segmentations)
        raise ArgumentError(f"a scene has one segmentation, and these are {len(segmentations)} ({names}); add one")
    if segmentations:
        labels = segmentations[0].labels(layers[0].drawn)
    if base is None:
        return Scene(layers, labels=labels, geometry=shapes)
    return base.with_(layers=layers, labels=labels, geometry=shapes)


def _found(path: Path | str, unit: str | None, choice: dict[str, Any]) -> Found:
    name = _name(path)
    place = None if is_address(path) else expanded(path)
    if place is not None and place.is_file():
        if is_structure_set(place):
            return Found("labels", name, path)
        if place.name.lower().endswith(".wavelets"):
            return Found("volume", name, path, (Layer(WaveletVolume.load(place)),))
        if _is_shape(place):
            return _shape(path, name, unit)
    try:
        layers = open_scene(path, **choice).layers
    except SeveralError as error:
        if error.option in CHOICES and error.option not in choice and error.is_known:
            raise Several(path, error) from None
        raise
    except WavesplatError as error:
        is_cancelled = isinstance(error, CancelledError)
        if place is not None and place.name.lower().endswith(OF_BOTH) and not is_cancelled:
            return _shape(path, name, unit)
        raise
    guesses = tuple(guess for layer in layers for guess in layer.drawn.facts.guesses)
    notes = tuple(dict.fromkeys(guesses))
    return Found(_kind(layers), name, path, tuple(layers), notes=notes, is_part=choice != {})


def _is_shape(place: Path) -> bool:
    name = place.name.lower()
    if name.endswith((*OF_VOLUMES, *OF_BOTH)):
        return False
    return name.endswith(OF_GEOMETRY) or is_freesurfer(place)


def _shape(path: Path | str, name: str, unit: str | None) -> Found:
    shape: Any = open_geometry(path, world_unit=unit)
    return Found("shape", name, path, shape=shape, notes=tuple(shape.guesses))


def _kind(layers: Sequence[Layer]) -> Kind:
    return "labels" if len(layers) == 1 and kind_of(layers[0].looked_at) in ("labels", "mask") else "volume"


def _name(path: Path | str) -> str:
    text = safe_address(path) if is_address(path) else os.fspath(path)
    return text.rstrip("/").rpartition("/")[2] or text


def _named(found: Found) -> Found:
    """The contents with sources as they are on the user's side: files of an upload lie in no folder there."""
    shape: Any = found.shape
    if shape is not None and shape.name is None:
        # Lists name shapes without a name by their number, which changes where one is removed.
        shape = shape.with_(name=found.name)
    if found.folder is not None:
        for layer in found.layers:
            for thing in (layer.volume, layer.drawn):
                thing._source = _own_source(thing._source, found.folder)
        if shape is not None:
            shape._set(_source=_own_source(shape._source, found.folder))
    return replace(found, shape=shape)


def _own_source(source: dict[str, Any] | None, folder: Path) -> dict[str, Any] | None:
    """A source with paths relative to the folder of an upload; the user has these files, wherever they lie.

    Folders end with "/", as they are none on this side: pictures leave their names out, which may be patients'.
    """
    if source is None:
        return None
    start = str(folder.absolute())

    def own(path: str) -> str:
        if not path.startswith(start):
            return path
        return os.path.relpath(path, start) + ("/" if Path(path).is_dir() else "")

    changed: dict[str, Any] = sources.with_paths(source, own)
    return changed
