"""Install the wheel of 64-bit ARM in an empty folder and draw with it, emulated by qemu: `make release-check`.

    python python/tools/try_on_arm.py dist/wavesplat-*aarch64.whl --beside out/release/first.png

Python and the libraries that it needs come from Debian's packages for ARM, which are unpacked to .cache/arm: no rights
of the administrator are needed, and nothing of this system is changed. The picture must be that of this processor,
`--beside`, to one step of 255. Needs apt-get, dpkg and qemu-aarch64 (`apt-get install qemu-user`).
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import check_wheel

CACHE = check_wheel.ROOT / ".cache" / "arm"
#: Packages of Debian that are unpacked, with their dependencies.
PACKAGES = ["python3", "libstdc++6"]
#: glibc of Debian 12 has more; wheels ask for one of these.
PLATFORMS = [f"manylinux_2_{minor}_aarch64" for minor in (17, 24, 26, 27, 28)] + ["manylinux2014_aarch64"]
COMPARE = """
import sys, numpy as np
from PIL import Image
here, there = (np.asarray(Image.open(path).convert("RGBA")).astype(int) for path in sys.argv[1:])
print(np.abs(here - there).max())
"""


def main(arguments: list[str]) -> None:
    """Draw on ARM, and compare; an error says what differs."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("wheel", type=Path)
    parser.add_argument("--beside", type=Path, required=True, help="the same picture, drawn on this processor")
    given = parser.parse_args(arguments)
    for program in ("apt-get", "dpkg", "qemu-aarch64"):
        if shutil.which(program) is None:
            raise SystemExit(f"there is no {program}, which the try on ARM needs; on Debian: apt-get install qemu-user")
    root = debian_root()
    [python] = sorted((root / "usr" / "bin").glob("python3.[0-9]*[0-9]"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        install(given.wheel, python.name.removeprefix("python"), folder / "packages")
        seconds = draw(root, python, folder)
        command = [python, "-c", COMPARE, folder / "arm.png", given.beside.resolve()]
        difference = int(emulate(root, folder, *command).splitlines()[-1])
    print(f"{given.wheel.name}: drawn by {python.name} for ARM in qemu in {seconds:.0f} s, within {difference} of 255")
    if difference > 1:
        raise SystemExit(f"{given.wheel}: on ARM the picture is another, by {difference} of 255")


def debian_root() -> Path:
    """The folder in which Python for ARM lies, made at the first call."""
    root, done = CACHE / "root", CACHE / "done"
    if done.exists():
        return root
    shutil.rmtree(CACHE, ignore_errors=True)
    for name in ("state/lists/partial", "cache/archives/partial", "root"):
        (CACHE / name).mkdir(parents=True)
    (CACHE / "status").touch()
    (CACHE / "apt.conf").write_text(
        'APT::Architecture "arm64";\nAPT::Architectures { "arm64"; };\nAPT::Sandbox::User "";\n'
        f'Dir::State "{CACHE}/state";\nDir::State::status "{CACHE}/status";\nDir::Cache "{CACHE}/cache";\n'
    )
    variables = {**os.environ, "APT_CONFIG": str(CACHE / "apt.conf")}
    _run(["apt-get", "update", "-qq"], variables)
    options = ["-qq", "-y", "--no-install-recommends", "--download-only"]
    _run(["apt-get", "install", *options, *PACKAGES], variables)
    for package in sorted((CACHE / "cache" / "archives").glob("*.deb")):
        _run(["dpkg", "-x", str(package), str(root)], variables)
    done.touch()
    return root


def install(wheel: Path, version: str, folder: Path) -> None:
    """Install the wheel, and what it needs, for a version of Python on ARM."""
    platforms = [f"--platform={platform}" for platform in PLATFORMS]
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--target", str(folder), "--only-binary=:all:"]
    _run([*command, f"--python-version={version}", *platforms, str(wheel)], dict(os.environ))


def draw(root: Path, python: Path, folder: Path) -> float:
    """Draw arm.png in the folder; return the seconds."""
    began = time.perf_counter()
    emulate(root, folder, python, "-c", check_wheel.DRAW, folder / "arm.png")
    return time.perf_counter() - began


def emulate(root: Path, folder: Path, *command: str | Path) -> str:
    """Run a command of ARM with the packages of the folder; return what it wrote."""
    variables = {name: value for name, value in os.environ.items() if not re.match("PYTHON|VIRTUAL_ENV", name)}
    variables["PYTHONPATH"] = str(folder / "packages")
    words = ["qemu-aarch64", "-L", str(root), *map(str, command)]
    done = subprocess.run(words, cwd=folder, env=variables, capture_output=True, text=True, check=False)  # noqa: S603 - commands of this file
    if done.returncode:
        raise SystemExit(f"{command[0]} failed on ARM:\n{done.stdout}\n{done.stderr}")
    return done.stdout


def _run(command: list[str], variables: dict[str, str]) -> None:
    done = subprocess.run(command, env=variables, capture_output=True, text=True, check=False)  # noqa: S603 - commands of this file
    if done.returncode:
        raise SystemExit(f"{' '.join(command)} failed:\n{done.stdout}\n{done.stderr}")


if __name__ == "__main__":
    main(sys.argv[1:])
