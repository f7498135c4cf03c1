import json
import pickle
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tiff_pixels import tiff_pixels

import wavesplat as ws
from wavesplat._looks.curves.materials_json import preset_names
from wavesplat.errors import ArgumentError, FileError, LibraryError

unit = st.floats(0, 1)
curves = st.lists(st.tuples(st.integers(-50, 50), unit), min_size=1, max_size=5).map(sorted)
CT = ws.Materials.preset("ct")
BONE = ws.Material("bone", [(150, 0), (300, 1)], (1, 0.95, 0.85), 0.4, density=7)


def mixture(materials, values):
    """The mixture, value by value: sum p_i alpha_i rgb_i and sum p_i alpha_i."""
    rows = []
    for value in values:
        claims = []
        for material in materials.materials:
            nodes = [node for node in material.probability if node[0] <= value][-1:]
            nodes += [node for node in material.probability if node[0] > value][:1]
            (a, p), (b, q) = nodes[0], nodes[-1]
            claims.append(p if len(nodes) == 1 else p + (q - p) * (value - a) / (b - a))
        shares = [claim / max(sum(claims), 1) for claim in claims]
        weights = [share * material.opacity for share, material in zip(shares, materials.materials, strict=True)]
        colors = [(*material.color, 1) for material in materials.materials]
        rows.append([sum(w * c[i] for w, c in zip(weights, colors, strict=True)) for i in range(4)])
    return np.array(rows)


def check_mixture(materials, values):
    """Check that the transfer function is the mixture to 1e-3, in associated colour and opacity."""
    rgba = materials.transfer_function()(values)
    rgba[:, :3] *= rgba[:, 3:]
    np.testing.assert_allclose(rgba, mixture(materials, values), rtol=0, atol=1e-3)


@pytest.mark.parametrize("name", preset_names())
def test_presets_are_their_mixture(name):
    check_mixture(ws.Materials.preset(name), np.linspace(-1200, 3000, 8401))


@given(st.lists(st.tuples(curves, st.tuples(unit, unit, unit), unit), min_size=1, max_size=4))
def test_any_materials_are_their_mixture(parts):
    materials = ws.Materials(ws.Material(str(n), *part) for n, part in enumerate(parts))
    check_mixture(materials, np.linspace(-51, 51, 1021))


@pytest.mark.parametrize("faint", [0, 1e-300, 1e-6, 1e-3, 0.1])
def test_colours_of_very_different_opacities_are_followed(faint):
    veil = ws.Material("veil", [(0, 1), (100, 0)], (1, 0, 0), faint)
    solid = ws.Material("solid", [(0, 0), (100, 1)], (0, 0, 1), 1)
    materials = ws.Materials([veil, solid])
    check_mixture(materials, np.concatenate([np.linspace(-1, 101, 10_201), np.geomspace(1e-9, 100, 1000)]))
    assert len(materials.transfer_function().color) < 40


def test_claims_of_more_than_everything_are_scaled():
    materials = ws.Materials(
        [ws.Material("a", [(0, 1), (10, 1)], "white", 1), ws.Material("b", [(0, 0), (10, 1)], "black", 0)]
    )
    np.testing.assert_allclose(materials.percentages([0, 5, 10]), [[1, 0], [2 / 3, 1 / 3], [0.5, 0.5]])
    check_mixture(materials, np.linspace(-1, 11, 1201))


def test_percentages_sum_to_one_where_values_are_claimed():
    np.testing.assert_allclose(CT.percentages(np.linspace(-2000, 4000, 6001)).sum(axis=1), 1, atol=1e-12)
    alone = ws.Materials([BONE]).percentages([0, 225, 1000, np.nan])
    np.testing.assert_allclose(alone, [[0], [0.5], [1], [0]])


def test_what_no_material_claims_is_clear():
    assert ws.Materials([BONE]).transfer_function()([-1000, 100])[:, 3].tolist() == [0, 0]


def test_steps_belong_to_their_upper_side():
    step = ws.Materials([ws.Material("a", [(5, 0), (5, 1)], "white", 0.5)])
    assert step.percentages([5 - 1e-9, 5]).ravel().tolist() == [0, 1]
    np.testing.assert_allclose(step.transfer_function()([4.999, 5])[:, 3], [0, 0.5])


def test_densities_are_places_in_the_list_where_none_is_given():
    materials = ws.Materials([ws.Material("air", [(0, 1), (1, 0)], "black", 0), BONE])
    assert [material.density for material in materials.materials] == [0, 7]


def test_the_unit_of_the_opacities_can_be_changed():
    assert CT.transfer_function().opacity_unit == 1
    assert CT.transfer_function(opacity_unit=2.5).opacity_unit == 2.5


def test_can_be_pickled_and_compared():
    assert pickle.loads(pickle.dumps(CT)) == CT  # noqa: S301 - our own bytes
    assert hash(BONE) == hash(pickle.loads(pickle.dumps(BONE)))  # noqa: S301


@pytest.mark.parametrize("draw", [ws.render, ws.reference.raycast, ws.reference.splat_literal])
def test_materials_draw_the_picture_of_their_transfer_function(draw):
    volume = ws.Volume(ws.examples.ct_pelvis().samples[::4, ::4, ::4], spacing=(12, 12, 12))
    pictures = [draw(volume, curves, size=(24, 24)).rgba for curves in (CT, CT.transfer_function())]
    assert pictures[0][..., 3].max() > 0.1
    np.testing.assert_array_equal(*pictures)


def test_wavelets_are_drawn_with_materials():
    wavelets = ws.WaveletVolume.from_volume(ws.examples.ct_pelvis(), threshold=10)
    pictures = [ws.render(wavelets.level(1), c, size=(24, 24)).rgba for c in (CT, CT.transfer_function())]
    np.testing.assert_array_equal(*pictures)


# JSON ----------------------------------------------------------------------------------------------------------------


@given(
    st.lists(
        st.tuples(st.text(min_size=1), curves, st.tuples(unit, unit, unit), unit), min_size=1, unique_by=lambda m: m[0]
    )
)
def test_json_reads_back_exactly(parts):
    materials = ws.Materials((ws.Material(*part) for part in parts), opacity_unit=0.7)
    assert ws.Materials.from_json(materials.to_json()) == materials


def test_files_read_back_exactly(tmp_path):
    path = tmp_path / "materials.json"
    CT.save(path)
    assert ws.Materials.load(path) == CT
    assert [entry.name for entry in tmp_path.iterdir()] == ["materials.json"]


ENTRY = {"name": "bone", "probability": [[150, 0], [300, 1]], "color": [1, 1, 1], "opacity": 0.4}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"version": 2}, "'version' is 2.*version 1"),
        ({"materials": "bone"}, "'materials' is not a list"),
        ({"materials": []}, "the list is empty"),
        ({"materials": ["bone"]}, "'materials', number 0: 'bone' is not an object"),
        ({"materials": [ENTRY, ENTRY]}, "two are named 'bone'"),
        ({"material": []}, "unknown field 'material'.*materials"),
        ({"opacity_unit": "mm"}, "'opacity_unit' is 'mm'"),
        ({"opacity_unit": True}, "'opacity_unit' is True"),
        ({"opacity_unit": -1}, "opacity_unit.*-1.*positive"),
    ],
)
def test_json_errors_name_the_field(change, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Materials.from_json(json.dumps({"version": 1, "materials": [ENTRY], **change}))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"name": 7}, "number 0: name of a material is 7"),
        ({"probability": 5}, "number 0: material 'bone': probability is 5"),
        ({"probability": []}, "probability curve has no node"),
        ({"probability": [[1]]}, r"node 0 is \[1\].*2 numbers"),
        ({"probability": [[0, 2]]}, "probability between 0 and 1"),
        ({"probability": [[1, 0], [0, 1]]}, "value 0 of probability node 1 is below.*sort"),
        ({"color": [255, 0, 0]}, "color is.*0..1"),
        ({"color": "transparent"}, "color is 'transparent'.*as opacity"),
        ({"color": 3}, "color is 3"),
        ({"opacity": 1.5}, "opacity is 1.5; give a number between 0 and 1"),
        ({"opacity": "thin"}, "opacity is 'thin'"),
        ({"density": "high"}, "density is 'high'; give a finite number"),
        ({"rho": 1}, "number 0: unknown field 'rho'.*density"),
    ],
)
def test_json_errors_name_the_material_and_its_field(change, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Materials.from_json(json.dumps({"version": 1, "materials": [{**ENTRY, **change}]}))


@pytest.mark.parametrize("name", ["name", "probability", "color", "opacity"])
def test_missing_fields_are_named(name):
    entry = {key: value for key, value in ENTRY.items() if key != name}
    with pytest.raises(ArgumentError, match=f"number 0: field '{name}' is missing"):
        ws.Materials.from_json(json.dumps({"version": 1, "materials": [entry]}))


def test_file_errors_end_with_the_path(tmp_path):
    with pytest.raises(FileError, match="cannot read the materials.*nothing.json$"):
        ws.Materials.load(tmp_path / "nothing.json")
    path = tmp_path / "bad.json"
    path.write_text("{}")
    with pytest.raises(ArgumentError, match="'version' is missing.*bad.json$"):
        ws.Materials.load(path)


def test_other_things_are_refused():
    with pytest.raises(ArgumentError, match="number 0 is a str; give a Material"):
        ws.Materials(["bone"])
    with pytest.raises(ArgumentError, match="number 0 is a int"):
        ws.Materials(5)
    with pytest.raises(ArgumentError, match="unknown preset of materials 'mri'; use one of: ct"):
        ws.Materials.preset("mri")


# The fit -------------------------------------------------------------------------------------------------------------

MEANS = (100, 200, 400)


def phantom(noise, scale=1):
    """A phantom of three materials: a ball within a ball within a field, with noise."""
    z, y, x = np.mgrid[-1:1:40j, -1:1:40j, -1:1:40j]
    r2 = x * x + y * y + z * z
    samples = np.select([r2 < 0.15, r2 < 0.6], MEANS[:0:-1], MEANS[0])
    return ws.Volume((samples + np.random.default_rng(5).normal(0, noise, r2.shape)) * scale)


def even(materials):
    """Values where neighbours have equal shares."""
    return [(a[0] + b[0]) / 2 for a, b in (material.probability[:2] for material in materials.materials[1:])]


@pytest.mark.parametrize("scale", [1, 1e-6, 1e6])
@pytest.mark.parametrize("noise", [2, 10, 20])
def test_a_fit_finds_the_materials_of_a_phantom(noise, scale):
    from wavesplat._looks.curves import materials_fit

    volume = phantom(noise, scale)
    mixture = materials_fit._mixture(materials_fit._quantiles(volume, 3), 3)
    np.testing.assert_allclose(np.sort(mixture.means_.ravel()) / scale, MEANS, rtol=0.03)
    fitted = ws.Materials.fit(volume, ["field", "shell", "core"])
    assert fitted.names == ("field", "shell", "core")
    np.testing.assert_allclose(np.array(even(fitted)) / scale, [150, 300], rtol=0.1)
    shares = fitted.percentages(np.array(MEANS) * scale)
    np.testing.assert_allclose(shares, np.eye(3), atol=0.05)


def test_a_fit_is_the_same_every_time():
    assert ws.Materials.fit(phantom(10)) == ws.Materials.fit(phantom(10))


def test_a_fit_claims_every_value_once_and_starts_clear():
    fitted = ws.Materials.fit(phantom(10), 3)
    np.testing.assert_allclose(fitted.percentages(np.linspace(-100, 900, 1001)).sum(axis=1), 1, atol=1e-12)
    assert [material.opacity for material in fitted.materials] == [0, pytest.approx(0.006), pytest.approx(0.6)]


def test_a_fit_tells_the_tissues_of_the_ct_apart():
    fitted = ws.Materials.fit(ws.examples.ct_pelvis(), ["air", "fat", "soft tissue", "bone"])
    shares = fitted.percentages([-1000, -100, 45, 400])
    assert (np.diag(shares) > 0.9).all(), shares


def test_a_fit_takes_holes_wavelets_and_two_slices():
    volume = phantom(10)
    samples = volume.samples.copy()
    samples[:, :, :5], samples[0, 0, 20] = np.nan, np.inf
    slices = samples[20:22]
    wavelets = ws.WaveletVolume.from_volume(volume, threshold=5)
    for given_volume in (ws.Volume(samples), ws.Volume(slices), wavelets):
        np.testing.assert_allclose(even(ws.Materials.fit(given_volume, 3)), [150, 300], rtol=0.15)


@pytest.mark.parametrize(
    ("samples", "materials", "message"),
    [
        (np.full((4, 4, 4), 7.0), 2, "1 different values, too few to tell 2 materials apart"),
        (np.where(np.indices((4, 4, 4)).sum(axis=0) % 2, 1.0, np.nan), 1, "0 different values"),
        (np.arange(64.0).reshape(4, 4, 4), 0, "materials is 0; give a number from 1 to 32"),
        (np.arange(64.0).reshape(4, 4, 4), 2.5, "materials is 2.5"),
        (np.arange(64.0).reshape(4, 4, 4), "bone", "materials is 'bone'.*list of their names"),
        (np.arange(64.0).reshape(4, 4, 4), ["a", "a"], "two are named 'a'"),
    ],
)
def test_what_cannot_be_fitted_is_refused(samples, materials, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Materials.fit(ws.Volume(samples), materials)


def test_one_material_is_clear():
    fitted = ws.Materials.fit(phantom(10), 1)
    assert fitted.percentages([100, 400]).tolist() == [[1], [1]]
    assert fitted.materials[0].opacity == 0


def test_a_fit_without_scikit_learn_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "sklearn.mixture", None)
    with pytest.raises(LibraryError, match=r'sklearn is not installed; .*: pip install "wavesplat\[fit\]"'):
        ws.Materials.fit(phantom(10))


# The command line ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("given_as", ["ct", "fit", "materials.json"])
def test_the_command_line_makes_the_picture_of_the_api(wavesplat, ramp_file, tmp_path, given_as):
    import tifffile

    volume = ws.open(ramp_file)
    materials = ws.Materials.fit(volume) if given_as == "fit" else CT
    CT.save(tmp_path / "materials.json")
    done = wavesplat("render", ramp_file, "-o", "a.tif", "--materials", given_as, "--size", "32x24", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    expected = ws.render(volume, materials, size=(32, 24), background="black")
    np.testing.assert_array_equal(tifffile.imread(tmp_path / "a.tif"), tiff_pixels(expected))


def test_the_command_line_refuses_two_transfer_functions(wavesplat, ramp_file, tmp_path):
    for other in (["--preset", "grey"], ["--tf", "x.json"]):
        done = wavesplat("render", ramp_file, "-o", tmp_path / "a.png", "--materials", "ct", *other)
        assert done.returncode == 2
        assert "--materials say the same thing twice" in done.stderr
