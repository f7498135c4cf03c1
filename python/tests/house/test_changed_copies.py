"""`dataclasses.replace` works for every frozen dataclass that is public."""

import dataclasses

import numpy as np
import pytest

import wavesplat as ws
from wavesplat import gpu, reference, study

BALL = ws.examples.ripples(8)
BOX = ws.Crop((0, 0, 0), (1, 1, 1))
FUNCTION = ws.TransferFunction([(0, 0), (1, 1)], [(0, 1, 1, 1)])
FLESH = ws.Material("flesh", [(0, 0), (1, 1)], "red", 0.5)
PICTURE = ws.render(BALL, size=(8, 6))
CAMERA = PICTURE.camera
assert CAMERA is not None

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
EIGHT = ((0, 8), (0, 8), (0, 8))
PART = ws.VolumePart(BALL.samples, (0, 0, 0), EIGHT, (8, 8, 8))
PARTIAL = ws.render_part(PART.whole([PART.overview()]), size=(8, 6))
COST = ws.Cost((8, 8, 8), 0, 1, 1, 1, 1, 1, 512, 512, 0, True, 512, 512, 0, {}, {}, 1, 1)

#: Of every public dataclass one object, and a field with another value for it.
SAMPLES = [
    (CAMERA, "position", (1.0, 2.0, 30.0)),
    (ws.AttenuatedMaximum(), None, None),
    (ws.Channel("a"), "name", "b"),
    (ws.ClipPlane((0, 0, 0), (0, 1, 0)), "point", (0.0, 1.0, 0.0)),
    (BOX, "upper", (2.0, 2.0, 2.0)),
    (COST, "workers", 2),
    (ws.CutOut(BOX), "crop", ws.Crop((0, 0, 0), (2, 2, 2))),
    (ws.DepthColoredMaximum(), None, None),
    (ws.DepthShadedMaximum(), None, None),
    (ws.Facts(modality="CT"), "modality", "MR"),
    (ws.FirstHit(0.5), None, None),
    (ws.Frame(), "grid", True),
    (ws.Isolines(BALL, [0.5], color="red"), "values", (0.25,)),
    (ws.KeyFrame(0), "time_s", 2.0),
    (ws.Label("red", name="a"), "name", "b"),
    (ws.Labels(np.eye(4, dtype=np.uint8).reshape(1, 4, 4)), "smooth", False),
    (ws.Layer(BALL), "opacity", 0.5),
    (ws.Light((0, 0, 1)), "frame", "world"),
    (ws.Lines(CORNERS), "width", 3.0),
    (ws.LocalMaximum(0.5), None, None),
    (ws.Look.preset("ct-bone"), "background", "white"),
    (FLESH, "opacity", 0.25),
    (ws.Materials([FLESH]), "opacity_unit", 2.0),
    (ws.Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]], np.int32), np.ones((3, 3))), "faces", np.array([[0, 2, 1]])),
    (ws.Meshes((), ()), None, None),
    (PARTIAL, "planes", {}),
    (PICTURE, "depth", np.ones((6, 8))),
    (ws.Points(CORNERS), "opacity", 0.5),
    (ws.Region([[(0, 0, 0), (1, 0, 0), (0, 1, 0)]], "red", is_of_patient=True), "name", "b"),
    (ws.SlicePlane(), "opacity", 0.5),
    (ws.Surface(CORNERS, [[0, 1, 2]]), "normals", "flat"),
    (ws.Sampling(), "quality", "fine"),
    (ws.Scene(BALL), "background", "white"),
    (ws.Shading(), "specular", 0.0),
    (ws.Stereo(), None, None),
    (FUNCTION, "opacity_unit", 2.0),
    (ws.TransferFunction2D([0, 1], [0, 1], np.ones((2, 2, 4))), "opacity_unit", 2.0),
    (ws.Turn(), None, None),
    (ws.XRay(), None, None),
    (study.Ablation(), "kernel_slicing", False),
    (study.StandardSplatting(), "view_angle_correction", False),
    (gpu.Adapter("a", "vulkan", "discrete", "1", 1, 2), "name", "b"),
    (gpu.SelfTest("failed"), "gathers", True),
]


def _public_dataclasses():
    modules = (ws, gpu, reference, study)
    named = {getattr(module, name) for module in modules for name in module.__all__ if name != "__version__"}
    return {thing for thing in named if isinstance(thing, type) and dataclasses.is_dataclass(thing)}


def test_no_public_dataclass_is_forgotten():
    assert {type(thing) for thing, _, _ in SAMPLES} >= _public_dataclasses()


def _same(one, other):
    if isinstance(one, tuple) and any(isinstance(part, np.ndarray) for part in one):
        return all(map(_same, one, other))
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    return one is other or one == other or repr(one) == repr(other)


@pytest.mark.parametrize(("thing", "name", "value"), SAMPLES, ids=lambda thing: type(thing).__name__)
def test_a_changed_copy_differs_in_that_field_alone_fault_24(thing, name, value):
    shown = [field.name for field in dataclasses.fields(thing) if not field.name.startswith("_")]
    copy = dataclasses.replace(thing)
    assert all(_same(getattr(copy, one), getattr(thing, one)) for one in shown)
    if name is not None:
        changed = dataclasses.replace(thing, **{name: value})
        assert _same(getattr(changed, name), value)
        assert not _same(getattr(changed, name), getattr(thing, name))
        assert all(_same(getattr(changed, one), getattr(thing, one)) for one in shown if one != name)


def test_a_changed_shading_draws_as_one_made_anew_fault_24():
    changed = dataclasses.replace(ws.Shading(), specular=0.0)
    assert changed == ws.Shading(specular=0.0)
    drawn = [ws.render(BALL, shading=shading, size=(16, 16)).rgba for shading in (changed, ws.Shading(specular=0.0))]
    assert np.array_equal(*drawn)


def test_changed_labels_keep_their_place_and_looks():
    segmentation = ws.Volume(np.eye(4, dtype=np.uint8).repeat(4).reshape(4, 4, 4), spacing=(2, 2, 2))
    labels = ws.Labels(segmentation, {1: ws.Label("red", name="line")})
    changed = dataclasses.replace(labels, smooth=False)
    assert (changed.labels, changed.smooth, changed.numbers) == (labels.labels, False, (0, 1))
    assert np.array_equal(changed.world_from_index, segmentation.world_from_index)
