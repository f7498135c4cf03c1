"""The pages of how to: every job in one command or at most five lines of Python, and all of them run."""

from __future__ import annotations

import re
import shutil
import warnings

import pages
import pytest

FOLDER = pages.ROOT / "docs" / "how_to"
DATA = FOLDER / "data.md"
INDEX = FOLDER / "README.md"
BLOCKS = {
    page: pages.blocks_of(page) for page in sorted(FOLDER.glob("*.md")) if page not in (DATA, INDEX)
}  # those of section "" import what the jobs of a page need
JOBS = [(page, job) for page, blocks in BLOCKS.items() for job in dict.fromkeys(b.section for b in blocks) if job]
MAX_LINES = 5
#: Jobs that run at night alone: by day `test_tasks.py` follows most of these sections, with data of a person's own.
OF_THE_NIGHT = (
    "A figure for a paper",
    "A maximum projection in a colour map",
    "A mesh to print",
    "A series of times",
    "A turntable",
    "Channels of a microscope",
    "Many files",
    "Opened at a corner",
    "PET over CT",
    "Slices on one sheet",
    "Two scans, before and after a registration",
    "Which function was used, to edit it",
)


def jobs_of(page):
    """The blocks of a page that are below a heading."""
    return [block for block in BLOCKS[page] if block.section]


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """The folder with the files that the page of data makes."""
    folder = tmp_path_factory.mktemp("data")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        pages.run(DATA, pages.blocks_of(DATA), None, folder, {})
    return folder


@pytest.mark.parametrize(
    "job",
    [pytest.param(job, marks=[pytest.mark.nightly] * (job[1] in OF_THE_NIGHT)) for job in JOBS],
    ids=lambda job: f"{job[0].stem}-{job[1]}",
)
def test_a_job_runs(job, data, tmp_path, monkeypatch, wavesplat):
    shutil.copytree(data, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        page, heading = job
        blocks = [block for block in BLOCKS[page] if block.section in ("", heading)]
        pages.run(page, blocks, wavesplat, tmp_path, {})


@pytest.mark.parametrize("page", BLOCKS, ids=lambda page: page.stem)
def test_jobs_are_short(page):
    assert jobs_of(page)
    for block in jobs_of(page):
        lines = [line for line in block.code.splitlines() if line.strip()]
        if block.language == "python":
            assert len([line for line in lines if not line.startswith(("import ", "from "))]) <= MAX_LINES
            assert max(map(len, lines)) <= 120
        else:
            assert block.language == "sh"


def test_the_index_leads_to_every_job():
    """Twenty-two jobs; each has a row, and a link to its heading."""
    links = set(re.findall(r"\]\((\w+\.md#[\w-]+)\)", INDEX.read_text(encoding="utf-8")))
    headings = {f"{page.name}#{anchor(job)}" for page, job in JOBS}
    assert links == headings
    assert len(JOBS) == 22
    assert set(OF_THE_NIGHT) <= {job for _, job in JOBS}


def anchor(heading):
    """The name that web pages of repositories give to a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
