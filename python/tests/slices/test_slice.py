"""Slices: values, positions, annotations, and errors."""

import json

import numpy as np
import pytest

import wavesplat as ws
from wavesplat.errors import WavesplatWarning

KERNELS = ("linear", "catmull-rom", "bspline2", "bspline3", "gaussian")

#: Pictures of samples [z, y, x] in RAS order: rows from the top, columns from the left.
PICTURES = {
    "axial": lambda samples, i: samples[i, ::-1, ::-1],
    "coronal": lambda samples, i: samples[::-1, i, ::-1],
    "sagittal": lambda samples, i: samples[::-1, ::-1, i],
}
AXES = {"axial": 2, "coronal": 1, "sagittal": 0}
SAMPLES = np.random.default_rng(3).integers(-1000, 3000, (5, 6, 7)).astype(np.int16)


def in_memory_order(order):
    """The volume with its index axes in another order and direction: "LPS", "SAR", ..."""
    samples, world_from_ras = SAMPLES, np.diag([2.0, 2.0, 2.0, 1.0])
    world_from_ras[:3, 3] = (-5, 8, 40)
    ras_from_index = np.zeros((4, 4))
    ras_from_index[3, 3] = 1
    axes = [next(n for n, pair in enumerate(("LR", "PA", "IS")) if letter in pair) for letter in order]
    for column, (axis, letter) in enumerate(zip(axes, order, strict=True)):
        flipped = letter in "LPI"
        ras_from_index[axis, column] = -1 if flipped else 1
        ras_from_index[axis, 3] = SAMPLES.shape[2 - axis] - 1 if flipped else 0
        if flipped:
            samples = np.flip(samples, 2 - axis)
    samples = samples.transpose([2 - axis for axis in reversed(axes)])
    return ws.Volume(samples, world_from_index=world_from_ras @ ras_from_index, anatomical=True)


@pytest.mark.parametrize("order", ["RAS", "LPS", "LAS", "SAR", "PIR"])
@pytest.mark.parametrize("plane", PICTURES)
def test_slices_through_samples_are_the_samples(plane, order):
    volume = in_memory_order(order)
    assert volume.orientation == order
    axis = AXES[plane]
    for i in range(SAMPLES.shape[2 - axis]):
        picture = ws.slice(volume, plane, (-5, 8, 40)[axis] + 2.0 * i)
        np.testing.assert_array_equal(picture.value, PICTURES[plane](SAMPLES, i))


@pytest.mark.parametrize("dtype", [np.uint8, np.int32, np.float32, np.float64])
def test_values_keep_what_float32_holds(dtype):
    samples = (np.random.default_rng(1).random((4, 5, 6)) * 200).astype(dtype)
    picture = ws.slice(ws.Volume(samples), "xy", 2)
    np.testing.assert_array_equal(picture.value, samples[2].astype(np.float32))


def test_the_middle_is_a_sample():
    np.testing.assert_array_equal(ws.slice(in_memory_order("RAS"), "coronal").value, SAMPLES[::-1, 3, ::-1])


def world_of_pixels(picture):
    """World position of every pixel, shape (height, width, 3), from the report."""
    report = picture.report
    width, height = picture.size
    right, down = (np.array(report[name]) * report["pixel"] for name in ("right", "down"))
    return np.array(report["origin"]) + np.arange(height)[:, None, None] * down + np.arange(width)[:, None] * right


def index_of_pixels(picture, world_from_index):
    homogeneous = np.insert(world_of_pixels(picture), 3, 1, axis=2)
    return (homogeneous @ np.linalg.inv(world_from_index).T)[..., :3]


def ramp_of(oblique):
    z, y, x = np.indices(oblique.samples.shape)
    world = np.stack([x, y, z], axis=-1) @ oblique.world_from_index[:3, :3].T + oblique.world_from_index[:3, 3]
    return ws.Volume(world @ np.array([2.0, -3.0, 5.0]), world_from_index=oblique.world_from_index, anatomical=True)


@pytest.mark.parametrize("normal", [(0, 0, 1), (1, 0, 0), (0.2, -0.5, 1), (1, 1, 1), (-3, 0.1, 0.2)])
@pytest.mark.parametrize("options", [{}, {"thickness": 1.5, "slab": "mean"}])
def test_a_ramp_is_exact_on_any_plane(oblique, normal, options):
    volume = ramp_of(oblique)
    middle = volume.bounds.mean(axis=0)
    picture = ws.slice(volume, (middle, normal), size=(50, 40), **options)
    world, index = world_of_pixels(picture), index_of_pixels(picture, oblique.world_from_index)
    assert np.abs((world - middle) @ np.array(normal)).max() < 1e-9
    is_inside = ((index >= 0) & (index <= np.array(volume.shape)[::-1] - 1)).all(axis=-1)
    if not options:
        np.testing.assert_array_equal(np.isfinite(picture.value), is_inside)
        assert 100 < is_inside.sum() < is_inside.size
    # A mean over a slab is the value in its middle where the whole slab is in the volume.
    n = np.array(normal) / np.linalg.norm(normal)
    reach = np.linalg.inv(oblique.world_from_index)[:3, :3] @ n * options.get("thickness", 0) / 2
    deep = ((index >= np.abs(reach)) & (index <= np.array(volume.shape)[::-1] - 1 - np.abs(reach))).all(axis=-1)
    assert deep.sum() > 30
    want = world @ np.array([2.0, -3.0, 5.0])
    np.testing.assert_allclose(picture.value[deep], want[deep], rtol=0, atol=2e-5)


def kernel_weight(kernel, x):
    r = np.abs(x)
    if kernel == "linear":
        return np.maximum(1 - r, 0)
    if kernel == "catmull-rom":
        near, far = (1.5 * r - 2.5) * r * r + 1, ((-0.5 * r + 2.5) * r - 4) * r + 2
        return np.where(r < 1, near, np.where(r < 2, far, 0))
    if kernel == "bspline2":
        return np.where(r < 0.5, 0.75 - r * r, np.where(r < 1.5, 0.5 * (1.5 - r) ** 2, 0))
    if kernel == "bspline3":
        return np.where(r < 1, 2 / 3 + r * r * (0.5 * r - 1), np.where(r < 2, np.maximum(2 - r, 0) ** 3 / 6, 0))
    return np.where(r < 2, np.exp(-2 * r * r), 0)


def weights_along(kernel, x, n):
    """Weights, shape (len(x), n), of each of n samples at each position; splines with their prefilter."""
    margin = 3
    places = np.arange(-margin, n + margin)
    direct = kernel_weight(kernel, x[:, None] - places)
    direct /= direct.sum(axis=1, keepdims=True)
    if kernel.startswith("bspline"):
        folded = np.where(places < 0, -places, np.where(places > n - 1, 2 * (n - 1) - places, places))
    else:
        folded = places.clip(0, n - 1)
    weights = np.zeros((len(x), n))
    np.add.at(weights.T, folded, direct.T)
    if kernel.startswith("bspline"):
        # A spline through the samples has the coefficients c that solve W c = samples, W the weights at the samples.
        at_samples = np.zeros((n, n))
        own = kernel_weight(kernel, np.arange(n)[:, None] - places)
        np.add.at(at_samples.T, folded, own.T)
        weights = weights @ np.linalg.inv(at_samples)
    return weights


def reference(samples, index, kernel):
    """The tensor product of the kernel over all samples, directly, at index positions [..., (x, y, z)]."""
    n_z, n_y, n_x = samples.shape
    # The Gaussian is cut off at two samples: a rounding error there is a step.
    index = np.where(np.abs(index - index.round()) < 1e-9, index.round(), index)
    is_inside = ((index >= 0) & (index <= np.array([n_x, n_y, n_z]) - 1)).all(axis=-1)
    per_axis = [weights_along(kernel, index[is_inside][:, axis], n) for axis, n in enumerate((n_x, n_y, n_z))]
    values = np.full(is_inside.shape, np.nan)
    values[is_inside] = np.einsum("pz,py,px,zyx->p", *reversed(per_axis), samples.astype(np.float64))
    return values


@pytest.mark.parametrize("dtype", [np.int16, np.float32])
@pytest.mark.parametrize("kernel", KERNELS)
def test_every_kernel_is_its_tensor_product(oblique, kernel, dtype):
    volume = ws.Volume(oblique.samples.astype(dtype), world_from_index=oblique.world_from_index)
    picture = ws.slice(volume, (volume.bounds.mean(axis=0), (0.2, -0.5, 1)), size=(61, 47), kernel=kernel)
    want = reference(oblique.samples, index_of_pixels(picture, oblique.world_from_index), kernel)
    assert np.isfinite(want).sum() > 300
    np.testing.assert_allclose(picture.value, want, rtol=0, atol=1e-5 * np.ptp(oblique.samples))


@pytest.mark.parametrize(("slab", "reduce"), [("maximum", np.max), ("minimum", np.min)])
@pytest.mark.parametrize(("first", "last"), [(0, 2), (1, 3), (0, 4), (2, 4)])
@pytest.mark.every_pair
def test_slabs_between_slices_are_those_of_numpy(slab, reduce, first, last):
    volume = in_memory_order("LPS")
    position, thickness = 40.0 + first + last, 2.0 * (last - first)
    picture = ws.slice(volume, "axial", position, thickness=thickness, slab=slab)
    np.testing.assert_array_equal(picture.value, reduce(SAMPLES[first : last + 1], axis=0)[::-1, ::-1])


def test_a_mean_slab_is_the_integral_of_the_linear_kernel():
    picture = ws.slice(in_memory_order("RAS"), "axial", 44, thickness=4, slab="mean")
    want = (np.array([0.25, 0.5, 0.25])[:, None, None] * SAMPLES[1:4]).sum(axis=0)
    np.testing.assert_allclose(picture.value, want[::-1, ::-1], atol=1e-3)


def test_a_slab_ends_where_the_volume_ends():
    volume = in_memory_order("RAS")
    picture = ws.slice(volume, "axial", 42, thickness=1e9)
    np.testing.assert_array_equal(picture.value, SAMPLES.max(axis=0)[::-1, ::-1])
    assert picture.report["n_planes"] < 20


def test_nan_is_background_and_thick_slabs_see_past_it():
    samples = SAMPLES.astype(np.float32)
    samples[2, 3, 4] = np.nan
    volume = ws.Volume(samples)
    for kernel in ("linear", "bspline3"):
        picture = ws.slice(volume, "xy", 2, kernel=kernel, background=(0, 1, 0))
        assert np.isnan(picture.value[3, 4])
        assert picture.rgba[3, 4].tolist() == [0, 1, 0, 1]
    linear = ws.slice(volume, "xy", 2)
    assert np.isnan(linear.value).sum() == 1
    assert np.isfinite(ws.slice(volume, "axial", 2, thickness=2).value).all()


def test_the_window_is_black_to_white():
    volume = in_memory_order("RAS")
    picture = ws.slice(volume, "axial", 40, window=(500, 2000))
    want = np.clip((SAMPLES[0, ::-1, ::-1] + 500) / 2000, 0, 1)
    np.testing.assert_allclose(picture.rgba[..., :3], np.repeat(want[..., None], 3, axis=2), atol=1e-6)
    assert (picture.rgba[..., 3] == 1).all()
    assert picture.report["window"] == (500, 2000)
    assert picture.report["clim"] == (-500, 1500)
    same = ws.slice(volume, "axial", 40, clim=(-500, 1500))
    np.testing.assert_array_equal(picture.rgba, same.rgba)
    low, high = ws.slice(volume).report["clim"]
    assert SAMPLES.min() <= low < high <= SAMPLES.max()
    assert ws.slice(ws.Volume(np.full((3, 3, 3), 7.0))).rgba[0, 0].tolist() == [0, 0, 0, 1]


def test_windows_of_ct_by_name():
    volume = ws.examples.ct_pelvis()
    assert ws.slice(volume, window="bone").report["window"] == (400, 1800)
    assert ws.slice(volume, window="Soft Tissue").report["clim"] == (-147.5, 227.5)
    with pytest.warns(WavesplatWarning, match="window 'bone' is for Hounsfield units.*the file says MR"):
        ws.slice(ws.examples.mri_head(), window="bone")


def test_transfer_functions_give_opaque_colours():
    tf = ws.TransferFunction([(0, 0), (0, 0.01), (3000, 0.5)], [(0, 1, 0, 0), (3000, 0, 0, 1)])
    picture = ws.slice(in_memory_order("RAS"), "axial", 40, transfer_function=tf, background=None)
    values = SAMPLES[0, ::-1, ::-1]
    assert (picture.rgba[values < 0] == 0).all()
    share = values[values > 0] / 3000
    want = np.stack([1 - share, 0 * share, share, 0 * share + 1], axis=1)
    np.testing.assert_allclose(picture.rgba[values > 0], want, atol=1e-6)
    assert ws.slice(in_memory_order("RAS"), transfer_function="grey").size == (7, 6)


def test_pixels_are_square_where_samples_are_not():
    samples = np.arange(5 * 6 * 7).reshape(5, 6, 7).astype(np.uint8)
    volume = ws.Volume(samples, spacing=(1, 1, 3))
    picture = ws.slice(volume, "xz", 2)
    assert picture.size == (7, 13)
    np.testing.assert_array_equal(picture.value[::3], samples[:, 2])
    wide = ws.slice(volume, "xz", 2, size=(70, 25))
    assert wide.report["pixel"] == 0.5
    # 6 mm in the middle of 70 pixels of 0.5 mm: the outermost pixel centres are 5.5 mm apart.
    assert np.isfinite(wide.value).any(axis=0).sum() == 12


def test_zoom_and_centre():
    volume = ws.Volume(SAMPLES)
    world = (2.0, 3.0, 1.0)
    picture = ws.slice(volume, "xy", 1, size=(5, 5), zoom=4, center=world)
    np.testing.assert_allclose(world_of_pixels(picture)[2, 2], world)
    assert picture.value[2, 2] == SAMPLES[1, 3, 2]
    assert picture.report["pixel"] == 6 / 4 / 4


def test_positions_move_oblique_planes_along_their_normal():
    volume = ws.Volume(SAMPLES)
    moved = ws.slice(volume, ((0, 0, 1), (0, 0, -4)), -2)
    np.testing.assert_array_equal(moved.value, SAMPLES[3])


@pytest.mark.parametrize("order", ["RAS", "LPS", "SAR"])
def test_letters_of_named_planes(order):
    volume = in_memory_order(order)
    letters = {plane: "".join(ws.slice(volume, plane).report["letters"].values()) for plane in PICTURES}
    assert letters == {"axial": "RLAP", "coronal": "RLSI", "sagittal": "APSI"}


@pytest.mark.parametrize(
    ("normal", "letters"),
    [
        ((0, 0.05, 1), "RLAP"),
        ((0, 0.5, 1), "R L AI PS"),
        ((0, -0.5, -1), "R L AI PS"),  # the same plane
        ((0, 1, 0.5), "R L SP IA"),
        ((1, -0.6, 0), "AR PL S I"),
        ((1, 1, 1), "RI LS ALI PRS"),
    ],
)
def test_letters_of_oblique_planes(oblique, normal, letters):
    volume = ws.Volume(oblique.samples, world_from_index=oblique.world_from_index, anatomical=True)
    picture = ws.slice(volume, (volume.bounds.mean(axis=0), normal))
    got = list(picture.report["letters"].values())
    assert got == (letters.split() if " " in letters else list(letters))


def test_files_in_any_orientation_give_one_picture(oblique, tmp_path):
    import nibabel

    volumes = []
    for name in ("LPS", "RAS"):
        array, matrix = oblique.samples.T, oblique.world_from_index
        image = nibabel.Nifti1Image(array, matrix).as_reoriented(
            nibabel.orientations.ornt_transform(
                nibabel.io_orientation(matrix), nibabel.orientations.axcodes2ornt(tuple(name))
            )
        )
        nibabel.save(image, tmp_path / f"{name}.nii")
        volumes.append(ws.open(tmp_path / f"{name}.nii"))
    assert [volume.orientation for volume in volumes] == ["LPS", "RAS"]
    for plane in PICTURES:
        position = volumes[0].bounds.mean(axis=0)[AXES[plane]]
        a, b = (ws.slice(volume, plane, position, size=(31, 31)) for volume in volumes)
        np.testing.assert_allclose(a.value, b.value, atol=0.05)  # affines in files are float32
        assert a.report["letters"] == b.report["letters"]


@pytest.mark.parametrize("kernel", ["linear", "bspline3"])
def test_wavelet_volumes_give_the_slices_of_their_samples(oblique, kernel):
    samples = np.random.default_rng(5).random((40, 50, 60)).astype(np.float32)
    volume = ws.Volume(samples, world_from_index=oblique.world_from_index)
    wavelets = ws.WaveletVolume.from_volume(volume, "cdf53")
    plane = (volume.bounds.mean(axis=0), (0.3, 0.4, 1))
    got, want = (ws.slice(v, plane, size=(70, 60), kernel=kernel, thickness=1) for v in (wavelets, volume))
    np.testing.assert_allclose(got.value, want.value, atol=1e-5)


def test_threads_do_not_matter(oblique):
    volume = ws.Volume(oblique.samples, world_from_index=oblique.world_from_index)
    one, two = (ws.slice(volume, size=(64, 64), threads=n).rgba for n in (1, 2))
    np.testing.assert_array_equal(one, two)


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        (("transverse",), {}, "unknown plane 'transverse'; use one of: axial, coronal, sagittal, xy, xz, yz, or"),
        ((3,), {}, "plane is 3; give axial, coronal, sagittal, xy, xz, yz, or (point, normal)"),
        ((((0, 0), (0, 0, 1)),), {}, "point of the plane is (0, 0); give three numbers"),
        ((((0, 0, 0), (0, 0, 0)),), {}, "a normal that is not zero"),
        (("axial", 500), {}, "position of the axial plane is 500, which is outside the volume 'volume'; it reaches "),
        (("sagittal", -1), {}, "from 0 to 6"),
        (("axial", float("nan")), {}, "position is nan"),
        ((((0, 0, 0), (0, 0, 1)), 9), {}, "from 0 to 4"),
        ((), {"clim": (100, -100)}, "clim is (100, -100); low must be less than high; did you mean (-100, 100)?"),
        ((), {"clim": (1, 1)}, "clim is (1, 1)"),
        ((), {"clim": 5}, "clim is 5; give (low, high)"),
        ((), {"window": (-150, -250)}, "window is (-150, -250), level and width; the width must be positive"),
        ((), {"window": 5}, "window is 5; give (level, width), such as (40, 400), or a name: abdomen"),
        ((), {"window": "lungs"}, "unknown window 'lungs'; did you mean lung?"),
        ((), {"window": (1, 1), "clim": (0, 1)}, "window and clim both say"),
        ((), {"clim": (0, 1), "transfer_function": "grey"}, "give one of them"),
        ((), {"window": (0, 1), "transfer_function": "grey"}, "give one of them"),
        ((), {"thickness": -1}, "thickness is -1"),
        ((), {"slab": "median"}, "slab is 'median'; use one of: maximum, minimum, mean"),
        ((), {"kernel": "cubic"}, 'unknown kernel "cubic"'),
        ((), {"zoom": 0}, "zoom is 0"),
        ((), {"size": (0, 5)}, "picture width is 0"),
        ((), {"size": 5}, "size is 5"),
        ((), {"size": (10**6, 5)}, "give at most 16384 pixels a side"),
        ((), {"threads": 0}, "threads is 0"),
        ((), {"center": 3}, "center of the slice is 3"),
        ((), {"background": "pinkish"}, "color is 'pinkish'"),
    ],
)
def test_mistakes_say_how_to_mend_them(arguments, options, message):
    with pytest.raises(ws.errors.ArgumentError) as caught:
        ws.slice(ws.Volume(SAMPLES), *arguments, **options)
    assert message in str(caught.value)


def test_command_line(wavesplat, ramp_file, tmp_path):
    out = tmp_path / "a.png"
    options = ["--plane", "coronal", "--position", "3", "--window", "100,200", "--size", "200x200"]
    options += ["--letters", "--scale-bar", "--colorbar", "--title", "Ramp"]
    done = wavesplat("slice", ramp_file, "-o", out, *options)
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{out}\n", "")
    assert out.read_bytes().startswith(b"\x89PNG")
    oblique = ["--point", "8,8,8", "--normal", "0,0.3,1", "--thickness", "3", "--slab", "mean", "--kernel", "bspline3"]
    done = wavesplat("slice", ramp_file, "-o", out, *oblique, "--size", "40x30", "--preset", "grey", "--json")
    facts = json.loads(done.stdout)
    assert facts["size"] == [40, 30]
    assert facts["report"]["n_planes"] == 7


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--plane", "top"], "'top' is not one of: axial, coronal, sagittal"),
        (["--position", "99"], "it reaches from 0 to 15"),
        (["--clim", "9,3"], "did you mean (3, 9)"),
        (["--window", "40,-400"], "the width must be positive"),
        (["--window", "bones"], "did you mean bone?"),
        (["--window", "1,2", "--clim", "1,2"], "window and clim both say"),
        (["--preset", "grey", "--cmap", "gray"], "without --preset"),
        (["--point", "1,2,3"], "--point and --normal belong together"),
        (["--plane", "axial", "--point", "1,2,3", "--normal", "0,0,1"], "--plane and --normal"),
        (["--slab", "median"], "'median' is not one of: maximum, minimum, mean"),
        (["--letters", "--cube"], "--letters and --cube both show"),
        (["--dpi", "0"], "dpi is 0"),
        (["--colorbar-label", "HU"], "give it with --colorbar"),
        (["--title", "\U0001f9e0"], "--title has signs that the typeface does not"),
        (["--bar-length", "9 m"], "the scale bar is '9 m'"),
        (["--legend", "--size", "99x99"], "nothing for a legend"),
        (["--size", "12x"], "'12x' is not WIDTHxHEIGHT"),
    ],
)
def test_command_line_mistakes(wavesplat, ramp_file, tmp_path, options, message):
    done = wavesplat("slice", ramp_file, "-o", tmp_path / "a.png", *options)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert message in done.stderr
    assert not (tmp_path / "a.png").exists()


def test_the_report_has_the_size():
    """Of slices and sheets of them, as of pictures: width and height."""
    volume = ws.examples.ripples(12)
    for picture in (ws.slice(volume, "xy", size=(30, 20)), ws.lightbox(volume, "xy", [2, 5, 8])):
        assert picture.report.size == list(picture.size)
        assert picture.rgba.shape[:2] == tuple(picture.report["size"])[::-1]
