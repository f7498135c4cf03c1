"""Pack the viewer's page as an npm package, and try it in an empty folder: `make page-package`.

    python python/tools/check_page_package.py out/release

1. What is in it: the module, its types, the page, licences, and nothing else; at most 250 kB.
2. All that `package.json` exports is there, and its version is that of the Python package.
3. Installed from the file, Node imports it, and TypeScript finds its types, in both ways of looking modules up.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path
from typing import Any

import version

WEB = version.ROOT / "web"
MAX_BYTES = 250_000
#: Patterns of the files that the package must have; it may have no others.
WANTED = [
    r"README\.md",
    r"package\.json",
    *(r"dist/LICENSE-MIT", r"dist/LICENSE-APACHE", r"dist/LICENSES-OF-OTHERS\.txt"),
    *(r"dist/widget\.js", r"dist/index\.d\.ts"),
    *(r"dist/page/index\.html", r"dist/page/favicon\.svg"),
    r"dist/page/[a-z_]+-[A-Z0-9]{8}\.js",
]
USE = """
import viewer from "@wavesplat/viewer";
type Model = Parameters<typeof viewer.render>[0]["model"];
const close: () => void = viewer.render({ model: {} as Model, el: document.body });
close();
"""
IMPORT = """
import viewer from "@wavesplat/viewer";
if (typeof viewer.render !== "function") throw new Error("the module has no render");
import.meta.resolve("@wavesplat/viewer/page/index.html");
"""


def main(folder: Path) -> None:
    """Pack to the folder and try the package; an error names what is wrong."""
    folder.mkdir(parents=True, exist_ok=True)
    run("npm", "pack", "--silent", "--pack-destination", str(folder.resolve()), folder=WEB)
    package = folder.resolve() / f"wavesplat-viewer-{version.current()}.tgz"
    if faults := faults_of(package):
        raise SystemExit(f"{package}: {'; '.join(faults)}")
    with tempfile.TemporaryDirectory() as name:
        try_in(Path(name), package)
    size = package.stat().st_size / 1000
    print(f"{package.name}: {size:.0f} kB, installed in an empty folder, imported by Node, and its types are found")


def faults_of(package: Path) -> list[str]:
    """Faults of the files of the package and of its manifest."""
    with tarfile.open(package) as file:
        names = [name.removeprefix("package/") for name in file.getnames()]
        manifest = json.load(file.extractfile("package/package.json"))  # type: ignore[arg-type]
    faults = []
    if (size := package.stat().st_size) > MAX_BYTES:
        faults.append(f"it has {size / 1000:.0f} kB, more than {MAX_BYTES / 1000:.0f}")
    faults += [f"it has {name}" for name in names if not any(re.fullmatch(one, name) for one in WANTED)]
    faults += [f"it lacks {one}" for one in WANTED if not any(re.fullmatch(one, name) for name in names)]
    faults += [f"it exports {path}, which it lacks" for path in exported(manifest) if path not in names]
    if manifest["version"] != version.current():
        faults.append(f"its version is {manifest['version']}, not {version.current()}")
    if manifest.get("private"):
        faults.append("it is private")
    return faults


def exported(manifest: dict[str, Any]) -> list[str]:
    """The files that a manifest exports, folders (`page/*`) left out."""
    targets: list[str] = []
    for target in manifest["exports"].values():
        targets += target.values() if isinstance(target, dict) else [target]
    return [target.removeprefix("./") for target in targets if "*" not in target]


def try_in(folder: Path, package: Path) -> None:
    """Install the package in an empty folder, import it, and check the types of a program that uses it."""
    (folder / "package.json").write_text('{"private": true, "type": "module"}')
    run("npm", "install", "--silent", "--no-audit", "--no-fund", str(package), folder=folder)
    run("node", "--input-type=module", "--eval", IMPORT, folder=folder)
    (folder / "use.ts").write_text(USE)
    for module, resolution in [("ESNext", "Bundler"), ("NodeNext", "NodeNext")]:
        options = ["--strict", "--noEmit", "--module", module, "--moduleResolution", resolution]
        run(
            *(str(WEB / "node_modules" / ".bin" / "tsc"), *options, "--types", "", "--lib", "ES2022,DOM", "use.ts"),
            folder=folder,
        )


def run(*command: str, folder: Path) -> None:
    """Run a command; an error ends the program with what it wrote."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)  # noqa: S603 - commands of this file
    if done.returncode:
        raise SystemExit(f"{' '.join(command)} failed:\n{done.stdout}\n{done.stderr}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
