"""Messages about packages that are not installed: each names a line that works where Wavesplat is installed."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from functools import cache
from importlib import metadata, util

import pages
import pytest

import wavesplat as ws
from wavesplat._system.libraries import how_to_install, library

ROOT = pages.ROOT
PACKAGE = ROOT / "python" / "wavesplat"
#: The line of an extra, in messages, docstrings and pages.
LINE = re.compile(r'pip install "wavesplat\[([\w,]+)\]"')


@cache
def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def packages(requirements):
    return {re.split(r"[\[<>=;]", one)[0].strip().lower().replace("_", "-") for one in requirements}


def calls():
    """Each use of `library(name, extra=...)` and `how_to_install(extra)` in the package: (file, modules, extra)."""
    found = []
    for path in sorted(PACKAGE.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        constants = {
            node.targets[0].id: node.value.value
            for node in tree.body
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant)
        }
        for node in ast.walk(tree):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name)):
                continue
            if node.func.id == "library":
                extra = node.keywords[0].value
                modules = [one.value for one in ast.walk(node.args[0]) if isinstance(one, ast.Constant)]
            elif node.func.id == "how_to_install" and path.name not in ("libraries.py", "reading.py"):
                extra, modules = node.args[0], []
            else:
                continue
            name = constants[extra.id] if isinstance(extra, ast.Name) else extra.value
            found.append((path.name, [one for one in modules if not one.startswith(".")], name))
    return found


CALLS = calls()
EXTRAS = sorted({extra for _, _, extra in CALLS} | {"http"})


def test_all_uses_are_found():
    assert len(CALLS) > 45
    assert {"bio", "dask", "figure", "fit", "geometry", "mesh", "movie", "netcdf", "notebook", "vtk"} <= set(EXTRAS)


@pytest.mark.parametrize("extra", EXTRAS)
def test_extras_of_messages_bring_what_is_missing(extra):
    extras = project()["optional-dependencies"]
    brought = packages(extras[extra]) | packages(project()["dependencies"])
    distributions = metadata.packages_distributions()
    for file, modules, _ in (call for call in CALLS if call[2] == extra):
        for module in modules:
            top = module.partition(".")[0]
            names = {name.lower().replace("_", "-") for name in distributions.get(top, [top])}
            if top not in sys.stdlib_module_names:
                assert names & brought, (file, module, extra)


@pytest.mark.parametrize("extra", EXTRAS)
def test_the_message_names_the_line_for_an_installed_package(monkeypatch, extra):
    monkeypatch.setattr(metadata, "version", lambda _name: "0.1.0")
    assert LINE.findall(how_to_install(extra)) == [extra]
    modules = {one.partition(".")[0] for _, modules, own in CALLS if own == extra for one in modules}
    for module in modules:
        for name in [name for name in sys.modules if name.partition(".")[0] == module]:
            monkeypatch.delitem(sys.modules, name)
        monkeypatch.setitem(sys.modules, module, None)
        with pytest.raises(ws.errors.LibraryError) as caught:
            library(module, extra=extra)
        assert str(caught.value) == f'{module} is not installed; run: pip install "wavesplat[{extra}]"'


def test_where_it_is_not_installed_the_line_is_for_the_checkout(monkeypatch):
    # Else pip would take whatever has this name where packages are published.
    def missing(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "version", missing)
    assert how_to_install("movie") == 'in the checkout of Wavesplat, run: pip install ".[movie]"'


def test_pip_takes_the_installed_package_and_asks_for_no_other():
    if util.find_spec("pip") is None or not any(True for _ in metadata.distributions(name="wavesplat")):
        pytest.skip("pip is not there, or wavesplat is run as it lies")
    command = [sys.executable, "-m", "pip", "install", "--dry-run", "--no-index", "--no-deps", "wavesplat[movie]"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "Requirement already satisfied: wavesplat[movie]" in done.stdout
    assert "Would install" not in done.stdout


def test_pages_and_docstrings_name_extras_that_exist():
    extras = project()["optional-dependencies"]
    files = [ROOT / "README.md", *(ROOT / "changes").glob("*.md"), *(ROOT / "docs").rglob("*.md")]
    texts = {path: path.read_text(encoding="utf-8") for path in [*files, *PACKAGE.rglob("*.py")]}
    lines = {
        (path.name, extra) for path, text in texts.items() for names in LINE.findall(text) for extra in names.split(",")
    }
    assert len(lines) > 15
    assert [(path, extra) for path, extra in lines if extra not in extras] == []
    # Nothing is released yet, and somebody else may take the name: by name only what is installed already is added to.
    assert [path for path, text in texts.items() if re.search(r"pip install (-\w+ )*\W?wavesplat(?!\[)", text)] == []
