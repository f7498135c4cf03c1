"""Anisotropy, probabilities, directions and displacements are told from MR scans (clinic, section 2: `dti_fa`, V1)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import pytest
from dicom_files import save, slice_at
from numpy.typing import NDArray

import wavesplat as ws
from wavesplat._looks.kinds.kinds import evidence
from wavesplat.errors import ArgumentError, FileError

RNG = np.random.default_rng(44)
SIDE = 48
X, Y, Z = np.meshgrid(*[np.linspace(-1, 1, SIDE)] * 3, indexing="ij")[::-1]
R = np.sqrt(X * X + Y * Y + Z * Z)
HEAD = R < 0.9
#: A head of four tissues with the noise of a magnitude, 0 to about 1.
TISSUE = np.where(R < 0.5, 0.75, np.where(R < 0.7, 0.5, np.where(R < 0.8, 0.15, 0.85))) * HEAD
SCAN = np.hypot(TISSUE + RNG.normal(0, 0.02, R.shape), RNG.normal(0, 0.02, R.shape))
#: White matter, 0.3 to 0.8, in a brain of low anisotropy, with the rim that noise makes of negative eigenvalues.
BUNDLES = np.exp(-((np.hypot(X, Z) - 0.4) ** 2) / 0.01)
FA = np.where(HEAD, 0.12 + 0.6 * BUNDLES + np.abs(RNG.normal(0, 0.04, R.shape)), 0)
RIM = HEAD & (R > 0.86) & (RNG.random(R.shape) < 0.2)
GREY = 1 / (1 + np.exp(-(0.08 - np.abs(R - 0.6)) / 0.012)) * HEAD
LESION = np.exp(-((X - 0.3) ** 2 + Y**2 + (Z - 0.2) ** 2) / 0.02)
DARK = SCAN**2
P_VALUES = 1 - 0.999 * LESION / LESION.max()
PATIENT = ws.Facts(unit="mm", is_anatomical=True)

#: Name of the file, samples, and the kind. Checked by hand besides, as a real file each: FA and V1 of FSL (Papaya),
#: the templates and heads of NiiVue's demo images normalised to 1, a stroke's FLAIR through a sigmoid.
TABLE: dict[str, tuple[str, NDArray[Any], str]] = {
    "FA of FSL, with its rim": ("x.nii", np.where(RIM, 1.2247, FA), "FA"),
    "FA clipped to 1, by its name": ("sub-01_param-FA_dwimap.nii.gz", np.clip(np.where(RIM, 1.2, FA), 0, 1), "FA"),
    "FA clipped to 1, without a name": ("x.nii", np.clip(np.where(RIM, 1.2, FA), 0, 1), "FA"),
    "FA without a rim, up to 0.8, without a name": ("x.nii", FA, "MR"),
    "a scan by its maximum, mostly dark": ("x.nii", DARK / DARK.max(), "MR"),
    "a scan, mostly dark, clipped at a percentile": (
        "x.nii",
        np.clip(SCAN**2 / np.percentile(SCAN**2, 99), 0, 1),
        "MR",
    ),
    "a scan by flip angle, which is FA too": ("sub-01_FA20.nii", 900 * SCAN, "MR"),
    "grey matter": ("c1.nii", GREY, "probability"),
    "grey matter as stored in bytes": ("c1.nii", np.round(255 * GREY) / 255, "probability"),
    "grey matter after splines": ("x.nii", 1.06 * GREY - 0.03, "probability"),
    "a lesion of a network": ("x.nii", np.where(LESION > 0.01, LESION, 0), "probability"),
    "a structure of an atlas, at most 0.7": ("x.nii", np.where(LESION > 0.01, 0.7 * LESION, 0), "probability"),
    "an atlas in per cent, by its name": ("Oxford-prob-1mm.nii", np.round(100 * LESION), "probability"),
    "p-values": ("x.nii", P_VALUES, "p-values"),
    "p-values by their name": ("clusters_p_value.nii", np.clip(P_VALUES - 0.3 * GREY, 0, 1), "p-values"),
    "p-values of a mask, by their name": ("pval.nii", np.where(HEAD, P_VALUES, 0), "map"),
    "1 - p of randomise": ("tbss_tfce_corrp_tstat1.nii.gz", 0.98 * LESION, "probability"),
    "an inverted head": ("x.nii", 1 - SCAN / SCAN.max(), "MR"),
    "a scan, 0 to 1 by its extremes": ("x.nii", SCAN / SCAN.max(), "MR"),
    "a scan, clipped at its 98th percentile": ("x.nii", np.clip(SCAN / np.percentile(SCAN, 98), 0, 1), "MR"),
    "a head without its skull, 0 to 1": ("x.nii", np.where(R < 0.7, SCAN / SCAN.max(), 0), "MR"),
    "a relaxation time, 0 to 2.9 s": ("T1map.nii", 2.9 * SCAN / SCAN.max(), "map"),
    "a relaxation time in two words": ("sub-01_T2_map.nii.gz", 120 * SCAN, "map"),
    "a relaxation time without a name": ("x.nii", 1400 * SCAN, "MR"),
    "a T1-weighted scan": ("sub-01_T1w.nii.gz", 900 * SCAN, "MR"),
    "ADC in mm²/s": ("x.nii", 0.003 * SCAN, "map"),
    "ADC in 10⁻⁶ mm²/s, by its name": ("prostate_ADC.nii.gz", 3000 * SCAN, "map"),
    "MD of FSL": ("dti_MD.nii.gz", 0.003 * SCAN, "map"),
    "initials": ("MD_scan.nii.gz", 900 * SCAN, "MR"),
    "blood flow": ("sub-01_cbf.nii.gz", 80 * SCAN, "map"),
    "a statistic above its threshold": ("thresh_zstat1.nii.gz", np.where(LESION > 0.4, 2.3 + 4 * LESION, 0), "map"),
    "a statistic of two signs": ("zstat1.nii.gz", 6 * LESION - 5 * np.roll(LESION, 12, axis=2), "signed field"),
    "uptake, by its name": ("thigh_SUV.nii.gz", 6 * SCAN, "PET"),
    "parts of a tumour": ("x.nii", (LESION > 0.2) * 2.0 + (LESION > 0.5) * 2.0 - 3.0 * (LESION > 0.8), "labels"),
    "a patchy lesion map of four values": (
        "x.nii",
        np.where(LESION > 0.05, 1.0 + (LESION > 0.4) + (RNG.random(R.shape) < 0.02), 0),
        "labels",
    ),
}


def patient(name: str, samples: NDArray[Any], **facts: Any) -> ws.Volume:
    known = ws.Facts(**{"unit": "mm", "is_anatomical": True, **facts})
    return ws.Volume(samples.astype(np.float32), name=name, spacing=(1, 1, 1), facts=known)


@pytest.mark.parametrize("what", TABLE)
def test_the_table_of_derived_maps(what: str) -> None:
    name, samples, kind = TABLE[what]
    found = evidence(patient(name, samples))
    assert found.kind == kind, found.reason
    if kind in ("FA", "probability", "map", "p-values", "PET"):
        assert found.is_guess
        assert "by the values" in found.reason


def test_a_lesion_that_the_samples_looked_at_miss_is_no_mask() -> None:
    lesion = np.zeros((130, 130, 130), np.float32)
    lesion[62:65, 62:65, 62:65] = RNG.uniform(0.1, 0.7, (3, 3, 3))
    volume = patient("x.nii", lesion)
    assert len(np.unique(evidence(volume).values)) <= 2
    assert evidence(volume).kind == "probability"


def test_maps_are_shown_by_light_and_low_p_values_alone() -> None:
    adc = patient("prostate_ADC.nii.gz", 3000 * SCAN)
    look = ws.Look.auto(adc)
    assert look.shading is None
    assert look.transfer_function([0.0, 300.0])[:, 3].max() < 0.03  # type: ignore[operator]
    p_values = patient("x.nii", P_VALUES)
    look = ws.Look.auto(p_values)
    alphas = look.transfer_function([0.0, 0.03, 0.06, 0.5, 1.0])[:, 3]  # type: ignore[operator]
    assert alphas[0] > alphas[1] > alphas[2] == alphas[3] == alphas[4] == 0
    for volume in (adc, p_values):
        picture = ws.render(volume, size=(48, 48))
        assert picture.rgba[..., 3].max() > 0.5
        assert picture.report["look"]["reason"].endswith("by the values")


@pytest.mark.parametrize(
    ("intent", "samples", "kind", "quantity"),
    [
        ("z score", np.abs(SCAN), "map", "z statistic"),
        ("p value", P_VALUES, "p-values", "p-value"),
        ("none", 900 * SCAN, "MR", None),
        ("estimate", 900 * SCAN, "MR", None),
    ],
)
def test_the_intent_of_nifti_says_what_a_map_holds(
    tmp_path: Path, intent: str, samples: NDArray[Any], kind: str, quantity: str | None
) -> None:
    image = nibabel.Nifti1Image(samples.T.astype(np.float32), np.diag([2.0, 2, 2, 1]))
    image.header.set_intent(intent, (1.0,) if intent == "t test" else ())
    nibabel.save(image, tmp_path / "x.nii")
    volume = ws.open(tmp_path / "x.nii")
    found = evidence(volume)
    assert (volume.facts.quantity, found.kind) == (quantity, kind)
    assert found.is_guess == (quantity is None)


@pytest.mark.parametrize(
    ("image_type", "kind", "quantity"),
    [
        (["DERIVED", "PRIMARY", "DIFFUSION", "ADC"], "map", "apparent diffusion coefficient"),
        (["DERIVED", "SECONDARY", "OTHER", "RCBV"], "map", "blood volume"),
        (["DERIVED", "PRIMARY", "M", "T2 MAP"], "map", "relaxation time T2"),
        (["DERIVED", "PRIMARY", "DIFFUSION", "TRACEW"], "MR", None),
        (["ORIGINAL", "PRIMARY", "M", "ADC"], "MR", None),
    ],
)
def test_the_image_type_of_dicom_says_what_a_map_holds(
    tmp_path: Path, image_type: list[str], kind: str, quantity: str | None
) -> None:
    pixels = (2000 * SCAN).astype(np.uint16)[::4]
    save(tmp_path / "mr", [slice_at(one, n, modality="MR", ImageType=image_type) for n, one in enumerate(pixels)])
    volume = ws.open(tmp_path / "mr")
    found = evidence(volume)
    assert (found.kind, volume.facts.quantity) == (kind, quantity), found.reason
    assert volume.value_unit == (None if quantity else "a.u.")
    assert not found.is_guess


def test_arrays_without_a_patient_are_fields_as_before() -> None:
    for name in ("grey matter", "FA of FSL, with its rim", "a lesion of a network"):
        assert evidence(ws.Volume(TABLE[name][1].astype(np.float32))).kind == "field"


def test_fractions_of_dicom_segmentations_are_probabilities_by_their_file() -> None:
    found = evidence(patient("seg.dcm", 0.9 * GREY, modality="SEG"))
    assert (found.kind, found.is_guess) == ("probability", False)


@pytest.mark.parametrize("what", ["FA of FSL, with its rim", "grey matter", "a lesion of a network"])
def test_shares_are_clear_at_0_in_colours_of_a_map_and_not_in_those_of_skin(what: str) -> None:
    name, samples, _ = TABLE[what]
    volume = patient(name, samples)
    look = ws.Look.auto(volume)
    assert isinstance(look.transfer_function, ws.TransferFunction)
    at = look.transfer_function([0.0, 0.02, 0.6, 0.95])
    assert at[0, 3] == 0
    assert at[1, 3] < 0.01
    assert 0.05 < at[2, 3] < at[3, 3]
    # Hot: red before green before blue, and all of a fibre bundle is no skin.
    assert at[2, 0] > at[2, 1] > at[2, 2]
    picture = ws.render(volume, size=(48, 48))
    assert picture.rgba[..., 3].max() > 0.8
    assert picture.report["look"]["reason"] == evidence(volume).reason


def test_isotropic_matter_is_clear_and_fibres_are_not() -> None:
    look = ws.Look.auto(patient("dti_FA.nii.gz", FA))
    assert isinstance(look.transfer_function, ws.TransferFunction)
    assert look.shading is None
    assert look.transfer_function([0.12, 0.2])[:, 3].max() == 0
    assert look.transfer_function([0.7])[0, 3] > 0.3


def test_two_probabilities_over_a_scan_have_maps_of_their_own() -> None:
    over = [patient(f"p{n}.nii", np.roll(TABLE["a lesion of a network"][1], n * 9, axis=2)) for n in range(2)]
    report = ws.render(ws.Scene([patient("scan.nii", 900 * SCAN), *over]), size=(24, 24)).report
    first, second = (layer["look"]["transfer_function"]["color"] for layer in report["scene"]["layers"][1:])
    assert first != second


# Vectors in NIfTI


def directions() -> NDArray[Any]:
    """Directions of fibres [x, y, z, component] in a ball, as V1 of FSL."""
    vectors = np.stack([-Z, 0.5 + 0 * Y, X], axis=-1)
    vectors /= np.linalg.norm(vectors, axis=-1)[..., None]
    return np.where(HEAD[..., None], vectors, 0).astype(np.float32)


def saved(path: Path, samples: NDArray[Any], intent: int = 0) -> Path:
    image = nibabel.Nifti1Image(samples, np.diag([2.0, 2, 2, 1]))
    image.header.set_intent(intent)
    nibabel.save(image, path)
    return path


@pytest.mark.parametrize("axis", [3, 4])
def test_directions_are_three_channels_of_magnitudes(tmp_path: Path, axis: int) -> None:
    v1 = directions()
    path = saved(tmp_path / "dti_V1.nii", v1 if axis == 3 else v1[:, :, :, None])
    with pytest.raises(FileError, match=r"3 channels \(0 red, 1 green, 2 blue\)"):
        ws.open(path)
    for number, name in enumerate(("red", "green", "blue")):
        volume = ws.open(path, channel=number)
        np.testing.assert_array_equal(volume.samples, np.abs(v1[..., number]).T)
        assert volume.facts.channel is not None
        assert volume.facts.channel.name == name
        assert volume.facts.n_times == 1
        assert "directions" in volume.facts.guesses[-1]
    np.testing.assert_array_equal(ws.open(path, component="z").samples, v1[..., 2].T)
    scene = ws.open_scene(path)
    assert [layer.name for layer in scene.layers] == ["red", "green", "blue"]
    rgba = scene.render(size=(32, 32)).rgba
    assert (rgba[..., :3].max(axis=(0, 1)) > 0.3).all()


def test_three_times_of_a_scan_stay_times(tmp_path: Path) -> None:
    scan = np.stack([SCAN, 0.9 * SCAN, 1.1 * SCAN], axis=-1).astype(np.float32)
    assert len(ws.open_series(saved(tmp_path / "bold.nii", scan))) == 3
    # One that is asked for by its number is a time too.
    assert ws.open(saved(tmp_path / "v1.nii", directions()), time=0).samples.min() < 0


def test_displacements_are_drawn_by_their_length(tmp_path: Path) -> None:
    warp = np.stack([3 * LESION, -2 * LESION, LESION], axis=-1)[:, :, :, None].astype(np.float32)
    path = saved(tmp_path / "warp.nii", warp, 1007)
    volume = ws.open(path)
    np.testing.assert_allclose(volume.samples, (np.sqrt(14) * LESION).T, rtol=1e-5, atol=1e-7)
    assert "holds vectors, of which the length is drawn" in volume.facts.guesses[-1]
    assert volume.facts.processing == ("the length of the vectors",)
    assert evidence(volume).kind == "field"
    np.testing.assert_array_equal(ws.open(path, component="y").samples, warp[:, :, :, 0, 1].T)
    np.testing.assert_array_equal(ws.open(path, channel=1).samples, warp[:, :, :, 0, 1].T)


def test_displacements_at_several_times_keep_their_times(tmp_path: Path) -> None:
    warp = np.stack([RNG.normal(size=(6, 6, 6, 3)) for _ in range(3)], axis=3).astype(np.float32)
    path = saved(tmp_path / "warps.nii", warp, 1007)
    series = ws.open_series(path)
    assert len(series) == 3
    np.testing.assert_allclose(series[2].samples, np.linalg.norm(warp[:, :, :, 2], axis=-1).T, rtol=1e-5)
    assert ws.open(path, time=1).facts.n_times == 3


def test_a_component_of_what_has_none_is_refused(tmp_path: Path) -> None:
    path = saved(tmp_path / "scan.nii", SCAN.astype(np.float32))
    with pytest.raises(ArgumentError, match="component='x', but the file holds no vectors"):
        ws.open(path, component="x")
    with pytest.raises(ArgumentError, match="leave out memory="):
        ws.open(saved(tmp_path / "v1.nii", directions()), component="x", memory="1 GB")
