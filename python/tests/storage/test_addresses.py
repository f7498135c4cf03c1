"""Addresses: a few protocols, no chains, one host; and what web servers answer instead of chunks."""

from __future__ import annotations

import functools
import gzip
import itertools
import json

import numpy as np
import pytest
import zarr
from odd_server import OddServer
from test_readers import ome_attributes

import wavesplat as ws
from wavesplat._storage import addresses
from wavesplat.errors import FileError, FileWarning, WavesplatError

pytest.importorskip("aiohttp")

SAMPLES = np.random.default_rng(4).integers(1, 60000, (8, 8, 8)).astype(np.uint16)


@pytest.fixture
def store(tmp_path):
    """A folder with an array of eight chunks in both formats, and an image."""
    for version in (2, 3):
        zarr.create_array(
            tmp_path / f"v{version}.zarr", data=SAMPLES, chunks=(4, 4, 4), zarr_format=version, compressors=None
        )
    group = zarr.open_group(tmp_path / "image.zarr", mode="w", zarr_format=2)
    group.create_array("s 0", data=SAMPLES, chunks=(4, 4, 4), compressors=None)
    group.attrs.update(ome_attributes("0.4", "zyx", [{"path": "s 0"}]))
    return tmp_path


def opened(path, options):
    """Open a volume and return all samples, read at once or in parts."""
    volume = ws.open(path, **options)
    return (volume.read() if isinstance(volume, ws.LazyVolume) else volume).samples


def is_chunk(path):
    return path.rpartition("/")[2] not in ("zarr.json", ".zarray", ".zattrs", ".zgroup", ".zmetadata")


NAMES = {"v2.zarr": "0.0.0", "v3.zarr": "c/0/0/0"}


# Protocols


@pytest.mark.parametrize(
    "address",
    [
        "reference://::data:application/json,{}",
        "reference://::file:///tmp/refs.json",
        "simplecache::http://127.0.0.1:9/a.zarr",
        "filecache::file:///etc",
        "zip://a.zarr::file:///tmp/a.zip",
        "ftp://127.0.0.1:9/a.zarr",
        "local:///etc",
        "memory://a",
        "github://owner:name@main/a",
        "http://127.0.0.1:9/a::file:///etc",
        "javascript://x",
    ],
)
def test_other_protocols_and_chains_are_refused(address, monkeypatch):
    import fsspec

    def asked(*_, **__):
        pytest.fail("an address of another protocol was handed to fsspec")

    for name in ("filesystem", "open", "get_mapper", "url_to_fs"):
        monkeypatch.setattr(fsspec, name, asked)
    for opened in (ws.open, ws.open_series, ws.open_scene):
        with pytest.raises(FileError, match="not opened"):
            opened(address)
    with pytest.raises(FileError, match="not opened"):
        ws.open_series([address, address])


def test_addresses_of_this_machine_are_paths(store):
    np.save(store / "a b.npy", SAMPLES)
    for address in ((store / "a b.npy").as_uri(), f"file://{store}/v3.zarr", f"file://localhost{store}/v2.zarr"):
        np.testing.assert_array_equal(ws.open(address).samples, SAMPLES)
    with pytest.raises(FileError, match="lies on elsewhere"):
        ws.open("file://elsewhere/a.zarr")
    with pytest.raises(FileError, match="a scene is read from a file on this machine"):
        ws.Scene.load("file:///etc/passwd")


def test_what_is_no_address():
    with pytest.raises(FileError, match="names no host"):
        ws.open("http:///a.zarr")
    with pytest.raises(FileError, match="check its host and port"):
        ws.open("http://host:999999/a.zarr")


HOSTS = [
    ("127.0.0.1", False), ("10.1.2.3", False), ("192.168.1.1", False), ("169.254.169.254", False),
    ("100.64.0.1", False), ("224.0.0.1", False), ("::1", False), ("fe80::1%eth0", False), ("::", False),
    ("::ffff:10.0.0.1", False), ("64:ff9b::7f00:1", False), ("2002:7f00:1::", False), ("localhost", False),
    ("127.1", False), ("2130706433", False), ("127.0.0.1.", False), ("8.8", False),
    ("fec0::1", False), ("fc00::1", False), ("100::1", False), ("2001:db8::1", False), ("3fff::1", False),
    ("5f00::1", False), ("64:ff9b:1::1", False), ("::127.0.0.1", False), ("::8.8.8.8", False),
    ("2001:0:808:808:0:0:80ff:fffe", False), ("0.1.2.3", False), ("192.0.0.8", False), ("192.0.0.10", False),
    ("192.0.2.1", False), ("192.88.99.1", False), ("198.18.0.1", False), ("198.51.100.1", False),
    ("203.0.113.9", False), ("240.0.0.1", False), ("255.255.255.255", False), ("ff0e::1", False),
    ("8.8.8.8", True), ("2606:4700::1111", True), ("::ffff:8.8.8.8", True), ("64:ff9b::808:808", True),
]  # fmt: skip


def test_public_hosts():
    assert [host for host, expected in HOSTS if addresses.is_public(host) is not expected] == []


SECRETS = "token=a-password&more=" + "x" * 200


@pytest.mark.parametrize(
    "address",
    [
        f"ftp://127.0.0.1:9/a.zarr?{SECRETS}",
        f"http://127.0.0.1:9/a::file:///etc?{SECRETS}",
        f"file://elsewhere/a.zarr?{SECRETS}",
        f"http:///a.zarr?{SECRETS}",
        f"http://host:999999/a.zarr?{SECRETS}",
        f"http://a-password@127.0.0.1:9/a.zarr?{SECRETS}",
        f"http://a:a-password@127.0.0.1:9/a.zarr#{SECRETS}",
    ],
)
def test_refused_addresses_are_told_without_their_passwords(address):
    for called in (ws.open, ws.open_series, ws.open_scene):
        with pytest.raises(FileError) as caught:
            called(address)
        assert "a-password" not in str(caught.value)
        assert len(str(caught.value)) < 400


@pytest.mark.parametrize("place", ["a.zarr", "a.zarr/", ""])
def test_names_have_no_passwords(place):
    wanted = "a.zarr" if place else "host:80"
    for secret in ("", "?token=a-password/b", "#a-password"):
        assert addresses.last_part(f"http://me:a-password@host:80/{place}{secret}") == wanted


def test_messages_of_servers_have_no_passwords(store, wavesplat):
    (store / "group.zarr").mkdir()
    (store / "group.zarr" / ".zgroup").write_text('{"zarr_format": 2}')
    path = "/v3.zarr"
    answers = [lambda _, code=code: (code, {}, iter([b""])) for code in (401, 403, 404, 418, 500)]
    answers += [
        lambda path: (302, {"Location": path}, iter([b""])),
        lambda _: (302, {"Location": "http://a:b@localhost:9/?token=b-password"}, iter([b""])),
        lambda _: (302, {"Location": "http://[/"}, iter([b""])),
        lambda _: (200, {"Content-Encoding": "br"}, iter([b"x"])),
        lambda _: (200, {"Content-Encoding": "gzip"}, iter([b"x"])),
        lambda _: (200, {"Content-Length": "99"}, iter([b"x"])),
    ]
    for odd in answers:
        with OddServer(store, odd) as server, pytest.raises(FileError) as caught:
            ws.open(f"{server.address}{path}?{SECRETS}")
        assert "-password" not in str(caught.value), odd
        assert "127.0.0.1" in str(caught.value)
    with pytest.raises(FileError) as caught:  # nobody listens
        ws.open(f"{server.address}{path}?{SECRETS}")
    assert "a-password" not in str(caught.value)
    with OddServer(store) as server:
        for name, options in (
            ("v3.zarr", {"time": 1}),
            ("v3.zarr", {"level": 7}),
            ("v3.zarr", {"gaps": "refuse"}),
            ("image.zarr", {"level": 3}),
            ("group.zarr", {}),
            ("group.zarr", {"dataset": "none"}),
        ):
            for more in ({}, {"memory": "50 MB"}):
                with pytest.raises(WavesplatError) as caught:
                    ws.open(f"{server.address}/{name}?{SECRETS}", **options, **more)
                assert "a-password" not in str(caught.value)
        done = wavesplat("info", f"{server.address}/none.zarr?{SECRETS}", f"{server.address}/group.zarr?{SECRETS}")
        assert done.returncode == 1
        assert "a-password" not in done.stderr
    (store / "v3.zarr" / NAMES["v3.zarr"]).unlink()
    with OddServer(store, missing=403) as server:
        for more in ({}, {"memory": "50 MB"}):
            with pytest.warns(FileWarning, match="403") as warned:
                opened(f"{server.address}/v3.zarr?{SECRETS}", more)
            assert not any("a-password" in str(one.message) for one in warned)


# Answers of servers


@pytest.mark.parametrize("name", NAMES)
def test_the_query_goes_along(store, name):
    with OddServer(store) as server:
        volume = ws.open(f"{server.address}/{name}/?token=a/b&x=1")
        np.testing.assert_array_equal(volume.samples, SAMPLES)
        assert volume.name == name
        assert f"/{name}/{NAMES[name]}?token=a/b&x=1" in server.asked
        assert all(path.endswith("?token=a/b&x=1") for path in server.asked)


def test_parts_of_paths_are_quoted(store):
    with OddServer(store) as server:
        np.testing.assert_array_equal(ws.open(f"{server.address}/image.zarr?k=1").samples, SAMPLES)
        assert any(path.startswith("/image.zarr/s%200/0.0.0?k=1") for path in server.asked)


def test_what_is_encoded_is_sent_as_typed(store):
    """Servers that compare the letters of a signature refuse it with / for %2F."""
    query, encoded = "sig=a%2Fb%2b%3D&x=/", "im%61ge%2ezarr"
    with OddServer(store) as server:
        np.testing.assert_array_equal(ws.open(f"{server.address}/{encoded}?{query}").samples, SAMPLES)
        assert server.asked
        assert all(path.startswith(f"/{encoded}/") and path.endswith(f"?{query}") for path in server.asked)


@pytest.mark.parametrize("name", NAMES)
def test_403_is_not_there(store, name):
    (store / name / NAMES[name]).unlink()
    with OddServer(store, missing=403) as server:
        with pytest.warns(FileWarning, match=rf"the server refuses \(403\) 1 chunks, the first '{NAMES[name]}'"):
            volume = ws.open(f"{server.address}/{name}")
        want = SAMPLES.copy()
        want[:4, :4, :4] = 0
        np.testing.assert_array_equal(volume.samples, want)
        assert any("403" in guess for guess in volume.guesses)
        lazy = ws.open(f"{server.address}/{name}", memory="50 MB")
        with pytest.warns(FileWarning, match=rf"refuses \(403\) chunk '{NAMES[name]}'"):
            np.testing.assert_array_equal(lazy.read().samples, want)


def test_the_command_line_notes_403(store, wavesplat):
    (store / "v3.zarr" / NAMES["v3.zarr"]).unlink()
    picture = store / "a.png"
    with OddServer(store, missing=403) as server:
        address = f"{server.address}/v3.zarr"
        for options in (
            (address, "--embed-paths", "-o", picture),
            ("--from", picture, "--external-files", "-o", store / "b.png"),
            (address, "--memory", "50 MB", "-o", store / "c.png"),
        ):
            more = () if options[0] == "--from" else ("--size", "9x9")
            done = wavesplat("render", *options, *more)
            assert done.returncode == 0, done.stderr
            assert all(line.startswith("wavesplat: note: ") for line in done.stderr.splitlines()), done.stderr
            assert "refuses (403)" in done.stderr


def test_403_of_all_is_no_empty_volume(store):
    with OddServer(store, lambda path: (403, {}, iter([b""])) if is_chunk(path) else None) as server:
        with pytest.raises(FileError, match=r"refuses \(403 Forbidden\) all 8 chunks.*check that you may read"):
            ws.open(f"{server.address}/v2.zarr")
        with pytest.raises(FileError, match="there is no Zarr array or group at this address"):
            ws.open(f"{server.address}/none.zarr")
    refused = pytest.raises(FileError, match=r"refuses \(403 Forbidden\) .*\.zarray.*check the address")
    with OddServer(store, missing=403) as server, refused:
        ws.open(f"{server.address}/none.zarr")


@pytest.mark.parametrize(
    ("status", "message"),
    [(401, "asks for a log-in"), (500, "has a fault"), (503, "is busy"), (429, "is busy"), (418, "does not give")],
)
@pytest.mark.parametrize("of_chunks", [True, False])
def test_other_answers_are_told(store, status, message, of_chunks):
    with OddServer(store, lambda path: (status, {}, iter([b"{}"])) if is_chunk(path) == of_chunks else None) as server:
        for options in ({}, {"memory": "50 MB"}):
            with pytest.raises(FileError, match=f"{message}.*{status}") as caught:
                opened(f"{server.address}/v3.zarr", options)
            assert "truncated" not in str(caught.value)


def test_redirects_stay_on_their_host(store):
    with OddServer(store) as other:
        elsewhere = {"to": ""}

        def moved(path):
            to = elsewhere["to"]
            return (302, {"Location": f"{to}{path}"}, iter([b""])) if is_chunk(path) and "/moved" not in path else None

        with OddServer(store, moved) as server:
            (store / "moved").mkdir()
            (store / "v2.zarr").rename(store / "moved" / "v2.zarr")
            (store / "v2.zarr").mkdir()
            (store / "v2.zarr" / ".zarray").write_bytes((store / "moved" / "v2.zarr" / ".zarray").read_bytes())
            elsewhere["to"] = "/moved"
            np.testing.assert_array_equal(ws.open(f"{server.address}/v2.zarr").samples, SAMPLES)
            for to in (f"{other.address}/moved", "http://localhost:9", "file://", "ftp://127.0.0.1"):
                elsewhere["to"] = to
                with pytest.raises(FileError, match="sends the request on to .*, another place"):
                    ws.open(f"{server.address}/v2.zarr")
        assert other.asked == []


def test_metadata_are_not_redirected_either(store):
    with OddServer(store) as other:
        moved = lambda path: (307, {"Location": other.address + path}, iter([b""]))  # noqa: E731
        with OddServer(store, moved) as server, pytest.raises(FileError, match="another place"):
            ws.open(f"{server.address}/v2.zarr")
        assert other.asked == []


def test_redirects_in_a_circle(store):
    circle = lambda path: (302, {"Location": path}, iter([b""])) if is_chunk(path) else None  # noqa: E731
    with OddServer(store, circle) as server, pytest.raises(FileError, match="in a circle"):
        ws.open(f"{server.address}/v2.zarr")


def endless(path):
    return (200, {"endless": "yes"}, itertools.repeat(b"\0" * 65536)) if is_chunk(path) else None


@functools.cache
def packed_zeros():
    return gzip.compress(b"\0" * (64 << 20), 1)


def bomb(path):
    return (200, {"Content-Encoding": "gzip"}, iter([packed_zeros()])) if is_chunk(path) else None


def lying(path):
    return (200, {"Content-Length": str(1 << 40)}, iter([b"\0" * 128])) if is_chunk(path) else None


@pytest.mark.parametrize("odd", [endless, bomb, lying])
@pytest.mark.parametrize("options", [{}, {"memory": "50 MB"}])
@pytest.mark.every_pair
def test_no_more_is_read_than_a_chunk_can_have(store, odd, options):
    import tracemalloc

    packed_zeros()
    with OddServer(store, odd) as server:
        tracemalloc.start()
        try:
            with pytest.raises(FileError, match=r"sends more than the \d+ bytes that can be there"):
                opened(f"{server.address}/v2.zarr", options)
            _, peak = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
    assert peak < 32 << 20


def test_metadata_are_bounded(store, monkeypatch):
    from wavesplat._storage.zarr import place as zarr_place

    monkeypatch.setattr(zarr_place, "MAX_METADATA_BYTES", 1 << 16)
    long = lambda path: None if is_chunk(path) else (200, {"endless": "yes"}, itertools.repeat(b" " * 65536))  # noqa: E731
    with OddServer(store, long) as server, pytest.raises(FileError, match="more than the 65536 bytes"):
        ws.open(f"{server.address}/v2.zarr")
    (store / "v2.zarr" / ".zattrs").write_text(json.dumps({"text": "a" * (1 << 17)}))
    with pytest.raises(FileError, match=r"'\.zattrs' has \d+ bytes, and there can be at most 65536"):
        ws.open(store / "v2.zarr")


@pytest.mark.parametrize("packing", ["gzip", "deflate"])
def test_packed_answers_are_read(store, packing):
    import zlib

    def packed(path):
        file = store / path.lstrip("/")
        if not file.is_file():
            return None
        pack = gzip.compress if packing == "gzip" else zlib.compress
        return 200, {"Content-Encoding": packing}, iter([pack(file.read_bytes())])

    with OddServer(store, packed) as server:
        np.testing.assert_array_equal(ws.open(f"{server.address}/v3.zarr").samples, SAMPLES)

    def cut(path):
        answer = packed(path)
        return answer and (200, answer[1], iter([next(answer[2])[:-4]]))

    with OddServer(store, cut) as server, pytest.raises(FileError, match="packed answer has no end"):
        ws.open(f"{server.address}/v3.zarr")
    strange = lambda path: (200, {"Content-Encoding": "br"}, iter([b"x"])) if is_chunk(path) else None  # noqa: E731
    with OddServer(store, strange) as server, pytest.raises(FileError, match="packs its answer by 'br'"):
        ws.open(f"{server.address}/v3.zarr")


def test_shards_of_a_server_without_ranges(tmp_path):
    options = {"shards": (8, 8, 8), "chunks": (4, 4, 4), "dtype": "u2"}
    zarr.create_array(tmp_path / "s.zarr", shape=(8, 8, 8), **options)[:] = SAMPLES
    with OddServer(tmp_path) as server:
        lazy = ws.open(f"{server.address}/s.zarr", memory="50 MB")
        np.testing.assert_array_equal(lazy.arrays(0).read((1, 2, 3), (3, 4, 8)), SAMPLES[1:3, 2:4, 3:8])
