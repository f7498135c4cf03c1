"""Facts on a volume beside samples and place, such as units: no step on the way loses any."""

import json
import pickle
from dataclasses import replace

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._model.volume import units
from wavesplat.errors import ArgumentError

FACTS = ws.Facts(
    unit="um",
    is_anatomical=True,
    modality="fluorescence",
    channel=ws.Channel("DAPI", (0, 0, 1), 461),
    channels=(ws.Channel("DAPI", (0, 0, 1), 461), ws.Channel("GFP", window=(10, 200.5), is_active=False)),
    n_times=3,
    time_step=0.5,
    time_unit="s",
    times=(0, 0.5, 1.5),
    levels=((8, 6, 4), (4, 3, 2)),
    conventions=("a custom",),
    guesses=("a guess: nothing said",),
)


@pytest.mark.parametrize(
    ("name", "ours"),
    [
        ("micron", "um"), ("microns", "um"), ("Micrometers", "um"), ("micrometre", "um"), ("µm", "um"), ("μm", "um"),
        ("\\u00B5m", "um"), ("MM", "mm"), ("millimeter", "mm"), ("nm", "nm"), ("Å", "angstrom"),
        ("Angstroms", "angstrom"),
        ("inch", "inch"), ("inches", "inch"), ("pixel", None), ("", None), (None, None), ("kpc", "kpc"), ("m", "m"),
    ],
)  # fmt: skip
def test_names_of_units_in_files(name, ours):
    assert units.canonical(name) == ours


@pytest.mark.parametrize(
    ("length", "unit", "text"),
    [
        (2000, "um", "2 mm"), (500, "um", "500 µm"), (0.2, "um", "200 nm"), (50, "mm", "50 mm"), (5, "cm", "50 mm"),
        (0.05, "m", "50 mm"), (2e-6, "m", "2 µm"), (20, "angstrom", "2 nm"), (5, None, "5"), (0.5, "kpc", "0.5 kpc"),
        (0.5, "m", "0.5 m"), (500, "mm", "500 mm"),
        (1000, "nm", "1 µm"), (2000, "km", "2000 km"), (5e-3, "pm", "0.005 pm"),
    ],
)  # fmt: skip
def test_lengths_are_told_in_the_unit_in_which_they_read_best(length, unit, text):
    assert units.length_text(length, unit) == text


@pytest.mark.parametrize(
    ("given", "unit", "factors"),
    [
        (("um", "um", "nm"), "um", (1, 1, 0.001)),
        (("mm", "um", "um"), "mm", (1, 0.001, 0.001)),
        (("inch", "inch", "inch"), "mm", (25.4, 25.4, 25.4)),
        (("um", "um", None), "um", (1, 1, 1)),
        ((None, None, None), None, (1, 1, 1)),
        (("kpc", "kpc", "kpc"), "kpc", (1, 1, 1)),
    ],
)
def test_axes_of_different_units_get_one(given, unit, factors):
    assert units.in_one_unit(given) == (unit, factors)


def test_an_array_has_no_unit_and_no_anatomy():
    volume = ws.Volume(np.zeros((2, 3, 4)))
    assert (volume.unit, volume.is_anatomical, volume.modality, volume.guesses) == (None, False, None, ())
    assert volume.facts == ws.Facts()
    assert volume.orientation == "RAS"  # of the world's axes, whatever the index axes are
    assert repr(volume) == "<Volume 'volume': z 2, y 3, x 4, float64, spacing (x, y, z) 1 x 1 x 1>"


def test_unit_and_anatomy_can_be_said():
    matrix = np.diag([-1.0, -1, 2, 1])
    volume = ws.Volume(np.zeros((2, 3, 4)), world_from_index=matrix, unit="Millimeter", anatomical=True)
    assert (volume.unit, volume.is_anatomical) == ("mm", True)
    assert repr(volume).endswith("spacing (x, y, z) 1 x 1 x 2 mm, LPS>")
    known = ws.Volume(volume.samples, unit="nm", anatomical=False, facts=FACTS)
    assert known.facts == replace(FACTS, unit="nm", is_anatomical=False)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ws.Volume(np.zeros((2, 2, 2)), unit=3), "unit is 3"),
        (lambda: ws.Volume(np.zeros((2, 2, 2)), unit="x" * 99), "unit is 'xxx"),
        (lambda: ws.Volume(np.zeros((2, 2, 2)), unit="inch"), "unit is 'inch'; give mm"),
        (lambda: ws.Volume(np.zeros((2, 2, 2)), facts={"unit": "um"}), "facts is a dict; give a wavesplat.Facts"),
        (lambda: ws.Facts(n_times=0), "n_times is 0"),
        (lambda: ws.Facts(guesses="one"), "guesses is one text"),
        (lambda: ws.Facts(channels=["DAPI"]), "a channel is a str"),
        (lambda: ws.Channel("a", color=(0, 0, 255)), "color of a channel"),
        (lambda: ws.Channel("a", color="red"), "color of a channel"),
        (lambda: ws.Channel("a", emission_nm=-1), "emission_nm of a channel is -1"),
        (lambda: ws.Channel("a", window=(9, 1)), r"window of a channel is \(9, 1\); give two numbers, the smaller"),
        (lambda: ws.Channel("a", window=5), "window of a channel is 5"),
        (lambda: ws.Facts(n_times=3, times=(1, 2)), "2 times are given for 3 time points"),
        (lambda: ws.Facts(n_times=1, times=(np.inf,)), "not a finite number"),
    ],
)
def test_what_cannot_be_is_refused(make, message):
    with pytest.raises(ArgumentError, match=message):
        make()


def test_facts_are_json_and_back():
    assert ws.Facts.from_json(json.loads(json.dumps(FACTS.as_json()))) == FACTS
    assert ws.Facts.from_json({"unit": "um", "of a later release": 1}) == ws.Facts(unit="um")


def test_whatever_makes_a_volume_of_a_volume_keeps_the_facts(tmp_path):
    volume = ws.Volume(np.random.default_rng(1).random((8, 8, 8)), facts=FACTS)
    wavelets = ws.WaveletVolume.from_volume(volume)
    wavelets.save(tmp_path / "a.wavelets")
    loaded = ws.WaveletVolume.load(tmp_path / "a.wavelets")
    made = [wavelets, wavelets.bands([0, 1]), wavelets.to_volume(), loaded, loaded.to_volume()]
    made += [pickle.loads(pickle.dumps(thing)) for thing in (volume, loaded)]  # noqa: S301 - our own bytes
    assert [thing.facts for thing in made] == [FACTS] * len(made)


def test_wavelets_of_before_have_no_facts(tmp_path):
    ws.WaveletVolume.from_volume(ws.examples.ripples(8)).save(tmp_path / "a.wavelets")
    with np.load(tmp_path / "a.wavelets") as archive:
        arrays = {name: archive[name] for name in archive.files if name != "facts"}
    with (tmp_path / "a.wavelets").open("wb") as file:
        np.savez(file, **arrays)
    assert ws.WaveletVolume.load(tmp_path / "a.wavelets").facts == ws.Facts()


@pytest.mark.parametrize(
    "document",
    [
        None,
        [],
        "facts",
        {"channel": 5},
        {"channel": {"hue": 1}},
        {"channels": 5},
        {"channels": [None]},
        {"channels": [{"": 0}]},
    ],
)
def test_documents_that_are_no_facts_are_refused(document):
    with pytest.raises(ArgumentError, match="^facts: .*; give"):
        ws.Facts.from_json(document)
