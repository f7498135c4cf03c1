"""Automatic looks of data with few or narrow values: bone alone, air alone, mostly padding, thin volumes."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks.kinds import histogram
from wavesplat._looks.kinds.automatic import automatic
from wavesplat._looks.kinds.kinds import kind_of
from wavesplat._model.volume.facts import Facts

N = 20
MODALITIES = (None, "CT", "MR", "PT", "RTDOSE", "US", "fluorescence", "EM", "CR", "SEG")
OPERATORS = (None, "over", "maximum", "minimum", "mean", "x-ray", "first-hit", "local-maximum")


def radius():
    z, y, x = np.mgrid[:N, :N, :N] - (N - 1) / 2
    return np.sqrt(x**2 + y**2 + z**2)


def samples_of():
    """Samples with narrow ranges, by what they are."""
    random = np.random.default_rng(1)
    noise, r = random.normal(size=(N, N, N)), radius()

    def between(low, high):
        return np.clip((low + high) / 2 + noise * (high - low) / 4, low, high)

    few = np.zeros((N, N, N))
    few.ravel()[: few.size // 400] = between(300, 1500).ravel()[: few.size // 400]
    border = np.full((N, N, N), 900.0)
    border[0] = between(300, 1500)[0]
    return {
        "bone": between(300, 1500),
        "bone in one place": 300 + 1200 * np.exp(-((r / 5) ** 2)),
        "bone in padding": np.where(r < 6, between(300, 1500), -1024),
        "a little bone in padding": few,
        "air": between(-1024, -950),
        "water": between(-20, 20),
        "water and a grain": np.where(r < 1, 3000, between(-20, 20)),
        "metal": between(4000, 12000),
        "below 0": between(-300, -1),
        "one value and a border": border,
        "two values": np.where(r < 6, 301.0, 300.0),
        "1499 to 1501": between(1499, 1501),
        "tiny": between(0, 1e-30),
        "around 1e7": 1e7 + random.integers(0, 3, (N, N, N)),
    }


VOLUMES = samples_of()


def volume_of(samples, modality, *, is_anatomical=True):
    facts = Facts(unit="mm", is_anatomical=is_anatomical, modality=modality)
    return ws.Volume(samples, spacing=(1, 1, 2), facts=facts)


def check_increasing(look):
    """Whether nodes of all curves grow, and all numbers are finite."""
    function = look.transfer_function
    for curve in (function.opacity, function.color):
        nodes = np.array(curve)
        assert np.isfinite(nodes).all()
        assert (np.diff(nodes[:, 0]) >= 0).all()


@pytest.mark.parametrize("modality", MODALITIES, ids=str)
@pytest.mark.parametrize("name", VOLUMES)
def test_every_kind_has_a_look_of_narrow_values(name, modality):
    for samples in (VOLUMES[name].astype(np.float32), np.rint(VOLUMES[name].clip(-32768, 32767)).astype(np.int16)):
        if samples.min() < samples.max():
            volume = volume_of(samples, modality, is_anatomical=name != "metal")
            for operator in OPERATORS:
                check_increasing(automatic(volume, operator))


@pytest.mark.parametrize("share", [0.0005, 0.002, 0.02])
def test_a_bone_alone_in_padding_is_shown(share):
    """Next to nothing but padding: the percentile that counts as largest lies within the bone."""
    random = np.random.default_rng(4)
    samples = np.full((30, 30, 30), 0, np.int16)
    n = int(share * samples.size)
    # Marrow and cortex, far apart.
    samples.ravel()[1000 : 1000 + n] = np.where(np.arange(n) % 4 == 0, 1400, 320) + random.integers(-9, 9, n)
    samples[:, 0] = 0
    volume = volume_of(samples, "CT")
    look = automatic(volume, None)
    check_increasing(look)
    picture = ws.render(volume, size=(32, 32), background="transparent")
    assert picture.rgba[..., 3].max() > 0


def test_what_counts_as_largest_lies_above_the_threshold():
    values = np.concatenate([np.zeros(100_000), np.full(80, 320.0), np.full(60, 1400.0), np.linspace(318, 322, 5)])
    low, high = histogram.robust_range_of(values)
    background, threshold, largest = histogram.otsu_of_scan(values, low, high)
    assert background < threshold < largest


@pytest.mark.parametrize("shape", [(2, 2, 2), (2, 2, 3), (2, 9, 9), (3, 3, 3)])
@pytest.mark.parametrize("modality", MODALITIES, ids=str)
def test_thin_volumes_have_looks(shape, modality):
    for samples in (np.arange(np.prod(shape)), 300 + 7.5 * np.arange(np.prod(shape))):
        check_increasing(automatic(volume_of(samples.reshape(shape).astype(np.float32), modality), None))


def test_a_volume_that_varies_at_its_border_alone_keeps_its_kind():
    volume = volume_of(VOLUMES["one value and a border"].astype(np.float32), "US")
    assert kind_of(volume) == "ultrasound"


def test_probabilities_below_0_show_nothing():
    volume = volume_of(-np.random.default_rng(1).random((6, 6, 6)).astype(np.float32) / 10 - 0.01, "SEG")
    look = automatic(volume, None)
    check_increasing(look)
    assert look.transfer_function.opacity[0] == (0.0, 0.0)


@pytest.mark.parametrize("value", [0, 700, -1000])
def test_one_value_is_said_with_a_remedy(value):
    with pytest.raises(ws.errors.ArgumentError, match=f"every sample is {value}, .* pass a transfer function"):
        automatic(volume_of(np.full((5, 5, 5), value, np.int16), "CT"), None)
