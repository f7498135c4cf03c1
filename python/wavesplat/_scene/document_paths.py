"""Files and addresses that a document may name: in its folder, and on public web servers, unless more is allowed.

A document is data: a picture that somebody sent must not make a program read other files of the user, ask servers in
the user's network, or be given what only the user can give.
"""

from __future__ import annotations

import glob
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from wavesplat._files.addresses import checked, is_address, is_web, safe_address
from wavesplat._files.paths import lies_in, real_path
from wavesplat._model.argument_types import described
from wavesplat._model.private_names import CONTENT, file_of_content
from wavesplat.errors import ArgumentError, FileError

#: Largest number of characters of a path that a message quotes.
MAX_LETTERS = 120
MEND = "if you trust the document, open it with external_files=True (--external-files)"


@dataclass(frozen=True)
class Reach:
    """Files and addresses that a document may name.

    folder : absolute; relative paths start there.
    external_files : whether the user allows it to name any file or address, and files to name others.
    """

    folder: Path
    external_files: bool = False

    @property
    def within(self) -> Path | None:
        """The folder that files must lie in; None where any may be named."""
        return None if self.external_files else real_path(self.folder)

    def options(self, options: dict[str, Any], what: str) -> dict[str, Any]:
        """Options of opening a file, as the document has them, with the path checked.

        Raises
        ------
        FileError
            If it names a file elsewhere, or wants more to be read than it may.
        ArgumentError
            If a path is no text.
        """
        if options.get("external_files") and not self.external_files:
            raise FileError(f"{what} asks that the file may name other files, which only you can allow; {MEND}")
        if "cache" in options:
            raise ArgumentError(f"{what}: unknown field 'cache'; where files are written is not a document's to say")
        path = options["path"]
        found = [self.path(one, what) for one in path] if isinstance(path, list) else self.path(path, what)
        return {**options, "path": found}

    def of_name(self, path: Any) -> Reach:
        """The reach for a path: of a name alone that is not in the folder, the working directory, if it is there.

        Pictures hold names of files without their folders.
        """
        names = path if isinstance(path, list) else [path]
        if not all(isinstance(one, str) and _is_bare(one) for one in names):
            return self
        here = Path.cwd()
        is_here_alone = not any(_is_in(one, self.folder) for one in names) and all(_is_in(one, here) for one in names)
        return Reach(here, self.external_files) if is_here_alone else self

    def check_there(self, path: Any, what: str) -> None:
        """Raise a `FileError` that says where was looked for a name alone, if it is in none of these folders."""
        for name in path if isinstance(path, list) else [path]:
            here = Path.cwd()
            if isinstance(name, str) and _is_bare(name) and not (_is_in(name, self.folder) or _is_in(name, here)):
                also = "" if self.folder == here else f", nor in the working directory, {here}"
                shown = "a scan by its content" if name.startswith(CONTENT) else repr(name[:MAX_LETTERS])
                raise FileError(
                    f"{what} names {shown}, and there is no such file in the document's folder, "
                    f"{self.folder}{also}; go to the file's folder, or copy the document there"
                )

    def path(self, path: Any, what: str) -> str:
        """The absolute path, or the address, that a document names."""
        if not isinstance(path, str):
            raise ArgumentError(f"{what}: field 'path' is {described(path)}; it must be the name of a file")
        if is_address(path):
            if not (self.external_files or is_web(path)):
                raise FileError(f"{what} names {safe_address(path)!r}, which is no address of a web server; {MEND}")
            checked(path)
            return path
        named = file_of_content(path, self.folder) if path.startswith(CONTENT) else None
        place = os.path.normpath(named or self.folder / path)
        if not self.external_files:
            # Readers check what a pattern matches, what a folder holds, and other parts of a file (`check_within`).
            self._check(place, path, what)
        return place

    def _check(self, place: str, path: str, what: str) -> None:
        if "\0" in place or not lies_in(place, real_path(self.folder)):
            raise FileError(
                f"{what} names {path[:MAX_LETTERS]!r}, which lies outside of the document's folder, {self.folder}; "
                f"{MEND}, or put the file into that folder"
            )


def _is_bare(path: str) -> bool:
    """Whether a path is the name of a file alone."""
    return path not in ("", ".", "..") and "\0" not in path and not is_address(path) and not set(path) & {"/", os.sep}


def _is_in(name: str, folder: Path) -> bool:
    """Whether a folder has a file of a name, or of a content, or files that fit it where it is a pattern."""
    if name.startswith(CONTENT):
        return file_of_content(name, folder) is not None
    place = folder / name
    return os.path.lexists(place) or (glob.has_magic(name) and any(folder.glob(name)))
