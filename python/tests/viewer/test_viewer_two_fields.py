"""The viewer's page knows the field that colours a layer, and a picked place has the values of both."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import wavesplat as ws
from wavesplat._viewer.page_requests import questions
from wavesplat._viewer.page_requests.under_pointer import label_at, values_at
from wavesplat._viewer.session.info import welcome_of
from wavesplat._viewer.session.state import ViewerState

N = 24
MIDDLE = {"x": 0.5, "y": 0.5, "width": 200, "height": 200}


@pytest.fixture
def gas(tmp_path: Path) -> Path:
    z, y, x = np.indices((N, N, N), dtype=np.float32) - np.float32((N - 1) / 2)
    with h5py.File(tmp_path / "gas.h5", "w") as file:
        file["density"] = np.clip(10 - np.sqrt(x**2 + y**2 + z**2), 0, None).astype(np.float32)
        file["temperature"] = (300 + x).astype(np.float32)
        file["temperature"].attrs["units"] = "K"
    return tmp_path / "gas.h5"


def state_of(gas: Path, **options: Any) -> ViewerState:
    density, heat = (ws.open(gas, dataset=name, **options) for name in ("density", "temperature"))
    colors = ws.TransferFunction.from_colormap("inferno", clim=(290, 312))
    return ViewerState.of(ws.Scene(ws.Layer(density, color_from=ws.Layer(heat, colors))))


@pytest.mark.parametrize("options", [{}, {"memory": "20 MB", "cache": False}])
def test_a_picked_place_has_the_values_of_both_fields(gas: Path, options: Any) -> None:
    state = state_of(gas, **options)
    told, _ = questions.answer_of(state, "pick", MIDDLE)
    assert [(one["name"], one["unit"]) for one in told["values"]] == [("density", ""), ("temperature", "K")]
    z, y, x = (round(float(at)) for at in told["point"][::-1])
    with h5py.File(gas) as file:
        wanted = [float(file[name][z, y, x]) for name in ("density", "temperature")]
    assert [one["value"] for one in told["values"]] == pytest.approx(wanted)
    beside, _ = questions.answer_of(state, "pick", {**MIDDLE, "x": 0.01, "y": 0.01})
    assert beside == {"point": None, "values": [], "label": None}


@pytest.mark.parametrize("options", [{}, {"memory": "20 MB", "cache": False}])
def test_the_page_knows_the_field_of_the_colours(gas: Path, options: Any) -> None:
    [info] = json.loads(json.dumps(welcome_of(state_of(gas, **options))))["volumes"]
    field = info["color_field"]
    assert (field["name"], field["value_unit"]) == ("temperature", "K")
    assert (field["color"][0][0], field["color"][-1][0]) == (290, 312)
    assert all(len(node) == 4 for node in field["color"])


def test_a_layer_alone_has_its_value_without_a_name(gas: Path) -> None:
    state = ViewerState.of(ws.Scene(ws.open(gas, dataset="density")))
    assert welcome_of(state)["volumes"][0]["color_field"] is None
    [told] = questions.answer_of(state, "pick", MIDDLE)[0]["values"]
    assert (told["name"], told["unit"]) == ("", "")


def test_every_layer_and_the_label_have_their_names_at_a_point() -> None:
    _, y, x = np.indices((8, 8, 8))
    scan, other = (ws.Volume(samples.astype(np.float32)) for samples in (10 * x, 100 * y))
    regions = ws.Labels(
        (1 + x // 4).astype(np.uint8), {1: ws.Label("red", name="liver"), 2: ws.Label("blue", opacity=0)}
    )
    layers = [ws.Layer(scan, name="CT"), ws.Layer(other, name="PET"), ws.Layer(other, name="hidden", visible=False)]
    scene = ws.Scene(layers, labels=regions)
    for point, values, label in (((2.2, 3, 1), (20, 300), "liver"), ((6, 1, 1), (60, 100), None)):
        found = values_at(scene, np.array(point, float))
        assert [(one["name"], one["value"]) for one in found] == list(zip(("CT", "PET"), values, strict=True))
        assert label_at(scene, np.array(point, float)) == label
    assert label_at(scene, np.array([50.0, 0, 0])) is None


def test_missing_values_and_named_layers(gas: Path) -> None:
    with h5py.File(gas, "a") as file:
        file["temperature"][...] = np.nan
        file["temperature"][0] = 300
    density, heat = (ws.open(gas, dataset=name) for name in ("density", "temperature"))
    layer = ws.Layer(density, color_from=ws.Layer(heat, name="heat"), name="gas")
    found = values_at(ws.Scene(layer), np.array([11.0, 12, 12]))
    assert [one["name"] for one in found] == ["gas", "heat"]
    assert found[0]["value"] == pytest.approx(9.13, abs=0.01)
    assert found[1]["value"] is None
    assert [one["value"] for one in values_at(ws.Scene(layer), np.array([-9.0, 0, 0]))] == [None, None]


def test_a_saved_view_of_lazy_fields_opens_again(gas: Path) -> None:
    state = state_of(gas, memory="20 MB", cache=False)
    document = json.loads(json.dumps(state.file_document((60, 50))))
    again = ws.Scene.from_json(json.dumps(document), folder=gas.parent)
    size = (60, 50)
    picture = state.scene.render(state.camera, size=size, **state.options)
    assert "lazy" in picture.report
    assert np.array_equal(again.render(state.camera, size=size, **state.options).rgba, picture.rgba)
