"""MetaImage headers whose samples are in a file with a percent sign in its name, and the header that ITK gets instead.

ITK takes every such name for a pattern of numbered files, "slice%03d.raw 1 20 1". It is handed a header that names a
link to the file.
"""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from wavesplat._readers.detached_samples import MAX_HEADER_BYTES

#: The line that names the file, and ends the header.
NAMED = re.compile(rb"(?m)^[ \t]*ElementDataFile[ \t]*[=:][^\n]*")


@contextmanager
def meta_for_itk(path: Path, fields: dict[str, str], places: Sequence[tuple[Path, int]]) -> Iterator[Path]:
    """The file for ITK: itself, or another header, for as long as it is read. `places`: files that hold the samples."""
    name = fields.get("elementdatafile", "")
    if "%" not in name or len(places) != 1 or places[0][0].name != Path(name).name:
        yield path
        return
    with path.open("rb") as file:
        content = file.read(MAX_HEADER_BYTES)
    with tempfile.TemporaryDirectory() as made:
        link = Path(made) / "samples"
        try:
            link.symlink_to(places[0][0].absolute())
        except OSError:  # Windows, without the right to make links
            shutil.copyfile(places[0][0], link)
        header = Path(made) / "header.mhd"
        header.write_bytes(NAMED.sub(b"ElementDataFile = samples", content))
        yield header
