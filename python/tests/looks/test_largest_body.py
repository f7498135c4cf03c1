"""The largest body of a scan: a table goes, skin, lungs and ears stay."""

import sys

import numpy as np
import pytest
from tiff_pixels import tiff_pixels

import wavesplat as ws
from wavesplat.errors import ArgumentError, LibraryError

pytest.importorskip("scipy.ndimage")

AIR, FOAM, TISSUE, LUNG, SHELL = -1000, -900, 40, -800, 300
SPACING = (1.5, 1.5, 3.0)


def patient(*, gap_mm=6.0, spacing=SPACING, noise=20.0):
    """A thorax with lungs that are open at its ends and an ear's thin flap, on foam, above a hollow table.

    Returns the scan, and masks [z, y, x] of body and table. `gap_mm`: distance from back to table; 0 touches.
    """
    n_x, n_y, n_z = (round(side / step) for side, step in zip((240, 200, 120), spacing, strict=True))
    z, y, x = np.meshgrid(*(np.arange(n) for n in (n_z, n_y, n_x)), indexing="ij", sparse=True)
    x, y, z = x * spacing[0] - 120, y * spacing[1] - 80, z * spacing[2]
    body = (x / 90) ** 2 + (y / 60) ** 2 + 0 * z < 1
    body |= (np.abs(x) < 60) & (y > 0) & (y < 60) & (z >= 0)  # a flat back
    flap = (np.abs(x - 97) < 10) & (np.abs(y) < 1.6) & (np.abs(z - 60) < 12)
    lungs = ((np.abs(x) - 42) / 28) ** 2 + (y / 38) ** 2 + 0 * z < 1
    depth = y - 60 - gap_mm
    table = (depth >= 0) & (depth < 40) & (np.abs(x) < 110) & (z >= 0)
    shell = table & ((depth < 3) | (depth > 37) | (np.abs(x) > 107))
    samples = np.full((n_z, n_y, n_x), AIR, np.float64)
    samples[(y > 60) & (depth < 40) & (np.abs(x) < 110) & (z >= 0)] = FOAM
    samples[np.broadcast_to(shell, samples.shape)] = SHELL
    samples[body | flap] = TISSUE
    samples[lungs & body] = LUNG
    samples += np.random.default_rng(2).normal(0, noise, samples.shape)
    volume = ws.Volume(np.clip(samples, -1024, 3000).astype(np.int16), spacing=spacing, unit="mm", name="thorax")
    return volume, body | flap, np.broadcast_to(table & ~body, samples.shape)


@pytest.mark.parametrize("spacing", [(1.5, 1.5, 3.0), (0.8, 0.8, 5.0), (3.0, 3.0, 3.0)])
@pytest.mark.parametrize("gap_mm", [6.0, 0.0])
def test_the_table_goes_and_the_body_stays(gap_mm, spacing):
    volume, body, table = patient(gap_mm=gap_mm, spacing=spacing)
    alone = ws.largest_body(volume)
    # Sharp corners, which no real body has, may lose a sample.
    assert (alone.samples[body] != volume.samples[body]).mean() < 2e-4
    assert (volume.samples[table] > -400).sum() > 1000
    below = int((80 + 60 + gap_mm + 7) / spacing[1])
    assert (volume.samples[:, below:] > -400).any()
    assert not (alone.samples[:, below:] > -400).any()
    if gap_mm:
        assert not (alone.samples[table] > -400).any()


def test_all_else_stays():
    volume, _, _ = patient()
    alone = ws.largest_body(volume)
    assert (alone.dtype, alone.name, alone.unit) == (np.int16, "thorax", "mm")
    np.testing.assert_array_equal(alone.world_from_index, volume.world_from_index)
    assert alone.facts.processing == ("all but the largest body emptied: above -400, opened by 4 mm",)
    assert alone.value_range[0] == volume.value_range[0]
    assert ws.render(alone, size=(8, 8)).report["processing"] == list(alone.facts.processing)


def test_what_is_not_known_stays_so():
    volume, _, _ = patient()
    samples = volume.samples.astype(np.float32)
    samples[:, :4] = np.nan
    alone = ws.largest_body(ws.Volume(samples, spacing=SPACING, unit="mm"))
    np.testing.assert_array_equal(np.isnan(alone.samples), np.isnan(samples))


def test_units_do_not_matter():
    volume, _, _ = patient()
    metres = ws.Volume(volume.samples, spacing=np.divide(SPACING, 1000), unit="m")
    np.testing.assert_array_equal(ws.largest_body(metres).samples, ws.largest_body(volume).samples)
    unknown = ws.Volume(volume.samples, spacing=SPACING)
    np.testing.assert_array_equal(ws.largest_body(unknown).samples, ws.largest_body(volume).samples)


def test_slices_are_those_of_the_patient_however_samples_lie():
    volume, _, _ = patient()
    turned = volume.world_from_index[:, [2, 0, 1, 3]]
    sagittal = ws.Volume(np.ascontiguousarray(volume.samples.transpose(1, 2, 0)), world_from_index=turned, unit="mm")
    alone = ws.largest_body(sagittal)
    np.testing.assert_array_equal(alone.samples.transpose(2, 0, 1), ws.largest_body(volume).samples)


def test_lungs_that_the_edge_of_the_picture_cuts_stay():
    volume, body, _ = patient()
    half = slice(None, volume.shape[2] // 2 - int(42 / SPACING[0]))  # through the middle of a lung
    cut = ws.Volume(volume.samples[..., half], spacing=SPACING, unit="mm")
    np.testing.assert_array_equal(ws.largest_body(cut).samples[body[..., half]], cut.samples[body[..., half]])


def test_two_legs_are_one_body():
    _, y, x = np.indices((40, 60, 120))
    legs = (y - 25) ** 2 + (np.abs(x - 59.5) - 30) ** 2 < 18**2
    table = (y > 52) & (y < 55)
    samples = np.where(legs, TISSUE, np.where(table, SHELL, AIR)).astype(np.int16)
    alone = ws.largest_body(ws.Volume(samples, unit="mm"))
    assert (alone.samples[legs] == TISSUE).all()
    assert (alone.samples[table] == AIR).all()


def test_thin_walls_are_kept():
    z, y, x = np.indices((50, 60, 60)) - np.array([25, 30, 30])[:, None, None, None]
    radius = np.sqrt(x**2 + y**2 + z**2)
    shell = (radius > 20) & (radius < 24)
    headrest = (y > 26) & (np.abs(x) < 10)
    samples = np.where(shell, 200, np.where(headrest, 120, 0)).astype(np.uint8)
    alone = ws.largest_body(ws.Volume(samples, unit="mm"), 60)
    assert (alone.samples[shell] == 200).all()
    assert (alone.samples[headrest] == 0).all()


def test_other_values_are_parted_by_otsu():
    samples = np.zeros((30, 30, 30), np.uint8)
    samples[5:25, 5:20, 5:25] = 90
    samples[:, 27:28] = 60
    alone = ws.largest_body(ws.Volume(samples, spacing=(3, 3, 3), unit="mm"))
    assert (alone.samples[5:25, 5:20, 5:25] == 90).all()
    assert (alone.samples[:, 27:] == 0).all()


def test_nothing_is_cut_off_without_opening():
    samples = np.full((30, 30, 40), AIR, np.int16)
    samples[:, 5:15, 10:30] = TISSUE
    samples[:, 15:17] = SHELL  # all across, and touching
    volume = ws.Volume(samples, spacing=(3, 3, 3), unit="mm")
    assert (ws.largest_body(volume, opening=0).samples[:, 15:17] == SHELL).all()
    assert (ws.largest_body(volume).samples[:, 15:17, :5] == AIR).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"threshold": 4000}, "nothing in volume 'thorax' is above 4000; its values are"),
        ({"threshold": np.nan}, "nothing in volume 'thorax' is above nan"),
        ({"opening": -1}, "opening is -1; give a radius of 0 or more"),
        ({"opening": np.inf}, "opening is inf"),
    ],
)
def test_wrong_numbers_are_refused(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        ws.largest_body(patient()[0], **arguments)


def test_wavelets_say_what_to_give():
    with pytest.raises(ArgumentError, match="such as its to_volume()"):
        ws.largest_body(ws.WaveletVolume.from_volume(ws.examples.ripples(16)))


def test_a_missing_library_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.ndimage", None)
    with pytest.raises(LibraryError, match=r'pip install "wavesplat\[body\]"'):
        ws.largest_body(ws.examples.ct_pelvis())


def test_the_command_line_removes_tables(wavesplat, tmp_path):
    import nibabel
    import tifffile

    volume, _, _ = patient()
    nibabel.save(nibabel.Nifti1Image(volume.samples.T, volume.world_from_index), tmp_path / "a.nii.gz")
    for command in (["render", "--preset", "ct-skin", "--size", "40x40"], ["slice", "--size", "160x133"]):
        done = wavesplat(*command, tmp_path / "a.nii.gz", "-o", tmp_path / "a.tif", "--remove-table", "--smooth", "0.7")
        assert (done.returncode, done.stderr) == (0, "")
        got = tifffile.imread(tmp_path / "a.tif")
        alone = ws.largest_body(ws.open(tmp_path / "a.nii.gz")).smoothed(0.7)
        if command[0] == "slice":
            want = ws.slice(alone, size=(160, 133))
        else:
            want = ws.render(alone, "ct-skin", size=(40, 40), background="black")
        np.testing.assert_array_equal(got, tiff_pixels(want))
