"""The same scene by every entry point: Python and the Rust crate give the bytes of `crates/wavesplat/tests/door.png`.

`crates/wavesplat/tests/doors.rs` draws it in Rust, from the same numbers.
"""

from pathlib import Path

import numpy as np

import wavesplat as ws

GOLDEN = Path(__file__).parents[3] / "crates" / "wavesplat" / "tests" / "door.png"


def draw():
    z, y, x = np.mgrid[:20, :20, :20]
    samples = np.clip(255 - 3 * ((x - 9) ** 2 + (y - 11) ** 2) - 4 * (z - 8) ** 2, 0, 255).astype(np.uint8)
    look = ws.TransferFunction(opacity=[(100, 0), (200, 0.4)], color=[(100, 0.2, 0.4, 0.8), (250, 1.0, 0.75, 0.5)])
    camera = ws.Camera((50, -30, 40), (9.5, 9.5, 9.5), (0, 0, 1), parallel_scale=12)
    # The default light of the crate.
    return ws.render(ws.Volume(samples), look, camera, size=(64, 48))


def test_the_picture_is_that_of_the_other_doors(tmp_path):
    draw().save(tmp_path / "door.png", scene=False)
    assert (tmp_path / "door.png").read_bytes() == GOLDEN.read_bytes()


def test_the_report_has_the_times_of_the_stages():
    seconds = draw().report["seconds"]
    assert sorted(seconds) == ["draw", "plan", "prepare", "warp"]
    assert all(time >= 0 for time in seconds.values())
    assert sum(seconds.values()) > 0
