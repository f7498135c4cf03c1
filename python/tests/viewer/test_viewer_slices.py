"""Slices of the viewer: what they show at first, by the kind of data, and where their pixels lie."""

import numpy as np
import pytest
import viewer_fakes

import wavesplat as ws
from wavesplat._viewer.session.state import ViewerState, changes_slices
from wavesplat._viewer.slices.slice_values import slice_values
from wavesplat._viewer.slices.slice_view import colors_of, geometry_of, slice_of, window_of

PANES = ("z", "y", "x")


def facts(modality):
    return ws.Facts(unit="mm", is_anatomical=True, modality=modality)


def ball(shape, middle, radius):
    """1 inside a ball, else 0; middle and radius in samples, [z, y, x]."""
    index = np.indices(shape).astype(np.float32)
    away = sum((one - at) ** 2 for one, at in zip(index, middle, strict=True))
    return (away < radius**2).astype(np.float32)


def pet():
    """A body of 2000 with a small spot of 40,000, on 4 mm voxels."""
    rng = np.random.default_rng(1)
    body = ball((48, 48, 48), (24, 24, 24), 16)
    samples = body * rng.normal(2000, 300, body.shape) + 38_000 * ball(body.shape, (30, 24, 20), 2)
    return ws.Volume(
        np.maximum(samples, 0).astype(np.float32),
        spacing=(4, 4, 4),
        facts=facts("PT"),
    )


def state_of(*volumes):
    return ViewerState.of(ws.Scene([ws.Layer(volume) for volume in volumes]))


def greys(state, pane):
    return slice_of(state, pane, (120, 120)).rgba[..., :3].mean(axis=2) * 255


@pytest.fixture(scope="module")
def pelvis():
    return state_of(ws.examples.ct_pelvis())


def test_ct_has_the_window_of_soft_tissue(pelvis):
    assert window_of(pelvis) == (40, 400)
    body = greys(pelvis, "z")[slice_of(pelvis, "z", (120, 120)).value > -150]
    assert 60 < body.mean() < 190


def test_ct_of_bone_alone_has_the_window_of_its_values():
    scan = ws.examples.ct_pelvis()
    bone = np.where(scan.samples > 300, scan.samples, -1000)
    state = ViewerState.of(
        ws.Scene(ws.Volume(bone, world_from_index=scan.world_from_index, facts=facts("CT")), "ct-bone")
    )
    assert window_of(state)[1] > 1000


def test_pet_is_dark_on_white_from_zero_to_a_robust_maximum():
    state = state_of(pet())
    level, width = window_of(state)
    assert level == width / 2
    assert 2200 < width < 4000
    assert colors_of(state) == "gray_r"
    shown = greys(state, "z")
    assert shown[0, 0] == 255
    inside = slice_of(state, "z", (120, 120)).value > 1000
    assert 60 < shown[inside].mean() < 190


def test_other_scans_run_over_their_values():
    samples = np.linspace(0, 200, 24**3).reshape(24, 24, 24).astype(np.float32)
    level, width = window_of(state_of(ws.Volume(samples, facts=ws.Facts(unit="mm", modality="MR"))))
    assert (level, width) == pytest.approx((100, 200), rel=0.02)


@pytest.mark.filterwarnings("ignore::wavesplat.errors.WavesplatWarning")
def test_channels_keep_their_colours_and_have_no_window():
    values = ball((24, 24, 24), (12, 12, 12), 8) * 200
    volume = ws.Volume(values, spacing=(1, 1, 1))
    scene = ws.Scene([ws.Layer(volume, ws.Look.channel(volume, color, (0, 200))) for color in ("red", "lime")])
    state = ViewerState.of(scene)
    # A window that was chosen for another volume does no harm.
    state = state.patched([{"op": "add", "path": "/view/slices/window", "value": [1, 2]}])
    picture = slice_of(state, "z", (60, 60))
    assert picture.rgba[30, 30] == pytest.approx([1, 1, 0, 1], abs=0.01)
    geometry = geometry_of(state, "z", picture.report)
    assert geometry["window"] is None
    assert geometry["colors"] is None


@pytest.mark.parametrize("middle", [(24, 24, 24), (8, 40, 10), (40, 8, 24)])
def test_the_crosshair_starts_where_every_slice_shows_something(middle):
    volume = ws.Volume(
        100 * ball((48, 48, 48), middle, 6),
        spacing=(1, 2, 3),
        facts=facts("MR"),
    )
    state = state_of(volume)
    for pane in PANES:
        assert np.mean(greys(state, pane) > 0) > 0.01
    if middle == (24, 24, 24):
        assert state.view["slices"]["crosshair"] == np.mean(volume.bounds, axis=0).tolist()


def test_a_window_and_colours_that_are_chosen_stay(pelvis):
    state = pelvis.patched(
        [
            {"op": "add", "path": "/view/slices/window", "value": [400, 1800]},
            {"op": "add", "path": "/view/slices/colors", "value": "hot"},
        ]
    )
    hot = ws.TransferFunction.from_colormap("hot", clim=(-500, 1300), opacity=1)
    position = state.view["slices"]["crosshair"][2]
    want = ws.slice(state.scene, "axial", position, size=(50, 40), transfer_function=hot)
    assert np.array_equal(slice_of(state, "z", (50, 40)).rgba, want.rgba)


@pytest.mark.parametrize("scale", [0.75, 0.5])
@pytest.mark.parametrize("pane", PANES)
def test_frames_with_fewer_pixels_show_as_much_of_the_world(pelvis, pane, scale):
    size = (131, 77)
    state = pelvis.patched(
        [
            {"op": "replace", "path": "/view/slices/zoom", "value": 3},
            {"op": "add", "path": "/view/slices/center", "value": [20, 150, 250]},
        ]
    )

    def left_and_width(picture):
        report = picture.report
        right, origin = np.array(report["right"]), np.array(report["origin"])
        return right @ origin - report["pixel"] / 2, report["pixel"] * picture.size[0]

    whole, small = (left_and_width(slice_of(state, pane, size, scale=one)) for one in (1, scale))
    assert small == pytest.approx(whole, abs=1e-9)


def test_the_centre_is_in_the_middle_of_every_pane(pelvis):
    center = [20.0, 150.0, 250.0]
    state = pelvis.patched([{"op": "add", "path": "/view/slices/center", "value": center}])
    for pane in PANES:
        report = slice_of(state, pane, (101, 101)).report
        right, down, origin = (np.array(report[name]) for name in ("right", "down", "origin"))
        middle = origin + 50 * report["pixel"] * (right + down)
        assert [right @ middle, down @ middle] == pytest.approx([right @ center, down @ center])


def decoded(state, pane, size):
    found = slice_values(state, pane, size)
    header = {"width": size[0], "height": size[1], "values": found.header}
    return found, viewer_fakes.decoded_values(header, found.payload)


@pytest.mark.parametrize("samples", [np.arange(4096, dtype=np.int16) - 1024, np.arange(4096, dtype=np.uint8)])
def test_whole_numbers_on_samples_stay_whole(samples):
    volume = ws.Volume(samples.reshape(16, 16, 16), facts=facts("MR"))
    state = ViewerState.of(ws.Scene(volume, "grey"))
    _, (values,) = decoded(state, "z", (16, 16))
    picture = slice_of(state, "z", (16, 16))
    on_sample = np.abs(picture.value - np.rint(picture.value)) < 1e-4
    assert np.array_equal(values[on_sample], np.rint(picture.value[on_sample]))
    assert values == pytest.approx(picture.value, abs=0.05)


def test_values_of_layers_and_labels_come_with_their_colours():
    scan = ws.examples.ct_pelvis()
    spot = ws.Volume(
        (scan.samples > 200).astype(np.float32) * 10, world_from_index=scan.world_from_index, facts=facts("PT")
    )
    marks = (scan.samples > 400).astype(np.uint8) * 7
    over = ws.Layer(spot, ws.TransferFunction.from_colormap("hot", clim=(2, 8), opacity="linear"), opacity=0.5)
    labels = ws.Labels(marks, {7: ws.Label("red", name="bone")})
    state = ViewerState.of(ws.Scene([ws.Layer(scan, "ct-bone"), over], labels=labels))
    found, (first, second, codes) = decoded(state, "y", (80, 60))
    assert [layer["kind"] for layer in found.header["layers"]] == ["window", "over"]
    assert found.header["layers"][1]["lowest"] == 2
    y = state.view["slices"]["crosshair"][1]
    for values, volume in ((first, scan), (second, spot)):
        assert values == pytest.approx(ws.slice(volume, "coronal", y, size=(80, 60)).value, abs=0.05, nan_ok=True)
    names = found.header["labels"]["names"]
    assert "bone" in {names[code] for code in np.unique(codes)}
    assert names[-1] is None


def test_the_page_follows_window_and_opacity_by_itself(pelvis):
    def changes(*operation):
        return changes_slices(pelvis, pelvis.patched([dict(zip(("op", "path", "value"), operation, strict=True))]))

    assert not changes("add", "/view/slices/window", [60, 20])
    assert not changes("replace", "/layers/0/opacity", 0.5)
    assert not changes("replace", "/layers/0/look/shading", None)
    assert changes("replace", "/layers/0/opacity", 0)
    assert changes("replace", "/view/slices/zoom", 2)
    assert changes("add", "/view/slices/colors", "hot")
    assert changes("replace", "/render/kernel", "bspline3")
