"""The Python program and the shell command that draw what the viewer shows, to the byte of every pixel."""

from __future__ import annotations

import json
import shlex
from dataclasses import replace
from typing import Any, Literal, TypeAlias

from wavesplat import _native
from wavesplat._looks import look_files, presets
from wavesplat._looks.kinds import overlays
from wavesplat._looks.kinds.channel_colors import color_of
from wavesplat._looks.kinds.channel_light import light_of
from wavesplat._looks.kinds.channels import channel_look
from wavesplat._looks.labels.labels import Labels
from wavesplat._looks.look import Look
from wavesplat._looks.shading import Shading
from wavesplat._model.arguments.clips import Clip, ClipPlane, CutOut
from wavesplat._scene.documents import geometry_json, scene_json
from wavesplat._scene.layer import Layer
from wavesplat._scene.scene import names_by_themselves
from wavesplat._system.threads import collected_notes
from wavesplat._viewer.page_requests import layer_rows
from wavesplat._viewer.page_requests.seen import Shown, name_of
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError, WavesplatError

# Short forms of a state for links and commands: looks by the name of a preset, or of a colour map and its window.
#
# A look in full has some hundred numbers, one of a colour map 256 colours. Where the named look of the same volume has
# the very same fields, the name says as much.

#: The form that a state is written in.
Use: TypeAlias = Literal["document", "link", "options"]

#: Fields of a layer that may be left out where they have these values.
USUAL: dict[str, Any] = {"visible": True, "opacity": 1.0, "time": 0}


def short_document(state: ViewerState, document: dict[str, Any], use: Use = "document") -> dict[str, Any]:
    """The document, or its form for files, without what is usual and with named looks; see `short_look`."""
    layers = []
    for number, layer in enumerate(document["layers"]):
        kept = {name: value for name, value in layer.items() if name not in USUAL or value != USUAL[name]}
        if layer["name"] == names_by_themselves(state.scene.layers)[number]:
            kept.pop("name")
        layers.append({**kept, "look": short_look(state, number, use)})
    usual: dict[str, Any] = {"labels": None, "shading": "look", "clip": [], "geometry": []}
    rest = {name: value for name, value in document.items() if name not in usual or value != usual[name]}
    return {**rest, "layers": layers}


def short_look(state: ViewerState, number: int, use: Use = "document") -> dict[str, Any] | str:
    """The look of a layer: a preset's name, or {"map": name, "window": [low, high]}, or all its fields.

    use : in links and options maps may also have "threshold" and "gamma", which documents of scenes have not; in links
        maps have the background of their look too, which elsewhere the whole picture decides.
    """
    fields: dict[str, Any] = state.document["layers"][number]["look"]
    name, layer = str(fields.get("name", "")), state.scene.layers[number]
    if layer.time != 0:
        return fields
    makers: list[Any] = [lambda: Look.preset(name, layer.looked_at)] if name in presets.catalogue() else []
    makers += [lambda: Look.auto(layer.looked_at)] if name == "auto" and number == 0 else []
    behind = state.document["background"]
    for make in makers:
        found = _fields(make)
        if found == fields or (use != "link" and found is not None and _on(behind, found) == _on(behind, fields)):
            return name
    curves = fields["transfer_function"]
    if "color" not in curves or name == "auto":
        return fields
    # Maps leave the background open, which `wavesplat view` fills in.
    background = fields["background"]
    own = {"background": background} if use == "link" and background is not None else {}
    window = [curves["color"][0][0], curves["color"][-1][0]]
    for ends in (window, None):
        found = _fields(lambda: overlays.overlay(layer.looked_at, name, ends))  # noqa: B023 - called at once
        if found == {**fields, "background": None}:
            return {"map": name, **({} if ends is None else {"window": window}), **own}
    if use == "document" or not isinstance(layer.look, Look):
        return fields
    found = layer_rows.map_fields(replace(layer, look=replace(layer.look, background=None)))
    return fields if found is None else {**found, **own}


def _on(background: Any, fields: dict[str, Any]) -> dict[str, Any]:
    """The fields of a look whose open background is filled in."""
    return {**fields, "background": fields["background"] or background}


def _fields(make: Any) -> Any:
    """The fields of a look in JSON's types; None where there is no such look."""
    try:
        with collected_notes():
            return json.loads(json.dumps(look_files.fields_of(make())))
    except WavesplatError:
        return None


# Options of `wavesplat render` that draw a state, where its looks have names and nothing else is unusual.


def options_of(state: ViewerState, size: tuple[int, int]) -> str | None:
    """The arguments of the command, but for the output; None where options cannot say what the state says.

    Options are for volumes that are files opened without options of their own; the first with a preset, others with a
    preset or a colour map; or for channels of one file; no labels, cuts, geometry or light that were changed.
    """
    document, options = state.document, state.options
    is_plain = (
        document["labels"] is None
        and document["shading"] == "look"
        and not document["clip"]
        and not document["geometry"]
        and not state.scene.keep_table
        and all(field is None for field in state.color_fields)
        and isinstance(options["composite"], str)
        and isinstance(options["quality"], str)
    )
    drawn = (_channels(state) or _volumes(state)) if is_plain else None
    if drawn is None:
        return None
    arguments, operator = drawn
    look, behind = document["layers"][0]["look"], document["background"]
    if not behind == (look["background"] or "black") == "black":
        if not isinstance(behind, str):
            return None
        arguments += ["--background", behind]
    given = (("quality", "normal"), ("kernel", "linear"), ("composite", operator))
    for name, usual in given:
        arguments += [] if options[name] == usual else [f"--{name}", options[name]]
    camera = json.dumps(document["camera"], separators=(",", ":"))
    arguments += ["--size", f"{size[0]}x{size[1]}", "--camera", camera]
    return shlex.join(arguments)


def _volumes(state: ViewerState) -> tuple[list[str], Any] | None:
    """The options that name volumes and their looks, and the operator that these give; None where there are none."""
    document = state.document
    names = names_by_themselves(state.scene.layers)
    if not all(map(_is_plain_layer, document["layers"], state.sources, names)):
        return None
    looks = [short_look(state, number, "options") for number in range(len(state.sources))]
    first, *others = zip(looks, state.sources, strict=True)
    layers = [_layer_option(look, source["path"]) for look, source in others]
    if not isinstance(first[0], str) or None in layers:
        return None
    further = [part for text in layers for part in ("--layer", str(text))]
    return [first[1]["path"], "--preset", first[0], *further], document["layers"][0]["look"]["composite"]


def _channels(state: ViewerState) -> tuple[list[str], Any] | None:
    """The options that name several channels of one file, as light over their windows, and the operator; else None."""
    layers = state.scene.layers
    facts = [layer.looked_at.facts for layer in layers]
    if len(layers) < 2 or len({source.get("path") for source in state.sources}) > 1:
        return None
    own = [color_of(one.channel, one.channels) for one in facts]
    options: list[str] = []
    for number, color in enumerate(_native.distinct_colors([None] * len(layers), own)):
        source, fields = dict(state.sources[number]), state.document["layers"][number]
        which, channel, layer = source.pop("channel", None), facts[number].channel, layers[number]
        light = light_of(layer.look) if isinstance(layer.look, Look) else None
        if channel is None or light is None or not isinstance(which, int):
            return None
        if not _is_plain_layer(fields, source, channel.name or f"channel {which}"):
            return None
        for window in (None, (light.low, light.high)):
            made = _fields(lambda: channel_look(layer.looked_at, color, window, state.options["composite"]))  # noqa: B023
            if made is not None and _drawn(made) == _drawn(fields["look"]):
                ends = "" if window is None else ":" + ",".join(map(_number, window))
                options += ["--channel", f"{which}{ends}"]
                break
        else:
            return None
    return [state.sources[0]["path"], *options], "over"


def _drawn(fields: dict[str, Any]) -> dict[str, Any]:
    """The fields of a look that change a picture whose background is given."""
    return {name: value for name, value in fields.items() if name not in ("description", "background")}


def _is_plain_layer(layer: dict[str, Any], source: dict[str, Any], name: str) -> bool:
    """Whether a layer is a file without options, shown in full under the name that it has by itself."""
    path = source.get("path")
    return (
        isinstance(path, str)
        and not path.startswith("-")
        and set(source) == {"path"}
        and layer["visible"]
        and layer["opacity"] == 1
        and layer["time"] == 0
        and layer["name"] == name
    )


def _layer_option(look: dict[str, Any] | str, path: str) -> str | None:
    """The text of `--layer`: FILE:LOOK:LOW,HIGH."""
    if any(sign in path for sign in ":#,"):
        return None
    if isinstance(look, str):
        return f"{path}:{look}"
    if "map" not in look or "gamma" in look or any(sign in look["map"] for sign in ":#,"):
        return None
    window, threshold = look.get("window"), look.get("threshold")
    ends = [] if window is None else [",".join(map(_number, window))]
    return ":".join([path, look["map"], *ends, *([] if threshold is None else [f"threshold={_number(threshold)}"])])


def _number(value: float) -> str:
    """A number in as few letters as read back to it."""
    short = f"{value:g}"
    return short if float(short) == value else repr(value)


# The Python program and the shell command that draw what the viewer shows, to the byte of every pixel.

#: Placeholder for data that comes from no file.
NOT_GIVEN = "...  # give the {} here: it comes from no file"
#: Functions of `wavesplat` that change volumes, by the step in their source; other steps are methods.
FUNCTIONS = {"largest_body": "ws.largest_body", "wavelets": "ws.WaveletVolume.from_volume"}


def command_of(state: ViewerState, size: tuple[int, int], shown: Shown = "3d", *, marks: bool = False) -> str:
    """The shell command that draws the picture, by options where they can say it, else with the state in it."""
    if shown == "3d" and not marks and (options := options_of(state, size)) is not None:
        return f"wavesplat render {options} -o {shlex.quote(f'{name_of(state, shown)}.png')}\n"
    text = scene_json.write(short_document(state, state.file_document(size)))
    note = "" if _has_sources(state) else '# A volume comes from no file: name one in the field "path".\n'
    # The command must be allowed to read the files that are open here, wherever it is run.
    allowed = " --external-files" if any(source.get("path") for source in _all_sources(state)) else ""
    output = f"{name_of(state, shown)}.png"
    if shown == "3d" and not marks:
        return f"{note}wavesplat render --from - -o {output}{allowed} <<'END'\n{text}END\n"
    what = f"--shown {shown} --size {size[0]}x{size[1]}{'' if marks else ' --no-marks'}"
    return f"{note}wavesplat view --state - --save {output} {what}{allowed} <<'END'\n{text}END\n"


def movie_command_of(state: ViewerState, size: tuple[int, int]) -> str:
    """The shell command that turns the picture in space once around, as a movie.

    Raises
    ------
    ArgumentError
        If options cannot say what is shown.
    """
    # Movies have even sides.
    options = options_of(state, (max(2, size[0] // 2 * 2), max(2, size[1] // 2 * 2)))
    if options is None:
        raise ArgumentError(
            "a movie's command has no options for labels, cuts, shapes, and changed looks or light; undo these, "
            'or copy as Python and add `ws.movie(scene, "turn.mp4", ws.Turn(frames=120))`'
        )
    output = shlex.quote(f"{name_of(state, '3d')}.mp4")
    return f"wavesplat movie {options} -o {output}\n"


def python_of(state: ViewerState, size: tuple[int, int], shown: Shown = "3d", *, marks: bool = False) -> str:
    """The Python program that draws the picture."""
    output = f"{name_of(state, shown)}.png"
    lines = _scene_lines(state)
    if shown != "3d" or marks:
        view = {name: value for name, value in state.view.items() if name in ("slices", "measures", "overlays")}
        options = [f"{name}={_option(value)}" for name, value in state.options.items()]
        lines.append(
            f"viewer = ws.view(scene, {', '.join(['camera=camera', *options, f'state={view!r}'])}, browser=False)"
        )
        how = f"size={size!r}, shown={shown!r}, marks={marks!r}"
        lines += [f'viewer.save("{output}", {how})', "viewer.close()"]
    else:
        options = [f"size={size!r}", *(f"{name}={_option(value)}" for name, value in state.options.items())]
        lines += [f"picture = scene.render(camera, {', '.join(options)})", f'picture.save("{output}")']
    return "\n".join(lines) + "\n"


def _scene_lines(state: ViewerState) -> list[str]:
    """Lines that make `scene` and `camera`."""
    scene = state.scene
    lines = ["import wavesplat as ws", ""]
    names = []
    for number, (layer, source) in enumerate(zip(scene.layers, state.sources, strict=True)):
        name = "volume" if len(scene.layers) == 1 else f"volume_{number}"
        lines.append(_made(name, source, layer))
        names.append(name)
    colors: list[str | None] = []
    for name, layer, field in zip(names, scene.layers, state.color_fields, strict=True):
        if field is None:
            colors.append(None)
            continue
        lines.append(_made(f"{name}_colors", field["volume"], layer.color_from))
        colors.append(_layer(f"{name}_colors", layer.color_from, field, has_own_name=layer.color_from._has_own_name))
    own_names = names_by_themselves(scene.layers)
    arguments = [
        _layer(name, layer, state.document["layers"][n], color, has_own_name=layer.name != own_names[n])
        for n, (name, layer, color) in enumerate(zip(names, scene.layers, colors, strict=True))
    ]
    missing = _Missing(lines)
    labels = None if scene.labels is None else _labels(scene.labels, state.label_source, missing)
    shapes = [_shape(one, missing) for one in _geometry_fields(state)]
    lines += ["scene = ws.Scene(", "    ["]
    lines += [f"        {argument}," for argument in arguments]
    lines.append("    ],")
    if labels is not None:
        lines.append(f"    labels={labels},")
    if not (isinstance(scene.shading, str) and scene.shading == "look"):
        lines.append(f"    shading={_shading(scene.shading)},")
    if scene.clip:
        lines.append(f"    clip=[{', '.join(map(_clip, scene.clip))}],")
    lines.append(f"    background={scene.background!r},")
    if scene.keep_table:
        lines.append("    keep_table=True,")
    if shapes:
        lines += ["    geometry=[", *[f"        {shape}," for shape in shapes], "    ],"]
    lines.append(")")
    camera = state.camera
    lens = (
        f"parallel_scale={camera.parallel_scale!r}"
        if camera.view_angle is None
        else f"view_angle={camera.view_angle!r}"
    )
    lines.append(f"camera = ws.Camera({camera.position!r}, {camera.focal_point!r}, {camera.view_up!r}, {lens})")
    return lines


def _all_sources(state: ViewerState) -> list[dict[str, Any]]:
    labels, colors = state.label_source, [field["volume"] for field in state.color_fields if field is not None]
    return [*state.sources, *colors, *([] if labels is None else [labels])]


def _has_sources(state: ViewerState) -> bool:
    sources = [*state.sources, *(field["volume"] for field in state.color_fields if field is not None)]
    return all(source.get("path") is not None or "example" in source for source in sources)


class _Missing:
    """Names for what comes from no file: each gets a line with a remark, which cannot stand inside of an expression."""

    def __init__(self, lines: list[str]) -> None:
        self._lines, self._n = lines, 0

    def name(self, what: str) -> str:
        """A name for a thing that the user must give."""
        self._n += 1
        self._lines.append(f"given_{self._n} = {NOT_GIVEN.format(what)}")
        return f"given_{self._n}"


def _made(name: str, source: dict[str, Any], layer: Layer) -> str:
    """The line that makes the volume of a layer."""
    return f"{name} = {_volume(source) or NOT_GIVEN.format(f'volume {layer.name!r}')}"


def _volume(source: dict[str, Any]) -> str | None:
    """The expression that opens a volume; None if it comes from no file."""
    options = dict(source)
    steps = options.pop("then", [])
    if "example" in options:
        made = f"ws.examples.{options.pop('example')}({_given(options)})"
    elif options.get("path") is None:
        return None
    else:
        path = options.pop("path")
        is_series = options.pop("series_of_times", False)
        is_wavelets = isinstance(path, str) and path.lower().endswith(".wavelets")
        opener = "ws.open_series" if is_series else "ws.WaveletVolume.load" if is_wavelets else "ws.open"
        made = f"{opener}({', '.join(filter(None, (repr(path), _given(options))))})"
    for step in steps:
        ((what, arguments),) = step.items()
        if what == "times":
            bounds = [arguments.get(end) for end in ("start", "stop", "step")]
            made += f"[{':'.join('' if bound is None else str(bound) for bound in bounds)}]"
        elif what in FUNCTIONS:
            made = f"{FUNCTIONS[what]}({', '.join(filter(None, (made, _given(arguments))))})"
        else:
            made += f".{what}({_given(arguments)})"
    return made


def _given(options: dict[str, Any]) -> str:
    return ", ".join(f"{name}={value!r}" for name, value in options.items())


def _layer(
    name: str, layer: Layer, fields: dict[str, Any], color_from: str | None = None, *, has_own_name: bool
) -> str:
    given: dict[str, Any] = {"name": layer.name} if has_own_name else {}
    given |= {} if layer.visible else {"visible": False}
    given |= {} if layer.opacity == 1 else {"opacity": layer.opacity}
    given |= {} if layer.time == 0 else {"time": layer.time}
    parts = [name, _look(name, layer, fields["look"]), _given(given)]
    parts += [] if color_from is None else [f"color_from={color_from}"]
    return f"ws.Layer({', '.join(filter(None, parts))})"


def _look(name: str, layer: Layer, fields: dict[str, Any]) -> str:
    known = str(fields.get("name", ""))
    if known in presets.catalogue() and layer.time == 0:
        preset = json.loads(json.dumps(look_files.fields_of(Look.preset(known, layer.looked_at))))
        if preset == fields:
            return f"ws.Look.preset({known!r}, {name})"
    return f"ws.Look.from_json({json.dumps({'version': 1, **fields})!r})"


def _geometry_fields(state: ViewerState) -> list[dict[str, Any]]:
    """Geometry as documents have it, in JSON's types."""
    found: list[dict[str, Any]] = json.loads(json.dumps(geometry_json.fields_of(state.scene.geometry, strict=False)))
    return found


def _shape(fields: dict[str, Any], missing: _Missing) -> str:
    ((name, own),) = fields.items()
    own = {key: tuple(value) if key == "clim" else value for key, value in own.items()}
    kind = geometry_json.TYPES[name].__name__
    if (file := own.pop("file", None)) is not None:
        if file["path"] is None:
            return missing.name(name)
        options = {"kind": name, **file}
        path = options.pop("path")
        return f"ws.open_geometry({', '.join(filter(None, (repr(path), _given(options), _given(own))))})"
    volume = own.pop("volume", None)
    if isinstance(own.get("plane"), dict):
        own["plane"] = (own["plane"]["point"], own["plane"]["normal"])
    first = [] if volume is None else [_volume(volume) or missing.name("volume of a slice")]
    values = own.pop("values", None)
    if values is not None:  # in JSON what is not a number is null
        listed = ", ".join('float("nan")' if value is None else repr(value) for value in values)
        first.append(f"values=[{listed}]")
    return f"ws.{kind}({', '.join(filter(None, (*_places(own), *first, _given(own))))})"


def _places(own: dict[str, Any]) -> list[str]:
    """Arguments that are positions, which go first, taken out of the fields of a shape."""
    return [_given({name: own.pop(name)}) for name in ("vertices", "faces", "paths", "positions") if name in own]


def _labels(labels: Labels, source: dict[str, Any] | None, missing: _Missing) -> str:
    looks = ", ".join(
        f"{number}: ws.Label({look.color!r}, {_given(scene_json.settings(look, but=('color',)))})"
        for number, look in sorted(labels.labels.items())
    )
    smooth = "" if labels.smooth else ", smooth=False"
    volume = (None if source is None else _volume(source)) or missing.name("segmentation")
    return f"ws.Labels({volume}, {{{looks}}}{smooth})"


def _shading(shading: Shading | None) -> str:
    return "None" if shading is None else _call("ws.Shading", look_files.fields_of_shading(shading))


def _call(name: str, fields: dict[str, Any]) -> str:
    lights = fields.pop("lights", None)
    if lights:
        made = ", ".join(f"ws.Light({_given(light)})" for light in lights)
        return f"{name}({_given(fields)}, lights=[{made}])"
    return f"{name}({_given(fields)})"


def _clip(clip: Clip) -> str:
    if isinstance(clip, ClipPlane):
        return f"ws.ClipPlane({clip.point!r}, {clip.normal!r})"
    box = clip.crop if isinstance(clip, CutOut) else clip
    made = f"ws.Crop({tuple(box.lower)!r}, {tuple(box.upper)!r}, space={box.space!r})"
    return f"ws.CutOut({made})" if isinstance(clip, CutOut) else made


def _option(value: Any) -> str:
    if value is None or isinstance(value, str):
        return repr(value)
    return f"ws.{value!r}"
