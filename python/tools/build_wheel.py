"""Build a wheel whose bytes depend on the sources alone, not on the folder, the home or the day: `make wheels`.

    python python/tools/build_wheel.py -o dist --zig --compatibility manylinux_2_28 [--target aarch64-unknown-linux-gnu]
    python python/tools/build_wheel.py -o dist --source FOLDER    # of another folder, an unpacked source distribution

The other options are those of `maturin build`.

1. The compiler writes `/wavesplat` and `/cargo` where it would write the paths of the checkout and of cargo's sources.
2. On Linux, symbols are taken out of the compiled module, 39 % of the wheel, and written to a file of the wheel's name
   and `.debug`, for `add-symbol-file` of gdb. The module has no link to it, which would hold a checksum of it all: the
   unwinder that zig brings has paths of zig's own folders there.
3. In the wheel's bill of materials, too, the path of the checkout becomes `/wavesplat`.
4. The terms of the crates that the module holds become a file of the wheel, `LICENSES-OF-OTHERS.txt`.
5. Its files have the time of `SOURCE_DATE_EPOCH`: if that is not given, of the last commit, or of 1980 without git.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import licences

ROOT = Path(__file__).parents[2]
#: The first day that a zip file can say, in seconds since 1970.
FIRST_DAY = 315_532_800


def main(arguments: list[str]) -> None:
    """Build the wheel, and print where it is."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("-o", "--out", type=Path, default=Path("dist"), help="folder of the wheel")
    parser.add_argument("--source", type=Path, default=ROOT, help="what is built; without it, this checkout")
    given, options = parser.parse_known_args(arguments)
    wheel = build(given.source.resolve(), given.out.resolve(), options)
    print(f"{wheel}: {wheel.stat().st_size / 1e6:.1f} MB")


def build(source: Path, out: Path, options: list[str]) -> Path:
    """Build the wheel of a folder with the options of `maturin build`; its path in the folder `out`."""
    variables = environment(source)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _run(
            [sys.executable, "-m", "maturin", "build", "--release", "--locked", *options, "-o", name],
            cwd=source,
            env=variables,
        )
        [raw] = folder.glob("*.whl")
        _run([sys.executable, "-m", "wheel", "unpack", "-d", str(folder / "unpacked"), str(raw)])
        [unpacked] = (folder / "unpacked").iterdir()
        for module in unpacked.glob("wavesplat/_native*.so"):
            if module.read_bytes().startswith(b"\x7fELF"):
                take_symbols_out(module, out / f"{raw.stem}.debug")
        hide_path(unpacked, source)
        add_licences(unpacked, licences.of_crates(source, target_of(options)))
        _run([sys.executable, "-m", "wheel", "pack", "-d", str(out), str(unpacked)], env=variables)
    return out / raw.name


def environment(source: Path) -> dict[str, str]:
    """The environment of the build of a folder, with what makes its bytes repeatable."""
    # Of several that fit, the compiler takes the last.
    names = {"/wavesplat": source, "/wavesplat/target": os.environ.get("CARGO_TARGET_DIR")}
    names["/cargo"] = os.environ.get("CARGO_HOME") or Path.home() / ".cargo"
    flags = [f"--remap-path-prefix={path}={name}" for name, path in names.items() if path]
    epoch = os.environ.get("SOURCE_DATE_EPOCH") or str(last_commit(source))
    others = {name: value for name, value in os.environ.items() if name != "RUSTFLAGS"}
    # Separated so, folders may have spaces in their names.
    return {**others, "CARGO_ENCODED_RUSTFLAGS": "\x1f".join(flags), "SOURCE_DATE_EPOCH": epoch}


def last_commit(source: Path) -> int:
    """Time of the last commit of a folder, seconds since 1970; that of the first day of zip files without git."""
    command = ["git", "log", "-1", "--format=%ct"]
    try:
        done = subprocess.run(command, cwd=source, capture_output=True, text=True, check=False)  # noqa: S603 - our own command
    except FileNotFoundError:
        return FIRST_DAY
    return int(done.stdout) if done.returncode == 0 and done.stdout.strip() else FIRST_DAY


def take_symbols_out(module: Path, symbols: Path) -> None:
    """Move the symbols of a compiled module to a file, by the objcopy of the compiler, which knows every processor."""
    command = ["rustc", "--print", "sysroot"]
    root = Path(subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip())  # noqa: S603 - our own command
    found = sorted(root.glob("lib/rustlib/*/bin/rust-objcopy"))
    if not found:
        raise SystemExit(f"{root} has no rust-objcopy; install the compiler by rustup, which brings it")
    variables = {**os.environ, "LD_LIBRARY_PATH": str(root / "lib")}
    _run([str(found[0]), "--only-keep-debug", str(module), str(symbols)], env=variables)
    _run([str(found[0]), "--strip-unneeded", str(module)], env=variables)


def hide_path(unpacked: Path, source: Path) -> None:
    """Write `/wavesplat` for the path of the sources in the bill of materials that maturin puts into the wheel."""
    for bill in unpacked.glob("*.dist-info/sboms/*.json"):
        text = bill.read_text(encoding="utf-8")
        bill.write_text(text.replace(source.as_uri(), "file:///wavesplat"), encoding="utf-8", newline="\n")


def add_licences(unpacked: Path, text: str) -> None:
    """Add the terms of others to the licences of a wheel, and to its metadata."""
    [metadata] = unpacked.glob("*.dist-info/METADATA")
    name = "LICENSES-OF-OTHERS.txt"
    (metadata.parent / "licenses" / name).write_text(text, encoding="utf-8", newline="\n")
    head, line, rest = metadata.read_text(encoding="utf-8").partition("License-File: ")
    metadata.write_text(f"{head}License-File: {name}\n{line}{rest}", encoding="utf-8", newline="\n")


def target_of(options: list[str]) -> str | None:
    """The target among the options of `maturin build`, if there is one."""
    return options[options.index("--target") + 1] if "--target" in options else None


def _run(command: list[str], cwd: Path | None = None, env: dict[str, str] | None = None) -> None:
    """Run a command; end with its exit code where it fails."""
    done = subprocess.run(command, cwd=cwd, env=env, check=False)  # noqa: S603 - commands of this file
    if done.returncode:
        raise SystemExit(done.returncode)


if __name__ == "__main__":
    main(sys.argv[1:])
