"""Materials as JSON: one object, with a version, whose errors name the field; and the presets, one such file each.

{"version": 1, "opacity_unit": 1.0,
 "materials": [{"name": "bone", "probability": [[150, 0], [300, 1]],
                "color": [1, 0.95, 0.85], "opacity": 0.4, "density": 3}]}
"""

from __future__ import annotations

from dataclasses import asdict
from importlib.resources import files
from os import PathLike
from typing import Any

from wavesplat import _native
from wavesplat._looks.curves.materials import Material, Materials
from wavesplat._storage import json_texts
from wavesplat.errors import ArgumentError

WHAT = "materials"
PRESETS = files("wavesplat._looks.presets") / "materials"


def write(materials: Materials) -> str:
    """JSON text of materials; numbers read back exactly."""
    listed = [asdict(material) for material in materials.materials]
    return json_texts.write({"opacity_unit": materials.opacity_unit, "materials": listed})


def load(path: str | PathLike[str]) -> Materials:
    """The materials in a file."""
    return json_texts.load(path, WHAT, parse)


def parse(text: str) -> Materials:
    """The materials in a JSON text."""
    document = json_texts.parse(text, WHAT, "materials")
    entries, unit = _native.materials_fields(document)
    return Materials((_material(entry, number) for number, entry in enumerate(entries)), unit)


def preset(name: str) -> Materials:
    """See `Materials.preset`."""
    if name not in preset_names():
        raise ArgumentError(f"unknown preset of materials {name!r}; use one of: {', '.join(preset_names())}")
    return parse((PRESETS / f"{name}.json").read_text(encoding="utf-8"))


def preset_names() -> list[str]:
    """Names of all presets, in alphabetical order."""
    return json_texts.names_in(PRESETS)


def _material(entry: Any, number: int) -> Material:
    _native.check_material(entry, number)
    try:
        return Material(**entry)
    except ArgumentError as error:
        raise ArgumentError(f"materials: field 'materials', number {number}: {error}") from None
