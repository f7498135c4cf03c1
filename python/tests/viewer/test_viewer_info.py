"""The first message to a page: what is known and what was guessed of the data."""

from __future__ import annotations

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._viewer.session.info import welcome_of
from wavesplat._viewer.session.state import ViewerState


def info_of(volume: ws.Volume) -> dict[str, object]:
    """Facts of the only volume of a scene, as the page gets them."""
    scene = ws.Scene([ws.Layer(volume, "grey")])
    [info] = welcome_of(ViewerState.of(scene))["volumes"]
    return dict(info)


@pytest.mark.parametrize(("unit", "symbol"), [("um", "µm"), ("angstrom", "Å"), ("mm", "mm"), (None, None)])
def test_units_of_lengths_have_their_symbols(unit: str | None, symbol: str | None) -> None:
    volume = ws.Volume(np.arange(60, dtype=np.uint8).reshape(3, 4, 5), facts=ws.Facts(unit=unit))
    assert info_of(volume)["unit"] == symbol


def test_a_kind_found_by_the_values_alone_is_a_guess() -> None:
    samples = np.random.default_rng(0).gamma(2, 1, (40, 40, 40)).astype(np.float32)
    samples[18:22, 10:14, 18:22] = 400
    pet = ws.Volume(samples, spacing=(4, 4, 4), facts=ws.Facts(unit="mm", is_anatomical=True))
    info = info_of(pet)
    assert info["kind"] == "PET"
    assert info["notes"] == ["taken for PET: coarse samples and a few very bright spots, by the values"]
    assert (info["dtype"], info["orientation"]) == ("float32", "RAS")


def test_what_a_file_says_is_no_guess_and_missing_samples_are_told() -> None:
    samples = np.ones((4, 4, 4), np.float32)
    samples[0, 0, :3] = np.nan
    volume = ws.Volume(samples, facts=ws.Facts(modality="MR", guesses=("axes drawn as z, y, x",)))
    notes = info_of(volume)["notes"]
    assert isinstance(notes, list)
    assert not any("taken for" in note for note in notes)
    assert notes[1:] == [
        "axes drawn as z, y, x",
        "3 samples are NaN or infinite: they are missing, and matter around them is fainter",
    ]


def test_wavelets_have_facts_too() -> None:
    volume = ws.WaveletVolume.from_volume(ws.examples.ripples(16))
    [info] = welcome_of(ViewerState.of(ws.Scene(volume)))["volumes"]
    assert (info["dtype"], info["shape"]) == ("wavelets", [16, 16, 16])


@pytest.mark.parametrize(("unit", "texts"), [("s", ["0.0 s", "2.5 s"]), (None, [])])
def test_times_have_their_unit(unit: str | None, texts: list[str]) -> None:
    volumes = [ws.Volume(np.full((3, 4, 5), value, np.uint8)) for value in (1, 2)]
    series = ws.Series(volumes, times=[0, 2.5], time_unit=unit)
    [info] = welcome_of(ViewerState.of(ws.Scene([ws.Layer(series, "grey")])))["volumes"]
    assert (info["n_times"], info["times"]) == (2, texts)
