"""Decisions of the program about many volumes stay to the bit: kinds, curves, windows, cameras.

Valid and damaged documents are read, or refused, in the words that are kept. `make brain-oracle` prints all
differences, and writes the lines anew where a change of them is meant.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import get_args

import brain_lines
import pytest

from wavesplat._looks.kinds.kinds import Kind


@pytest.mark.parametrize("group", brain_lines.groups())
def test_decisions_are_those_that_are_kept(group):
    lines = dict(brain_lines.groups()[group]())
    assert not (found := brain_lines.in_words(brain_lines.kept(group), lines)), found


def test_phantoms_are_of_every_kind():
    lines = brain_lines.kept("phantoms").values()
    found = {line["kind"]["kind"] for line in lines if "kind" in line.get("kind", {})}
    assert found == set(get_args(Kind))
    assert len(lines) >= 100


def test_numbers_do_not_depend_on_process_or_threads():
    program = "import brain_lines as b; print(b.in_words(b.kept('numbers'), dict(b.groups()['numbers']())) or 'equal')"
    other = {"PYTHONHASHSEED": "7", "RAYON_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    paths = os.pathsep.join([str(Path(brain_lines.__file__).parent), *sys.path])
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | other | {"PYTHONPATH": paths},
        capture_output=True,
        encoding="utf-8",
        timeout=120,
        check=False,
    )
    assert done.stdout == "equal\n", done.stdout + done.stderr


def test_differences_name_line_field_and_both_values():
    old = {"a": {"look": ["0x1.0p+0", 2], "camera": ["0x1.0p+0"]}, "b": {"kind": "MR"}}
    new = {"a": {"look": ["0x1.8p+0", 2], "camera": ["0x1.0000000000001p+0"]}, "b": {"kind": "MR"}}
    found = brain_lines.in_words(old, new)
    assert found == "1 of 2 lines differ: look in 1\n  a/look/0\n    was 0x1.0p+0 (1)\n    is  0x1.8p+0 (1.5)"
    assert "camera in 1" in brain_lines.in_words(old, new, to_the_bit=True)
    assert brain_lines.in_words({"a": {}}, {}).startswith("1 of 0 lines differ: all in 1")
