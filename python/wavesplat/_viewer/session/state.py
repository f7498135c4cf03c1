"""The state of a viewer: a scene's document with the field `view`, and the scene, camera and options that it means.

States are never changed in place. What a change does not touch is shared by the states before and after, down to the
scene: a turn of the camera makes a new camera and nothing else.
The page knows no paths: its documents name what is open by numbers (`catalogue`), and the sources are put back in for
files.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from wavesplat import _native
from wavesplat._geometry.shape import Shape
from wavesplat._geometry.shape_arrays import facts_of_shapes, names_of_shapes
from wavesplat._looks import look_files
from wavesplat._looks.kinds.kinds import kind_of
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.layer_names import layer_name_of
from wavesplat._looks.look import Look
from wavesplat._model.camera.camera import Camera
from wavesplat._model.volume.private_names import whole
from wavesplat._model.volume.series import Series
from wavesplat._scene.documents import scene_json
from wavesplat._scene.documents.named_volumes import made_at
from wavesplat._scene.drawing.drawn_layers import drawn_layers
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import Scene
from wavesplat._system.values import described
from wavesplat._viewer.session.catalogue import Catalogue, Entry
from wavesplat._viewer.session.framed_cameras import FirstView
from wavesplat._viewer.session.previews import has_lazy, preview_of
from wavesplat._viewer.slices.first_slices import first_crosshair
from wavesplat.errors import ArgumentError

# Segmentations that are opened alone: their regions are labels of the scene, which the page lists, hides and colours.
#
# The automatic look of such a volume has the labels in itself, and documents of scenes hold no looks with labels.


def with_labels_apart(scene: Scene) -> Scene:
    """The scene with the labels of its only layer's look as its own; the scene itself where there are none."""
    if len(scene.layers) != 1 or scene.labels is not None:
        return scene
    (layer,) = scene.layers
    if isinstance(layer.volume, Series) or not layer.visible:
        return scene
    look = layer.look
    if look in (None, "auto") and kind_of(layer.looked_at) == "labels":
        look = Look.auto(layer.drawn)
    if not isinstance(look, Look) or look.labels is None:
        return scene
    return scene.with_(layers=[replace(layer, look=replace(look, labels=None))], labels=look.labels)


# The state of a viewer: a scene's document with the field `view`, and the scene, camera and options that it means.

WHAT = scene_json.WHAT
#: Size of the picture that is drawn to find looks, operator and camera that are not given, pixels.
FIRST_SIZE = (64, 48)
#: Fields that change the picture in space.
PICTURE = ("layers", "labels", "shading", "clip", "background", "geometry", "camera", "render")


@dataclass(frozen=True, eq=False)
class ViewerState:
    """The state of a viewer: its document, and the scene, camera and options that the document means.

    document : the JSON document, as the page has it.
    scene, camera, options : what `Scene.render` is called with; options are quality, kernel and composite.
    view : the field `view`, complete.
    """

    document: dict[str, Any]
    scene: Scene
    camera: Camera
    options: dict[str, Any]
    #: Entries of the layers, of the labels, and of the shapes, in the document's order; all that it may name.
    entries: tuple[Entry, ...]
    label_entry: Entry | None
    shape_entries: tuple[Entry, ...]
    catalogue: Catalogue
    #: The view that key 0 goes back to.
    first_view: FirstView

    @property
    def sources(self) -> tuple[dict[str, Any], ...]:
        """Sources of the volumes, as in files."""
        return tuple(entry.source or {"path": None} for entry in self.entries)

    @property
    def label_source(self) -> dict[str, Any] | None:
        """Source of the labels, as in files; None without labels."""
        return None if self.label_entry is None else self.label_entry.source

    @property
    def color_fields(self) -> tuple[dict[str, Any] | None, ...]:
        """Fields that colour layers, as in files, which the page does not change; None where a layer has none."""
        return tuple(entry.color_field for entry in self.entries)

    @property
    def view(self) -> dict[str, Any]:
        """The field `view` of the document, which only the viewer reads."""
        view: dict[str, Any] = self.document["view"]
        return view

    @classmethod
    def of(
        cls,
        scene: Scene,
        camera: Camera | str | None = None,
        options: Mapping[str, Any] | None = None,
        view: Mapping[str, Any] | None = None,
        catalogue: Catalogue | None = None,
    ) -> ViewerState:
        """The state of a scene; looks, operator and camera that are not given are found out by drawing a small picture.

        Raises
        ------
        ArgumentError
            If an argument cannot work.
        """
        scene = with_labels_apart(scene)
        given = {name: value for name, value in (options or {}).items() if name in ("quality", "kernel", "composite")}
        picture = preview_of(scene).render(camera, size=FIRST_SIZE, **{**given, "quality": "draft"})
        document = whole(picture.report["scene"])
        if has_lazy(scene):
            _as_of_all_samples(document, scene)
        if scene.shading != "look" and any(layer["look"] is None for layer in document["layers"]):
            document["shading"] = scene_json.document_of(scene, strict=False)["shading"]
        known = Catalogue() if catalogue is None else catalogue
        entries = []
        for layer, opened in zip(document["layers"], scene.layers, strict=True):
            if not isinstance(layer["look"], dict):
                # The report has no look of a layer that is hidden or has labels.
                layer["look"] = look_files.fields_of(_plain_look(scene, opened))
            fields = {"path": None, "name": str(layer_name_of(opened.volume, opened.time))}
            entries.append(known.add(opened, fields, layer["volume"], layer.pop("color_from", None)))
            layer["volume"] = dict(entries[-1].fields)
            layer["name"] = layer["name"] or opened.name
        labels, label_entry = document["labels"], None
        if labels is not None:
            label_entry = known.add(scene.labels, {"path": None}, labels["volume"])
            labels["volume"] = dict(label_entry.fields)
        shape_entries = tuple(
            known.add(shape, facts) for shape, facts in zip(scene.geometry, _facts_of_shapes(scene), strict=True)
        )
        document["background"] = document["background"] or "black"
        # It is the scene's, which the page does not change.
        document.pop("keep_table", None)
        document["geometry"] = [
            {**entry.fields, "visible": shape.visible}
            for entry, shape in zip(shape_entries, scene.geometry, strict=True)
        ]
        quality = given.get("quality", "normal")
        document["render"] = {
            "quality": quality if isinstance(quality, str) else scene_json.fields_of_sampling(quality),
            "kernel": document["render"]["kernel"],
            "composite": document["render"]["composite"],
        }
        document["view"] = _native.checked_view(view or {}, first_crosshair(scene))
        nowhere = Camera((0, 0, 1), (0, 0, 0), (0, 1, 0), parallel_scale=1)
        unseen = FirstView(nowhere, 1.0, is_framed=False)
        first = cls({}, scene, nowhere, {}, tuple(entries), label_entry, shape_entries, known, unseen)
        # In JSON's types, as the page sends it back: lists for tuples.
        return first._with(json.loads(json.dumps(document))).begun()

    def begun(self) -> ViewerState:
        """The state as one that a viewer begins with: its view is the one that key 0 goes back to."""
        width, height = FIRST_SIZE
        view = FirstView.of(self.scene, self.options["composite"], self.camera, width / height)
        self.catalogue.first_views[self.entries[0].number] = view
        return replace(self, first_view=view)

    def patched(self, operations: Sequence[Mapping[str, Any]]) -> ViewerState:
        """The state after some changes (JSON Patch).

        Raises
        ------
        ArgumentError
            If there cannot be such a state; the message names the field.
        """
        return self._with(_native.patched(self.document, operations))

    def replaced(self, document: Mapping[str, Any]) -> ViewerState:
        """The state that another document describes, of things that are open."""
        return self._with(document)

    def with_scene(self, scene: Scene) -> ViewerState:
        """The state of another scene, seen by the same camera; what it leaves open is found out."""
        view = {name: value for name, value in self.view.items() if name != "slices"}
        known = self.catalogue.reduced_to([*scene.layers, scene.labels, *scene.geometry])
        return ViewerState.of(scene, self.camera, self.options, view, known)

    def with_camera(self, camera: Camera) -> ViewerState:
        """The state seen by another camera."""
        return replace(self, camera=camera, document={**self.document, "camera": camera.as_json()})

    def framed_first(self, aspect: float) -> ViewerState:
        """The state with the first picture framed for that width over height; itself once the camera is another one."""
        if self.camera != self.first_view.camera:
            return self
        camera = self.first_view.camera_for(self.scene, self.options["composite"], aspect)
        return self if camera == self.camera else self.with_camera(camera)

    def file_document(self, size: tuple[int, int] | None = None) -> dict[str, Any]:
        """The document with the sources of volumes and labels, for files; `size`: of the picture, pixels."""
        layers = [
            {**layer, "volume": source, **({} if color is None else {"color_from": color})}
            for layer, source, color in zip(self.document["layers"], self.sources, self.color_fields, strict=True)
        ]
        own = scene_json.document_of(self.scene, strict=False)
        document = {name: value for name, value in self.document.items() if name != "geometry"} | {"layers": layers}
        document |= {name: own[name] for name in ("keep_table", "geometry") if name in own}
        if self.document["labels"] is not None:
            document["labels"] = {**self.document["labels"], "volume": self.label_source}
        if size is not None:
            document["render"] = {"size": list(size), **self.document["render"]}
        return document

    def _with(self, document: Any) -> ViewerState:
        if document is self.document:
            return self
        before = self.document
        _native.check_state(document, before)
        camera = self.camera
        if not _same(document, before, "camera"):
            camera = scene_json.camera_of(document["camera"]) or camera
        options = self.options
        if not _same(document, before, "render"):
            options = _options(document["render"])
            # A viewer's picture has the size of the view.
            document = {**document, "render": {k: v for k, v in document["render"].items() if k != "size"}}
        if not _same(document, before, "view"):
            document = {**document, "view": _native.checked_view(document["view"], first_crosshair(self.scene))}
        entries = self._entries(document)
        changes = self._changes(document, entries)
        scene = self.scene.with_(**changes) if changes else self.scene
        return replace(self, document=document, scene=scene, camera=camera, options=options, **entries)

    def _entries(self, document: Mapping[str, Any]) -> dict[str, Any]:
        """The entries that a document names, by the fields of the state that hold them."""
        if all(_same(document, self.document, name) for name in ("layers", "labels", "geometry")):
            return {}
        layers, labels, shapes = document["layers"], document["labels"], document["geometry"]
        entries = tuple(
            self._entry(one["volume"], Layer, self.entries, f"layers[{n}]: field 'volume'")
            for n, one in enumerate(layers)
        )
        return {
            "entries": entries,
            # Another volume has a view of its own, to which undo goes back too.
            "first_view": self.catalogue.first_views.get(entries[0].number if entries else 0, self.first_view),
            "label_entry": None
            if labels is None
            else self._entry(labels["volume"], Labels, (self.label_entry,), "labels: field 'volume'"),
            "shape_entries": tuple(
                self._entry(one, Shape, self.shape_entries, f"geometry[{n}]") for n, one in enumerate(shapes)
            ),
        }

    def _entry(self, fields: Any, kind: type, shown: Sequence[Entry | None], what: str) -> Entry:
        """The entry that some fields name; `shown`: those of the state, which the catalogue may have dropped."""
        number = fields.get("id")
        known = next((one for one in shown if one is not None and is_same(one.number, number)), None)
        entry = known or self.catalogue.find(number, kind, f"{WHAT}: {what}: field 'id'")
        given = {**fields, "visible": entry.fields["visible"]} if kind is Shape and "visible" in fields else fields
        if not is_same(dict(given), dict(entry.fields)):
            mend = "only its field 'visible' can be changed here" if kind is Shape else "it cannot be changed here"
            raise ArgumentError(f"{WHAT}: {what} is {described(dict(fields))}; {mend}; open another file instead")
        return entry

    def _changes(self, document: Mapping[str, Any], entries: Mapping[str, Any]) -> dict[str, Any]:
        """Scene fields that differ from the current state; what is open stays, whatever the document says of it."""
        before, changes = self.document, dict[str, Any]()
        layers = _layers(document["layers"], entries.get("entries", self.entries), self)
        if len(layers) != len(self.scene.layers) or any(
            new is not old for new, old in zip(layers, self.scene.layers, strict=True)
        ):
            changes["layers"] = layers
        made: dict[str, Callable[[], Any]] = {
            "labels": lambda: _labels(document["labels"], entries["label_entry"]),
            "shading": lambda: scene_json.shading_of(document["shading"]),
            "clip": lambda: scene_json.clips_of(dict(document)),
            "background": lambda: document["background"],
            "geometry": lambda: _shapes(document["geometry"], entries["shape_entries"]),
        }
        for name, make in made.items():
            if not _same(document, before, name):
                changes[name] = make()
        return changes


def changes_picture(before: ViewerState, after: ViewerState) -> bool:
    """Whether the picture in space may have changed."""
    return any(before.document[name] is not after.document[name] for name in PICTURE)


def changes_slices(before: ViewerState, after: ViewerState) -> bool:
    """Whether values of slices, or the colours that the page gives them, may have changed.

    The page itself follows the window, and opacities of layers.
    """
    old, new = before.document, after.document
    if old["labels"] is not new["labels"] or old["render"].get("kernel") != new["render"].get("kernel"):
        return True
    if _without(old["view"]["slices"], "window") != _without(new["view"]["slices"], "window"):
        return True
    if old["layers"] is new["layers"]:
        return False
    if len(old["layers"]) != len(new["layers"]):
        return True
    # A volume alone has the colours of its slices, whatever its look in space.
    looks = ("look",) if len(new["layers"]) == 1 else ()
    return any(
        not is_same(_without(one, "opacity", *looks), _without(other, "opacity", *looks))
        or (one["opacity"] > 0) != (other["opacity"] > 0)
        for one, other in zip(old["layers"], new["layers"], strict=True)
    )


def _without(fields: Mapping[str, Any], *names: str) -> dict[str, Any]:
    return {name: value for name, value in fields.items() if name not in names}


def _same(document: Mapping[str, Any], before: Mapping[str, Any], name: str) -> bool:
    """Whether a field is unchanged: mostly it is the very same object."""
    if name not in before:
        return False
    return is_same(document[name], before[name])


def is_same(one: Any, other: Any) -> bool:
    """Whether two JSON values are the same; 1, 1.0 and true, which are equal in Python, are not.

    A patch leaves most objects of a document in place, and an object is compared no further with itself: a layer with a
    table of thousands of numbers costs nothing where its opacity was patched.
    """
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, Mapping):
        return one.keys() == other.keys() and all(is_same(one[name], other[name]) for name in one)
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(is_same, one, other))
    # As text, since 0.0 and -0.0 are equal in Python.
    return repr(one) == repr(other)


def _as_of_all_samples(document: dict[str, Any], scene: Scene) -> None:
    """Makes a document of a coarse copy that of the scene itself: its own volumes and clips, with the looks found."""
    own = scene_json.document_of(scene, strict=False)
    for found, layer in zip(document["layers"], own["layers"], strict=True):
        found["volume"] = layer["volume"]
        if "color_from" in found:
            found["color_from"]["volume"] = layer["color_from"]["volume"]
    for name in set(own) - {"layers", "camera", "render", "background", "shading"}:
        document[name] = own[name]


def _layers(fields: list[Any], entries: Sequence[Entry], before: ViewerState) -> list[Layer]:
    # Layers as they are, by their numbers: one that moves in the list stays the same object.
    shown = {entry.number: n for n, entry in reversed(list(enumerate(before.entries)))}
    layers = []
    for number, (new, entry) in enumerate(zip(fields, entries, strict=True)):
        place = shown.get(entry.number)
        old_fields = before.document.get("layers")
        old = None if place is None or old_fields is None else old_fields[place]
        layer = entry.thing if place is None else before.scene.layers[place]
        if old is not None and is_same(new, old):
            layers.append(layer)
            continue
        what = f"{WHAT}: layers[{number}]"
        made = scene_json.layer_of(new, what, layer.volume)
        if old is not None and "look" in new and is_same(new["look"], old["look"]):
            # The look stays the same object, for which results are cached.
            made = replace(made, look=layer.look)
        if layer.color_from is not None:
            made = replace(made, color_from=layer.color_from)
        _ = made.drawn  # or an error, for times
        layers.append(made)
    return layers


def _labels(fields: Any, entry: Entry | None) -> Labels | None:
    if entry is None:
        return None
    what = f"{WHAT}: labels"
    looks = scene_json.looks_of_labels(fields, what)
    opened: Labels = entry.thing
    return made_at(what, lambda: opened.with_looks(looks or {}, smooth=fields.get("smooth", True)))


def _facts_of_shapes(scene: Scene) -> list[dict[str, Any]]:
    """Facts of the geometry that the page lists: kind, name, number of parts, and whether it is shown."""
    facts = zip(scene.geometry, names_of_shapes(scene.geometry), facts_of_shapes(scene.geometry), strict=True)
    return [
        {"kind": shape.KIND, "name": name, "count": one["count"], "visible": shape.visible}
        for shape, name, one in facts
    ]


def _shapes(fields: list[Any], entries: Sequence[Entry]) -> list[Shape]:
    """The shapes, shown or hidden as a document says."""
    return [entry.thing._with_visible(new["visible"]) for entry, new in zip(entries, fields, strict=True)]


def _plain_look(scene: Scene, layer: Layer) -> Look:
    """The look that a layer is drawn with where it is visible, without the labels that looks of segmentations bring."""
    visible = replace(layer, visible=True, opacity=layer.opacity or 1.0)
    layers = [visible if one is layer else one for one in scene.layers]
    shown = drawn_layers(scene.with_(layers=layers), None).layers
    return replace(next(one.look for one in shown if one.layer is visible), labels=None)


def _options(render: Mapping[str, Any]) -> dict[str, Any]:
    options = scene_json.options_of({name: value for name, value in render.items() if name != "size"})
    return {"quality": "normal", "kernel": "linear", "composite": None, **options}
