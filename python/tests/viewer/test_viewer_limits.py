"""Limits of the viewer: other programs on the machine cannot exhaust it, fill its log, or read its link."""

import http.client
import logging
import os
import re
import socket
import stat
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path

import pytest

from wavesplat._viewer.server import connections
from wavesplat._viewer.server.connections import BrowserLink
from wavesplat._viewer.server.server import Server
from wavesplat.errors import ArgumentError

pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


@pytest.fixture
def server():
    made = Server()
    yield made
    made.close()


@pytest.fixture
def log(caplog, monkeypatch):
    """The log of the viewer's libraries, whatever settings other libraries of the process have made."""
    for name in ("tornado", "tornado.application", *connections.QuietLog.LOGGERS):
        logger = logging.getLogger(name)
        monkeypatch.setattr(logger, "propagate", True)
        monkeypatch.setattr(logger, "disabled", False)
        caplog.set_level(logging.WARNING, logger=name)
    return caplog


def half_a_request(server):
    connection = socket.create_connection(("127.0.0.1", server.port), timeout=60)
    connection.sendall(b"GET / HT")
    return connection


def is_closed(connection):
    connection.setblocking(False)
    try:
        return connection.recv(1) == b""
    except BlockingIOError:
        return False
    except ConnectionError:
        return True


def wait_for(condition, seconds=60.0):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.02)


def status_of(server):
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=60)
    try:
        connection.request("GET", "/", headers={"Connection": "close"})
        return connection.getresponse().status
    finally:
        connection.close()


def test_connections_beyond_the_limit_are_closed_as_they_come(monkeypatch):
    monkeypatch.setattr(connections, "HEADER_S", 600)  # no connection is closed for sending nothing
    server = Server()
    held = [half_a_request(server) for _ in range(connections.MAX_CONNECTIONS + 20)]
    try:
        wait_for(lambda: all(map(is_closed, held[-20:])))
        assert not any(map(is_closed, held[:-20]))
    finally:
        for connection in held:
            connection.close()
    try:
        wait_for(lambda: status_of(server) == 200)
    finally:
        server.close()


def test_a_request_that_does_not_come_is_not_waited_for(monkeypatch):
    assert connections.HEADER_S <= 10
    monkeypatch.setattr(connections, "HEADER_S", 0.3)
    server = Server()
    try:
        held = [half_a_request(server) for _ in range(connections.MAX_CONNECTIONS)]
        wait_for(lambda: all(map(is_closed, held)))
        assert status_of(server) == 200
        for connection in held:
            connection.close()
    finally:
        server.close()


@pytest.mark.skipif(sys.platform == "win32", reason="has no such limit")
def test_without_descriptors_it_waits_and_says_so_once(tmp_path):
    # The test runs in a process of its own, since the limit is for all files of a process.
    code = """
import os, resource, socket, sys, time
from wavesplat._viewer.server.connections import Listener
from wavesplat._viewer.server.server import Server
server = Server()
address = ("127.0.0.1", server.port)
waiting = [socket.socket() for _ in range(4)]
resource.setrlimit(resource.RLIMIT_NOFILE, (max(map(int, os.listdir("/dev/fd"))) + 1, 4096))
calls = []
accept = Listener.accept
Listener.accept = lambda listener: calls.append(1) or accept(listener)
for one in waiting:
    one.settimeout(60)
    one.connect(address)
    one.sendall(b"GET / HTTP/1.1\\r\\nHost: 127.0.0.1:%d\\r\\nConnection: close\\r\\n\\r\\n" % server.port)
while not calls:
    time.sleep(0.01)
time.sleep(2.5)
print(len(calls))
resource.setrlimit(resource.RLIMIT_NOFILE, (1024, 4096))
print([one.recv(15)[9:12].decode() for one in waiting])
server.close()
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    n_accepts, statuses = done.stdout.splitlines()
    assert statuses == str(["200"] * 4)
    # A connection that waits keeps the socket readable: without the pause there are thousands of tries a second.
    assert 1 <= int(n_accepts) < 50
    lines = done.stderr.splitlines()
    assert len(lines) == 1, done.stderr
    assert "cannot accept a connection" in lines[0]


def test_our_own_failures_are_logged_each_time_with_their_traceback(server, monkeypatch, log):
    def fail(*_):
        raise RuntimeError("it broke")

    monkeypatch.setattr(server, "is_own", fail)
    for n in range(1, 4):
        assert status_of(server) == 500
        said = [record for record in log.records if record.name == "tornado.application"]
        assert len(said) == n
        assert str(said[-1].exc_info[1]) == "it broke"


def log_in_loop(server, *calls):
    """Log from the thread of the server, as its libraries do."""
    done = threading.Event()

    def run():
        for call in calls:
            call()
        done.set()

    server._later(run)
    assert done.wait(60)


@pytest.mark.parametrize("name", connections.QuietLog.LOGGERS)
def test_trouble_with_connections_is_one_line_a_minute(server, log, monkeypatch, name):
    now = [1000.0]
    monkeypatch.setattr(connections, "monotonic", lambda: now[0])
    logger = logging.getLogger(name)

    def trouble(n):
        try:
            raise OSError(f"socket {n}")
        except OSError:
            logger.exception("accept failed\nsocket: %s", n)

    log_in_loop(server, *[partial(trouble, n) for n in range(5)])
    now[0] += connections.LINE_S - 1
    log_in_loop(server, lambda: trouble(5), lambda: logger.warning("something else"))
    now[0] += 1
    log_in_loop(server, lambda: trouble(6))
    # The first message silences its kind for a minute; messages of another kind are not held back.
    assert [record.getMessage() for record in log.records] == [
        "accept failed: OSError: socket 0",
        "something else",
        "accept failed: OSError: socket 6",
    ]
    assert not any(record.exc_info for record in log.records)


def test_other_loggers_are_left_as_they_are(server, log):
    for _ in range(2):
        logging.getLogger("tornado.general").warning("of a notebook")
    assert [record.getMessage() for record in log.records] == ["of a notebook"] * 2


@pytest.mark.parametrize("port", [-1, 1 << 16, 10**30])
def test_a_port_that_is_none_is_refused(port):
    with pytest.raises(ArgumentError, match=r"port is .*; give a whole number"):
        Server(port)


@pytest.fixture
def browser(monkeypatch):
    """List of the addresses that the browser is called with."""
    called = []
    monkeypatch.setattr("webbrowser.open", lambda address: called.append(address) or True)
    return called


def path_of(address):
    assert address.startswith("file://")
    from urllib.request import url2pathname

    return Path(url2pathname(address.removeprefix("file://")))


def test_the_link_is_no_argument_of_the_browser(server, browser):
    assert server.open_in_browser()
    (address,) = browser
    assert "token" not in address
    file = path_of(address)
    page = file.read_text(encoding="utf-8")
    (link,) = re.findall(r'url=(http[^"]+)"', page)
    token = link.partition("#token=")[2]
    assert link.startswith(f"http://127.0.0.1:{server.port}/#")
    if os.name == "posix":
        assert stat.S_IMODE(file.stat().st_mode) == 0o600
        assert stat.S_IMODE(file.parent.stat().st_mode) == 0o700
    assert server.tokens.key_for(token, None) is not None
    server.close()
    assert not file.parent.exists()


def test_without_a_browser_no_file_is_left(monkeypatch):
    monkeypatch.setattr("webbrowser.open", lambda _: False)
    link = BrowserLink("http://127.0.0.1:1/#token=a")
    assert not link.open()
    assert not link.path.parent.exists()


def test_a_file_does_not_outlive_python():
    code = "from wavesplat._viewer.server.connections import BrowserLink\nlink = BrowserLink('http://a/#b')\nprint(link.path)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600, check=True)
    assert not Path(done.stdout.strip()).parent.exists()
