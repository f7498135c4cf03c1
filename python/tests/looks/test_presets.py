import json
import warnings

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks import presets
from wavesplat.errors import ArgumentError, FileError, WavesplatWarning

OURS = [name for name, preset in presets.catalogue().items() if preset.kind != "slicer"]
#: Values that, as Hounsfield units, are neither air, soft tissue nor bone of a scan.
SIGNED = ws.Volume(np.linspace(-3, 5, 12**3, dtype=np.float32).reshape(12, 12, 12))
DENSE = ws.Volume(np.random.default_rng(1).normal(170, 30, (12, 12, 12)).clip(0, 255).astype(np.uint8))
POSITIVE = ws.Volume(np.geomspace(0.1, 1e4, 12**3).reshape(12, 12, 12))


def volume_for(name):
    kind = presets.catalogue()[name].kind
    return {"ct": ws.examples.ct_pelvis(), "mr": ws.examples.mri_head()}.get(kind, POSITIVE)


@pytest.mark.parametrize("name", OURS)
def test_every_preset_of_ours_shows_something(name):
    volume = volume_for(name)
    look = ws.Look.preset(name, volume)
    assert (look.name, look.reason) == (name, presets.catalogue()[name].description)
    alpha = look.transfer_function(np.linspace(*volume.value_range, 500))[:, 3]
    assert alpha.max() > 0.1
    # The background stays clear, except with projections, which give it a colour, and with stains on white.
    assert alpha[0] == 0 or look.composite == "maximum" or name == "em"
    picture = ws.render(
        volume,
        look.transfer_function,
        size=(24, 24),
        shading=look.shading,
        composite=look.composite,
        background=look.background,
    )
    assert np.ptp(picture.rgba[..., :3]) > 0.2


def test_names_do_not_depend_on_case_and_on_what_joins_words():
    want = ws.Look.preset("ct-soft-tissue")
    for name in ("CT-Soft-Tissue", "ct_soft tissue", " CT SOFT_TISSUE "):
        assert ws.Look.preset(name) == want


@pytest.mark.parametrize(
    ("name", "offered"),
    [
        ("bone", "did you mean ct-bone"),
        ("ct-bon", "did you mean ct-bone"),
        ("green", "did you mean fluorescence-green"),
        ("qqqqqqq", "'qqqqqqq'; `wavesplat presets` lists all"),
    ],
)
def test_unknown_names_offer_near_ones(name, offered):
    with pytest.raises(ArgumentError, match=offered):
        ws.Look.preset(name)


@pytest.mark.parametrize("name", ["auto", "mr-head", "pet", "signed", "log", "fluorescence-green"])
def test_fitted_presets_need_a_volume_and_say_so(name):
    with pytest.raises(ArgumentError, match="pass the volume"):
        ws.Look.preset(name)


def test_presets_for_hounsfield_units_warn_of_other_values():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ws.Look.preset("ct-bone", ws.examples.ct_pelvis())
        ws.Look.preset("mr-head", ws.examples.mri_head())
    with pytest.warns(WavesplatWarning, match=r"'ct-bone' is for Hounsfield units.* 0 to .*the file says MR"):
        ws.Look.preset("ct-bone", ws.examples.mri_head())
    with pytest.warns(WavesplatWarning, match=r"'ct-bone' is for Hounsfield units.* -3 to 5.*no air near -1000"):
        ws.Look.preset("ct-bone", SIGNED)


def test_what_the_file_says_of_the_modality_counts_more_than_the_values(monkeypatch):
    monkeypatch.setattr(ws.Volume, "modality", "MR", raising=False)
    with pytest.warns(WavesplatWarning, match="the file says MR"):
        ws.Look.preset("ct-bone", ws.examples.ct_pelvis())
    monkeypatch.setattr(ws.Volume, "modality", "CT")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ws.Look.preset("ct-bone", SIGNED)


def test_the_command_line_makes_one_note_of_it(wavesplat, ramp_file, tmp_path):
    arguments = ("render", ramp_file, "-o", tmp_path / "a.png", "--preset", "CT Bone", "--size", "8x8")
    done = wavesplat(*arguments)
    assert done.returncode == 0
    assert done.stderr.count("is for Hounsfield units") == done.stderr.count("\n") == 1
    assert wavesplat(*arguments, "--quiet").stderr == ""


def test_a_preset_brings_operator_and_background_to_the_command_line(wavesplat, ramp_file, tmp_path):
    import tifffile

    by_preset, by_options = tmp_path / "preset.tif", tmp_path / "options.tif"
    preset = ("--preset", "pet", "--size", "16x16", "--zoom", "0.5")
    assert wavesplat("render", ramp_file, "-o", by_preset, *preset).returncode == 0
    assert wavesplat("render", ramp_file, "-o", by_options, *preset, "--background", "black").returncode == 0
    preset, given = tifffile.imread(by_preset), tifffile.imread(by_options)
    assert preset[0, 0].tolist() == [255, 255, 255]
    assert given[0, 0].tolist() == [0, 0, 0]


# The list and the sheet


def test_the_command_line_lists_all_in_groups(wavesplat):
    done = wavesplat("presets")
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert [line.split()[0] for line in lines if line.startswith("  ")] == list(presets.catalogue())
    assert [line for line in lines if line in presets.GROUPS.values()] == list(presets.GROUPS.values())
    facts = json.loads(wavesplat("presets", "--json").stdout)["presets"]
    assert facts[0]["name"] == "ct-angio"
    assert set(facts[0]) == {"name", "kind", "description"}


@pytest.mark.parametrize(
    ("volume", "has", "lacks"),
    [
        (ws.examples.ct_pelvis(), {"ct-bone", "grey"}, {"mr-head", "CT-AAA", "signed"}),
        (ws.examples.mri_head(), {"mr-head", "grey"}, {"ct-bone", "heat", "signed"}),
        (ws.Volume(ws.examples.mri_head().samples), {"mr-head", "confocal", "heat"}, {"ct-bone", "em", "signed"}),
        (DENSE, {"em", "confocal"}, {"mr-head"}),
        (SIGNED, {"signed", "log"}, {"ct-bone", "pet"}),
        (ws.Volume(POSITIVE.samples - 1e5), {"signed"}, {"log"}),
    ],
)
def test_presets_that_fit_a_volume(volume, has, lacks):
    names = {preset.name for preset in presets.fitting(volume)}
    assert has <= names
    assert not lacks & names


@pytest.mark.parametrize(
    ("modality", "kinds"), [("PT", {"pet", "any"}), ("fluorescence", {"microscopy", "any"}), ("US", {"any"})]
)
def test_what_the_file_says_narrows_the_choice(monkeypatch, modality, kinds):
    monkeypatch.setattr(ws.Volume, "modality", modality)
    monkeypatch.setattr(SIGNED, "_kind", None)  # what was found in it before
    assert {preset.kind for preset in presets.fitting(SIGNED)} == kinds


def test_a_sheet_shows_the_volume_with_each(wavesplat, ramp_file, tmp_path):
    import tifffile

    out = tmp_path / "sheet.tif"
    done = wavesplat("presets", ramp_file, "--sheet", out, "--size", "40x30", "--json")
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout)
    # A ramp of bytes has no noise, so it is a field.
    assert facts["presets"][:2] == ["auto", "confocal"]
    width, height = facts["size"]
    assert (width - 2) // 42 * ((height - 2) // 32) >= len(facts["presets"])
    sheet = tifffile.imread(out)
    assert sheet.shape == (height, width, 3)
    first, second = sheet[2:32, 2:42], sheet[2:32, 44:84]
    assert not np.array_equal(first, second)


def test_a_sheet_needs_a_volume(wavesplat, tmp_path):
    done = wavesplat("presets", "--sheet", tmp_path / "a.png")
    assert done.returncode == 2
    assert "name the volume too" in done.stderr


# Scales


def test_fractions_of_a_signed_range_are_even_about_zero():
    values = [value for value, _ in ws.Look.preset("signed", SIGNED).transfer_function.opacity]
    np.testing.assert_allclose(values, -np.array(values)[::-1])
    assert 4.9 < values[-1] <= 5


def test_a_logarithmic_scale_is_even_in_the_logarithm():
    curves = ws.TransferFunction.from_json(
        '{"version": 1, "values": "log", "opacity": [[0, 0], [1, 1]], "color": [[0, 0, 0, 0], [1, 1, 1, 1]]}', POSITIVE
    )
    low, high = curves.opacity[0][0], curves.opacity[-1][0]
    at = np.geomspace(low, high, 333)
    np.testing.assert_allclose(curves(at)[:, 3], np.linspace(0, 1, 333), atol=0.5 / 255)
    with pytest.raises(ArgumentError, match="no sample is positive"):
        ws.Look.preset("log", ws.Volume(-POSITIVE.samples))


def test_the_scale_of_an_object_leaves_its_background_out():
    rng = np.random.default_rng(3)
    samples = rng.normal(100, 3, (24, 24, 24))
    samples[8:16, 8:16, 8:16] += 200
    curves = ws.TransferFunction.from_json(
        '{"version": 1, "values": "object", "opacity": [[0, 0], [1, 1]], "color": [[0, 1, 1, 1]]}', ws.Volume(samples)
    )
    assert 115 < curves.opacity[0][0] < 285
    assert 300 < curves.opacity[1][0] < 320


def test_a_unit_may_be_a_share_of_the_longest_side():
    text = '{"version": 1, "opacity_unit_share": 0.1, "opacity": [[0, 1]], "color": [[0, 1, 1, 1]]}'
    volume = ws.Volume(np.zeros((4, 5, 6)), spacing=(1, 2, 3))
    assert ws.TransferFunction.from_json(text, volume).opacity_unit == pytest.approx(
        0.9
    )  # from the first sample to the last


def test_other_scales_are_refused():
    with pytest.raises(ArgumentError, match="'values' is 'bogus'; it is one of.*fraction"):
        ws.TransferFunction.from_json('{"version": 1, "values": "bogus", "opacity": [], "color": []}')


# Files


def test_looks_come_back_from_json(tmp_path):
    light = ws.Shading(ambient=0.3, lights=[ws.Light((1, 2, 3), (1, 0.5, 0), "world")], occlusion_radius=2.5)
    curves = ws.TransferFunction([(0, 0), (1, 0.3)], [(0, 1, 0, 0)], 0.25, [(0, 0), (3, 1)])
    table = ws.TransferFunction2D([0, 1], [0, 1], np.full((2, 2, 4), 0.1))
    for function in (curves, table):
        for shading in (light, None):
            look = ws.Look(
                transfer_function=function,
                shading=shading,
                composite="maximum",
                view="left",
                background="#102030",
                name="mine",
                reason="for tests",
            )
            look.save(tmp_path / "look.json")
            assert ws.Look.from_json((tmp_path / "look.json").read_text()) == look
    with pytest.raises(FileError, match="folder does not exist"):
        look.save(tmp_path / "none" / "look.json")


CURVES = '"transfer_function": {"opacity": [[0, 1]], "color": [[0, 1, 1, 1]]}'


def test_what_a_text_leaves_out_is_as_usual():
    look = ws.Look.from_json(f'{{"version": 1, {CURVES}, "shading": {{"diffuse": 0.5}}}}')
    assert look.shading == ws.Shading(diffuse=0.5)
    assert (look.composite, look.view, look.background) == ("over", None, None)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ('{"version": 1}', "'transfer_function' is missing"),
        ('{"version": 1, "transfer_function": 3}', "'transfer_function' is 3; it must be an object"),
        (f'{{"version": 1, {CURVES}, "light": 3}}', "unknown field 'light'"),
        (f'{{"version": 1, {CURVES}, "composite": "under"}}', "'composite' is 'under'; use one of: over"),
        (f'{{"version": 1, {CURVES}, "view": 3}}', "'view' is 3; it must be a text"),
        (f'{{"version": 1, {CURVES}, "shading": 3}}', "'shading' is 3; it must be an object"),
        (f'{{"version": 1, {CURVES}, "shading": {{"glow": 3}}}}', "shading has no 'glow'; it has ambient"),
        (f'{{"version": 1, {CURVES}, "shading": {{"lights": [3]}}}}', "3 is no light"),
        (f'{{"version": 1, {CURVES}, "shading": {{"lights": [{{}}]}}}}', "light is {}.*direction"),
    ],
)
def test_other_texts_are_refused_by_field(text, complaint):
    with pytest.raises(ArgumentError, match=complaint):
        ws.Look.from_json(text)
