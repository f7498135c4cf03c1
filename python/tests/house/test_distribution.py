"""The distribution: it contains the viewer's page, built, so that no Node is needed to install it."""

import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
CLIENT = ROOT / "python" / "wavesplat" / "_viewer" / "client"
#: Files of the page, without its scripts in the folder `page`, whose names have the hashes of their contents.
FILES = {"index.html", "widget.js", "favicon.svg", "LICENSES-OF-OTHERS.txt"}
SCRIPTS = {f"page/{path.name}" for path in (CLIENT / "page").iterdir()}
MATURIN = Path(sys.executable).with_name("maturin")


def test_the_page_lies_in_the_package():
    assert {path.name for path in CLIENT.iterdir()} == FILES | {"page"}
    assert {name.partition("-")[0] for name in SCRIPTS} == {"page/page", "page/late_panels", "page/chunk"}
    # They say where they come from, since they are minified.
    for name in ("widget.js", *SCRIPTS):
        assert (CLIENT / name).read_text(encoding="utf-8").startswith("// Built from web/ by `make web`")


@pytest.mark.skipif(not MATURIN.exists(), reason="maturin is not installed")
def test_what_is_installed_from_has_the_page_and_nothing_of_node(tmp_path):
    done = subprocess.run([MATURIN, "sdist", "--out", tmp_path], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (archive,) = tmp_path.glob("*.tar.gz")
    with tarfile.open(archive) as file:
        names = [name.partition("/")[2] for name in file.getnames()]
    package = {name for name in names if name.startswith("python/wavesplat/")}
    here = {path.relative_to(ROOT).as_posix() for path in (ROOT / "python" / "wavesplat").rglob("*.py")}
    assert here <= package
    assert {f"python/wavesplat/_viewer/client/{name}" for name in FILES | SCRIPTS} <= package
    assert not [name for name in names if "node_modules" in name or name.startswith(("web/", "python/tests/"))]


@pytest.mark.skipif(shutil.which("git") is None or not (ROOT / ".git").exists(), reason="this is no checkout")
def test_nothing_of_the_package_is_ignored():
    # Wheels leave out files that git ignores.
    tracked = subprocess.run(
        ["git", "ls-files", "python/wavesplat/_viewer/client"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    assert {name.partition("/client/")[2] for name in tracked} == FILES | SCRIPTS
