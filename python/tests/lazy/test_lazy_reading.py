"""Lazy volumes keep within their memory, read chunks once, and name what cannot be read."""

from __future__ import annotations

import os
import subprocess
import sys
import threading

import lazy_fakes
import numpy as np
import pytest
from cases_of_the_day import nightly
from lazy_fakes import Broken, Chunked, WrongShape, shells

import wavesplat as ws
from wavesplat._model.lazy.read_ahead import BoxReader

LOOK = ws.TransferFunction([(60, 0.0), (200, 0.2)], [(0, 1.0, 0.8, 0.5)])


def lazily(array, memory="100 MB", **options):
    return ws.Volume.lazy(array, memory=memory, **{"cache": False, **options})


def test_a_chunk_is_read_once_and_invisible_ones_never():
    array = Chunked(shells(192), (24, 24, 24))
    volume = lazily(array)
    volume.survey(0, "linear")
    assert set(array.counts.values()) == {1}, "looking through the samples reads each chunk once"
    assert len(array.counts) == 8**3
    array.counts.clear()
    ws.render(volume, LOOK, "isometric", size=(300, 300))
    assert max(array.counts.values()) == 1
    # Only chunks that are seen are read, and a chunk around them.
    is_seen = shells(192) > 60
    touched = {tuple(index) for index in np.argwhere(is_seen) // 24}
    around = {tuple(np.add(index, step)) for index in touched for step in np.ndindex(3, 3, 3)}
    assert len(array.counts) < 0.75 * 8**3
    assert set(array.counts) <= {tuple(np.subtract(index, 1)) for index in around}


def test_blocks_share_few_chunks():
    array = Chunked(shells(192), (24, 24, 24))
    volume = lazily(array, "3.5 MB")
    volume.survey(0, "linear")
    array.counts.clear()
    picture = ws.render(volume, LOOK, "isometric", size=(500, 500))
    assert picture.report["lazy"]["blocks"] > 1
    assert sum(array.counts.values()) <= 1.6 * len(array.counts)


def test_opaque_rays_stop_reading():
    solid = np.full((192, 96, 96), 200, np.uint8)
    solid[0], solid[-1] = 0, 0
    array = Chunked(solid, (16, 96, 96))
    volume = lazily(array, "4 MB")
    volume.survey(0, "linear")
    array.counts.clear()
    hard = ws.TransferFunction([(100, 0.0), (101, 1.0)], [(0, 1, 1, 1)])
    ws.render(volume, hard, ws.Camera.orbit(volume, 0, 90), size=(60, 60))
    assert len(array.counts) < 5, "of twelve layers"


def test_bounds_are_kept_for_other_programs(tmp_path):
    samples = shells(96)
    picture = []
    for _ in range(2):
        array = Chunked(samples, (16, 16, 16))
        array.token = "always the same"  # noqa: S105 - no secret
        volume = lazily(array, cache=tmp_path / "kept")
        picture.append(ws.render(volume, LOOK, "isometric", size=(100, 100)))
        n_reads = sum(array.counts.values())
    assert n_reads < 6**3, "nothing was looked through again"
    assert np.array_equal(picture[0].rgba, picture[1].rgba)
    # Changed or damaged contents are surveyed again.
    array = Chunked(samples, (16, 16, 16))
    array.token = "another one"  # noqa: S105 - no secret
    ws.render(lazily(array, cache=tmp_path / "kept"), LOOK, "isometric", size=(100, 100))
    assert sum(array.counts.values()) >= 6**3
    for file in (tmp_path / "kept").iterdir():
        file.write_bytes(file.read_bytes()[:100])
    array.counts.clear()
    array.token = "always the same"  # noqa: S105 - no secret
    again = ws.render(lazily(array, cache=tmp_path / "kept"), LOOK, "isometric", size=(100, 100))
    assert sum(array.counts.values()) >= 6**3
    assert np.array_equal(picture[0].rgba, again.rgba)


# By day arrays that give whole chunks.
@pytest.mark.parametrize("reads_parts", [False, *nightly(True)])
def test_too_little_memory_says_how_much_is_enough(reads_parts):
    array = Chunked(shells(256), (64, 64, 64))
    array.reads_parts = reads_parts
    volume = lazily(array, "50 kB")
    if reads_parts:
        # No chunk is too large; only the picture is.
        volume.survey(0, "linear")
        array.counts.clear()
    with pytest.raises(ws.errors.LimitError, match=r"memory is 50 kB.*give memory=\"(\d+) MB\"") as error:
        ws.render(volume, LOOK, "isometric", size=(300, 300))
    assert not array.counts, "it is told before anything is read"
    enough = str(error.value).split('memory="')[1].split('"')[0]
    picture = ws.render(lazily(array, enough), LOOK, "isometric", size=(300, 300))
    assert np.array_equal(picture.rgba, ws.render(ws.Volume(shells(256)), LOOK, "isometric", size=(300, 300)).rgba)


def test_a_fresh_process_stays_within_its_memory():
    code = """
import resource, sys
sys.path.insert(0, sys.argv[1])
import numpy as np, wavesplat as ws
from lazy_fakes import Chunked

class MadeUp(Chunked):
    def __init__(self, n):
        super().__init__(np.broadcast_to(np.zeros(1, np.uint8), (n, n, n)), (32, 32, 32))
    def read(self, lo, hi):
        z, y, x = (np.arange(a, b, dtype=np.float32) - 256 for a, b in zip(lo, hi))
        r = np.sqrt(z[:, None, None] ** 2 + y[None, :, None] ** 2 + x[None, None, :] ** 2)
        return (220 * np.exp(-((r - 150) / 12) ** 2)).astype(np.uint8)

tf = ws.TransferFunction([(60, 0.0), (200, 0.2)], [(0, 1.0, 0.8, 0.5)])
ws.render(ws.Volume(np.zeros((8, 8, 8), np.uint8)), tf, size=(8, 8))
def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
before = peak()
volume = ws.Volume.lazy(MadeUp(512), memory="32 MB", cache=False)
picture = ws.render(volume, tf, "isometric", size=(400, 400))
assert picture.rgba[..., 3].max() > 0.1
print(peak() - before)
"""
    here = os.path.dirname(lazy_fakes.__file__)  # noqa: PTH120
    told = subprocess.run([sys.executable, "-c", code, here], capture_output=True, text=True, check=True)
    # 32 MB of samples and bounds; the picture and its rays; what numpy needs to make samples up.
    assert float(told.stdout) < 32 + 45, "of 134 MB"


def test_a_chunk_that_cannot_be_read_is_named():
    volume = lazily(Broken(shells(96), (2, 3, 1), chunks=(16, 16, 16)))
    with pytest.raises(ws.errors.FileError, match=r"chunk \(2, 3, 1\)"):
        ws.render(volume, LOOK, "isometric", size=(60, 60))


def test_holes_are_drawn_and_reported():
    samples = shells(96)
    # A source that breaks after its survey, as a disk or a server may.
    array = Broken(samples, (2, 3, 1), times=0, chunks=(16, 16, 16))
    volume = lazily(array, holes=True)
    volume.survey(0, "linear")
    array.times = 10**9
    picture = ws.render(volume, LOOK, "isometric", size=(200, 200))
    assert any("chunk (2, 3, 1)" in hole for hole in picture.report["holes"])
    punched = samples.copy()
    punched[32:48, 48:64, 16:32] = 0
    whole = ws.render(ws.Volume(samples), LOOK, "isometric", size=(200, 200))
    assert not np.array_equal(picture.rgba, whole.rgba)
    assert np.abs(picture.rgba - ws.render(ws.Volume(punched), LOOK, "isometric", size=(200, 200)).rgba).max() < 0.02


def test_holes_are_left_out_of_the_survey_too():
    volume = lazily(Broken(shells(96), (2, 3, 1), chunks=(16, 16, 16)), holes=True)
    picture = ws.render(volume, LOOK, "isometric", size=(60, 60))
    assert picture.report["holes"]
    assert picture.rgba[..., 3].max() > 0.2


def test_what_comes_in_another_shape_is_refused():
    with pytest.raises(ws.errors.FileError, match="shape"):
        ws.render(lazily(WrongShape(shells(48))), LOOK, "isometric", size=(30, 30))


class WaitsForCancelling(Chunked):
    """A lazy array: reads under way end when the picture is cancelled, later ones when no more reads are wanted."""

    def __init__(self, samples, chunks):
        super().__init__(samples, chunks)
        self.told, self.is_cancelled, self.readers = threading.Condition(), False, []
        self.waits = lambda _: False
        self.n_begun = self.n_under_way = self.n_late = 0

    def progress(self, _):
        with self.told:
            if self.n_begun > 0:
                # Some reads are ahead of the survey or of drawing.
                assert self.told.wait_for(lambda: self.n_under_way > 0, timeout=60)
                self.is_cancelled = True
                self.told.notify_all()
            return not self.is_cancelled

    def read(self, lo, hi):
        with self.told:
            self.n_begun += 1
            if self.is_cancelled:
                self.n_late += 1
                for _ in range(6000):
                    if self.readers[-1]._stopped:
                        break
                    self.told.wait(0.01)
            elif self.waits(lo):
                self.n_under_way += 1
                self.told.notify_all()
                assert self.told.wait_for(lambda: self.is_cancelled, timeout=60)
        return super().read(lo, hi)


@pytest.mark.parametrize("where", ["surveying", "drawing"])
def test_cancelling_waits_for_no_more_than_the_reads_under_way(where, monkeypatch):
    array = WaitsForCancelling(shells(160), (16, 160, 160))
    volume = lazily(array, "8 MB")
    if where == "drawing":
        volume.survey(0, "linear")
    # A survey reports progress after each box; drawing reports it while it waits for the first one.
    array.waits, array.n_begun = (lambda lo: where == "drawing" or lo != (0, 0, 0)), 0
    begin = BoxReader.__init__

    def begin_and_hold(reader, *args, **options):
        begin(reader, *args, **options)
        array.readers.append(reader)

    monkeypatch.setattr(BoxReader, "__init__", begin_and_hold)
    with pytest.raises(ws.errors.CancelledError):
        ws.render(volume, LOOK, "isometric", size=(300, 300), progress=array.progress)
    assert array.n_late <= array.n_readers
    assert array.n_begun <= 2 * array.n_readers + (where == "surveying")


class WaitsForDrawing(Chunked):
    """A lazy array: a read ends when something was drawn since it began, or else after a time limit."""

    def __init__(self, samples, chunks):
        super().__init__(samples, chunks)
        self.done, self.n_reads, self.n_overlapping, self.told = 0.0, 0, 0, threading.Condition()
        self.patience_s = 0.0

    def progress(self, done):
        with self.told:
            self.done = done
            self.told.notify_all()

    def read(self, lo, hi):
        with self.told:
            before = self.done
            self.n_reads += 1
            self.n_overlapping += self.told.wait_for(lambda: self.done > before, timeout=self.patience_s)
        return super().read(lo, hi)


def test_reading_and_drawing_overlap():
    array = WaitsForDrawing(shells(192), (24, 192, 192))
    volume = lazily(array, "18 MB")
    volume.survey(0, "linear")
    camera = ws.Camera.orbit(volume, 0, 90)
    # The first blocks wait in vain, since nothing is drawn before them; where the machine is busy, all wait longer.
    for array.patience_s in (0.3, 1.0, 3.0):
        array.n_reads = array.n_overlapping = 0
        ws.render(volume, LOOK, camera, size=(120, 120), progress=array.progress)
        assert array.n_reads >= 6
        if array.n_overlapping >= array.n_reads // 3:
            break
    assert array.n_overlapping >= array.n_reads // 3, (array.n_overlapping, array.n_reads)


def test_memory_is_an_amount():
    for wrong in ("much", "-1 GB", 0, float("nan"), "2 parsecs"):
        with pytest.raises(ws.errors.ArgumentError, match="memory"):
            lazily(Chunked(shells(16)), wrong)
    assert lazily(Chunked(shells(16)), "1.5 GiB").memory == 3 << 29
    assert lazily(Chunked(shells(16)), 2e9).memory == 2 * 10**9
