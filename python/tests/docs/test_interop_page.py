"""The page docs/interop.md: its code runs, in order, and prints what its comments say."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import re
from pathlib import Path

import pytest

PAGE = (Path(__file__).parents[3] / "docs" / "interop.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
#: Large libraries that need not be installed.
LARGE = ("pyvista",)


def test_its_code_runs(tmp_path, monkeypatch):
    for needed in ("xarray", "dask", "PIL"):
        pytest.importorskip(needed)
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    n_run = 0
    for block in BLOCKS:
        if any(f"import {name}" in block and importlib.util.find_spec(name) is None for name in LARGE):
            continue
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            exec(block, names)  # noqa: S102 - the code of our own page
        for told in re.findall(r"print\(error\)  # (.*)|print\(ws\.Volume\(smooth\)\)  # (.*)", block):
            assert "".join(told) in said.getvalue()
        n_run += 1
    assert n_run >= len(BLOCKS) - 1 == 6
    assert sorted(path.name for path in tmp_path.iterdir()) == ["head.nii.gz", "head.nrrd"]


def test_it_names_what_gives():
    import wavesplat as ws

    giving = [name for name in vars(ws.Volume) if name.startswith("to_")]
    assert len(giving) == 4
    assert [name for name in [*giving, "save"] if f"`volume.{name}(" not in PAGE] == []
