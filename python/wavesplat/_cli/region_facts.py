"""Regions of a structure set (RTSTRUCT) for `wavesplat info`: names, colours, kinds, lines and where these lie."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from wavesplat._files.addresses import is_address
from wavesplat._files.paths import expanded
from wavesplat._readers.dicom_structures import Structure, is_structure_set, structures_in

__all__ = ["lines", "regions_of"]


def regions_of(input: str) -> dict[str, Any] | None:
    """The regions of a structure set, ready for JSON; None for other files."""
    path = Path(input if is_address(input) else expanded(input))
    if is_address(input) or not is_structure_set(path):
        return None
    return {"name": path.name, "modality": "RTSTRUCT", "regions": [_facts(region) for region in structures_in(path)]}


def _facts(region: Structure) -> dict[str, Any]:
    points = np.concatenate(region.lines) if region.lines else None
    return {
        "number": region.number,
        "name": region.name,
        "color": None if region.color is None else list(region.color),
        "kind": region.kind,
        "n_lines": len(region.lines),
        "n_open": region.n_open,
        "bounds_xyz": None if points is None else [points.min(axis=0).tolist(), points.max(axis=0).tolist()],
    }


def lines(facts: Mapping[str, Any]) -> list[str]:
    """The facts as text, a line for each region."""
    listed = [f"region {region['number']:<5} {', '.join(_parts(region))}" for region in facts["regions"]]
    return [
        f"name         {facts['name']}",
        "modality     RTSTRUCT, to draw on its scan: --contours, --labels",
        *listed,
    ]


def _parts(region: Mapping[str, Any]) -> list[str]:
    parts = [region["name"]]
    if region["color"] is not None:
        parts.append("#" + "".join(f"{round(255 * share):02x}" for share in region["color"]))
    parts += [region["kind"]] if region["kind"] else []
    parts.append(f"{region['n_lines']} lines" if region["n_lines"] else "no closed lines")
    if region["bounds_xyz"] is not None:
        lower, upper = (f"({', '.join(f'{number:.6g}' for number in corner)})" for corner in region["bounds_xyz"])
        parts.append(f"{lower} to {upper} mm")
    return parts
