"""Damage to files and documents, by hypothesis, and the check of what a reader makes of them.

`make fuzz` sets FUZZ_SECONDS: then each test runs for so long, with random seeds; else a few examples, the same ones
each time.
"""

from __future__ import annotations

import contextlib
import copy
import json
import os
import re
import signal
import struct
import sys
import time
import tracemalloc
import warnings

import hypothesis
from hypothesis import strategies as st

if sys.platform == "linux":
    import resource

from wavesplat.errors import WavesplatError, WavesplatWarning

#: Seconds for each test; 0: a short run.
SECONDS = float(os.environ.get("FUZZ_SECONDS", "0"))
#: Examples of a part of a long run, after which the clock is looked at.
N_OF_PART = 200
#: Letters of a message, at most.
MAX_LETTERS = 4500
#: Most that an example may take: seconds of the processor, seconds by the clock, and bytes of memory.
MAX_CPU_S, MAX_S, MAX_BYTES = 5.0, 60, 1 << 28

ODD_WORDS = [
    b"", b"0", b"1", b"2", b"3", b"-1", b"-0", b"1.5", b"65536", b"4294967296", b"-9223372036854775808", b"9" * 30,
    b"1000000000000", b"1e308", b"-1e308", b"1e-320", b"1e999", b"nan", b"inf", b"-inf", b"NaN", b"1_0", b"0x10", b"+2",
    "\u0663".encode(), "\u00b2".encode(), "\u00e9\u4e2d".encode(), b"\xff\xfe", b"\0", b"\x1b[31m", b"\x85", b"%d %s%n",
    b"../x", b"/", b"none", b"None", b"true", b"list", b"gzip", b"raw", b"ascii", b"big", b"a" * 3000, b"1 2 3",
    b"(1,0,0)",
]  # fmt: skip
ODD_NUMBERS = [
    struct.pack(order + kind, value)
    for order in "<>"
    for kind, values in {
        "b": (0, 1, 2, 3, -1, -128),
        "h": (0, 1, 2, -1, 32767, -32768),
        "i": (0, 1, 2, -1, 2**31 - 1, -(2**31), 65536),
        "q": (0, 1, -1, 2**63 - 1, -(2**63), 2**32, 10**12),
        "f": (0.0, -0.0, 1.5, float("nan"), float("inf"), -1.0, 3e38, 1e-45),
        "d": (0.0, float("nan"), float("-inf"), 1e308, 1e12, -1.0, 5e-324),
    }.items()
    for value in values
]
#: Stands in a document for lists inside lists, deeper than parsers and writers of messages that call themselves like.
NESTED, LISTS = "nested lists", "[" * 900 + "]" * 900
ODD_VALUES = [
    None, True, False, 0, 1, 2, -1, 7, 0.5, 1e-320, 1e308, -1e308, float("nan"), float("inf"), float("-inf"), 10**12,
    2**63, 10**400, "", "a", "auto", "over", "\u00e9\u4e2d", "\x1b[31m\n", "\0", "\ud800", "1", "nan", "a" * 3000,
    "../x", "http://127.0.0.1:9/x", [], [[]], [0], [1, 2, 3], [0, 0, 0], [float("nan")] * 3, [1e308] * 3,
    [[0, 0], [1, 1]],
    [0] * 3000, {}, {"": 0}, {"version": 1}, {"path": "."}, NESTED,
]  # fmt: skip
WORD = re.compile(rb"[^\s:=,;\"'<>(){}\[\]]+")

PLACES = st.integers(0, 1 << 24)
BYTES_CHANGES = st.one_of(
    st.tuples(st.just("word"), PLACES, st.sampled_from(ODD_WORDS)),
    st.tuples(st.just("number"), PLACES, st.sampled_from(ODD_NUMBERS)),
    st.tuples(st.sampled_from(["word again", "line again", "line there", "lose line", "swap words"]), PLACES, PLACES),
    st.tuples(st.just("flip"), PLACES, st.integers(1, 255)),
    st.tuples(st.just("add"), PLACES, st.binary(min_size=1, max_size=9)),
    st.tuples(st.just("lose"), PLACES, st.integers(1, 20)),
    st.tuples(st.just("cut"), PLACES, st.none()),
)
#: Changes of bytes, and whether each is in the header.
DAMAGE = st.lists(st.tuples(BYTES_CHANGES, st.sampled_from([True, True, True, False])), min_size=1, max_size=4)
JSON_CHANGES = st.one_of(
    st.tuples(st.just("value"), PLACES, st.sampled_from(ODD_VALUES)),
    st.tuples(st.sampled_from(["value of", "lose", "twice", "listed"]), PLACES, PLACES),
    st.tuples(
        st.just("add"), PLACES, st.tuples(st.sampled_from(["", "a", "name", "\ud800"]), st.sampled_from(ODD_VALUES))
    ),
)
JSON_DAMAGE = st.lists(JSON_CHANGES, min_size=1, max_size=3)


def fuzz(n, check, *strategies):
    """Check `n` examples of what the strategies draw, few by day, or as many as FUZZ_SECONDS allow."""
    settings = hypothesis.settings(
        max_examples=N_OF_PART if SECONDS else min(n, hypothesis.settings().max_examples),
        derandomize=not SECONDS,
        database=None,
        deadline=None,
        print_blob=False,
        # Without `explain`, which runs a failing example a hundred times more.
        phases=[hypothesis.Phase.generate, hypothesis.Phase.shrink],
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    until = time.monotonic() + SECONDS
    while True:
        settings(hypothesis.given(st.tuples(*strategies))(lambda drawn: check(*drawn)))()
        if time.monotonic() >= until:
            return


def damaged(content, changes, n_header=None, fields=()):
    """A copy of bytes with changes. `n_header`: length of the header; `fields`: (offset, length) of its numbers."""
    content = bytearray(content)
    for (kind, place, what), in_header in changes:
        n = min(len(content), n_header or len(content)) if in_header else len(content)
        if n == 0:
            break
        if kind == "number" and fields and in_header:
            at, length = fields[place % len(fields)]
            content[at : at + length] = what[:length].ljust(length, b"\0")
        else:
            _change(content, kind, place, what, n)
    return bytes(content)


def _change(content, kind, place, what, n):
    at = place % n
    if kind == "word":
        begin, end = _word(content, place, n)
        content[begin:end] = what
    elif kind == "number":
        content[at : at + len(what)] = what
    elif kind in ("word again", "swap words"):
        (begin, end), (first, last) = _word(content, place, n), _word(content, what, n)
        one, other = content[begin:end], content[first:last]
        if kind == "swap words" and end <= first:
            content[first:last] = one
        content[begin:end] = other
    elif kind in ("line again", "line there", "lose line"):
        lines = content[:n].splitlines(keepends=True)
        line = lines[place % len(lines)] if kind == "line again" else lines.pop(place % len(lines))
        if kind != "lose line":
            lines.insert(what % (len(lines) + 1), line)
        content[:n] = b"".join(lines)
    elif kind == "flip":
        content[at] ^= what
    elif kind == "add":
        content[at:at] = what
    elif kind == "lose":
        del content[at : at + what]
    else:
        del content[at:]


def _word(content, place, n):
    words = [match.span() for match in WORD.finditer(content, 0, n)]
    return words[place % len(words)] if words else (0, 0)


def damaged_json(document, changes):
    """The text of a document whose values have been changed, lost, doubled or moved."""
    root = [copy.deepcopy(document)]
    for kind, place, what in changes:
        places = [one for one in _places(root) if one[1] is not None]
        inside, name = places[place % len(places)]
        if kind == "value":
            inside[name] = copy.deepcopy(what)
        elif kind == "value of":
            other, others = places[what % len(places)]
            inside[name] = copy.deepcopy(other[others])
        elif kind == "listed":
            inside[name] = [inside[name]]
        elif kind == "lose" and inside is not root:
            del inside[name]
        elif kind == "twice" and isinstance(inside, list):
            inside.insert(name, copy.deepcopy(inside[name]))
        elif kind == "add" and isinstance(inside[name], dict):
            inside[name][what[0]] = copy.deepcopy(what[1])
    return json.dumps(root[0] if root else None).replace(json.dumps(NESTED), LISTS)


def _places(value):
    """All fields of a document: what each lies in, and its name or number there."""
    names = list(value) if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ()
    for name in names:
        yield value, name
        yield from _places(value[name])


class TooLong(BaseException):
    """An example does not end; no error that readers catch."""


def check(load, *names):
    """The result of `load()`; None where it is refused, in one line that has one of the names.

    Any other error, a warning that is not ours, and more time or memory than any small file needs fail the test.
    """
    resident = _most_resident()
    tracemalloc.start()
    began = time.process_time()
    with warnings.catch_warnings(record=True) as said, _alarm():
        warnings.simplefilter("always")
        try:
            result = load()
        except WavesplatError as error:
            line, result = str(error), None
            assert line.isprintable(), line
            assert len(line) < MAX_LETTERS, line
            assert any(name in line for name in names), line
            # Sizes are to be checked before memory is asked for.
            assert "takes more memory than there is" not in line, line
    assert time.process_time() - began < MAX_CPU_S, f"{time.process_time() - began:.1f} s"
    _, asked_for = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert max(asked_for, _most_resident() - resident) < MAX_BYTES, f"{asked_for} bytes"
    # Libraries' files that only the garbage collector closes are no fault of a file.
    ours = (WavesplatWarning, ResourceWarning)
    foreign = [
        f"{one.filename}:{one.lineno}: {one.category.__name__}: {one.message}"
        for one in said
        if not issubclass(one.category, ours)
    ]
    assert not foreign, foreign
    return result


@contextlib.contextmanager
def _alarm():
    def stop(*_):
        raise TooLong(f"more than {MAX_S} s")

    if not hasattr(signal, "SIGALRM"):
        yield
        return
    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(MAX_S)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def _most_resident():
    """Most memory that the process has had, bytes; 0 where it is unknown. It counts what libraries in C take."""
    if sys.platform != "linux":
        return 0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10
