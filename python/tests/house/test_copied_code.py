"""The Python that the viewer gives to copy is Python, whatever the scene is made of."""

import ast

import numpy as np
import pytest

import wavesplat as ws
from wavesplat._viewer.page_requests import code
from wavesplat._viewer.session.state import ViewerState

BOX = np.zeros((6, 7, 8), np.uint8)
BOX[1:4, 1:5, 1:4], BOX[4:, 2:, 5:] = 1, 2
VOLUME = ws.Volume(np.random.default_rng(2).random((6, 7, 8), np.float32), name="it's \"one\"\n# of 'many'")
OTHER = ws.Volume(VOLUME.samples[::-1] * 3, name="other")
NAMED = {1: ws.Label("red", name='a "b"\n#'), 2: ws.Label("#20c040", opacity=0.5)}
TRIANGLE = [(0, 0, 0), (3, 0, 0), (0, 3, 3)]
GEOMETRY = [
    ws.Surface(TRIANGLE, [(0, 1, 2)], color="red", name="a 'part'"),
    ws.Surface(TRIANGLE, [(0, 1, 2)], values=[0.0, np.nan, 2.0]),
    ws.SlicePlane(VOLUME, "axial"),
    ws.Points([(1, 1, 1)], radius=0.5),
]
SERIES = ws.Series([VOLUME, OTHER], times=[0, 2.5], time_unit="s")
MAP = ws.TransferFunction.from_colormap("hot", clim=(0.1, 2))
CLIPS = [
    ws.Crop((0, 0, 0), (5, 5, 5)),
    ws.CutOut(ws.Crop((3, 3, 3), (5, 6, 7))),
    ws.ClipPlane((1, 1, 1), (0, 0.6, 0.8)),
]

SCENES = {
    "volume": ws.Scene(VOLUME),
    "labels": ws.Scene(VOLUME, labels=ws.Labels(BOX, NAMED)),
    "labels of a box": ws.Scene(VOLUME, "grey", labels=ws.Labels(BOX, NAMED, smooth=False), clip=CLIPS),
    "layers": ws.Scene([VOLUME, ws.Layer(OTHER, MAP, opacity=0.5, name="x'y"), ws.Layer(OTHER, visible=False)]),
    "color from": ws.Scene(ws.Layer(VOLUME, color_from=ws.Layer(OTHER, MAP, name="heat"))),
    "series": ws.Scene(ws.Layer(SERIES, time=1)),
    "geometry": ws.Scene(VOLUME, geometry=GEOMETRY, labels=ws.Labels(BOX), background="white"),
    "light": ws.Scene(VOLUME, shading=ws.Shading(lights=[ws.Light((0, 0, 1))])),
    "wavelets": ws.Scene(ws.WaveletVolume.from_volume(VOLUME)),
    "example": ws.Scene(ws.examples.ripples(8), clip=CLIPS, keep_table=True),
}


@pytest.mark.parametrize("name", SCENES)
def test_copied_python_parses_and_says_what_to_give(name):
    state = ViewerState.of(SCENES[name])
    for shown, marks in (("3d", False), ("z", True), ("all", False)):
        text = code.python_of(state, (32, 24), shown, marks=marks)
        named = {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}
        made = {node.targets[0].id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Assign)}
        assert named - made <= {"ws", "float"}, text
        # What comes from no file is a line of its own, with a remark.
        assert [line for line in text.splitlines() if "..." in line and "# give" not in line] == []
        assert ("# give" in text) == (name != "example"), text
