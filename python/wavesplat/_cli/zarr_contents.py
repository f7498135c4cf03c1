"""Images, wells and labels in an OME-Zarr file for `wavesplat info`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wavesplat._readers import ome_zarr
from wavesplat._readers.opening import is_zarr

if TYPE_CHECKING:
    from wavesplat._cli.reader_options import ReaderOptions

__all__ = ["contents", "lines"]

#: Images, wells and labels that the text lists, at most.
N_LISTED = 40


def contents(input: str, reader: ReaderOptions) -> dict[str, Any]:
    """Facts on the images of a series, wells of a plate, and labels of an image; none of files of other kinds."""
    return ome_zarr.contents(input, reader.dataset) if is_zarr(input, **vars(reader)) else {}


def lines(facts: dict[str, Any]) -> list[str]:
    """The contents as text."""
    if "images" not in facts:
        return []
    text = []
    if facts["images"]:
        named = [f"{image['path']} {image['name']!r}" if image["name"] else image["path"] for image in facts["images"]]
        text.append(f"images       {len(named)}, choose with --dataset: {_listed(named)}")
    for well in facts["wells"][:N_LISTED]:
        n = len(well["fields"])
        fields = f"{n} field{'' if n == 1 else 's'}{': ' if n else ''}{_listed(well['fields'])}"
        text.append(f"well {well['name']:<7} {', '.join(part for part in (well['path'], fields) if part)}")
    if len(facts["wells"]) > N_LISTED:
        text.append(f"{'':<12} and {len(facts['wells']) - N_LISTED} wells more; --json has all")
    if facts["label_images"]:
        first = facts["label_images"][0]
        text.append(f"label images {_listed(facts['label_images'])}; draw one with the image: --labels {first}")
    return text


def _listed(names: list[str]) -> str:
    return ", ".join(names[:N_LISTED]) + (", ..." if len(names) > N_LISTED else "")
