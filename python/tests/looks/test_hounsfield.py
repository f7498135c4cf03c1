"""Signed fields and noise are no CT, whatever their size (simulation, fault F1); scans of patients are."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks.kinds.kinds import kind_of, unit_of_values

Z, Y, X = np.indices((32, 32, 32)).astype(float)
WAVES = np.sin(X / 3) * np.cos(Y / 4) * np.sin(Z / 5)


def noise(deviation, dtype):
    return np.random.default_rng(0).normal(0, deviation, (40, 40, 40)).astype(dtype)


FIELDS = {
    **{f"noise {d} {t}": noise(d, t) for d in (300, 400, 500, 700, 1000, 1500, 2500, 5000) for t in ("i2", "f4")},
    **{f"waves {a}": (a * WAVES).astype("f4") for a in (1000, 1050, 1100, 1500, 3000, 6000, 10000, 20000)},
    "whole waves": np.round(1050 * WAVES).astype("i2"),
    "potential": (1200 * np.cos(X / 4)).astype("f4"),
    "velocity": (1500 * np.sin(Y / 3)).astype("i2"),
    "seismic": (2000 * np.sin(Z / 2) * np.exp(-X / 40)).astype("f4"),
    "uniform": np.random.default_rng(1).integers(-1060, 800, (30, 30, 30)).astype("i2"),
    "one-sided": -np.abs(noise(450, "f4")),
}


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("anatomical", [False, True])
def test_no_field_is_a_ct(name, anatomical):
    volume = ws.Volume(FIELDS[name], anatomical=anatomical, unit="mm" if anatomical else None)
    assert kind_of(volume) != "CT"
    assert unit_of_values(volume) == ""
    assert "HU" not in str(ws.render(volume, size=(32, 32)).report["shown"])


def test_scans_of_patients_are():
    ct = ws.examples.ct_pelvis()
    assert kind_of(ws.Volume(ct.samples)) == "CT"
    assert kind_of(ws.Volume(ct.samples, world_from_index=ct.world_from_index, unit="mm", anatomical=True)) == "CT"
    resampled = ct.samples.astype(np.float32) + np.float32(0.25)
    assert kind_of(ws.Volume(resampled, unit="mm", anatomical=True)) == "CT"
    assert kind_of(ws.Volume(resampled)) != "CT"
    # Padding around a round field of view is one value.
    padded = np.where(np.hypot(*np.indices(ct.shape)[1:] - 56.0) > 60, -2000, ct.samples).astype(np.int16)
    assert kind_of(ws.Volume(padded, unit="mm", anatomical=True)) == "CT"


def test_whole_numbers_of_both_signs_are_a_field():
    assert kind_of(ws.Volume(noise(300, "i2"))) == "signed field"


@pytest.mark.parametrize("padding", [-2000, -3024])
def test_padding_that_was_resampled_is_no_noise(padding):
    ct = ws.examples.ct_pelvis()
    outside = np.hypot(*np.indices(ct.shape)[1:] - np.array(ct.shape[1:])[:, None, None, None] / 2) > 45
    padded = np.where(outside, padding, ct.samples).astype(np.float32)
    shifted = (padded[:, :, 1:] + padded[:, :, :-1]) / 2
    assert kind_of(ws.Volume(shifted, unit="mm", anatomical=True)) == "CT"
