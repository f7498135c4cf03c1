"""The viewer's server: its answers, and the connections that it refuses."""

import asyncio
import contextlib
import gc
import gzip
import http.client
import json
import re
import struct
from pathlib import Path
from urllib.request import url2pathname

import pytest
import tornado.httpclient
import tornado.websocket
import viewer_fakes
from hypothesis import given
from hypothesis import strategies as st

from wavesplat._viewer.server.connections import Tokens
from wavesplat._viewer.server.messages import MAX_BYTES, packed, unpacked
from wavesplat._viewer.server.server import Server
from wavesplat._viewer.session.session import Session
from wavesplat.errors import ArgumentError

pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


@pytest.fixture(scope="module")
def session():
    made = Session(viewer_fakes.state_of())
    yield made
    made.close()


@pytest.fixture(scope="module")
def server(session):
    """One server for all tests: each asks it for a link of its own."""
    made = Server()
    made.show(session)
    yield made
    made.close()
    # Tornado's client leaves the sockets of refused connections to the garbage collector.
    gc.collect()


def get(server, path="/", method="GET", **headers):
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=5)
    connection.putrequest(method, path, skip_host="Host" in headers)
    for name, value in headers.items():
        connection.putheader(name.replace("_", "-"), value)
    connection.endheaders()
    with contextlib.closing(connection):
        response = connection.getresponse()
        return response.status, dict(response.getheaders()), response.read()


def token_of(server):
    return server.link.partition("#token=")[2]


def talk(server, *messages, origin="own", host=None, n=1, path="/socket"):
    """Headers of the answers to messages, until `n` came or the socket is closed, and the close code."""

    async def run():
        headers = {}
        if origin is not None:
            headers["Origin"] = f"http://127.0.0.1:{server.port}" if origin == "own" else origin
        if host is not None:
            headers["Host"] = host
        request = tornado.httpclient.HTTPRequest(f"ws://127.0.0.1:{server.port}{path}", headers=headers)
        socket = await tornado.websocket.websocket_connect(request)
        for message in messages:
            data = packed(message) if isinstance(message, dict) else message
            await socket.write_message(data, binary=not isinstance(data, str))
        got = []
        answer = b""
        while len(got) < n and answer is not None:
            answer = await asyncio.wait_for(socket.read_message(), 8)
            if answer is not None:
                got.append(unpacked(answer)[0])
        code = socket.close_code if answer is None else None
        socket.close()
        # The socket is read until it is closed at both ends; else it is left to the garbage collector.
        while answer is not None:
            answer = await asyncio.wait_for(socket.read_message(), 8)
        await asyncio.sleep(0.02)
        return got, code

    return asyncio.run(run())


def hello(server):
    return {"type": "hello", "protocol": 1, "token": token_of(server)}


def test_the_page_has_all_it_needs(server):
    status, headers, body = get(server)
    assert status == 200
    scripts = re.findall(rb'"(/[\w-]+\.js)"', body)
    assert len(scripts) >= 2
    assert "default-src 'none'" in headers["Content-Security-Policy"]
    assert f"ws://127.0.0.1:{server.port}" in headers["Content-Security-Policy"]
    assert "unsafe" not in headers["Content-Security-Policy"]
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Cross-Origin-Opener-Policy"] == "same-origin"
    assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
    assert headers["Referrer-Policy"] == "no-referrer"
    assert "Server" not in headers
    assert "Access-Control-Allow-Origin" not in headers
    for path in (*(script.decode() for script in scripts), "/favicon.svg"):
        assert get(server, path)[0] == 200


def test_scripts_travel_compressed_and_once(server):
    paths = [path for path in server.files if path.endswith(".js")]
    assert len(paths) >= 3
    body = get(server)[2].decode()
    first = [path for path in paths if f'"{path}"' in body]
    for path in paths:
        status, headers, plain = get(server, path)
        assert (status, "Content-Encoding" in headers) == (200, False)
        # The name has the hash of the content, so a browser need not ask again.
        assert "immutable" in headers["Cache-Control"]
        assert headers["Vary"] == "Accept-Encoding"
        _, headers, small = get(server, path, **{"Accept-Encoding": "br, gzip"})
        assert headers["Content-Encoding"] == "gzip"
        assert gzip.decompress(small) == plain
        assert get(server, path, **{"Accept-Encoding": "gzip;q=0, br"})[2] == plain
    # curl --compressed of what the page loads before it shows anything.
    assert sum(len(get(server, path, **{"Accept-Encoding": "gzip"})[2]) for path in first) < 60_000
    assert get(server)[1]["Cache-Control"] == "no-store"


def test_another_address_is_told_how_to_tunnel(server):
    status, headers, body = get(server, Host="localhost:9000")
    assert status == 403
    assert f"ssh -N -L {server.port}:127.0.0.1:{server.port} SERVER".encode() in body
    assert b"9000" not in body
    assert headers["Content-Security-Policy"]


def test_a_page_that_is_in_gets_a_token_that_lets_another_one_in(server):
    ask = {"type": "ask", "id": 7, "question": "token", "arguments": {}}
    (_, answer), _ = talk(server, hello(server), ask, n=2)
    assert (answer["type"], answer["id"]) == ("answer", 7)
    got = answer["token"]
    assert server.tokens.key_for(got, None) is not None
    assert server.tokens.key_for(got, None) is None


def test_it_listens_on_this_machine_alone(server):
    elsewhere = http.client.HTTPConnection("127.0.0.2", server.port, timeout=2)
    with contextlib.closing(elsewhere), pytest.raises(OSError, match="refused|unreachable|timed"):
        elsewhere.request("GET", "/")


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1", "localhost:1", "evil.example:{port}", "127.0.0.1.evil.example:{port}", ""]
)
def test_other_hosts_are_refused(server, host):
    status, headers, body = get(server, Host=host.format(port=server.port))
    assert status in (400, 403)
    assert b".js" not in body
    assert "Access-Control-Allow-Origin" not in headers


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "HEAD"])
def test_other_methods_are_refused(server, method):
    assert get(server, method=method)[0] in (403, 405, 501)


@pytest.mark.parametrize(
    "path",
    ["/nothing", "/../server.py", "/..%2fserver.py", "/viewer.js/", "//etc/passwd", "/%00", "/socket", "/index.html"],
)
def test_other_paths_are_refused(server, path):
    status, headers, body = get(server, path)
    assert status in (400, 403, 404, 426)
    assert b"import" not in body
    assert headers.get("Content-Security-Policy") is not None or status == 400 or path == "/socket"


@pytest.mark.parametrize(
    "origin",
    [
        None,
        "null",
        "http://evil.example",
        "https://127.0.0.1:{port}",
        "http://127.0.0.1",
        "http://localhost:{port}",
        "file://",
    ],
)
def test_sockets_of_other_origins_are_refused(server, origin):
    given_origin = None if origin is None else origin.format(port=server.port)
    with pytest.raises(tornado.httpclient.HTTPError) as told:
        talk(server, hello(server), origin=given_origin)
    assert told.value.code == 403


def test_sockets_of_other_hosts_are_refused(server):
    with pytest.raises(tornado.httpclient.HTTPError):
        talk(server, hello(server), host="evil.example", origin="http://evil.example")


def test_a_token_works_once_and_gives_a_key(server):
    first = hello(server)
    (welcome,), _ = talk(server, first)
    assert welcome["type"] == "welcome"
    assert welcome["session"]
    assert talk(server, first) == ([], 4401)
    (again,), _ = talk(server, {"type": "hello", "protocol": 1, "session": welcome["session"]})
    assert again["type"] == "welcome"


@pytest.mark.parametrize(
    "messages",
    [
        [{"type": "hello", "protocol": 1}],
        [{"type": "hello", "protocol": 1, "token": "guess"}],
        [{"type": "hello", "protocol": 1, "token": 5, "session": []}],
        [{"type": "hello", "protocol": 9, "token": "right"}],
        [{"type": "patch", "seq": 1, "operations": []}],
        ["text"],
        [b""],
        [b"\xff\xff\xff\xff{}"],
        [struct.pack("<I", 2) + b"[]"],
        [struct.pack("<I", 5) + b'{"a"}'],
        [{"type": "hello", "protocol": 1, "token": "right"}, {"type": "dance"}],
        [{"type": "hello", "protocol": 1, "token": "right"}, b"abc"],
        [{"type": "hello", "protocol": 1, "token": "right"}, {"type": "view", "view": "3d", "size": [10**6, 10**6]}],
        [{"type": "hello", "protocol": 1, "token": "right"}, b"\0" * (MAX_BYTES + 1)],
    ],
    ids=lambda messages: str(messages)[:60],
)
def test_other_messages_end_the_conversation(server, messages):
    token = token_of(server)
    sent = [
        {**one, "token": token} if isinstance(one, dict) and one.get("token") == "right" else one for one in messages
    ]
    got, code = talk(server, *sent, n=9)
    assert code in (4400, 4401, 1009, 1006)
    assert all(header["type"] != "frame" for header in got)


def test_keys_of_pages_that_are_here_are_kept():
    tokens = Tokens()
    first, second = (tokens.key_for(tokens.new(), None) for _ in range(2))
    tokens.leave(second)
    others = [tokens.key_for(tokens.new(), None) for _ in range(100)]
    for key in others[:50]:
        tokens.leave(key)
    # The one that came back has two connections, of which the old one ends later.
    assert tokens.key_for(None, first) == first
    tokens.leave(first)
    for key in others[50:]:
        tokens.leave(key)
    assert tokens.key_for(None, first) == first
    assert tokens.key_for(None, others[-1]) == others[-1]
    assert tokens.key_for(None, second) is None  # 64 others left after it


def test_wrong_tokens_keep_nobody_out():
    tokens = Tokens()
    token = tokens.new()
    for guess in ("guess", "", "\ud800", token[:-1], None, 5):
        assert tokens.key_for(guess, guess) is None
    key = tokens.key_for(token, None)
    assert key is not None
    for _ in range(100):
        assert tokens.key_for("guess", "guess") is None
    assert tokens.key_for(None, key) == key
    assert tokens.key_for(token, None) is None


def test_a_page_with_its_key_comes_back_after_many_wrong_hellos(server):
    (welcome,), _ = talk(server, hello(server))
    for _ in range(8):
        assert talk(server, {"type": "hello", "protocol": 1, "token": "guess"}) == ([], 4401)
    (again,), _ = talk(server, {"type": "hello", "protocol": 1, "session": welcome["session"]})
    assert again["type"] == "welcome"
    (new,), _ = talk(server, hello(server))
    assert new["type"] == "welcome"


def test_the_file_with_the_link_is_deleted_when_a_page_is_let_in(server, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or True)
    server.open_in_browser()
    file = Path(url2pathname(opened[0].removeprefix("file://")))
    assert talk(server, {"type": "hello", "protocol": 1, "token": "guess"}) == ([], 4401)
    assert file.is_file()
    token = file.read_text(encoding="utf-8").partition("#token=")[2].partition('"')[0]
    (welcome,), _ = talk(server, {"type": "hello", "protocol": 1, "token": token})
    assert welcome["type"] == "welcome"
    assert not file.parent.exists()


def test_nothing_is_told_before_a_hello(server, monkeypatch):
    monkeypatch.setattr("wavesplat._viewer.server.server.HELLO_S", 0.3)
    got, code = talk(server, n=1)
    assert got == []
    assert code == 4401


def test_pages_that_wait_are_told_how_far_it_is_and_why_it_failed():
    server = Server()
    try:
        server.send_progress("Opening scan.nii", 0.5)
        server.fail("scan.nii is no volume")
        (failed, progress), _ = talk(server, hello(server), n=2)
        assert failed == {"type": "failed", "id": None, "code": "open", "message": "scan.nii is no volume"}
        assert progress["text"] == "Opening scan.nii"
    finally:
        server.close()


def test_a_port_that_is_taken_is_an_error(server):
    with pytest.raises(ArgumentError, match=f"port {server.port} of this machine cannot be used"):
        Server(server.port)


def test_messages_go_and_come():
    header, payload = {"type": "frame", "number": 1, "text": "Grüße"}, b"\0\1\2"
    assert unpacked(packed(header, payload)) == (header, payload)


@given(st.binary(max_size=200))
def test_any_bytes_are_a_message_or_refused(data):
    try:
        header, _ = unpacked(data)
    except ArgumentError:
        return
    assert isinstance(header, dict)


NAMES = ["type", "seq", "operations", "view", "size", "frame", "id", "question", "arguments", "moving"]
PLAIN = st.none() | st.booleans() | st.integers() | st.text(max_size=5)
WORDS = st.sampled_from(["patch", "view", "shown", "ask", "cancel", "3d"])
LISTS = st.lists(st.integers() | st.dictionaries(st.text(max_size=3), st.integers()), max_size=3)


@given(st.dictionaries(st.sampled_from(NAMES), PLAIN | WORDS | LISTS))
def test_any_header_is_taken_or_refused(session, header):
    page = viewer_fakes.Page(session)
    with contextlib.closing(page.client), contextlib.suppress(ArgumentError):
        page.client.receive(json.loads(json.dumps(header)))
