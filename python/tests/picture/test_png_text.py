"""Scenes within PNG files: long ones too are read by others, and back."""

import io

import numpy as np
import pytest
from PIL import Image

import wavesplat as ws
from wavesplat._picture import picture_files
from wavesplat._picture.picture_files import SIGNATURE, text_in, with_text


def png():
    content = io.BytesIO()
    Image.new("RGB", (3, 2), "red").save(content, "png")
    return content.getvalue()


@pytest.mark.parametrize("text", ["", "a", "µ" * 2_500_000, "abc😀" * 400_000])
def test_texts_of_any_length_are_read_back_and_open_elsewhere(text):
    content = with_text(png(), "wavesplat", text)
    assert text_in(content, "wavesplat") == text
    assert Image.open(io.BytesIO(content)).getpixel((0, 0)) == (255, 0, 0)


def test_a_picture_of_a_function_of_two_dimensions_opens_in_pillow(tmp_path):
    volume = ws.examples.ripples(8)
    table = np.random.default_rng(1).random((120, 200, 4))
    curves = ws.TransferFunction2D(np.linspace(0, 255, 200), np.linspace(0, 90, 120), table)
    ws.render(volume, curves, size=(16, 16)).save(tmp_path / "a.png")
    assert len(text_in((tmp_path / "a.png").read_bytes(), "wavesplat")) > 1 << 20
    with Image.open(tmp_path / "a.png") as opened:
        assert opened.size == (16, 16)


def test_bombs_are_refused(monkeypatch):
    monkeypatch.setattr(picture_files, "MAX_TEXT", 100_000)
    content = with_text(png(), "wavesplat", "a" * 100_000)
    assert text_in(content, "wavesplat") == "a" * 100_000
    for text in ("a" * 100_001, "a" * 300_000):
        with pytest.raises(ValueError, match="larger than any"):
            text_in(with_text(png(), "wavesplat", text), "wavesplat")


def test_other_texts_are_left_alone():
    content = with_text(with_text(png(), "other", "theirs"), "wavesplat", "ours")
    assert (text_in(content, "wavesplat"), text_in(content, "other"), text_in(content, "third")) == (
        "ours",
        "theirs",
        None,
    )
    assert content.startswith(SIGNATURE)
