"""Draws all that the program decides by itself about many volumes, and prints what differs from the kept lines.

    make brain-oracle                       phantoms, bundled volumes, presets, colour maps, numbers, documents
    make brain-oracle DATA=../shared/data   the volumes of a folder too: those of `make looks`, and others
    make brain-oracle BRAIN=--keep          keep the lines as they are now

Lines of files have the hash of their samples in their names. Positions may differ by rounding on other processors;
`BRAIN=--to-the-bit` counts these too.
"""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "python/tests/shared"), str(ROOT / "studies/looks")]

import brain_lines  # noqa: E402
import looks  # noqa: E402

import wavesplat as ws  # noqa: E402
from wavesplat.errors import WavesplatError  # noqa: E402

#: Files and folders that the study of looks leaves out.
OTHERS = [
    *(looks.Case(path) for path in ("ct_pelvis_right.nii.gz", "dicom_ct_gantry_tilt", "dicom_mr_missing_slice")),
    *(looks.Case("dicom_12bit", {"time": time}) for time in range(3)),
    *(looks.Case(f"nifti_cases/orient_{axes}.nii.gz") for axes in ("AIL", "IRA", "LPS", "LSA", "PSR", "RIP", "SPL")),
    looks.Case("mhd_case/ct_abdomen_pelvis_lower.mhd"),
    *(looks.Case("dicom_multiframe/philips_fieldmap_64frames.dcm", {"time": time}) for time in range(2)),
    looks.Case("omezarr_v3_mouse_brain_sharded.ome.zarr"),
]


def main() -> int:
    """Draw, compare, and keep where asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="a folder of volumes")
    parser.add_argument("--keep", action="store_true", help="write the lines")
    parser.add_argument("--to-the-bit", action="store_true", help="count the rounding of positions")
    arguments = parser.parse_args()
    groups: dict[str, Callable[[], Any]] = dict(brain_lines.groups())
    if arguments.data:
        groups["files"] = lambda: _lines_of_files(arguments.data)
    else:
        print("files: not compared; DATA=FOLDER names a folder of volumes")
    are_equal = True
    for group, make in groups.items():
        new = dict(make())
        path = brain_lines.FOLDER / f"{group}.jsonl.xz"
        old = brain_lines.kept(group) if path.exists() else {}
        if group == "files" and not arguments.keep:
            gone = [name for name in old if name not in new]
            old = {name: line for name, line in old.items() if name in new}
            print("".join(f"files: not there, or other samples: {name}\n" for name in gone), end="")
        found = brain_lines.in_words(old, new, to_the_bit=arguments.to_the_bit)
        print(f"{group}: {found or f'{len(new)} lines are equal'}", flush=True)
        are_equal &= not found
        if arguments.keep and found:
            brain_lines.keep(group, new)
    return 0 if are_equal or arguments.keep else 1


def _lines_of_files(folder: Path) -> Iterator[tuple[str, brain_lines.Line]]:
    for case in [*looks.CASES, *OTHERS]:
        path = folder / case.path
        if not path.exists():
            print(f"files: not there: {case.path}")
            continue
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                volume = ws.open(path, **case.options)
        except WavesplatError as error:
            print(f"files: not opened: {error}")
            continue
        line = brain_lines.line_of_volume(lambda volume=volume: volume)
        yield f"{case.name} {line['volume']['content']}", line


if __name__ == "__main__":
    os.environ.setdefault("WAVESPLAT_DEVICE", "cpu")
    sys.exit(main())
