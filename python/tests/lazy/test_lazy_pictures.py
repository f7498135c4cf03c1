"""Volumes whose samples are read as they are drawn give the bytes of those in memory."""

from __future__ import annotations

import numpy as np
import pytest
from lazy_fakes import Chunked, shells

import wavesplat as ws

KERNELS = ("linear", "catmull-rom", "bspline2", "bspline3", "gaussian")
OPERATORS = (
    "over",
    "maximum",
    "depth-shaded-maximum",
    "depth-colored-maximum",
    "attenuated-maximum",
    "local-maximum",
    "minimum",
    "mean",
    "sum",
    "x-ray",
    ws.FirstHit(250.0),
)


def _pelvis():
    """A scan whose table is out of the samples: lazy volumes are drawn with it, others without."""
    volume = ws.examples.ct_pelvis()
    samples = np.array(volume.samples)
    samples[:, :13] = -1000
    return ws.Volume(samples, world_from_index=volume.world_from_index, facts=volume.facts, name=volume.name)


def lazily(volume, chunks=(17, 23, 29), memory="40 MB", **options):
    """A lazy copy of a volume, read in chunks."""
    made = ws.Volume.lazy(
        Chunked(np.array(volume.samples), chunks),
        world_from_index=volume.world_from_index,
        facts=volume.facts,
        name=volume.name,
        memory=memory,
        cache=False,
        **options,
    )
    assert made.shape == volume.shape
    return made


def same(first, second):
    """Whether two pictures are the same to the byte, depth and values included."""
    planes = [(first.rgba, second.rgba), (first.depth, second.depth), (first.value, second.value)]
    return all(
        (a is None and b is None) or (a.tobytes() == b.tobytes() if a is not None and b is not None else False)
        for a, b in planes
    )


def cameras(volume):
    inside = np.mean(volume.bounds, axis=0)
    return {
        "parallel": ws.Camera.orbit(volume, 30, 20),
        "from below": ws.Camera.orbit(volume, -140, -35),
        "along x": ws.Camera.orbit(volume, 90, 0),
        "perspective": ws.Camera.orbit(volume, 40, 25, view_angle=45),
        "corner": ws.Camera.orbit(volume, 45, 35.264, view_angle=60),
        "inside": ws.Camera(tuple(inside), tuple(np.add(inside, (9, 7, 5))), (0, 0, 1), view_angle=100),
    }


@pytest.mark.parametrize("operator", OPERATORS, ids=str)
@pytest.mark.parametrize("kernel", KERNELS)
def test_every_operator_and_kernel(operator, kernel):
    volume = _pelvis()
    look = "ct-soft-tissue" if operator == "over" else ws.Look.auto(volume, getattr(operator, "name", None) or "over")
    camera = cameras(volume)["perspective"]
    options = {"size": (90, 70), "kernel": kernel, "composite": operator, "depth": operator == "over"}
    options["depth"] = operator == "over" or isinstance(operator, ws.FirstHit)
    assert same(
        ws.render(volume, look, camera, **options),
        ws.render(lazily(volume), look, camera, **options),
    )


@pytest.mark.parametrize("name", cameras(_pelvis()))
@pytest.mark.parametrize("preset", ["ct-bone", "ct-soft-tissue"])
def test_every_camera(name, preset, is_night):
    volume = _pelvis()
    camera = cameras(volume)[name]
    for chunks in ((17, 23, 29), (112, 8, 8), (1, 101, 122), (500, 500, 500))[: 4 if is_night else 2]:
        lazy = lazily(volume, chunks)
        assert same(
            ws.render(volume, preset, camera, size=(120, 90)), ws.render(lazy, preset, camera, size=(120, 90))
        ), chunks


def _with_holes():
    samples = shells(48, np.float32)
    samples[10:14, 20:30, 5:9] = np.nan
    samples[30, 30, 30] = np.inf
    return ws.Volume(samples, spacing=(1, 1.2, 0.8))


def _sheared():
    matrix = np.eye(4)
    matrix[:3, :3] = [[1.0, 0.3, 0.0], [-0.1, 1.1, 0.2], [0.0, 0.0, -0.7]]
    return ws.Volume(shells(48, np.uint16) * 100, world_from_index=matrix)


VOLUMES = {
    "int8": lambda: ws.Volume(shells(40, np.float32).astype(np.int8)),
    "uint16": lambda: ws.Volume(shells(40, np.uint16) * 200),
    "int32 far from 0": lambda: ws.Volume(shells(40, np.int32) + 10**9),
    "float64": lambda: ws.Volume(shells(40, np.float64) * 1e-12),
    "holes": _with_holes,
    "sheared": _sheared,
    "mri": ws.examples.mri_head,
}


@pytest.mark.parametrize("kind", VOLUMES)
@pytest.mark.parametrize("kernel", ["linear", "bspline3"])
def test_every_kind_of_samples(kind, kernel):
    volume = VOLUMES[kind]()
    lazy = lazily(volume)
    assert (lazy.value_range, lazy.n_nonfinite, lazy.dtype) == (volume.value_range, volume.n_nonfinite, volume.dtype)
    low, high = volume.value_range
    span = high - low
    look = ws.Look(
        transfer_function=ws.TransferFunction(
            [(low + 0.2 * span, 0.0), (low + 0.5 * span, 0.1), (high, 0.7)], [(low, 1, 0.4, 0.2), (high, 1, 1, 1)]
        )
    )
    camera = ws.Camera.orbit(volume, 25, 35)
    options = {"size": (80, 60), "kernel": kernel, "depth": True}
    assert same(ws.render(volume, look, camera, **options), ws.render(lazy, look, camera, **options))


SCENES = {
    "light and shadow": {"shading": ws.Shading(ambient_occlusion=0.6, shadow=0.5)},
    "no light": {"shading": None},
    "crop in samples": {"clip": ws.Crop((10, 20, 30), (90, 80, 70), space="index")},
    "plane": {"clip": ws.ClipPlane((0, 0, 0), (0.3, 1, 0.2))},
    "background": {"background": "white"},
}


@pytest.mark.parametrize("name", SCENES)
def test_light_clips_and_backgrounds(name):
    volume = _pelvis()
    given = SCENES[name]
    pictures = [ws.Scene(one, "ct-bone", **given).render("front", size=(100, 90)) for one in (volume, lazily(volume))]
    assert same(*pictures)


def test_gradient_opacity_and_functions_of_two_dimensions():
    volume = _pelvis()
    by_gradient = ws.TransferFunction(
        [(-200, 0.0), (300, 0.4)], [(0, 1, 0.8, 0.6)], gradient_opacity=[(20, 0.0), (200, 1.0)]
    )
    values, magnitudes = np.linspace(-1000, 2000, 32), np.linspace(0, 1500, 16)
    rgba = np.ones((16, 32, 4)) * 0.5
    rgba[..., 3] = np.outer(np.linspace(0, 1, 16), np.linspace(0, 0.4, 32))
    for function in (by_gradient, ws.TransferFunction2D(values, magnitudes, rgba)):
        pictures = [ws.render(one, function, "left", size=(70, 60)) for one in (volume, lazily(volume))]
        assert same(*pictures)


def test_labels_lie_beside_a_lazy_volume():
    volume = _pelvis()
    codes = (np.array(volume.samples) > 250).astype(np.uint8)
    labels = ws.Labels(codes, {1: ws.Label("red", opacity=0.6)})
    pictures = [
        ws.Scene(one, "ct-soft-tissue", labels=labels).render("front", size=(70, 60))
        for one in (volume, lazily(volume))
    ]
    assert same(*pictures)


def test_several_layers_of_which_some_are_lazy():
    volume = _pelvis()
    spots = ws.Volume(
        np.roll(np.array(volume.samples), 20, axis=2), world_from_index=volume.world_from_index, name="spots"
    )
    look = ws.TransferFunction([(200, 0.0), (900, 0.4)], [(0, 0.2, 1.0, 0.3)])
    layers = [ws.Layer(volume, "ct-soft-tissue"), ws.Layer(spots, look, opacity=0.7)]
    whole = ws.Scene(layers).render("front", size=(70, 60))
    for lazy in ([0], [1], [0, 1]):
        mixed = [
            ws.Layer(lazily(one.volume), one.look, opacity=one.opacity) if k in lazy else one
            for k, one in enumerate(layers)
        ]
        assert same(whole, ws.Scene(mixed).render("front", size=(70, 60))), lazy


def test_the_plainest_call_frames_and_looks_as_in_memory():
    volume = _pelvis()
    assert same(ws.render(volume, size=(90, 90)), ws.render(lazily(volume), size=(90, 90)))


def test_the_picture_does_not_depend_on_threads_or_budget():
    volume = ws.Volume(shells(128))
    look = ws.TransferFunction([(60, 0.0), (200, 0.2)], [(0, 1.0, 0.8, 0.5)])
    whole = ws.render(volume, look, "isometric", size=(600, 500))
    blocks = set()
    for memory, threads in (("1 GB", 1), ("1 MB", 2), ("600 kB", 1)):
        picture = ws.render(lazily(volume, (16, 16, 16), memory), look, "isometric", size=(600, 500), threads=threads)
        assert same(whole, picture), memory
        blocks.add(picture.report["lazy"]["blocks"])
    assert len(blocks) > 1


def test_slices_are_read_alone():
    volume = _pelvis()
    lazy = lazily(volume, (8, 8, 8))
    array = lazy.arrays(0)
    array.counts.clear()
    for plane in ("axial", "coronal", ((0, 0, 0), (1, 0.3, 0.5))):
        assert same(ws.slice(volume, plane, window=(0, 1000)), ws.slice(lazy, plane, window=(0, 1000)))
    lazy = lazily(volume, (8, 8, 8))
    array = lazy.arrays(0)
    ws.slice(lazy, "axial", window=(0, 1000))
    # Coefficients reach 20 samples beyond the plane.
    n_chunks = np.prod([-(-n // 8) for n in volume.shape])
    assert 0 < len(array.counts) < 0.5 * n_chunks
    assert max(array.counts.values()) == 1


@pytest.mark.parametrize(
    "call",
    [
        lambda lazy: lazy.samples,
        lambda lazy: lazy.smoothed(1),
        ws.WaveletVolume.from_volume,
        lambda lazy: ws.mesh(lazy, 200),
        ws.largest_body,
        lambda lazy: ws.reference.raycast(lazy, "ct-bone", size=(8, 8)),
        lambda lazy: ws.render(lazy, "ct-bone", clip=ws.CutOut(ws.Crop((0, 0, 0), (9, 9, 9)))),
    ],
)
def test_what_needs_all_samples_is_refused_by_name(call):
    with pytest.raises(ws.errors.ArgumentError, match=r"lazy.*volume\.read"):
        call(lazily(_pelvis()))


@pytest.mark.filterwarnings("ignore:OME:wavesplat.errors.WavesplatWarning")
@pytest.mark.parametrize("name", ["a.nii", "a.nrrd", "a.ome.tif", "a.ome.zarr"])
def test_files_have_all_samples(tmp_path, name):
    volume = _pelvis()
    lazily(volume).save(tmp_path / name)
    np.testing.assert_array_equal(ws.open(tmp_path / name).samples, volume.samples)


def test_a_wanted_psnr_is_refused():
    with pytest.raises(ws.errors.ArgumentError, match="psnr.*lazy"):
        ws.render(lazily(_pelvis()), "ct-bone", psnr=40)


def test_a_part_is_read_into_memory():
    volume = _pelvis()
    lazy = lazily(volume)
    part = lazy.read(ws.Crop((10, 20, 30), (40, 50, 60), space="index"))
    assert np.array_equal(part.samples, volume.samples[30:61, 20:51, 10:41])
    place = part.world_from_index @ [0, 0, 0, 1]
    assert np.allclose(place, volume.world_from_index @ [10, 20, 30, 1])
    assert np.array_equal(np.asarray(lazy), volume.samples)


def test_segments_are_the_same_wherever_they_are_cut():
    volume = ws.Volume(shells(96))
    look = ws.TransferFunction([(60, 0.0), (200, 0.2)], [(0, 1.0, 0.8, 0.5)])
    whole = ws.render(volume, look, "isometric", size=(200, 160))
    cut = ws.render(volume, look, "isometric", size=(200, 160), segments=20)
    for chunks, memory in (((17, 23, 29), "40 MB"), ((32, 32, 32), "3 MB")):
        assert same(cut, ws.render(lazily(volume, chunks, memory), look, "isometric", size=(200, 160), segments=20))
    off = np.abs(whole.rgba - cut.rgba).max()
    assert 0 < off < 3e-4
    with pytest.raises(ws.errors.ArgumentError, match="segments"):
        ws.render(volume, look, "isometric", size=(20, 16), segments=20, depth=True)
