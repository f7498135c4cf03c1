"""Clusters whose scheduler or client goes away, or that lack the package: one error that says so, and no wait."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from lazy_fakes import Slow, shells

import wavesplat as ws
from wavesplat._cluster import waiting

distributed: Any = pytest.importorskip("distributed")

LOOK = ws.TransferFunction([(120, 0.0), (121, 1.0)], [(0, 1.0, 0.8, 0.5)])

pytestmark = [
    # Sockets are closed by the client's loop, now and then after the test.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.xdist_group("dask"),
]


def _slow_volume() -> ws.LazyVolume:
    """A volume that takes seconds to draw, and was looked through."""
    array: Any = Slow(shells(64), (16, 16, 16))
    array.seconds = 0.0
    lazy = ws.Volume.lazy(array, memory="50 MB", cache=False)
    lazy.survey(0, "linear")
    array.seconds = 0.2
    return lazy


@contextlib.contextmanager
def _scheduler(folder: Path, **environment: str) -> Iterator[tuple[subprocess.Popen[bytes], Path]]:
    """A scheduler in a process of its own, and its file."""
    file = folder / "scheduler.json"
    command = ["-m", "distributed.cli.dask_scheduler", "--port", "0", "--host", "127.0.0.1", "--no-dashboard"]
    with _process([*command, "--scheduler-file", str(file)], environment) as process:
        yield process, file


@contextlib.contextmanager
def _process(command: list[str], environment: dict[str, str]) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen([sys.executable, *command], env={**os.environ, **environment}, stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def _pictures(lazy: ws.LazyVolume, client: Any) -> list[Any]:
    """Calls that draw one picture, and a frame, by a client."""
    return [
        lambda: ws.render(lazy, LOOK, "isometric", size=(200, 150), client=client),
        lambda: list(ws.render_frames(ws.Scene(lazy, LOOK), ["front"] * 4, size=(200, 150), client=client)),
    ]


def test_clusters_without_the_package_are_named(tmp_path: Path) -> None:
    """Such workers were left out like dead ones: after a minute the cluster was said to have none."""
    (tmp_path / "wavesplat").mkdir()
    (tmp_path / "wavesplat" / "__init__.py").write_text("raise ImportError('not here')")
    without = {"PYTHONPATH": str(tmp_path)}
    with _scheduler(tmp_path, **without) as (_, file):
        worker = ["-m", "distributed.cli.dask_worker", "--scheduler-file", str(file), "--no-dashboard", "--no-nanny"]
        with _process(worker, without), distributed.Client(scheduler_file=str(file), timeout=300) as client:
            client.wait_for_workers(1, timeout=300)
            for draw in _pictures(_slow_volume(), client):
                with pytest.raises(ws.errors.LibraryError, match=r"1 of 1 workers.*cannot be imported.*not here"):
                    draw()
            with pytest.raises(ws.errors.LibraryError, match=r"the scheduler cannot read.*not here.*same release"):
                waiting.result_of(client, waiting.held(client, b"", "nothing"))


def test_schedulers_that_are_gone_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures hung until the client gave up, for 100 s and more."""
    monkeypatch.setattr(waiting, "SCHEDULER_S", 1.0)
    lazy = _slow_volume()
    with _scheduler(tmp_path) as (scheduler, file):
        client = distributed.Client(scheduler_file=str(file), timeout=60)
        try:
            scheduler.kill()
            scheduler.wait()
            for draw in _pictures(lazy, client):
                begun = time.monotonic()
                with pytest.raises(ws.errors.ClusterError, match="lost the scheduler"):
                    draw()
                assert time.monotonic() - begun < 30
        finally:
            client.close(timeout=1)


def test_schedulers_that_go_in_mid_drawing_are_named(monkeypatch: pytest.MonkeyPatch, is_night: bool) -> None:
    """By day frames alone, whose blocks are those of a picture."""
    monkeypatch.setattr(waiting, "SCHEDULER_S", 1.0)
    for which in (0, 1) if is_night else (1,):
        with _local_cluster() as cluster, distributed.Client(cluster.scheduler_address, timeout=60) as client:
            ending = _when_busy(client, cluster.close)
            with pytest.raises(ws.errors.ClusterError, match=r"lost the scheduler|has lost its scheduler"):
                _pictures(_slow_volume(), client)[which]()
            ending.join()


def test_clients_that_are_closed_are_named() -> None:
    """They ended pictures with bare AttributeErrors and ClosedClientErrors."""
    lazy = _slow_volume()
    with _local_cluster() as cluster:
        for which in (0, 1):
            client = distributed.Client(cluster)
            closing = _when_busy(client, client.close)
            with pytest.raises(ws.errors.ClusterError, match="client was closed"):
                _pictures(lazy, client)[which]()
            closing.join()
            with pytest.raises(ws.errors.ArgumentError, match="client was closed; give a new"):
                _pictures(lazy, client)[which]()


def _local_cluster() -> Any:
    options = {"processes": False, "dashboard_address": "127.0.0.1:0"}
    return distributed.LocalCluster(n_workers=1, threads_per_worker=1, **options)


def _when_busy(client: Any, act: Any) -> threading.Thread:
    """A thread that acts once tasks run."""

    def wait_and_act() -> None:
        until = time.monotonic() + 60
        while not any(client.processing().values()) and time.monotonic() < until:
            time.sleep(0.02)
        act()

    thread = threading.Thread(target=wait_and_act)
    thread.start()
    return thread
