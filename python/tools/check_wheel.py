"""Try a wheel as a newcomer would, in an empty environment, and hold it to its budgets: `make release-check`.

    python python/tools/check_wheel.py dist/wavesplat-*.whl [--python python3.13]

1. What is in it: the package, the viewer's page, licences; no tests, no symbols of the compiler; at most 10 MB.
2. `pip install`, and the first picture, in two commands; steps and seconds are printed.
3. `import wavesplat` takes at most 40 ms more than Python itself: the median of several, without NumPy.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

MAX_BYTES = 10_000_000
MAX_IMPORT_S = 0.040
IMPORTS = 15
#: Seconds from the end of the installation to the first picture.
MAX_PICTURE_S = 60.0
WANTED = ("wavesplat/__init__.py", "wavesplat/py.typed", "wavesplat/_viewer/client/viewer.js")
DRAW = "import wavesplat as ws; ws.render(ws.examples.ct_pelvis()).save('first.png')"


def faults_of(wheel: Path) -> list[str]:
    """Faults of the files of a wheel: too large, missing, or not for users."""
    faults = []
    if (size := wheel.stat().st_size) > MAX_BYTES:
        faults.append(f"it has {size / 1e6:.1f} MB, more than {MAX_BYTES / 1e6:.0f}; run python/tools/strip_wheel.py")
    with zipfile.ZipFile(wheel) as file:
        names = file.namelist()
    faults += [f"it lacks {name}" for name in WANTED if name not in names]
    faults += [
        f"it lacks {name}" for name in ("LICENSE-MIT", "LICENSE-APACHE") if not any(one.endswith(name) for one in names)
    ]
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
    """Seconds of `import wavesplat` beyond those of Python itself, the medians of both."""

    def median(code: str) -> float:
        return statistics.median(run(python, "-c", code, folder=folder) for _ in range(IMPORTS))

    median("import wavesplat")  # the first one reads the files from the disk
    return median("import wavesplat") - median("pass")


def try_as_newcomer(wheel: Path, interpreter: str) -> list[str]:
    """Install the wheel, draw the first picture, and time the import; what took too long."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run(interpreter, "-m", "venv", "empty", folder=folder)
        python = folder / "empty" / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
        install = run(python, "-m", "pip", "install", "--quiet", wheel.resolve(), folder=folder)
        picture = run(python, "-c", DRAW, folder=folder)
        imported = import_seconds(python, folder)
        size = (folder / "first.png").stat().st_size
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB")
    print(f"  1. pip install: {install:.0f} s, with the download of what it needs")
    print(f"  2. the first picture: {picture:.1f} s, {size // 1000} kB")
    print(f"  import wavesplat: {imported * 1000:.0f} ms")
    faults = []
    if picture > MAX_PICTURE_S:
        faults.append(f"the first picture took {picture:.0f} s, more than {MAX_PICTURE_S:.0f}")
    if imported > MAX_IMPORT_S:
        faults.append(f"its import takes {imported * 1000:.0f} ms, more than {MAX_IMPORT_S * 1000:.0f}")
    return faults


def main(arguments: list[str]) -> None:
    """Check each wheel; an error names what is wrong."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("wheels", nargs="+", type=Path)
    parser.add_argument("--python", default=sys.executable, help="the interpreter of the empty environment")
    parser.add_argument(
        "--files-alone", action="store_true", help="for a wheel of another processor: do not install it"
    )
    given = parser.parse_args(arguments)
    for wheel in given.wheels:
        faults = faults_of(wheel)
        if not faults and not given.files_alone:
            faults = try_as_newcomer(wheel, given.python)
        if faults:
            raise SystemExit(f"{wheel}: {'; '.join(faults)}")
        print(f"{wheel.name}: all is well")


if __name__ == "__main__":
    main(sys.argv[1:])
