"""One object has one look, whatever its file says of units; hot pixels, specks and odd windows of files change none."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks.kinds.kinds import found_in

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def cells(shape=(40, 128, 128), seed=5):
    """Cells over a noisy background, counts of photons."""
    rng = np.random.default_rng(seed)
    z, y, x = np.mgrid[: shape[0], : shape[1], : shape[2]].astype(np.float32)
    light = np.full(shape, 60, np.float32)
    for cz, cy, cx in rng.uniform((6, 6, 6), np.array(shape) - 6, (40, 3)):
        squared = (z - cz) ** 2 + (y - cy) ** 2 + (x - cx) ** 2
        light += rng.uniform(60, 600) * np.exp(-squared / (2 * rng.uniform(2, 5) ** 2))
    return rng.poisson(light).astype(np.uint16)


CELLS = cells()


def kind_of(samples, **facts):
    spacing = facts.pop("spacing", (1.0, 1.0, 1.0))
    return ws.Look.auto(ws.Volume(samples, spacing=spacing, facts=ws.Facts(**facts)))


def test_the_unit_alone_chooses_no_look_fault_11():
    """A mouse brain was copper and lit in millimetres, green in micrometres; an array of cells blue and cream."""
    looks = [
        kind_of(CELLS, unit="um", spacing=(40, 40, 50)),
        kind_of(CELLS, unit="mm", spacing=(0.04, 0.04, 0.05), is_anatomical=True),
        kind_of(CELLS),
        kind_of(CELLS.astype(np.int32)),
    ]
    assert [look.reason.partition(":")[0] for look in looks] == ["fluorescence"] * 4
    assert {look.shading for look in looks} == {None}
    assert len({look.transfer_function.color for look in looks}) == 1


def test_scans_stay_scans():
    """Bodies of even matter, and images without noise, are no light of photons."""
    rng = np.random.default_rng(1)
    z, y, x = np.mgrid[-1:1:48j, -1:1:48j, -1:1:48j]
    body = 100.0 * (x * x + y * y + z * z < 0.5) + 80 * (x * x + y * y < 0.05) + np.abs(rng.normal(0, 6, x.shape))
    vessels = (255 * np.exp(-((x - 0.2 * np.sin(4 * z)) ** 2 + y * y) * 300)).astype(np.uint8)
    assert kind_of(body.astype(np.uint8)).reason == "a scan of no fixed scale"
    assert kind_of(vessels).reason == "a scan of no fixed scale"
    fine = kind_of(body.astype(np.uint16), unit="mm", spacing=(0.05, 0.05, 0.05), is_anatomical=True)
    assert fine.reason == "a scan of no fixed scale"


def test_dense_fluorescence_is_not_overexposed_fault_11():
    """A brain in white had the mean 212 of 255 in its pixels."""
    rng = np.random.default_rng(2)
    z, y, x = np.mgrid[-1:1:64j, -1:1:64j, -1:1:64j]
    tissue = (x * x + y * y + z * z < 0.6) * (200 + 60 * np.sin(9 * x) * np.cos(8 * y) + 300 * (x * x + y * y < 0.01))
    samples = rng.poisson(5 + tissue).astype(np.uint16)
    white = ws.Channel("autofluorescence", color=(1, 1, 1), window=(0, 600))
    for facts in (ws.Facts(unit="um", channel=white), ws.Facts(unit="um")):
        picture = ws.render(ws.Volume(samples, spacing=(80, 80, 80), facts=facts), size=(96, 96), background="black")
        rgb = picture.rgba[..., :3]
        luminance = 255 * (rgb @ LUMINANCE)[(rgb > 6 / 255).any(axis=2)]
        assert 60 < luminance.mean() < 170


@pytest.mark.parametrize(
    ("window", "said"),
    [
        ((60.0, 500.0), "as the file says"),
        ((0.0, 47602.0), "only the lowest 30 % is used"),
        ((0.0, 20.0), "more than 30 % of the samples are beyond the end"),
        ((0.0, 65535.0), "by the values"),
    ],
)
def test_the_display_range_of_a_file_is_used_where_samples_lie_in_it(window, said):
    channel = ws.Channel(window=window, color=(0, 1, 0))
    volume = ws.Volume(CELLS, facts=ws.Facts(unit="um", channel=channel))
    look = ws.Look.channel(volume)
    assert said in look.reason
    used = said == "as the file says"
    assert ((look.transfer_function.color[0][0], look.transfer_function.color[-1][0]) == window) == used
    first = ws.Look.auto(volume).transfer_function
    assert (first.color[-1][0] == window[1]) == used


@pytest.mark.parametrize("n_hot", [5, 200])
def test_hot_pixels_move_no_window_fault_12(n_hot):
    """The 99th percentile of a maximum projection went from 179 to 80 by 200 hot pixels of 655360."""
    at = np.random.default_rng(7).choice(CELLS.size, n_hot, replace=False)
    hot = CELLS.copy()
    hot.ravel()[at] = 65535
    for composite in ("maximum", "local-maximum", None):
        looks = [
            ws.Look.auto(ws.Volume(one, facts=ws.Facts(unit="um")), composite).transfer_function for one in (CELLS, hot)
        ]
        ends = [(look.color[0][0], look.color[-1][0]) for look in looks]
        assert np.allclose(ends[0], ends[1], rtol=0.05)
    shown = [
        ws.render(ws.Volume(one, facts=ws.Facts(unit="um")), camera="xy", composite="maximum", size=(96, 96)).rgba
        for one in (CELLS, hot)
    ]
    # But for the hot pixels themselves the picture is the same.
    assert (np.abs(shown[1] - shown[0]).max(axis=2) < 0.02).mean() > 0.85


def test_specks_take_no_greys_fault_12():
    """A maximum projection of a brain was black: its white was 2438, four times the 99.9th percentile."""
    samples = np.minimum(CELLS, 300).astype(np.uint16)
    rng = np.random.default_rng(3)
    for z, y, x in rng.integers(4, 36, (30, 3)):
        samples[z : z + 3, y * 3 : y * 3 + 3, x * 3 : x * 3 + 3] = 9000
    greys = ws.Look.auto(ws.Volume(samples, facts=ws.Facts(unit="um")), "maximum").transfer_function
    assert greys.color[-1][0] < 2 * np.percentile(samples, 99.7)


def test_threads_of_a_thinned_volume_are_no_hot_pixels():
    """A thread one sample thick is no row of hot pixels, though its thinned samples lie alone."""
    samples = np.zeros((130, 140, 150), np.float32)
    samples += np.random.default_rng(4).normal(10, 1, samples.shape).astype(np.float32)
    samples[:, 70, 74:76] = 100
    samples[60, :, 74:76] = 100
    white = ws.Look.auto(ws.Volume(samples), "maximum").transfer_function.color[-1][0]
    assert white > 30


def test_the_kind_is_looked_for_again_after_a_change():
    cells = np.zeros((24, 24, 24), np.float32)
    cells[4:20, 4:20, 4:20] = 3
    volume = ws.Volume(cells)
    assert found_in(volume).kind == "mask"
    assert found_in(volume) is found_in(volume)
    cells[:] = np.random.default_rng(1).normal(size=cells.shape)
    volume.changed()
    assert found_in(volume).kind == "signed field"


@pytest.mark.parametrize("peak", [300, 2000])
@pytest.mark.parametrize("of", [np.uint16, np.float32])
def test_a_bead_in_noise_is_its_brightest_pixels(peak, of):
    """It was a brick of noise, "dense matter that fills the volume": half of the noise is above its median."""
    z, y, x = np.indices((48, 48, 48)) - np.reshape((10, 24, 30), (3, 1, 1, 1))
    light = 140 + peak * np.exp(-(z * z + y * y + x * x) / 8)
    samples = np.random.default_rng(1).poisson(light).astype(of)
    looks = [kind_of(samples, unit=unit) for unit in (None, "um")]
    assert looks[0] == looks[1]
    assert looks[0].composite == "maximum"
    picture = ws.render(ws.Volume(samples), looks[0], camera=ws.Camera.orbit(ws.Volume(samples), 0, 90), size=(48, 48))
    brightness = picture.rgba[..., :3].sum(axis=2)
    row, column = np.unravel_index(brightness.argmax(), brightness.shape)
    assert picture.value[row, column] > 140 + 0.8 * peak
    assert np.median(brightness) < 0.1 * brightness.max()


def test_hot_pixels_are_no_beads():
    dark = np.random.default_rng(1).poisson(140, (48, 48, 48)).astype(np.uint16)
    dark[::7, ::7, ::7] = 2000
    assert kind_of(dark).composite == "over"


def test_spots_in_noise_have_no_haze():
    random = np.random.default_rng(0)
    z, y, x = np.indices((48, 48, 48))
    light = np.full(z.shape, 140.0)
    for at in random.uniform(5, 43, (20, 3)):
        light += 1500 * np.exp(-((z - at[0]) ** 2 + (y - at[1]) ** 2 + (x - at[2]) ** 2) / 4)
    samples = random.poisson(light).astype(np.uint16)
    looks = [kind_of(samples, unit=unit) for unit in (None, "um", "mm")]
    assert looks[0] == looks[1] == looks[2]
    assert looks[0].transfer_function([140 + 3 * np.sqrt(140)])[0, 3] == 0
    assert looks[0].transfer_function([1000])[0, 3] > 0.1


@pytest.mark.parametrize("unit", ["um", "nm", "mm", "m"])
def test_scans_of_any_unit_are_scans(unit):
    z, y, x = np.mgrid[-1:1:32j, -1:1:32j, -1:1:32j]
    body = 100.0 * (x * x + y * y + z * z < 0.5) + np.abs(np.random.default_rng(1).normal(0, 6, x.shape))
    assert kind_of(body.astype(np.uint16), unit=unit, spacing=(0.01,) * 3) == kind_of(
        body.astype(np.uint16), spacing=(0.01,) * 3
    )


@pytest.mark.parametrize("shift", ["mean", "middle", "least"])
def test_a_normalised_mr_looks_like_the_scan(shift):
    """z-scores were a filled box, "a field with two signs": their air is negative, and most of the volume."""
    head = ws.examples.mri_head()
    values = head.samples.astype(np.float64)
    subtracted = {"mean": values.mean(), "middle": np.ptp(values) / 2 + values.min(), "least": values.min()}[shift]
    divided = values.std() if shift == "mean" else np.ptp(values)
    made = ws.Volume(
        ((values - subtracted) / divided).astype(np.float32),
        world_from_index=head.world_from_index,
        facts=ws.Facts(unit="mm", is_anatomical=True),
    )
    wanted = ws.Volume(head.samples.astype(np.int16), world_from_index=head.world_from_index, facts=made.facts)
    pictures = [ws.render(volume, size=(64, 64)) for volume in (wanted, made)]
    assert np.mean((pictures[0].rgba - pictures[1].rgba) ** 2) < 1e-5  # 50 dB
    assert pictures[0].report.get("notes") == pictures[1].report.get("notes")
