"""CT whose Hounsfield units are stored with 1000 or 1024 added is drawn as CT, and MR is not taken for it."""

import warnings

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks.kinds.hounsfield import stored_offset
from wavesplat._looks.kinds.kinds import evidence, unit_of_values
from wavesplat.errors import WavesplatWarning

CT = ws.examples.ct_pelvis()


def stored(offset, modality=None, anatomical=True):
    samples = np.maximum(CT.samples.astype(np.int32) + offset, 0).astype(np.uint16)
    facts = ws.Facts(modality=modality, is_anatomical=anatomical, unit="mm")
    return ws.Volume(samples, world_from_index=CT.world_from_index, facts=facts)


@pytest.mark.parametrize("offset", [1000, 1024])
@pytest.mark.parametrize("modality", [None, "CT"])
def test_it_is_drawn_as_ct_fault_14(offset, modality):
    volume = stored(offset, modality)
    found = evidence(volume)
    assert (found.kind, found.is_guess) == ("CT", True)
    assert f"with {offset} added" in found.reason
    assert unit_of_values(CT) == "HU"
    # The first picture is that of the scan in Hounsfield units.
    drawn, wanted = (ws.render(one, size=(48, 48)).rgba for one in (volume, CT))
    assert np.abs(drawn - wanted).max() < 0.02


@pytest.mark.parametrize("offset", [1000, 1024])
def test_presets_and_windows_move_with_it_and_say_so_fault_14(offset):
    volume = stored(offset)
    moved = rf"is moved up by {offset}, which seems to be added to the Hounsfield units.*a guess by its values"
    with pytest.warns(WavesplatWarning, match=f"preset 'ct-bone' {moved}"):
        look = ws.Look.preset("ct-bone", volume)
    wanted = ws.Look.preset("ct-bone", CT)
    assert look.transfer_function.opacity == tuple((v + offset, a) for v, a in wanted.transfer_function.opacity)
    with pytest.warns(WavesplatWarning, match="preset 'CT-AAA' is moved up by"):
        ws.Look.preset("CT-AAA", volume)
    with pytest.warns(WavesplatWarning, match=f"window 'abdomen' {moved}"):
        picture = ws.slice(volume, "coronal", window="abdomen")
    np.testing.assert_allclose(picture.rgba, ws.slice(CT, "coronal", window="abdomen").rgba, atol=1e-5)
    assert picture.report["window"] == (50 + offset, 400)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ws.slice(volume, "coronal", window=(50 + offset, 400))  # as it is given
        ws.Look.preset("ct-bone", CT)


def test_other_scans_are_not_taken_for_it_fault_14():
    head = ws.examples.mri_head()
    values = head.samples[::2, ::2, ::2].astype(np.float64).ravel()
    for largest in np.geomspace(1000, 6000, 40):
        assert stored_offset(values * largest / np.percentile(values, 99.5)) == 0
    assert stored_offset(CT.samples.astype(np.float64)) == 0
    for modality in ("MR", "PT"):
        assert evidence(stored(1024, modality)).kind != "CT"
    assert evidence(stored(1024, anatomical=False)).kind != "CT"
    noise = np.random.default_rng(0)
    assert stored_offset(noise.uniform(0, 3000, 10_000)) == 0
    assert stored_offset(noise.normal(1000, 100, 10_000)) == 0
    assert stored_offset(np.zeros(0)) == 0


def test_info_says_so_fault_14(wavesplat, tmp_path):
    stored(1024).save(tmp_path / "stored.nrrd")
    guess = "guess        1024 seems to be added to the Hounsfield units of a CT, by the values"
    assert guess in wavesplat("info", tmp_path / "stored.nrrd").stdout
    CT.save(tmp_path / "ct.nrrd")
    assert "seems to be added" not in wavesplat("info", tmp_path / "ct.nrrd").stdout


def test_crops_with_little_air_and_heads_with_little_fat_are_told():
    crop = CT.samples[28:84, 25:75, 30:91].astype(np.float64) + 1024
    assert 0.003 < np.mean(crop < 100) < 0.004
    assert stored_offset(np.maximum(crop, 0)) == 1024
    random = np.random.default_rng(1)
    parts = [(-1000, 10, 30_000), (35, 20, 64_000), (-95, 20, 2_400), (900, 300, 5_000)]
    head = np.concatenate([random.normal(mean, deviation, n) for mean, deviation, n in parts])
    assert stored_offset(np.maximum(np.round(head + 1000), 0)) == 1000
