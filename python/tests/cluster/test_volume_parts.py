"""Parts of a volume in several processes: each draws its own, and `merge` gives the picture of the whole."""

from __future__ import annotations

import os
import pickle
import shutil
import subprocess
import sys
import zlib
from dataclasses import replace
from importlib.util import find_spec
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pages
import pytest
from numpy.typing import NDArray
from PIL import Image

import wavesplat as ws
from wavesplat._cluster.parts import front_to_back
from wavesplat.errors import ArgumentError

Box = tuple[tuple[int, int, int], tuple[int, int, int]]

PAGE = pages.ROOT / "docs" / "large_volumes.md"
SPACING = (1.0, 1.2, 0.9)
COLORS = [(-2, 0.0, 0.0, 1.0), (0, 1.0, 1.0, 1.0), (2, 1.0, 0.0, 0.0)]
SOFT = ws.TransferFunction([(-2, 0), (-0.5, 0), (2, 0.12)], COLORS)
HARD = ws.TransferFunction([(0.69, 0), (0.7, 1)], COLORS)


def field(shape: tuple[int, int, int] = (40, 52, 44), seed: int = 0) -> NDArray[np.float32]:
    """Waves with noise, which fill the whole box, so that its faces are cut faces."""
    z, y, x = np.indices(shape)
    noise = np.random.default_rng(seed).standard_normal(shape)
    return (np.sin(x / 4) * np.cos(y / 5) + np.sin(z / 3 + x / 9) + 0.1 * noise).astype(np.float32)


def tree_of_boxes(shape: tuple[int, int, int], n: int, rng: np.random.Generator) -> list[Box]:
    """A volume that is cut `n - 1` times, each time the largest box at a random place along a random axis."""
    boxes: list[Box] = [((0, 0, 0), shape)]
    while len(boxes) < n:
        sizes = [np.subtract(high, low) for low, high in boxes]
        largest = int(np.argmax([size.prod() for size in sizes]))
        low, high = boxes.pop(largest)
        axis = int(rng.integers(3))
        axis = axis if sizes[largest][axis] >= 4 else int(np.argmax(sizes[largest]))
        cut = int(rng.integers(low[axis] + 1, high[axis]))
        below, above = list(high), list(low)
        below[axis] = above[axis] = cut
        boxes += [(low, (below[0], below[1], below[2])), ((above[0], above[1], above[2]), high)]
    return boxes


def part_of(whole: NDArray[Any], box: Box, n_ghosts: int, **place: Any) -> ws.VolumePart:
    low = [max(0, a - n_ghosts) for a in box[0]]
    high = [min(size, b + n_ghosts) for b, size in zip(box[1], whole.shape, strict=True)]
    samples = whole[tuple(slice(a, b) for a, b in zip(low, high, strict=True))]
    return ws.VolumePart(samples, low, list(zip(*box, strict=True)), whole.shape, **place)


def merged(
    whole: NDArray[Any], boxes: list[Box], look: Any = SOFT, camera: Any = None, n_ghosts: int = 3, **options: Any
) -> ws.Picture:
    parts = [part_of(whole, box, n_ghosts, spacing=SPACING) for box in boxes]
    overviews = [part.overview() for part in parts]
    return ws.merge(ws.render_part(part.whole(overviews), look, camera, **options) for part in parts)


def psnr(one: ws.Picture, other: ws.Picture) -> float:
    error = np.mean((one.rgba.astype(np.float64) - other.rgba) ** 2)
    return float(np.inf if error == 0 else -10 * np.log10(error))


def random_camera(rng: np.random.Generator, bounds: NDArray[np.float64]) -> ws.Camera:
    """In perspective or not, outside of a box, inside of it, or along an axis."""
    focal = tuple(rng.uniform(bounds[0], bounds[1]).tolist())
    side = float((bounds[1] - bounds[0]).max())
    kind = rng.integers(4)
    if kind == 0:
        return ws.Camera(tuple(rng.uniform(bounds[0], bounds[1]).tolist()), focal, (0.1, 0.2, 1), view_angle=80)
    way = rng.standard_normal(3) if kind < 3 else np.eye(3)[rng.integers(3)] * rng.choice([-1, 1])
    place = np.array(focal) + 2 * side * way / np.linalg.norm(way)
    up = (0.1, 0.2, 1) if abs(way[2]) < 0.9 * np.linalg.norm(way) else (0.1, 1, 0.2)
    lens: dict[str, float] = {"view_angle": 30} if kind == 1 else {"parallel_scale": 0.6 * side}
    return ws.Camera((float(place[0]), float(place[1]), float(place[2])), focal, up, **lens)


# By day twelve trees.
@pytest.mark.parametrize("seed", [*range(12), *(pytest.param(n, marks=pytest.mark.nightly) for n in range(12, 30))])
def test_parts_of_random_trees_give_the_picture_of_the_whole(seed: int) -> None:
    rng = np.random.default_rng(seed)
    whole = field(seed=seed)
    volume = ws.Volume(whole, spacing=SPACING)
    boxes = tree_of_boxes(whole.shape, int(rng.integers(2, 12)), rng)
    camera = random_camera(rng, volume.bounds)
    own: dict[str, Any] = {"size": (96, 80), "shading": None}
    expected = ws.render(volume, SOFT, camera, device="cpu", **own)
    assert expected.rgba[..., 3].max() > 0.2
    assert psnr(merged(whole, boxes, SOFT, camera, **own), expected) > 130
    # With the light on the faces of the volume, which depends on where rays enter it.
    own["shading"] = "look"
    expected = ws.render(volume, SOFT, camera, device="cpu", **own)
    assert psnr(merged(whole, boxes, SOFT, camera, **own), expected) > 57


@pytest.mark.parametrize("n_ghosts", [2, 3])
@pytest.mark.parametrize("kernel", ["linear", "catmull-rom"])
@pytest.mark.parametrize(
    "composite",
    ["over", ws.FirstHit(0.7), "maximum", "minimum", "mean", "sum", "attenuated-maximum", "depth-colored-maximum"],
)
def test_operators_and_kernels(n_ghosts: int, kernel: Any, composite: Any) -> None:
    whole = field()
    volume = ws.Volume(whole, spacing=SPACING)
    boxes = tree_of_boxes(whole.shape, 7, np.random.default_rng(1))
    camera = ws.Camera.orbit(volume, 35, 25)
    own: dict[str, Any] = {"size": (80, 64), "composite": composite, "kernel": kernel, "shading": None}
    expected = ws.render(volume, SOFT, camera, device="cpu", **own)
    assert psnr(merged(whole, boxes, SOFT, camera, n_ghosts, **own), expected) > 80


def test_hard_looks_in_a_grid_of_boxes() -> None:
    whole = field()
    volume = ws.Volume(whole, spacing=SPACING)
    halves = [[(0, n // 2), (n // 2, n)] for n in whole.shape]
    boxes: list[Box] = [(tuple(a for a, _ in own), tuple(b for _, b in own)) for own in product(*halves)]  # type: ignore[misc]
    expected = ws.render(volume, HARD, "right", size=(96, 96), device="cpu", shading=None)
    assert psnr(merged(whole, boxes, HARD, "right", size=(96, 96), shading=None), expected) > 60


def test_automatic_looks_and_cameras_are_those_of_the_whole() -> None:
    whole = field()
    boxes = tree_of_boxes(whole.shape, 5, np.random.default_rng(2))
    expected = ws.render(ws.Volume(whole, spacing=SPACING), size=(64, 64), device="cpu")
    picture = merged(whole, boxes, None, size=(64, 64))
    for name in ("look", "camera", "shown", "size", "background"):
        assert picture.report[name] == expected.report[name], name
    assert psnr(picture, expected) > 45
    with pytest.raises(ArgumentError, match="give looks to projections"):
        merged(whole, boxes, None, size=(64, 64), composite="mean")


def test_cuts_and_backgrounds() -> None:
    whole = field()
    volume = ws.Volume(whole, spacing=SPACING)
    boxes = tree_of_boxes(whole.shape, 6, np.random.default_rng(3))
    cuts = [ws.Crop((5, 6, 7), (30, 40, 30)), ws.ClipPlane((20, 20, 20), (1, 1, 1))]
    own: dict[str, Any] = {"size": (80, 64), "clip": cuts, "background": "white", "shading": None}
    expected = ws.render(volume, SOFT, "left", device="cpu", **own)
    assert expected.rgba[..., :3].min() < 0.7
    assert psnr(merged(whole, boxes, SOFT, "left", **own), expected) > 90


def test_ghost_samples_beyond_the_whole_are_left_out() -> None:
    """Codes keep a halo all around; `start` below 0 was refused."""
    whole = field((12, 10, 8))
    boxes: list[Box] = [((0, 0, 0), (5, 10, 8)), ((5, 0, 0), (12, 10, 8))]
    haloed = np.pad(whole, 3, constant_values=1e30)
    parts = [
        ws.VolumePart(haloed[a : b + 6], (a - 3, -3, -3), ((a, b), (0, 10), (0, 8)), whole.shape, spacing=SPACING)
        for a, b in ((0, 5), (5, 12))
    ]
    overviews = [part.overview() for part in parts]
    drawn = [ws.render_part(part.whole(overviews), SOFT, size=(48, 40)) for part in parts]
    assert np.array_equal(ws.merge(drawn).rgba, merged(whole, boxes, SOFT, size=(48, 40)).rgba)
    with pytest.raises(ArgumentError, match="must lie within the samples"):
        ws.VolumePart(whole[:3], (-3, 0, 0), ((0, 3), (0, 10), (0, 8)), whole.shape)
    with pytest.raises(ArgumentError, match="must lie within the samples"):
        ws.VolumePart(whole[:3], (20, 0, 0), ((0, 3), (0, 10), (0, 8)), whole.shape)


def test_processes_without_samples_give_none() -> None:
    whole = field((12, 10, 8))
    boxes: list[Box] = [((0, 0, 0), (1, 10, 8)), ((1, 0, 0), (12, 10, 8))]
    parts = [part_of(whole, box, 3, spacing=SPACING) for box in boxes]
    overviews = [None, *(part.overview() for part in parts)]
    pictures = [ws.render_part(part.whole(overviews), SOFT, size=(48, 40)) for part in parts]
    assert np.array_equal(ws.merge([*pictures, None]).rgba, merged(whole, boxes, SOFT, size=(48, 40)).rgba)
    with pytest.raises(ArgumentError, match="1 of 2 parts are missing"):
        ws.merge([None, pictures[1]])
    with pytest.raises(ArgumentError, match="no pictures to merge"):
        ws.merge([None])


def drawn_in_a_process(given: tuple[NDArray[Any], list[Box], int]) -> bytes:
    whole, boxes, number = given
    parts = [part_of(whole, box, 3, spacing=SPACING) for box in boxes]
    overviews = pickle.loads(pickle.dumps([part.overview() for part in parts]))  # noqa: S301 - made here
    return pickle.dumps(ws.render_part(parts[number].whole(overviews[::-1]), SOFT, size=(64, 64)))


def test_pictures_from_other_processes_merge() -> None:
    whole = field()
    boxes = tree_of_boxes(whole.shape, 3, np.random.default_rng(4))
    # Not a pool of `multiprocessing`: where one of its processes dies, it waits for ever.
    code = (
        "import pickle, sys; from test_volume_parts import drawn_in_a_process as drawn; "
        "sys.stdout.buffer.write(drawn(pickle.load(sys.stdin.buffer)))"
    )
    packed = []
    for number in range(len(boxes)):
        done = subprocess.run(
            [sys.executable, "-c", code],
            input=pickle.dumps((whole, boxes, number)),
            capture_output=True,
            check=True,
            cwd=Path(__file__).parent,
            env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[1] / "shared")},
            timeout=300,
        )
        packed.append(done.stdout)
    pictures = [pickle.loads(one) for one in packed]  # noqa: S301 - made here
    assert np.array_equal(ws.merge(pictures).rgba, merged(whole, boxes, SOFT, size=(64, 64)).rgba)
    # The samples stay where they are: states of rays are sent, and one overview of all parts.
    assert not any(np.ascontiguousarray(whole[5:7, 5, 5:40]).tobytes() in one for one in packed)
    assert sorted(picture.frame is None for picture in pictures) == [False, True, True]
    assert "64 x 64 of the samples z 0 to" in repr(pictures[0])


def test_what_does_not_fit_together_is_said() -> None:
    whole = field((12, 10, 8))
    boxes: list[Box] = [((0, 0, 0), (6, 10, 8)), ((6, 0, 0), (12, 10, 8))]
    parts = [part_of(whole, box, 2) for box in boxes]
    overviews = [part.overview() for part in parts]
    first, second = (ws.render_part(part.whole(overviews), SOFT, "left", size=(32, 32)) for part in parts)
    for pictures, message in (
        ([], "no pictures to merge"),
        ([first], "1 of 2 parts are missing.*z 6 to 12"),
        ([first, first], "twice among the pictures"),
        ([first, ws.render_part(parts[1].whole(overviews), SOFT, "right", size=(32, 32))], "not of one frame"),
        ([first, ws.render_part(parts[1].whole(overviews), HARD, "left", size=(32, 32))], "not of one frame"),
        ([first, "second"], "not str"),
    ):
        with pytest.raises(ArgumentError, match=message):
            ws.merge(pictures)  # type: ignore[arg-type]
    assert ws.merge([second, first]).size == (32, 32)
    with pytest.raises(ArgumentError, match="have 480 samples of 960"):
        parts[0].whole(overviews[:1])
    with pytest.raises(ArgumentError, match="overlap"):
        parts[0].whole([*overviews, part_of(whole, ((3, 0, 0), (9, 10, 8)), 2).overview()])
    with pytest.raises(
        ArgumentError, match=r"differ in the type of samples of the whole: float32 of z 0 to 6.* float64 of z 6"
    ):
        parts[0].whole([overviews[0], part_of(whole.astype(np.float64), boxes[1], 2).overview()])
    with pytest.raises(ArgumentError, match="must lie within the samples"):
        ws.VolumePart(whole[:6], (0, 0, 0), ((0, 7), (0, 10), (0, 8)), whole.shape)
    with pytest.raises(ArgumentError, match="give three whole numbers"):
        ws.VolumePart(whole[:6], (0, 0), ((0, 6), (0, 10), (0, 8)), whole.shape)
    holed = whole.copy()
    holed[8, 4, 4] = np.nan
    missing = [part_of(holed, box, 2) for box in boxes]
    with pytest.raises(ArgumentError, match="1 samples are NaN"):
        missing[0].whole([part.overview() for part in missing])


def test_what_was_damaged_on_its_way_is_said() -> None:
    whole = field((12, 12, 12))
    boxes: list[Box] = [((0, 0, 0), (6, 12, 12)), ((6, 0, 0), (12, 12, 12))]
    parts = [part_of(whole, box, 3) for box in boxes]
    overviews = [part.overview() for part in parts]
    drawn = [ws.render_part(part.whole(overviews), size=(16, 16)) for part in parts]
    planes = drawn[1].planes
    for lost in (
        {},
        {9: b"", **planes},
        {**planes, max(planes): b"no zlib"},
        {**planes, max(planes): zlib.compress(b"")},
    ):
        with pytest.raises(ArgumentError, match="on its way"):
            ws.merge([drawn[0], replace(drawn[1], planes=lost)])
    for frame in (b"no pickle", pickle.dumps(5), None):
        with pytest.raises(ArgumentError, match="on its way|holds the frame"):
            ws.merge([replace(drawn[0], frame=frame), drawn[1]])
    for lie in ({"own": 5}, {"bounds": {}}, {"statistics": None}, {"looks": []}, {"whole": (1, 2)}, {"light": ((), 0)}):
        with pytest.raises(ArgumentError, match="on its way|of the whole"):
            ws.render_part(parts[0].whole([overviews[0], replace(overviews[1], **lie)]), size=(16, 16))
    with pytest.raises(ArgumentError, match="an overview is a dict"):
        parts[0].whole([overviews[0], {}])  # type: ignore[list-item]


def test_what_needs_the_whole_volume_is_refused() -> None:
    whole = field((12, 10, 8))
    boxes: list[Box] = [((0, 0, 0), (6, 10, 8)), ((6, 0, 0), (12, 10, 8))]
    parts = [part_of(whole, box, 2) for box in boxes]
    volume = parts[0].whole([part.overview() for part in parts])
    small: dict[str, Any] = {"size": (16, 16)}
    with pytest.raises(ArgumentError, match="draw with ws.render_part"):
        ws.render(volume, SOFT, **small)
    for options, message in (
        ({"kernel": "bspline3"}, "depend on all samples"),
        ({"segments": 4}, "segments is for whole volumes"),
        ({"psnr": 40}, "psnr is for whole volumes"),
        ({"panorama": True}, "several pictures"),
        ({"composite": ws.LocalMaximum(0.5)}, "without segments and parts"),
    ):
        with pytest.raises(ArgumentError, match=message):
            ws.render_part(volume, SOFT, "left", **small, **options)  # type: ignore[arg-type]
    with pytest.raises(ArgumentError, match=r"what VolumePart\.whole returns"):
        ws.render_part(whole, SOFT)
    with pytest.raises(ArgumentError, match="no part of a larger one"):
        ws.render_part(ws.Volume.lazy(whole), SOFT, **small)


def test_boxes_are_ordered_from_every_eye() -> None:
    rng = np.random.default_rng(7)
    boxes = tree_of_boxes((40, 40, 40), 24, rng)
    lows, highs = (np.array([box[k] for box in boxes], np.float64) for k in (0, 1))
    for _ in range(40):
        is_direction = bool(rng.integers(2))
        eye = rng.standard_normal(3) if is_direction else rng.uniform(-30, 70, 3)
        order = front_to_back(lows, highs, eye.tolist(), is_direction=is_direction)
        place = np.empty(len(order), int)
        place[order] = np.arange(len(order))
        for _ in range(60):
            target = rng.uniform(0, 40, 3)
            start, way = (target - 100 * eye, eye) if is_direction else (eye, target - eye)
            with np.errstate(divide="ignore", invalid="ignore"):
                ends = np.sort([(lows - start) / way, (highs - start) / way], axis=0)
            enters, leaves = np.maximum(ends[0].max(axis=1), 0), ends[1].min(axis=1)
            met = np.flatnonzero(enters < leaves - 1e-9)
            along = met[np.argsort(enters[met])]
            assert (np.diff(place[along]) > 0).all()


def test_rings_of_boxes_are_refused() -> None:
    # The first is below the second along x, this below the third along y, and that below the first along z.
    lows = np.array([(0, 0, 1), (1, 0, 0), (0, 1, 0)], np.float64)
    highs = np.array([(1, 2, 2), (2, 1, 2), (2, 2, 1)], np.float64)
    with pytest.raises(ArgumentError, match="in a ring"):
        front_to_back(lows, highs, (1, 1, 1), is_direction=True)
    assert front_to_back(lows, highs, (1, 1, -1), is_direction=True) == [0, 1, 2]


def program_of_page() -> str:
    (block,) = [block for block in pages.blocks_of(PAGE) if block.section == "In the ranks of MPI"]
    return block.code


def run_ranks(n_ranks: int, program: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a Python program by ranks of MPI on this machine."""
    # Open MPI asks for these; MPICH needs none of them.
    allowed = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    allowed["OMPI_MCA_rmaps_base_oversubscribe"] = "1"  # on fewer cores than ranks
    command = ["mpiexec", "-host", "localhost", "-n", str(n_ranks), sys.executable, *program]
    return subprocess.run(
        command, cwd=folder, env={**os.environ, **allowed}, capture_output=True, text=True, timeout=300, check=False
    )


@pytest.fixture(scope="module")
def mpi(tmp_path_factory: pytest.TempPathFactory) -> None:
    """MPI itself runs here; else the test is skipped."""
    if shutil.which("mpiexec") is None or find_spec("mpi4py") is None:
        pytest.skip("needs mpi4py and mpiexec")
    sent = "from mpi4py import MPI; assert MPI.COMM_WORLD.allgather(1) == [1, 1]"
    alone = run_ranks(2, ["-c", sent], tmp_path_factory.mktemp("mpi"))
    if alone.returncode != 0:
        pytest.skip(f"MPI itself does not run here: {alone.stderr.strip().splitlines()[-1:]}")


@pytest.mark.usefixtures("mpi")
def test_a_rank_that_fails_ends_all(tmp_path: Path) -> None:
    program = program_of_page().replace("volume = part", 'assert comm.rank != 1, "no samples"\nvolume = part')
    (tmp_path / "ranks.py").write_text(program)
    done = run_ranks(3, ["-m", "mpi4py", "ranks.py"], tmp_path)
    assert done.returncode != 0
    assert "AssertionError: no samples" in done.stderr
    assert not (tmp_path / "waves.png").exists()


@pytest.mark.usefixtures("mpi")
def test_two_ranks_of_mpi(tmp_path: Path) -> None:
    found = []
    for n_ranks in (1, 2):
        folder = tmp_path / str(n_ranks)
        folder.mkdir()
        (folder / "ranks.py").write_text(program_of_page())
        done = run_ranks(n_ranks, ["-m", "mpi4py", "ranks.py"], folder)
        assert done.returncode == 0, done.stderr
        with Image.open(folder / "waves.png") as image:
            found.append(np.asarray(image, np.float64))
    assert found[0].std() > 10
    assert np.sqrt(np.mean((found[0] - found[1]) ** 2)) < 0.5
