"""Fields that exist in a part of their box: kinds and looks count the samples that are there, and no others."""

import numpy as np
import pytest
from scipy import ndimage

import wavesplat as ws
from wavesplat._looks.kinds.kinds import found_in, kind_of

N = 24
Z, Y, X = np.indices((N, N, N)) - (N - 1) / 2
WAVES = (np.sin(X / 3) + Y / 12).astype(np.float32)
PLACES = {
    "a shell": abs(np.sqrt(X**2 + Y**2 + Z**2) - 8) < 0.7,
    "two layers": (Z > -1) & (Z < 1),
    "the last layer": Z.max() == Z,
    "a line": (abs(Z) < 1) & (abs(Y) < 1),
}


def scattered(share, seed):
    random = np.random.default_rng(seed)
    return np.where(random.random((N, N, N)) < share, np.nan, random.normal(size=(N, N, N))).astype(np.float32)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.75, 0.9, 0.95])
def test_scattered_noise_is_no_mask(share):
    """With 75 % missing 4 of 8 seeds were masks, with 90 % all: no sample had six neighbours."""
    assert {kind_of(ws.Volume(scattered(share, seed))) for seed in range(8)} == {"signed field"}


@pytest.mark.parametrize("place", PLACES)
def test_waves_in_a_thin_place_are_a_field_without_noise(place):
    found = found_in(ws.Volume(np.where(PLACES[place], WAVES, np.nan)))
    assert (found.kind, found.has_noise) == ("signed field", False)


def test_two_values_are_a_mask_wherever_they_are_and_a_third_one_is_seen():
    thin = PLACES["two layers"]
    assert kind_of(ws.Volume(np.where(thin, np.where(X > 0, 7.0, 3.0), np.nan))) == "mask"
    bead = np.zeros((70, 70, 70), np.uint8)  # every second sample along each axis is looked at
    bead[30:40, 30:40, 30:40] = 200
    assert kind_of(ws.Volume(bead)) == "mask"
    bead[2, 2, 2] = 90
    assert kind_of(ws.Volume(bead)) != "mask"


def test_one_value_among_missing_samples_is_an_object():
    ball = np.where(X**2 + Y**2 + Z**2 < 64, 5.0, np.nan)
    alpha = ws.render(ws.Volume(ball), size=(48, 48), background="transparent").rgba[..., 3]
    assert alpha[24, 24] > 0.99


def test_looks_are_the_same_in_parts(tmp_path):
    np.save(tmp_path / "a.npy", scattered(0.9, 1))
    whole, parts = ws.open(tmp_path / "a.npy"), ws.open(tmp_path / "a.npy", memory="50 MB")
    assert ws.Look.auto(whole).to_json() == ws.Look.auto(parts).to_json()


def test_slow_flow_in_a_vessel_is_seen_too():
    """A vessel that narrows, and one that widens: the slower one was clear, so there were two loose pieces."""
    radius = np.where(X < 0, 3.0, 7.0)
    inside = np.hypot(Y, Z) < radius
    speed = 9.0 / radius**2 * (1 - (Y**2 + Z**2) / radius**2) + 1e-3
    vessel = ws.Volume(np.where(inside, speed, np.nan).astype(np.float32))
    alpha = ws.render(vessel, camera="xy", size=(96, 96), background="transparent").rgba[..., 3]
    is_seen = alpha > 0.1
    assert ndimage.label(is_seen)[1] == 1
    assert np.ptp(np.flatnonzero(is_seen.any(axis=0))) > 80, "from end to end"
    rows = [np.count_nonzero(is_seen[:, column]) for column in (24, 72)]
    assert rows[1] > 1.8 * rows[0], "the wide part is as wide as it is"


@pytest.mark.parametrize("fill", [-30.0, -9999.0])
def test_a_value_that_many_samples_have_exactly_is_no_lid(fill):
    """Rain in a part of a box, and the fill of the rest: it was an opaque blue lid, "a field with two signs"."""
    rain = 50 * np.exp(-(X**2 + Y**2 + Z**2) / 20) - 5
    radar = ws.Volume(np.where(rain > -4, rain, fill).astype(np.float32))
    look = ws.Look.auto(radar)
    assert kind_of(radar) == "field"
    assert look.transfer_function([fill])[0, 3] == 0
    assert look.transfer_function.color[0][0] > -10
    alpha = ws.render(radar, size=(48, 48), background="transparent").rgba[..., 3]
    assert alpha[24, 24] > 0.5
    assert max(alpha[0].max(), alpha[:, 0].max()) < 0.05


def test_two_phases_of_which_one_is_negative_stay_two():
    phases = np.where(X + 3 * np.sin(Y / 4) > 0, 1.0, -1.0) + np.where(abs(X) < 1, 0.3 * np.sin(Z), 0.0)
    assert kind_of(ws.Volume(phases.astype(np.float32))) == "signed field"
