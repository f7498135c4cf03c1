"""Names of inputs: without the suffixes of their formats."""

from __future__ import annotations

import os
import re
from pathlib import Path

from wavesplat._files.addresses import is_address

__all__ = ["is_folder", "stem_of"]

#: Suffixes that belong to the one after them, as in .nii.gz.
DOUBLE = re.compile(r"(\.ome)?\.zarr$|\.(nii|img|hdr|ome|seg)$", re.IGNORECASE)


def stem_of(input: str) -> str:
    """Name of an input without its suffixes."""
    path = Path(input) if is_address(input) else Path(os.path.expanduser(input))  # noqa: PTH111
    stem = path.name if is_folder(path) and path.suffix.lower() != ".zarr" else path.stem
    return DOUBLE.sub("", stem)


def is_folder(path: Path) -> bool:
    """Whether a path is a folder; False for impossible names, which fail where they are opened or written."""
    return os.path.isdir(path)  # noqa: PTH112
