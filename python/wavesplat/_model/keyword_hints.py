"""Hints for unknown keyword arguments: the argument that is meant by a keyword of our commands or of other programs.

Similar spelling is the last resort: `view` is not `device`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from difflib import get_close_matches

#: Keywords that people try -> keywords that may be meant, the first that a function has; after a comma, what to give.
MEANT: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(
        ("view", "azimuth", "elevation", "zoom", "perspective", "view_angle", "viewpoint", "cpos", "direction"),
        ('camera, the name of a view, such as "xy", or a wavesplat.Camera', "plane"),
    ),
    **dict.fromkeys(("orientation", "axis"), ("plane", 'camera, the name of a view, such as "xy"')),
    **dict.fromkeys(("z", "slice", "index", "slice_index"), ("position, in world units",)),
    **dict.fromkeys(
        ("cmap", "colormap", "colour_map", "preset", "tf", "transfer_function", "opacity", "lut"),
        ("look", "transfer_function, the name of a preset or a TransferFunction"),
    ),
    **dict.fromkeys(
        ("clim", "window", "vmin", "vmax", "contrast_limits"),
        ("clim", "look, wavesplat.Look.auto(volume).changed(...)"),
    ),
    **dict.fromkeys(("projection", "mode", "blending", "mip", "operator", "rendering"), ("composite", "slab")),
    **dict.fromkeys(("iso", "iso_value", "isovalue", "isosurface"), ("composite, wavesplat.FirstHit(value)",)),
    **dict.fromkeys(("light", "lights", "lighting", "shade", "occlusion", "ambient"), ("shading",)),
    **dict.fromkeys(("clipping", "clip_plane", "clip_planes", "cut_out", "crop", "roi"), ("clip",)),
    **dict.fromkeys(("bg", "bgcolor", "background_color"), ("background",)),
    **dict.fromkeys(("width", "height", "window_size", "resolution"), ("size, (width, height)",)),
    **dict.fromkeys(("segmentation", "seg", "masks"), ("labels, a wavesplat.Labels",)),
    **dict.fromkeys(("lines", "points", "surfaces", "mesh", "meshes", "tracks"), ("geometry",)),
    **dict.fromkeys(("gpu", "backend"), ("device",)),
    **dict.fromkeys(("n_threads", "workers", "n_jobs"), ("threads",)),
    **dict.fromkeys(("voxel_size", "scale", "pixel_size"), ("spacing",)),
    **dict.fromkeys(("channels", "c"), ("channel", "channels")),
    **dict.fromkeys(("t", "timepoint", "frame"), ("time",)),
}
#: Keywords for things that another function does -> that function.
ELSEWHERE = {
    **dict.fromkeys(
        ("scale_bar", "scalebar", "colorbar", "colourbar", "legend", "title", "letters", "dpi"),
        "annotate the picture: picture.annotated({}=...)",
    ),
    **dict.fromkeys(("output", "out", "filename", "save"), "save the picture: picture.save(path)"),
    **dict.fromkeys(
        ("layer", "layers", "overlay"), "give several volumes: wavesplat.Scene([volume, wavesplat.Layer(...)])"
    ),
    **dict.fromkeys(("exposure", "gamma"), "change the look: wavesplat.Look.auto(volume).changed({}=...)"),
    **dict.fromkeys(("smooth", "sigma"), "smooth the volume: volume.smoothed(...)"),
    **dict.fromkeys(("time", "channel", "spacing", "unit", "level"), "say it to wavesplat.open: open(path, {}=...)"),
    "labels": "give a scene: wavesplat.Scene(volume, labels=...)",
}
#: Least similarity, 0..1 (`difflib`), from which a name counts as misspelt.
ALIKE = 0.7


def check_keywords(function: Callable[..., object], given: Collection[str], known: Collection[str]) -> None:
    """Raise a `TypeError`, as Python does, for the first keyword that a function does not take, with a hint."""
    called = function.__name__ if function.__name__ != "__init__" else function.__qualname__.split(".")[0]
    for name in given:
        if name not in known:
            raise TypeError(f"{called}() got an unexpected keyword argument {name!r}{_hint(name, known)}")


def _hint(name: str, known: Collection[str]) -> str:
    for meant in MEANT.get(name, ()):
        keyword, _, how = meant.partition(", ")
        if keyword in known:
            return f"; write {keyword}={f' ({how})' if how else ''}"
    near = get_close_matches(name, known, 1, ALIKE)
    if near:
        return f"; is it {near[0]!r}?"
    return f"; {ELSEWHERE[name].format(name)}" if name in ELSEWHERE else ""
