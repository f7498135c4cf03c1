"""Hints for unknown commands: the command that does what the name asks for, or the commands for a file without one."""

from __future__ import annotations

from collections.abc import Collection
from difflib import get_close_matches
from pathlib import Path

__all__ = ["hint"]

#: Words that people use, in other programs too -> the command.
WORDS: dict[str, str] = {
    **dict.fromkeys(
        ("draw", "plot", "picture", "image", "screenshot", "snapshot", "export", "volume", "vr", "mip"), "render"
    ),
    **dict.fromkeys(("open", "show", "viewer", "gui", "serve", "browse", "display", "ui", "app", "start"), "view"),
    **dict.fromkeys(("video", "animate", "animation", "turntable", "turn", "rotate", "spin", "gif"), "movie"),
    **dict.fromkeys(("slices", "mpr", "ortho", "reslice", "section", "lightbox", "montage", "plane"), "slice"),
    **dict.fromkeys(("header", "describe", "inspect", "stats", "metadata", "dump", "ls", "list"), "info"),
    **dict.fromkeys(("save", "write", "transcode", "copy", "resample"), "convert"),
    **dict.fromkeys(("transfer-function", "look", "lut"), "tf"),
    **dict.fromkeys(("isosurface", "surface", "contour", "stl", "marching-cubes", "segment"), "mesh"),
    **dict.fromkeys(("gpu", "gpus", "devices", "vulkan"), "gpu-check"),
    **dict.fromkeys(("example", "examples", "try", "tour"), "demo"),
    **dict.fromkeys(("cost", "estimate", "dry-run"), "plan"),
    **dict.fromkeys(("looks", "styles", "preset"), "presets"),
    **dict.fromkeys(("compress", "wavelets", "levels"), "wavelet"),
}
#: Least similarity, 0..1 (`difflib`), from which a name counts as a misspelt command.
ALIKE = 0.7


def hint(name: str, commands: Collection[str]) -> str:
    """The hint for an unknown command. `commands`: the names of all."""
    word = name.lower().replace("_", "-")
    if word in WORDS:
        return f"write wavesplat {WORDS[word]}"
    if near := get_close_matches(word, [*commands, *WORDS], 1, ALIKE):
        return f"did you mean {WORDS.get(near[0], near[0])}?"
    if Path(name).suffix or "/" in name or "\\" in name or Path(name).exists():
        return f"for a picture of a file write wavesplat render {name}, to look at it wavesplat view {name}"
    return "wavesplat --help lists the commands"
