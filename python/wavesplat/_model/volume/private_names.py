"""Documents without names of folders and of patients' scans: what pictures, reports and other published files hold.

A path becomes the name of its file. The name of a scan of a patient, by its format or by what it holds, may be the
patient's, so such a file is named by its content: `content:`, its size and a digest, by which it is found again in a
folder, whatever it is called (`_scene.documents.named_volumes`). A path becomes null where neither would do: a folder
of slices, a pattern with wildcards for folders or for scans, a header with samples in another file, two files of one
name. Stores of Zarr are folders that users name as files.
"""

from __future__ import annotations

import glob
import hashlib
import os
from collections.abc import Collection
from functools import lru_cache
from pathlib import Path, PurePath
from typing import Any

from wavesplat._model.volume.sources import with_paths
from wavesplat._storage.addresses import is_address, last_part

#: Beginning of a path that names a file by its content.
CONTENT = "content:"
#: Suffixes of headers whose samples may lie in another file.
HEADERS = (".hdr", ".img", ".nhdr", ".mhd", ".head", ".par")
#: Suffixes of formats for scans of patients. DICOM files have other suffixes or none, so a suffix that is no word
#: counts too.
OF_SCANS = (
    *(*HEADERS, ".nii", ".nii.gz", ".mgh", ".mgz", ".mnc", ".rec", ".v", ".nrrd", ".mha", ".dcm", ".dicom", ".ima"),
    *(".gipl", ".gipl.gz", ".zip", ".img.gz", ".brik", ".brik.gz"),
)
#: Files of at most `MAX_WHOLE` bytes are read whole for their digest, larger ones in `N_BLOCKS` parts of `BLOCK` bytes.
MAX_WHOLE, N_BLOCKS, BLOCK = 1 << 24, 64, 1 << 16


class Published(dict[str, Any]):
    """A document without folders and patients' names.

    whole : the same with paths; not written by `json` and not shown by `repr`.
    private : paths that name scans of patients though their suffixes do not say so.
    """

    whole: dict[str, Any]
    private: frozenset[str]


def published(document: dict[str, Any], private: Collection[str] = ()) -> Published:
    """The document as files hold it. `private`: paths that name scans of patients."""
    made = Published(without_folders(document, private))
    made.whole, made.private = document, frozenset(private)
    return made


def with_fields(document: dict[str, Any], **fields: Any) -> dict[str, Any]:
    """The document with other fields, which may hold paths."""
    if not isinstance(document, Published):
        return {**document, **fields}
    return published({**document.whole, **fields}, document.private)


def whole(document: Any) -> Any:
    """The document, or the report with documents in it, with paths."""
    if isinstance(document, Published):
        return document.whole
    if isinstance(document, dict):
        return {name: whole(part) for name, part in document.items()}
    return [whole(part) for part in document] if isinstance(document, list) else document


def without_folders(document: Any, private: Collection[str] = ()) -> Any:
    """The document, or the report, with names of files in place of paths; see the module."""
    paths: dict[str, str | None] = {}

    def look(path: str) -> str:
        paths[path] = file_name_of(path, is_private=path in private)
        return path

    with_paths(document, look)
    given = list(paths.values())
    chosen = {
        path: None if given.count(name) > 1 and not (name or "").startswith(CONTENT) else name
        for path, name in paths.items()
    }
    return with_paths(document, chosen.__getitem__)


def file_name_of(path: str, *, is_private: bool = False) -> str | None:
    """A file's name or the name of its content, or the last part of an address; None if it may be a folder."""
    if is_address(path):
        return last_part(path)
    if path.startswith(CONTENT):  # of a document that was read
        return path
    parts = PurePath(path)
    is_zarr = parts.suffix.lower() == ".zarr"
    if path.endswith("/") and not is_zarr:  # a folder that need not be here, such as one that a page sent
        return None
    if glob.has_magic(str(parts.parent)) and not os.path.lexists(path):
        return None
    if Path(path).is_dir() and not is_zarr:
        return None
    if is_private or _is_of_scan(parts.name):
        return content_of(path)
    return parts.name


def content_of(path: str) -> str | None:
    """The name of a file by its content; None if it cannot be read or its samples lie in another file."""
    try:
        state = Path(path).stat()
        if path.lower().endswith(HEADERS):
            return None
        return _content_of(path, state.st_size, state.st_mtime_ns)
    except OSError:
        return None


def file_of_content(name: str, folder: Path) -> Path | None:
    """The file in a folder whose content has this name; None if there is none."""
    size = name.removeprefix(CONTENT).partition("-")[0]
    try:
        with os.scandir(folder) as entries:
            paths = sorted(one.path for one in entries if one.is_file() and str(one.stat().st_size) == size)
    except OSError:
        return None
    return next((Path(path) for path in paths if content_of(path) == name), None)


@lru_cache(maxsize=64)
def _content_of(path: str, size: int, changed: int) -> str:  # noqa: ARG001 - a changed file has another content
    digest = hashlib.sha256()
    with open(path, "rb") as file:  # noqa: PTH123
        if size <= MAX_WHOLE:
            digest.update(file.read())
        else:
            for number in range(N_BLOCKS):
                file.seek((size - BLOCK) * number // (N_BLOCKS - 1))
                digest.update(file.read(BLOCK))
    return f"{CONTENT}{size}-{digest.hexdigest()[:32]}"


def _is_of_scan(name: str) -> bool:
    """Whether a file has a suffix of scans, or one that is no word, as DICOM files have that are named by numbers."""
    if name.lower().endswith(".zarr.zip"):
        return False
    suffix = PurePath(name).suffix
    return name.lower().endswith(OF_SCANS) or not any(letter.isalpha() for letter in suffix)
