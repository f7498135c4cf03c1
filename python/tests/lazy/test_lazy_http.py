"""OME-Zarr images on a web server: read chunk by chunk, shards by ranges; the first coarse picture takes few bytes."""

from __future__ import annotations

import contextlib
import functools
import http.server
import sys
import threading
import time

import numpy as np
import pytest
from cases_of_the_day import nightly
from lazy_fakes import shells
from test_lazy_files import ome_zarr

import wavesplat as ws

pytest.importorskip("aiohttp")

LOOK = ws.TransferFunction([(60, 0.0), (200, 0.2)], [(0, 1.0, 0.8, 0.5)])


class Handler(http.server.SimpleHTTPRequestHandler):
    """Serves files of a folder, with or without ranges, and counts the bytes that are sent."""

    takes_ranges = True
    sent: list[tuple[str, int]]

    def do_GET(self):
        path = self.translate_path(self.path)
        try:
            with open(path, "rb") as file:  # noqa: PTH123
                content = file.read()
        except OSError:
            self.send_error(404)
            return
        wanted = self.headers.get("Range")
        status = 200
        if wanted and self.takes_ranges:
            first, _, last = wanted.removeprefix("bytes=").partition("-")
            content = content[-int(last) :] if not first else content[int(first) : int(last) + 1 if last else None]
            status = 206
        self.sent.append((self.path, len(content)))
        self.send_response(status)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_):
        pass


@pytest.fixture
def serve(tmp_path):
    """A server of `tmp_path`; returns its address and the counts of what it sent."""
    servers = []

    def start(takes_ranges=True):
        handler = type("Own", (Handler,), {"takes_ranges": takes_ranges, "sent": []})
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(handler, directory=str(tmp_path)))
        threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True).start()
        servers.append(server)
        return f"http://127.0.0.1:{server.server_port}", handler.sent

    def stop():
        while servers:
            server = servers.pop()
            server.shutdown()
            server.server_close()

    start.stop = stop
    yield start
    stop()


# By day the test below reads without ranges.
@pytest.mark.parametrize("takes_ranges", [True, *nightly(False)])
def test_the_first_picture_is_quick_and_small(serve, tmp_path, takes_ranges):
    # Noise, so that chunks do not shrink to nothing.
    rng = np.random.default_rng(1)
    made = shells(256)
    samples = np.where(made > 40, made // 2 + rng.integers(0, 100, (256,) * 3), 0).astype(np.uint8)
    samples += rng.integers(0, 8, samples.shape, np.uint8)
    ome_zarr(tmp_path / "image.zarr", samples, n_levels=5, chunk=32)
    address, sent = serve(takes_ranges)
    begun = time.monotonic()
    volume = ws.open(f"{address}/image.zarr", memory="50 MB", channel=0)
    pictures = ws.progressive(ws.Scene(volume, LOOK), "isometric", size=(200, 150))
    first = next(pictures)
    took = time.monotonic() - begun
    stored = sum(f.stat().st_size for f in (tmp_path / "image.zarr" / "0" / "c" / "0" / "0").rglob("*") if f.is_file())
    n_bytes = sum(n for _, n in sent)
    assert first.report["lazy"]["levels"] == [4]
    assert n_bytes < 0.05 * stored, (n_bytes, stored)
    assert took < 20, "by far: machines are busy"
    pictures.close()
    # Pictures are the same as from the files.
    local = ws.open(tmp_path / "image.zarr", memory="50 MB", channel=0)
    options = {"size": (100, 75), "camera": first.camera}
    drawn = [ws.Scene(one.at_level(1), LOOK).render(**options) for one in (volume, local)]
    assert np.array_equal(*(picture.rgba for picture in drawn))


@pytest.mark.parametrize("takes_ranges", [True, False])
def test_shards_are_read_by_ranges_where_they_can_be(serve, tmp_path, takes_ranges):
    import zarr

    samples = shells(64)
    array = zarr.create_array(
        tmp_path / "s.zarr", shape=samples.shape, chunks=(16, 16, 16), shards=(64, 64, 64), dtype="u1", compressors=None
    )
    array[:] = samples
    address, sent = serve(takes_ranges)
    volume = ws.open(f"{address}/s.zarr", memory="50 MB")
    sent.clear()
    if not takes_ranges:
        # From a server without ranges a shard is an error or a right picture, never a wrong one.
        with contextlib.suppress(ws.errors.FileError):
            assert np.array_equal(volume.arrays(0).read((0, 0, 0), (8, 8, 8)), samples[:8, :8, :8])
        return
    got = volume.arrays(0).read((0, 0, 0), (8, 8, 8))
    assert np.array_equal(got, samples[:8, :8, :8])
    n_bytes = sum(n for _, n in sent)
    assert n_bytes < 30_000


def test_shards_cost_what_their_chunks_cost(serve, tmp_path):
    """Fault 11 of microscopy: shards were counted as what must be held, so a small budget read 13 times the bytes."""
    import zarr

    rng = np.random.default_rng(2)
    samples = rng.integers(0, 255, (96, 128, 128), np.uint8)
    n_bytes = {}
    for name, shards in (("plain", None), ("sharded", (48, 128, 128))):
        array = zarr.create_array(
            tmp_path / f"{name}.zarr", shape=samples.shape, chunks=(16, 32, 32), shards=shards, dtype="u1"
        )
        array[:] = samples
        address, sent = serve()
        volume = ws.open(f"{address}/{name}.zarr", memory="8 MB")
        ws.render(volume, ws.TransferFunction([(0, 0.0), (255, 0.02)], [(0, 1, 1, 1)]), size=(100, 100))
        n_bytes[name] = sum(n for _, n in sent)
        local = ws.open(tmp_path / f"{name}.zarr", memory="8 MB")
        assert local.arrays(0).chunks == volume.arrays(0).chunks == (16, 32, 32)
        assert ws.Volume.lazy(array).arrays(0).chunks == (16, 32, 32)
    assert samples.nbytes < n_bytes["sharded"] < 1.1 * n_bytes["plain"], n_bytes


def test_a_server_that_goes_away_names_the_chunk(serve, tmp_path):
    ome_zarr(tmp_path / "image.zarr", shells(32), n_levels=1, chunk=16)
    address, _ = serve()
    volume = ws.open(f"{address}/image.zarr", memory="50 MB", channel=0)
    (tmp_path / "image.zarr" / "0" / "c" / "0" / "0" / "1" / "1" / "1").write_bytes(b"nothing")
    with pytest.raises(ws.errors.FileError, match=r"chunk \(1, 1, 1\)"):
        ws.render(volume, LOOK, size=(60, 60))


def test_a_server_that_is_gone_is_no_damaged_file(serve, tmp_path):
    """Microscopy, section 5: all errors ended in "truncated, damaged"."""
    ome_zarr(tmp_path / "image.zarr", shells(32), n_levels=1, chunk=16)
    address, _ = serve()
    volume = ws.open(f"{address}/image.zarr", memory="50 MB", channel=0)
    serve.stop()
    with pytest.raises(ws.errors.FileError, match="there is no connection to the server .*check the address") as caught:
        ws.render(volume, LOOK, size=(60, 60))
    assert not {"copy", "damaged", "truncated"} & set(str(caught.value).replace(",", " ").split())
    with pytest.raises(ws.errors.FileError, match="there is no connection to the server"):
        ws.open(f"{address}/image.zarr")


def test_a_missing_path_is_no_damaged_file(serve, tmp_path):
    ome_zarr(tmp_path / "image.zarr", shells(32), n_levels=1, chunk=16)
    address, _ = serve()
    with pytest.raises(ws.errors.FileError, match="no Zarr array or group at this address .*; check it"):
        ws.open(f"{address}/imag.zarr", channel=0)


def test_a_missing_package_is_named_with_the_command_that_installs_it(serve, monkeypatch):
    address, _ = serve()
    monkeypatch.setitem(sys.modules, "aiohttp", None)
    with pytest.raises(ws.errors.LibraryError, match=r'aiohttp is not installed; .*pip install "wavesplat\[http\]"'):
        ws.open(f"{address}/image.zarr")


def test_damage_is_damage(serve, tmp_path):
    ome_zarr(tmp_path / "image.zarr", shells(32), n_levels=1, chunk=16)
    file = tmp_path / "image.zarr" / "zarr.json"
    file.write_text(file.read_text()[:100])
    address, _ = serve()
    with pytest.raises(ws.errors.FileError, match="damaged"):
        ws.open(f"{address}/image.zarr", channel=0)
