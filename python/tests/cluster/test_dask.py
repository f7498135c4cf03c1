"""Pictures over the workers of a Dask cluster: the bytes of one machine, whatever happens to workers and reads."""

from __future__ import annotations

import contextlib
import importlib
import os
import pickle
import signal
import threading
import time

import lazy_fakes
import numpy as np
import pytest
from lazy_fakes import Broken, Chunked, FailsOnce, Slow, WearsOut, shells

import wavesplat as ws

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")

LOOK = ws.TransferFunction([(60, 0.0), (200, 0.2)], [(0, 1.0, 0.8, 0.5)])
HARD = ws.TransferFunction([(120, 0.0), (121, 1.0)], [(0, 1.0, 0.8, 0.5)])

pytestmark = [
    # The scheduler's sockets are closed by its own loop, now and then after the test.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    # One process runs all tests of this file, so that there is one cluster.
    pytest.mark.xdist_group("dask"),
]


@contextlib.contextmanager
def _two_workers():
    """A client of a cluster of two processes."""
    # A port of its own: others may run clusters on this machine.
    options = {"dashboard_address": "127.0.0.1:0", "host": "127.0.0.1", "memory_limit": "1GiB"}
    # Workers import Dask and what it finds, which on a loaded machine takes more than the usual 30 s.
    patience = {"distributed.comm.timeouts.connect": "300s", "distributed.comm.timeouts.tcp": "300s"}
    os.environ["PYTHONPATH"] = os.path.dirname(lazy_fakes.__file__)  # noqa: PTH120 - workers unpickle the fakes
    with (
        dask.config.set(patience),
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, **options) as cluster,
        distributed.Client(cluster, timeout=300) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def client():
    with _two_workers() as client:
        yield client


def _zarr(folder, samples, chunks=(17, 23, 29)):
    import zarr

    array = zarr.create_array(folder / "a.zarr", shape=samples.shape, chunks=chunks, dtype=samples.dtype)
    array[:] = samples
    return folder / "a.zarr"


def _pelvis(folder):
    whole = ws.examples.ct_pelvis()
    samples = np.array(whole.samples)
    # Lazy volumes are drawn with the table, others without.
    samples[:, :13] = -1000
    volume = ws.Volume(samples, world_from_index=whole.world_from_index, facts=whole.facts, name=whole.name)
    path = _zarr(folder, samples)
    lazy = ws.Volume.lazy(
        __import__("zarr").open_array(path),
        world_from_index=volume.world_from_index,
        facts=volume.facts,
        name=volume.name,
        memory="100 MB",
    )
    return volume, lazy


OPERATORS = (
    "over",
    "maximum",
    "depth-shaded-maximum",
    "local-maximum",
    "minimum",
    "mean",
    "x-ray",
    ws.FirstHit(250.0),
    "depth-colored-maximum",
    "attenuated-maximum",
)


def _scenes(volume, is_night):
    """30 scenes: operators, cameras, kernels, light, clips. By day each operator has one camera."""
    views = [
        ws.Camera.orbit(volume, 30, 20),
        ws.Camera.orbit(volume, 45, 35, view_angle=60),
        ws.Camera.orbit(volume, -120, -30),
    ]
    scenes = []
    for k, operator in enumerate(OPERATORS):
        look = "ct-soft-tissue" if operator == "over" else ws.Look.auto(volume, "over")
        for view in views if is_night else [views[k % 3]]:
            kernel = ("linear", "catmull-rom", "bspline3")[k % 3]
            clip = ws.ClipPlane((0, 0, 0), (0, 1, 0.3)) if k % 4 == 3 else ()
            depth = operator in ("over", "maximum", "attenuated-maximum") or isinstance(operator, ws.FirstHit)
            options = {"size": (90, 70), "kernel": kernel, "composite": operator, "depth": depth}
            scenes.append((look, clip, view, options))
    return scenes


def _same(a, b):
    planes = [(a.rgba, b.rgba), (a.depth, b.depth), (a.value, b.value)]
    return all((x is None and y is None) or x.tobytes() == y.tobytes() for x, y in planes)


def test_blocks_have_the_bytes_of_one_machine(client, tmp_path, is_night):
    """By day `test_lazy_pictures.py` has every operator block by block; here each second one."""
    volume, lazy = _pelvis(tmp_path)
    scenes = _scenes(volume, is_night)[:: 1 if is_night else 2]
    assert len(scenes) == (30 if is_night else 5)
    for look, clip, view, options in scenes:
        here = ws.Scene(volume, look, clip=clip).render(view, **options)
        there = ws.Scene(lazy, look, clip=clip).render(view, client=client, **options)
        assert _same(here, there), options
        assert there.report["lazy"]["blocks"] > 1


def test_segments_have_the_bytes_of_one_machine_with_segments(client, tmp_path, is_night):
    """By day `test_volume_parts.py` merges every operator; here each third one."""
    volume, lazy = _pelvis(tmp_path)
    n = 0
    for look, clip, view, options in _scenes(volume, is_night)[:: 1 if is_night else 3]:
        if options["composite"] == "local-maximum":
            continue
        own = {**options, "depth": False, "segments": 30}
        here = ws.Scene(volume, look, clip=clip).render(view, **own)
        there = ws.Scene(lazy, look, clip=clip).render(view, client=client, **own)
        assert _same(here, there), options
        n += 1
    assert n == (27 if is_night else 3)


def test_frames_have_the_bytes_of_one_machine(client, tmp_path):
    volume, lazy = _pelvis(tmp_path)
    cameras = [ws.Camera.orbit(volume, angle, 20) for angle in (0, 40, 80)]
    told = []
    for scene in (ws.Scene(lazy, "ct-bone"), ws.Scene(volume, "ct-bone")):
        pictures = list(ws.render_frames(scene, cameras, client=client, size=(60, 50), progress=told.append))
        for picture, camera in zip(pictures, cameras, strict=True):
            assert _same(picture, ws.render(volume, "ct-bone", camera, size=(60, 50)))
    assert told == pytest.approx([1 / 3, 2 / 3, 1.0] * 2)


def test_a_movie_is_drawn_elsewhere(client, tmp_path):
    pytest.importorskip("av")
    volume, _ = _pelvis(tmp_path)
    for name, where in (("here", None), ("there", client), ("threads", "threads")):
        ws.movie(volume, tmp_path / name / "%02d.png", ws.Turn(frames=4), "ct-bone", size=(40, 40), client=where)
    for k in range(4):
        frames = {(tmp_path / name / f"{k:02}.png").read_bytes() for name in ("here", "there", "threads")}
        assert len(frames) == 1


def test_threads_of_this_process_will_do(tmp_path):
    volume, lazy = _pelvis(tmp_path)
    view = ws.Camera.orbit(volume, 30, 20)
    here = ws.render(volume, "ct-bone", view, size=(90, 70))
    assert _same(here, ws.render(lazy, "ct-bone", view, size=(90, 70), client="threads"))
    cut = ws.render(volume, "ct-bone", view, size=(90, 70), segments=25)
    assert _same(cut, ws.render(lazy, "ct-bone", view, size=(90, 70), client="threads", segments=25))
    # The bound is the one of docs/large_volumes.md, without even light on cut faces.
    shading = ws.Look.preset("ct-bone", volume).shading.changed(even_cuts=0)
    here = ws.render(volume, "ct-bone", view, size=(90, 70), shading=shading)
    assert np.abs(cut.rgba - here.rgba).max() <= 2e-4


def test_arrays_in_workers_memory_are_drawn_in_segments(client):
    da = pytest.importorskip("dask.array")
    samples = shells(64)
    persisted = da.from_array(samples, chunks=(20, 30, 25)).persist()
    lazy = ws.Volume.lazy(persisted, memory="50 MB")
    here = ws.render(ws.Volume(samples), LOOK, "isometric", size=(80, 60), segments=16)
    assert _same(here, ws.render(lazy, LOOK, "isometric", size=(80, 60), segments=16, client=client))
    with pytest.raises(ws.errors.ArgumentError, match="segments=256"):
        ws.render(lazy, LOOK, "isometric", size=(80, 60), client=client)


def _slow(samples, seconds):
    """A lazy volume of these samples, whose boxes take some seconds each to read once it was looked through."""
    array = Slow(samples, (16, 16, 16))
    array.seconds = 0.0
    lazy = ws.Volume.lazy(array, memory="50 MB", cache=False)
    lazy.survey(0, "linear")
    array.seconds = seconds
    return lazy


def test_a_worker_that_is_killed_changes_nothing(client):
    samples = shells(96)
    lazy = _slow(samples, 0.05)
    here = ws.render(ws.Volume(samples), HARD, "isometric", size=(200, 150))
    pids = client.run(os.getpid)
    worker, pid = next(iter(pids.items()))
    was_busy = []

    def kill_in_the_middle():
        until = time.monotonic() + 60
        while not client.processing().get(worker) and time.monotonic() < until:
            time.sleep(0.02)
        was_busy.append(bool(client.processing().get(worker)))
        os.kill(pid, signal.SIGKILL)

    killer = threading.Thread(target=kill_in_the_middle)
    killer.start()
    there = ws.render(lazy, HARD, "isometric", size=(200, 150), client=client)
    killer.join()
    assert was_busy == [True], "it was killed while it drew"
    assert _same(here, there)
    client.wait_for_workers(2, timeout=300)
    assert set(client.run(os.getpid).values()) != set(pids.values())


@pytest.mark.parametrize(
    "seconds", [pytest.param(s, marks=() if s == 0.03 else pytest.mark.nightly) for s in (-0.1, 0.0, 0.03, 0.15)]
)
def test_a_worker_that_is_killed_at_the_start_changes_nothing(client, seconds):
    """The picture hung, or ended with a bare KeyError, if a worker died just before or while it began (F3, F4)."""
    samples = shells(64)
    lazy = _slow(samples, 0.0)
    here = ws.render(ws.Volume(samples), HARD, "isometric", size=(80, 60))
    client.wait_for_workers(2, timeout=300)
    pid = next(iter(client.run(os.getpid, on_error="ignore").values()))
    killer = threading.Timer(max(seconds, 0.0), os.kill, (pid, signal.SIGKILL))
    killer.start()
    time.sleep(max(-seconds, 0.0))
    assert _same(here, ws.render(lazy, HARD, "isometric", size=(80, 60), client=client))
    killer.join()
    client.wait_for_workers(2, timeout=300)


def _restart_when_busy(client):
    """A thread that restarts all workers once tasks run."""

    def restart():
        until = time.monotonic() + 60
        while not any(client.processing().values()) and time.monotonic() < until:
            time.sleep(0.02)
        client.restart(timeout=300)

    thread = threading.Thread(target=restart)
    thread.start()
    return thread


def test_workers_that_are_restarted_change_nothing(is_night):
    """Frames ended with a bare FutureCancelledError."""
    samples = shells(64)
    lazy = _slow(samples, 0.05)
    here = ws.render(ws.Volume(samples), HARD, "isometric", size=(200, 150))
    with _two_workers() as client:
        if is_night:  # by day frames alone, whose blocks are those of one picture
            restarting = _restart_when_busy(client)
            assert _same(here, ws.render(lazy, HARD, "isometric", size=(200, 150), client=client))
            restarting.join()
            client.wait_for_workers(2, timeout=300)
        restarting = _restart_when_busy(client)
        pictures = list(ws.render_frames(ws.Scene(lazy, HARD), ["isometric"] * 4, size=(200, 150), client=client))
        restarting.join()
    assert len(pictures) == 4
    assert all(_same(here, picture) for picture in pictures)


@pytest.mark.parametrize(
    ("module", "step"),
    [pytest.param("machines", "facts_of_workers", marks=pytest.mark.nightly), ("blocks", "held")],
)
def test_a_worker_that_dies_within_a_step_of_the_start_changes_nothing(monkeypatch, module, step):
    """Killed by the clock, a worker is seldom hit in these steps (F3, F4): this one is stopped as they begin."""
    samples = shells(64)
    lazy = ws.Volume.lazy(Chunked(samples, (16, 16, 16)), memory="50 MB", cache=False)
    lazy.survey(0, "linear")
    here = ws.render(ws.Volume(samples), HARD, "isometric", size=(80, 60))
    drawn = []
    with _two_workers() as client:
        client.wait_for_workers(2, timeout=300)
        pid = next(iter(client.run(os.getpid).values()))
        killer = threading.Timer(0.5, os.kill, (pid, signal.SIGKILL))
        place = importlib.import_module(f"wavesplat._cluster.{module}")
        real = getattr(place, step)

        def struck(*arguments):
            if killer.ident is None:
                os.kill(pid, signal.SIGSTOP)
                killer.start()
            return real(*arguments)

        monkeypatch.setattr(place, step, struck)
        drawing = threading.Thread(
            target=lambda: drawn.append(ws.render(lazy, HARD, "isometric", size=(80, 60), client=client)), daemon=True
        )
        drawing.start()
        drawing.join(timeout=120)
        killer.join()
        assert drawn, "it hangs, or ended with an error"
    assert _same(here, drawn[0])


def test_a_cluster_that_loses_all_workers_is_named(monkeypatch):
    from wavesplat._cluster import waiting

    monkeypatch.setattr(waiting, "PATIENCE_S", 1.0)
    monkeypatch.setattr(waiting, "LOOK_S", 0.3)
    samples = shells(64)
    lazy = _slow(samples, 0.2)
    options = {"processes": False, "dashboard_address": "127.0.0.1:0"}
    with (
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, **options) as cluster,
        distributed.Client(cluster) as alone,
    ):

        def end_in_the_middle():
            until = time.monotonic() + 60
            while not any(alone.processing().values()) and time.monotonic() < until:
                time.sleep(0.02)
            cluster.scale(0)

        threading.Thread(target=end_in_the_middle).start()
        with pytest.raises(ws.errors.ClusterError, match="all workers of the cluster were lost"):
            ws.render(lazy, HARD, "isometric", size=(200, 150), client=alone)


def test_a_read_that_fails_once_is_done_again(client):
    samples = shells(64)
    lazy = ws.Volume.lazy(FailsOnce(samples, (16, 16, 16)), memory="50 MB", cache=False)
    FailsOnce.failed = True  # the survey runs in this process, and must not fail
    there = ws.render(lazy, LOOK, "isometric", size=(80, 60), client=client)
    assert _same(there, ws.render(ws.Volume(samples), LOOK, "isometric", size=(80, 60)))


def test_a_read_that_always_fails_is_named(client):
    array = Broken(shells(64), (2, 2, 1), times=0, chunks=(16, 16, 16))
    lazy = ws.Volume.lazy(array, memory="50 MB", cache=False)
    lazy.survey(0, "linear")
    array.times = 10**6
    with pytest.raises(ws.errors.FileError, match=r"chunk \(2, 2, 1\)"):
        ws.render(lazy, LOOK, "isometric", size=(80, 60), client=client)


def test_a_source_that_wears_out_is_named(client, monkeypatch):
    monkeypatch.setattr(WearsOut, "n_reads", -(10**6))  # the survey runs in this process, and must not fail
    lazy = ws.Volume.lazy(WearsOut(shells(64), 20), memory="50 MB", cache=False)
    begun = time.monotonic()
    with pytest.raises(ws.errors.FileError, match=r"cannot read the samples z .*Input/output error"):
        ws.render(lazy, LOOK, "isometric", size=(200, 150), client=client)
    assert time.monotonic() - begun < 30


def _truncated(path):
    os.truncate(path, path.stat().st_size // 2)


def _without_chunks(path):
    for chunk in path.rglob("c/*/*/*"):
        chunk.unlink()


@pytest.mark.parametrize("suffix", [".npy", ".h5", ".zarr"])
@pytest.mark.parametrize("is_lost", [False, True])
def test_files_that_are_lost_in_mid_drawing_are_named(client, tmp_path, suffix, is_lost):
    samples = np.repeat(np.repeat(np.repeat(shells(64), 2, 0), 2, 1), 2, 2)
    path = tmp_path / f"a{suffix}"
    if suffix == ".npy":
        np.save(path, samples)
    elif suffix == ".h5":
        with pytest.importorskip("h5py").File(path, "w") as file:
            file.create_dataset("a", data=samples, chunks=(16, 16, 16), compression="gzip")
    else:
        _zarr(tmp_path, samples, (16, 16, 16))
    lazy = ws.open(path, memory="20 MB", cache=False)
    lazy.survey(0, "linear")
    told = []

    def hurt(share):
        if share == 0:  # the samples are looked through, and nothing is drawn yet
            return
        told.append(share)
        if len(told) == 1:
            if suffix == ".zarr":
                (_without_chunks if is_lost else lambda where: [_truncated(c) for c in where.rglob("c/*/*/*")])(path)
            else:
                (path.unlink if is_lost else lambda: _truncated(path))()

    begun = time.monotonic()
    with pytest.raises(
        ws.errors.FileError, match=r"changed or replaced|not there any more|written to while|cannot read"
    ):
        ws.render(lazy, LOOK, "isometric", size=(200, 150), client=client, progress=hurt)
    assert 0 < told[0] < 1
    assert time.monotonic() - begun < 30


def test_progress_is_told_and_cancels(client):
    lazy = ws.Volume.lazy(Chunked(shells(64), (16, 16, 16)), memory="50 MB", cache=False)
    told = []
    ws.render(lazy, LOOK, "isometric", size=(200, 150), client=client, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == pytest.approx(1.0)
    with pytest.raises(ws.errors.CancelledError):
        ws.render(lazy, LOOK, "isometric", size=(200, 150), client=client, progress=lambda _: False)


def test_clients_that_cannot_draw_are_refused(client):
    lazy = ws.Volume.lazy(shells(32), memory="50 MB")
    for wrong, match in (("processes", "threads"), (42, "Client"), (object(), "Client")):
        with pytest.raises(ws.errors.ArgumentError, match=match):
            ws.render(lazy, LOOK, size=(20, 20), client=wrong)


def test_workers_without_the_package_are_named(client, monkeypatch):
    def run(_function, on_error):
        assert on_error == "return"
        return {"tcp://10.0.0.1:1": (None, "host", 1, 1, 0), "tcp://10.0.0.2:1": ("0.0.9", "host", 1, 1, 0)}

    monkeypatch.setattr(client, "run", run)
    with pytest.raises(ws.errors.LibraryError, match=r"2 of 2 workers.*10.0.0.1.*no wavesplat.*PipInstall"):
        ws.render(ws.Volume.lazy(shells(32), memory="50 MB"), LOOK, size=(20, 20), client=client)


def test_what_is_sent_is_small(tmp_path):
    _, lazy = _pelvis(tmp_path)
    assert len(pickle.dumps(ws.Scene(lazy, "ct-bone"))) < 20_000
