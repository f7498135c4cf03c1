"""Twenty tasks of ten kinds of people: each follows one page, with data of their own in place of those that it shows.

A task runs the blocks of one section, with the names of the person's files, and what else is theirs (channels,
positions), in place of the page's. The page's own data are not there.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pages
import pytest
import task_data as data
from PIL import Image

import wavesplat as ws

DOCS = pages.ROOT / "docs"
#: The share of a picture's pixels that must differ from its corner, so that it is not empty.
MIN_SHOWN = 0.01


class Task(NamedTuple):
    """A wish, the section that says how, the maker of the person's data, and the files that must be there after it.

    `own`: texts of the section, and what stands in their place. `languages`: of the blocks that are followed.
    """

    who: str
    wants: str
    page: str
    section: str
    makes: Callable[[Path], None]
    own: dict[str, str]
    files: list[str]
    languages: tuple[str, ...] = ("python", "sh")


CT, HEAD = {"ct.nii.gz": "thorax.nrrd"}, {"head.nii.gz": "t1.nii"}
PARTS = {"organs.nii.gz": "plan.nrrd", "organs.tsv": "parts.tsv"}
FIELDS = {"density.npy": "rho.npy", "vorticity.npy": "omega.npy"}

TASKS = (
    Task("radiologist", "a figure of bones", "how_to/figures.md", "A figure for a paper",
         data.scans_of_a_patient, CT, ["figure.pdf", "figure.png"]),
    Task("radiologist", "slices on a sheet", "how_to/figures.md", "Slices on one sheet",
         data.scans_of_a_patient, {**CT, "100:400:50": "-100:80:40", "range(100, 401, 50)": "range(-100, 81, 40)"},
         ["sheet.png", "planes.png", "scout.png"]),
    Task("nuclear physician", "PET over CT", "how_to/two_scans.md", "PET over CT",
         data.scans_of_a_patient, {**CT, "pet.nii.gz": "fdg.mha"}, ["fused.png", "fused_slice.png"]),
    Task("nuclear physician", "a follow-up compared", "how_to/two_scans.md",
         "Two scans, before and after a registration", data.scans_of_a_patient,
         {**CT, "later.nii.gz": "follow_up.nrrd", "later_to_ct.tfm": "registration.tfm"},
         ["checked.png", "both.png"]),
    Task("neuroscientist", "an activation", "how_to/two_scans.md", "A statistic above its threshold",
         data.scans_of_a_head, {**HEAD, "zstat.nii.gz": "tmap.nii"}, ["activation.png"]),
    Task("neuroscientist", "a maximum projection", "how_to/figures.md", "A maximum projection in a colour map",
         data.scans_of_a_head, {**HEAD, "0,150": "0,400", "(0, 150)": "(0, 400)"}, ["mip.png"]),
    Task("radiotherapy physicist", "doses on a slice", "radiotherapy.md", "Doses (RTDOSE)",
         data.scans_of_a_patient,
         {"ct.nii.gz": "thorax.nrrd", "dose.dcm": "plan_dose.nrrd", "10,64": "10,60", " --contours rs.dcm": "",
          "--position 259": "--position 0"}, ["dose.png", "isodoses.png"], ("sh",)),
    Task("radiotherapy physicist", "one view of several scans", "how_to/views_and_batches.md",
         "The same view of several volumes", data.scans_of_a_patient,
         {**CT, "scans": "cohort", "*.nii.gz": "*.nrrd"}, ["camera.json", "a.nrrd.png", "a.png", "b.png"]),
    Task("cell biologist", "channels in colours", "how_to/microscopes.md", "Channels of a microscope",
         data.recording_of_cells,
         {"cells.ome.tif": "slide.ome.tif", "DAPI": "Hoechst", "150,700": "80,300", "(150, 700)": "(80, 300)"},
         ["cells.png", "two.png"]),
    Task("cell biologist", "a stack without sizes", "how_to/microscopes.md", "Pixels whose size the file does not say",
         data.recording_of_cells, {"stack.tif": "confocal.tif", "0.242,0.242,1": "0.1,0.1,0.3",
                                   "(0.242, 0.242, 1)": "(0.1, 0.1, 0.3)"}, ["stack.png"]),
    Task("climate scientist", "a netCDF file drawn", "simulations.md", "netCDF",
         data.ocean, {"air.nc": "ocean.nc"}, ["air.png"], ("sh",)),
    Task("climate scientist", "salt by current", "how_to/looks.md", "A field in the colours of another one",
         data.ocean, {"density.npy": "salt.npy", "vorticity.npy": "current.npy"}, ["two_fields.png"]),
    Task("engineer", "an uneven VTK grid", "simulations.md", "VTK's grids",
         data.flow_in_a_duct, {"flow.vtr": "duct.vtr"}, ["flow.png"], ("sh",)),
    Task("engineer", "decades and signs", "how_to/looks.md", "Logarithms, and values with two signs",
         data.flow_in_a_duct, FIELDS, ["density.png", "vorticity.png"]),
    Task("surgeon", "parts to print", "how_to/segmentations.md", "A mesh to print",
         data.parts_of_a_patient, {**CT, **PARTS}, ["bone.stl", "organs.3mf", "organs.glb", "tumour.stl"]),
    Task("surgeon", "a segmentation shown", "how_to/segmentations.md", "A segmentation with its legend",
         data.parts_of_a_patient, {**CT, **PARTS}, ["organs.png"]),
    Task("teacher", "a turntable", "how_to/turns_and_flights.md", "A turntable",
         data.lesson, CT, ["turn.mp4"]),
    Task("teacher", "a series of times", "how_to/turns_and_flights.md", "A series of times",
         data.lesson, {"beat.nii.gz": "ring.nii.gz"}, ["beat_0.png", "beat_5.png"]),
    Task("programmer", "arrays and images", "how_to/python_objects.md", "Arrays and images of other libraries",
         data.arrays_of_a_programmer, {**HEAD, **FIELDS}, ["of_nibabel.png", "of_numpy.png"]),
    Task("programmer", "a folder of scans", "how_to/views_and_batches.md", "Many files",
         data.arrays_of_a_programmer, {"scans": "cohort", "*.nii.gz": "*.nrrd"}, ["a.png", "pictures/b.nrrd.png"]),
)  # fmt: skip


def blocks_of(task: Task) -> list[pages.Block]:
    """The blocks that the person runs, with texts of their own in them; imports of the page first."""
    page = DOCS / task.page
    found = [block for block in pages.blocks_of(page) if block.section == task.section]
    followed = [block for block in found if block.language in task.languages]
    assert followed, f"{task.page} has no section {task.section!r}"
    head = [block for block in pages.blocks_of(page) if block.section == "" and "how_to/" in task.page]
    code = "\n".join(block.code for block in followed)
    unused = [text for text in task.own if text not in code]
    assert unused == [], f"{task.page}, {task.section}: {unused} is not there any more"
    return head + [block._replace(code=in_own_words(block.code, task.own)) for block in followed]


def in_own_words(code: str, own: dict[str, str]) -> str:
    """A block with texts of the person's own in place of the page's, the longest first."""
    for text in sorted(own, key=len, reverse=True):
        code = code.replace(text, own[text])
    return code


def shown_share(path: Path) -> float:
    """The share of a picture's pixels that differ from its first one."""
    pixels = np.asarray(Image.open(path).convert("RGBA"), np.int16)
    return float((np.abs(pixels - pixels[0, 0]).max(axis=-1) > 8).mean())


#: By day `test_how_to.py` runs these sections, or tests of meshes, netCDF and transforms do what they say.
OF_THE_NIGHT = (
    "a follow-up compared",
    "an activation",
    "one view of several scans",
    "a stack without sizes",
    "a netCDF file drawn",
    "salt by current",
    "decades and signs",
    "parts to print",
    "a segmentation shown",
    "arrays and images",
)


@pytest.mark.parametrize(
    "task",
    [pytest.param(task, marks=[pytest.mark.nightly] * (task.wants in OF_THE_NIGHT)) for task in TASKS],
    ids=lambda task: f"{task.who}: {task.wants}",
)
def test_a_task_is_done_by_following_a_page(task, tmp_path, monkeypatch, wavesplat):
    monkeypatch.chdir(tmp_path)
    task.makes(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pages.run(DOCS / task.page, blocks_of(task), wavesplat, tmp_path, {})
    for name in task.files:
        assert (tmp_path / name).stat().st_size > 0
        if name.endswith(".png"):
            assert shown_share(tmp_path / name) >= MIN_SHOWN, name
    if "tumour.stl" in task.files:
        volume = ws.mesh(ws.Labels.open("plan.nrrd", table="parts.tsv"), labels="all")["tumour"].volume
        assert volume == pytest.approx(4 / 3 * np.pi * data.PART_MM**3, rel=0.08)


def test_there_are_twenty_tasks_of_ten_kinds_of_people():
    assert len(TASKS) == 20
    assert len({task.who for task in TASKS}) == 10


def test_a_text_that_a_page_lost_is_noticed():
    task = TASKS[0]._replace(own={"no such file.nrrd": "mine.nrrd"})
    with pytest.raises(AssertionError, match="is not there any more"):
        blocks_of(task)
