"""Try a wheel as a newcomer would, in an empty environment, and hold it to its budgets: `make release-check`.

    python python/tools/check_wheel.py dist/*x86_64.whl [--python python3.13] [--picture out/release/first.png]

1. What is in it: the package, the viewer's page, licences; no tests, no symbols of the compiler, no path of this
   machine; at most 10 MB.
2. `pip install` and `wavesplat demo`, the two commands to the first pictures: at most a minute, without the download.
3. `import wavesplat` takes at most 40 ms more than Python itself, and does not load NumPy.

With `--picture`, a small picture is drawn to a file, for comparison with that of another processor.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
OLDEST_PYTHON = 11  # 3.11, as pyproject.toml says
MAX_BYTES = 10_000_000
MAX_IMPORT_S = 0.040
IMPORTS = 15
#: Seconds of the installation, without the download, and of the first pictures.
MAX_CLOCK_S = 60.0
PAGE = "wavesplat/_viewer/client"
WANTED = ("wavesplat/__init__.py", "wavesplat/py.typed", f"{PAGE}/widget.js", f"{PAGE}/LICENSES-OF-OTHERS.txt")
#: Ours, and those of the crates in the module; those of the page lie beside it.
LICENCES = ("LICENSE-MIT", "LICENSE-APACHE", "LICENSES-OF-OTHERS.txt")
DRAW = """
import sys, wavesplat as ws
picture = ws.render(ws.examples.ct_pelvis(), size=(128, 128))
assert 0.3 < picture.rgba[..., 3].mean() < 0.8, "the picture is nearly empty or nearly full"
picture.save(sys.argv[1])
"""
LEAN = "import sys, wavesplat; assert 'numpy' not in sys.modules, 'import wavesplat loads NumPy'"


def faults_of(wheel: Path) -> list[str]:
    """Faults of the files of a wheel: too large, missing, not for users, or of this machine."""
    faults = []
    if (size := wheel.stat().st_size) > MAX_BYTES:
        faults.append(f"it has {size / 1e6:.1f} MB, more than {MAX_BYTES / 1e6:.0f}; take symbols or data out")
    with zipfile.ZipFile(wheel) as file:
        names = file.namelist()
        paths = {str(ROOT).encode(), str(Path.home()).encode() + b"/"}
        for name in names:
            content = file.read(name)
            faults += [f"{name} has the path {path.decode()} in it" for path in sorted(paths) if path in content]
    faults += [f"it lacks {name}" for name in WANTED if name not in names]
    faults += [f"it lacks {name}" for name in LICENCES if not any(one.endswith(f"licenses/{name}") for one in names)]
    faults += [f"it has {name}" for name in names if "/tests/" in name or name.endswith((".debug", ".pdb"))]
    if len([name for name in names if name.startswith("wavesplat/_native.") and not name.endswith(".pyi")]) != 1:
        faults.append("it has not one compiled module")
    return faults


def run(*command: str | Path, folder: Path) -> float:
    """Run a command; return its seconds. An error ends the program with what it wrote."""
    began = time.perf_counter()
    done = subprocess.run([str(word) for word in command], cwd=folder, capture_output=True, text=True, check=False)  # noqa: S603 - commands of this file
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))} failed:\n{done.stdout}\n{done.stderr}")
    return time.perf_counter() - began


def import_seconds(python: Path, folder: Path) -> float:
    """Seconds of `import wavesplat` beyond those of Python itself.

    The two are timed in turns, and the least of each counts: other work of the machine only adds.
    """
    run(python, "-c", LEAN, folder=folder)  # also reads the files from the disk
    turns = [[run(python, "-c", code, folder=folder) for code in ("import wavesplat", "pass")] for _ in range(IMPORTS)]
    with_it, without = (min(times) for times in zip(*turns, strict=True))
    return with_it - without


def try_as_newcomer(wheel: Path, interpreter: str, picture: Path | None) -> list[str]:
    """Install the wheel, draw the first pictures, and time the import; what took too long."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run(interpreter, "-m", "venv", "empty", folder=folder)
        programs = folder / "empty" / ("Scripts" if sys.platform == "win32" else "bin")
        python = programs / "python"
        load = run(python, "-m", "pip", "download", "--quiet", "-d", "wheels", wheel.resolve(), folder=folder)
        needed = sorted((folder / "wheels").glob("*.whl"))
        size = sum(one.stat().st_size for one in needed)
        install = run(
            *(python, "-m", "pip", "install", "--quiet", "--no-index", "--find-links", "wheels", wheel.resolve()),
            folder=folder,
        )
        first = run(programs / "wavesplat", "demo", "-o", "pictures", folder=folder)
        drawn = list((folder / "pictures").glob("*.png"))
        if picture is not None:
            picture.parent.mkdir(parents=True, exist_ok=True)
            run(python, "-c", DRAW, picture.resolve(), folder=folder)
        imported = import_seconds(python, folder)
        version = (folder / "empty" / "pyvenv.cfg").read_text().partition("version = ")[2].split()[0]
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, in an empty environment of Python {version}")
    print(f"  before: download of {len(needed)} wheels, {size / 1e6:.0f} MB: {load:.0f} s")
    print(f"  1. pip install: {install:.1f} s")
    print(f"  2. wavesplat demo: {first:.1f} s, {len(drawn)} pictures")
    print(f"  import wavesplat: {imported * 1000:.0f} ms, without NumPy")
    faults = []
    if not drawn:
        faults.append("wavesplat demo drew no picture")
    if install + first > MAX_CLOCK_S:
        faults.append(f"the first pictures took {install + first:.0f} s, more than {MAX_CLOCK_S:.0f}")
    if imported > MAX_IMPORT_S:
        faults.append(f"its import takes {imported * 1000:.0f} ms, more than {MAX_IMPORT_S * 1000:.0f}")
    return faults


def interpreters() -> list[str]:
    """The oldest and the newest Python that this machine has and that we allow, one if there is one."""
    found: dict[int, str] = {}
    for minor in range(OLDEST_PYTHON, 30):
        here = [*(Path.home() / ".pyenv" / "versions").glob(f"3.{minor}.*/bin/python"), f"python3.{minor}"]
        for one in map(str, here):
            command = [one, "-c", "import ensurepip"]
            if shutil.which(one) and subprocess.run(command, capture_output=True, check=False).returncode == 0:  # noqa: S603 - a command of this file
                found[minor] = one
    return list(dict.fromkeys([found[min(found)], found[max(found)]])) if found else [sys.executable]


def main(arguments: list[str]) -> None:
    """Check a wheel; an error names what is wrong."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("wheel", type=Path)
    parser.add_argument(
        "--python",
        dest="interpreter",
        action="append",
        help="the interpreter of the empty environment, once or more; without it, the oldest and the newest found",
    )
    parser.add_argument("--picture", type=Path, help="where a small picture is drawn to")
    parser.add_argument(
        "--files-alone", action="store_true", help="for a wheel of another processor: do not install it"
    )
    given = parser.parse_args(arguments)
    faults = faults_of(given.wheel)
    for interpreter in [] if faults or given.files_alone else given.interpreter or interpreters():
        faults += try_as_newcomer(given.wheel, interpreter, given.picture)
    if faults:
        raise SystemExit(f"{given.wheel}: {'; '.join(faults)}")
    print(f"{given.wheel.name}: all is well")


if __name__ == "__main__":
    main(sys.argv[1:])
