"""Rows of the page's list of layers: what they read from a look, and that what they set is what the library makes."""

import json

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._looks import look_files
from wavesplat._viewer.page_requests import layer_rows, questions
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError


def ball(high, **options):
    places = np.indices((16, 18, 20)) - np.array([8, 9, 10]).reshape(3, 1, 1, 1)
    samples = (0.5 + high * np.exp(-(places**2).sum(axis=0) / 20)).astype("float32")
    return ws.Volume(samples, **options)


@pytest.fixture(scope="module")
def over():
    """A grey volume with another one over it."""
    return ViewerState.of(
        ws.Scene([ws.Layer(ball(100.0, anatomical=True), "grey"), ws.Layer(ball(9.0, anatomical=True))])
    )


def rows(state):
    return questions.answer_of(state, "layer_rows", {})[0]["rows"]


def changed(state, layer, **wanted):
    told, _ = questions.answer_of(state, "layer_change", {"layer": layer, **wanted})
    return state.patched(told["operations"])


def fields(look):
    return json.loads(json.dumps(look_files.fields_of(look)))


def test_a_window_and_a_threshold_that_are_typed_make_the_look_of_the_command(over):
    state = changed(changed(changed(over, 1, window=[2, None]), 1, window=[None, 8]), 1, threshold=2)
    expected = ws.Layer.overlay(over.scene.layers[1].volume, "hot", (2, 8), threshold=2)
    assert state.document["layers"][1]["look"] == fields(expected.look)
    row = rows(state)[1]
    assert row == {
        "kind": "map", "colors": "hot", "window": [2, 8], "threshold": 2, "gamma": 1, "is_automatic": False,
    }  # fmt: skip
    # The other layer is as it was.
    assert state.document["layers"][0] == over.document["layers"][0]


def test_the_automatic_look_of_a_layer_over_another_one_is_the_map_that_it_has(over):
    row = rows(over)[1]
    assert (row["kind"], row["colors"], row["is_automatic"]) == ("map", "hot", True)


@pytest.mark.parametrize("name", ["viridis", "coolwarm"])
def test_a_gamma_moves_the_colours_of_a_map_and_is_read_again(over, name):
    plain = changed(changed(over, 1, colors=name), 1, window=[-8, 8])
    state = changed(plain, 1, gamma=0.5)
    row = rows(state)[1]
    assert (row["colors"], row["window"], row["gamma"]) == (name, [-8, 8], 0.5)
    before, after = (one.document["layers"][1]["look"]["transfer_function"] for one in (plain, state))
    # A quarter of the way has the colour of a half.
    value = np.interp(-4, [node[0] for node in after["color"]], [node[2] for node in after["color"]])
    assert value == pytest.approx(
        np.interp(0, [node[0] for node in before["color"]], [node[2] for node in before["color"]]), abs=1e-3
    )
    assert after["opacity"] == before["opacity"]
    assert changed(state, 1, gamma=1).document == plain.document
    assert rows(changed(state, 1, auto=True))[1]["is_automatic"]


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_a_gamma_is_read_again_whatever_the_unit_of_the_values(scale):
    tiny = ball(9.0)
    tiny = ws.Volume(tiny.samples * np.float32(scale))
    state = changed(ViewerState.of(ws.Scene([ws.Layer(ball(100.0), "grey"), ws.Layer(tiny)])), 1, gamma=0.8)
    assert (rows(state)[1]["gamma"], rows(state)[1]["kind"]) == (0.8, "map")
    low, high = rows(state)[1]["window"]
    state = changed(state, 1, window=[low, low + (high - low) / 2])
    assert rows(state)[1]["gamma"] == 0.8


@pytest.mark.parametrize("gamma", [1 / 3, 0.05, 20])
def test_every_gamma_that_is_taken_is_read_again(over, gamma):
    row = rows(changed(over, 1, gamma=gamma))[1]
    assert (row["kind"], row["colors"], row["gamma"]) == ("map", "hot", pytest.approx(gamma, abs=1e-6))


def test_percentiles_are_those_of_the_samples(over):
    state = changed(over, 1, window=["5%", "99%"])
    samples = over.scene.layers[1].volume.samples
    assert rows(state)[1]["window"] == pytest.approx(np.percentile(samples, [5, 99]).tolist())


def test_the_window_of_the_first_layer_is_that_of_slices_too(over):
    state = changed(over, 0, window=[20, 60])
    assert state.view["slices"]["window"] == [40, 40]
    assert rows(state)[0]["window"] == [20, 60]
    back = changed(state, 0, auto=True)
    assert "window" not in back.view["slices"]
    assert rows(back)[0] == rows(over)[0]


@pytest.mark.parametrize(("layer", "first", "second"), [(0, "grey", None), (0, "auto", None), (1, "auto", "grey")])
def test_auto_gives_a_look_its_window_by_the_data_again(layer, first, second):
    state = ViewerState.of(ws.Scene([ws.Layer(ball(100.0), first), ws.Layer(ball(9.0), second)]))
    assert rows(state)[layer]["is_automatic"]
    moved = changed(changed(state, layer, window=[4, 7]), layer, window=[3, 6])
    assert (rows(moved)[layer]["window"], rows(moved)[layer]["is_automatic"]) == ([3, 6], False)
    assert changed(moved, layer, auto=True).document == state.document
    # The slices alone are not the whole.
    if layer == 0:
        slices_alone = moved.patched([{"op": "remove", "path": "/view/slices/window"}])
        assert not rows(slices_alone)[0]["is_automatic"]


def test_auto_keeps_the_light_and_the_curves_of_a_look_that_was_changed_by_hand():
    state = ViewerState.of(ws.Scene([ws.Layer(ball(100.0), "grey")]))
    path = "/layers/0/look/transfer_function/opacity/0/1"
    by_hand = state.patched([{"op": "replace", "path": path, "value": 0.25}])
    back = changed(changed(by_hand, 0, window=[3, 6]), 0, auto=True)
    opacity, before = (one.document["layers"][0]["look"]["transfer_function"]["opacity"] for one in (back, by_hand))
    assert np.allclose(opacity, before)
    assert rows(back)[0]["is_automatic"]


def test_a_table_has_the_window_of_slices_and_takes_a_colour_map():
    table = ws.TransferFunction2D([0, 50], [0, 1], np.full((2, 2, 4), 0.1))
    state = ViewerState.of(ws.Scene([ws.Layer(ball(100.0), table), ws.Layer(ball(9.0), table)]))
    moved = changed(state, 0, window=[20, 60])
    assert rows(moved)[0]["window"] == [20, 60]
    assert moved.document["layers"] == state.document["layers"]
    assert rows(changed(moved, 0, auto=True))[0] == rows(state)[0]
    for layer, wanted in [(0, {"gamma": 2}), (0, {"threshold": 3}), (1, {"window": [1, 2]}), (1, {"auto": True})]:
        with pytest.raises(ArgumentError, match="a table or of labels"):
            changed(state, layer, **wanted)
    hot = changed(state, 0, colors="hot")
    assert (rows(hot)[0]["kind"], rows(hot)[0]["colors"]) == ("map", "hot")
    assert rows(changed(state, 1, colors="hot"))[1]["colors"] == "hot"


def test_a_projection_of_one_volume_stays_one_with_another_map():
    state = ViewerState.of(ws.Scene([ws.Layer(ball(9.0, anatomical=True), "pet")]))
    assert state.options["composite"] == "maximum"
    state = changed(state, 0, colors="viridis")
    assert (state.options["composite"], state.document["layers"][0]["look"]["composite"]) == ("maximum", "maximum")
    assert rows(state)[0]["colors"] == "viridis"


def test_channels_have_the_colours_of_their_dyes_and_settings_of_their_own():
    names = ["DAPI", "GFP", "mCherry"]
    facts = [ws.Facts(channel=ws.Channel(name)) for name in names]
    state = ViewerState.of(ws.Scene([ws.Layer(ball(500.0, facts=one)) for one in facts]))
    found = rows(state)
    assert [row["kind"] for row in found] == ["channel"] * 3
    blue, green, red = (int(row["colors"][1:], 16) for row in found)
    assert (blue & 0xFF, green, red >> 16) == (0xFF, 0x00FF00, 0xFF)
    # Many steps, as of a slider that is dragged, are as good as one, and add no nodes.
    state = changed(state, 1, window=[10, 300])
    for gamma in (0.9, 0.8, 0.7, 0.6):
        state = changed(state, 1, gamma=gamma)
    row = rows(state)[1]
    assert (row["window"], row["colors"], row["gamma"]) == ([10, 300], "#00ff00", pytest.approx(0.6))
    assert len(state.document["layers"][1]["look"]["transfer_function"]["color"]) < 40
    assert rows(changed(state, 1, colors="#ff0000"))[1]["colors"] == "#ff0000"
    assert rows(changed(state, 1, auto=True))[1] == found[1]


@pytest.mark.parametrize(("look", "gammas"), [("grey", []), (ws.Look.channel(ball(100.0), "green"), [0.5, 0.4])])
def test_the_description_of_a_look_names_the_last_window_and_gamma_of_a_slider_alone(look, gammas):
    state = ViewerState.of(ws.Scene([ws.Layer(ball(100.0), look)]))
    plain = state.document["layers"][0]["look"]["description"]
    for gamma in gammas:
        state = changed(state, 0, gamma=gamma)
    for window in ([3, 60], [4, 60]):
        state = changed(state, 0, window=window)
    description = state.document["layers"][0]["look"]["description"]
    assert description.startswith(plain)
    assert (description.count("window"), description.count("gamma")) == (1, len(gammas[:1]))
    assert "window 4 to 60" in description


@pytest.mark.parametrize(
    "wanted",
    [
        {"colors": "no-such-map"}, {"window": [8, 2]}, {"window": [1]}, {"window": ["a", 2]}, {"gamma": 0},
        {"gamma": "1"}, {"threshold": "2"}, {"auto": 1}, {"blend": "over"}, {"colors": ""},
        {"map": "hot"}, {"auto": True, "gamma": 2}, {"gamma": 0.01}, {"gamma": 21},
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(over, wanted):
    with pytest.raises(ArgumentError):
        changed(over, 1, **wanted)


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"gamma": 2, "colors": "viridis"}, "colors"), ({"gamma": 2, "auto": True}, "auto"), ({"gamma": "2"}, "gamma"),
        ({"gamma": 2, "map": 5}, "map"),
    ],
)  # fmt: skip
def test_a_link_with_another_field_of_a_look_of_a_map_is_refused_by_its_name(over, given, field):
    document = json.loads(json.dumps(over.document))
    document["layers"][1]["look"] = {"map": "hot", **given}
    with pytest.raises(ArgumentError, match=f"look: {field} is "):
        questions.state_from_text(over, json.dumps(document))


@pytest.mark.parametrize("name", [*layer_rows.OF_SLICES, *layer_rows.OFFERED])
def test_slices_have_the_colour_maps_that_documents_of_them_may_name(over, name):
    operation = {"op": "add", "path": "/view/slices/colors", "value": name}
    if name in layer_rows.OF_SLICES:
        assert over.patched([operation]).view["slices"]["colors"] == name
    else:
        with pytest.raises(ArgumentError, match=", ".join(layer_rows.OF_SLICES)):
            over.patched([operation])
