"""Directive `scene-schema`: the fields of scene documents, from their JSON schema, a section for each kind of value."""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import wavesplat

SCHEMA = Path(wavesplat.__file__).parent / "_scene" / "documents" / "scene.schema.json"


def setup(app: Sphinx) -> dict[str, Any]:
    """Name the directive."""
    app.add_directive("scene-schema", SceneSchema)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


class SceneSchema(SphinxDirective):  # type: ignore[misc]  # Sphinx need not be there
    """The sections of the document itself and of all values that it is made of."""

    def run(self) -> list[nodes.Node]:
        """Return the sections."""
        self.env.note_dependency(str(SCHEMA))
        schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
        kinds = {"document": schema} | schema["$defs"]
        return [section_of(name, kind) for name, kind in kinds.items()]


def section_of(name: str, kind: Mapping[str, Any]) -> nodes.section:
    """A kind of value: what it is, and what each of its fields may hold."""
    section = nodes.section(ids=[nodes.make_id(f"schema-{name}")])
    section += nodes.title(text=name)
    if kind.get("description"):
        section += nodes.paragraph(text=kind["description"])
    if not kind.get("properties"):
        plain = {key: value for key, value in kind.items() if key != "description"}
        section += nodes.paragraph("", "", *described(plain))
        return section
    needed = kind.get("required", [])
    listed = nodes.definition_list()
    for field, value in kind["properties"].items():
        term = nodes.term("", "", nodes.literal(text=field), nodes.Text(", needed" if field in needed else ""))
        listed += nodes.definition_list_item("", term, nodes.definition("", nodes.paragraph("", "", *described(value))))
    section += listed
    return section


def described(value: Any) -> list[nodes.Node]:
    """The words for the values that are allowed, with links to the kinds that they name."""
    parts = [*references(value), *choices(value), *own_words(value)]
    if value.get("description"):
        parts.append(nodes.Text(f"{'. ' if parts else ''}{value['description']}"))
    return parts or [nodes.Text("any value")]


def references(value: Mapping[str, Any]) -> list[nodes.Node]:
    """A link to the kind that a value is of."""
    if "$ref" not in value:
        return []
    _, _, kind, *inner = value["$ref"].split("/")  # "#/$defs/layer", or a field in it: "#/$defs/layer/properties/look"
    name = f"{inner[-1]} of {kind}" if inner else kind
    return [nodes.reference("", name, refid=nodes.make_id(f"schema-{kind}"), internal=True)]


def choices(value: Mapping[str, Any]) -> list[nodes.Node]:
    """The kinds that a value may be of, one after the other."""
    parts: list[nodes.Node] = []
    for one in value.get("anyOf", []):
        if set(one) == {"required"}:  # which fields go together: the schema itself says it
            continue
        parts += [nodes.Text(", or "), *described(one)] if parts else described(one)
    return parts


def own_words(value: Mapping[str, Any]) -> list[nodes.Node]:
    """The type, the bounds, the fields and the items that stand with a value itself."""
    words: list[nodes.Node] = []
    for text in (type_of(value), bounds_of(value)):
        if text:
            words.append(nodes.Text(f"{', ' if words else ''}{text}"))
    if value.get("properties"):
        words.append(nodes.Text(" with the fields "))
        for number, (field, kind) in enumerate(value["properties"].items()):
            words += [nodes.Text(", " if number else ""), nodes.literal(text=field), nodes.Text(" ("), *described(kind)]
            words.append(nodes.Text(")"))
    if isinstance(value.get("items"), dict):
        words += [nodes.Text(" of "), *described(value["items"])]
    return words


def type_of(value: Mapping[str, Any]) -> str:
    """The type of a value, or the values that it may have."""
    if "const" in value:
        return json.dumps(value["const"])
    if "enum" in value:
        return ", ".join(json.dumps(one) for one in value["enum"])
    types = value.get("type", [])
    return " or ".join([types] if isinstance(types, str) else types)


def bounds_of(value: Mapping[str, Any]) -> str:
    """The least and the largest number, or number of items or fields."""
    words = {
        "minimum": "at least {}",
        "exclusiveMinimum": "above {}",
        "maximum": "at most {}",
        "exclusiveMaximum": "below {}",
        "minItems": "at least {} items",
        "maxItems": "at most {} items",
        "minProperties": "at least {} fields",
        "maxProperties": "at most {} fields",
        "pattern": "as {}",
    }
    return ", ".join(text.format(value[key]) for key, text in words.items() if key in value)
