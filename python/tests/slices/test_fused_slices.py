"""Slices of several volumes, against the mixture by hand."""

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import ArgumentError

SCAN = ws.examples.ct_pelvis()
HOT = ws.TransferFunction([(2, 0), (6, 0.5)], [(2, 1, 0, 0), (6, 1, 1, 0)])


def uptake(spacing: float = 9.0) -> ws.Volume:
    """A hot ball in the middle of the scan, on a coarser grid that ends within it."""
    middle = np.mean(SCAN.bounds, axis=0)
    affine = np.diag([spacing, spacing, spacing, 1.0])
    affine[:3, 3] = middle - 6 * spacing
    z, y, x = np.mgrid[-6:7, -6:7, -6:7]
    values = (8 - 1.2 * np.sqrt(x**2 + y**2 + z**2)).astype(np.float32)
    return ws.Volume(values, world_from_index=affine, unit="mm", anatomical=True, name="uptake")


def mixed(below: ws.Picture, values: np.ndarray, opacity: float) -> np.ndarray:
    rgba = HOT(values.ravel()).reshape(*values.shape, 4)
    alpha = np.where(np.isfinite(values), opacity * rgba[..., 3] / 0.5, 0)[..., None]
    return np.where(alpha > 0, rgba[..., :3], 0) * alpha + (1 - alpha) * below.rgba[..., :3]


@pytest.mark.parametrize("plane", ["axial", "coronal", (tuple(np.mean(SCAN.bounds, axis=0)), (1, 2, 3))])
@pytest.mark.parametrize("opacity", [1.0, 0.6])
def test_a_layer_lies_over_the_slice_at_the_same_places(plane, opacity):
    pet = uptake()
    below = ws.slice(SCAN, plane, size=(90, 80), window="abdomen")
    fused = ws.slice([SCAN, ws.Layer(pet, HOT, opacity=opacity)], plane, size=(90, 80), window="abdomen")
    right, down = (np.array(below.report[name]) * below.report["pixel"] for name in ("right", "down"))
    columns, rows = np.arange(90)[None, :, None], np.arange(80)[:, None, None]
    places = np.array(below.report["origin"]) + columns * right + rows * down
    index = (places - pet.world_from_index[:3, 3]) / 9.0
    values = trilinear(pet.samples, index)
    np.testing.assert_allclose(fused.rgba[..., :3], mixed(below, values, opacity), atol=2e-5)
    assert np.array_equal(fused.value, below.value, equal_nan=True)
    outside = ~np.isfinite(values)
    assert outside.any()
    assert (np.abs(fused.rgba - below.rgba).max(axis=2) > 0.1).any()
    assert np.array_equal(fused.rgba[outside], below.rgba[outside])
    assert [layer["name"] for layer in fused.report["shown"]] == ["CT", "uptake"]


def trilinear(samples: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Values at index positions (x, y, z); NaN outside."""
    last = np.array(samples.shape[::-1]) - 1
    inside = ((index >= -1e-9) & (index <= last + 1e-9)).all(axis=-1)
    first = np.clip(np.floor(index).astype(int), 0, last - 1)
    share = np.clip(index - first, 0, 1)
    total = np.zeros(index.shape[:-1])
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod([share[..., a] if corner[a] else 1 - share[..., a] for a in range(3)], axis=0)
        x, y, z = (first[..., a] + corner[a] for a in range(3))
        total += weight * samples[z, y, x]
    return np.where(inside, total, np.nan)


def test_layers_that_are_not_shown_and_slabs():
    pet = uptake()
    alone = ws.slice(SCAN, size=(60, 50), thickness=20)
    for hidden in (ws.Layer(pet, HOT, visible=False), ws.Layer(pet, HOT, opacity=0)):
        assert np.array_equal(ws.slice([SCAN, hidden], size=(60, 50), thickness=20).rgba, alone.rgba)
    scene = ws.Scene([SCAN, ws.Layer(pet, HOT)])
    above = float(np.mean(SCAN.bounds, axis=0)[2]) + 25
    thin, thick = (ws.slice(scene, "axial", above, size=(60, 50), thickness=t).rgba for t in (0, 60))
    # The maximum across a slab that reaches the middle of the ball is hot in more places.
    assert (thick[..., 0] - thick[..., 2] > 0.3).sum() > (thin[..., 0] - thin[..., 2] > 0.3).sum()


def over(below: np.ndarray, values: np.ndarray, curves: ws.TransferFunction, opacity: float = 1.0) -> np.ndarray:
    """A layer composited over a picture, by the opacity of its values."""
    rgba = curves(np.nan_to_num(values).ravel()).reshape(*values.shape, 4)
    alpha = np.where(np.isfinite(values), rgba[..., 3] / max(a for _, a in curves.opacity) * opacity, 0)[..., None]
    return np.concatenate([rgba[..., :3] * alpha, alpha], axis=2) + (1 - alpha) * below


def test_layers_are_laid_over_each_other_in_their_order():
    cold = ws.TransferFunction([(3, 0), (8, 1)], [(3, 0, 0, 1), (8, 0, 1, 1)])
    warm, blue = ws.Layer(uptake(), HOT, opacity=0.7), ws.Layer(uptake(6.0), cold, opacity=0.9)
    how = {"plane": "sagittal", "size": (70, 60)}
    alone = ws.slice(SCAN, **how).rgba
    picture = ws.slice([SCAN, warm, blue], **how)
    # Values of the volumes alone, at the same places.
    values = [ws.slice([ws.Layer(SCAN, visible=False), layer], **how) for layer in (warm, blue)]
    assert all(np.array_equal(one.value, picture.value, equal_nan=True) for one in values)
    samples = [sampled(layer.volume, picture) for layer in (warm, blue)]
    np.testing.assert_allclose(picture.rgba, over(over(alone, samples[0], HOT, 0.7), samples[1], cold, 0.9), atol=2e-5)
    assert not np.allclose(picture.rgba, ws.slice([SCAN, blue, warm], **how).rgba, atol=0.05)


def sampled(volume: ws.Volume, picture: ws.Picture) -> np.ndarray:
    """The values of a volume, on a grid in any direction, at the pixels of a slice."""
    report, (width, height) = picture.report, picture.size
    right, down = (np.array(report[name]) * report["pixel"] for name in ("right", "down"))
    columns, rows = np.arange(width)[None, :, None], np.arange(height)[:, None, None]
    places = np.array(report["origin"]) + columns * right + rows * down
    inverse = np.linalg.inv(volume.world_from_index)
    return trilinear(volume.samples, places @ inverse[:3, :3].T + inverse[:3, 3])


def test_a_layer_may_lie_in_any_direction():
    turn, middle = np.eye(4), np.mean(SCAN.bounds, axis=0)
    turn[:3, :3] = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, -1]])
    turn[:3, 3] = middle - turn[:3, :3] @ middle
    straight = uptake()
    turned = straight.samples[:, :, ::-1].copy()
    oblique = ws.Volume(turned, world_from_index=turn @ straight.world_from_index, unit="mm", name="oblique")
    picture, alone = (ws.slice(what, size=(90, 80)) for what in ([SCAN, ws.Layer(oblique, HOT)], SCAN))
    np.testing.assert_allclose(picture.rgba, over(alone.rgba, sampled(oblique, picture), HOT), atol=1e-4)


def test_an_even_opacity_shows_from_the_low_end_on():
    how = {"size": (90, 80)}
    alone = ws.slice(SCAN, **how)
    even = ws.TransferFunction.from_colormap("hot", clim=(4, 8), opacity=1.0)
    values = sampled(uptake(), alone)
    for opacity in (1.0, 0.4):
        picture = ws.slice([SCAN, ws.Layer(uptake(), even, opacity=opacity)], **how)
        want = over(alone.rgba, np.where(values >= 4, values, np.nan), even, opacity)
        is_sure = ~(np.abs(values - 4) < 1e-4)
        np.testing.assert_allclose(picture.rgba[is_sure], want[is_sure], atol=2e-5)


def test_maps_of_two_signs_show_all_that_lies_beyond_their_ends():
    signed = ws.Volume(-uptake().samples, world_from_index=uptake().world_from_index, unit="mm")
    picture = ws.slice([SCAN, ws.Layer(signed, ws.TransferFunction.diverging(3))], size=(91, 81))
    np.testing.assert_allclose(picture.rgba[40, 45, :3], (0.23, 0.30, 0.75), atol=1e-5)  # -8


def test_the_first_volume_decides_the_plane_also_where_it_does_not_show():
    pet, alone = uptake(), ws.slice(SCAN, background="white")
    for first, share in ((ws.Layer(SCAN, visible=False), 0.0), (ws.Layer(SCAN, opacity=0.25), 0.25)):
        picture = ws.slice([first, ws.Layer(pet, HOT)], background="white")
        assert np.array_equal(picture.value, alone.value, equal_nan=True)
        want = over(share * alone.rgba + (1 - share), sampled(pet, picture), HOT)
        np.testing.assert_allclose(picture.rgba, want, atol=2e-5)
    hidden = ws.slice([ws.Layer(SCAN, visible=False), ws.Layer(pet, HOT)])
    assert [shown["name"] for shown in hidden.report["shown"]] == ["uptake"]
    assert [layer["opacity"] for layer in hidden.report["layers"]] == [0.0, 1.0]


def test_a_layer_without_a_look_is_coloured():
    fine, coarse = (
        ws.Volume(grid.samples.clip(0), world_from_index=grid.world_from_index, unit="mm", name="uptake")
        for grid in (uptake(6.0), uptake())
    )
    picture = ws.slice([SCAN, coarse, fine], size=(91, 81))
    first, second = (ws.TransferFunction(**shown_curves(picture, n)) for n in (1, 2))
    assert first.color[-1][1:] == (1, 1, 1)  # the colours of "hot", not greys or the colours of tissue
    assert first.color != second.color
    chosen = ws.slice([SCAN, ws.Layer(coarse, first), ws.Layer(fine, second)], size=(91, 81))
    assert np.array_equal(picture.rgba, chosen.rgba)
    assert np.ptp(picture.rgba[..., :3], axis=2).max() > 0.5


def shown_curves(picture: ws.Picture, number: int) -> dict[str, object]:
    fields = picture.report["shown"][number]["transfer_function"]
    return {name: fields[name] for name in ("opacity", "color")}


def test_a_series_is_cut_at_the_time_of_its_layer():
    faint = ws.Volume(uptake().samples / 2, world_from_index=uptake().world_from_index, unit="mm", anatomical=True)
    series = ws.Series([faint, uptake()])
    for time, volume in enumerate((faint, uptake())):
        picture = ws.slice([SCAN, ws.Layer(series, HOT, time=time)], size=(60, 50))
        assert np.array_equal(picture.rgba, ws.slice([SCAN, ws.Layer(volume, HOT)], size=(60, 50)).rgba)
        assert picture.report["layers"][1]["time"] == time
    assert np.array_equal(ws.slice(ws.Layer(series, time=1)).value, ws.slice(uptake()).value)


def test_every_layer_has_the_slabs_planes_of_its_own_samples():
    # A layer that is thin against the distance of the scan's planes, and far from the middle one.
    affine = np.diag([9.0, 9.0, 0.2, 1.0])
    affine[:3, 3] = np.mean(SCAN.bounds, axis=0) + np.array([-54, -54, 31.3])
    sheet = np.zeros((9, 13, 13), np.float32)
    sheet[4] = 8
    layer = ws.Layer(ws.Volume(sheet, world_from_index=affine, unit="mm"), HOT)
    alone, thin, thick = (
        ws.slice(what, size=(91, 81), thickness=thickness)
        for what, thickness in ((SCAN, 80), ([SCAN, layer], 40), ([SCAN, layer], 80))
    )
    np.testing.assert_allclose(thick.rgba[40, 45], (1, 1, 0, 1), atol=1e-5)
    assert "no part of it lies in the picture" in thin.report["notes"][0]
    assert np.array_equal(thick.value, alone.value, equal_nan=True)


def test_pictures_do_not_depend_on_how_many_rows_are_mixed_at_once(monkeypatch):
    layers = [SCAN, ws.Layer(uptake(), HOT, opacity=0.5), uptake(6.0)]
    whole = ws.slice(layers, size=(61, 53)).rgba
    monkeypatch.setattr("wavesplat._scene.slices.layers_on_slices.PIXELS_AT_ONCE", 200)
    assert np.array_equal(ws.slice(layers, size=(61, 53)).rgba, whole)


def test_notes_say_why_a_layer_does_not_show():
    affine = uptake().world_from_index.copy()
    affine[0, 3] += 5000
    far = ws.Volume(uptake().samples, world_from_index=affine, unit="mm", name="far")
    high = ws.TransferFunction.from_colormap("hot", clim=(20, 30))
    scene = ws.Scene([SCAN, ws.Layer(far, HOT), ws.Layer(uptake(), high)], clip=ws.ClipPlane((0, 0, 0), (0, 0, 1)))
    picture = ws.slice(scene, size=(40, 30))
    outside, below, left_out = picture.report["notes"]
    assert "the layer 'far' does not show: no part of it lies in the picture; it lies at x " in outside
    assert "the layer 'uptake' does not show: its values there, " in below
    assert below.endswith("are clear in its look, which shows values from 20 on")
    assert left_out == "left out of the slice, since for pictures in space: the scene's clip"
    assert np.array_equal(picture.rgba, ws.slice(SCAN, size=(40, 30)).rgba)


def test_bars_and_legend_of_several_layers_stand_in_one_column():
    picture = ws.slice([ws.Layer(SCAN, name="CT"), ws.Layer(uptake(), HOT, name="uptake of the day")], size=(300, 300))
    legend, both = (picture.annotated(legend=True, colorbar=colorbar).size for colorbar in (False, True))
    assert both == legend


def test_what_cannot_be():
    microns = ws.Volume(uptake().samples, world_from_index=uptake().world_from_index, unit="um", name="cells")
    with pytest.raises(ArgumentError, match="are in mm, the lengths of 'cells' in um; open one of them with"):
        ws.slice([SCAN, ws.Layer(microns, HOT)])
    joint = ws.TransferFunction2D([0, 1], [0, 1], np.zeros((2, 2, 4)) + 0.5)
    with pytest.raises(ArgumentError, match="give the layer 'uptake' a TransferFunction"):
        ws.slice([SCAN, ws.Layer(uptake(), joint)])


def test_the_command_line_fuses(wavesplat, tmp_path):
    SCAN.save(tmp_path / "ct.nii.gz")
    uptake().save(tmp_path / "pet.nii.gz")
    options = ["--layer", f"{tmp_path / 'pet.nii.gz'}:hot:2,8", "--plane", "coronal", "--size", "80x70", "--colorbar"]
    done = wavesplat("slice", tmp_path / "ct.nii.gz", "-o", tmp_path / "fused.png", *options)
    assert done.returncode == 0, done.stderr
    hot = ws.TransferFunction.from_colormap("hot", clim=(2, 8), opacity="linear")
    volumes = [ws.open(tmp_path / name) for name in ("ct.nii.gz", "pet.nii.gz")]
    picture = ws.slice([volumes[0], ws.Layer(volumes[1], hot)], "coronal", size=(80, 70))
    picture.annotated(colorbar=True).save(tmp_path / "python.png")
    assert (tmp_path / "python.png").read_bytes() == (tmp_path / "fused.png").read_bytes()


def test_slices_of_a_series_have_one_window():
    volumes = [ws.Volume((scale * np.random.default_rng(0).random((6, 8, 9))).astype(np.float32)) for scale in (1, 10)]
    scene = ws.Scene(ws.Layer(ws.Series(volumes)))
    windows = [ws.slice(scene.at_time(time)).report["clim"] for time in range(2)]
    assert windows[0] == windows[1]
    assert windows[0][1] > 9


@pytest.mark.parametrize(
    ("look", "window", "threshold", "shown"),
    [
        ("hot", (3, 10), 60, "from 60 on"),
        ("hot", (20, 30), None, "from 20 on"),
        (None, None, 60, "up to -60, and from 60 on"),
        ("coolwarm", (-80, 80), 60, "up to -60, and from 60 on"),
        ("coolwarm", (60, 80), None, "up to -60, and from 60 on"),
    ],
)
def test_the_note_on_a_layer_below_its_threshold_names_the_threshold(look, window, threshold, shown):
    """It named the low end of the window: "which show from 3 on", of values of 4 that a threshold of 60 hid."""
    layer = ws.Layer.overlay(uptake(), look, window, threshold=threshold)
    (note,) = ws.slice([SCAN, layer], size=(40, 30)).report["notes"]
    assert note.endswith(f"are clear in its look, which shows values {shown}")
