"""Reading of files by libraries: bounded streams, XML without entities, and errors as one line that helps."""

from __future__ import annotations

import gzip
import io
import lzma
import mmap
import re
import struct
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree as ET

from wavesplat._system.libraries import how_to_install
from wavesplat._system.memory import free_bytes
from wavesplat.errors import ArgumentError, FileError, LimitError, WavesplatError

# Files as streams for libraries that read as many bytes as a file says, and take the memory for them first.
#
# A damaged length of four bytes is up to 4 GB: of an element of DICOM, or of the header of a .npy file.


class BoundedFile(io.BufferedReader):
    """A file to read, in parts that are no longer than the file."""

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path))
        self._n_bytes = path.stat().st_size

    def read(self, n: int | None = -1, /) -> bytes:
        """The next bytes, fewer at the end."""
        return super().read(n if n is None else min(n, self._n_bytes))


# XML of other programs: elements of a text, without entities.


def parsed(text: str, what: str) -> ET.Element:
    """The root element of an XML text. `what`: such as "look", for messages."""
    # Entities could stand for other files, or for gigabytes; these formats have none.
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ArgumentError(f"{what}: the XML text declares entities, which such files have not")
    try:
        return ET.fromstring(text.lstrip("\ufeff \t\r\n"))  # noqa: S314 - without entities
    except ET.ParseError as error:
        raise ArgumentError(f"{what}: not XML: {error}") from None


# Errors of the libraries that read files, as one line that a user can act on.

#: Beginning of the line that ITK adds to every failure: the system's last error, of some earlier call, or "Success".
OLD_REASON = "Reason: "

#: A place in a library's source, and the prefix of ITK's messages: "itk::ERROR: Class(0x5555): ", "[nrrd] function: ".
SOURCE = re.compile(r"(?<!\S)\S*\.[ch](?:xx|pp)?:\d+:\s*")
ITK_PLACE = re.compile(r"^((itk::|ITK )ERROR: \w+\(\w+\): |sitk::ERROR: |\[\w+\] \w+: )")

#: The file in ITK's messages, which we name ourselves.
ITK_FILE = " for reading"

#: Messages of libraries in C and C++ that get no memory. HDF5's image buffer holds its own structure: it is too large
#: only where a length in the file is wrong.
NO_MEMORY = re.compile(
    r"bad.?alloc|(?:[Ff]ailed|[Uu]nable|[Cc]annot) to allocate"
    r"|[Mm]emory allocation failed(?! for on disk image buffer)"
)

#: Exceptions that mean missing or wrong bytes.
TRUNCATION_ERRORS = (EOFError, zlib.error, lzma.LZMAError, zipfile.BadZipFile, gzip.BadGzipFile, struct.error)
#: Words of messages that mean missing or wrong bytes.
TRUNCATION_WORDS = re.compile(
    r"truncate|truncati[no]|unexpected end|end of (?:the )?file|end-of-stream|too (?:short|early)|checksum|corrupt"
    r"|damaged|got only|but received|not enough (?:data|bytes)|no data left|is cut"
    # Of numcodecs: Zstd and LZ4 say no more, whether bytes are missing or wrong; which of both depends on the release.
    r"|decompression error|error during \w+ decompression|bad input data",
    re.IGNORECASE,
)
#: Packages that no extra brings, in messages of libraries: of fsspec for a protocol, of tifffile for a compression.
MISSING = re.compile(r"Install (s3fs|gcsfs) to access|(?:requires the|No module named) '(imagecodecs)'")
#: Packages that only some files need -> the extra that installs them.
EXTRAS = {"aiohttp": "http"}

GIB = 1 << 30
#: Maximum number of letters of a library's message that are searched: some messages repeat the whole file.
MAX_LETTERS = 20_000


@contextmanager
def mapped(path: Path) -> Iterator[mmap.mmap]:
    """The bytes of a file, mapped into memory until the block ends."""
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        yield content


@contextmanager
def reading(kind: str, path: object, *, other_form: str | None = None) -> Iterator[None]:
    """Turn whatever a library raises while it reads into one line that names the kind and the path.

    other_form : what to do where no error says that bytes are missing or wrong, such as of a library that reads some
    forms of a format alone; None says that the file may be damaged.
    Parsers of damaged files raise nearly anything (KeyError, struct.error, zlib.error, MemoryError, ...), so this is
    the one place that catches everything.
    """
    try:
        yield
    except WavesplatError:
        raise
    except Exception as error:
        if isinstance(error, MemoryError) or NO_MEMORY.search(str(error)):
            raise LimitError(_memory_line(kind, path)) from error
        line = _without_path(_informative_line(error), str(path))
        raise FileError(f"cannot read as {kind}: {line}; {_advice(error, other_form)}: {path}") from error


def _advice(error: Exception, other_form: str | None) -> str:
    """The end of a message: bytes are called missing or wrong only where the error says so."""
    if named := MISSING.search(str(error)):
        return f"a package is missing; run: pip install {named[1] or named[2]}"
    if isinstance(error, ImportError):
        extra = next((extra for name, extra in EXTRAS.items() if name in str(error)), None)
        return f"a package is missing; {how_to_install(extra) if extra else 'install it with pip'}"
    if isinstance(error, FileNotFoundError):
        return "it is not there; check the name"
    if isinstance(error, PermissionError):
        return "check its permissions"
    if isinstance(error, ConnectionError | TimeoutError) or type(error).__module__.startswith("aiohttp"):
        return "the server does not answer, or refuses; check the address, and try again"
    if isinstance(error, TRUNCATION_ERRORS) or TRUNCATION_WORDS.search(str(error)):
        return "the file is truncated or damaged; copy or export it again"
    return other_form or (
        "the file is damaged, or of a form that wavesplat does not read; export it again, or in another format"
    )


def _memory_line(kind: str, path: object) -> str:
    free = free_bytes()
    has = "" if free is None else f", of which this machine has {free / GIB:.1f} GiB"
    return f"reading {kind} takes more memory than there is{has}; use a smaller or coarser file: {path}"


def _without_path(line: str, path: str) -> str:
    """A library's message without the path, which ends ours."""
    return re.sub(rf"""(?:\b[Ff]ile )?(["']?){re.escape(path)}\1""", "it", line) if path else line


def _informative_line(error: BaseException) -> str:
    """The first line of an error's message that says something, or its type.

    ITK begins with a line of its own source and goes from the general to the particular: of it, the last.
    """
    lines = [line.strip().rstrip(".;") for line in str(error)[:MAX_LETTERS].splitlines() if line.strip()]
    lines = [line for line in lines if not line.startswith(OLD_REASON)] or lines
    if len(lines) > 1 and SOURCE.search(f"{lines[0]}:"):
        lines = [lines[-1].partition(": ")[0] if lines[-1].endswith(ITK_FILE) else lines[-1]]
    return ITK_PLACE.sub("", SOURCE.sub("", lines[0])) if lines else type(error).__name__
