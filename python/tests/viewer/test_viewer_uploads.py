"""Limits of what pages send and ask for: names, sizes and places of uploads, recent files, pages from elsewhere."""

import asyncio
import contextlib
import gc
import http.client
import json
import os
import stat
import struct
import threading
import time
from pathlib import Path

import pytest
import tornado.httpclient
import tornado.websocket
import viewer_fakes
from hypothesis import given
from hypothesis import strategies as st

from wavesplat._viewer.opening import uploads
from wavesplat._viewer.opening.opening import Opener
from wavesplat._viewer.opening.start_page import Recent, state_folder
from wavesplat._viewer.opening.uploads import MAX_BYTES, MAX_FILES, Uploads, checked_parts
from wavesplat._viewer.server.messages import packed, unpacked
from wavesplat._viewer.server.server import Server
from wavesplat._viewer.session.session import Session
from wavesplat.errors import ArgumentError, FileError

pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture
def kept():
    made = Uploads()
    yield made
    made.close()


@pytest.mark.parametrize(
    "name",
    [
        *("../../x", "..", "a/../../x", "/etc/passwd", "a//b", "", ".", "a/.", "a/", "..\\x", "a\\..\\b", "a\0b"),
        *("a\nb", "x" * 256, "/".join("a" * 20), "\ud800", None, 5, ["a"], "...", " ", ". /x"),
    ],
    ids=repr,
)
def test_names_that_lead_elsewhere_are_refused(kept, name):
    upload = kept.begin("page", 1, 3)
    with pytest.raises(ArgumentError, match="the name"):
        upload.write(name, 0, b"abc")
    assert list(upload.folder.rglob("*")) == []


@given(st.text(max_size=30))
def test_any_name_lies_below_its_folder_or_is_refused(name):
    folder = Path("/below/here")
    with contextlib.suppress(ArgumentError):
        place = Path(os.path.normpath(folder.joinpath(*checked_parts(name))))
        assert folder in place.parents


def test_bytes_are_put_together_and_only_the_user_can_read_them(kept):
    upload = kept.begin("page", 2, 7)
    assert upload.write("in/ä 1.raw", 0, b"abc") == 3
    assert upload.write("in/ä 1.raw", 3, b"de") == 5
    assert upload.write("b", 0, b"fg") == 7
    assert (upload.folder / "in" / "ä 1.raw").read_bytes() == b"abcde"
    if os.name != "nt":
        assert stat.S_IMODE((upload.folder / "b").stat().st_mode) == 0o600
        assert stat.S_IMODE(upload.folder.parent.stat().st_mode) == 0o700
    root = upload.folder.parent
    kept.close()
    assert not root.exists()


@pytest.mark.skipif(os.name == "nt", reason="links need rights there")
def test_no_link_is_written_through(kept, tmp_path):
    victim = tmp_path / "victim"
    victim.write_bytes(b"abc")
    upload = kept.begin("page", 2, 9)
    (upload.folder / "link").symlink_to(victim)
    for offset in (0, 3):
        with pytest.raises((ArgumentError, FileError)):
            upload.write("link", offset, b"xyz")
    assert victim.read_bytes() == b"abc"


def test_more_than_was_said_is_refused(kept):
    upload = kept.begin("page", 1, 4)
    upload.write("a", 0, b"abc")
    for path, offset, data in (("a", 3, b"xy"), ("b", 0, b"x"), ("a", 0, b"x"), ("a", 9, b"x"), ("a", -1, b"x")):
        with pytest.raises(ArgumentError, match="upload:"):
            upload.write(path, offset, data)
    assert (upload.folder / "a").read_bytes() == b"abc"


@pytest.mark.parametrize(
    ("n_files", "n_bytes", "said"),
    [
        (1, MAX_BYTES + 1, "4 GiB in all"),
        (MAX_FILES + 1, 1, "20000 files"),
        (0, 0, "20000 files"),
        (1, -1, "whole number"),
        (None, 1, "whole number"),
        (1, True, "whole number"),
    ],
)
def test_uploads_have_limits_that_are_said(kept, n_files, n_bytes, said):
    with pytest.raises(ArgumentError, match=said):
        kept.begin("page", n_files, n_bytes)


def test_a_full_disk_is_said_before_anything_is_sent(kept, monkeypatch):
    monkeypatch.setattr(uploads.shutil, "disk_usage", lambda _: os.statvfs_result((0,) * 10) and _Usage())
    with pytest.raises(FileError, match=r"has 0.001 GB left; make room, or set TMPDIR"):
        kept.begin("page", 1, 5_000_000)


class _Usage:
    free = 1_000_000


def test_uploads_under_way_are_few_and_end_with_their_page(kept):
    made = [kept.begin("page", 1, 1) for _ in range(uploads.MAX_OPEN)]
    with pytest.raises(ArgumentError, match="under way"):
        kept.begin("other", 1, 1)
    made[0].is_complete = True
    kept.leave("page")
    assert [one.folder.exists() for one in made] == [True] + [False] * (len(made) - 1)
    kept.discard(made[0].number)
    assert not made[0].folder.exists()


def test_all_uploads_together_have_a_limit_that_is_said(kept, monkeypatch):
    monkeypatch.setattr(uploads, "MAX_TOTAL_BYTES", 3 << 30)
    monkeypatch.setattr(uploads.shutil, "disk_usage", lambda _: _Roomy())
    first = kept.begin("page", 1, 2 << 30)
    first.is_complete = True
    said = r"1 files of 1\.5 GB .* beside the 1 of 2\.15 GB .* 3 GiB; cancel .* wavesplat view FILE"
    with pytest.raises(ArgumentError, match=said):
        kept.begin("other", 1, 1_500_000_000)
    kept.discard(first.number)
    assert kept.begin("other", 1, 1_500_000_000).folder.exists()
    monkeypatch.setattr(uploads, "MAX_TOTAL_FILES", 5)
    with pytest.raises(ArgumentError, match="may be 5 files"):
        kept.begin("page", 5, 1)


class _Roomy:
    free = 1 << 40


class _Reader:
    """An object that reads on from files."""


def test_files_go_with_the_last_object_that_reads_on_from_them(kept):
    upload, other = kept.begin("page", 1, 1), kept.begin("page", 1, 1)
    first, second = _Reader(), _Reader()
    kept.discard_after(upload.number, [first, second, first])
    kept.discard_after(other.number, [])
    assert not other.folder.exists()
    del first
    time.sleep(0.05)
    assert upload.folder.exists()
    del second
    until = time.monotonic() + 20
    while upload.folder.exists() and time.monotonic() < until:
        time.sleep(0.01)
    assert not upload.folder.exists()


@pytest.mark.parametrize("end", ["close", "discard"])
def test_a_write_that_is_under_way_leaves_no_file_behind(kept, monkeypatch, end):
    upload = kept.begin("page", 1, 3)
    is_writing, may_go = threading.Event(), threading.Event()
    make_folder = Path.mkdir

    def slowly(*arguments, **options):
        is_writing.set()
        assert may_go.wait(20)
        make_folder(*arguments, **options)

    monkeypatch.setattr(Path, "mkdir", slowly)
    writing = threading.Thread(target=lambda: upload.write("in/a", 0, b"abc"))
    writing.start()
    assert is_writing.wait(20)
    ending = threading.Thread(target=kept.close if end == "close" else lambda: kept.discard(upload.number))
    ending.start()
    ending.join(0.2)
    may_go.set()
    for thread in (writing, ending):
        thread.join(20)
    assert not upload.folder.exists()
    with pytest.raises(ArgumentError, match="was cancelled"):
        upload.write("in/b", 0, b"abc")
    assert not upload.folder.exists()


def test_a_closed_viewer_takes_no_files(kept):
    root = kept.begin("page", 1, 1).folder.parent
    kept.close()
    with pytest.raises(ArgumentError, match="closed"):
        kept.begin("page", 1, 1)
    assert not root.exists()


def test_recent_files_are_few_private_and_cleared(tmp_path):
    recent = Recent(tmp_path / "state")
    assert recent.paths() == []
    for number in range(15):
        recent.add(str(tmp_path / f"{number}.nii"))
    recent.add(str(tmp_path / "9.nii"))
    names = [one["name"] for one in recent.shown()]
    assert names[:2] == ["9.nii", "14.nii"]
    assert len(names) == 12
    assert recent.shown()[0] == {"name": "9.nii", "folder": str(tmp_path), "is_there": False}
    recent.add("https://user:secret@example.org/a.zarr?key=1")
    assert "secret" not in (tmp_path / "state" / "recent.json").read_text(encoding="utf-8")
    if os.name != "nt":
        assert stat.S_IMODE((tmp_path / "state" / "recent.json").stat().st_mode) == 0o600
        assert stat.S_IMODE((tmp_path / "state").stat().st_mode) == 0o700
    recent.clear()
    assert recent.paths() == []
    assert list((tmp_path / "state").iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"[]", b"{", b'{"files": 5}', b'{"files": [1, null]}', b"\xff"])
def test_a_list_that_is_damaged_is_an_empty_one(tmp_path, content):
    (tmp_path / "recent.json").write_bytes(content)
    recent = Recent(tmp_path)
    assert recent.paths() == []
    recent.add("/a/b.nii")
    assert recent.paths() == ["/a/b.nii"]


@pytest.mark.skipif(os.name == "nt", reason="other variables there")
def test_the_list_lies_in_the_state_directory(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert state_folder() == tmp_path / "wavesplat"


# The server


@pytest.fixture
def server(tmp_path):
    made, begun = Server(), []

    def begin(state):
        begun.append(Session(state))
        made.show(begun[0])

    recent = Recent(tmp_path)
    recent.add(str(tmp_path / "patient.nii.gz"))
    opener = Opener(lambda: begun[0].state if begun else None, begin, recent)
    made.offer(opener)
    yield made
    made.close()
    opener.close()
    for session in begun:
        session.close()
    # Tornado's client leaves the sockets of refused connections to the garbage collector.
    gc.collect()


def talk(server, *messages, n=1, origin=None, host=None, token=True):
    """Answers, whole, to a hello and messages, until `n` came or the socket is closed."""

    async def run():
        headers = {"Origin": origin or f"http://127.0.0.1:{server.port}", **({"Host": host} if host else {})}
        request = tornado.httpclient.HTTPRequest(f"ws://127.0.0.1:{server.port}/socket", headers=headers)
        socket = await tornado.websocket.websocket_connect(request)
        hello = {"type": "hello", "protocol": 1}
        if token:
            hello["token"] = server.link.partition("#token=")[2]
        got = []
        with contextlib.suppress(tornado.websocket.WebSocketClosedError):  # after a hello that was refused
            for message in (packed(hello), *messages):
                await socket.write_message(message, binary=True)
        answer = b""
        while len(got) < n and answer is not None:
            answer = await asyncio.wait_for(socket.read_message(), 20)
            if answer is not None:
                got.append(unpacked(answer))
        socket.close()
        # The socket is read until it is closed at both ends; else it is left to the garbage collector.
        while answer is not None:
            answer = await asyncio.wait_for(socket.read_message(), 20)
        await asyncio.sleep(0.02)
        return got

    return asyncio.run(run())


def ask(number, question, payload=b"", **arguments):
    return packed({"type": "ask", "id": number, "question": question, "arguments": arguments}, payload)


def test_a_page_that_is_let_in_gets_the_start_page(server):
    ((start, _),) = talk(server)
    assert start["type"] == "start"
    assert start["recent"][0]["name"] == "patient.nii.gz"
    assert start["session"]


@pytest.mark.parametrize(
    ("origin", "host", "token"),
    [
        ("http://evil.example", None, True),
        ("null", None, True),
        ("https://127.0.0.1:{port}", None, True),
        ("http://evil.example", "evil.example", True),
        ("http://127.0.0.1:1", None, True),
    ],
)
def test_pages_from_elsewhere_get_nothing_and_send_nothing(server, origin, host, token):
    with pytest.raises(tornado.httpclient.HTTPError) as told:
        talk(server, ask(1, "offered"), origin=origin.format(port=server.port), host=host, token=token)
    assert told.value.code == 403


def test_without_a_key_nothing_is_told_or_stored(server):
    assert talk(server, ask(1, "upload_begin", files=1, bytes=1), ask(2, "offered"), token=False, n=2) == []
    assert server._opener._uploads._folder is None


def test_nothing_is_posted(server):
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=5)
    with contextlib.closing(connection):
        connection.request("POST", "/upload", b"abc", {"Origin": f"http://127.0.0.1:{server.port}"})
        assert connection.getresponse().status in (400, 403, 404, 405)


@pytest.mark.parametrize("value", ["a\ud800", 10**309, float("nan")], ids=["surrogate", "number", "nan"])
def test_names_and_numbers_that_nothing_can_hold_are_answered(server, value):
    half = json.dumps(
        {"type": "ask", "id": 2, "question": "upload", "arguments": {"upload": 1, "path": value}}
    ).encode()
    message = struct.pack("<I", len(half)) + half
    got = talk(server, ask(1, "upload_begin", files=1, bytes=3), message, ask(3, "offered"), n=4)
    assert [(header["type"], header.get("id")) for header, _ in got[1:]] == [
        ("answer", 1),
        ("failed", 2),
        ("answer", 3),
    ]


def test_a_page_opens_a_file_and_gets_the_session(server):
    volume = viewer_fakes.ball(12)
    header = b"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 12 12 12\nencoding: raw\n\n"
    data = header + volume.samples.tobytes()
    got = talk(
        server,
        ask(1, "upload_begin", files=1, bytes=len(data)),
        ask(2, "upload", data, upload=1, path="ball.nrrd", offset=0),
        ask(3, "open", upload=1),
        n=5,
    )
    kinds = [(header["type"], header.get("id")) for header, _ in got]
    assert kinds[:3] == [("start", None), ("answer", 1), ("answer", 2)]
    assert sorted(kinds[3:], key=str) == [("answer", 3), ("welcome", None)]
    welcome = next(header for header, _ in got if header["type"] == "welcome")
    assert [one["name"] for one in welcome["volumes"]] == ["ball.nrrd"]
    assert "wavesplat-open" not in json.dumps(welcome)


def test_a_recent_file_is_chosen_by_its_place_alone(server):
    got = talk(
        server,
        ask(1, "open", recent=0, name="other.nii.gz"),
        ask(2, "open", recent=5, name="patient.nii.gz"),
        ask(3, "open", recent="/etc/passwd", name="passwd"),
        ask(4, "open", recent=0, name="patient.nii.gz"),
        ask(5, "clear_recent"),
        n=6,
    )
    messages = {header.get("id"): header for header, _ in got}
    for number in (1, 2, 3):
        assert "the list of recent files is another one now" in messages[number]["message"]
    assert "patient.nii.gz" in messages[4]["message"]
    assert messages[5]["recent"] == []


def test_uploads_of_another_page_are_out_of_reach(server):
    async def run():
        url = f"ws://127.0.0.1:{server.port}/socket"
        origin = {"Origin": f"http://127.0.0.1:{server.port}"}
        pages = []
        for _ in range(2):
            page = await tornado.websocket.websocket_connect(tornado.httpclient.HTTPRequest(url, headers=origin))
            hello = {"type": "hello", "protocol": 1, "token": server.link.partition("#token=")[2]}
            await page.write_message(packed(hello), binary=True)
            await asyncio.wait_for(page.read_message(), 20)
            pages.append(page)
        answers = []
        for page, message in (
            (pages[0], ask(1, "upload_begin", files=1, bytes=3)),
            (pages[1], ask(2, "upload", b"abc", upload=1, path="a", offset=0)),
            (pages[0], ask(3, "upload", b"abc", upload=1, path="a", offset=0)),
            (pages[1], ask(4, "open", upload=1)),
        ):
            await page.write_message(message, binary=True)
            answers.append(unpacked(await asyncio.wait_for(page.read_message(), 20))[0])
        for page in pages:
            page.close()
            while await asyncio.wait_for(page.read_message(), 20) is not None:
                pass
        await asyncio.sleep(0.02)
        return answers

    answers = asyncio.run(run())
    assert [one["type"] for one in answers] == ["answer", "failed", "answer", "failed"]
