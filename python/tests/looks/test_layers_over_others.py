"""Layers over another volume hide nothing but where their values are high: all presets, all colour maps."""

import warnings

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks import presets
from wavesplat._looks.curves.colormaps import is_diverging
from wavesplat._looks.kinds.overlays import cleared
from wavesplat._scene.drawing.looks_of_layers import look_over_others
from wavesplat.errors import ArgumentError, WavesplatWarning

SIZE = (40, 40)
#: Pixels that must be as without the layer, of those outside of the spots; and what counts as the same, of 255.
SHARE, LEVELS = 0.9, 10
N = 24
#: Presets for low values: what they show is at the low end, and their background at the high one.
SHOW_LOW_VALUES = ("em", "CT-Air")
SPOT = (slice(8, 14),) * 3


def made(background, low, high, name, modality=None):
    """A volume of one value, with a hot spot; and a cold one where the low end is below the background."""
    rng = np.random.default_rng(7)
    samples = np.full((N, N, N), background, np.float32)
    samples[SPOT] = rng.uniform(background + 0.3 * (high - background), high, (6, 6, 6))
    if low < background:
        samples[15:18, 15:18, 15:18] = rng.uniform(low, background + 0.3 * (low - background), (3, 3, 3))
    facts = ws.Facts(modality=modality)
    return ws.Volume(samples, spacing=(2, 2, 2), unit="mm", anatomical=True, facts=facts, name=name)


@pytest.fixture(scope="module")
def scan():
    z, y, x = np.indices((N, N, N))
    samples = (300 + 40 * z - 25 * y + 15 * x).astype(np.float32)
    samples[np.hypot(np.hypot(x - 11, y - 12), z - 13) > 11] = 0
    return ws.Volume(samples, spacing=(2, 2, 2), unit="mm", anatomical=True, name="scan")


@pytest.fixture(scope="module")
def matter():
    return ws.TransferFunction([(100, 0), (300, 0.03)], [(0, 0.3, 0.2, 0.1), (1200, 1, 1, 0.9)], opacity_unit=2.0)


@pytest.fixture(scope="module")
def layers():
    """Layers with their background at the lowest value, for Hounsfield units, for two signs, and at the highest."""
    return {
        "hounsfield": made(-1000, -1000, 2500, "CT", "CT"),
        "any": made(0, 0, 8, "uptake"),
        "signed": made(0, -10, 10, "activation"),
        "dark": made(8, 0, 8, "stain"),
        "airy": made(100, -1000, 100, "CT", "CT"),
    }


def pictures(scan, matter, *others):
    """A picture in space and a slice, 0..255."""
    scene = ws.Scene([ws.Layer(scan, matter), *others], background="black")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WavesplatWarning)
        camera = ws.Camera.view(scan, "front")
        both = scene.render(camera, size=SIZE, quality="draft"), ws.slice(scene, "coronal", 22, size=SIZE)
    return [255 * picture.rgba[..., :3] for picture in both]


def outside(spots):
    """Pixels outside of the spots, with a margin of three samples; x grows to the left, z upwards."""
    place = np.linspace(0, N - 1, SIZE[0])[::-1]
    inside = np.zeros(SIZE, bool)
    for lower, upper in spots:
        near = (place > lower - 3) & (place < upper + 2)
        inside |= near[:, None] & near[None, :]
    return ~inside


def shares_unchanged(alone, both, *, has_two_spots=False):
    """Share of the pixels outside of the spots that are as without the layer, in space and on a slice."""
    is_outside = outside([(8, 14), (15, 18)] if has_two_spots else [(8, 14)])
    pairs = zip(alone, both, strict=True)
    return [float((np.abs(one - other).max(axis=2) <= LEVELS)[is_outside].mean()) for one, other in pairs]


def changed_most(alone, both):
    """Largest change of a pixel, in space and on a slice."""
    return [float(np.abs(one - other).max()) for one, other in zip(alone, both, strict=True)]


@pytest.fixture(scope="module")
def alone(scan, matter):
    return pictures(scan, matter)


def layer_for(name, layers):
    entry = presets.catalogue().get(name)
    if name in SHOW_LOW_VALUES:
        kind = "airy" if entry.is_hounsfield else "dark"
    elif name == "signed":
        kind = "signed"
    else:
        kind = "hounsfield" if entry is not None and entry.is_hounsfield else "any"
    return layers[kind]


@pytest.mark.parametrize("name", presets.names())
def test_no_preset_hides_the_rest_fault_1(scan, matter, alone, layers, name):
    layer = layer_for(name, layers)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WavesplatWarning)
        look = ws.Look.preset(name, layer)
    found = pictures(scan, matter, ws.Layer(layer, look))
    shares = shares_unchanged(alone, found, has_two_spots=name == "signed" or name in SHOW_LOW_VALUES)
    assert min(shares) >= SHARE, shares
    if name != "auto":  # which is chosen for layers without a look
        again = pictures(scan, matter, ws.Layer(layer, name.upper()))
        assert all(np.array_equal(one, other) for one, other in zip(found, again, strict=True))


@pytest.mark.parametrize("look", ["pet", "pet-hot-iron", "grey", None, "heat"])
def test_the_spot_shows_in_what_is_for_uptake(scan, matter, alone, layers, look):
    assert min(changed_most(alone, pictures(scan, matter, ws.Layer(layers["any"], look)))) > 40


def maps(nth):
    import cmap

    return sorted(cmap.Catalog().unique_keys())[::nth]


def test_no_colour_map_hides_the_rest(scan, matter, alone, layers, is_night):
    """Maps, without a window and with one, over values of one sign and of two: all at night, a tenth by day."""
    hidden, pale = [], []
    for name in maps(1 if is_night else 10):
        for kind, window in (("any", None), ("any", (1.0, 8.0)), ("signed", None), ("signed", (-10.0, 10.0))):
            if (kind == "signed") != is_diverging(name) and kind == "signed":
                continue  # their background is in the middle of a map that has none
            found = pictures(scan, matter, ws.Layer.overlay(layers[kind], name, window))
            shares = shares_unchanged(alone, found, has_two_spots=kind == "signed")
            if min(shares) < SHARE:
                hidden.append((name, kind, window, shares))
            if changed_most(alone, found)[1] < 15:
                pale.append((name, kind, window))
    assert hidden == []
    assert pale == []


@pytest.mark.parametrize("color", ["red", "#3050ff", "white"])
def test_no_colour_hides_the_rest(scan, matter, alone, layers, color):
    found = pictures(scan, matter, ws.Layer.overlay(layers["any"], color))
    assert min(shares_unchanged(alone, found)) >= SHARE


# Diverging maps


@pytest.mark.parametrize("name", ["coolwarm", "RdBu_r", "cmocean:balance", "vanimo"])
def test_a_diverging_map_is_clear_at_its_centre_fault_8(layers, name):
    function = ws.Layer.overlay(layers["signed"], name, (-10, 10)).look.transfer_function
    below, zero, above = function([-10, 0, 10])[:, 3]
    assert (below, zero, above) == (1, 0, 1)
    symmetric = ws.Layer.overlay(layers["signed"], name).look.transfer_function
    assert symmetric.color[0][0] == -symmetric.color[-1][0]
    assert symmetric([0])[0, 3] == 0


def test_the_corner_of_a_signed_layer_stays_black_fault_8(layers):
    anatomy = ws.Volume(np.pad(np.full((16, 16, 16), 500, np.float32), 4), spacing=(2, 2, 2), unit="mm")
    layer = ws.Layer.overlay(layers["signed"], "coolwarm", (-10, 10))
    for picture in (
        ws.slice([anatomy, layer], size=SIZE),
        ws.render(ws.Scene([anatomy, layer], background="black"), size=SIZE),
    ):
        assert picture.rgba[0, 0, :3].max() == 0


def test_a_window_of_one_sign_is_a_dead_zone_of_both(layers):
    function = ws.Layer.overlay(layers["signed"], "coolwarm", (3, 10)).look.transfer_function
    values = [-12, -10, -6.5, -3, -2.9, 0, 2.9, 3, 6.5, 10, 12]
    np.testing.assert_allclose(function(values)[:, 3], [1, 1, 0.5, 0, 0, 0, 0, 0, 0.5, 1, 1], atol=1e-6)
    blue, red = function([-10, 10])[:, :3]
    assert blue[2] > 2 * blue[0]
    assert red[0] > 2 * red[2]
    # The map's halves begin where the dead zone ends.
    pale = function([-3, 3])[:, :3]
    assert np.abs(pale[0] - pale[1]).max() < 0.05


def test_a_window_from_zero_has_no_dead_zone(layers):
    function = ws.Layer.overlay(layers["signed"], "coolwarm", (0, 10)).look.transfer_function
    assert function([0])[0, 3] == 0
    assert (function([-10, 10])[:, 3] == 1).all()


def test_two_signs_of_unequal_length_part_at_zero(layers):
    function = ws.Layer.overlay(layers["signed"], "coolwarm", (-5, 10)).look.transfer_function
    assert function([-5, 0, 10])[:, 3].tolist() == [1, 0, 1]
    pale = function([0])[0, :3]
    assert pale.max() - pale.min() < 0.1


def test_a_diverging_map_of_values_of_one_sign_is_clear_at_the_lowest():
    distances = made(40, 40, 80, "distances")
    function = ws.Layer.overlay(distances, "coolwarm").look.transfer_function
    assert function([40])[0, 3] == 0
    assert function([80])[0, 3] > 0.9


@pytest.mark.parametrize(("high", "offered"), [(-3, "give -10,10, or 3,10 for"), (0, "give -10,10, or 0,10 for")])
def test_a_window_without_positive_values_is_refused(layers, high, offered):
    with pytest.raises(ArgumentError, match=f"the window -10,{high} .* has no positive values; {offered}"):
        ws.Layer.overlay(layers["signed"], "coolwarm", (-10, high))


@pytest.mark.parametrize("look", [("coolwarm", (-10, 10)), ("coolwarm", (3, 10)), ("coolwarm", None), ("signed", None)])
def test_the_lowest_of_two_signs_shows_as_the_highest_does(look):
    """The values furthest below 0 were cleared as background is, over another volume: fault 8, second half."""
    samples = np.broadcast_to(np.linspace(-12, 12, 25, dtype=np.float32), (8, 8, 25)).copy()
    values, under = ws.Volume(samples, name="z"), ws.Volume(np.zeros((8, 8, 25), np.uint8), name="anatomy")
    layer = ws.Layer.overlay(values, *look)
    curves = look_over_others(layer.look, values, "over").transfer_function
    magnitudes = np.array([12.0, 11, 9, 7])
    np.testing.assert_allclose(curves(-magnitudes)[:, 3], curves(magnitudes)[:, 3], atol=1e-6)
    row = ws.slice([under, layer], clim=(0, 1)).rgba[4, :, :3]
    assert row[0].max() > 0.5
    assert row[-1].max() > 0.5


# Thresholds of statistics


def ramp():
    """Values from -12 to 12 along x, a quarter apart."""
    return ws.Volume(np.broadcast_to(np.linspace(-12, 12, 97, dtype=np.float32), (4, 4, 97)).copy(), name="z")


@pytest.mark.parametrize(
    ("look", "window", "signs"),
    [
        (None, None, 2),
        ("coolwarm", (-10, 10), 2),
        ("coolwarm", (3, 10), 2),
        ("signed", None, 2),
        ("RdBu_r", None, 2),
        ("hot", (0, 10), 1),
        ("hot", None, 1),
        ("red", (0, 8), 1),
        (None, (0, 8), 1),
    ],
)
def test_below_its_threshold_a_statistic_is_hidden_and_above_it_whole(look, window, signs):
    values = ramp()
    layer = ws.Layer.overlay(values, look, window, threshold=3.1)
    curves = look_over_others(layer.look, values, "over").transfer_function
    found = curves([-11, -3.2, -3, 0, 3, 3.2, 11])[:, 3]
    outer = 1 if signs == 2 else found[0]
    np.testing.assert_array_equal(found[2:], [0, 0, 0, 1, 1])
    np.testing.assert_array_equal(found[:2], outer)
    if look == "hot" and window is not None:
        assert outer == 0
    if look is not None:
        without = ws.Layer.overlay(values, look, window).look.transfer_function
        assert layer.look.transfer_function.color == without.color


@pytest.mark.parametrize("highest", [0.0, -1.0])
def test_without_positive_values_a_threshold_shows_the_negative_ones(highest):
    """The map was "hot" then, which hid all values below the threshold, so all of them."""
    values = ws.Volume(np.broadcast_to(np.linspace(-12, highest, 49, dtype=np.float32), (4, 4, 49)).copy(), name="z")
    curves = ws.Layer.overlay(values, threshold=3.1).look.transfer_function
    np.testing.assert_array_equal(curves([-11, -3.2, -3, -1, 0])[:, 3], [1, 1, 0, 0, 0])
    assert curves([-11])[0, 2] > curves([-11])[0, 0], "cold"


def test_a_threshold_hides_to_the_pixel_and_shows_at_full_opacity():
    values = ramp()
    under = ws.Volume(np.full((4, 4, 97), 7, np.uint8), name="anatomy")
    plain = ws.slice(under, clim=(0, 10)).rgba
    over = ws.slice([under, ws.Layer.overlay(values, "coolwarm", (-10, 10), threshold=3)], clim=(0, 10))
    z = np.linspace(-12, 12, 97)
    changed = (over.rgba != plain).any(axis=-1)[2]
    np.testing.assert_array_equal(changed[np.abs(z) < 3], False)
    np.testing.assert_array_equal(changed[np.abs(z) > 3], True)
    colors = ws.TransferFunction.from_colormap("coolwarm", clim=(-10, 10), opacity=1.0)(z)[:, :3]
    np.testing.assert_allclose(over.rgba[2, np.abs(z) > 3, :3], colors[np.abs(z) > 3], atol=1e-3)


@pytest.mark.parametrize(
    ("look", "threshold", "message"),
    [
        ("coolwarm", -3, "values between -T and T are hidden, so give a positive T"),
        ("hot", float("nan"), "finite"),
        ("nonsense", 3, "the look of a layer"),
    ],
)
def test_thresholds_that_cannot_be(look, threshold, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Layer.overlay(ramp(), look, threshold=threshold)


# Looks of layers


def test_a_layer_without_a_look_is_hot_in_space_and_on_slices_fault_22(scan, matter):
    pet = made(0, 0, 8, "pet", "PT")
    scene = ws.Scene([ws.Layer(scan, matter), pet])
    in_space = scene.render("front", size=SIZE, quality="draft").report["shown"][1]["transfer_function"]
    on_slice = ws.slice(scene, size=SIZE).report["shown"][1]["transfer_function"]
    assert in_space == on_slice
    hot = ws.TransferFunction.from_colormap("hot", clim=(0, 1))
    np.testing.assert_allclose([one[1:] for one in in_space["color"]], [one[1:] for one in hot.color], atol=1e-6)


def test_looks_of_ones_own_stay(layers):
    solid = ws.TransferFunction([(0, 1.0)], [(0, 1, 0, 0)])
    own = ws.Look(transfer_function=solid)
    assert cleared(own, layers["any"], "over") is own


def test_white_of_a_projection_adds_no_light(scan, layers):
    camera = ws.Camera.view(scan, "front")
    alone, both = (
        255 * ws.Scene([ws.Layer(scan, "grey"), *others]).render(camera, size=SIZE, composite="maximum").rgba[..., :3]
        for others in ([], [ws.Layer(layers["any"], "pet")])
    )
    assert shares_unchanged([alone], [both])[0] >= SHARE
    assert changed_most([alone], [both])[0] > 20


def test_a_saved_picture_keeps_the_look_that_was_drawn(scan, matter, layers, tmp_path):
    scene = ws.Scene([ws.Layer(scan, matter), ws.Layer(layers["any"], "pet-hot-iron")], background="black")
    report = scene.render("front", size=SIZE).report
    again = report["scene"]["layers"][1]["look"]
    assert again["composite"] == "over"
    assert again["transfer_function"]["opacity"][0][1] == 0


def test_a_layer_beside_the_slice_has_no_colour_bar_fault_18(scan):
    samples = np.zeros((4, N, N), np.float32)
    samples[2, 5:15, 5:15] = 8
    head = ws.Volume(samples, spacing=(2, 2, 2), unit="mm", anatomical=True, name="head")
    shown = ws.slice([scan, head], "axial", 4).report["shown"]
    beside = ws.slice([scan, head], "axial", 30).report
    assert [layer["name"] for layer in shown] == ["scan", "head"]
    assert [layer["name"] for layer in beside["shown"]] == ["scan"]
    assert "the layer 'head' does not show: no part of it lies in the picture" in beside["notes"][0]


@pytest.mark.parametrize("composite", ["maximum", "mean"])
def test_projections_of_layers_are_drawn_again_as_they_were(tmp_path, composite):
    """A look that was written out for a projection was made clearer once more when it was read."""
    scan = ws.examples.ct_pelvis()
    scan.save(tmp_path / "pet.nii.gz")
    ct, pet = ws.open(tmp_path / "pet.nii.gz"), ws.open(tmp_path / "pet.nii.gz")
    picture = ws.Scene([ct, ws.Layer.overlay(pet, "hot")]).render(size=(40, 40), composite=composite)
    picture.save(tmp_path / "p.png")
    again = ws.Scene.load(tmp_path / "p.png").render(
        ws.Camera.from_json(picture.report["camera"]), size=(40, 40), composite=composite
    )
    np.testing.assert_allclose(again.rgba, picture.rgba, atol=1e-6)
