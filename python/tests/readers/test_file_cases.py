"""The files that the crate `files` is tested with, and what Python's readers find in them, are those that are kept."""

import json
from pathlib import Path

import file_cases

KEPT = Path(__file__).parents[3] / "crates/files/tests/cases.jsonl"


def test_the_crate_and_python_read_the_same():
    kept = {line["file"]: line for line in map(json.loads, KEPT.read_text().splitlines())}
    assert {line["file"]: line for line in map(json.loads, file_cases.lines())} == kept
