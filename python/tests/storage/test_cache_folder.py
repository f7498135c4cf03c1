"""The cache of surveys is private, bounded, safe for several processes, and never believed where it is damaged."""

from __future__ import annotations

import json
import os
import stat
import subprocess
import sys
import time
import tracemalloc

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._model.lazy import survey
from wavesplat._storage import cache_folder
from wavesplat._storage.cache_folder import CacheFolder, default_folder

ON_POSIX = pytest.mark.skipif(sys.platform == "win32", reason="permissions of POSIX")
NAMES = [f"{k:032x}.npz" for k in range(9)]


@pytest.fixture
def own(tmp_path, monkeypatch):
    """The user's cache folder, empty."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "home" / "caches"))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "home" / "caches"))
    return default_folder("surveys")


def write(folder, name, content=b"x"):
    CacheFolder(folder, True).write(name, lambda file: file.write(content))


def npy(tmp_path, seed=1):
    np.save(tmp_path / "a.npy", np.random.default_rng(seed).integers(0, 200, (24, 24, 24)).astype(np.uint8))
    return tmp_path / "a.npy"


def looked(path, **options):
    """Open a file lazily; "made" or "kept", as its survey is new or comes from the cache, and the range of values."""
    volume = ws.open(path, memory="50 MB", **options)
    return ("kept" if volume.survey(0, "linear").is_from_cache else "made"), volume.value_range


@ON_POSIX
@pytest.mark.parametrize("mask", [0o000, 0o022, 0o777 - 0o700])
def test_only_the_user_can_read_it(own, tmp_path, mask):
    before = os.umask(mask)
    try:
        assert looked(npy(tmp_path))[0] == "made"
    finally:
        os.umask(before)
    assert [stat.S_IMODE(folder.stat().st_mode) for folder in (own, own.parent)] == [0o700, 0o700]
    files = list(own.iterdir())
    assert [stat.S_IMODE(file.stat().st_mode) for file in files] == [0o600]
    # Folders and files of earlier releases are made private.
    own.chmod(0o755)
    own.parent.chmod(0o755)
    files[0].chmod(0o644)
    write(own, NAMES[0])
    assert {stat.S_IMODE(place.stat().st_mode) for place in (own, own.parent)} == {0o700}
    assert {stat.S_IMODE(place.stat().st_mode) for place in own.iterdir()} == {0o600}


def test_the_least_recently_used_files_are_removed_beyond_a_size(own, monkeypatch):
    monkeypatch.setattr(cache_folder, "MAX_BYTES", 3000)
    now = time.time()
    for k, name in enumerate(NAMES[:3]):
        write(own, name, bytes(1000))
        os.utime(own / name, (now - 100 + k,) * 2)
    with CacheFolder(own, True).open(NAMES[0]) as file:  # used now
        assert len(file.read()) == 1000
    write(own, NAMES[3], bytes(1000))
    assert sorted(file.name for file in own.iterdir()) == [NAMES[0], NAMES[2], NAMES[3]]
    (own / "notes.txt").write_bytes(bytes(9000))
    write(own, NAMES[4], bytes(1000))
    assert (own / "notes.txt").exists(), "no file of ours"
    assert sum(file.suffix == ".npz" for file in own.iterdir()) == 3


def test_what_was_not_used_for_long_is_removed(own, monkeypatch):
    for name in NAMES[:2]:
        write(own, name)
    part = own / f"{cache_folder.PART_PREFIX}killed{cache_folder.PART_SUFFIX}"
    part.write_bytes(b"half a")
    old = time.time() - cache_folder.MAX_AGE - 60
    for place in (own / NAMES[0], part):
        os.utime(place, (old, old))
    monkeypatch.setattr(cache_folder, "_TIDIED", set())
    assert CacheFolder(own, True).open(NAMES[2]) is None, "looking something up is enough"
    assert [file.name for file in own.iterdir()] == [NAMES[1]]


WRITER = """
import sys
from pathlib import Path
from wavesplat._storage import cache_folder
cache_folder.MAX_BYTES = 6 * 20_000
folder = cache_folder.CacheFolder(Path(sys.argv[1]), True)
wrong = 0
for k in range(60):
    for n in range(9):
        content = bytes([k, n]) * 10_000
        folder.write(f"{n:032x}.npz", lambda file: file.write(content))
        file = folder.open(f"{(n + 4) % 9:032x}.npz")
        if file is not None:
            with file:
                found = file.read()
            wrong += len(found) != 20_000 or found != found[:2] * 10_000
print(wrong)
"""


def test_two_processes_write_and_evict_at_once(own):
    writers = [
        subprocess.Popen([sys.executable, "-c", WRITER, str(own)], stdout=subprocess.PIPE, text=True) for _ in range(2)
    ]
    told = [writer.communicate(timeout=100)[0].strip() for writer in writers]
    assert [writer.returncode for writer in writers] == [0, 0]
    assert told == ["0", "0"], "whole files only"
    names = [file.name for file in own.iterdir()]
    assert all(cache_folder.NAME.fullmatch(name) for name in names), "nothing half-written is left"
    assert 5 <= len(names) <= 7


@ON_POSIX
def test_a_link_is_neither_read_nor_written_through(own, tmp_path):
    path = npy(tmp_path)
    assert looked(path)[0] == "made"
    (kept,) = own.iterdir()
    elsewhere = tmp_path / "elsewhere"
    kept.rename(elsewhere)
    content = elsewhere.read_bytes()
    kept.symlink_to(elsewhere)
    assert looked(path)[0] == "made", "not read through a link"
    assert not kept.is_symlink()
    assert elsewhere.read_bytes() == content
    assert looked(path)[0] == "kept"
    # A folder of the name is no file either.
    kept.unlink()
    kept.mkdir()
    assert looked(path)[0] == "made"


READER = """
import sys
from pathlib import Path
from wavesplat._storage.cache_folder import CacheFolder
folder = CacheFolder(Path(sys.argv[1]), True)
print(folder.open(sys.argv[2]))
folder.write(sys.argv[2], lambda file: file.write(b"x"))
print(folder.open(sys.argv[2]).read())
"""


@ON_POSIX
@pytest.mark.parametrize("number", [0, 1])
def test_nobody_waits_for_a_pipe(own, number):
    own.mkdir(parents=True)
    os.mkfifo(own / NAMES[0], 0o644)
    done = subprocess.run(
        [sys.executable, "-c", READER, str(own), NAMES[number]], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.split() == ["None", "b'x'"]
    assert number == 0 or stat.S_IMODE((own / NAMES[0]).stat().st_mode) == 0o644, "none of our files"


def test_a_kept_survey_of_more_than_the_memory_is_not_unpacked(own, tmp_path, monkeypatch):
    monkeypatch.setattr(survey, "MAX_KEPT_BYTES", 1 << 20)
    path = npy(tmp_path)
    wanted = looked(path)[1]
    (kept,) = own.iterdir()
    with np.load(kept) as parts:
        fields = dict(parts)
    np.savez_compressed(kept, **{**fields, "samples bounds": np.zeros(100 << 20, np.uint8)})
    tracemalloc.start()
    assert looked(path) == ("made", wanted)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 50 << 20


def _cut(content):
    return content[: len(content) // 2]


def _flipped(content):
    place = len(content) // 2
    return content[:place] + bytes([content[place] ^ 255]) + content[place + 1 :]


@pytest.mark.parametrize(
    "damage", [_cut, _flipped, lambda _: b"", lambda _: b"PK\3\4 no archive", lambda _: bytes(999)]
)
def test_damaged_and_foreign_files_are_replaced(own, tmp_path, damage):
    path = npy(tmp_path)
    wanted = looked(path)[1]
    (kept,) = own.iterdir()
    kept.write_bytes(damage(kept.read_bytes()))
    assert looked(path) == ("made", wanted)
    assert looked(path) == ("kept", wanted)


@pytest.mark.parametrize("change", ["format", "samples statistics", "samples bounds", "samples light", "look 0"])
def test_a_survey_of_something_else_is_not_believed(own, tmp_path, change):
    path = npy(tmp_path)
    wanted = looked(path)[1]
    (kept,) = own.iterdir()
    with np.load(kept) as parts:
        fields = dict(parts)
    changed = {
        "format": np.array([1]),
        "samples statistics": np.array([5.0, np.nan, 0]),
        "samples bounds": fields["samples bounds"][1:],
        "samples light": fields["samples light"][:-1],
        "look 0": fields["look 0"].astype("f8"),
    }
    with kept.open("wb") as file:
        np.savez_compressed(file, **{**fields, change: changed[change]})
    assert looked(path) == ("made", wanted)


def test_a_folder_of_ones_own(own, tmp_path):
    path = npy(tmp_path)
    for folder in (tmp_path / "near" / "kept", tmp_path / "there"):
        (tmp_path / "there").mkdir(exist_ok=True)
        assert looked(path, cache=folder)[0] == "made"
        assert looked(path, cache=str(folder))[0] == "kept"
        assert len(list(folder.iterdir())) == 1
    assert looked(path, cache=False)[0] == "made"
    assert looked(path, cache=False)[0] == "made"
    assert not own.exists()
    if os.name != "nt":
        assert stat.S_IMODE((tmp_path / "near" / "kept").stat().st_mode) == 0o700
        assert stat.S_IMODE((tmp_path / "there").stat().st_mode) == 0o777 & ~_umask(), "left as it is"


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask


def test_other_distances_are_another_survey(own, tmp_path):
    path = npy(tmp_path)
    assert [looked(path)[0], looked(path, spacing=(1, 1, 5))[0], looked(path)[0]] == ["made", "made", "kept"]


def test_a_folder_that_cannot_be_written_to_keeps_nothing_and_draws(own, tmp_path):
    path = npy(tmp_path)
    own.parent.parent.mkdir(parents=True)
    own.parent.write_text("in the way")
    assert looked(path)[0] == "made"
    assert looked(path)[0] == "made"


def test_scenes_neither_say_nor_choose_where_something_is_from_cache(tmp_path):
    scene = ws.Scene(ws.open(npy(tmp_path), memory="50 MB", cache=tmp_path / "kept"))
    assert "kept" not in scene.to_json()
    document = json.loads(scene.to_json())
    document["layers"][0]["volume"]["cache"] = str(tmp_path / "elsewhere")
    with pytest.raises(ws.errors.ArgumentError, match="where files are written is not a document"):
        ws.Scene.from_json(json.dumps(document))
    assert not (tmp_path / "elsewhere").exists()
