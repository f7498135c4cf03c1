"""Files of meshes: PLY, STL, OBJ and glTF by trimesh, 3MF here; and names of labels as names of files.

3MF is a zip archive with a model in XML: meshes, each with a name and a material, whose colour is sRGB.
Source: 3MF Core Specification 1.3, https://github.com/3MFConsortium/spec_core.
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Sequence
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from wavesplat._system.libraries import library

# Names of labels as names of files, for all file systems, each different from the others.

#: Characters that Windows, macOS or Linux refuse in a name, or shells read: all but letters, digits and a few signs.
UNSAFE = re.compile(r"[^\w.+()-]+")
#: Names of devices on Windows, with any suffix.
DEVICES = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?$", re.IGNORECASE)
#: Largest number of characters, of four bytes each at most: names of files have 255 bytes.
MAX_LETTERS = 50


def safe_names(names: Sequence[str], numbers: Sequence[int]) -> list[str]:
    """The names, with `_` for what is not safe; those that differ in case alone end in the label's number."""
    found = [UNSAFE.sub("_", name)[:MAX_LETTERS].strip("._ ") for name in names]
    found = [f"_{name}" if DEVICES.match(name) else name for name in found]
    alike = [name.casefold() for name in found]
    return [
        f"{name or 'label'}_{number}" if not name or alike.count(name.casefold()) > 1 else name
        for name, number in zip(found, numbers, strict=True)
    ]


# Files of meshes: PLY, STL, OBJ and glTF by trimesh; 3MF here, since trimesh writes it by lxml and without colours.

#: Suffixes of formats that hold several meshes with names and colours.
OF_PARTS = (".3mf", ".glb", ".gltf")
#: Units of 3MF; lengths in others are written as numbers of millimetres.
UNITS = {"um": "micron", "mm": "millimeter", "cm": "centimeter", "m": "meter"}
#: Colour of meshes without one: like bone.
GREY = (0.9, 0.88, 0.84)

CONTENT_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""
RELATIONSHIPS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"""


def encoded(parts: Sequence[Any], suffix: str) -> bytes:
    """The content of a file of one `Mesh`, or of several in a format that holds them."""
    if suffix == ".3mf":
        return _threemf(parts)
    if suffix in (".glb", ".gltf"):
        return _gltf(parts, suffix)
    (mesh,) = parts
    options: dict[str, Any] = {".ply": {"vertex_normal": True}, ".obj": {"include_normals": True}}.get(suffix, {})
    content = mesh.to_trimesh().export(file_type=suffix[1:], **options)
    return content.encode() if isinstance(content, str) else bytes(content)


def _gltf(parts: Sequence[Any], suffix: str) -> bytes:
    trimesh = library("trimesh", extra="mesh")
    scene = trimesh.Scene()
    for part in parts:
        surface = part.to_trimesh()
        if part.color is not None:
            # Factors of glTF are linear light; colours here are sRGB.
            factor = [*(_linear(share) for share in part.color), 1.0]
            material = trimesh.visual.material.PBRMaterial(
                name=part.name, baseColorFactor=factor, metallicFactor=0.0, roughnessFactor=0.7
            )
            surface.visual = trimesh.visual.TextureVisuals(material=material)
        name = part.name or None
        scene.add_geometry(surface, node_name=name, geom_name=name)
    export = library("trimesh.exchange.gltf", extra="mesh")
    if suffix == ".glb":
        return bytes(export.export_glb(scene, include_normals=True))
    files = export.export_gltf(scene, include_normals=True, merge_buffers=True, embed_buffers=True)
    return bytes(files["model.gltf"])


def _linear(share: float) -> float:
    """Light of an sRGB share (IEC 61966-2-1)."""
    return share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4


def _threemf(parts: Sequence[Any]) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        # A fixed time, so that the same meshes make the same file.
        for name, text in (
            ("[Content_Types].xml", CONTENT_TYPES),
            ("_rels/.rels", RELATIONSHIPS),
            ("3D/3dmodel.model", _model(parts)),
        ):
            archive.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)
    return content.getvalue()


def _model(parts: Sequence[Any]) -> str:
    unit = UNITS.get(parts[0].unit or "mm", "millimeter")
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<model unit="{unit}" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">',
        '<resources><basematerials id="1">',
    ]
    for part in parts:
        red, green, blue = (round(255 * share) for share in part.color or GREY)
        lines.append(f'<base name={_text(part)} displaycolor="#{red:02X}{green:02X}{blue:02X}FF"/>')
    lines.append("</basematerials>")
    for number, part in enumerate(parts):
        lines.append(f'<object id="{number + 2}" type="model" name={_text(part)} pid="1" pindex="{number}">')
        lines.append("<mesh><vertices>")
        # Nine digits are all that a float32 has.
        places = part.vertices.astype(np.float32).tolist()
        lines += [f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>' for x, y, z in places]
        lines.append("</vertices><triangles>")
        lines += [f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in part.faces.tolist()]
        lines.append("</triangles></mesh></object>")
    lines.append("</resources><build>")
    lines += [f'<item objectid="{number + 2}"/>' for number in range(len(parts))]
    lines.append("</build></model>")
    return "\n".join(lines)


def _text(part: Any) -> str:
    """The name as an attribute, without what XML cannot hold."""
    return quoteattr("".join(letter for letter in part.name if letter.isprintable()) or "surface")
