"""Output of commands: results on stdout, messages on stderr, reports in files; checks of paths before the work."""

from __future__ import annotations

import codecs
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wavesplat.errors import ArgumentError, FileError, WavesplatWarning

if TYPE_CHECKING:
    from wavesplat._picture.picture import Picture
    from wavesplat._storage.output import Kind

#: Facts of results that are printed together, at the end.
_COLLECTED: list[list[dict[str, Any]]] = []


def print_result(facts: dict[str, Any], text: object, *, as_json: bool, written: Path | None = None) -> None:
    """Print the facts as JSON, or the text that people read. `written`: the file that is there already."""
    if as_json and _COLLECTED:
        _COLLECTED[-1].append(facts)
    else:
        print_lines(json_text(facts) if as_json else text, written=written)


@contextmanager
def collected(*, as_json: bool) -> Iterator[None]:
    """Print the facts of all results of the block as one list, since several JSON texts in a row are no JSON."""
    if not as_json:
        yield
        return
    _COLLECTED.append([])
    try:
        yield
    finally:
        results = _COLLECTED.pop()
    print_lines(json_text({"results": results}))


def print_lines(text: object, *, written: Path | None = None) -> None:
    """Print a text; raise a `FileError` where stdout leads to a full disk."""
    try:
        print(text, flush=True)
    except BrokenPipeError:
        raise
    except OSError as error:
        _give_up_stdout()
        beside = "" if written is None else f"; what it is about is written: {written}"
        raise FileError(f"cannot print the result: {error.strerror or error}{beside}") from error


def json_text(facts: dict[str, Any]) -> str:
    """Facts as JSON; NaN and infinity, which JSON lacks, become null."""
    import json

    from wavesplat._picture.report import finite

    return json.dumps(finite(facts), indent=2, allow_nan=False, default=float)


def message(text: str) -> None:
    """Print a line on stderr, if there is a stderr."""
    if sys.stderr is not None:
        print(f"wavesplat: {text}", file=sys.stderr)


@contextmanager
def warnings_as_notes(*, quiet: bool = False) -> Iterator[None]:
    """Print each warning of the block as a note on stderr, or none of Wavesplat's if `quiet`."""
    import warnings

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", WavesplatWarning)
        yield
    for warning in caught:
        if quiet and issubclass(warning.category, WavesplatWarning):
            continue
        message(f"note: {warning.message}")


def print_notes(picture: Picture) -> None:
    """Print the notes in a picture's report, such as why it is black."""
    from wavesplat._render.lazy_layers import FROM_CACHE

    for note in picture.report.get("notes", ()):
        message(f"note: {note}")
    if FROM_CACHE in picture.report.get("lazy", {}).get("surveys", ()):
        message(f"note: range and bounds of the samples are {FROM_CACHE}")


def is_terminal() -> bool:
    """Whether stderr is a terminal, in which a progress bar can move."""
    return sys.stderr is not None and sys.stderr.isatty()


def take_any_name() -> None:
    """Print names of files as they are, also bytes and letters that the terminal's encoding does not have."""
    codecs.register_error("wavesplat", _as_bytes)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="wavesplat")


def _as_bytes(error: UnicodeError) -> tuple[bytes | str, int]:
    """Handler of encoding errors: the original byte of a file's name, else the escaped code point."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letter = ord(error.object[error.start])
    is_byte = 0xDC80 <= letter <= 0xDCFF  # as Python keeps bytes of names (PEP 383)
    return bytes([letter - 0xDC00]) if is_byte else f"\\u{letter:04x}", error.start + 1


def _give_up_stdout() -> None:
    """Send the rest of stdout to the null device: Python would try again when it ends, and complain."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)


def check_outputs(
    input: str, output: Path, kind: Kind, report: Path | None = None, *, option: str = "--output"
) -> None:
    """Raise if a result cannot be written, or would replace the input or another result. `option`: of the output."""
    from wavesplat._storage.output import check_output, check_writable
    from wavesplat._storage.paths import expanded, real_path

    check_output(output, kind)
    places = {"INPUT": expanded(input), option: output}
    if report is not None:
        check_writable(report)
        places["--report"] = report
    owners: dict[Path, str] = {}
    for name, path in places.items():
        owner = owners.setdefault(real_path(path), name)
        if owner != name:
            raise ArgumentError(f"{owner} and {name} are the same file, which would be lost; change a name: {path}")


def with_paths(facts: dict[str, Any]) -> dict[str, Any]:
    """The facts about a result with the whole paths of its volumes."""
    from wavesplat._model.volume.private_names import whole

    found: dict[str, Any] = whole(facts)
    return found


def write_report(path: Path, facts: dict[str, Any], *, embed_paths: bool) -> None:
    """Write the facts about a result to a JSON file, with paths or with names of files alone."""
    from wavesplat._model.volume.private_names import without_folders
    from wavesplat._storage.output import write_atomically

    if embed_paths:
        facts = with_paths(facts)
    else:
        # So that `picture` and `input` are treated as the paths in the scene are.
        named = without_folders({name: {"path": facts[name]} for name in ("picture", "input") if name in facts})
        facts = {**without_folders(facts), **{name: one["path"] for name, one in named.items()}}
    write_atomically(path, lambda part: part.write_text(json_text(facts) + "\n", encoding="utf-8"))
