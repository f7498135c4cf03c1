"""The default look and view of a volume, and the light."""

import subprocess
import sys
from typing import get_args

import numpy as np
import pytest
from PIL import Image

import wavesplat as ws
from wavesplat import _native
from wavesplat._model.arguments.sampling import Composite

RNG = np.random.default_rng(5)
X, Y, Z = np.meshgrid(*[np.linspace(-1, 1, 48)] * 3, indexing="ij")[::-1]
BALL = (X * X + Y * Y + Z * Z < 0.5).astype(np.int32)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def noise(scale):
    return RNG.normal(0, scale, BALL.shape)


def ct():
    values = np.full(BALL.shape, -1000.0) + noise(20)
    values[BALL > 0] = 40 + noise(20)[BALL > 0]
    values[(np.abs(X) < 0.12) & (np.abs(Y) < 0.12)] = 900
    return values.astype(np.int16)


def pet():
    values = np.abs(noise(30)) + 800 * BALL
    values[20:26, 20:26, 20:26] = 30_000
    return values.astype(np.float32)


def spots():
    values = noise(5) + 100
    for at in RNG.uniform(-0.7, 0.7, (12, 3)):
        values += 900 * np.exp(-((X - at[0]) ** 2 + (Y - at[1]) ** 2 + (Z - at[2]) ** 2) / 0.01)
    return values.astype(np.float32)


SIGNED = (np.sin(5 * X) * np.cos(4 * Y) * np.exp(-2 * Z * Z)).astype(np.float32)
PATIENT = ws.Facts(unit="mm", is_anatomical=True)
CASES = {
    "CT": (ct(), PATIENT),
    "CT that says so": (ct(), ws.Facts(unit="mm", is_anatomical=True, modality="CT")),
    "MR": (np.abs(noise(5) + 120 * BALL).astype(np.int16), PATIENT),
    "PET": (pet(), PATIENT),
    "PET that says so": ((100 * BALL + np.abs(noise(9))).astype(np.uint16), ws.Facts(modality="PT")),
    "dose": ((70 * np.exp(-3 * (X**2 + Y**2 + Z**2))).astype(np.float32), ws.Facts(modality="RTDOSE", value_unit="Gy")),
    "ultrasound": ((90 * BALL + np.abs(noise(30))).astype(np.uint8), ws.Facts(modality="US")),
    "fluorescence": (spots().astype(np.uint16), ws.Facts(unit="um")),
    "EM": (np.clip(170 + noise(25), 0, 255).astype(np.uint8), ws.Facts(unit="nm")),
    "signed field": (SIGNED, ws.Facts()),
    "field": (spots(), ws.Facts()),
    "mask": (BALL.astype(np.uint8), ws.Facts()),
    "labels": ((BALL * (1 + (X > 0) + 2 * (Y > 0))).astype(np.uint8), ws.Facts()),
    "scan": ((120 * BALL + np.abs(noise(9))).astype(np.uint8), ws.Facts()),
}


def volume(name, spacing=(2.0, 2.0, 2.0)):
    samples, facts = CASES[name]
    return ws.Volume(samples, spacing=spacing, facts=facts)


def first_picture(shown, **options):
    return ws.render(shown, size=(96, 96), background=options.pop("background", "black"), **options)


@pytest.mark.parametrize("name", CASES)
def test_the_kind_of_data_is_told_and_the_picture_is_bright(name):
    picture = first_picture(volume(name))
    kind = name.removesuffix(" that says so")
    words = {"signed field": "two signs", "field": "floating-point", "EM": "dense", "scan": "no fixed scale"}
    assert words.get(kind, kind) in picture.report["look"]["reason"]
    luminance = picture.rgba[..., :3] @ LUMINANCE
    assert luminance.max() > (0.5 if kind == "dose" else 0.7)  # the hottest doses are red, which is darker than white
    assert (picture.rgba[..., 3] > 0.05).mean() > 0.02


def test_what_the_file_says_comes_before_what_values_look_like():
    said = ws.Look.auto(volume("CT that says so")).reason
    assert "the file says CT" in said
    assert "the file says" not in ws.Look.auto(volume("CT")).reason
    assert ws.Look.auto(volume("PET that says so")).reason == "PET: the file says PT"
    # The scale of a CT that was windowed to 8 bits is not known.
    samples = np.clip((ct() + 200) / 6, 0, 255).astype(np.uint8)
    windowed = ws.Volume(samples, facts=ws.Facts(unit="mm", is_anatomical=True, modality="CT"))
    assert ws.Look.auto(windowed).reason == "a scan of no fixed scale"


def test_a_channel_that_the_file_names_is_shown_in_its_colour():
    facts = ws.Facts(channel=ws.Channel("Abeta", color=(1, 0, 1)))
    picture = first_picture(ws.Volume(spots(), facts=facts))
    assert "the file names channels" in picture.report["look"]["reason"]
    red, green, blue = picture.rgba[..., :3].reshape(-1, 3).sum(axis=0)
    assert red > 1.2 * green
    assert blue > 1.2 * green


def test_bone_shows_through_soft_tissue():
    seen = first_picture(volume("CT"), camera="top")
    red, green, blue = (seen.rgba[48, 48, c] for c in range(3))
    assert min(red, green, blue) > 0.5
    beside = seen.rgba[48, 76, :3]  # beyond the rod, whose faces to the sides are seen beside it
    assert beside @ LUMINANCE < 0.6 * (seen.rgba[48, 48, :3] @ LUMINANCE)
    assert beside[0] > 0.02


def test_a_dose_is_told_from_mr_and_shown_in_its_colours_fault_14():
    dose = volume("dose")
    look = ws.Look.auto(dose)
    assert look.reason == "dose map: the file says RTDOSE"
    values = np.array([5.0, 20.0, 45.0, 68.0])  # Gy, the largest is 70
    red, green, blue, alpha = look.transfer_function(values).T
    assert alpha[0] == 0
    assert (np.diff(alpha) > 0).all()
    assert blue[1] > red[1]  # cold
    assert red[3] > 2 * max(green[3], blue[3])  # hot
    assert first_picture(dose).report["shown"][0]["values"] == "Gy"


@pytest.mark.parametrize(("name", "n"), [("CT", 2), ("CT that says so", 4), ("MR", 3), ("ultrasound", 2), ("scan", 4)])
def test_a_few_slices_are_not_dark_fault_17(name, n):
    samples, facts = CASES[name]
    flat = ws.Volume(samples[20 : 20 + n], spacing=(1, 1, 5), facts=facts)
    picture = first_picture(flat)
    assert f"{n} slices in greys" in picture.report["look"]["reason"]
    luminance = 255 * (picture.rgba[..., :3] @ LUMINANCE)[picture.rgba[..., 3] > 0.5]
    assert np.percentile(luminance, 99) > 200
    # More slices have the look of their kind.
    assert "greys" not in ws.Look.auto(ws.Volume(samples[20:30], facts=facts)).reason


def test_rounding_below_zero_beside_high_peaks_is_no_second_sign():
    """The density of the cores of atoms: nothing but rounding between them, which falls to both sides of 0."""
    values = np.random.default_rng(1).normal(0, 1e-4, (20, 20, 20))
    values[0, 0, 0] = 2000
    assert "two signs" not in ws.Look.auto(ws.Volume(values)).reason
    values[0, 0, 10] = -1000
    assert "two signs" in ws.Look.auto(ws.Volume(values)).reason


def test_a_field_with_two_signs_shows_both():
    rgba = first_picture(volume("signed field")).rgba
    red, blue = rgba[..., 0] - rgba[..., 2], rgba[..., 2] - rgba[..., 0]
    assert (red > 0.2).mean() > 0.05
    assert (blue > 0.2).mean() > 0.05


def test_pet_is_black_on_white_as_radiology_reads_it():
    shown = volume("PET")
    picture = ws.render(shown, size=(64, 64))
    luminance = picture.rgba[..., :3] @ LUMINANCE
    hottest, faint = np.nanargmax(picture.value), luminance[(picture.value > 500) & (picture.value < 1000)]
    assert luminance.ravel()[hottest] == luminance.min() < 0.05
    assert 0.5 < np.median(faint) < 0.97
    assert luminance[0, 0] > 0.999


def test_the_air_of_a_pet_is_as_white_as_the_page():
    """The largest noise along a ray is no 0, so the box of the scan was grey on white."""
    rng = np.random.default_rng(3)
    z, y, x = np.mgrid[-1:1:60j, -1:1:48j, -1:1:48j]
    body = (x / 0.5) ** 2 + (y / 0.4) ** 2 < 1
    hot = (x - 0.1) ** 2 + y**2 + (z - 0.3) ** 2 < 0.01
    activity = np.where(hot, 60000, np.where(body, 2500, 0)) + np.abs(rng.normal(0, 60, body.shape))
    facts = ws.Facts(modality="PT", is_anatomical=True, unit="mm")
    scan = ws.Volume(activity.astype(np.float32), spacing=(3.5, 3.5, 3.5), facts=facts)
    rgb = ws.render(scan, None, "anterior", size=(96, 96)).rgba[..., :3]
    middle = rgb[48]
    beside = middle[: int(96 * 0.2)]
    assert np.array_equal(np.round(255 * beside), np.full_like(beside, 255.0))
    assert np.round(255 * middle[48].max()) < 250  # the body is seen


@pytest.mark.parametrize("composite", ["maximum", "mean", "sum"])
def test_projections_on_white_are_inverted(composite):
    shown = volume("PET")
    on_white, on_black = (
        ws.render(shown, composite=composite, size=(64, 64), background=behind) for behind in ("white", "black")
    )
    # Without the outermost pixels, which walls of the volume cover only in part.
    known = np.pad(np.isfinite(on_white.value), 1)
    inside = known[1:-1, 1:-1] & known[:-2, 1:-1] & known[2:, 1:-1] & known[1:-1, :-2] & known[1:-1, 2:]
    order = np.argsort(on_white.value[inside])
    white, black = ((picture.rgba[..., :3] @ LUMINANCE)[inside][order] for picture in (on_white, on_black))
    # On white larger values are never brighter, and on black never darker.
    assert (np.diff(white) < 1e-3).all()
    assert (np.diff(black) > -1e-3).all()
    assert white[0] > 0.9
    assert white[-1] < 0.1


def test_the_command_line_inverts_projections_on_white_too(tmp_path):
    file, out = tmp_path / "pet.npy", tmp_path / "pet.png"
    np.save(file, pet())
    command = [sys.executable, "-m", "wavesplat", "render", str(file), "--composite", "mip", "--background", "white"]
    subprocess.run([*command, "--size", "64x64", "-q", "-o", str(out)], check=True)
    grey = np.asarray(Image.open(out).convert("L"))
    assert grey[0, 0] == 255
    # The object is darker than what is around it, and the hottest spot is black.
    assert np.median(grey[24:40, 24:40]) < 240
    assert grey.min() < 30


def test_labels_have_colours_and_a_cut_face_is_lit():
    shown = volume("labels")
    whole = first_picture(shown)
    hues = {tuple(np.round(pixel[:3] / max(pixel[:3].max(), 1e-3), 1)) for pixel in whole.rgba[::6, ::6].reshape(-1, 4)}
    assert len(hues) > 4
    face = first_picture(shown, camera="xy", clip=ws.ClipPlane((48, 48, 48), (0, 0, -1)))
    outside = first_picture(shown, camera="xy")
    at = (slice(40, 44), slice(40, 44))
    assert face.rgba[at][..., :3].mean() > 0.5 * outside.rgba[at][..., :3].mean()


def test_a_volume_of_one_value_has_no_look():
    with pytest.raises(ws.errors.ArgumentError, match="every sample is 7"):
        ws.Look.auto(ws.Volume(np.full((4, 4, 4), 7, np.uint8)))


def test_looks_are_chosen_for_every_operator():
    for name in get_args(Composite):
        assert _native.look_refused((0.0, 1.0), False, name) is None
    with pytest.raises(ws.errors.ArgumentError, match="unknown composite operator 'nope'") as refused:
        _native.look_refused((0.0, 1.0), False, "nope")
    assert set(str(refused.value).partition("one of: ")[2].split(", ")) == set(get_args(Composite))


def test_operators_of_looks_are_names_or_synonyms():
    volume = ws.examples.ripples(16)
    assert ws.Look.auto(volume, "mip").composite == "maximum"
    assert ws.Look.auto(volume, "average").transfer_function == ws.Look.auto(volume, "mean").transfer_function
    function = ws.Look.auto(volume).transfer_function
    layers = [ws.Layer(volume), ws.Layer(volume, ws.Look(transfer_function=function, composite="mip"))]
    assert ws.Scene(layers).render(composite="over", size=(8, 8)).size == (8, 8)
    for made in (
        lambda: ws.Look.auto(volume, "nope"),
        lambda: ws.Look.auto(volume, ""),
        lambda: ws.Look.channel(volume, composite="nope"),
        lambda: ws.Look(transfer_function=function, composite="nope"),
    ):
        with pytest.raises(ws.errors.ArgumentError, match=r"unknown composite operator .*; use one of: over, "):
            made()


@pytest.mark.parametrize(
    ("shape", "anatomical", "view"),
    [
        ((40, 44, 42), True, "anterior"),
        ((40, 44, 42), False, "isometric"),
        ((5, 40, 40), False, "xy"),
        ((40, 5, 40), False, "xz"),
        ((40, 40, 5), False, "yz"),
        ((5, 40, 40), True, "inferior"),
        ((40, 40, 5), True, "left"),
    ],
)
def test_the_view_suits_the_data(shape, anatomical, view):
    shown = ws.Volume(RNG.integers(0, 255, shape, dtype=np.uint8), anatomical=anatomical)
    look = ws.Look.auto(shown, "over")  # a block is cut open else, and seen from its corner
    by_itself, named = (ws.render(shown, look, size=(48, 48), camera=camera).rgba for camera in (None, view))
    assert (by_itself == named).all()
    if min(shape) == 5:
        assert (by_itself[..., 3] > 0.1).mean() > 0.4


@pytest.mark.parametrize("name", ["front", "left", "isometric", "xy"])
def test_the_object_fills_nine_tenths_of_the_picture(name):
    samples = np.zeros((60, 60, 60), np.uint8)
    samples[34:50, 10:22, 8:20] = 200
    rgba = ws.render(ws.Volume(samples), camera=name, size=(120, 90)).rgba
    seen = np.argwhere(rgba[..., 3] > 0.1)
    height, width = np.ptp(seen, axis=0) + 1
    assert 0.82 < max(height / 90, width / 120) < 0.96
    middle = (seen.max(axis=0) + seen.min(axis=0)) / 2
    assert np.abs(middle - [44.5, 59.5]).max() < 3


def test_a_crop_is_framed():
    shown = volume("scan")
    small = ws.Crop((8, 8, 8), (20, 20, 20), space="index")
    rgba = ws.render(shown, camera="xy", size=(60, 60), clip=small, composite="mean").rgba
    assert (rgba[..., 3] > 0).mean() > 0.7


def test_smoothed_gradients_take_the_rings_of_voxels_off_the_skin():
    scan = ws.examples.ct_pelvis()
    skin = ws.TransferFunction([(-350, 0), (-250, 1)], [(0, 0.95, 0.8, 0.7)])
    eye = ws.Camera.orbit(scan, 20, 10, zoom=2.2, fit="view")
    plain = {"specular": 0.0, "shoulder": 1.0}
    contrast, alpha = [], []
    for smoothing in (0, ws.Shading().gradient_smoothing):
        light = ws.Shading(gradient_smoothing=smoothing, **plain)
        picture = ws.render(scan, skin, eye, size=(384, 384), quality="high", shading=light)
        patch = (picture.rgba[..., :3] @ LUMINANCE)[110:270, 110:270]
        contrast.append((_mean_of(patch, 3) - _mean_of(patch, 25))[25:-25, 25:-25].std())
        alpha.append(picture.rgba[..., 3])
    assert contrast[1] < contrast[0] / 3
    # Light does not move edges.
    assert (alpha[0] == alpha[1]).all()


def _mean_of(patch, n):
    weights = np.full(n, 1 / n)
    for axis in (0, 1):
        patch = np.apply_along_axis(np.convolve, axis, patch, weights, "same")
    return patch


def test_the_light_of_other_renderers_is_there_by_name():
    light = ws.Shading.headlight(specular=0.5)
    assert (light.ambient, light.specular, light.shoulder, light.gradient_smoothing) == (0.1, 0.5, 1.0, 0.0)
    assert light.lights == (ws.Light((0, 0, 1)),)
    assert ws.Shading().changed(ambient=0.5).ambient == 0.5
    with pytest.raises(ws.errors.ArgumentError, match="exposure"):
        ws.Shading(exposure=-1)
    with pytest.raises(ws.errors.ArgumentError, match="gradient_smoothing"):
        ws.Shading(gradient_smoothing=3)


def test_highlights_keep_below_white_and_exposure_scales_all_light():
    shown = volume("mask")
    bright = first_picture(shown, shading=ws.Shading(exposure=4.0)).rgba
    assert 0.9 < bright[..., :3].max() < 1
    dark = first_picture(shown, shading=ws.Shading(exposure=0.1)).rgba
    usual = first_picture(shown, shading=ws.Shading(exposure=0.2)).rgba
    assert np.allclose(2 * dark[..., :3], usual[..., :3], atol=1e-5)


@pytest.mark.parametrize("name", ["CT", "scan", "mask", "labels"])
def test_draft_has_no_holes(name):
    shown = volume(name)
    draft, normal = (first_picture(shown, quality=quality).rgba[..., :3] for quality in ("draft", "normal"))
    assert -10 * np.log10(np.mean((draft - normal) ** 2)) > 25


def test_skin_that_is_brighter_than_the_brain_is_not_white():
    """The clinic's "bald heads": fat is the brightest seventh of a T1 scan, and was white all over."""
    r = np.sqrt(X * X + Y * Y + Z * Z)
    head = np.where(r < 0.65, 500, np.where(r < 0.75, 250, np.where(r < 0.85, 1000, 0))) * (
        1 + 0.05 * RNG.normal(size=r.shape)
    )
    volume = ws.Volume(np.abs(head + noise(20)).astype(np.int16), facts=PATIENT)
    look = ws.Look.auto(volume)
    red, _, blue = look.transfer_function([1000])[0, :3]
    assert red - blue > 0.15, "skin has a hue"
    assert (look.transfer_function([np.percentile(volume.samples, 99.99)])[0, :3] > 0.9).all(), (
        "white is left to the top"
    )
    rgb = ws.render(volume, size=(64, 64)).rgba[..., :3]
    luminance = 255 * (rgb @ LUMINANCE)[rgb.max(axis=2) > 0.1]
    assert 130 < luminance.mean() < 180
