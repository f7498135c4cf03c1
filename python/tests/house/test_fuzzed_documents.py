"""Damaged documents: looks, ours and of other programs, scenes, cameras, tables, states and messages of the viewer."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest
import viewer_fakes
from damage import DAMAGE, JSON_DAMAGE, PLACES, check, damaged, damaged_json, fuzz
from hypothesis import strategies as st

import wavesplat as ws
from wavesplat._picture.picture_files import KEYWORD, with_text
from wavesplat._storage import json_texts
from wavesplat._viewer.page_requests import questions
from wavesplat._viewer.server.messages import packed, unpacked
from wavesplat._viewer.session.state import ViewerState

N = 60
BALL = viewer_fakes.ball(8)
CURVES = ws.TransferFunction([(0, 0), (120, 0.2), (255, 0.5)], [(0, 1, 0, 0), (255, 1, 1, 1)])
#: A look in a file of 3D Slicer, as it exports it, in its scenes, and of its older kind.
VP_JSON = {
    "@schema": "https://raw.githubusercontent.com/slicer/slicer/main/Schema/volume-property-schema-v1.0.0.json#",
    "volumeProperties": [
        {
            "effectiveRange": [0.0, 255.0],
            "isoSurfaceValues": [],
            "components": [
                {
                    "rgbTransferFunction": {
                        "type": "colorTransferFunction",
                        "points": [
                            {"x": 0, "color": [0.3, 0.3, 1.0], "midpoint": 0.5, "sharpness": 0.0},
                            {"x": 255.0, "color": [1.0, 1.0, 1.0], "midpoint": 0.3, "sharpness": 0.5},
                        ],
                    },
                    "scalarOpacity": {
                        "type": "piecewiseLinearFunction",
                        "points": [
                            {"x": 0, "y": 0.0, "midpoint": 0.5, "sharpness": 0.0},
                            {"x": 255.0, "y": 0.7, "midpoint": 0.5, "sharpness": 0.0},
                        ],
                    },
                    "gradientOpacity": {"points": [{"x": 0, "y": 0.2}, {"x": 30, "y": 1.0}]},
                    "scalarOpacityUnitDistance": 0.5,
                    "shade": True,
                    "lighting": {"diffuse": 0.9, "ambient": 0.2, "specular": 0.1, "specularPower": 5.0},
                }
            ],
        }
    ],
}
VP = "1\n1\n0.9\n0.2\n0.1\n10\n6 0 0 100 0.1 255 0.5\n4 0 1 255 1\n8 0 0 0 0 255 1 0.5 0.2\n"
SLICER_XML = (
    '<MRML><VolumeProperty id="v" name="A" shade="1" diffuse="0.9" ambient="0.1" specular="0.2" specularPower="10" '
    'scalarOpacity="4 0 0 255 0.5" gradientOpacity="4 0 1 255 1" colorTransfer="8 0 0 0 0 255 1 1 1"/></MRML>'
)
PARAVIEW = [
    {"Name": "a", "ColorSpace": "Lab", "RGBPoints": [0, 0, 0, 1, 1, 1, 0, 0], "Points": [0, 0, 0.5, 0, 1, 1, 0.5, 0]}
]
PARAVIEW_XML = (
    '<ColorMaps><ColorMap name="a" space="HSV"><Point x="0" o="0.5" r="0" g="0" b="1"/>'
    '<Point x="1" o="1" r="1" g="0" b="0"/></ColorMap></ColorMaps>'
)


def drawn(look):
    """Check that a look can be drawn and written: what it holds was checked when it was read."""
    if look is not None:
        look = look if isinstance(look, ws.Look) else ws.Look(transfer_function=look)
        ws.render(BALL, look, size=(6, 6))
        again = ws.Look.from_json(look.to_json())
        assert again.to_json() == look.to_json()


def two_dimensions():
    return ws.TransferFunction2D((0, 100, 255), (0, 5, 10, 30), np.full((4, 3, 4), 0.25))


@pytest.mark.parametrize(
    "suffix", [".json", ".tf", ".2d", ".vp.json", ".vp", ".xml", ".pv.json", ".pv.xml", ".materials"]
)
def test_looks(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    look = ws.Look(transfer_function=CURVES, shading=ws.Shading(lights=[ws.Light((0, 0, 1))]), name="a", view="front")
    texts = {
        ".json": look.to_json(), ".tf": CURVES.to_json(), ".2d": two_dimensions().to_json(), ".vp": VP,
        ".xml": SLICER_XML, ".vp.json": json.dumps(VP_JSON), ".pv.json": json.dumps(PARAVIEW), ".pv.xml": PARAVIEW_XML,
        ".materials": ws.Materials.preset("ct").to_json(),
    }  # fmt: skip
    whole = texts[suffix]
    document = json.loads(whole) if whole[0] in "[{" else None

    def load(has_volume):
        if suffix == ".materials":
            found = ws.Materials.load(path)
            found.to_json()
            return found
        loaded = ws.Look.load(path, BALL if has_volume else None)
        drawn(loaded)
        return loaded

    path.write_text(whole, encoding="utf-8")
    assert check(lambda: load(True), path.name) is not None

    def damage(changes, of_bytes, has_volume):
        content = damaged(whole.encode(), of_bytes) if of_bytes else damaged_json(document, changes).encode()
        path.write_bytes(content)
        check(lambda: load(has_volume), path.name)

    of_bytes = DAMAGE if document is None else st.none() | st.none() | DAMAGE
    fuzz(N, damage, JSON_DAMAGE, of_bytes, st.booleans())


def test_cameras(tmp_path):
    path = tmp_path / "camera.json"
    whole = ws.Camera.view(BALL, "left").as_json()

    def damage(changes, of_bytes):
        text = damaged_json(whole, changes).encode()
        path.write_bytes(damaged(text, of_bytes) if of_bytes else text)
        camera = check(lambda: ws.Camera.load(path), path.name)
        if camera is not None:
            assert check(lambda: ws.Camera.from_json(camera.as_json()), "") == camera
            check(lambda: ws.render(BALL, CURVES, camera, size=(6, 6)), "")

    fuzz(N, damage, JSON_DAMAGE, st.none() | DAMAGE)


def scene_document(folder):
    np.save(folder / "a.npy", BALL.samples)
    np.save(folder / "labels.npy", (BALL.samples > 200).astype(np.uint8))
    volume = ws.open(folder / "a.npy")
    labels = ws.Labels(ws.open(folder / "labels.npy"), {1: ws.Label("red", name="one")})
    shading = ws.Shading(lights=[ws.Light((0, 0, 1))])
    layers = [ws.Layer(volume, CURVES, name="one"), ws.Layer(volume.smoothed(0.7), CURVES, opacity=0.5)]
    clip = [ws.ClipPlane((4, 4, 4), (0, 0, 1)), ws.CutOut(ws.Crop((0, 0, 0), (3, 3, 3)))]
    scene = ws.Scene(layers, labels=labels, shading=shading, clip=clip)
    picture = scene.render(size=(8, 8), quality="draft")
    document = json.loads(json.dumps(picture.report["scene"]))
    for layer in (*document["layers"], document["labels"]):
        layer["volume"]["path"] = layer["volume"]["path"].rpartition("/")[2]
    return document, picture


@pytest.mark.parametrize("suffix", [".json", ".png"])
def test_scenes(tmp_path, suffix):
    document, picture = scene_document(tmp_path)
    path = tmp_path / f"scene{suffix}"
    picture.save(tmp_path / "plain.png", scene=False)
    plain = (tmp_path / "plain.png").read_bytes()

    def load():
        scene = ws.Scene.load(path)
        scene.render(size=(6, 6))
        return scene

    def damage(changes, of_bytes):
        text = damaged_json(document, changes)
        content = with_text(plain, KEYWORD, text) if suffix == ".png" else text.encode()
        path.write_bytes(damaged(content, of_bytes, len(plain)) if of_bytes else content)
        # Errors of the files that it names have their names, and presets are looked up when the scene is drawn.
        check(load, path.name, "a.npy", "labels.npy", tmp_path.name, "unknown preset")

    path.write_bytes(
        with_text(plain, KEYWORD, json.dumps(document)) if suffix == ".png" else json.dumps(document).encode()
    )
    assert check(load, path.name) is not None
    fuzz(N, damage, JSON_DAMAGE, st.none() | st.none() | DAMAGE)


def test_facts():
    whole = ws.Facts(unit="mm", is_anatomical=True, modality="CT", n_times=2, times=[0.0, 1.0], time_unit="s").as_json()

    def damage(changes):
        document = json_texts.decode_syntax(damaged_json(whole, changes), "facts")
        facts = check(lambda: ws.Facts.from_json(document), "")
        assert facts is None or check(lambda: ws.Facts.from_json(facts.as_json()), "") == facts

    fuzz(N, damage, JSON_DAMAGE)


TABLES = {
    "itk_snap.txt": '# ITK-SnAP\n0 0 0 0 0 0 0 "Clear Label"\n1 255 0 0 1 1 1 "liver"\n2 0 255 0 0.5 1 1 "a b"\n',
    "slicer.ctbl": "# Color table\n0 background 0 0 0 0\n1 liver 255 0 0 255\n2 a_b 0 255 0 255\n",
    "bids.tsv": "index\tname\tcolor\n0\tbackground\t#000000\n1\tliver\t#ff0000\n2\tspleen\t\n",
}


@pytest.mark.parametrize("name", TABLES)
def test_tables_of_labels(tmp_path, name):
    np.save(tmp_path / "labels.npy", (BALL.samples // 100).astype(np.uint8))
    path = tmp_path / name

    def damage(changes):
        path.write_bytes(damaged(TABLES[name].encode(), changes))
        check(lambda: ws.Labels.open(tmp_path / "labels.npy", table=path), path.name)

    fuzz(N, damage, DAMAGE)


@pytest.mark.parametrize("name", ["a.seg.nrrd", "a.nii"])
def test_labels_in_their_files(tmp_path, name):
    samples = (BALL.samples // 100).astype(np.uint8)
    path = tmp_path / name
    if name == "a.nii":
        import nibabel

        image = nibabel.Nifti1Image(samples.T, np.eye(4))
        text = b'<CaretExtension><Label Key="1" Red="0.5" Green="1" Blue="0"><![CDATA[liver]]></Label></CaretExtension>'
        image.header.extensions.append(nibabel.nifti1.Nifti1Extension(0, text))
        nibabel.save(image, path)
    else:
        header = (
            "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 8 8 8\n"
            "space directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: domain domain domain\nencoding: raw\n"
            "space origin: (0,0,0)\nSegment0_ID:=s\nSegment0_LabelValue:=1\nSegment0_Name:=liver\n"
            "Segment0_Color:=0.5 1 0\nSegment0_Layer:=0\n\n"
        )
        path.write_bytes(header.encode() + samples.tobytes())
    whole = path.read_bytes()
    assert check(lambda: ws.Labels.open(path), path.name).labels[1].name == "liver"

    def damage(changes):
        path.write_bytes(damaged(whole, changes, len(whole) - samples.nbytes))
        check(lambda: ws.Labels.open(path), path.name)

    fuzz(N, damage, DAMAGE)


# The viewer


def viewed():
    labels = ws.Labels((BALL.samples > 200).astype(np.uint8), {1: ws.Label("red", name="one")})
    clip = [ws.ClipPlane((4, 4, 4), (0, 0, 1))]
    scene = ws.Scene(BALL, CURVES, labels=labels, shading=ws.Shading(lights=[ws.Light((0, 0, 1))]), clip=clip)
    return ViewerState.of(scene)


def test_states():
    state = viewed()
    document = json.loads(json.dumps(state.document))

    def load(text):
        loaded = questions.state_from_text(state, text)
        loaded.scene.render(loaded.camera, size=(6, 6), **loaded.options)
        return loaded

    assert check(lambda: load(json.dumps(document)), "") is not None

    def damage(changes):
        check(lambda: load(damaged_json(document, changes)), "")

    fuzz(N, damage, JSON_DAMAGE)


def places_in(value, path=""):
    """Paths of all fields, as patches name them."""
    yield path
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, part in parts:
        yield from places_in(part, f"{path}/{str(name).replace('~', '~0').replace('/', '~1')}")


def test_patches():
    state = viewed()
    document = json.loads(json.dumps(state.document))
    paths = list(places_in(document))

    def damage(which, other, kind, changes):
        path = paths[which % len(paths)]
        found = document
        for step in path.split("/")[1:]:
            found = found[int(step) if isinstance(found, list) else step]
        operations = [{"op": kind, "path": path, "from": paths[other % len(paths)], "value": found}]
        text = damaged_json(operations, changes)
        check(lambda: state.patched(json_texts.decode_syntax(text, "patch")), "")

    kinds = st.sampled_from(["add", "replace", "remove", "move", "copy", "test"])
    fuzz(2 * N, damage, PLACES, PLACES, kinds, JSON_DAMAGE)


QUESTIONS = {
    "histogram": {"layer": 0, "bins": 8, "low": 0, "high": 255},
    "region": {"points": [[3, 3, 3], [9, 3, 3], [3, 9, 3]]},
    "pick": {"width": 16, "height": 12, "x": 0.5, "y": 0.5},
    "layer_change": {"layer": 0, "colors": "hot", "window": [1, "99%"], "threshold": 2, "gamma": 0.5},
    "preset": {"layer": 0, "name": "ct-bone"},
    "preset_picture": {"layer": 0, "name": "auto", "size": 16},
    "framed": {"width": 16, "height": 12, "camera": ws.Camera.view(BALL, "left").as_json()},
    "first_view": {"width": 16, "height": 12},
    "kept_in_view": {"width": 16, "height": 12, "aspect": 2, "camera": ws.Camera.view(BALL, "left").as_json()},
    "picture": {"width": 16, "height": 12, "quality": "draft", "transparent": False, "annotated": False},
    "code": {"width": 16, "height": 12, "as": "python"},
    "open_state": {"text": "{}"},
}


@pytest.mark.parametrize("question", QUESTIONS)
def test_questions(question):
    state = viewed()

    def damage(changes):
        arguments = json.loads(damaged_json(QUESTIONS[question], changes))
        # Pictures as large as a page may ask for take their time.
        if (
            isinstance(arguments, dict)
            and max((arguments.get(name) or 0 for name in ("width", "height")), key=_size) == 7
        ):
            return
        found = check(lambda: questions.answer_of(state, question, arguments), "")
        if found is not None:
            packed({"type": "answer", **found[0]}, found[1])

    fuzz(N, damage, JSON_DAMAGE)


def _size(value):
    return value if isinstance(value, int) else 0


def test_messages():
    session = viewer_fakes.Session(viewed())
    camera = session.state.camera.as_json()
    messages = [
        {
            "type": "patch",
            "seq": 1,
            "operations": [{"op": "replace", "path": "/camera", "value": camera}],
            "moving": False,
        },
        {"type": "view", "view": "3d", "size": [16, 12]},
        {"type": "shown", "view": "3d", "frame": 1},
        {"type": "ask", "id": 1, "question": "pick", "arguments": {"x": 0.5, "y": 0.5, "width": 16, "height": 12}},
        {"type": "cancel", "id": 1},
    ]
    page = viewer_fakes.Page(session)

    def receive(message):
        header, _ = unpacked(message)
        page.client.receive(header)

    def damage(which, changes, of_bytes):
        text = damaged_json(messages[which % len(messages)], changes).encode()
        message = struct.pack("<I", len(text)) + text
        check(lambda: receive(damaged(message, of_bytes) if of_bytes else message), "")

    try:
        fuzz(2 * N, damage, PLACES, JSON_DAMAGE, st.none() | DAMAGE)
        # The session lives, and no thread of it met what it did not expect.
        page.patch({"op": "replace", "path": "", "value": viewed().document})
        page.show()
        page.at_rest()
        failed = [header for _, header, _ in page.messages if header["type"] == "failed"]
        assert [
            one for one in failed if one.get("code") == "failed" and one["message"].startswith("the renderer failed")
        ] == []
    finally:
        session.close()
