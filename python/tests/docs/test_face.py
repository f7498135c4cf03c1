"""The face of the project: the logo is what its command draws, and the pictures have their sizes."""

from __future__ import annotations

import importlib.util
from xml.etree import ElementTree as ET

import numpy as np
import pages
import pytest
from PIL import Image

FACE = pages.ROOT / "docs" / "face"
MAX_BYTES = {"logo.svg": 15_000, "row.webp": 100_000, "social.png": 600_000}
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def face():
    spec = importlib.util.spec_from_file_location("face", pages.ROOT / "docs" / "face.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_logo_is_what_the_command_draws(face):
    text = (FACE / "logo.svg").read_text(encoding="utf-8")
    assert text == face.logo_svg()
    circles = ET.fromstring(text).findall(f"{SVG}circle")  # noqa: S314 - our own file
    assert len(circles) == face.N_SPLATS
    middle = circles[len(circles) // 2]
    assert float(middle.get("cx")) == face.SIDE / 2
    assert float(middle.get("cy")) == min(float(circle.get("cy")) for circle in circles)


def test_the_logo_as_a_picture_is_symmetric_and_has_round_corners(face):
    pixels = np.asarray(face.logo(64), np.int16)
    assert np.abs(pixels - pixels[:, ::-1]).mean() <= 1  # splats lie over each other from left to right
    assert pixels[0, 0, 3] == 0
    assert pixels[32, 32, 3] == 255


def test_pictures_have_their_sizes(face):
    assert sorted(path.name for path in FACE.iterdir()) == sorted(MAX_BYTES)
    assert [name for name, most in MAX_BYTES.items() if (FACE / name).stat().st_size > most] == []
    with Image.open(FACE / "social.png") as social, Image.open(FACE / "row.webp") as row:
        assert social.size == (1280, 640)  # what GitHub and others show
        assert row.size == (face.PANEL_PX * len(face.ROW), face.PANEL_PX)
