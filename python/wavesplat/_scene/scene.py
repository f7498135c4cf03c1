"""Scenes, and the cache that a scene keeps between pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import zip_longest
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from wavesplat._geometry.shape import Shape
from wavesplat._geometry.shape_arrays import as_shapes, is_geometry
from wavesplat._looks.curves import colors
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.layer_names import FoundName, distinct_names, layer_name_of
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.clips import Clip, Clipping, clip_tuple, combined_clips
from wavesplat._model.arguments.types import takes_its_types, takes_options
from wavesplat._model.camera.camera import Camera
from wavesplat._model.interchange.convert_from import is_rows
from wavesplat._model.volume.series import Series
from wavesplat._model.volume.sources import beside, warn_of_elsewhere
from wavesplat._picture.picture import Picture
from wavesplat._public import public
from wavesplat._render.options import DrawOptions, RenderOptions
from wavesplat._scene.labelled_layers import labelled_layers
from wavesplat._scene.layer import AnyLook, Layer
from wavesplat._storage import json_texts
from wavesplat._storage.paths import expanded
from wavesplat._system.values import described
from wavesplat.errors import ArgumentError

if TYPE_CHECKING:
    from typing import Unpack

#: Largest number of layers of a scene.
MAX_LAYERS = 8
#: Largest numbers of kept facts and looks, three for a layer, and of kinds of pictures with kept measurements.
MAX_KEPT, MAX_MEASURED = 3 * MAX_LAYERS, 3

T = TypeVar("T")


@dataclass(eq=False)
class Cache:
    """Results that a scene keeps between its pictures."""

    #: Chosen looks and other facts, each with the identity of the samples that it was found from.
    looks: dict[Any, tuple[Any, Any]] = field(default_factory=dict)
    #: Transfer functions, and their fields in documents.
    documents: dict[int, tuple[Any, Any]] = field(default_factory=dict)
    #: Errors measured for a wanted PSNR, by kind of picture, each with what the picture showed.
    measured: dict[Any, tuple[Any, Any]] = field(default_factory=dict)
    #: Arrays of shapes, by the sides that grids of frames lie on, each with the identity of what they were made from.
    shapes: dict[Any, tuple[Any, Any]] = field(default_factory=dict)

    def get_or_compute(self, key: Any, identity: object, find: Callable[[], T]) -> T:
        """The result of `find`, computed once for the samples that `identity` stands for.

        Kept results may hold samples, so only a few are kept.
        """
        found = self.looks.get(key)
        if found is None or found[0] != identity:
            if len(self.looks) >= MAX_KEPT:
                self.looks.clear()
            found = self.looks[key] = identity, find()
        value: T = found[1]
        return value

    def shapes_of(self, key: Any, identity: object, make: Callable[[], T]) -> T:
        """The result of `make`, called once for the shapes that `identity` stands for."""
        found = self.shapes.get(key)
        if found is None or found[0] != identity:
            others = {other: kept for other, kept in self.shapes.items() if kept[0] == identity}
            found = identity, make()
            self.shapes = {**others, key: found}
        value: T = found[1]
        return value

    def remember(self, key: Any, shown: object, found: object) -> None:
        """Cache a picture's measurements; evict the measurements of the oldest kind of picture."""
        self.measured.pop(key, None)
        self.measured[key] = shown, found
        while len(self.measured) > MAX_MEASURED:
            self.measured.pop(next(iter(self.measured)), None)


@public
@dataclass(frozen=True, init=False, eq=False)
class Scene:
    """Volumes, how they are shown, and where they are cut: all that a picture has but the camera.

    It is frozen in what it shows; `with_` makes changed copies. What is prepared for its pictures is kept.

    Parameters
    ----------
    layers : Volume, WaveletVolume, array, Layer, or up to eight of them in a list
        What is shown; `geometry` may stand among them. An array of xarray with an axis of channels (C) is a layer for
        each, in a colour of its own; one with an axis of times (T) is a series. At a point of space the extinctions of
        layers add and their colours mix by extinction; projections are made of each layer, and their colours added as
        light.
    look : Look, TransferFunction, TransferFunction2D, Materials or str, optional
        How values are shown, as for `Layer`; for several volumes one for each, in a list. Layers bring their own.
    labels : Labels, optional
        A segmentation of the first layer's volume, with a look for every label; for "over".
    shading : Shading, None or "look"
        Phong shading of "over" and `FirstHit`; None draws the colours as given, "look" takes each look's own.
    clip : Crop, ClipPlane, CutOut or several of them
        `Crop` keeps a box, `ClipPlane` keeps a side of a plane, `CutOut` takes a box out. A box in samples
        counts the samples of the first layer.
    background : colour, optional
        (r, g, b), (r, g, b, a), "#rrggbb" or a name. None is the first look's background or, where it has none,
        transparent.
    keep_table : bool, default False
        Draw the table below a patient in a CT. Else pictures leave it out, of every layer in memory, where it can be
        recognized, but for minima; the report's `notes` say so, and the samples stay. For all times of a series it is
        decided once.
    geometry : Surface, Lines, Points, SlicePlane, Frame, or several of them in a list
        What stands in space with the volumes, in world coordinates, each thing at its depth: matter before it dims it,
        and matter behind what is opaque is hidden. Meshes of `mesh`, and what those types take of other libraries, go
        in as they are.

    Raises
    ------
    ArgumentError
        If an argument cannot work.

    Examples
    --------
    >>> import wavesplat as ws
    >>> pelvis = ws.examples.ct_pelvis()
    >>> scene = ws.Scene(pelvis, "ct-bone", background="black")
    >>> front, left = (scene.render(view, size=(32, 32)) for view in ("front", "left"))
    >>> scene.with_(clip=ws.ClipPlane((0, 0, 0), (0, 1, 0))).clip[0].normal
    (0.0, 1.0, 0.0)
    """

    layers: tuple[Layer, ...]
    labels: Labels | None
    shading: Shading | Literal["look"] | None
    clip: tuple[Clip, ...]
    background: str | tuple[float, ...] | None
    keep_table: bool
    geometry: tuple[Shape, ...]
    _clipping: Clipping = field(init=False, repr=False)
    _cache: Cache = field(init=False, repr=False)

    def __init__(
        self,
        layers: Any,
        look: AnyLook | Sequence[AnyLook] = None,
        *,
        labels: Labels | None = None,
        shading: Shading | Literal["look"] | None = "look",
        clip: Clip | Iterable[Clip] = (),
        background: str | Sequence[float] | None = None,
        keep_table: bool = False,
        geometry: Any = (),
    ) -> None:
        given: object = shading
        if not (labels is None or isinstance(labels, Labels)):
            raise ArgumentError(f"labels is a {type(labels).__name__}; give a wavesplat.Labels(segmentation, ...)")
        if not (given is None or isinstance(given, Shading) or (isinstance(given, str) and given == "look")):
            raise ArgumentError(f'shading is {described(shading)}; give a wavesplat.Shading or None or "look"')
        if not isinstance(keep_table, bool):
            raise ArgumentError(f"keep_table is {described(keep_table)}; give True or False")
        clips = clip_tuple(clip)
        colors.parse(background)  # or an error
        layers, among = _parted(layers)
        values: dict[str, Any] = {
            "layers": _with_distinct_names(_layers(layers, look)),
            "labels": labels,
            "shading": shading,
            "clip": clips,
            "background": background if background is None or isinstance(background, str) else tuple(background),
            "keep_table": keep_table,
            "geometry": as_shapes([*among, *(geometry if isinstance(geometry, list | tuple) else [geometry])]),
            "_clipping": combined_clips(clips),
            "_cache": Cache(),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def with_(self, **changes: Any) -> Scene:
        """The scene with another field, of those that it is made with, such as `layers`; it shares what is kept.

        Raises
        ------
        ArgumentError
            If there is nothing of that name to change, or it cannot work.

        Examples
        --------
        >>> import wavesplat as ws
        >>> scene = ws.Scene(ws.examples.ripples(8))
        >>> scene.with_(background="white").background
        'white'
        """
        names = ("layers", "labels", "shading", "clip", "background", "keep_table", "geometry")
        for name in changes:
            if name not in names:
                raise ArgumentError(f"a scene has no {name!r} to change; it has {', '.join(names)}")
        given = {name: changes.get(name, getattr(self, name)) for name in names}
        changed = Scene(given.pop("layers"), **given)
        object.__setattr__(changed, "_cache", self._cache)
        return changed

    def at_time(self, time: int) -> Scene:
        """The scene at another time: of every layer that is a series, the volume of that number.

        Raises
        ------
        ArgumentError
            If no layer is a series, or one has no such time.

        Examples
        --------
        >>> import wavesplat as ws
        >>> series = ws.Series([ws.examples.ripples(n) for n in (8, 12, 16)])
        >>> scene = ws.Scene(ws.Layer(series))
        >>> scene.at_time(-1).layers[0].drawn.shape
        (16, 16, 16)
        """
        if not any(isinstance(layer.volume, Series) for layer in self.layers):
            raise ArgumentError(f"{self!r} has no layer with several times; make one of wavesplat.open_series(...)")
        layers = [replace(layer, time=time) if isinstance(layer.volume, Series) else layer for layer in self.layers]
        for layer in layers:
            _ = layer.drawn  # or an error
        return self.with_(layers=layers)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Corners (lower, upper) of the world box around all layers, shape (2, 3), as (x, y, z)."""
        corners = np.array([layer.drawn.bounds for layer in self.layers])
        return np.stack([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])

    @property
    def is_anatomical(self) -> bool:
        """Whether the first layer's axes are a patient's: x to the right, y to the front, z up."""
        return self.layers[0].drawn.is_anatomical

    def to_json(self) -> str:
        """The scene as a JSON text, which `from_json` reads back; volumes are named by their files.

        Raises
        ------
        ArgumentError
            If a volume or the labels come from no file.

        Examples
        --------
        >>> import wavesplat as ws
        >>> scene = ws.Scene(ws.examples.ct_pelvis(), "ct-bone", background="black")
        >>> ws.Scene.from_json(scene.to_json()).background
        'black'
        """
        from wavesplat._scene.documents import scene_json

        return scene_json.write(scene_json.document_of(self))

    @classmethod
    @takes_its_types
    def from_json(cls, text: str, folder: str | PathLike[str] | None = None, *, external_files: bool = False) -> Scene:
        """The scene that a JSON text describes, as `to_json` writes it; its volumes are opened.

        Parameters
        ----------
        text : str
            A document, or the report of a picture, which has one.
        folder : path, optional
            Where relative paths in it start, and what it names must lie; None is the working directory.
        external_files : bool, default False
            Whether it may name files elsewhere, servers in private networks, and files that name others; for texts
            that you trust.

        Raises
        ------
        ArgumentError
            If it is no such text; the message names the field.
        FileError
            If a volume cannot be opened, or may not.
        """
        from wavesplat._scene.documents import scene_json

        place = None if folder is None else expanded(folder).absolute()
        return scene_json.parse(text, place, external_files=external_files).scene

    @takes_its_types
    def save_volumes(
        self, path: str | PathLike[str], *, downsampling: Literal["mean", "nearest"] | None = None
    ) -> None:
        """Write the samples of all layers to one file, a channel each, with their times where they are series.

        Parameters
        ----------
        path, downsampling
            As for `Volume.save`; `.ome.tif` and `.ome.zarr` hold several channels. Channels have the names of the
            layers, and the colours, in `.ome.zarr` also the windows, of their looks; where a look is not a
            `Look.channel`, the colour and window of the volume. Layers that are not visible are written too, as such in
            `.ome.zarr`.

        Raises
        ------
        FileError
            If the suffix is unknown or the file cannot be written; an existing file is replaced only by a whole one.
        ArgumentError
            If the layers differ in shape, place or number of times, or one has no samples.

        Examples
        --------
        >>> import numpy as np, wavesplat as ws
        >>> cells = [ws.Volume(np.random.default_rng(n).random((8, 8, 8), np.float32), unit="um") for n in (1, 2)]
        >>> looks = [ws.Look.channel(cells[0], "blue", (0, 1)), ws.Look.channel(cells[1], "green", (0.5, 1))]
        >>> scene = ws.Scene([ws.Layer(*pair, name=name) for *pair, name in zip(cells, looks, ("DAPI", "GFP"))])
        >>> scene.save_volumes("cells.ome.tif")
        >>> [layer.name for layer in ws.open_scene("cells.ome.tif").layers]
        ['DAPI', 'GFP']
        """
        from wavesplat._scene.documents import scene_files as scene_volumes

        scene_volumes.save(self.layers, path, downsampling)

    @takes_its_types
    def save(self, path: str | PathLike[str]) -> None:
        """Write the scene to a JSON file; paths of volumes that lie below its folder, or beside it, are relative to it.

        Raises
        ------
        FileError
            If the file cannot be written; nothing is left behind.
        ArgumentError
            If a volume or the labels come from no file.

        Warns
        -----
        WavesplatWarning
            If a volume does not lie in the folder of the file, so that `load` needs `external_files=True`.

        Examples
        --------
        >>> import wavesplat as ws
        >>> ws.Scene(ws.examples.ct_pelvis(), "ct-bone").save("bones.json")
        >>> ws.Scene.load("bones.json").layers[0].look
        'ct-bone'
        """
        from wavesplat._scene.documents import scene_json

        document = beside(scene_json.document_of(self), expanded(path).absolute().parent)
        json_texts.save(path, scene_json.write(document))
        warn_of_elsewhere(document, path, stacklevel=3)

    @classmethod
    @takes_its_types
    def load(cls, path: str | PathLike[str], *, external_files: bool = False) -> Scene:
        """The scene in a file: one that `save` wrote, the report of a picture, or a PNG file that `render` made.

        Parameters
        ----------
        path : path
            The file. What it names must lie in its folder, or on a public web server.
        external_files : bool, default False
            Whether it may name files elsewhere, servers in private networks, and files that name others; for files
            that you trust.

        Raises
        ------
        FileError
            If the file, or a volume, cannot be read, or may not.
        ArgumentError
            If there is no scene in it; the message names the field.
        """
        from wavesplat._scene.documents import scene_files

        return scene_files.load(path, external_files=external_files).scene

    @takes_its_types
    @takes_options(RenderOptions, DrawOptions)
    def render(
        self,
        camera: Camera | str | None = None,
        **options: Unpack[RenderOptions],
    ) -> Picture:
        """A picture of the scene.

        Parameters
        ----------
        camera : Camera or str, optional
            As for `wavesplat.render`.
        **options : RenderOptions
            As for `wavesplat.render`.

        Raises
        ------
        ArgumentError
            If an argument cannot work; the message says which, and how to mend it.
        LimitError
            If the picture needs more memory than there may be.
        CancelledError
            If `progress` returned False.

        Notes
        -----
        With `psnr` the first picture of a scene is measured, some tiles of it drawn with several samplings. The errors
        found are used for the next ones, be they from other sides or with another `psnr`, and these are drawn without
        measuring anything: for the frames of a turn, say. The farther the view turns, the less that promises, which
        `expected_psnr_spread_db` in the report shows. Where a picture showed nothing, or pixels are more than 1.5 times
        as far apart or as close as they were, in samples, the next one is measured all the same. A new `Scene`
        measures its first picture.

        Examples
        --------
        >>> import wavesplat as ws
        >>> scene = ws.Scene(ws.examples.ripples(16))
        >>> frames = [scene.render(ws.Camera.orbit(scene.layers[0].volume, a), size=(24, 24), psnr=40) for a in (0, 9)]
        >>> frames[0].report["expected_psnr_spread_db"] < frames[1].report["expected_psnr_spread_db"]
        True
        """
        from wavesplat._scene.drawing.drawing import draw

        return draw(self, camera, DrawOptions(**options))

    def __reduce__(self) -> tuple[Any, ...]:
        names = ("labels", "shading", "clip", "background", "keep_table", "geometry")
        how = {name: getattr(self, name) for name in names}
        return partial(Scene, **how), (self.layers,)

    def __repr__(self) -> str:
        names = ", ".join(repr(layer.name) for layer in self.layers)
        return f"<Scene: {names}>"


def as_scene(
    what: Any,
    look: Any,
    *,
    labels: Any,
    shading: Any,
    clip: Any,
    background: Any,
    keep_table: bool = False,
    geometry: Any = (),
) -> Scene:
    """A scene of volumes or layers; or the scene itself, changed by what is given."""
    if not isinstance(what, Scene):
        given = {"labels": labels, "shading": shading, "clip": clip, "background": background}
        return Scene(what, look, **given, keep_table=keep_table, geometry=geometry)
    if look is not None:
        raise ArgumentError(
            "a scene brings its looks; leave out look, or change its layers with scene.with_(layers=...)"
        )
    changes = {"labels": labels, "background": background, "clip": clip_tuple(clip) or None}
    changes["keep_table"] = keep_table or None
    changes["geometry"] = (*what.geometry, *shapes) if (shapes := as_shapes(geometry)) else None
    changes = {name: value for name, value in changes.items() if value is not None}
    if not (isinstance(shading, str) and shading == "look"):
        changes["shading"] = shading
    return what.with_(**changes) if changes else what


def _parted(what: Any) -> tuple[Any, list[Any]]:
    """Layers, and the geometry that stands among them in a list."""
    if not isinstance(what, list | tuple) or is_rows(what):
        if is_geometry(what):
            raise ArgumentError(f"{described(what)} stands in space with volumes; give one too: Scene([volume, ...])")
        return what, []
    among = [thing for thing in what if is_geometry(thing)]
    if not among:
        return what, []
    layers = [thing for thing in what if not is_geometry(thing)]
    if not layers:
        raise ArgumentError("the scene has geometry and no volume; give at least one volume too")
    return layers, among


def _layers(what: Any, look: Any) -> tuple[Layer, ...]:
    if isinstance(what, Scene):
        raise ArgumentError("this is a scene already; change it with scene.with_(...), or take its layers")
    # Rows of numbers are samples; volumes, layers and arrays in a list are several layers.
    several = isinstance(what, list | tuple) and not is_rows(what)
    things = list(what) if several else labelled_layers(what, has_looks=look is not None) or [what]
    if not 1 <= len(things) <= MAX_LAYERS:
        raise ArgumentError(f"a scene has 1 to {MAX_LAYERS} layers, not {len(things)}")
    looks = list(look) if isinstance(look, list | tuple) else [look] * len(things)
    if len(looks) != len(things):
        raise ArgumentError(
            f"there are {len(looks)} looks for {len(things)} volumes; give one for each, or one for all"
        )
    return tuple(_layer(thing, one) for thing, one in zip(things, looks, strict=True))


def _with_distinct_names(layers: tuple[Layer, ...]) -> tuple[Layer, ...]:
    """The layers, renamed so that no two layers without a name from the user have the same name."""
    names = names_by_themselves(layers, [None if isinstance(one.name, FoundName) else one.name for one in layers])
    return tuple(one if one.name == name else one._with_name(name) for one, name in zip(layers, names, strict=True))


def names_by_themselves(layers: Sequence[Layer], given: Sequence[str | None] = ()) -> list[str]:
    """The default names of the layers of one scene. `given`: names from the user, or None, by layer."""
    # Start from the names without numbers: a layer that one was numbered against may be gone.
    alone = [name or layer_name_of(one.volume, one.time) for one, name in zip_longest(layers, given)]
    return distinct_names(alone, lambda n: layers[n].drawn.facts.description)


def _layer(thing: Any, look: Any) -> Layer:
    if not isinstance(thing, Layer):
        return Layer(thing, look)
    if look is None:
        return thing
    if thing.look is not None:
        raise ArgumentError(f"layer {thing.name!r} has a look, and another one is given; leave out one of them")
    return replace(thing, look=look)
