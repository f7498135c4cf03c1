"""Install each extra of the project in an empty environment, and open or write one file of each format that it is for.

The files are written here, by the libraries of the tests. An environment has the package's own dependencies and those
of one extra, of the package index, and nothing else; the package is that of the checkout, with its native module.
A minute for each extra, most of it pip's, and up to 1 GB of disk at a time: environments are removed one by one.

    python python/tools/check_extras.py            # all
    python python/tools/check_extras.py geometry   # some
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
import venv
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "python" / "tests" / "shared"))

#: Begin of what is run in an environment, in the folder of the files.
START = """
import numpy as np, wavesplat as ws
ball = ws.Volume(np.pad(np.full((8, 8, 8), 100, np.float32), 4), unit="mm")
def volume(*names, **options):
    for name in names:
        assert min(ws.open(name, **options).shape) > 1
        print("opened", name)
def shape(*names):
    for name in names:
        ws.open_geometry(name)
        print("opened", name)
"""
#: Extra -> what must work by it.
WORKS = {
    "bio": "volume('a.dv'); import bioio_nd2, bioio_lif",
    "body": "assert ws.largest_body(ball)",
    "dask": "assert ws.render(ball, size=(8, 8), client='threads').rgba.max() > 0",
    "figure": "p = ws.render(ball, size=(64, 64)); p.figure(); p.annotated(scale_bar=True).save('a.pdf')",
    "fit": "ws.Materials.fit(ws.examples.mri_head(), 3)",
    "geometry": "shape('a.stl', 'a.ply', 'a.obj', 'a.off', 'a.glb', 'a.gltf', 'a.3mf', 'a.vtp', 'poly.vtk', 'a.gii')",
    "http": "import aiohttp, fsspec; fsspec.filesystem('https')",
    "mesh": "m = ws.mesh(ball, 50); [m.save('b' + end) for end in ('.ply', '.stl', '.obj', '.glb', '.gltf', '.3mf')]",
    "movie": "[ws.movie(ball, 'a' + end, ws.Turn(2), size=(32, 32)) for end in ('.mp4', '.webm', '.gif', '.webp')]",
    "n5": "volume('bdv.xml', channel=0)",
    "netcdf": "volume('three.nc', 'four.nc')",
    "notebook": "import anywidget; ws.view",
    "parquet": "shape('a.parquet')",
    "pyvista": "ball.to_pyvista()",
    "segy": "volume('a.sgy')",
    "vtk": "volume('a.vtr', 'a.vts')",
    "xarray": "assert ws.Volume(ball.to_xarray()).shape == ball.shape",
}
WORKS["all"] = "\n".join(code.replace("\n", ";") for code in WORKS.values())


def main() -> None:
    """Check the extras that are named, or all of them."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    missing = set(extras) - set(WORKS) - {"dev", "bench", "study", "site"}
    if missing:
        raise SystemExit(f"nothing is said of what must work by {', '.join(sorted(missing))}: add it to WORKS")
    failed = []
    with tempfile.TemporaryDirectory(prefix="extras-") as folder:
        files = Path(folder, "files")
        files.mkdir()
        write_files(files)
        for extra in sys.argv[1:] or WORKS:
            said = tried(Path(folder), [*project["dependencies"], *extras[extra]], START + WORKS[extra])
            print(f"{extra}: {said or 'works'}", flush=True)
            failed += [extra] if said else []
    if failed:
        raise SystemExit(f"these extras lack something: {', '.join(failed)}")


def tried(folder: Path, packages: list[str], code: str) -> str:
    """The end of the messages of what failed with some packages in an empty environment; empty where all worked."""
    place = folder / "environment"
    shutil.rmtree(place, ignore_errors=True)
    venv.create(place, with_pip=True)
    python = place / ("Scripts" if os.name == "nt" else "bin") / "python"
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    install = [python, "-m", "pip", "install", "--quiet", "--no-compile", "--disable-pip-version-check", *packages]
    done = subprocess.run(  # noqa: S603 - pip of the new environment
        install, env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode == 0:
        own = environment | {"PYTHONPATH": str(ROOT / "python"), "PYTHONDONTWRITEBYTECODE": "1"}
        done = subprocess.run(  # noqa: S603 - the code above
            [python, "-c", code], env=own, cwd=folder / "files", capture_output=True, text=True, check=False
        )
    shutil.rmtree(place, ignore_errors=True)
    return "" if done.returncode == 0 else done.stderr.strip()[-600:] or f"ended with {done.returncode}"


def write_files(folder: Path) -> None:
    """Write one file of each format that an extra is for."""
    import mrc  # type: ignore[import-untyped, unused-ignore]
    import nibabel
    import pyarrow as pa
    import pyarrow.parquet as pq
    import pyvista
    import trimesh
    import xarray
    from microscope_files import image, save_bdv_n5
    from test_molecules_and_traces import save_segy

    samples = np.random.default_rng(1).normal(size=(5, 6, 7)).astype(np.float32)
    array = xarray.DataArray(samples, dims=("level", "lat", "lon"), name="t")
    array.to_netcdf(folder / "three.nc", engine="scipy")
    array.to_netcdf(folder / "four.nc", engine="h5netcdf")
    save_segy(folder / "a.sgy", samples)
    save_bdv_n5(folder, image())
    mrc.imsave(str(folder / "a.dv"), samples.astype(np.int16), resolution=(0.1, 0.2, 0.3))
    grid = pyvista.RectilinearGrid(*(np.arange(n, dtype=float) for n in (7, 6, 5)))
    grid["v"] = samples.ravel()
    grid.save(folder / "a.vtr")
    grid.cast_to_structured_grid().save(folder / "a.vts")
    box = trimesh.creation.box()
    for end in ("stl", "ply", "obj", "off", "glb", "3mf"):
        box.export(folder / f"a.{end}")
    content = trimesh.exchange.gltf.export_gltf(trimesh.Scene(box), merge_buffers=True, embed_buffers=True)
    (folder / "a.gltf").write_bytes(content["model.gltf"])
    pyvista.wrap(box).save(folder / "a.vtp")
    pyvista.wrap(box).save(folder / "poly.vtk")
    parts = [
        nibabel.gifti.GiftiDataArray(data.astype(kind), intent=intent)
        for data, kind, intent in (
            (box.vertices, np.float32, "NIFTI_INTENT_POINTSET"),
            (box.faces, np.int32, "NIFTI_INTENT_TRIANGLE"),
        )
    ]
    nibabel.save(nibabel.GiftiImage(darrays=parts), folder / "a.gii")
    table = pa.table({axis: [0.0, 1.0, 2.0] for axis in "xyz"})
    pq.write_table(table, folder / "a.parquet")


if __name__ == "__main__":
    main()
