import json
import math
import sys

import numpy as np
import pytest

import wavesplat as ws

trimesh = pytest.importorskip("trimesh")
pytest.importorskip("skimage")

RADIUS = 15.3

AFFINES = {
    "plain": np.eye(3),
    "anisotropic": np.diag([0.7, 0.8, 1.5]),
    "sheared": np.array([[1.0, 0.3, 0.1], [0.0, 1.0, 0.2], [0.0, 0.0, 1.2]]),
    "mirrored": np.diag([-1.0, 1.0, 1.0]),
    "mirrored and sheared": np.array([[-0.9, 0.3, 0.0], [0.0, 1.0, 0.2], [0.0, 0.1, 1.2]]),
}


def ball(steps=AFFINES["plain"], *, n=56, radius=RADIUS, center=(10.0, -20.0, 30.0)):
    """A volume whose samples are the distance below a sphere's surface; the columns of `steps` are the index axes."""
    world_from_index = np.eye(4)
    world_from_index[:3, :3] = steps
    world_from_index[:3, 3] = center - steps @ np.full(3, (n - 1) / 2)
    z, y, x = np.mgrid[:n, :n, :n]
    world = np.stack([x, y, z], axis=-1) @ steps.T + world_from_index[:3, 3]
    return ws.Volume(radius - np.linalg.norm(world - center, axis=-1), world_from_index=world_from_index)


def boundary_edges(mesh):
    """Number of edges that belong to one triangle only."""
    edges = np.sort(mesh.to_trimesh().edges, axis=1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    return int((counts == 1).sum())


@pytest.mark.parametrize("steps", AFFINES.values(), ids=AFFINES.keys())
@pytest.mark.parametrize("radius", [RADIUS, 15.0])  # 15: samples of the plain grid lie exactly on the surface
def test_a_sphere_is_a_sphere(steps, radius):
    volume = ball(steps, radius=radius)
    mesh = ws.mesh(volume, 0)
    from_center = mesh.vertices - (10, -20, 30)
    radii = np.linalg.norm(from_center, axis=1)
    # The distance is not linear along an edge: it sags by up to h^2 / 8 r, 0.019 for h = 1.5 and r = 15.
    assert np.abs(radii - radius).max() < 0.02 * max(volume.spacing)
    assert mesh.watertight
    assert mesh.to_trimesh().euler_number == 2  # genus 0
    assert mesh.volume == pytest.approx(4 / 3 * math.pi * radius**3, rel=0.005)
    assert mesh.area == pytest.approx(4 * math.pi * radius**2, rel=0.005)
    assert mesh.volume == pytest.approx(mesh.to_trimesh().volume)
    outward = from_center / radii[:, None]
    assert np.einsum("ij,ij->i", mesh.normals, outward).min() > 0.9999
    corners = mesh.vertices[mesh.faces]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.einsum("ij,ij->i", facing, corners.mean(axis=1) - (10, -20, 30)).min() > 0


def first_crossing(mesh, origins, direction):
    """Distances from the origins to the nearest triangle along one direction; inf where none is met."""
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    # Moeller and Trumbore (1997), for one direction.
    across = np.cross(direction, c - a)
    along = np.einsum("ij,ij->i", b - a, across)
    inverse = 1 / np.where(along == 0, np.inf, along)
    nearest = np.full(len(origins), np.inf)
    for ray, origin in enumerate(origins):
        offset = origin - a
        turned = np.cross(offset, b - a)
        u, v = np.einsum("ij,ij->i", offset, across) * inverse, turned @ direction * inverse
        hits = (u >= 0) & (v >= 0) & (u + v <= 1) & (along != 0)
        nearest[ray] = min((np.einsum("ij,ij->i", c - a, turned) * inverse)[hits], default=np.inf)
    return nearest


@pytest.mark.parametrize("steps", AFFINES.values(), ids=AFFINES.keys())
def test_the_first_hit_of_the_renderer_lies_on_the_mesh(steps):
    volume = ball(steps)
    position, center = np.array([60.0, 50.0, 80.0]), np.array([10.0, -20.0, 30.0])
    camera = ws.Camera(position, center, (0, 0, 1), parallel_scale=18)
    n, every = 216, 9  # fine, since the warp interpolates depths; few pixels, since the rays below are slow
    picture = ws.render(volume, "grey", camera, size=(n, n), composite=ws.FirstHit(0), depth=True)
    forward = (center - position) / np.linalg.norm(center - position)
    right = np.cross(forward, (0, 0, 1))
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    pixels = (((np.arange(n) + 0.5) / n * 2 - 1) * 18)[4::every]
    origins = (position + pixels[None, :, None] * right - pixels[:, None, None] * up).reshape(-1, 3)
    crossing = first_crossing(ws.mesh(volume, 0), origins, forward)
    depth = picture.depth[4::every, 4::every].ravel()
    # Where the ray grazes the sphere, any error of the surface's position grows along the ray without bound.
    aside = np.linalg.norm((origins - center) - (origins - center) @ forward[:, None] * forward, axis=1)
    inner = aside < 0.95 * RADIUS
    assert inner.sum() > 250
    assert np.abs(depth - crossing)[inner].max() < 0.1 * min(volume.spacing)
    assert np.isinf(crossing[aside > RADIUS]).all()
    assert np.isnan(depth[aside > RADIUS + 0.1]).all()


@pytest.mark.parametrize("suffix", [".ply", ".stl", ".obj", ".glb", ".gltf"])
def test_files_hold_the_mesh(tmp_path, suffix):
    mesh = ws.mesh(ball(AFFINES["mirrored and sheared"]), 0)
    path = tmp_path / f"ball{suffix.upper() if suffix == '.ply' else suffix}"
    mesh.save(path)
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]
    with path.open("rb") as file:
        read = trimesh.load(file, file_type=suffix[1:], force="mesh")
    assert len(read.vertices) == len(mesh.vertices)
    assert len(read.faces) == len(mesh.faces)
    assert read.is_watertight
    assert read.volume == pytest.approx(mesh.volume, rel=1e-5)
    assert read.area == pytest.approx(mesh.area, rel=1e-5)
    # The order may change, and float32 has seven digits.
    wanted = mesh.vertices[mesh.faces].mean(axis=1)
    got = np.asarray(read.triangles).mean(axis=1)
    np.testing.assert_allclose(got[np.lexsort(got.round(2).T)], wanted[np.lexsort(wanted.round(2).T)], atol=0.02)
    np.testing.assert_allclose(read.bounds, [mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)], atol=1e-5)
    content = path.read_bytes()
    if suffix == ".ply":
        numbers = np.frombuffer(content.partition(b"end_header\n")[2], "<f4", 6 * len(mesh.vertices)).reshape(-1, 6)
        np.testing.assert_array_equal(numbers, np.hstack([mesh.vertices, mesh.normals]).astype(np.float32))
    elif suffix != ".stl":
        assert {".obj": b"\nvn ", ".glb": b'"NORMAL"', ".gltf": b'"NORMAL"'}[suffix] in content


def half_ball():
    """A ball whose middle lies on the volume's lowest slice."""
    whole = ball(n=41, center=(20.0, 20.0, 20.0))
    return ws.Volume(whole.samples[20:])


def test_a_cut_surface_is_closed_or_left_open():
    closed, left_open = ws.mesh(half_ball(), 0), ws.mesh(half_ball(), 0, closed=False)
    assert closed.watertight
    assert closed.to_trimesh().euler_number == 2
    assert closed.volume == pytest.approx(2 / 3 * math.pi * RADIUS**3, rel=0.005)
    assert closed.area == pytest.approx(3 * math.pi * RADIUS**2, rel=0.005)
    cap = closed.vertices[:, 2] < 0
    assert closed.vertices[:, 2].min() == pytest.approx(-0.001)
    assert (closed.normals[cap, 2] < -0.5).all()
    assert not left_open.watertight
    assert boundary_edges(left_open) > 50
    assert left_open.vertices[:, 2].min() == 0
    assert left_open.area == pytest.approx(2 * math.pi * RADIUS**2, rel=0.005)
    assert left_open.faces.max() == len(left_open.vertices) - 1


def test_normals_of_a_sheet_of_one_sample_point_outside():
    samples = np.zeros((9, 12, 12))
    samples[4, 1:-1, 1:-1] = 10
    samples[5:] = 4  # so that the gradient has the same sign on both sides
    mesh = ws.mesh(ws.Volume(samples), 6)
    corners = mesh.vertices[mesh.faces]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.einsum("ij,ij->i", mesh.normals[mesh.faces].sum(axis=1), facing).min() > 0


@pytest.mark.parametrize("steps", [AFFINES["plain"], AFFINES["mirrored and sheared"]])
def test_a_crop_box_cuts_where_it_lies(steps):
    # The box leaves a quarter of the ball; its planes lie between samples, in the second case oblique to the grid.
    mesh = ws.mesh(ball(steps), 0, crop=ws.Crop((10, -20, 0), (40, 40, 60)))
    assert mesh.watertight
    assert mesh.to_trimesh().euler_number == 2
    # Each of the box's edges is beveled by up to a voxel, over the ball's diameter.
    assert mesh.volume == pytest.approx(math.pi / 3 * RADIUS**3, rel=0.01)
    lower = mesh.vertices.min(axis=0)
    np.testing.assert_allclose(lower[:2], (10, -20), atol=2e-3)


def test_a_crop_in_samples_is_that_part_of_the_volume():
    samples = np.random.default_rng(3).random((12, 13, 14))
    crop = ws.Crop((2, 3, 4), (9, 10, 8), space="index")
    cropped = ws.mesh(ws.Volume(samples), 0.5, crop=crop)
    part = ws.mesh(ws.Volume(samples[4:9, 3:11, 2:10]), 0.5)
    assert cropped.watertight
    assert cropped.volume == pytest.approx(part.volume, rel=0.02)  # ambiguous cells may choose otherwise


def test_holes_are_outside():
    samples = ball(n=41, center=(0.0, 0.0, 0.0)).samples.copy()
    samples[20, 20, 20] = np.nan
    samples[18:23, 18:23, 28:31] = np.inf
    mesh = ws.mesh(ws.Volume(samples), 0)
    assert mesh.watertight
    assert mesh.to_trimesh().body_count == 3  # the sphere and two cavities
    assert np.isfinite(mesh.vertices).all()
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1)
    whole = ws.mesh(ball(n=41), 0).volume
    # Around a hole the surface is an octahedron of radius 1, swept over the 4 x 4 x 2 cells of the other holes.
    swept = 4 * 4 * 2 + 2 * (4 * 4 + 4 * 2 + 4 * 2) + (4 + 4 + 2) * 4 / 2 + 4 / 3
    assert whole - mesh.volume == pytest.approx(4 / 3 + swept, rel=0.005)
    left_open = ws.mesh(ws.Volume(samples), 0, closed=False)
    assert left_open.watertight  # the sphere without its cavities
    assert left_open.volume == pytest.approx(whole)


@pytest.mark.parametrize("seed", range(6))
def test_noise_is_closed_too(seed):
    """Many ambiguous cells, samples with exactly the value, masks, and holes; seed 1 has touching sheets."""
    generator = np.random.default_rng(seed)
    samples = generator.standard_normal((24, 25, 26))
    samples = [samples, samples.round(), (samples > 0).astype(np.uint8), samples, samples, samples.round()][seed]
    if seed in (3, 5):
        samples[generator.random(samples.shape) < 0.1] = np.nan
    mesh = ws.mesh(ws.Volume(samples, spacing=(1, 2, 3)), 0)
    assert mesh.watertight
    assert mesh.volume > 0


def test_touching_sheets_are_parted():
    samples = np.random.default_rng(110).standard_normal((40, 40, 40)).astype(np.float32)
    assert ws.mesh(ws.Volume(samples), 0).watertight


def test_a_step_takes_fewer_samples_and_the_last():
    fine, coarse = ws.mesh(half_ball(), 0), ws.mesh(half_ball(), 0, step=3)
    assert coarse.watertight
    assert len(coarse.faces) < len(fine.faces) / 6
    assert coarse.volume == pytest.approx(fine.volume, rel=0.03)
    samples = np.ones((6, 7, 8))
    samples[1, 1, 1] = 0
    full = ws.mesh(ws.Volume(samples), 0.5, step=4)
    np.testing.assert_allclose(full.vertices.max(axis=0), (7, 6, 5), atol=0.005)


def test_wavelet_volumes_are_taken():
    volume = ws.examples.ripples(24)
    direct = ws.mesh(volume, 150)
    mesh = ws.mesh(ws.WaveletVolume.from_volume(volume, threshold=0), 150)
    assert mesh.volume == pytest.approx(direct.volume, rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"iso_value": 999}, "no surface at iso value 999: its samples are 0 to 26"),
        ({"iso_value": 26}, "its samples are 0 to 26; give a value from the first to below the second"),
        ({"iso_value": -1}, "its samples are 0 to 26"),
        ({"iso_value": math.nan}, "iso_value is nan; give a finite number"),
        ({"iso_value": "high"}, "iso_value is 'high'; give a number"),
        ({"iso_value": 13, "step": 0}, "step is 0; give a whole number of at least 1"),
        ({"iso_value": 13, "step": 1.5}, "step is 1.5; give a whole number"),
        ({"iso_value": 13, "crop": (0, 1)}, r"crop is \(0, 1\); give a wavesplat.Crop"),
        ({"iso_value": 13, "crop": ws.Crop((50, 50, 50), (60, 60, 60))}, "no sample in the crop box is larger"),
        ({"iso_value": 13, "crop": ws.Crop((0, 0, 0), (2, 2, 0.5))}, "no sample in the crop box is larger"),
    ],
)
def test_errors_say_what_to_give(arguments, message):
    volume = ws.Volume(np.arange(27.0).reshape(3, 3, 3))
    with pytest.raises(ws.errors.ArgumentError, match=message):
        ws.mesh(volume, **arguments)


def test_nothing_left_open_is_said():
    samples = np.zeros((4, 4, 4))
    samples[0] = 1
    samples[1:] = np.nan
    samples[3] = 0
    with pytest.raises(ws.errors.ArgumentError, match="nothing is left open"):
        ws.mesh(ws.Volume(samples), 0.5, closed=False)


def test_a_missing_library_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "skimage.measure", None)
    with pytest.raises(ws.errors.LibraryError, match=r'skimage is not installed; .*: pip install "wavesplat\[mesh\]"'):
        ws.mesh(half_ball(), 0)


def test_files_that_cannot_be_written(tmp_path, monkeypatch):
    mesh = ws.mesh(half_ball(), 0, step=4)
    with pytest.raises(ws.errors.FileError, match=r"as \.vtk; use one of: \.ply, \.stl, \.obj, \.glb, \.gltf"):
        mesh.save(tmp_path / "a.vtk")
    with pytest.raises(ws.errors.FileError, match="the folder does not exist"):
        mesh.save(tmp_path / "no" / "a.stl")
    monkeypatch.setattr("os.access", lambda *_: False)  # tests may run as root, who may write everywhere
    with pytest.raises(ws.errors.FileError, match="no permission in its folder"):
        mesh.save(tmp_path / "a.stl")
    assert list(tmp_path.iterdir()) == []


def test_the_command_writes_the_mesh_of_the_api(wavesplat, ramp_file, tmp_path):
    out = tmp_path / "a.ply"
    options = ["--iso-value", "100", "--open", "--step", "2", "--crop", "0,0,0,15,15,9.5"]
    done = wavesplat("mesh", ramp_file, "-o", out, *options)
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{out}\n", "")
    expected = ws.mesh(ws.open(ramp_file), 100, closed=False, step=2, crop=ws.Crop((0, 0, 0), (15, 15, 9.5)))
    read = trimesh.load(out, process=False)
    np.testing.assert_allclose(read.vertices, expected.vertices, atol=1e-5)
    np.testing.assert_array_equal(read.faces, expected.faces)


def test_the_command_says_as_json_what_it_made(wavesplat, ramp_file, tmp_path):
    done = wavesplat("mesh", ramp_file, "-o", tmp_path / "a.stl", "--iso-value", "100", "--json")
    facts = json.loads(done.stdout)
    expected = ws.mesh(ws.open(ramp_file), 100)
    assert facts["mesh"] == str(tmp_path / "a.stl")
    assert facts["watertight"] is True
    assert (facts["n_vertices"], facts["n_faces"]) == (len(expected.vertices), len(expected.faces))
    assert facts["volume"] == pytest.approx(expected.volume)
    assert facts["area"] == pytest.approx(expected.area)
    done = wavesplat("mesh", ramp_file, "-o", tmp_path / "a.stl", "--iso-value", "100", "--json", "--open")
    assert json.loads(done.stdout)["volume"] is None


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["IN", "-o", "a.stl"], 2, "--iso-value"),
        (["IN", "-o", "a.stl", "--iso-value", "300"], 2, "its samples are 0 to 255"),
        (["IN", "-o", "a.jpg", "--iso-value", "100"], 1, "use one of: .ply, .stl, .obj, .glb, .gltf"),
        (["no.nii", "-o", "no/a.stl", "--iso-value", "100"], 1, "folder does not exist"),
        (["IN", "-o", "a.stl", "--iso-value", "9", "--crop", "1,1,1,2,2,2", "--crop-index", "1,1,1,2,2,2"], 2, "twice"),
    ],
)
def test_wrong_commands_leave_nothing(wavesplat, ramp_file, tmp_path, arguments, code, message):  # noqa: PLR0917
    places = {"IN": ramp_file}
    done = wavesplat("mesh", *[places.get(a, a) for a in arguments], cwd=tmp_path, NO_COLOR="1")
    assert done.returncode == code
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert [entry.name for entry in tmp_path.iterdir()] == ["ramp.nii.gz"]
