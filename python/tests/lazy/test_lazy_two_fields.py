"""Layers of lazy volumes that a lazy field colours give the bytes of both in memory, within one budget."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import zarr
from lazy_fakes import Chunked
from numpy.typing import NDArray
from PIL import Image

import wavesplat as ws
from wavesplat._viewer.session.previews import has_lazy, preview_of
from wavesplat.errors import ArgumentError

N = 44
Z, Y, X = np.indices((N, N, N), dtype=np.float32)
RADIUS = np.sqrt((X - 21.5) ** 2 + (Y - 21.5) ** 2 + (Z - 21.5) ** 2)
DENSITY = np.clip(18 - RADIUS + 2 * np.sin(X / 3) * np.cos(Z / 4), 0, None).astype(np.float32)
HEAT = (300 + X + 5 * np.sin(Z / 3)).astype(np.float32)

SOFT = ws.TransferFunction([(0, 0), (14, 0.2)], [(0, 1, 1, 1)])
SOLID = ws.TransferFunction([(3.9, 0), (4.1, 1)], [(0, 1, 1, 1)])
HOT = ws.TransferFunction.from_colormap("inferno", clim=(300, 344))
BOTH = ws.TransferFunction2D([0, 6, 14], [300, 320, 344], np.random.default_rng(1).random((3, 3, 4)), rows="field")


def in_zarr(samples: NDArray[Any], path: Path, name: str, **place: Any) -> ws.Volume:
    array = zarr.create_array(path / f"{name}.zarr", shape=samples.shape, chunks=(16, 10, 44), dtype=samples.dtype)
    array[...] = samples
    return ws.Volume.lazy(array, memory="40 MB", name=name, cache=False, **place)


def mapped(samples: NDArray[Any], path: Path, name: str, **place: Any) -> ws.Volume:
    np.save(path / f"{name}.npy", samples)
    array = np.load(path / f"{name}.npy", mmap_mode="r")
    return ws.Volume.lazy(array, memory="40 MB", name=name, cache=False, **place)


def in_chunks(samples: NDArray[Any], chunk: tuple[int, int, int], memory: str, **place: Any) -> ws.Volume:
    return ws.Volume.lazy(Chunked(samples, chunk), memory=memory, cache=False, **place)


def scene(density: ws.Volume, heat: ws.Volume, look: Any = SOFT, colors: Any = HOT) -> ws.Scene:
    return ws.Scene(ws.Layer(density, look, color_from=ws.Layer(heat, colors)))


def holed(samples: NDArray[Any], *, at: int) -> NDArray[Any]:
    made = samples.copy()
    made[at : at + 9, 4:30, 12:30] = np.nan
    return made


#: Samples of density and heat, and where those of heat lie: at the same places, with holes, and coarser and flipped.
FIELDS: tuple[tuple[NDArray[Any], NDArray[Any], dict[str, Any]], ...] = (
    (DENSITY, HEAT, {}),
    (holed(DENSITY, at=8), holed(HEAT, at=22), {}),
    (
        DENSITY,
        HEAT[::-3, ::2, ::2].copy(),
        {"world_from_index": np.array([[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, -3, 43], [0, 0, 0, 1.0]])},
    ),
)


@pytest.mark.parametrize("lazily", [in_zarr, mapped])
@pytest.mark.parametrize("case", range(3))
@pytest.mark.every_pair
def test_two_lazy_fields_have_the_bytes_of_two_in_memory(lazily: Any, case: int, tmp_path: Path) -> None:
    density, heat, place = FIELDS[case]
    here = ws.Volume(density, name="density"), ws.Volume(heat, name="heat", **place)
    there = lazily(density, tmp_path, "density"), lazily(heat, tmp_path, "heat", **place)
    for (look, colors), composite in product(((None, None), (SOFT, HOT), (SOLID, HOT), (BOTH, None)), (None, 4)):
        operator = composite and ws.FirstHit(composite)
        kernels = ("linear", "bspline3") if look is SOFT else ("linear",)
        for kernel in kernels:
            options: Any = {"size": (90, 72), "composite": operator, "kernel": kernel}
            want = ws.render(scene(*here, look, colors), **options)
            got = ws.render(scene(*there, look, colors), **options)
            assert want.rgba[..., 3].max() > 0.1
            assert got.rgba.tobytes() == want.rgba.tobytes(), (look, composite, kernel)
            assert got.camera == want.camera
    assert got.report["lazy"]["levels"] == [0, 0]


def test_one_of_the_two_may_be_in_memory() -> None:
    here = ws.Volume(DENSITY), ws.Volume(HEAT)
    there = in_chunks(DENSITY, (16, 10, 9), "40 MB"), in_chunks(HEAT, (11, 44, 13), "40 MB")
    want = ws.render(scene(*here), size=(80, 80)).rgba
    for density, heat in ((here[0], there[1]), (there[0], here[1])):
        assert np.array_equal(ws.render(scene(density, heat), size=(80, 80)).rgba, want)


@pytest.fixture(scope="module")
def large() -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    z, y, x = np.indices((128, 128, 128), dtype=np.float32)
    waves = 100 * (1 + np.sin(x / 9) * np.cos(y / 11) * np.sin(z / 13 + 1))
    return waves.astype(np.uint8), (300 + x + 30 * np.sin(z / 10)).astype(np.float32)


WALLS = ws.TransferFunction([(130, 0), (200, 0.05)], [(0, 1, 1, 1)])
WARM = ws.TransferFunction.from_colormap("inferno", clim=(270, 458))


def test_small_budgets_and_other_chunks_give_the_same_bytes(large: Any) -> None:
    density, heat = large
    want = ws.render(scene(ws.Volume(density), ws.Volume(heat), WALLS, WARM), size=(300, 300)).rgba
    blocks = []
    for chunk, memory in (((32, 32, 32), "4 MB"), ((64, 16, 128), "12 MB"), ((9, 40, 31), "40 MB")):
        there = in_chunks(density, (32, 32, 32), memory), in_chunks(heat, chunk, memory)
        for client in (None, "threads"):
            got = ws.render(scene(*there, WALLS, WARM), size=(300, 300), client=client)
            assert np.array_equal(got.rgba, want), (chunk, memory, client)
        blocks.append(got.report["lazy"]["blocks"])
    assert blocks[0] > blocks[-1]


def test_where_all_of_it_fits_each_chunk_of_both_is_read_once_for_a_picture(large: Any) -> None:
    density, heat = large
    # The field's chunks are thicker than a step of the layer.
    arrays = Chunked(density, (32, 32, 32)), Chunked(heat, (48, 32, 32))
    drawn = scene(*(ws.Volume.lazy(array, memory="60 MB", cache=False) for array in arrays), WALLS, WARM)
    first = ws.render(drawn, size=(300, 300))
    for array in arrays:
        array.counts.clear()
    again = ws.render(drawn, size=(300, 300))
    assert np.array_equal(first.rgba, again.rgba)
    assert again.report["lazy"]["blocks"] == 1
    for array in arrays:
        assert array.counts
        assert max(array.counts.values()) == 1


def test_chunks_of_a_field_that_colour_nothing_are_not_read() -> None:
    density = np.zeros((96, 96, 96), np.uint8)
    density[40:56, 40:56, 40:56] = 200
    heat = Chunked(np.indices((96, 96, 96), np.float32)[2], (16, 16, 16))
    drawn = scene(in_chunks(density, (16, 16, 16), "40 MB"), ws.Volume.lazy(heat, memory="40 MB", cache=False), WALLS)
    ws.render(drawn, size=(96, 96))
    heat.counts.clear()
    assert ws.render(drawn, size=(96, 96)).rgba[..., 3].max() > 0.1
    assert 1 <= len(heat.counts) <= 64, "of 216 chunks"


def test_segments_of_two_fields_do_not_depend_on_who_draws_them(large: Any) -> None:
    density, heat = large
    there = scene(in_chunks(density, (32,) * 3, "12 MB"), in_chunks(heat, (40,) * 3, "12 MB"), WALLS, WARM)
    here = scene(ws.Volume(density), ws.Volume(heat), WALLS, WARM)
    want = ws.render(here, size=(200, 200), segments=40).rgba
    for client in (None, "threads"):
        assert np.array_equal(ws.render(there, size=(200, 200), segments=40, client=client).rgba, want)


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(2, threads_per_worker=1, dashboard_address=":0", memory_limit="2GB") as cluster:  # noqa: SIM117
        with distributed.Client(cluster) as made:
            yield made


def test_workers_draw_two_fields(client: Any, tmp_path: Path) -> None:
    there = scene(in_zarr(DENSITY, tmp_path, "density"), in_zarr(HEAT, tmp_path, "heat"))
    want = ws.render(scene(ws.Volume(DENSITY), ws.Volume(HEAT)), size=(120, 90)).rgba
    assert np.array_equal(ws.render(there, size=(120, 90), client=client).rgba, want)
    cut = ws.render(there, size=(120, 90), segments=16).rgba
    assert np.array_equal(ws.render(there, size=(120, 90), segments=16, client=client).rgba, cut)


def test_arrays_in_workers_memory_are_drawn_in_segments(client: Any) -> None:
    import dask.array as da

    arrays = [client.persist(da.from_array(samples, chunks=(22, 22, 22))) for samples in (DENSITY, HEAT)]
    there = scene(*(ws.Volume.lazy(array, memory="40 MB", cache=False) for array in arrays))
    with pytest.raises(ArgumentError, match="segments=256"):
        ws.render(there, size=(90, 90), client=client)
    got = ws.render(there, size=(90, 90), client=client, segments=16)
    want = ws.render(scene(ws.Volume(DENSITY), ws.Volume(HEAT)), size=(90, 90), segments=16)
    assert np.array_equal(got.rgba, want.rgba)


def test_levels_and_previews_have_both_fields() -> None:
    pyramids = [[samples, samples[::2, ::2, ::2].copy()] for samples in (DENSITY, HEAT)]
    both = [ws.Volume.lazy(levels, memory="40 MB", cache=False) for levels in pyramids]
    drawn = scene(*both)
    coarse, *_, last = ws.progressive(drawn, size=(160, 160))
    assert coarse.report["lazy"]["levels"] == [1, 1]
    assert np.array_equal(last.rgba, ws.render(drawn, size=(160, 160)).rgba)
    seen = preview_of(drawn)
    assert has_lazy(drawn)
    assert not has_lazy(seen)
    near = ws.render(seen, camera=last.camera, size=(160, 160))
    assert np.abs(near.rgba - last.rgba).mean() < 0.03


def test_what_two_lazy_fields_cannot_do_is_said(tmp_path: Path) -> None:
    density, heat = in_zarr(DENSITY, tmp_path, "density"), in_zarr(HEAT, tmp_path, "heat")
    matrix = np.eye(4)
    matrix[:2, :2] = [[0.8, -0.6], [0.6, 0.8]]
    turned = ws.Volume.lazy(np.ones((80, 80, 80), np.float32), memory="40 MB", world_from_index=matrix, name="turned")
    for drawn, arguments, wanted in (
        (scene(density, turned), {}, "turned"),
        (scene(density, heat), {"psnr": 40}, "lazy volumes"),
        (scene(density, ws.WaveletVolume.from_volume(ws.Volume(HEAT))), {}, r"to_volume\(\)"),
        (scene(density, in_zarr(HEAT[:9], tmp_path, "part")), {}, "does not cover it"),
    ):
        with pytest.raises(ArgumentError, match=wanted):
            ws.render(drawn, size=(24, 24), **arguments)


def test_color_by_reads_files_as_they_are_drawn(wavesplat: Any, tmp_path: Path) -> None:
    with h5py.File(tmp_path / "gas.h5", "w") as file:
        file.create_dataset("density", data=DENSITY, chunks=(16, 16, 16))
        file.create_dataset("heat", data=HEAT, chunks=(16, 16, 16))
    np.save(tmp_path / "heat.npy", HEAT)
    made = []
    for number, (field, memory) in enumerate(product(("heat", f"{tmp_path}/heat.npy"), ((), ("--memory", "20MB")))):
        out = tmp_path / f"{number}.png"
        by = ("--dataset", "density", "--color-by", f"{field}:inferno:300,344", "--size", "64x64", "--json")
        result = wavesplat("render", tmp_path / "gas.h5", *by, *memory, "--cache", "off", "-o", out)
        assert result.returncode == 0, result.stderr
        report = json.loads(result.stdout)["report"]
        assert ("lazy" in report) == bool(memory)
        assert not memory or report["lazy"]["levels"] == [0, 0]
        with Image.open(out) as image:
            made.append(np.asarray(image))
    assert made[0].max() > 50
    assert all(np.array_equal(made[0], one) for one in made[1:])


#: Draws a Zarr array that another one colours, and tells the peak of the process.
CODE = """
import json, sys
import wavesplat as ws
density, heat = (ws.open(path, memory=sys.argv[3], cache=False) for path in sys.argv[1:3])
colors = ws.TransferFunction.from_colormap("inferno", clim=(0, 256))
picture = ws.render(ws.Scene(ws.Layer(density, color_from=ws.Layer(heat, colors))), size=(256, 256))
lines = open("/proc/self/status").read().splitlines()
peak = next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))
print(json.dumps({"peak": peak, "alpha": float(picture.rgba[..., 3].max()), **picture.report["lazy"]}))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="peak memory is read from /proc")
def test_two_fields_are_drawn_within_the_budget_of_one(tmp_path: Path) -> None:
    n, side = 192, 48
    for name in ("density", "heat"):
        array = zarr.create_array(tmp_path / f"{name}.zarr", shape=(n,) * 3, chunks=(side,) * 3, dtype="u2")
        noise = np.random.default_rng(0).integers(0, 64, (side, n, n)).astype(np.uint16)
        y, x = np.ogrid[-1 : 1 : n * 1j, -1 : 1 : n * 1j]
        for z in range(0, n, side):
            slab = [1000 * np.exp(-(((np.hypot(y, x) - 0.4 - k / n / 3) / 0.1) ** 2)) for k in range(z, z + side)]
            array[z : z + side] = noise + (np.stack(slab).astype(np.uint16) if name == "density" else 0)
    command = [sys.executable, "-c", CODE, str(tmp_path / "density.zarr"), str(tmp_path / "heat.zarr"), "12 MB"]
    told = json.loads(subprocess.run(command, capture_output=True, text=True, check=True, timeout=240).stdout)
    assert told["alpha"] > 0.1
    # What one volume takes beside its budget (`test_memory_budget`), and the field's samples for light and looks.
    assert told["peak"] < 12e6 + 165e6 + 4 * n**3 + 12e6, f"{told['peak'] / 1e6:.0f} MB"
