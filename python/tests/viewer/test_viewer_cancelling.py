"""Cancelling in the page what is opened: readers stop between files, results are thrown away, files are removed."""

import threading
import time
from pathlib import Path

import numpy as np
import pytest
import tifffile
import viewer_fakes
from dicom_files import random, save, slice_at
from opening_pages import Asker, nifti_of, scan_samples
from test_viewer_uploads import ask, server, talk  # noqa: F401 - `server` is a fixture

import wavesplat as ws
from wavesplat._readers.dicom import reading as dicom
from wavesplat._readers.dicom import series
from wavesplat._readers.tiff import tiff
from wavesplat._system.threads import cancelled_by, check_cancelled
from wavesplat._viewer.opening import opening
from wavesplat._viewer.opening.opening import Opener
from wavesplat._viewer.server.messages import packed
from wavesplat._viewer.session.session import Session
from wavesplat.errors import CancelledError


@pytest.fixture
def page():
    """A page of a session that shows a ball."""
    session = Session(viewer_fakes.state_of())
    opener = Opener(lambda: session.state)
    yield Asker(opener)
    opener.close()
    session.close()


class Pending:
    """A question that was asked, and its answer."""

    def __init__(self, page, number, question, **arguments):
        self.page, self.number, self.came, self.got = page, number, threading.Event(), []
        header = {"type": "ask", "id": number, "question": question, "arguments": arguments}
        page.opener.receive(page.owner, self._take, header, b"")

    def _take(self, header, _):
        self.got.append(header)
        self.came.set()

    def cancel(self, owner=None):
        self.page.opener.cancel(owner or self.page.owner, {"type": "cancel", "id": self.number})

    def answer(self):
        assert self.came.wait(60)
        return self.got[0]


def slowed(monkeypatch, module, name):
    """Make a function wait: events that it was called, and may go on, and the arguments of its calls."""
    is_called, may_go, calls, made = threading.Event(), threading.Event(), [], getattr(module, name)

    def slow(*arguments, **options):
        calls.append(arguments)
        is_called.set()
        assert may_go.wait(60)
        return made(*arguments, **options)

    monkeypatch.setattr(module, name, slow)
    return is_called, may_go, calls


def tiff_slices(n):
    """Bytes of slices of TIFF, by their names."""
    made = {}
    for number in range(n):
        path = Path(f"slice{number}.tif")
        tifffile.imwrite(path, np.full((9, 8), number, np.uint8))
        made[f"stack/{path}"] = path.read_bytes()
    return made


def test_a_reader_stops_between_slices_and_its_files_go(page, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    upload = page.send(tiff_slices(6))
    folder = page.opener._uploads.get(upload).folder
    is_called, may_go, calls = slowed(monkeypatch, tiff, "check_pages")
    pending = Pending(page, 900, "open", upload=upload)
    assert is_called.wait(60)
    pending.cancel("another page")
    pending.cancel()
    may_go.set()
    assert pending.answer()["code"] == "cancelled"
    assert len(calls) < 6
    assert not folder.exists()
    assert page.opener._read == {}


def test_the_result_of_a_reader_that_cannot_stop_is_thrown_away(page, monkeypatch):
    is_called, may_go, _ = slowed(monkeypatch, opening, "found_at")
    upload = page.send({"scan.nii.gz": nifti_of(scan_samples())})
    folder = page.opener._uploads.get(upload).folder
    pending = Pending(page, 900, "open", upload=upload)
    assert is_called.wait(60)
    # One that waits behind it is not begun.
    other = page.send({"other.nii.gz": nifti_of(scan_samples())})
    waiting = Pending(page, 901, "open", upload=other)
    waiting.cancel()
    pending.cancel()
    may_go.set()
    assert [pending.answer()["code"], waiting.answer()["code"]] == ["cancelled", "cancelled"]
    assert not folder.exists()
    assert page.opener._uploads._uploads == {}
    assert page.opener._read == {}


def test_a_cancel_that_comes_after_the_answer_forgets_what_was_read(page):
    upload = page.send({"scan.nii.gz": nifti_of(scan_samples())})
    folder = page.opener._uploads.get(upload).folder
    pending = Pending(page, 900, "open", upload=upload)
    opened = pending.answer()["opened"]
    pending.cancel()
    assert not folder.exists()
    assert "open it again" in page.refusal("show", opened=opened, how="replace")


def test_a_show_that_is_cancelled_changes_nothing(page, monkeypatch):
    opened = page.open({"scan.nii.gz": nifti_of(scan_samples())})["opened"]
    is_called, may_go, _ = slowed(monkeypatch, opening, "scene_with")
    pending = Pending(page, 900, "show", opened=opened, how="replace")
    assert is_called.wait(60)
    pending.cancel()
    may_go.set()
    assert pending.answer()["code"] == "cancelled"
    assert page.opener._uploads._uploads == {}


def test_what_a_page_that_goes_was_opening_goes_with_it(page, monkeypatch):
    is_called, may_go, _ = slowed(monkeypatch, opening, "found_at")
    upload = page.send({"scan.nii.gz": nifti_of(scan_samples())})
    folder = page.opener._uploads.get(upload).folder
    pending = Pending(page, 900, "open", upload=upload)
    assert is_called.wait(60)
    page.opener.leave(page.owner)
    may_go.set()
    assert pending.answer()["code"] == "cancelled"
    assert not folder.exists()
    assert page.opener._read == {}


def test_a_page_without_a_session_can_cancel(server, monkeypatch):  # noqa: F811 - the fixture
    begin = ask(1, "upload_begin", files=1, bytes=3)
    piece = ask(2, "upload", b"abc", upload=1, path="a.nii", offset=0)
    cancel = packed({"type": "cancel", "id": 3})

    def slow(_):
        until = time.monotonic() + 20
        while time.monotonic() < until:
            check_cancelled()
            time.sleep(0.01)

    monkeypatch.setattr(opening, "paths_in", slow)
    got = talk(server, begin, piece, ask(3, "open", upload=1), cancel, n=4)
    assert got[-1][0]["code"] == "cancelled"
    assert server._opener._uploads._uploads == {}


def test_readers_ask_between_files(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "stack").mkdir()
    for name, data in tiff_slices(5).items():
        (tmp_path / name).write_bytes(data)
    for n_asked in (1, 3):
        left = iter(range(n_asked))
        with cancelled_by(lambda left=left: next(left, None) is None), pytest.raises(CancelledError):
            ws.open(tmp_path / "stack")
    assert ws.open(tmp_path / "stack").shape == (5, 9, 8)


def test_dicom_stops_between_headers_and_between_pixels(monkeypatch, tmp_path):
    save(tmp_path, [slice_at(one, n) for n, one in enumerate(random(5))])
    for module, name in ((series, "header_of"), (dicom, "frames_in")):
        read, made = [], getattr(module, name)
        monkeypatch.setattr(module, name, lambda one, read=read, made=made: read.append(one) or made(one))
        with cancelled_by(lambda read=read: len(read) >= 2), pytest.raises(CancelledError):
            ws.open(tmp_path)
        assert len(read) == 2
    assert ws.open(tmp_path).shape[0] == 5
