"""XML of other programs: elements of a text, without entities."""

from __future__ import annotations

from xml.etree import ElementTree as ET

from wavesplat.errors import ArgumentError


def parsed(text: str, what: str) -> ET.Element:
    """The root element of an XML text. `what`: such as "look", for messages."""
    # Entities could stand for other files, or for gigabytes; these formats have none.
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ArgumentError(f"{what}: the XML text declares entities, which such files have not")
    try:
        return ET.fromstring(text.lstrip("\ufeff \t\r\n"))  # noqa: S314 - without entities
    except ET.ParseError as error:
        raise ArgumentError(f"{what}: not XML: {error}") from None
