"""The package as a whole: its names, its cost to import, its docstrings."""

import doctest
import inspect
import pickle
import pkgutil
import subprocess
import sys
import tomllib
from importlib import import_module
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._cli import COMMANDS

MODULES = [
    module.name
    for module in pkgutil.walk_packages(ws.__path__, "wavesplat.")
    if not module.name.endswith(("._native", ".__main__"))
]
#: Modules of each room, which is the second word of their names.
ROOMS = {room: [*names] for room, names in groupby(sorted(MODULES), lambda name: ".".join(name.split(".")[:2]))}


def test_every_public_name_exists_and_says_what_it_is():
    assert [name for name in ws.__all__ if not getattr(ws, name).__doc__] == []
    assert set(ws.__all__) <= set(dir(ws))


def test_unknown_names_are_attribute_errors():
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        ws.nothing  # noqa: B018


@pytest.mark.parametrize("room", ROOMS)
def test_examples_in_docstrings_run(room, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = {name: doctest.testmod(import_module(name)).failed for name in ROOMS[room]}
    assert {name: n_failed for name, n_failed in found.items() if n_failed} == {}


def test_examples_of_public_names_run(tmp_path, monkeypatch):
    # Public objects name `wavesplat` as their module, so `testmod` does not find them in the module that defines them.
    monkeypatch.chdir(tmp_path)
    runner, without = doctest.DocTestRunner(), []
    failing = [test.name for test in doctest.DocTestFinder(recurse=False).find(ws) if runner.run(test).failed]
    for name in (name for name in ws.__all__ if callable(getattr(ws, name))):
        tests = doctest.DocTestFinder().find(getattr(ws, name), name, module=False, globs={})
        without += [] if any(test.examples for test in tests) else [name]
        failing += [test.name for test in tests if runner.run(test).failed]
    assert without == ["Cost", "Mesh"]  # made by functions that have one
    assert failing == []


def test_public_names_say_where_to_import_them_from():
    things = [getattr(ws, name) for name in ws.__all__]
    things = [thing for thing in things if callable(thing)]
    assert len(things) == 65
    assert [thing for thing in things if thing.__module__ != "wavesplat"] == []


def test_pickles_hold_no_private_place():
    volume = ws.examples.ripples(8)
    curves = ws.TransferFunction.diverging(10)
    table = ws.TransferFunction2D([0, 1], [0, 1], np.ones((2, 2, 4)))
    things = [volume, ws.WaveletVolume.from_volume(volume), ws.Camera.view(volume, "left"), curves, table, ws.Shading()]
    things += [ws.Light((0, 0, 1)), ws.Crop((0, 0, 0), (1, 1, 1)), ws.Materials.preset("ct"), ws.study.Ablation()]
    things += [ws.study.StandardSplatting(), ws.Look.preset("ct-bone"), ws.Labels(np.eye(3, dtype=np.uint8)[None])]
    things += [ws.Picture(np.zeros((2, 2, 4))), ws.FirstHit(3), ws.LocalMaximum(), ws.DepthShadedMaximum(), ws.XRay()]
    things += [ws.DepthColoredMaximum(), ws.AttenuatedMaximum()]
    things += [ws.Sampling(2, 1), ws.ClipPlane((0, 0, 0), (0, 0, 1)), ws.CutOut(ws.Crop((0, 0, 0), (1, 1, 1)))]
    things += [ws.Layer(volume), ws.Scene(volume)]
    for thing in things:
        data = pickle.dumps(thing)
        assert b"wavesplat._" not in data
        assert type(pickle.loads(data)) is type(thing)  # noqa: S301 - our own bytes


def test_importing_loads_no_heavy_library():
    heavy = ["SimpleITK", "nibabel", "tifffile", "h5py", "zarr", "fsspec", "OpenEXR", "rich", "typer", "PIL"]
    heavy += ["skimage", "trimesh", "sklearn", "cmap", "scipy", "matplotlib"]
    modules = (
        "wavesplat._scene.drawing.rendering, wavesplat._scene.slices.slicing, wavesplat._readers.opening, "
        "wavesplat._mesh.meshing, wavesplat._looks.body.largest_body, wavesplat._readers.time_points"
    )
    code = f"import sys, {modules}; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_command_line_starts_without_numpy_and_http():
    slow = ["numpy", "urllib.request", "http.client"]
    modules = ", ".join(f"wavesplat._cli.commands.{name.replace('-', '_')}" for name in COMMANDS)
    code = f"import sys, {modules}; print([m for m in {slow} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_command_imports_no_other():
    code = "import sys\nfrom wavesplat._cli import main\ntry: main(['plan', '--help'])\n"
    code += "except SystemExit: print([m for m in ('movie', 'view') if f'wavesplat._cli.commands.{m}' in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_options_are_read_without_large_libraries():
    # There is no file of this name, so its reader is never loaded.
    code = """if True:
        import sys
        from typer.testing import CliRunner
        import wavesplat._cli
        result = CliRunner().invoke(wavesplat._cli.app, ["render", "none.nrrd", "-o", "none.png", "--size", "4x4"])
        assert result.exit_code == 1, result.output
        print([m for m in ["pydantic", "SimpleITK", "nibabel", "zarr"] if m in sys.modules])
    """
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_extra_of_all_has_what_the_others_have():
    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    for_work_on_the_package = {"dev", "bench", "study", "site"}
    assert for_work_on_the_package <= set(extras)
    users = set(extras) - for_work_on_the_package - {"all"}
    assert "movie" in users
    assert sorted(extras["all"]) == sorted({requirement for name in users for requirement in extras[name]})


def test_the_page_of_what_is_public_names_all_modules_and_commands():
    page = (Path(__file__).parents[3] / "docs" / "public_api.md").read_text(encoding="utf-8")
    modules = [f"`wavesplat.{name}`" for name in ws.__all__ if inspect.ismodule(getattr(ws, name))]
    commands = [f"`{name}`" for name in COMMANDS]
    assert len(modules) == 6
    assert len(commands) == 13
    assert [name for name in [*modules, *commands] if name not in page] == []
