"""The viewer's link, handed to the browser in a file that only the user can read.

Arguments of a process are public: as one, the link and its token could be read, and used first, by other users of the
machine. Jupyter hands its links over in the same way.
"""

from __future__ import annotations

import contextlib
import html
import shutil
import tempfile
import weakref
import webbrowser
from pathlib import Path

PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={link}">
<title>Wavesplat</title>
<p><a href="{link}">Open the viewer</a></p>
</html>
"""


class BrowserLink:
    """A page in a file that sends the browser on to a link, until it is removed or Python ends."""

    def __init__(self, link: str) -> None:
        folder = tempfile.mkdtemp(prefix="wavesplat-")  # only the user can enter it
        self._remove = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        self.path = Path(folder) / "viewer.html"
        try:
            self.path.touch(0o600, exist_ok=False)
            self.path.write_text(PAGE.format(link=html.escape(link)), encoding="utf-8")
        except OSError:
            self.remove()
            raise

    def open(self) -> bool:
        """Show the link in the browser; False if there is none."""
        opened = False
        with contextlib.suppress(webbrowser.Error):
            opened = webbrowser.open(self.path.as_uri())
        if not opened:
            self.remove()
        return opened

    def remove(self) -> None:
        """Delete the file and its folder."""
        self._remove()
