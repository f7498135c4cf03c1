"""Scenes in files: documents, reports of pictures, and PNG files, whose metadata have the document."""

from __future__ import annotations

from os import PathLike

from wavesplat._files import size_checks
from wavesplat._files.addresses import check_no_address
from wavesplat._files.paths import expanded, read_text
from wavesplat._files.reading import reading
from wavesplat._picture.png_text import KEYWORD, SIGNATURE, text_in
from wavesplat._scene import scene_json
from wavesplat._scene.scene_json import Document
from wavesplat.errors import ArgumentError


def load(path: str | PathLike[str], *, external_files: bool = False) -> Document:
    """The document in a file; relative paths in it start from the file's folder.

    external_files : whether it may name files elsewhere.
    """
    check_no_address(path, "a scene")
    place = expanded(path)
    size_checks.check_readable(place)
    with reading("a scene", path), place.open("rb") as file:
        is_png = file.read(len(SIGNATURE)) == SIGNATURE
    if is_png:
        with reading("a scene", path):
            text = text_in(place.read_bytes(), KEYWORD)
        if text is None:
            raise ArgumentError(f"this PNG file does not say how it was made; wavesplat wrote none of it: {path}")
    else:
        text = read_text(path, scene_json.WHAT)
    try:
        return scene_json.parse(text, place.absolute().parent, external_files=external_files)
    except ArgumentError as error:
        raise ArgumentError(f"{error}: {path}") from None
