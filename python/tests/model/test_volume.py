import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import wavesplat as ws
from wavesplat.errors import ArgumentError


def zeros(*shape, dtype=np.uint8):
    return np.zeros(shape, dtype)


def test_without_an_affine_the_first_sample_is_at_the_world_origin():
    volume = ws.Volume(zeros(4, 3, 2), spacing=(1, 2, 3))
    assert volume.shape == (4, 3, 2)
    assert volume.spacing == (1, 2, 3)
    np.testing.assert_array_equal(volume.bounds, [[0, 0, 0], [1, 4, 9]])


def test_bounds_follow_the_affine(oblique):
    volume = ws.Volume(oblique.samples, world_from_index=oblique.world_from_index)
    last = oblique.world_from_index @ [6, 5, 4, 1]
    assert np.all(volume.bounds[0] <= last[:3])
    assert np.all(last[:3] <= volume.bounds[1])
    assert volume.spacing == pytest.approx((0.7, 0.8, 1.5))


@pytest.mark.parametrize(
    ("given_dtype", "expected"),
    [("?", "u1"), ("f2", "f4"), (">i2", "i2"), (">f8", "f8"), ("u1", "u1"), ("i4", "i4"), ("f8", "f8"), ("g", "f8")],
)
def test_sample_types(given_dtype, expected):
    samples = np.arange(8).reshape(2, 2, 2).astype(given_dtype)
    volume = ws.Volume(samples)
    assert volume.dtype == np.dtype(expected)
    np.testing.assert_array_equal(volume.samples, samples)


@pytest.mark.parametrize(
    ("lowest", "highest", "expected"),
    [
        (0, 200, "u1"),
        (-5, 100, "i1"),
        (-5, 200, "i2"),
        (0, 60000, "u2"),
        (-1, 70000, "i4"),
        (0, 2**32 - 1, "u4"),
        (0, 2**40, "f8"),
    ],
)
def test_64_bit_integers_take_the_narrowest_exact_type(lowest, highest, expected):
    samples = np.full((2, 2, 2), lowest, np.int64)
    samples[1, 1, 1] = highest
    volume = ws.Volume(samples)
    assert volume.dtype == np.dtype(expected)
    assert volume.value_range == (lowest, highest)


def test_contiguous_samples_are_shared_and_protected():
    samples = zeros(3, 3, 3)
    volume = ws.Volume(samples)
    assert np.shares_memory(volume.samples, samples)
    with pytest.raises(ValueError, match="read-only"):
        volume.samples[0, 0, 0] = 1
    samples[0, 0, 0] = 1  # the caller's own array stays writable


@pytest.mark.parametrize("kernel", ["linear", "bspline3"])
def test_a_changed_array_is_drawn_as_a_new_volume_is(kernel):
    def drawn(volume):
        # The histogram, the bricks that a function shows, and the kernel's prefiltered samples all follow the samples.
        picture = ws.render(volume, kernel=kernel, size=(24, 24))
        return picture.rgba, ws.slice(volume, size=(24, 24), kernel=kernel).rgba

    samples = np.zeros((16, 16, 16), np.float32)
    samples[2:9, 2:6, 2:6] = 10
    volume = ws.Volume(samples)
    before = drawn(volume)
    samples[2:9, 2:6, 2:6] = 0
    samples[9:14, 8:15, 9:13] = 300
    samples[0, 0, 0] = np.nan
    volume.changed()
    assert (volume.value_range, volume.n_nonfinite) == ((0, 300), 1)
    for now, wanted, then in zip(drawn(volume), drawn(ws.Volume(samples.copy())), before, strict=True):
        np.testing.assert_array_equal(now, wanted)
        assert not np.array_equal(now, then)


def test_a_change_that_leaves_no_volume_is_refused():
    samples = np.ones((2, 2, 2), np.float32)
    volume = ws.Volume(samples, name="scan")
    samples[:] = np.nan
    with pytest.raises(ArgumentError, match='"scan".*none of its 8 samples is finite'):
        volume.changed()


def test_a_view_with_strides_is_copied_right():
    samples = np.arange(4 * 6 * 8, dtype=np.int16).reshape(4, 6, 8)
    np.testing.assert_array_equal(ws.Volume(samples[::2, ::-1, ::4]).samples, samples[::2, ::-1, ::4])


def test_not_finite_samples_are_counted():
    samples = np.ones((3, 3, 3), np.float32)
    samples[0, 0, :2] = np.nan, np.inf
    samples[1, 1, 1] = 5
    volume = ws.Volume(samples)
    assert (volume.n_nonfinite, volume.value_range) == (2, (1, 5))


def test_masked_samples_are_empty():
    samples = np.ma.masked_equal(np.arange(8).reshape(2, 2, 2), 3)
    assert ws.Volume(samples).n_nonfinite == 1


@pytest.mark.parametrize(
    ("samples", "message"),
    [
        (zeros(3, 3), "2-D.*np.stack"),
        (zeros(2, 3, 4, 5), r"4-D.*one time point.*array\[n\] with n = 0..1"),
        (zeros(3), r"1-D.*\[z, y, x\]"),
        (zeros(3, 0, 3), "no samples"),
        (zeros(1, 3, 3), "fewer than 2 samples"),
        (np.zeros((2, 2, 2), complex), "complex128.*np.abs"),
        (np.full((2, 2, 2), "a"), "not real numbers"),
        (np.full((2, 2, 2), None), "object.*astype"),
        (np.full((2, 2, 2), np.nan), "none of its 8 samples is finite"),
    ],
)
def test_arrays_that_are_no_volume_are_refused_with_a_way_out(samples, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Volume(samples, name="scan")


@pytest.mark.parametrize("spacing", [(0, 1, 1), (1, -1, 1), (1, 1, np.nan), (1, 1), 3, (1, np.inf, 1)])
def test_bad_spacing_is_refused(spacing):
    with pytest.raises(ArgumentError, match="spacing is"):
        ws.Volume(zeros(2, 2, 2), spacing=spacing)


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.zeros((4, 4)), "world_from_index"),
        (np.diag([1, 1, 0, 1]), "world_from_index"),
        (np.full((4, 4), np.nan), "world_from_index"),
        (np.eye(3), r"shape \(3, 3\).*\(4, 4\)"),
    ],
)
def test_degenerate_affines_are_refused(matrix, message):
    with pytest.raises(ArgumentError, match=message):
        ws.Volume(zeros(2, 2, 2), world_from_index=matrix)


def test_spacing_and_affine_exclude_each_other():
    with pytest.raises(ArgumentError, match="both spacing and world_from_index"):
        ws.Volume(zeros(2, 2, 2), spacing=(1, 1, 1), world_from_index=np.eye(4))


@given(st.permutations(range(3)), st.tuples(*[st.sampled_from([-1, 1])] * 3))
def test_orientation_names_every_axis_order_and_flip(order, signs):
    matrix = np.eye(4)
    matrix[:3, :3] = np.eye(3)[:, order] * signs
    letters = [("LR", "PA", "IS")[axis][sign > 0] for axis, sign in zip(order, signs, strict=True)]
    assert ws.Volume(zeros(2, 2, 2), world_from_index=matrix).orientation == "".join(letters)


def test_volumes_can_be_pickled(oblique):
    volume = ws.Volume(oblique.samples, world_from_index=oblique.world_from_index, name="scan")
    again = pickle.loads(pickle.dumps(volume))  # noqa: S301 - our own bytes
    np.testing.assert_array_equal(again.samples, volume.samples)
    np.testing.assert_array_equal(again.world_from_index, volume.world_from_index)
    assert again.name == "scan"
