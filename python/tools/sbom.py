"""Tidy and check the bills of materials that `make sbom` writes: rust.cdx.json, page.cdx.json, python.cdx.json.

    python python/tools/sbom.py out/sbom
    python python/tools/sbom.py --requirements    # print what pip installs with ours

Paths of this machine and the time of the run are taken out, so that two runs give the same bytes. Each part must have a
name, a version and a licence, and each bill what is known to be in it: the crates of `Cargo.lock` that the module is
built from, the library of the viewer's page, the packages that `pyproject.toml` asks for.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
#: Licences of packages whose metadata name none: https://openexr.com/en/latest/license.html.
LICENCES = {"openexr": "BSD-3-Clause"}


def main(folder: Path) -> None:
    """Tidy and check the bills of a folder."""
    wanted = {"rust.cdx.json": crates(), "page.cdx.json": page_packages(), "python.cdx.json": python_packages()}
    for name, parts in wanted.items():
        path = folder / name
        bill = tidied(json.loads(path.read_text(encoding="utf-8").replace(f"file://{ROOT}", "file://wavesplat")))
        faults = faults_of(bill, parts)
        if faults:
            raise SystemExit(f"{path}: {'; '.join(faults)}")
        path.write_text(json.dumps(bill, indent=1, sort_keys=True) + "\n", encoding="utf-8")
        print(f"{path}: {len(bill['components'])} parts")


def tidied(bill: dict[str, Any]) -> dict[str, Any]:
    """The bill without what differs from run to run, and with the licences that metadata lack."""
    bill.pop("serialNumber", None)
    bill.get("metadata", {}).pop("timestamp", None)
    for part in bill.get("components", []):
        if not part.get("licenses") and part["name"].lower() in LICENCES:
            part["licenses"] = [{"license": {"id": LICENCES[part["name"].lower()]}}]
    return bill


def faults_of(bill: dict[str, Any], parts: set[str]) -> list[str]:
    """Faults of a bill: parts that are missing, or that lack a version or a licence."""
    if bill.get("bomFormat") != "CycloneDX":
        return ["it is no bill of materials in CycloneDX"]
    faults = []
    found = {part["name"].lower().replace("_", "-"): part for part in bill.get("components", [])}
    if missing := sorted(parts - set(found)):
        faults.append(f"it lacks {', '.join(missing)}")
    faults += [f"{name} has no version" for name, part in found.items() if not part.get("version")]
    faults += [f"{name} has no licence" for name, part in found.items() if name in parts and not part.get("licenses")]
    return faults


def crates() -> set[str]:
    """The crates that the module is built from, on Linux, this workspace's among them."""
    command = [
        "cargo",
        "tree",
        "--locked",
        "-p",
        "wavesplat-python",
        "-e",
        "normal",
        "--prefix",
        "none",
        "--format",
        "{p}",
    ]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)  # noqa: S603 - a command of this file
    names = {line.partition(" ")[0].replace("_", "-") for line in done.stdout.splitlines()}
    return names - {"wavesplat-python"}


def page_packages() -> set[str]:
    """The packages that the viewer's page carries."""
    return set(json.loads((ROOT / "web" / "package.json").read_text(encoding="utf-8"))["dependencies"])


def requirements() -> list[str]:
    """The requirements that pip installs with our package, `numpy>=1.24` for example."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    [listed] = re.findall(r"^dependencies = \[\n(.*?)^\]", text, re.MULTILINE | re.DOTALL)
    return re.findall(r'^ +"([^"]+)"', listed, re.MULTILINE)


def python_packages() -> set[str]:
    """The packages that are installed with ours, whatever the version of Python."""
    return {re.split(r"[^\w-]", one)[0].lower() for one in requirements()} - {"numcodecs"}


if __name__ == "__main__":
    if sys.argv[1:] == ["--requirements"]:
        print("\n".join(requirements()))
    else:
        main(Path(sys.argv[1]))
