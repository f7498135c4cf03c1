"""The package as a whole: its names, its cost to import, its docstrings."""

import doctest
import pkgutil
import subprocess
import sys
from importlib import import_module

import pytest

import wavesplat as ws

MODULES = [
    module.name
    for module in pkgutil.walk_packages(ws.__path__, "wavesplat.")
    if not module.name.endswith(("._native", ".__main__"))
]


@pytest.mark.parametrize("name", ws.__all__)
def test_every_public_name_exists_and_says_what_it_is(name):
    assert getattr(ws, name).__doc__
    assert name in dir(ws)


def test_unknown_names_are_attribute_errors():
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        ws.nothing  # noqa: B018


@pytest.mark.parametrize("name", ["wavesplat", *MODULES])
def test_examples_in_docstrings_run(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert doctest.testmod(import_module(name)).failed == 0


def test_importing_loads_no_heavy_library():
    heavy = ["SimpleITK", "nibabel", "tifffile", "h5py", "zarr", "fsspec", "OpenEXR", "rich", "typer", "PIL"]
    heavy += ["skimage", "trimesh", "sklearn"]
    modules = (
        "wavesplat._render.rendering, wavesplat._render.slicing, wavesplat._readers.opening, wavesplat._mesh.meshing"
    )
    code = f"import sys, {modules}; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_command_line_starts_without_numpy():
    code = "import sys, wavesplat._cli; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_options_are_read_without_large_libraries():
    # No file of this name: what reads it is never loaded.
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
