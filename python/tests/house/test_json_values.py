"""Whole numbers of any length and invalid texts, at every entry point for documents: the error names the field."""

import json

import numpy as np
import pytest
import viewer_fakes

import wavesplat as ws
from wavesplat._storage import json_texts
from wavesplat._viewer.session.state import ViewerState
from wavesplat.errors import ArgumentError, WavesplatError

HUGE = 10**400
#: Values that no document can have.
BAD = [HUGE, -HUGE, "\ud800", [HUGE], {"a": HUGE}, {"\udfff": 1}, [[["\udc00"]]]]
LOOK = ws.TransferFunction([(0, 0), (255, 0.5)], [(0, 1, 0, 0), (255, 1, 1, 1)])


@pytest.mark.parametrize(
    ("text", "place"),
    [
        (f'{{"a": [1, {{"b": {HUGE}}}]}}', r"field 'a\[1\]\.b' is a whole number of more than 308 digits"),
        (f"[{-HUGE}]", r"field '\[0\]' is a whole number"),
        (f"{HUGE}", "the document is a whole number"),
        (f'{{"a": {"1" * 5000}}}', "more than 4300 digits"),
        (r'{"name": "\ud800"}', "field 'name' has half of a surrogate pair"),
        (r'{"a": {"\udfff": 1}}', "field 'a' has half of a surrogate pair in a name"),
        ("{", "not JSON"),
        ("[" * 100_000, "not JSON"),
    ],
)
def test_the_message_names_the_field(text, place):
    with pytest.raises(ArgumentError, match=f"thing: .*{place}"):
        json_texts.decode(text, "thing")


def test_what_documents_may_hold():
    values = {"a": [0, -1, 10**308, 1.5, True, None, "\U0001f600", "ü"], "b": {}}
    assert json_texts.decode(json.dumps(values), "thing") == values
    assert json_texts.decode(json.dumps(values, ensure_ascii=False), "thing") == values


def places_in(value, steps=()):
    """Paths of all fields of a document."""
    yield steps
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, part in parts:
        yield from places_in(part, (*steps, name))


def replaced(document, steps, value):
    copy = json.loads(json.dumps(document))
    if not steps:
        return value
    inside = copy
    for step in steps[:-1]:
        inside = inside[step]
    inside[steps[-1]] = value
    return copy


def refusals(document, load):
    """Fields and values whose error is not one of ours, or which are accepted."""
    found = []
    for steps in places_in(document):
        for value in BAD:
            complaint = said(load, replaced(document, steps, value))
            if not complaint.isprintable() or complaint.startswith("not ours: "):
                found.append((steps, value, complaint))
    return found


def said(load, document):
    """Load a document; return the sentence of the error."""
    try:
        load(document)
    except WavesplatError as error:
        return str(error)
    except Exception as error:  # noqa: BLE001 - that is what is looked for
        return f"not ours: {type(error).__name__}: {error}"
    return "not ours: taken"


def scene():
    volume = viewer_fakes.ball(6)
    labels = ws.Labels((volume.samples > 200).astype(np.uint8), {1: ws.Label("red", name="one")})
    return ws.Scene(volume, LOOK, labels=labels, shading=ws.Shading(lights=[ws.Light((0, 0, 1))]))


def test_cameras():
    document = ws.Camera.view(viewer_fakes.ball(6), "left").as_json()
    assert refusals(document, ws.Camera.from_json) == []
    assert refusals(document, lambda changed: ws.Camera.from_json(json.dumps(changed))) == []


def test_looks_and_transfer_functions():
    look = ws.Look(transfer_function=LOOK, name="a")
    assert refusals(json.loads(look.to_json()), lambda changed: ws.Look.from_json(json.dumps(changed))) == []
    assert refusals(json.loads(LOOK.to_json()), lambda one: ws.TransferFunction.from_json(json.dumps(one))) == []


def test_materials():
    document = json.loads(ws.Materials.preset("ct").to_json())
    assert refusals(document, lambda changed: ws.Materials.from_json(json.dumps(changed))) == []


def test_scenes(tmp_path):
    np.save(tmp_path / "a.npy", viewer_fakes.ball(6).samples)
    picture = ws.render(ws.open(tmp_path / "a.npy"), LOOK, size=(8, 8), device="cpu")
    document = json.loads(json.dumps(picture.report["scene"]))
    assert refusals(document, lambda changed: ws.Scene.from_json(json.dumps(changed), tmp_path)) == []


def test_states_and_patches():
    state = ViewerState.of(scene())
    document = json.loads(json.dumps(state.document))
    with ws.view(scene(), browser=False) as viewer:
        assert refusals(document, lambda changed: setattr(viewer, "state", changed)) == []

    def patch(steps, value):
        path = "".join("/" + str(step).replace("~", "~0").replace("/", "~1") for step in steps)
        return state.patched([{"op": "replace", "path": path, "value": value}])

    for steps in places_in(document):
        for value in BAD:
            with pytest.raises(ArgumentError):
                patch(steps, value)
    for bad in ({"op": "\ud800", "path": ""}, {"op": "add", "path": "/labels/\ud800", "value": 1}):
        with pytest.raises(ArgumentError):
            state.patched([bad])


def test_a_page_that_sends_one_is_told_and_goes_on():
    session = viewer_fakes.Session(viewer_fakes.state_of())
    try:
        page = viewer_fakes.Page(session)
        page.patch({"op": "replace", "path": "/camera/position", "value": [HUGE, 0, 0]})
        told, _ = page.wait(lambda header: header["type"] == "failed" and header.get("seq") == page.seq)
        assert "'value[0]' is a whole number of more than 308 digits" in told["message"]
        answer, _ = page.ask("histogram", layer=0, bins=4, low=-HUGE, high=1)
        assert answer["type"] == "failed"
        assert "field 'low'" in answer["message"]
        page.patch(viewer_fakes.turned(session.state.camera, 10))
        page.show()
        page.at_rest()
    finally:
        session.close()


@pytest.mark.parametrize(
    "make",
    [
        lambda: ws.Label("red", name="\ud800"),
        lambda: ws.Layer(viewer_fakes.ball(6), name="\ud800"),
        lambda: ws.Look(transfer_function=LOOK, name="\ud800"),
        lambda: ws.Look(transfer_function=LOOK, reason="\udfff"),
        lambda: ws.Material("\ud800", [(0, 1)], "red", 0.5),
        lambda: ws.Channel("\ud800"),
        lambda: ws.Facts(modality="\ud800"),
        lambda: ws.Facts(guesses=["\ud800"]),
        lambda: ws.render(viewer_fakes.ball(6), LOOK, size=(16, 16)).annotated(title="\ud800"),
    ],
)
def test_texts_that_cannot_be_written_are_refused_where_they_enter(make):
    with pytest.raises(ArgumentError, match=r"\\ud[8f][0-9a-f]{2}.*half of a surrogate pair"):
        make()


@pytest.mark.parametrize(
    "make",
    [
        lambda: ws.Label("red", opacity=HUGE),
        lambda: ws.Facts(n_times=HUGE),
        lambda: ws.Facts(time_step=HUGE),
        lambda: ws.Facts(n_times=1, times=[HUGE]),
        lambda: ws.Channel(color=(HUGE, 0, 0)),
        lambda: ws.Channel(window=(0, HUGE)),
        lambda: ws.Channel(emission_nm=HUGE),
        lambda: ws.Volume.lazy(np.zeros((4, 4, 4)), memory=HUGE),
        lambda: ws.Volume.lazy(np.zeros((4, 4, 4)), memory=1e300),
        lambda: ws.Volume.lazy(np.zeros((4, 4, 4)), memory="1e300 GB"),
        lambda: ws.view(viewer_fakes.ball(6), port=10**30, browser=False),
        lambda: ws.view(viewer_fakes.ball(6), state={"slices": {"thickness": HUGE}}, browser=False),
        lambda: ws.Shading(gradient_offset=float("inf")),
        lambda: ws.Shading(ambient=True),
        lambda: ws.Shading(ambient=HUGE),
    ],
)
def test_numbers_that_nothing_can_hold_are_refused(make):
    with pytest.raises(ArgumentError):
        make()
