"""The page docs/command_line.md: its commands run, and the options that it names exist."""

from __future__ import annotations

import pages
import pytest

import wavesplat as ws

PAGE = pages.ROOT / "docs" / "command_line.md"


@pytest.mark.nightly  # by day: `test_named_in_blocks.py` parses each command
def test_its_commands_run(tmp_path, monkeypatch, wavesplat):
    monkeypatch.chdir(tmp_path)
    ws.examples.ct_pelvis().save("scan.nrrd")
    for folder in ("scans", "pictures"):
        (tmp_path / folder).mkdir()
    for name in ("a", "b"):
        ws.examples.ripples(12).save(f"scans/{name}.nrrd")
    pages.run(PAGE, pages.blocks_of(PAGE), wavesplat, tmp_path, {})
    made = sorted(path.name for path in tmp_path.glob("*.png"))
    assert (tmp_path / "demo").is_dir()
    assert made == ["a.png", "b.png", "fire.png", "mip.png", "own.png", "sheet.png"]
    assert sorted(path.name for path in (tmp_path / "pictures").iterdir()) == [
        "1_a_axial.jpg",
        "2_b_axial.jpg",
        "a.png",
        "b.png",
    ]


def test_its_options_are_there(wavesplat):
    import re

    helps = "".join(wavesplat(command, "--help").stdout for command in ("render", "slice", "mesh"))
    table = PAGE.read_text(encoding="utf-8").split("## Words")[1].split("```sh")[0]
    named = set(re.findall(r"(--[a-z][a-z-]*)", table))
    assert len(named) > 15
    assert sorted(option for option in named if option not in helps) == []
