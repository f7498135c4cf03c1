"""The notebooks of the pages: they run from top to bottom, each shows the viewer, and none carries outputs."""

from __future__ import annotations

import json
import re
import warnings

import pages
import pytest

FOLDER = pages.ROOT / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
WIDGET, PICTURE = "application/vnd.jupyter.widget-view+json", "image/png"
MAX_BYTES = 12_000
SECONDS_FOR_A_CELL = 120


def test_there_are_six():
    assert [path.stem for path in NOTEBOOKS] == ["ct", "field", "first", "levels", "microscope", "overlay"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_outputs_are_not_kept_and_the_first_cell_leads_to_places_that_run_it(path):
    assert path.stat().st_size <= MAX_BYTES
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert [cell for cell in code if cell["outputs"] or cell["execution_count"] is not None] == []
    links = re.findall(r"\]\((https://[^)]+)\)", "".join(cells[0]["source"]))
    assert [link.split("/")[2] for link in links] == ["mybinder.org", "colab.research.google.com"]
    assert all(link.endswith(f"docs/notebooks/{path.name}") for link in links)
    # Nothing is released yet, and somebody else may take the name: no cell installs it by name.
    assert "".join(code[0]["source"]).startswith("# On Colab, once Wavesplat is released: %pip install")
    assert [cell for cell in code if re.search(r"^\s*[!%]", "".join(cell["source"]), re.MULTILINE)] == []


# By day the first one shows that a kernel runs, shows the viewer and draws.
@pytest.mark.parametrize(
    "path",
    [path if path.stem == "first" else pytest.param(path, marks=pytest.mark.nightly) for path in NOTEBOOKS],
    ids=lambda path: path.stem,
)
def test_it_runs(path, tmp_path, monkeypatch):
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))  # without settings of the user's own
    notebook = nbformat.read(path, as_version=4)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # those of the libraries that run kernels
        place = {"metadata": {"path": str(tmp_path)}}
        nbclient.NotebookClient(notebook, timeout=SECONDS_FOR_A_CELL, resources=place).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert [output for output in outputs if output.get("name") == "stderr"] == []
    shown = [set(output.get("data", {})) for output in outputs]
    assert sum({WIDGET, PICTURE} <= kinds for kinds in shown) == 1
    assert sum(PICTURE in kinds for kinds in shown) >= 3
